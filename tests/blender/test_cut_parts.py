"""One stroke over several meshes and parts of meshes: what is cut, what stays, what is told."""

import bpy
import numpy as np
import pytest
from cuts import caps, check_sound, cut, drawn, is_closed, line, stroke_object, volume
from drawings import activate, circle, mesh_objects, vertices

from addon.cut import drawnline
from addon.data import frames

BEHIND = [(-2.0, 0.0, 0.1), (2.0, 0.0, 0.2)]


def ball(x=0.0):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, location=(x, 0, 0))
    return bpy.context.object


class TestSeveralMeshes:
    def test_all_selected_are_cut(self):
        balls = [ball(3.0 * k) for k in range(3)]
        activate(balls[1], balls[0], balls[2])
        points = line((-2, 0, 0.1), (8, 0, 0.2))
        assert bpy.ops.object.gridmesh_cut(stroke=drawn(points), direction="Y", source="DRAWN") == {
            "FINISHED"
        }
        assert len(mesh_objects()) == 6
        assert sum(map(volume, mesh_objects())) == pytest.approx(3 * volume(ball()), rel=1e-4)
        for ob in balls:
            check_sound(ob)
            assert caps(ob)

    def test_those_that_cannot_be_cut_are_named(self, capfd):
        one, far = ball(), ball(9.0)
        bpy.ops.mesh.primitive_cube_add(location=(0, 0, 0))
        flat = bpy.context.object
        flat.scale.z = 0.0
        before = vertices(far.data)
        activate(one, far, flat)
        stroke = drawn(line(*BEHIND))
        assert bpy.ops.object.gridmesh_cut(stroke=stroke, direction="Y", source="DRAWN") == {"FINISHED"}
        assert np.array_equal(vertices(far.data), before)
        told = capfd.readouterr().out
        assert f"'{far.name}' is left as it was: the stroke does not divide the mesh" in told
        assert f"'{flat.name}' is left as it was: " in told
        assert "has no thickness" in told

    def test_a_cut_made_twice_is_told(self, capfd):
        one = ball()
        activate(one)
        points = drawn(line(*BEHIND))
        options = {"stroke": points, "direction": "Y", "source": "DRAWN"}
        assert bpy.ops.object.gridmesh_cut(**options) == {"FINISHED"}
        halves = mesh_objects()
        before = [vertices(half.data) for half in halves]
        activate(*halves)
        with pytest.raises(RuntimeError, match="the mesh ends along the stroke already"):
            bpy.ops.object.gridmesh_cut(**options)
        assert len(mesh_objects()) == 2
        assert all(np.array_equal(vertices(half.data), old) for half, old in zip(halves, before, strict=True))
        # Beside another object that is cut they stay, and are named.
        other = ball(3.0)
        activate(other, *halves)
        assert bpy.ops.object.gridmesh_cut(**{**options, "extend_ends": True}) == {"FINISHED"}
        assert f"'{halves[0].name}' is left as it was: the mesh ends along" in capfd.readouterr().out
        assert len(mesh_objects()) == 4

    def test_a_mesh_of_two_objects_is_cut_once(self, capfd):
        one = ball()
        twin = one.copy()
        bpy.context.scene.collection.objects.link(twin)
        activate(one, twin)
        points = line(*BEHIND)
        assert bpy.ops.object.gridmesh_cut(stroke=drawn(points), direction="Y", source="DRAWN") == {
            "FINISHED"
        }
        assert f"has the same mesh as '{one.name}' and is what that is" in capfd.readouterr().out
        check_sound(one)

    def test_what_shares_the_mesh_is_told(self, capfd):
        one = ball()
        twin = one.copy()
        bpy.context.scene.collection.objects.link(twin)
        activate(one)
        stroke = drawn(line(*BEHIND))
        assert bpy.ops.object.gridmesh_cut(stroke=stroke, direction="Y", source="DRAWN") == {"FINISHED"}
        assert f"lso changed, with the same mesh: {twin.name}" in capfd.readouterr().out

    def test_nothing_that_can_be_cut_is_an_error(self):
        one, far = ball(), ball(9.0)
        activate(one, far)
        with pytest.raises(RuntimeError, match="left as it was"):
            bpy.ops.object.gridmesh_cut(
                stroke=drawn(line((-2, 0, 5), (20, 0, 5))), direction="Y", source="DRAWN"
            )


class TestEnds:
    def three(self):
        """Three balls in a row as one mesh."""
        balls = [ball(3.0 * k) for k in range(3)]
        activate(balls[0], balls[1], balls[2])
        bpy.ops.object.join()
        return bpy.context.object

    def test_ends_go_as_far_as_what_they_cross(self):
        ob = self.three()
        whole = volume(ob)
        pieces = cut(ob, line((-0.2, 0, 0.1), (0.3, 0, 0.12)))
        least = min(map(volume, pieces))
        assert least < 0.55 * whole / 3
        assert sum(map(volume, pieces)) == pytest.approx(whole, rel=1e-4)
        for piece in pieces:
            check_sound(piece)

    def test_extended_ends_go_through_everything(self):
        ob = self.three()
        whole = volume(ob)
        pieces = cut(ob, line((-0.2, 0, 0.1), (0.3, 0, 0.1)), extend_ends=True)
        assert min(map(volume, pieces)) > 0.35 * whole

    def test_the_preview_ends_where_the_cut_does(self):
        points = np.array([[10.0, 10.0], [20.0, 10.0], [30.0, 10.0]])
        ends = np.array([[4.0, 10.0], [30.0, 10.0]])
        assert drawnline.extended(points, ends, 500.0).tolist() == [[4.0, 10.0], *points.tolist()]
        far = drawnline.extended(points, None, 500.0)
        assert far[0].tolist() == [-490.0, 10.0]
        assert far[-1].tolist() == [530.0, 10.0]
        near, off = drawnline.band(far, 5.0, left=True)
        assert len(near) == len(off) == 5
        closed = np.vstack([points, [[20.0, 20.0]], points[:1]])
        assert np.array_equal(drawnline.extended(closed, None, 500.0), closed)


class TestMirror:
    def half(self):
        ob = ball()
        activate(ob)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.bisect(plane_co=(0, 0, 0), plane_no=(1, 0, 0), clear_inner=True)
        bpy.ops.object.mode_set(mode="OBJECT")
        modifier = ob.modifiers.new("Mirror", "MIRROR")
        modifier.use_axis = (True, False, False)
        return ob

    def shown(self, ob):
        return ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()

    @pytest.mark.parametrize("edge_length", [0.0, 0.2])
    def test_both_halves_together_are_closed(self, edge_length):
        ob = self.half()
        ob.rotation_euler = (0.3, 0.2, 0.1)
        ob.location = (0.5, 0, 0)
        bpy.context.view_layer.update()
        assert is_closed(self.shown(ob))
        pieces = cut(ob, line((-3, 0, 0.1), (3, 0, 0.3)), edge_length=edge_length, keep="BOTH")
        assert len(pieces) == 2
        for piece in pieces:
            assert caps(piece)
            assert not is_closed(piece.data)
            assert is_closed(self.shown(piece))

    def test_without_merging_it_is_open(self, capfd):
        ob = self.half()
        ob.modifiers["Mirror"].use_mirror_merge = False
        cut(ob, line((-3, 0, 0.1), (3, 0, 0.3)))
        assert "ends at the border of the mesh" in capfd.readouterr().out


def test_a_live_body_is_frozen(capfd):
    source = stroke_object(np.asarray(circle(60, 1.0), float), cyclic=True)
    activate(source)
    assert bpy.ops.object.gridmesh_from_strokes(follow=True) == {"FINISHED"}
    (ob,) = mesh_objects()
    assert frames.is_linked(ob)
    activate(ob)
    points = line((-3, 0.1, 0), (3, 0.2, 0))
    assert bpy.ops.object.gridmesh_cut(stroke=drawn(points), direction="Z", source="DRAWN") == {"FINISHED"}
    assert len(mesh_objects()) == 2
    assert not any(frames.is_linked(piece) for piece in mesh_objects())
    assert f"cannot follow its drawing: {ob.name}" in capfd.readouterr().out


def test_reduced_caps_are_told(capfd):
    bpy.ops.mesh.primitive_cube_add()
    ob = bpy.context.object
    pieces = cut(ob, line((-3, 0, 0.97), (3, 0, 0.97)), smooth="TANGENT", edge_length=0.5)
    assert all(volume(piece) > 0 for piece in pieces)
    assert "less than the mesh around" in capfd.readouterr().out
