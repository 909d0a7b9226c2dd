"""`mesh.gridmesh_fill` on real holes: geometry, selection, undo."""

import bmesh
import bpy
import gridmesh
import numpy as np
import pytest
from drawings import activate, fingerprint, linked, vertices
from holes import (
    Before,
    ball_with_hole,
    cylinder,
    edit,
    faces_of,
    fill,
    fill_as_user,
    grid,
    leave,
    rim,
    select,
    suzanne,
    without_faces,
)

from addon.ui import panels as ui


@pytest.mark.smoke
@pytest.mark.parametrize("smooth", ["FLAT", "TANGENT", "CURVATURE"])
def test_both_ends_of_a_cylinder(smooth, capfd):
    ob = cylinder(24)
    before = Before(ob)
    bm = edit(ob)
    select(ob, rim(bm))
    fill(smooth=smooth)
    assert bpy.context.mode == "EDIT_MESH"
    leave()
    patch = before.check(ob)
    told = capfd.readouterr().out
    assert f"Filled 2 holes: {len(patch)} triangles, " in told
    assert " irregular vert" in told
    assert " ms" in told


def test_result_is_the_one_of_the_module():
    ob = ball_with_hole()
    mesh = ob.data
    mesh.calc_loop_triangles()
    triangles = np.array([t.vertices[:] for t in mesh.loop_triangles], np.int32)
    polygons = np.array([t.polygon_index for t in mesh.loop_triangles], np.int32)
    n, n_faces = len(mesh.vertices), len(mesh.polygons)
    (expected,) = gridmesh.fill_holes(vertices(mesh), triangles, polygons=polygons)
    bm = edit(ob)
    select(ob, rim(bm)[:1])
    fill()
    leave()
    assert np.allclose(vertices(mesh)[n:], expected.vertices, rtol=0, atol=1e-6)
    ours = [frozenset(face) for face in faces_of(mesh)[n_faces:]]
    assert ours == [frozenset(face) for face in expected.triangles.tolist()]


@pytest.mark.parametrize("n", [3, 4, 5, 6, 7, 8, 9, 13, 31])
def test_any_number_of_edges(n):
    ob = cylinder(n)
    before = Before(ob)
    edit(ob)
    fill(holes="ALL")
    leave()
    before.check(ob)


@pytest.mark.smoke
def test_eye_sockets_of_suzanne():
    ob = suzanne()
    assert len(rim_of(ob))
    before = Before(ob)
    edit(ob)
    fill(holes="ALL", max_edges=0)
    leave()
    before.check(ob)


def test_ball_stays_a_ball():
    ob = ball_with_hole(48, 24)
    before = Before(ob)
    bm = edit(ob)
    select(ob, rim(bm)[:1])
    fill(smooth="TANGENT")
    leave()
    before.check(ob)
    radius = np.linalg.norm(vertices(ob.data)[len(before.points) :], axis=1)
    assert abs(radius - 1).max() < 0.1


def height_of(vertex):
    return 0.3 * np.sin(vertex.co.x) * np.cos(vertex.co.y)


@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize("max_edges", [0, 100])
def test_all_holes_of_a_sheet_but_its_outer_border(bent, max_edges, capfd):
    ob = without_faces(grid(6), lambda c: max(abs(c.x), abs(c.y)) > 1)
    for vertex in ob.data.vertices if bent else ():
        vertex.co.z = height_of(vertex)
    before = Before(ob)
    edit(ob)
    fill(holes="ALL", max_edges=max_edges)
    leave()
    before.check(ob, closed=False)
    outer = rim_of(ob)
    assert len(outer) == 24
    told = capfd.readouterr().out
    assert "Filled 1 hole: " in told
    assert "1 outer border left open, inside which the mesh lies already; select a border to fill it" in told


def test_a_sheet_without_a_hole_has_none_and_its_border_is_filled_if_selected(capfd):
    ob = grid(4)
    edit(ob)
    assert bpy.ops.mesh.gridmesh_fill(holes="ALL") == {"CANCELLED"}
    assert "1 outer border left open" in capfd.readouterr().out
    leave()
    assert len(rim_of(ob)) == 16
    bm = edit(ob)
    select(ob, rim(bm))
    fill()
    leave()
    assert len(rim_of(ob)) == 0


class TestSelection:
    def hole(self, **options):
        """A grid with two holes of four edges, in Edit Mode."""
        gone = ((1.5, 0.5), (-1.5, -1.5))
        ob = without_faces(grid(6), lambda c: (round(c.x, 1), round(c.y, 1)) not in gone)
        before = Before(ob)
        return ob, edit(ob, **options), before

    def inner(self, bm):
        return [edge for edge in rim(bm) if all(max(abs(v.co.x), abs(v.co.y)) < 2.9 for v in edge.verts)]

    def n_filled(self, ob, before):
        leave()
        before.check(ob, closed=False)
        return len(rim_of(ob))

    def test_single_vertex(self):
        ob, bm, before = self.hole(mode="VERT")
        select(ob, [self.inner(bm)[0].verts[0]])
        fill()
        assert self.n_filled(ob, before) == 24 + 4

    def test_single_edge(self):
        ob, bm, before = self.hole()
        select(ob, [self.inner(bm)[0]])
        fill()
        assert self.n_filled(ob, before) == 24 + 4

    def test_both_at_once(self, capfd):
        ob, bm, before = self.hole()
        select(ob, self.inner(bm))
        fill()
        assert self.n_filled(ob, before) == 24
        assert "Filled 2 holes" in capfd.readouterr().out

    def test_all_up_to_a_size(self, capfd):
        ob, _, before = self.hole()
        fill(holes="ALL", max_edges=10)
        assert self.n_filled(ob, before) == 24
        told = capfd.readouterr().out
        assert "Filled 2 holes" in told
        assert "1 hole with more than 10 edges left open; raise Max Edges" in told

    def test_face_beside_a_hole(self):
        ob, bm, before = self.hole(mode="FACE")
        beside = next(edge for edge in self.inner(bm) if all(abs(v.co.x - 1) < 0.01 for v in edge.verts))
        select(ob, beside.link_faces)
        fill()
        assert self.n_filled(ob, before) == 24 + 4

    def test_everything_selected_fills_every_hole(self):
        ob, bm, before = self.hole(mode="VERT")
        select(ob, bm.verts)
        fill()
        leave()
        before.check(ob)

    def test_hidden_holes_stay(self, capfd):
        ob, bm, _ = self.hole(mode="VERT")
        first = self.inner(bm)[0]
        around = {face for v in first.verts for face in v.link_faces}
        for vertex in {v for face in around for v in face.verts}:
            vertex.hide_set(True)
        bmesh.update_edit_mesh(ob.data)
        fill(holes="ALL", max_edges=10)
        assert "Filled 1 hole:" in capfd.readouterr().out
        leave()
        assert len(rim_of(ob)) == 24 + 4
        assert sum(v.hide for v in ob.data.vertices) > 0

    def test_hidden_faces_stay_hidden(self):
        ob, bm, _ = self.hole(mode="FACE")
        far = [f for f in bm.faces if f.calc_center_median().y > 2]
        for face in far:
            face.hide_set(True)
        bmesh.update_edit_mesh(ob.data)
        hidden = sum(f.hide for f in bm.faces)
        select(ob, [self.inner(bm)[0].link_faces[0]])
        fill()
        leave()
        assert sum(p.hide for p in ob.data.polygons) == hidden


def rim_of(ob):
    """Indices of open edges."""
    sides = np.empty(len(ob.data.loops), np.int32)
    ob.data.loops.foreach_get("edge_index", sides)
    return np.flatnonzero(np.bincount(sides, minlength=len(ob.data.edges)) == 1)


def wire(points, edges, name="Wire"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(points, float).tolist(), edges, [])
    return linked(name, mesh)


def ring(n, radius=1.0):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.stack([radius * np.cos(t), radius * np.sin(t), 0.1 * np.sin(2 * t)], axis=1)


def test_wire_loop():
    ob = wire(ring(20), [(k, (k + 1) % 20) for k in range(20)])
    bm = edit(ob)
    select(ob, bm.edges)
    fill()
    leave()
    mesh = ob.data
    assert np.array_equal(vertices(mesh)[:20], ring(20).astype(np.float32))
    assert not mesh.validate()
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 1


def test_open_chain_closed():
    ob = wire(ring(20), [(k, k + 1) for k in range(19)])
    bm = edit(ob)
    select(ob, bm.edges)
    fill(close_chains=True)
    leave()
    mesh = ob.data
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 1
    assert frozenset((0, 19)) in {frozenset(edge.vertices) for edge in mesh.edges}


def test_a_notch_is_closed_by_a_straight_edge():
    ob = grid(6)
    without_faces(ob, lambda centre: not (centre.y > 1 and abs(centre.x) < 1))
    bm = edit(ob)
    chosen = [
        edge for edge in rim(bm) if all(abs(vertex.co.x) < 1.1 and vertex.co.y > 0.9 for vertex in edge.verts)
    ]
    before = len(ob.data.polygons)
    select(ob, chosen)
    fill(close_chains=True)
    leave()
    mesh = ob.data
    assert not mesh.validate()
    assert len(mesh.polygons) > before
    assert np.abs(vertices(mesh)).max() < 3.01
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 1


def test_what_a_mirror_closes_is_left_open(capfd):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16)
    ob = bpy.context.object
    without_faces(ob, lambda centre: centre.x > 0 and centre.x < 0.9)
    ob.modifiers.new("Mirror", "MIRROR")
    edit(ob)
    assert fill(holes="ALL") is None
    leave()
    told = capfd.readouterr().out
    assert "Filled 1 hole" in told
    assert "1 hole left open at the plane of a Mirror modifier" in told
    assert vertices(ob.data)[:, 0].min() > -1e-6


def test_a_hole_across_the_plane_of_a_mirror_is_left_open(capfd):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16)
    ob = bpy.context.object
    without_faces(ob, lambda centre: 0 < centre.x < 0.9 and np.hypot(centre.x, centre.z) + centre.y > 0)
    ob.modifiers.new("Mirror", "MIRROR")
    edit(ob)
    assert fill(holes="ALL") is None
    leave()
    told = capfd.readouterr().out
    assert "Filled 1 hole" in told  # the one beside the plane
    assert "1 hole left open across the plane of a Mirror modifier; apply the modifier" in told
    assert vertices(ob.data)[:, 0].min() > -1e-6
    bpy.ops.object.modifier_apply(modifier="Mirror")
    assert len(rim(edit(ob))) > 0
    fill(holes="ALL")
    assert not rim(bmesh.from_edit_mesh(ob.data))
    leave()
    assert abs(vertices(ob.data)[:, 0].min() + vertices(ob.data)[:, 0].max()) < 1e-5


def test_several_meshes_at_once(capfd):
    first, second, idle = cylinder(12), cylinder(9, location=(4, 0, 0)), grid(3)
    befores = Before(first), Before(second), Before(idle)
    activate(first, second, idle)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    for ob in (first, second):
        bm = bmesh.from_edit_mesh(ob.data)
        select(ob, rim(bm))
    fill()
    leave()
    assert "Filled 4 holes" in capfd.readouterr().out
    befores[0].check(first)
    befores[1].check(second)
    assert len(idle.data.polygons) == len(befores[2].faces)


TRANSFORMS = {
    "moved far": ((1e5, 0, 0), (1, 1, 1)),
    "stretched": ((0, 0, 0), (5, 0.2, 1)),
    "mirrored": ((0, 0, 0), (-1, 1, 1)),
}


@pytest.mark.parametrize("name", TRANSFORMS)
def test_object_transform(name):
    place, scale = TRANSFORMS[name]
    ob = ball_with_hole()
    ob.location, ob.scale, ob.rotation_euler = place, scale, (0.3, 0.2, 0.1)
    bpy.context.view_layer.update()
    before = Before(ob)
    edit(ob)
    fill(holes="ALL")
    leave()
    before.check(ob)
    assert abs(vertices(ob.data)).max() < 1.3


def test_smoothness_is_that_of_the_world():
    """A ball squeezed by its object, and one whose mesh was squeezed, are filled alike."""
    ob = ball_with_hole()
    ob.scale = (1, 1, 0.3)
    bpy.context.view_layer.update()
    edit(ob)
    fill(holes="ALL")
    leave()
    by_object = vertices(ob.data) * [1, 1, 0.3]
    bpy.data.objects.remove(ob)
    ob = ball_with_hole()
    for vertex in ob.data.vertices:
        vertex.co.z *= 0.3
    edit(ob)
    fill(holes="ALL")
    leave()
    assert np.allclose(vertices(ob.data), by_object, atol=1e-4)


@pytest.mark.smoke
def test_one_undo_step():
    ob = cylinder(16)
    name, count = ob.name, len(ob.data.vertices)
    bm = edit(ob)
    select(ob, rim(bm))
    bpy.ops.ed.undo_push(message="base")
    fill_as_user()
    bpy.ops.ed.undo()
    leave()
    mesh = bpy.data.objects[name].data
    assert (len(mesh.vertices), len(mesh.polygons)) == (count, 16)


def test_again_after_undo_with_other_options():
    """What the redo panel does."""
    ob = cylinder(16)
    bm = edit(ob)
    select(ob, rim(bm))
    bpy.ops.ed.undo_push(message="base")
    fill_as_user(smooth="FLAT")
    bpy.ops.ed.undo()
    fill_as_user(smooth="CURVATURE")
    leave()
    assert not len(rim_of(bpy.data.objects["Cylinder"]))


def test_quads_go_on_through_the_rim(capfd):
    ob = grid(8)
    without_faces(ob, lambda c: max(abs(c.x), abs(c.y)) > 2)
    before = Before(ob)
    bm = edit(ob)
    select(ob, [edge for edge in rim(bm) if all(abs(v.co.x) < 3.9 and abs(v.co.y) < 3.9 for v in edge.verts)])
    fill(cells="QUADS")
    leave()
    patch = before.check(ob, closed=False, triangles=False)
    assert [len(face) for face in patch] == [4] * 16
    assert "Filled 1 hole: 16 quads, 0 irregular vertices" in capfd.readouterr().out
    points = vertices(ob.data)
    assert np.abs(points - np.round(points)).max() < 1e-2, "the grid that was there"


@pytest.mark.parametrize("n", [5, 12, 17])
def test_an_odd_hole_gets_one_triangle(n, capfd):
    ob = cylinder(n)
    edit(ob)
    fill(holes="ALL", max_edges=0, cells="QUADS")
    leave()
    patches = [len(polygon.vertices) for polygon in ob.data.polygons if polygon.select]
    assert patches.count(3) == 2 * (n % 2)
    assert patches.count(4) == len(patches) - 2 * (n % 2)
    assert not len(rim_of(ob))
    out = capfd.readouterr().out
    assert ("and 2 triangles" in out) == (n % 2 == 1)


def test_big_mesh_with_a_small_hole():
    ob = grid(200)
    without_faces(ob, lambda c: c.length > 5)
    before = len(ob.data.vertices)
    edit(ob)
    fill(holes="ALL", max_edges=100)
    leave()
    assert len(ob.data.vertices) > before
    assert len(rim_of(ob)) == 800


@pytest.mark.smoke
def test_menus_and_panel_are_there():
    for name in ui.FILL_MENUS:
        assert ui._fill_entry in getattr(bpy.types, name).draw._draw_funcs
    edit(cylinder())
    assert bpy.ops.mesh.gridmesh_fill.poll()
    leave()
    assert not bpy.ops.mesh.gridmesh_fill.poll()


def test_untouched_when_nothing_is_filled():
    ob = cylinder()
    edit(ob)
    before = fingerprint()
    with pytest.raises(RuntimeError, match="Nothing is selected; select the edges around a hole"):
        bpy.ops.mesh.gridmesh_fill()
    leave()
    bpy.ops.object.mode_set(mode="EDIT")
    assert fingerprint() == before
