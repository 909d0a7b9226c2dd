"""`object.gridmesh_join` on real meshes: closed, data carried on, one undo step, refusals, options."""

from collections import Counter

import bmesh
import bpy
import numpy as np
import pytest
from cuts import check_sound, volume
from drawings import activate, circle, fingerprint, grease_pencil, mesh_objects, run, vertices
from holes import faces_of
from mathutils import Matrix


def ball(name, x=0.0, radius=1.0, *, material=None, segments=32, rings=16):
    """A closed sphere of quads, with triangles at its poles."""
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=segments, ring_count=rings, radius=radius, location=(x, 0, 0.1 * x)
    )
    ob = bpy.context.object
    ob.name = ob.data.name = name
    if material is not None:
        ob.data.materials.append(bpy.data.materials.new(material))
    return ob


def pair(**options):
    return ball("Body", **options), ball("Head", 1.1, 0.7, **options)


def join(*objects, **options):
    """Join as from a script; return the whole."""
    activate(*objects)
    assert bpy.ops.object.gridmesh_join(**options) == {"FINISHED"}
    bpy.context.view_layer.update()
    return bpy.context.view_layer.objects.active


def faces_in_world(ob):
    """Corners of all faces in the world, rounded, each from its least corner on."""
    matrix = np.array(ob.matrix_world)
    points = (vertices(ob.data) @ matrix[:3, :3].T + matrix[:3, 3]).round(4) + 0.0
    found = []
    for face in faces_of(ob.data):
        ring = [tuple(points[index].tolist()) for index in face]
        least = ring.index(min(ring))
        found.append(tuple(ring[least:] + ring[:least]))
    return found


def colored(ob, color):
    layer = ob.data.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    for entry in layer.data:
        entry.color = color


# ----------------------------------------------------------------------------------------------- geometry


@pytest.mark.smoke
@pytest.mark.parametrize("blend", [0.0, 2.0, 4.0])
def test_two_become_one_closed_body_and_keep_their_faces(blend, capfd):
    body, head = pair()
    before = set(faces_in_world(body)) | set(faces_in_world(head))
    whole = join(body, head, blend=blend)
    assert whole == body
    assert mesh_objects() == [body]
    assert [mesh.name for mesh in bpy.data.meshes] == ["Body"]
    check_sound(whole)
    assert 4.2 < volume(whole) < 6.5
    kept = set(faces_in_world(whole)) & before
    assert len(kept) > 0.4 * len(before)
    assert all(len(face) == 3 for face in set(faces_in_world(whole)) - before)
    told = capfd.readouterr().out
    assert "Joined 2 parts: " in told
    assert " quads and " in told


def test_cubes_of_six_faces_keep_the_crease(capfd):
    """They leave a blend no room; it used to take most of them away, or to leave the slivers of a Boolean."""
    bpy.ops.mesh.primitive_cube_add(size=2)
    first = bpy.context.object
    bpy.ops.mesh.primitive_cube_add(size=2, location=(0.9, 0.7, 0.5), rotation=(0.3, 0.4, 0.5))
    whole = join(first, bpy.context.object)
    check_sound(whole)
    assert 11 < volume(whole) < 16
    assert "1 joint with a crease, since there is no room for a transition" in capfd.readouterr().out


def test_the_border_of_two_materials_has_no_teeth():
    body, head = ball("Body", material="Red"), ball("Head", 1.1, 0.7, material="Blue")
    whole = join(body, head)
    check_sound(whole)
    mesh = whole.data
    bm = bmesh.new()
    bm.from_mesh(mesh)
    line = [edge for edge in bm.edges if len({face.material_index for face in edge.link_faces}) == 2]
    assert len(line) > 12
    angles = []
    for vertex in {vertex for edge in line for vertex in edge.verts}:
        first, second = (edge.other_vert(vertex).co - vertex.co for edge in line if vertex in edge.verts)
        angles.append(first.angle(second))
    bm.free()
    # Where the line meets a vertex of a rim a corner may stay.
    corner, *rest = sorted(np.degrees(angles))
    assert corner > 120
    assert min(rest) > 150


def test_wide_blends_take_more_away():
    kept = []
    for blend in (1.0, 3.0):
        kept.append(sum(len(face) == 4 for face in faces_of(join(*pair(), blend=blend).data)))
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert kept[1] < kept[0]


def test_three_parts_one_of_them_apart(capfd):
    whole = join(*pair(), ball("Moon", 9.0))
    check_sound(whole)
    assert "1 part without contact to others" in capfd.readouterr().out
    assert max(point[0] for face in faces_in_world(whole) for point in face) > 9.5


def test_a_part_inside_another_is_left_out(capfd):
    whole = join(ball("Body"), ball("Core", radius=0.3))
    check_sound(whole)
    assert "1 part inside others left out" in capfd.readouterr().out
    assert len(whole.data.vertices) == 32 * 15 + 2


def merged(*objects):
    """One object of several, by Blender's own Join: their meshes as they are."""
    activate(*objects)
    bpy.ops.object.join()
    return bpy.context.object


def test_overlapping_pieces_of_one_mesh_are_joined_like_parts(capfd):
    """One object of two balls that cross, with a material and a vertex group each, joined with a third."""
    pieces = [ball("First", material="Red"), ball("Second", 1.1, 0.7, material="Blue")]
    for ob in pieces:
        ob.vertex_groups.new(name=ob.name).add(range(len(ob.data.vertices)), 1.0, "REPLACE")
    body = merged(*reversed(pieces))
    other = ball("Third", 2.0, 0.6, material="Green")
    before = dict.fromkeys(faces_in_world(other), "Green")
    for polygon, face in zip(body.data.polygons, faces_in_world(body), strict=True):
        before[face] = body.data.materials[polygon.material_index].name
    whole = join(body, other)
    check_sound(whole)
    assert "Overlapping pieces of meshes, joined like parts: 2" in capfd.readouterr().out
    bm = bmesh.new()
    bm.from_mesh(whole.data)
    assert len(bm.verts) - len(bm.edges) + len(bm.faces) == 2
    bm.free()
    kept = Counter()
    for polygon, face in zip(whole.data.polygons, faces_in_world(whole), strict=True):
        if face in before:
            assert whole.data.materials[polygon.material_index].name == before[face]
            kept[before[face]] += 1
    assert min(kept[name] for name in ("Red", "Blue", "Green")) > 60
    weights = np.zeros((len(whole.data.vertices), len(whole.vertex_groups)))
    for vertex in whole.data.vertices:
        for element in vertex.groups:
            weights[vertex.index, element.group] = element.weight
    names = [group.name for group in whole.vertex_groups]
    # What is left of the first ball is the first group's alone, as it was.
    far = vertices(whole.data)[:, 0] + whole.location.x < -0.5
    assert far.sum() > 50
    assert (weights[far][:, names.index("First")] == 1).all()
    assert (weights[far][:, names.index("Second")] == 0).all()


@pytest.mark.parametrize(
    "matrix",
    [
        Matrix.Diagonal((-1, 1, 1, 1)),
        Matrix.Rotation(0.7, 4, "X") @ Matrix.Diagonal((2, 1, -0.5, 1)),
        Matrix(((1, 0.4, 0, 3), (0, 1, 0, 0), (0, 0.2, 1, 0), (0, 0, 0, 1))),
    ],
    ids=["mirrored", "mirrored and stretched", "sheared"],
)
@pytest.mark.parametrize("both", [False, True])
def test_places_of_objects_do_not_matter(matrix, both):
    """The same surfaces in the world, in other spaces: the same whole in the world, wound outward there as before."""
    body, head = pair()
    plain = faces_in_world(join(body, head))
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    body, head = pair()
    for ob in (body, head) if both else (head,):
        mesh = ob.data
        mesh.transform(matrix.inverted() @ ob.matrix_world)
        if matrix.determinant() < 0:
            mesh.flip_normals()
        parent = bpy.data.objects.new("Carrier", None)
        bpy.context.scene.collection.objects.link(parent)
        ob.parent, ob.matrix_parent_inverse, ob.matrix_basis = parent, matrix, Matrix()
    bpy.context.view_layer.update()
    assert head.matrix_world.determinant() * matrix.determinant() > 0
    whole = join(body, head)
    check_sound(whole)
    assert volume(whole) > 0
    assert len(faces_of(whole.data)) == pytest.approx(len(plain), rel=0.05)


def test_a_part_inside_out_is_turned_and_named(capfd):
    body, head = pair()
    head.data.flip_normals()
    whole = join(body, head)
    check_sound(whole)
    assert volume(whole) > 4.2
    assert "nside out, and turned round: Head" in capfd.readouterr().out


def test_cubes_that_share_an_edge_are_taken_apart_there(capfd):
    cubes = []
    for place in (0, 2):
        bpy.ops.mesh.primitive_cube_add(location=(place, place, 0))
        cubes.append(bpy.context.object)
    both = merged(*cubes)
    edit = bmesh.new()
    edit.from_mesh(both.data)
    bmesh.ops.remove_doubles(edit, verts=edit.verts, dist=0.01)
    assert len(edit.verts) == 14
    bmesh.ops.subdivide_edges(edit, edges=edit.edges, cuts=3, use_grid_fill=True)
    edit.to_mesh(both.data)
    edit.free()
    both.data.polygons.foreach_set("use_smooth", np.arange(len(both.data.polygons)) % 2 == 0)
    before = corners_in_space(both)
    whole = join(both, ball("Body", -1.0, 0.5))
    check_sound(whole)
    assert "faces met in one point or edge alone: 5" in capfd.readouterr().out
    kept = {corner for corner in before if corner[0] > -0.9}
    assert kept <= set(corners_in_space(whole))


def corners_in_space(ob):
    """Where each corner of a mesh with UVs is, its UV, and how its face is shaded."""
    mesh, matrix = ob.data, ob.matrix_world
    corners = []
    for polygon in mesh.polygons:
        for index in polygon.loop_indices:
            at = matrix @ mesh.vertices[mesh.loops[index].vertex_index].co
            uv = mesh.uv_layers[0].data[index].uv
            corners.append((*np.round([*at, *uv], 5).tolist(), polygon.use_smooth))
    return corners


def test_objects_that_share_a_mesh_are_joined_and_others_keep_it():
    body = ball("Body")
    twin, third = body.copy(), body.copy()
    for x, ob in ((1.2, twin), (9.0, third)):
        bpy.context.scene.collection.objects.link(ob)
        ob.location.x = x
    before = vertices(body.data)
    whole = join(body, twin)
    check_sound(whole)
    assert np.array_equal(vertices(third.data), before)
    assert third.data != whole.data


# --------------------------------------------------------------------------------------------------- data


def test_materials_groups_and_colours_go_on_over_the_joint():
    body, head = ball("Body", material="Red"), ball("Head", 1.1, 0.7, material="Blue")
    for ob, color in ((body, (1, 0, 0, 1)), (head, (0, 0, 1, 1))):
        ob.vertex_groups.new(name=ob.name).add(range(len(ob.data.vertices)), 1.0, "REPLACE")
        colored(ob, color)
    old = {name: set(faces_in_world(ob)) for name, ob in (("Red", body), ("Blue", head))}
    whole = join(body, head)
    mesh = whole.data
    assert [material.name for material in mesh.materials] == ["Red", "Blue"]
    names = {group.index: group.name for group in whole.vertex_groups}
    assert sorted(names.values()) == ["Body", "Head"]
    new = 0
    for polygon, face in zip(mesh.polygons, faces_in_world(whole), strict=True):
        name = mesh.materials[polygon.material_index].name
        origin = next((origin for origin, faces in old.items() if face in faces), None)
        assert origin in (None, name)
        new += origin is None
    assert new > 50
    assert "gridmesh" not in " ".join(layer.name for layer in mesh.attributes)
    weights = np.zeros((len(mesh.vertices), 2))
    for vertex in mesh.vertices:
        for element in vertex.groups:
            weights[vertex.index, int(names[element.group] == "Head")] = element.weight
    assert np.allclose(weights.sum(axis=1), 1.0, atol=1e-5)
    assert weights.min() >= 0
    between = (weights[:, 0] > 0.05) & (weights[:, 0] < 0.95)
    assert between.sum() > 20
    red = np.array([entry.color[0] for entry in mesh.color_attributes["Paint"].data])
    assert np.allclose(red, weights[:, 0], atol=1e-4)


def test_materials_of_the_object_count():
    body, head = pair()
    for ob in (body, head):
        ob.data.materials.append(None)
        ob.material_slots[0].link = "OBJECT"
        ob.material_slots[0].material = bpy.data.materials.new(f"Of {ob.name}")
    whole = join(body, head)
    assert [slot.material.name for slot in whole.material_slots] == ["Of Body", "Of Head"]
    assert len({polygon.material_index for polygon in whole.data.polygons}) == 2


def test_uvs_and_sharp_edges_stay_where_faces_stay():
    body, head = pair()
    layer = body.data.uv_layers.active
    before = {}
    for polygon, face in zip(body.data.polygons, faces_in_world(body), strict=True):
        ring = [layer.uv[index].vector.to_tuple(4) for index in polygon.loop_indices]
        before[face] = Counter(ring)
    for edge in body.data.edges:
        edge.use_edge_sharp = True
    whole = join(body, head)
    layer = whole.data.uv_layers.active
    same = 0
    for polygon, face in zip(whole.data.polygons, faces_in_world(whole), strict=True):
        ring = Counter(layer.uv[index].vector.to_tuple(4) for index in polygon.loop_indices)
        assert all(np.isfinite(uv).all() and min(uv) >= 0 and max(uv) <= 1 for uv in ring)
        if face in before:
            assert ring == before[face]
            same += 1
    assert same > 200
    assert sum(edge.use_edge_sharp for edge in whole.data.edges) > 200


def test_shape_keys_of_all_parts_move_the_collars():
    body, head = pair()
    head.shape_key_add(name="Basis")
    key = head.shape_key_add(name="Nod")
    for point in key.data:
        point.co.z += 0.5
    key.value = 1.0
    whole = join(body, head)
    check_sound(whole)
    keys = whole.data.shape_keys.key_blocks
    assert [key.name for key in keys] == ["Basis", "Nod"]
    places = [np.array([point.co for point in key.data]) for key in keys]
    lift = (places[1] - places[0])[:, 2]
    assert lift.min() > -1e-5
    assert lift.max() == pytest.approx(0.5, abs=1e-4)
    assert ((lift > 0.05) & (lift < 0.45)).sum() > 20
    assert np.allclose(places[0], vertices(whole.data))


def test_crease_is_sharp_and_a_blend_is_not():
    sharp = []
    for blend in (0.0, 2.0):
        for ob in (pair := [ball("Body"), ball("Head", 1.1, 0.7)]):
            ob.data.shade_smooth()
        whole = join(*pair, blend=blend)
        assert all(polygon.use_smooth for polygon in whole.data.polygons)
        sharp.append(sum(edge.use_edge_sharp for edge in whole.data.edges))
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert sharp[0] > 10
    assert sharp[1] == 0


def test_modifiers_children_and_collections_stay(capfd):
    body, head = pair()
    body.modifiers.new("Subdivision", "SUBSURF")
    head.modifiers.new("Bevel", "BEVEL")
    child = bpy.data.objects.new("Hat", None)
    bpy.context.scene.collection.objects.link(child)
    child.parent, child.location, head.rotation_euler.y = head, (0, 0, 1), 0.3
    bpy.context.view_layer.update()
    place = child.matrix_world.translation.copy()
    whole = join(body, head)
    assert [modifier.name for modifier in whole.modifiers] == ["Subdivision"]
    assert child.parent == whole
    assert (child.matrix_world.translation - place).length < 1e-5
    assert "without their modifiers: Head" in capfd.readouterr().out


# ------------------------------------------------------------------------------------------- undo, options


@pytest.mark.smoke
def test_one_undo_step():
    activate(*pair())
    bpy.ops.ed.undo_push(message="base")
    before = fingerprint()
    assert bpy.ops.object.gridmesh_join("EXEC_DEFAULT", True) == {"FINISHED"}
    assert len(mesh_objects()) == 1
    bpy.ops.ed.undo()
    assert fingerprint() == before
    assert bpy.ops.object.gridmesh_join("EXEC_DEFAULT", True, blend=0.0) == {"FINISHED"}
    check_sound(bpy.context.view_layer.objects.active)


def test_kept_parts_are_hidden_and_as_they_were():
    body, head = pair()
    body.modifiers.new("Subdivision", "SUBSURF")
    before = [vertices(ob.data) for ob in (body, head)]
    whole = join(body, head, keep_parts=True)
    assert whole not in (body, head)
    check_sound(whole)
    assert [modifier.name for modifier in whole.modifiers] == ["Subdivision"]
    assert whole.visible_get()
    assert not whole.hide_render
    for ob, points in zip((body, head), before, strict=True):
        assert not ob.visible_get()
        assert ob.hide_render
        assert np.array_equal(vertices(ob.data), points)
    assert bpy.context.selected_objects == [whole]


def test_edge_length_is_what_blend_counts_in():
    quads = []
    for length in (0.0, 0.05, 0.4):
        quads.append(sum(len(face) == 4 for face in faces_of(join(*pair(), edge_length=length).data)))
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert quads[2] < quads[0] < quads[1]


# ---------------------------------------------------------------------------------------------- live, strokes


def drawing():
    """A head before a body, each in a layer of its own."""
    ob = grease_pencil([circle(radius=1.0)], layer="Body")
    return grease_pencil([circle(radius=0.5, centre=(0.0, 0.9))], layer="Head", ob=ob)


def test_overlapping_strokes_become_one_body(capfd):
    drawing()
    (whole,) = run(use_join=True)
    check_sound(whole)
    assert "Joined 2 parts" in capfd.readouterr().out
    assert mesh_objects() == [whole]
    assert not bpy.ops.object.gridmesh_from_strokes.poll() or len(bpy.data.meshes) == 1


def test_layers_lie_one_before_the_other():
    reach = []
    for depth in (0.0, 1.0):
        grease_pencil([circle(radius=0.4)], layer="Nose", ob=grease_pencil([circle()], layer="Face"))
        (whole,) = run(use_join=True, layer_depth=depth)
        check_sound(whole)
        reach.append(max(point[2] for face in faces_in_world(whole) for point in face))
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert reach[0] == pytest.approx(1.0, abs=0.02)
    assert reach[1] > 1.2


def test_live_bodies_are_frozen_and_named(capfd):
    drawing()
    bodies = run(follow=True)
    whole = join(*bodies, follow=False)
    check_sound(whole)
    assert mesh_objects() == [whole]
    assert not whole.gridmesh_live.linked
    assert "frozen, since a joined body cannot follow its drawings" in capfd.readouterr().out.lower()


def test_live_parts_stay_live_where_they_are_kept():
    drawing()
    bodies = run(follow=True)
    whole = join(*bodies, keep_parts=True)
    assert not whole.gridmesh_live.linked
    assert all(body.gridmesh_live.linked for body in bodies)


# ------------------------------------------------------------------------------------------------- refusals


def refused(match, *objects, **options):
    """The operator refuses, and nothing changes."""
    activate(*objects)
    before = fingerprint()
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.object.gridmesh_join(**options)
    assert fingerprint() == before


def test_needs_two_meshes_or_pieces_that_overlap():
    refused("'Body' is the only mesh, and none of its pieces overlap", ball("Body"))
    empty = bpy.data.objects.new("Empty", None)
    bpy.context.scene.collection.objects.link(empty)
    refused("'Body' is the only mesh", bpy.data.objects["Body"], empty)
    refused("Select closed meshes", empty)
    refused("'Far' is the only mesh", merged(ball("Far"), ball("Apart", 5.0)))


@pytest.mark.parametrize("keep", [False, True])
def test_overlapping_pieces_of_the_only_mesh_are_joined(keep):
    body = merged(ball("Body"), ball("Head", 1.2, 0.7))
    before = vertices(body.data)
    whole = join(body, keep_parts=keep)
    check_sound(whole)
    assert (whole == body) is not keep
    if keep:
        assert np.array_equal(vertices(body.data), before)


def test_an_open_mesh():
    body, head = pair()
    bm = bmesh.new()
    bm.from_mesh(head.data)
    bm.faces.ensure_lookup_table()
    bmesh.ops.delete(bm, geom=[bm.faces[7]], context="FACES")
    bm.to_mesh(head.data)
    bm.free()
    refused("'Head' is not closed: it has [34] open edges; fill its holes", body, head)


def test_a_flat_piece_beside_a_solid_one():
    sheet = ball("Sheet", 5.0)
    for vertex in sheet.data.vertices:
        vertex.co.z = 0
    body = merged(sheet, ball("Body"))
    refused("(?s)'Sheet' .*the faces of a piece of it lie on each other", body, ball("Head", -1.1, 0.7))


def test_a_mesh_with_a_wall_inside():
    body, head = pair()
    bm = bmesh.new()
    bm.from_mesh(head.data)
    bm.verts.ensure_lookup_table()
    ring = sorted((v for v in bm.verts if abs(v.co.z) < 1e-4), key=lambda v: np.arctan2(v.co.y, v.co.x))
    bm.faces.new(ring)
    bm.to_mesh(head.data)
    bm.free()
    refused("'Head' is not manifold: more than two faces meet at 32 edges", body, head)


def test_faces_that_look_against_each_other():
    body, head = pair()
    bm = bmesh.new()
    bm.from_mesh(head.data)
    bm.faces.ensure_lookup_table()
    bmesh.ops.reverse_faces(bm, faces=[bm.faces[7]])
    bm.to_mesh(head.data)
    bm.free()
    refused("Part 'Head' is not closed and manifold: .*wound against each other", body, head)


def test_a_mesh_without_faces():
    body, head = pair()
    head.data.clear_geometry()
    refused("'Head' has no faces to join", body, head)


@pytest.mark.parametrize("which", [0, 1])
def test_a_scale_of_zero(which):
    both = pair()
    both[which].scale.y = 0.0
    refused("has no thickness, since a scale of it is zero", *both)


def test_a_place_that_is_not_finite():
    body, head = pair()
    head.data.vertices[3].co.x = float("nan")
    refused("Vertex 3 of 'Head' has a coordinate that is not a finite number", body, head)
