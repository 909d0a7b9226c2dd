"""`mesh.gridmesh_bridge` on real loops: geometry, data, undo, refusals."""

from collections import Counter
from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
import pytest
from drawings import activate, fingerprint, vertices
from holes import Before, cylinder, edit, faces_of, grid, leave, rim, select, without_faces
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from addon.fill import patches


def bridge(**options):
    assert bpy.ops.mesh.gridmesh_bridge(**options) == {"FINISHED"}


def two_pipes(n=16, m=24, height=3.0):
    """Two open cylinders in one mesh, one above the other."""
    lower = cylinder(n, depth=1.0)
    upper = cylinder(m, depth=1.0, location=(0, 0, height))
    upper.select_set(True)
    lower.select_set(True)
    bpy.context.view_layer.objects.active = lower
    bpy.ops.object.join()
    return lower


def facing(bm):
    """Edges of the two rims that face each other."""
    heights = sorted({round(edge.verts[0].co.z, 4) for edge in rim(bm)})
    return [edge for edge in rim(bm) if round(edge.verts[0].co.z, 4) in heights[1:3]]


def is_closed_but_for(ob, rims):
    edges = Counter(
        frozenset(e) for face in faces_of(ob.data) for e in zip(face, face[1:] + face[:1], strict=True)
    )
    assert max(edges.values()) == 2
    return sum(n == 1 for n in edges.values()) == rims


@pytest.mark.smoke
@pytest.mark.parametrize("smooth", ["FLAT", "TANGENT", "CURVATURE"])
@pytest.mark.parametrize(("n", "m"), [(16, 16), (16, 24), (9, 40)])
def test_two_rims_are_joined(n, m, smooth, capfd):
    ob = two_pipes(n, m)
    before, n_faces = vertices(ob.data), len(ob.data.polygons)
    bm = edit(ob)
    select(ob, facing(bm))
    bridge(smooth=smooth)
    bm = bmesh.from_edit_mesh(ob.data)
    bm.faces.index_update()
    assert all(face.select == (face.index >= n_faces) for face in bm.faces)
    leave()
    assert is_closed_but_for(ob, n + m)
    assert np.array_equal(vertices(ob.data)[: len(before)], before)
    told = capfd.readouterr().out
    assert "Joined by " in told
    assert " rows: " in told
    sides = Counter(e for face in faces_of(ob.data) for e in zip(face, face[1:] + face[:1], strict=True))
    assert max(sides.values()) == 1, "wound against a neighbour"


def test_a_single_edge_of_each_rim_is_enough_and_rows_are_kept():
    ob = two_pipes()
    bm = edit(ob)
    edges = facing(bm)
    select(ob, [min(edges, key=lambda e: e.verts[0].co.z), max(edges, key=lambda e: e.verts[0].co.z)])
    bridge(rows=3)
    leave()
    assert is_closed_but_for(ob, 40)


@pytest.mark.parametrize(("n", "m", "poles"), [(16, 16, 0), (16, 20, 2), (16, 21, 1)])
def test_quads_join_two_rims(n, m, poles, capfd):
    ob = two_pipes(n, m)
    bm = edit(ob)
    select(ob, facing(bm))
    n_faces = len(bm.faces)
    bridge(cells="QUADS", rows=6)
    leave()
    assert is_closed_but_for(ob, n + m)
    new = [len(face) for face in faces_of(ob.data)[n_faces:]]
    assert new.count(3) == (n + m) % 2
    assert new.count(4) == len(new) - (n + m) % 2
    told = capfd.readouterr().out
    assert "Joined by 6 rows: " in told
    assert f" {poles} irregular vert" in told


def test_twist_is_of_use():
    places = []
    for twist in (0.0, 0.4):
        ob = two_pipes()
        bm = edit(ob)
        select(ob, facing(bm))
        bridge(twist=twist)
        leave()
        places.append(vertices(ob.data))
    assert not np.allclose(*places)


def test_data_of_both_sides_goes_on():
    ob = two_pipes()
    group = ob.vertex_groups.new(name="up")
    top = [v.index for v in ob.data.vertices if v.co.z > 1.5]
    group.add(top, 1.0, "REPLACE")
    colour = ob.data.color_attributes.new("Colour", "FLOAT_COLOR", "POINT")
    for index, vertex in enumerate(ob.data.vertices):
        colour.data[index].color = (1, 0, 0, 1) if vertex.co.z > 1.5 else (0, 0, 1, 1)
    key = ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Longer")
    for index in top:
        key.data[index].co.z += 2.0
    n = len(ob.data.vertices)
    bm = edit(ob)
    select(ob, facing(bm))
    bridge()
    leave()
    new = ob.data.vertices[n:]
    assert len(new) > 20
    heights = np.array([v.co.z for v in new])
    share = (heights - heights.min()) / np.ptp(heights)
    weights = np.array([next((g.weight for g in v.groups), 0.0) for v in new])
    red = np.array([ob.data.color_attributes["Colour"].data[v.index].color[0] for v in new])
    moved = np.array([ob.data.shape_keys.key_blocks["Longer"].data[v.index].co.z for v in new]) - heights
    for values, most in [(weights, 1), (red, 1), (moved, 2)]:
        assert values.min() >= -1e-6
        assert values.max() <= most + 1e-6
        assert np.corrcoef(share, values)[0, 1] > 0.95


def test_uvs_go_on_on_both_sides():
    ob = two_pipes()
    layer = ob.data.uv_layers.active or ob.data.uv_layers.new()
    for loop in ob.data.loops:
        co = ob.data.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (0.5, co.z)
    n_faces = len(ob.data.polygons)
    bm = edit(ob)
    select(ob, facing(bm))
    bridge()
    leave()
    layer = ob.data.uv_layers.active
    low, high = 0.5, 2.5
    for face in list(ob.data.polygons)[n_faces:]:
        for at in face.loop_indices:
            u, v = layer.data[at].uv
            assert abs(u - 0.5) < 1e-5
            assert low - 1e-4 <= v <= high + 1e-4
            z = ob.data.vertices[ob.data.loops[at].vertex_index].co.z
            assert abs(v - z) < 0.25


def test_two_wires():
    mesh = bpy.data.meshes.new("wires")
    ring = lambda n, z: [(np.cos(6.2832 * k / n), np.sin(6.2832 * k / n), z) for k in range(n)]  # noqa: E731
    edges = [(k, (k + 1) % 8) for k in range(8)] + [(8 + k, 8 + (k + 1) % 11) for k in range(11)]
    mesh.from_pydata(ring(8, 0) + ring(11, 1), edges, [])
    ob = bpy.data.objects.new("wires", mesh)
    bpy.context.scene.collection.objects.link(ob)
    activate(ob)
    edit(ob)
    bpy.ops.mesh.select_all(action="SELECT")
    bridge()
    leave()
    assert is_closed_but_for(ob, 19)


# --------------------------------------------------------------------------------------------- several loops


def pipes(*ends, name="pipes"):
    """Open pipes of one segment, each of (edges around, end, radius, direction away from it), in one mesh."""
    points, faces, loops = [], [], []
    for n, end, radius, way in ends:
        first, way = len(points), np.array(way, float)
        u = np.cross(way, [1, 0, 0] if abs(way[0]) < abs(way[1]) + abs(way[2]) else [0, 0, 1])
        u /= np.linalg.norm(u)
        v = np.cross(way, u) / np.linalg.norm(way)
        turns = 2 * np.pi * np.arange(n) / n
        ring = np.array(end) + radius * (np.outer(np.cos(turns), u) + np.outer(np.sin(turns), v))
        points += [*ring.tolist(), *(ring + way).tolist()]
        for k in range(n):
            a, b = first + k, first + (k + 1) % n
            faces.append((a, b, b + n, a + n))
        loops.append(list(range(first, first + n)))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(ob)
    return ob, loops


def trousers(counts=(16, 24, 31), **options):
    """Two legs whose upper rims lie in one plane, and a waist above them."""
    legs, waist, wide = counts
    return pipes(
        (legs, (-1.6, 0, 0), 1.0, (0, 0, -1)),
        (waist, (1.6, 0, 0), 1.0, (0, 0, -1)),
        (wide, (0, 0, 2.5), 2.2, (0, 0, 1)),
        **options,
    )


def star(counts):
    """Pipes whose ends look at each other, around a ring, each of its own width."""
    turns = 2 * np.pi * np.arange(len(counts)) / len(counts)
    ways = np.c_[np.cos(turns), np.sin(turns), 0.3 * np.cos(2 * turns)]
    return pipes(
        *((n, 2.5 * way, 0.7 + 0.1 * k, way) for k, (n, way) in enumerate(zip(counts, ways, strict=True)))
    )


def edges_of(bm, loop):
    """Edges of a loop of vertex numbers."""
    return [bm.edges.get([bm.verts[a], bm.verts[b]]) for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)]


def choose(ob, loops):
    bm = edit(ob)
    select(ob, [edge for loop in loops for edge in edges_of(bm, loop)])


def check_patch(ob, before, loops, **options):
    """The mesh as it was, and a patch with the loops as its boundary: a sphere with as many holes."""
    patch = before.check(ob, closed=False, **options)
    edges = Counter(frozenset(e) for f in patch for e in zip(f, [*f[1:], f[0]], strict=True))
    own = {frozenset(e) for loop in loops for e in zip(loop, [*loop[1:], loop[0]], strict=True)}
    assert {edge for edge, uses in edges.items() if uses == 1} == own
    used = {vertex for face in patch for vertex in face}
    assert used == {v for loop in loops for v in loop} | set(range(len(before.points), len(ob.data.vertices)))
    assert len(used) - len(edges) + len(patch) == 2 - len(loops)
    return patch


SHAPES = {
    "trousers": trousers,  # unequal counts, two of the loops in one plane
    "equal": lambda: star((20, 20, 20)),
    "unequal": lambda: star((9, 40, 17, 24)),
    "five": lambda: star((14, 22, 18, 26, 12)),
}


@pytest.mark.smoke
@pytest.mark.parametrize("smooth", ["FLAT", "TANGENT", "CURVATURE"])
@pytest.mark.parametrize("shape", SHAPES)
def test_several_loops_get_one_patch(shape, smooth, capfd):
    ob, loops = SHAPES[shape]()
    before = Before(ob)
    choose(ob, loops)
    bridge(smooth=smooth)
    leave()
    check_patch(ob, before, loops)
    told = capfd.readouterr().out
    assert f"Joined {len(loops)} loops: " in told
    assert "left out" not in told
    if smooth == "TANGENT":
        assert "Warning" not in told


def test_a_single_edge_of_each_of_three_rims_is_enough():
    ob, loops = trousers()
    before = Before(ob)
    bm = edit(ob)
    select(ob, [edges_of(bm, loop)[0] for loop in loops])
    bridge()
    leave()
    check_patch(ob, before, loops)


def test_three_loops_with_vertices_selected():
    ob, loops = trousers()
    before = Before(ob)
    bm = edit(ob, mode="VERT")
    select(ob, [bm.verts[index] for loop in loops for index in loop])
    bridge()
    leave()
    check_patch(ob, before, loops)


@pytest.mark.parametrize("counts", [(16, 16, 28), (11, 8, 20), (16, 21, 28)])
def test_quads_join_three_loops(counts):
    ob, loops = trousers(counts)
    before = Before(ob)
    choose(ob, loops)
    bridge(cells="QUADS")
    leave()
    patch = check_patch(ob, before, loops, triangles=False)
    odd = sum(map(len, loops)) % 2
    assert sorted({len(face) for face in patch}) == ([3, 4] if odd else [4])
    assert sum(len(face) == 3 for face in patch) == odd


@pytest.mark.parametrize("cells", ["TRIANGLES", "QUADS"])
def test_three_holes_of_a_plate_get_tubes_that_come_together_above_it(cells, capfd):
    """It lay in the plate, and went through itself."""
    ob = without_faces(grid(15), lambda c: not any(abs(c.x - x) < 1.1 and abs(c.y) < 1.1 for x in (-4, 0, 4)))
    before = Before(ob)
    bm = edit(ob)
    inner = [e for e in rim(bm) if all(max(abs(v.co.x), abs(v.co.y)) < 6.9 for v in e.verts)]
    around = {v.index for e in inner for v in e.verts}
    select(ob, inner)
    bridge(cells=cells)
    leave()
    patch = before.check(ob, closed=False, triangles=cells == "TRIANGLES")
    assert around <= {vertex for face in patch for vertex in face}
    assert is_closed_but_for(ob, 60)
    new = vertices(ob.data)[len(before.points) :]
    assert new[:, 2].min() > -0.1
    assert new[:, 2].max() > 2
    assert "Warning" not in capfd.readouterr().out


def test_three_wires():
    ob, loops = trousers((11, 8, 20))
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bm.verts.ensure_lookup_table()
    own = {index for loop in loops for index in loop}
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if v.index not in own], context="VERTS")
    for vertices_of in ((0, 11), (11, 19), (19, 39)):
        bm.verts.ensure_lookup_table()
        ring = [bm.verts[k] for k in range(*vertices_of)]
        for a, b in zip(ring, [*ring[1:], ring[0]], strict=True):
            if bm.edges.get((a, b)) is None:
                bm.edges.new((a, b))
    bm.to_mesh(ob.data)
    bm.free()
    edit(ob)
    bpy.ops.mesh.select_all(action="SELECT")
    bridge()
    leave()
    assert is_closed_but_for(ob, 39)


def test_data_of_all_sides_goes_on():
    """A group, a colour and a shape key that only one of three pipes has: more of it where that is nearer."""
    ob, loops = star((16, 24, 31))
    n = len(ob.data.vertices)
    own = range(loops[2][0], n)
    group = ob.vertex_groups.new(name="third")
    group.add(list(own), 1.0, "REPLACE")
    colour = ob.data.color_attributes.new("Colour", "FLOAT_COLOR", "POINT")
    for index in range(n):
        colour.data[index].color = (1, 0, 0, 1) if index in own else (0, 0, 1, 1)
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Up")
    for index in own:
        key.data[index].co.z += 2.0
    choose(ob, loops)
    bridge()
    leave()
    places = vertices(ob.data)
    far = [np.linalg.norm(places[n:, None] - places[loop], axis=2).min(axis=1) for loop in loops]
    share = np.minimum(far[0], far[1]) / (np.minimum(far[0], far[1]) + far[2])
    new = ob.data.vertices[n:]
    assert len(new) > 20
    weights = np.array([next((g.weight for g in v.groups), 0.0) for v in new])
    red = np.array([ob.data.color_attributes["Colour"].data[v.index].color[0] for v in new])
    moved = np.array([ob.data.shape_keys.key_blocks["Up"].data[v.index].co.z - v.co.z for v in new])
    for values in (weights, red):
        assert values.min() >= -1e-6
        assert values.max() <= 1 + 1e-6
        assert np.corrcoef(share, values)[0, 1] > 0.9
    assert np.corrcoef(share, moved)[0, 1] > 0.9
    assert moved[far[2].argmin()] > 1.4
    assert abs(moved[np.minimum(far[0], far[1]).argmin()]) < 0.6


def test_data_that_is_not_finite_is_left_out_and_told(capfd):
    ob, loops = trousers()
    for name in ("Bad", "Good"):
        ob.data.attributes.new(name, "FLOAT", "POINT")
    bad, good = ob.data.attributes["Bad"], ob.data.attributes["Good"]
    for index in range(len(ob.data.vertices)):
        good.data[index].value = 2.0
        bad.data[index].value = float("nan") if index == loops[2][5] else 1.0
    n = len(ob.data.vertices)
    choose(ob, loops)
    bridge()
    leave()
    assert "1 layer of data not continued: a value at a loop is not finite" in capfd.readouterr().out
    values = [item.value for item in ob.data.attributes["Good"].data]
    assert values[n:] == pytest.approx([2.0] * (len(values) - n))


def test_uvs_go_on_on_all_sides():
    ob, loops = trousers()
    layer = ob.data.uv_layers.new()
    for loop in ob.data.loops:
        co = ob.data.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (co.x, co.z)
    n_faces = len(ob.data.polygons)
    choose(ob, loops)
    bridge()
    leave()
    layer = ob.data.uv_layers.active
    on_loops = {vertex for loop in loops for vertex in loop}
    ends = vertices(ob.data)[sorted(on_loops)]
    low, high = ends.min(axis=0), ends.max(axis=0)
    for face in list(ob.data.polygons)[n_faces:]:
        for at in face.loop_indices:
            u, v = layer.data[at].uv
            assert low[0] - 1e-4 <= u <= high[0] + 1e-4
            assert low[2] - 1e-4 <= v <= high[2] + 1e-4
            vertex = ob.data.loops[at].vertex_index
            if vertex in on_loops:
                co = ob.data.vertices[vertex].co
                assert (u, v) == pytest.approx((co.x, co.z), abs=1e-5)


def test_three_loops_are_joined_in_one_undo_step():
    ob, loops = trousers()
    name, before = ob.name, (len(ob.data.vertices), len(ob.data.polygons))
    choose(ob, loops)
    bpy.ops.ed.undo_push(message="base")
    assert bpy.ops.mesh.gridmesh_bridge("EXEC_DEFAULT", True) == {"FINISHED"}
    bpy.ops.ed.undo()
    leave()
    mesh = bpy.data.objects[name].data
    assert (len(mesh.vertices), len(mesh.polygons)) == before


def test_two_meshes_at_once_each_for_itself(capfd):
    """One with three loops, one with two: the second has rows, which the first has not."""
    one, loops = trousers(name="one")
    other, pair = pipes((16, (9, 0, 0), 1, (0, 0, -1)), (24, (9, 0, 2), 1, (0, 0, 1)), name="other")
    before = [Before(one), Before(other)]
    activate(one, other)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, True, False)
    bpy.ops.mesh.select_all(action="DESELECT")
    for ob, own in ((one, loops), (other, pair)):
        bm = bmesh.from_edit_mesh(ob.data)
        bm.verts.ensure_lookup_table()
        select(ob, [edge for loop in own for edge in edges_of(bm, loop)])
    bridge(rows=3)
    leave()
    for ob, own, was in zip((one, other), (loops, pair), before, strict=True):
        check_patch(ob, was, own)
    told = capfd.readouterr().out
    assert "Joined 5 loops: " in told
    assert "are for two loops" not in told


def test_rows_and_twist_of_three_loops_are_told_to_do_nothing(capfd):
    places = []
    for options in ({}, {"rows": 3, "twist": 0.5}):
        ob, loops = trousers()
        choose(ob, loops)
        bridge(**options)
        leave()
        places.append(vertices(ob.data).tobytes())
        assert ("Rows and Twist are for two loops" in capfd.readouterr().out) == bool(options)
    assert places[0] == places[1]


def test_faces_that_look_the_other_way_are_told(capfd):
    """One pipe inside out: a patch between it and the others meets itself."""
    ob, loops = trousers()
    bm = edit(ob)
    bmesh.ops.reverse_faces(bm, faces=[f for f in bm.faces if all(v.index in range(32) for v in f.verts)])
    bmesh.update_edit_mesh(ob.data)
    leave()
    before = Before(ob)
    choose(ob, loops)
    bridge()
    leave()
    check_patch(ob, before, loops)
    assert "which way the faces at the loops look" in capfd.readouterr().out


# --------------------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("choose", "words"),
    [
        (lambda bm: [], "Nothing is selected; select two or more loops"),
        (lambda bm: facing(bm)[:1], "1 loop of open edges selected; select two or more"),
        (lambda bm: [*facing(bm)[:3], *facing(bm)[-3:]], "rows of edges are not joined"),
    ],
)
def test_other_selections_are_refused_and_change_nothing(choose, words, capfd):
    ob = two_pipes()
    bm = edit(ob)
    select(ob, choose(bm))
    leave()
    before = fingerprint()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.mesh.gridmesh_bridge()
    leave()
    assert fingerprint() == before


def test_faces_in_place_of_loops_are_refused():
    bpy.ops.mesh.primitive_uv_sphere_add()
    ob = bpy.context.object
    bm = edit(ob, mode="FACE")
    select(ob, [face for face in bm.faces if abs(face.calc_center_median().z) > 0.9])
    with pytest.raises(RuntimeError, match="delete them and select the loops that are left"):
        bpy.ops.mesh.gridmesh_bridge()
    leave()


def test_loops_of_two_objects_are_refused():
    pipes = [two_pipes(), two_pipes()]
    activate(*pipes)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, True, False)
    bpy.ops.mesh.select_all(action="DESELECT")
    for ob in pipes:
        bm = bmesh.from_edit_mesh(ob.data)
        select(ob, facing(bm)[:1])
    with pytest.raises(RuntimeError, match=r"of several objects; join these first \(Ctrl-J\)"):
        bpy.ops.mesh.gridmesh_bridge()
    leave()


def test_loops_with_a_common_vertex_are_refused():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=6)
    ob = without_faces(bpy.context.object, lambda c: not (abs(c.x - c.y) < 0.1 and abs(c.x + 0.5) < 0.6))
    edit(ob)
    bm = bmesh.from_edit_mesh(ob.data)
    inner = [e for e in rim(bm) if all(abs(v.co.x) < 2.9 and abs(v.co.y) < 2.9 for v in e.verts)]
    select(ob, inner)
    with pytest.raises(RuntimeError):
        bpy.ops.mesh.gridmesh_bridge()
    leave()


def test_three_loops_two_of_which_touch_are_refused_and_the_vertex_is_selected():
    """Two holes of a plate that meet in a vertex, and one apart."""
    holes = [(-2, -2), (-1, -1), (2, 2)]
    ob = without_faces(grid(7), lambda c: not any(abs(c.x - x) + abs(c.y - y) < 0.2 for x, y in holes))
    before = vertices(ob.data).tobytes(), faces_of(ob.data)
    bm = edit(ob, mode="VERT")
    # One edge of each hole: whole loops that touch were taken for one selection.
    middles = [Vector(place) for place in ((-2, -2.5, 0), (-1, -0.5, 0), (2, 2.5, 0))]
    select(
        ob, [min(rim(bm), key=lambda e: ((e.verts[0].co + e.verts[1].co) / 2 - at).length) for at in middles]
    )
    (shared,) = (v.index for v in bm.verts if sum(e.is_boundary for e in v.link_edges) == 4)
    words = f"2 of the loops pass through vertex {shared}; split it, or choose loops that are apart"
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.mesh.gridmesh_bridge()
    leave()
    assert [v.index for v in ob.data.vertices if v.select] == [shared]
    assert (vertices(ob.data).tobytes(), faces_of(ob.data)) == before


def test_three_loops_without_a_patch_are_told_and_stay_selected(monkeypatch):
    class Refused(ValueError):
        kind = "no_patch"

    def refuse(*_, **__):
        raise Refused("no valid mesh was found")

    ob, loops = trousers()
    before = vertices(ob.data).tobytes(), faces_of(ob.data)
    choose(ob, loops)
    module = SimpleNamespace(GridMeshError=Refused, fill_hole=refuse, look_apart=lambda *_: False)
    monkeypatch.setattr(patches, "native", lambda *_: module)
    with pytest.raises(RuntimeError, match="No triangles between these loops make one patch; subdivide"):
        bpy.ops.mesh.gridmesh_bridge()
    leave()
    assert {edge.index for edge in ob.data.edges if edge.select} == {
        edge.index for edge in ob.data.edges if any(set(edge.vertices) <= set(loop) for loop in loops)
    }
    assert (vertices(ob.data).tobytes(), faces_of(ob.data)) == before


# --------------------------------------------------------------------------------------------- pairs of loops


def whole_pipes(*them):
    """Open pipes along z in one mesh, each of (edges around, radius, middle, length), and both loops of each."""
    for n, radius, middle, length in them:
        cylinder(n, radius=radius, depth=length, location=middle)
    made = list(bpy.context.scene.objects)[-len(them) :]
    for ob in made:
        ob.select_set(True)
    bpy.context.view_layer.objects.active = made[0]
    if len(made) > 1:
        bpy.ops.object.join()
    return made[0]


BESIDE = ((24, 1.0, (-1.6, 0, 0), 2.0), (32, 1.2, (1.6, 0, 0), 2.2))
INSIDE = ((24, 1.0, (0, 0, 0), 2.0), (32, 1.6, (0, 0, 0), 2.0))
BEHIND = ((24, 1.0, (0, 0, -2), 2.0), (32, 1.2, (0, 0, 2), 2.0))


@pytest.mark.parametrize("cells", ["TRIANGLES", "QUADS"])
@pytest.mark.parametrize(("pipes_of", "left"), [(BESIDE, 0), (INSIDE, 0), (BEHIND, 56)])
def test_all_ends_of_two_pipes_are_joined_in_pairs(pipes_of, left, cells, capfd):
    ob = whole_pipes(*pipes_of)
    before, n_faces = vertices(ob.data), len(ob.data.polygons)
    choose_rims(ob)
    bridge(cells=cells)
    leave()
    assert np.array_equal(vertices(ob.data)[: len(before)], before)
    assert is_closed_but_for(ob, left)
    sides = Counter(e for face in faces_of(ob.data) for e in zip(face, face[1:] + face[:1], strict=True))
    told = capfd.readouterr().out
    # Both pipes look outward: joined to one wall, one of them looks the other way.
    turned = pipes_of is INSIDE
    assert max(sides.values()) == 1 + turned
    assert ("look the other way than the tube; recalculate" in told) == turned
    assert f"Joined {'1 pair' if left else '2 pairs'} of loops by " in told
    assert ("A tube between two of the loops would meet the mesh or itself" in told) == (left > 0)
    assert len(ob.data.polygons) > n_faces
    assert meetings(ob, n_faces) == 0


def choose_rims(ob):
    bm = edit(ob)
    select(ob, rim(bm))


def meetings(ob, first):
    """Pairs of faces that meet without a vertex in common, one of them new."""
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bm.faces.ensure_lookup_table()
    tree = BVHTree.FromBMesh(bm)
    corners = [{v.index for v in face.verts} for face in bm.faces]
    found = {tuple(sorted(pair)) for pair in tree.overlap(tree)}
    bm.free()
    return sum(b >= first and not corners[a] & corners[b] for a, b in found)


def test_how_loops_are_joined_can_be_chosen(capfd):
    ob, loops = star((20, 20, 20, 20))
    choose(ob, loops)
    bridge(connect="PAIRS", rows=5)
    leave()
    assert "Rows and Twist" not in (told := capfd.readouterr().out)
    assert "Joined 2 pairs of loops by 5 rows" in told
    assert is_closed_but_for(ob, 80)
    ob, loops = star((20, 20, 20, 20))
    choose(ob, loops)
    bridge(connect="ONE")
    leave()
    assert "Joined 4 loops: " in capfd.readouterr().out
    assert is_closed_but_for(ob, 80)


@pytest.mark.parametrize("pipes_of", [BESIDE, BEHIND])
def test_one_patch_that_would_have_to_turn_round_is_refused(pipes_of):
    ob = whole_pipes(*pipes_of)
    before = vertices(ob.data).tobytes(), faces_of(ob.data)
    choose_rims(ob)
    with pytest.raises(RuntimeError, match=r"look away from each other.*choose Pairs under Loops"):
        bpy.ops.mesh.gridmesh_bridge(connect="ONE")
    leave()
    assert (vertices(ob.data).tobytes(), faces_of(ob.data)) == before


@pytest.mark.parametrize("cells", ["TRIANGLES", "QUADS"])
def test_rings_that_lie_on_each_other_are_refused(cells):
    """A loose ring and its copy in place; the tube between them had no area."""
    mesh = bpy.data.meshes.new("rings")
    turns = 2 * np.pi * np.arange(16) / 16
    points = np.c_[np.cos(turns), np.sin(turns), 0 * turns]
    edges = [(k, (k + 1) % 16) for k in range(16)]
    mesh.from_pydata(
        np.vstack([points, points]).tolist(), [*edges, *((a + 16, b + 16) for a, b in edges)], []
    )
    ob = bpy.data.objects.new("rings", mesh)
    bpy.context.scene.collection.objects.link(ob)
    activate(ob)
    bm = edit(ob)
    select(ob, list(bm.edges))
    with pytest.raises(RuntimeError, match=r"touch at vertices .* merge the vertices by distance"):
        bpy.ops.mesh.gridmesh_bridge(cells=cells)
    leave()
    assert (len(mesh.vertices), len(mesh.edges), len(mesh.polygons)) == (32, 32, 0)


def test_a_loop_without_a_partner_is_told(capfd):
    ob, loops = trousers()
    choose(ob, loops)
    bridge(connect="PAIRS")
    leave()
    assert "1 loop is left over" in capfd.readouterr().out


def test_a_shape_key_goes_on_in_all_pairs():
    ob = whole_pipes(*INSIDE)
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Up")
    for point in key.data:
        point.co.z += 1.0
    n = len(ob.data.vertices)
    choose_rims(ob)
    bridge()
    leave()
    assert len(ob.data.vertices) > n + 20
    basis, moved = (np.array([p.co for p in block.data]) for block in ob.data.shape_keys.key_blocks)
    assert np.allclose(moved - basis, [0, 0, 1], atol=1e-5)


@pytest.mark.parametrize("cells", ["TRIANGLES", "QUADS"])
@pytest.mark.parametrize("smooth", ["FLAT", "TANGENT", "CURVATURE"])
def test_two_holes_in_a_ball_get_a_handle(smooth, cells, capfd):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=32)
    ob = bpy.context.object
    bm = edit(ob)
    holes = Vector((0.85, 0, 0.5)), Vector((0.85, 0, -0.5))
    gone = [f for f in bm.faces if min((f.calc_center_median() - hole).length for hole in holes) < 0.25]
    bmesh.ops.delete(bm, geom=gone, context="FACES")
    n_faces = len(bm.faces)
    select(ob, rim(bm))
    bridge(smooth=smooth, cells=cells)
    assert "No regular lattice" not in capfd.readouterr().out, "there is no irregular vertex"
    bm = bmesh.from_edit_mesh(ob.data)
    bm.faces.index_update()
    assert all(edge.is_manifold and edge.is_contiguous for edge in bm.edges)
    assert len(bm.verts) - len(bm.edges) + len(bm.faces) == 0, "one handle"
    new = [face for face in bm.faces if face.index >= n_faces]
    assert max(face.calc_center_median().x for face in new) > 1.2
    # Its outside is outside: where it is furthest out it looks away from the ball.
    assert max(new, key=lambda face: face.calc_center_median().x).normal.x > 0.5
    leave()
