"""Areas of meshes in Edit Mode, meshed anew: the grid, its place, and what is carried over."""

import bmesh
import bpy
import numpy as np
import pytest
from drawings import activate, bean, grease_pencil, run_one, uv_of, vertices
from holes import directed, edit, faces_of, grid, leave, select, suzanne

from addon.regrid.carried import nearest_on_edges


def sphere(segments=24, rings=16):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=rings)
    return bpy.context.object


def select_faces(ob, keep):
    bm = edit(ob, mode="FACE")
    chosen = [face for face in bm.faces if keep(face.calc_center_median())]
    select(ob, chosen)
    return [face.index for face in chosen]


def regrid(**options):
    assert bpy.ops.mesh.gridmesh_regrid(**options) == {"FINISHED"}
    leave()


def refused(**options):
    before = [vertices(ob.data).tobytes() for ob in bpy.data.objects if ob.type == "MESH"]
    with pytest.raises(RuntimeError) as error:
        bpy.ops.mesh.gridmesh_regrid(**options)
    leave()
    assert before == [vertices(ob.data).tobytes() for ob in bpy.data.objects if ob.type == "MESH"]
    return str(error.value)


def patch_of(ob):
    return [tuple(polygon.vertices) for polygon in ob.data.polygons if polygon.select]


def check(ob, closed=True):
    mesh = ob.data
    assert not mesh.validate(verbose=True)
    runs = directed(faces_of(mesh))
    assert max(runs.values()) == 1
    if closed:
        assert all(pair[::-1] in runs for pair in runs)
    assert len({v for face in faces_of(mesh) for v in face}) == len(mesh.vertices), "a vertex is left alone"
    return patch_of(ob)


def regular(patch):
    """Share of the patch's inner vertices with six edges."""
    sides = np.array([pair for face in patch for pair in zip(face, face[1:] + face[:1], strict=True)])
    edges, times = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    border = set(edges[times == 1].ravel().tolist())
    valence = np.bincount(edges.ravel())
    inner = [v for v in np.unique(edges).tolist() if v not in border]
    return float(np.mean([valence[v] == 6 for v in inner]))


def test_selected_faces_become_a_grid_on_the_same_surface():
    ob = sphere()
    select_faces(ob, lambda at: at.x > 0.3)
    regrid()
    patch = check(ob)
    assert {len(face) for face in patch} == {3}
    new = np.unique(patch)
    radius = np.linalg.norm(vertices(ob.data)[new], axis=1)
    assert radius.min() > 0.97
    assert radius.max() < 1 + 1e-6
    assert regular(patch) > 0.8


def test_the_rest_of_the_mesh_is_what_it_was():
    ob = suzanne()
    before = {tuple(map(tuple, vertices(ob.data)[list(face)].tolist())) for face in faces_of(ob.data)}
    chosen = select_faces(ob, lambda at: at.z > 0.45 and abs(at.x) < 0.6)
    regrid()
    points = vertices(ob.data)
    after = {
        tuple(map(tuple, points[list(polygon.vertices)].tolist()))
        for polygon in ob.data.polygons
        if not polygon.select
    }
    assert after <= before
    assert len(before) - len(after) == len(chosen)


def test_a_loop_of_edges_encloses_the_smaller_side():
    ob = sphere()
    bm = edit(ob)
    level = sorted({round(vertex.co.z, 4) for vertex in bm.verts})[-5]
    select(ob, [e for e in bm.edges if all(abs(v.co.z - level) < 1e-3 for v in e.verts)])
    regrid()
    patch = check(ob)
    assert vertices(ob.data)[np.unique(patch)][:, 2].min() > level - 1e-3
    assert regular(patch) > 0.6


def test_bodies_of_drawings_keep_their_uv_map_weights_and_keys():
    grease_pencil([bean()])
    ob = run_one(triangles=1500)
    points = vertices(ob.data)
    group = ob.vertex_groups.new(name="Bone")
    for vertex in ob.data.vertices:
        group.add([vertex.index], 0.5 + 0.4 * vertex.co.x / np.abs(points[:, 0]).max(), "REPLACE")
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Up", from_mix=False)
    moved = points + [0, 0, 2]
    key.data.foreach_set("co", moved.astype(np.float32).ravel())
    ob.active_shape_key_index = 0
    select_faces(ob, lambda at: at.z > 0.4 * points[:, 2].max())
    regrid()
    patch = check(ob)
    assert len(patch) > 100
    after, corners = vertices(ob.data), np.array(faces_of(ob.data)).ravel()
    uv, inside = uv_of(ob), np.repeat([polygon.select for polygon in ob.data.polygons], 3)
    for v in set(corners[inside].tolist()) & set(corners[~inside].tolist()):
        assert np.ptp(uv[corners == v], axis=0).max() < 1e-6, "the map is torn"
    a, b, c = uv.reshape(-1, 3, 2)[inside[::3]].transpose(1, 0, 2)
    (p, q), (r, s) = (b - a).T, (c - a).T
    areas = p * s - q * r
    assert areas.min() > 0.2 * np.median(areas)
    weights = np.array([v.groups[0].weight for v in ob.data.vertices])
    assert np.abs(weights - (0.5 + 0.4 * after[:, 0] / np.abs(points[:, 0]).max())).max() < 1e-3
    up = np.array([point.co[:] for point in ob.data.shape_keys.key_blocks["Up"].data])
    assert np.abs(up - after - [0, 0, 2]).max() < 1e-4


def test_a_seam_of_the_uv_map_stays_a_seam():
    ob = sphere(32, 24)
    before = uv_of(ob)
    select_faces(ob, lambda at: abs(at.z) < 0.6 and at.x < -0.2)  # the map is torn along this side
    regrid()
    check(ob)
    at = uv_of(ob)
    for polygon in ob.data.polygons:
        assert np.ptp(at[list(polygon.loop_indices)], axis=0).max() < 0.3, "a face runs across the map"
    assert at.min() >= before.min() - 1e-6
    assert at.max() <= before.max() + 1e-6


def test_materials_smoothness_and_layers_of_faces_are_those_of_the_old_surface():
    ob = grid(8)
    for name in ("Red", "Blue"):
        ob.data.materials.append(bpy.data.materials.new(name))
    number = ob.data.attributes.new("Number", "INT", "FACE")
    for polygon in ob.data.polygons:
        polygon.material_index = number.data[polygon.index].value = int(polygon.center.x > 0)
        polygon.use_smooth = polygon.center.x > 0
    select_faces(ob, lambda at: at.length < 2.9)
    regrid()
    check(ob, closed=False)
    number = ob.data.attributes["Number"]
    seen = set()
    for polygon in ob.data.polygons:
        right = int(polygon.center.x > 0)
        if polygon.select and abs(polygon.center.x) < 0.6:
            continue  # on the border between both
        assert polygon.material_index == number.data[polygon.index].value == right
        assert polygon.use_smooth == bool(right)
        seen.add((polygon.select, right))
    assert len(seen) == 4


def test_several_areas_and_several_meshes_at_once():
    one, other = sphere(), suzanne()
    other.location.x = 3
    activate(one, other)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, False, True)
    bpy.ops.mesh.select_all(action="DESELECT")
    for ob in (one, other):
        bm = bmesh.from_edit_mesh(ob.data)
        for face in bm.faces:
            face.select_set(abs(face.calc_center_median().z) > (0.55 if ob == one else 0.7))
        bmesh.update_edit_mesh(ob.data)
    regrid()
    for ob in (one, other):
        assert len(check(ob, closed=ob == one)) > 20
    z = vertices(one.data)[np.unique(patch_of(one))][:, 2]
    assert z.min() < -0.9
    assert z.max() > 0.9


def test_without_keeping_the_shape_the_area_is_smoothed_over():
    ob = grid(10)
    bump = [vertex for vertex in ob.data.vertices if vertex.co.length < 1.5]
    for vertex in bump:
        vertex.co.z = 1.0
    select_faces(ob, lambda at: at.length < 3.5)
    regrid(keep_shape=False)
    check(ob, closed=False)
    assert np.abs(vertices(ob.data)[:, 2]).max() < 0.05


def test_areas_become_quads():
    """An area of a sphere, with what it carries."""
    ob = sphere()
    points = vertices(ob.data)
    group = ob.vertex_groups.new(name="Bone")
    for vertex in ob.data.vertices:
        group.add([vertex.index], float(0.5 + 0.4 * points[vertex.index, 0]), "REPLACE")
    select_faces(ob, lambda at: at.x > 0.3)
    regrid(cells="QUADS")
    patch = check(ob)
    assert {len(face) for face in patch} == {4}
    new = np.unique(patch)
    radius = np.linalg.norm(vertices(ob.data)[new], axis=1)
    assert radius.min() > 0.97
    assert radius.max() < 1 + 1e-6
    weights = [ob.data.vertices[v].groups[0].weight for v in new]
    assert np.abs(np.array(weights) - (0.5 + 0.4 * vertices(ob.data)[new, 0])).max() < 0.02
    assert np.isfinite(uv_of(ob)).all()


def mouth():
    """Select what lies around Suzanne's mouth, nose included."""
    ob = suzanne()
    at = vertices(ob.data)
    lip = np.linalg.norm(at - (0.0, -0.8, -0.5), axis=1).argmin()
    select_faces(ob, lambda centre: (centre - ob.data.vertices[lip].co).length < 0.2)
    for _ in range(3):
        bpy.ops.mesh.select_more()


def test_lost_shape_is_told(capfd):
    ob = suzanne()
    select_faces(ob, lambda centre: centre.x > 0.75)
    regrid()
    assert "1 area lost shape" in capfd.readouterr().out
    mouth()
    regrid()
    assert "1 area lost shape: the new faces are up to 0." in capfd.readouterr().out
    ob = sphere()
    select_faces(ob, lambda centre: centre.z > 0.3)
    regrid()
    assert "lost shape" not in capfd.readouterr().out


def test_refusals_say_what_is_selected():
    ob = sphere()
    select_faces(ob, lambda _centre: True)
    assert "not the whole of a closed mesh" in refused()
    ob = sphere()
    bm = edit(ob, mode="VERT")
    select(ob, bm.verts[:1])
    assert "Only vertices are selected" in refused()
    ob = sphere()
    bm = edit(ob, mode="FACE")
    for face in bm.faces:
        face.hide_set(face.calc_center_median().z > 0.8)
    select(ob, [face for face in bm.faces if not face.hide and face.calc_center_median().z > 0.2])
    assert "reveal them first" in refused()


def test_one_undo_step(capfd):
    ob = sphere()
    select_faces(ob, lambda at: at.x > 0.3)
    bpy.ops.ed.undo_push(message="before")
    before = len(bmesh.from_edit_mesh(ob.data).faces)
    assert bpy.ops.mesh.gridmesh_regrid("EXEC_DEFAULT", True) == {"FINISHED"}
    assert "Meshed 1 area anew: " in capfd.readouterr().out
    bpy.ops.ed.undo()
    ob = bpy.context.object
    assert len(bmesh.from_edit_mesh(ob.data).faces) == before


class TestRefusals:
    def test_nothing_selected(self):
        edit(sphere())
        assert "closed loop" in refused()

    def test_a_line_encloses_nothing(self):
        ob = sphere()
        bm = edit(ob)
        select(
            ob,
            [
                edge
                for edge in bm.edges
                if all(v.co.z > 0.2 and v.co.y > -1e-3 and abs(v.co.x) < 1e-3 for v in edge.verts)
            ],
        )
        assert "enclose no area" in refused()

    def test_a_ring_is_no_disk(self):
        ob = sphere()
        select_faces(ob, lambda at: abs(at.z) < 0.5)
        assert "borders" in refused()

    def test_a_ring_and_a_disk_give_the_disk_and_name_the_ring(self, capfd):
        one = sphere()
        select_faces(one, lambda at: abs(at.z) < 0.3 or at.z > 0.8)
        regrid()
        check(one)
        assert "1 area left out" in capfd.readouterr().out

    def test_a_scale_of_zero(self):
        ob = sphere()
        ob.scale.z = 0
        select_faces(ob, lambda at: at.x > 0.3)
        assert "thickness" in refused()


def test_the_nearest_place_on_the_edges_of_triangles():
    triangles = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[5, 0, 0], [6, 0, 0], [5, 1, 0]]], float)
    at, weights = nearest_on_edges(triangles, np.array([0.25, -1.0, 0.0]))
    assert at == 0
    assert np.allclose(weights, [0.75, 0.25, 0])
    at, weights = nearest_on_edges(triangles, np.array([5.0, 3.0, 0.0]))
    assert at == 1
    assert np.allclose(weights, [0, 0, 1])
