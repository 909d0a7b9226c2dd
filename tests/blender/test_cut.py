"""`object.gridmesh_cut`: the pieces of real models, and what becomes of the scene."""

import bpy
import numpy as np
import pytest
from cuts import caps, check_sound, cut, drawn, is_closed, line, stroke_object, volume
from drawings import activate, circle, fingerprint, grease_pencil, mesh_objects, vertices, world_vertices
from holes import edit, faces_of, leave, suzanne

ACROSS = line((-3, 0, 0.1), (3, 0, 0.3))
"""Across the models, rising, seen along Y."""


def cube(**options):
    bpy.ops.mesh.primitive_cube_add(**options)
    return bpy.context.object


def ball(**options):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, **options)
    return bpy.context.object


def torus():
    bpy.ops.mesh.primitive_torus_add()
    return bpy.context.object


@pytest.mark.smoke
@pytest.mark.parametrize("edge_length", [0.0, 0.15])
@pytest.mark.parametrize("make", [cube, ball, torus])
def test_both_pieces_are_closed(make, edge_length):
    ob = make()
    whole = volume(ob)
    points = line((-3, 0, 0.1), (3, 0, 0.3), 40, wave=0.1)
    pieces = cut(ob, points, edge_length=edge_length)
    assert len(pieces) == 2
    for piece in pieces:
        check_sound(piece)
        assert caps(piece)
        assert volume(piece) > 0
    assert sum(map(volume, pieces)) == pytest.approx(whole, rel=1e-5 if edge_length == 0 else 0.02)


@pytest.mark.smoke
@pytest.mark.parametrize("smooth", ["FLAT", "TANGENT"])
@pytest.mark.parametrize("make", [cube, ball, torus])
def test_caps_of_quads(make, smooth, capfd):
    ob = make()
    pieces = cut(
        ob, line((-3, 0, 0.1), (3, 0, 0.3), 40, wave=0.1), edge_length=0.15, cells="QUADS", smooth=smooth
    )
    sizes = [[len(face.vertices) for face in caps(piece)] for piece in pieces]
    assert sizes[0] == sizes[1]
    assert set(sizes[0]) <= {3, 4}
    assert sizes[0].count(3) <= 2
    for piece in pieces:
        check_sound(piece)
    assert f": {2 * sizes[0].count(4)} quads" in capfd.readouterr().out


@pytest.mark.smoke
def test_caps_of_suzanne(capfd):
    """Below the eyes her head is closed all around the cut."""
    ob = suzanne()
    n_open = n_borders(ob)
    pieces = cut(ob, line((-3, 0, -0.5), (3, 0, -0.45)), edge_length=0.08)
    for piece in pieces:
        check_sound(piece, closed=False)
    assert sum(map(n_borders, pieces)) == n_open
    told = capfd.readouterr().out
    assert "2 pieces, 2 caps: " in told
    assert " irregular vert" in told
    assert told.count("Warning") == 0


def n_borders(ob):
    faces = faces_of(ob.data)
    pairs = {pair for face in faces for pair in zip(face, face[1:] + face[:1], strict=True)}
    return sum(pair[::-1] not in pairs for pair in pairs)


class TestSides:
    """Left and right are as a viewer sees them who looks along the direction."""

    @pytest.mark.parametrize(
        ("direction", "a", "b", "axis"),
        [
            ("Y", (-3, 0, 0), (3, 0, 0), 2),  # front view: drawn to the right, up is on the left
            ("Z", (-3, 0, 0), (3, 0, 0), 1),  # top view
            ("X", (0, -3, 0), (0, 3, 0), 2),  # right view
        ],
    )
    def test_left(self, direction, a, b, axis):
        ob = cube()
        (piece,) = cut(ob, line(a, b), direction=direction, keep="LEFT")
        assert vertices(piece.data)[:, axis].min() == pytest.approx(0, abs=1e-6)
        assert vertices(piece.data)[:, axis].max() == 1

    def test_right(self):
        ob = cube()
        cut(ob, ACROSS, keep="RIGHT")
        assert vertices(ob.data)[:, 2].min() == -1
        assert vertices(ob.data)[:, 2].max() < 0.3

    @pytest.mark.parametrize("clockwise", [False, True])
    @pytest.mark.parametrize("keep", ["LEFT", "RIGHT"])
    def test_closed_stroke(self, keep, clockwise):
        ob = cube()
        round_about = circle(40, 0.5)[:, [0, 2, 1]]
        points = round_about[::-1] if clockwise else round_about
        cut(ob, points, cyclic=True, keep=keep)
        check_sound(ob)
        inside = 2 * np.pi / 4 * np.sinc(2 / 40)
        assert volume(ob) == pytest.approx(inside if keep == "LEFT" else 8 - inside, rel=1e-4)

    def test_nearly_closed_stroke_is_closed(self):
        ob = cube()
        points = circle(40, 0.5)[:, [0, 2, 1]]
        cut(ob, points, keep="LEFT")
        assert np.abs(vertices(ob.data)[:, [0, 2]]).max() < 0.51

    def test_gap_closing_can_be_turned_off(self):
        ob = cube()
        points = circle(40, 0.5)[:, [0, 2, 1]]
        activate(ob, stroke_object(points))
        with pytest.raises(RuntimeError, match="stroke"):
            bpy.ops.object.gridmesh_cut(direction="Y", close_gaps=0.0)


class TestPieces:
    def test_larger_piece_keeps_the_object(self):
        ob = cube()
        _, other = cut(ob, line((-3, 0, -0.5), (3, 0, -0.5)))
        assert volume(ob) == pytest.approx(6)
        assert volume(other) == pytest.approx(2)
        assert other.name == "Cube.001"

    def test_together(self):
        ob = cube()
        assert cut(ob, ACROSS, pieces="TOGETHER") == [ob]
        check_sound(ob)
        assert volume(ob) == pytest.approx(8, rel=1e-5)
        # No vertex is in both.
        below = {i for face in faces_of(ob.data) for i in face if ob.data.vertices[i].co.z < -0.9}
        assert below
        assert len(islands(ob)) == 2

    def test_along_edges_of_the_mesh_together(self):
        """Old vertices on the cut are in both pieces: one of these gets copies."""
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4)
        ob = bpy.context.object
        cut(ob, line((-3, 0, 0), (3, 0, 0)), direction="Z", pieces="TOGETHER")
        check_sound(ob, closed=False)
        assert len(islands(ob)) == 2
        assert len(ob.data.polygons) == 16
        assert len(ob.data.vertices) == 30

    def test_gap(self):
        ob = cube()
        one, other = cut(ob, line((-3, 0, 0), (3, 0, 0)), gap=0.2)
        assert volume(one) + volume(other) == pytest.approx(8 - 0.8, rel=1e-5)
        assert {round(float(abs(vertices(piece.data)[:, 2]).min()), 5) for piece in (one, other)} == {0.1}

    def test_open(self):
        ob = cube()
        one, other = cut(ob, ACROSS, use_cap=False)
        assert not caps(one)
        assert not is_closed(one.data)
        assert not is_closed(other.data)

    def test_caps_are_mirror_images(self):
        ob = ball()
        one, other = cut(ob, ACROSS, edge_length=0.1)
        assert cap_points(one) == cap_points(other)

    def test_tangent_caps_bulge(self):
        ob = ball()
        (piece,) = cut(ob, line((-3, 0, 0.5), (3, 0, 0.5)), keep="RIGHT", edge_length=0.1, smooth="TANGENT")
        assert vertices(piece.data)[:, 2].max() > 0.6
        check_sound(piece)


def cap_points(ob):
    return {
        tuple(np.round(ob.data.vertices[i].co, 5).tolist()) for polygon in caps(ob) for i in polygon.vertices
    }


def islands(ob):
    parent = list(range(len(ob.data.vertices)))

    def root(i):
        while parent[i] != i:
            i = parent[i]
        return i

    for edge in ob.data.edges:
        a, b = edge.vertices
        parent[root(a)] = root(b)
    return {root(i) for i in parent}


def test_faces_that_are_not_met_stay():
    ob = ball()
    before = [tuple(map(tuple, (ob.data.vertices[i].co[:] for i in face))) for face in faces_of(ob.data)]
    cut(ob, ACROSS, keep="RIGHT", edge_length=0.1)
    after = [tuple(map(tuple, (ob.data.vertices[i].co[:] for i in face))) for face in faces_of(ob.data)]
    far = [face for face in before if max(p[2] for p in face) < -0.35]
    assert len(far) > 100
    assert [face for face in after if face in set(far)] == far


class TestPlaces:
    """World space: transforms, parents, and far away."""

    @pytest.mark.parametrize("scale", [(1, 1, 1), (2, 0.5, 3), (-1, 1, 1)])
    def test_transformed(self, scale):
        ob = cube(location=(10, 20, 30), rotation=(0.3, 0.5, 0.7))
        ob.scale = scale
        parent = bpy.data.objects.new("Parent", None)
        bpy.context.scene.collection.objects.link(parent)
        parent.location = (1, 2, 3)
        ob.parent = parent
        bpy.context.view_layer.update()
        middle = ob.matrix_world.translation
        pieces = cut(ob, line(middle + middle.__class__((-9, 0, 0)), middle + middle.__class__((9, 0, 0.5))))
        for piece in pieces:
            check_sound(piece)
            assert piece.matrix_world == ob.matrix_world
            assert piece.parent == parent
            assert volume(piece) > 0
        assert sum(map(volume, pieces)) == pytest.approx(8, rel=1e-5)
        height = [world_vertices(piece)[:, 2] - middle.z for piece in pieces]
        assert min(h.max() for h in height) < 0.5
        assert max(h.min() for h in height) > -0.5

    def test_modifiers_and_collections(self):
        ob = cube()
        ob.modifiers.new("Array", "ARRAY")
        home = bpy.data.collections.new("Home")
        bpy.context.scene.collection.children.link(home)
        home.objects.link(ob)
        bpy.context.scene.collection.objects.unlink(ob)
        _, other = cut(ob, ACROSS)
        assert [modifier.type for modifier in other.modifiers] == ["ARRAY"]
        assert other.users_collection == (home,)
        assert other.select_get()
        assert bpy.context.view_layer.objects.active == ob

    def test_mesh_with_several_users(self):
        """As with Bisect, all of them change; the new piece has a mesh of its own."""
        ob = cube()
        twin = bpy.data.objects.new("Twin", ob.data)
        bpy.context.scene.collection.objects.link(twin)
        _, other = cut(ob, ACROSS)
        assert twin.data == ob.data
        assert ob.data.users == 2
        assert other.data.users == 1


class TestStrokes:
    def test_grease_pencil(self):
        ob = cube()
        pencil = grease_pencil([line((-3, 0, -0.5), (3, 0, -0.5)), ACROSS], cyclic=False)
        activate(ob, pencil)
        assert bpy.ops.object.gridmesh_cut(direction="Y", keep="LEFT") == {"FINISHED"}
        assert vertices(ob.data)[:, 2].min() > 0.1  # the last stroke
        assert not pencil.select_get()

    def test_numbered_stroke(self, capfd):
        ob = cube()
        pencil = grease_pencil([line((-3, 0, -0.5), (3, 0, -0.5)), ACROSS], cyclic=False)
        activate(ob, pencil)
        assert bpy.ops.object.gridmesh_cut(direction="Y", keep="LEFT", number=1) == {"FINISHED"}
        assert vertices(ob.data)[:, 2].min() == pytest.approx(-0.5)
        assert "the last one" not in capfd.readouterr().out

    def test_choice_is_told(self, capfd):
        ob = cube()
        activate(ob, grease_pencil([line((-3, 0, -0.5), (3, 0, -0.5)), ACROSS], cyclic=False))
        bpy.ops.object.gridmesh_cut(direction="Y")
        assert "stroke 2 of 2, the last one" in capfd.readouterr().out

    @pytest.mark.smoke
    def test_plane_of_the_stroke_without_a_view(self, capfd):
        """A stroke drawn in the front view, cut in background: along Y."""
        ob = cube()
        pieces = cut(ob, line((-3, 0, 0), (3, 0, 0), 40, wave=0.3), direction="VIEW")
        assert [volume(piece) for piece in pieces] == [pytest.approx(4, rel=1e-4)] * 2
        assert "There is no view here" in capfd.readouterr().out

    @pytest.mark.smoke
    def test_drawn_in_perspective(self):
        """The stroke is swept through the eye: the cut is a cone of rays, not a prism."""
        ob = cube()
        points = line((-3, -1, 0.5), (3, -1, 0.5))
        activate(ob)
        options = {"view_kind": "PERSPECTIVE", "view_eye": (0, -5, 0), "view_direction": (0, 1, 0)}
        assert bpy.ops.object.gridmesh_cut(
            source="DRAWN", stroke=drawn(points), keep="LEFT", direction="VIEW", **options
        ) == {"FINISHED"}
        check_sound(ob)
        lowest = vertices(ob.data)[np.argsort(vertices(ob.data)[:, 2])[:2]]
        assert lowest[:, 2] == pytest.approx(0.5, abs=1e-6)  # in front, where it was drawn
        behind = vertices(ob.data)[vertices(ob.data)[:, 1] > 0.99]
        assert behind[:, 2].min() == pytest.approx(0.5 * 6 / 4, abs=1e-6)

    def test_view_direction_of_a_slanted_view(self):
        ob = cube()
        activate(ob)
        options = {"view_kind": "ORTHOGRAPHIC", "view_direction": (0, 1, -1)}
        points = line((-3, -3, 3), (3, -3, 3))
        assert bpy.ops.object.gridmesh_cut(source="DRAWN", stroke=drawn(points), keep="RIGHT", **options) == {
            "FINISHED"
        }
        assert volume(ob) == pytest.approx(4, rel=1e-5)


class TestEditMode:
    @pytest.mark.smoke
    def test_same_as_in_object_mode(self):
        ob = ball()
        twin = ob.copy()  # not another ball: Blender orders a sphere's faces by their addresses
        twin.data = ob.data.copy()
        bpy.context.collection.objects.link(twin)
        (piece,) = cut(ob, ACROSS, keep="LEFT", edge_length=0.1)
        stroke = stroke_object(ACROSS)
        activate(twin, stroke)
        edit(twin)
        stroke.select_set(True)
        assert bpy.ops.object.gridmesh_cut(direction="Y", keep="LEFT", edge_length=0.1) == {"FINISHED"}
        assert bpy.context.mode == "EDIT_MESH"
        leave()
        check_sound(twin)
        assert np.array_equal(vertices(twin.data), vertices(piece.data))
        assert faces_of(twin.data) == faces_of(piece.data)
        assert [p.index for p in caps(twin)] == [p.index for p in caps(piece)]

    def test_two_objects(self):
        ob = cube()
        stroke = stroke_object(ACROSS)
        activate(ob, stroke)
        edit(ob)
        stroke.select_set(True)
        assert bpy.ops.object.gridmesh_cut(direction="Y") == {"FINISHED"}
        (other,) = [other for other in mesh_objects() if other != ob]
        assert ob.mode == "EDIT"
        assert other.mode == "OBJECT"
        leave()
        for piece in (ob, other):
            check_sound(piece)
        assert volume(ob) + volume(other) == pytest.approx(8, rel=1e-5)

    def test_edits_so_far_are_cut(self):
        ob = cube()
        stroke = stroke_object(ACROSS)
        activate(ob, stroke)
        bm = edit(ob)
        stroke.select_set(True)
        for vertex in bm.verts:
            vertex.co.x *= 2
        bpy.ops.object.gridmesh_cut(direction="Y", keep="RIGHT")
        leave()
        assert np.abs(vertices(ob.data)[:, 0]).max() == 2


class TestUndo:
    @pytest.mark.parametrize("editing", [False, True])
    def test_one_step(self, editing):
        ob = cube()
        stroke = stroke_object(ACROSS)
        activate(ob, stroke)
        if editing:
            edit(ob)
            stroke.select_set(True)
        bpy.ops.ed.undo_push(message="base")
        before = fingerprint()
        assert bpy.ops.object.gridmesh_cut("EXEC_DEFAULT", True, direction="Y") == {"FINISHED"}
        assert len(mesh_objects()) == 2
        bpy.ops.ed.undo()
        assert len(mesh_objects()) == 1
        if editing:
            leave()
            assert len(bpy.data.objects["Cube"].data.vertices) == 8
        else:
            assert fingerprint() == before


class TestMaterials:
    def test_slot_of_their_own(self):
        ob = cube()
        red = bpy.data.materials.new("Red")
        ob.data.materials.append(red)
        inner = bpy.data.materials.new("Inside")
        pieces = cut(ob, ACROSS, use_cap_slot=True, cap_material="Inside")
        for piece in pieces:
            assert [slot.material for slot in piece.material_slots] == [red, inner]
            for polygon in piece.data.polygons:
                assert polygon.material_index == int(polygon.select)
        # Another cut takes the same slot.
        cut(ob, line((0, 0, -3), (0.1, 0, 3)), use_cap_slot=True, cap_material="Inside")
        assert len(ob.material_slots) == 2

    def test_empty_slot_beside_none(self):
        ob = cube()
        cut(ob, ACROSS, use_cap_slot=True)
        assert [slot.material for slot in ob.material_slots] == [None, None]
        assert {polygon.material_index for polygon in caps(ob)} == {1}

    def test_of_the_faces_around(self):
        ob = cube()
        for name in ("A", "B"):
            ob.data.materials.append(bpy.data.materials.new(name))
        for polygon in ob.data.polygons:
            polygon.material_index = 1
        cut(ob, ACROSS)
        assert {polygon.material_index for polygon in ob.data.polygons} == {1}
