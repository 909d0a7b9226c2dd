"""Joined bodies whose transform was applied, or whose origin was set: they stay where they are and go on following."""

import bpy
import numpy as np
import pytest
from drawings import circle, vertices, world_vertices
from mathutils import Matrix
from test_join import ball, join
from test_join_following import copy_of, redraw, settle, snowman

from addon.join import characters, following, showing

__all__ = ["snowman"]
pytestmark = pytest.mark.usefixtures("awake")


def placed(whole):
    whole.rotation_euler, whole.scale, whole.location = (0.2, 0.5, 0.3), (2, 2, 2), (1, 2, 3)
    bpy.context.view_layer.update()
    settle()


def apply(ob, **what):
    showing.choose(ob)
    bpy.ops.object.transform_apply(**what)
    bpy.context.view_layer.update()


def set_origin(ob, place):
    showing.choose(ob)
    bpy.context.scene.cursor.location = place
    bpy.ops.object.origin_set(type="ORIGIN_CURSOR")
    bpy.context.view_layer.update()


def check_goes_on(whole, before, parts_before):
    """It is where it was, without being made anew, as its parts are; moved, a part is joined where it is then."""
    assert settle() == 0
    assert whole.gridmesh_joined.problem == ""
    assert np.allclose(world_vertices(whole), before, atol=1e-4)
    parts = following.parts_of(whole)
    for part, points in zip(parts, parts_before, strict=True):
        assert np.allclose(world_vertices(part), points, atol=1e-4)
    parts[1].location.y += 0.2
    bpy.context.view_layer.update()
    assert settle() == 1
    assert whole.gridmesh_joined.problem == ""
    bpy.ops.object.gridmesh_show_parts()
    fresh = join(*parts, keep_parts=True, follow=False)
    check_same_reach(fresh, whole)


def check_same_reach(one, two, away=(0, 0, 0)):
    """They lie at the same place in the world, or the first away from the second."""
    for end in (np.min, np.max):
        lies = end(world_vertices(one), axis=0) - end(world_vertices(two), axis=0)
        assert np.allclose(lies, away, atol=0.02)


WAYS = [
    {},
    {"location": True, "rotation": False, "scale": False},
    {"location": False, "rotation": True, "scale": False},
    {"location": False, "rotation": False, "scale": True},
]


@pytest.mark.parametrize("what", WAYS)
def test_applied_transforms_leave_a_whole_and_its_parts_where_they_are(snowman, what):
    _, whole, parts = snowman
    placed(whole)
    before, parts_before = world_vertices(whole), [world_vertices(part) for part in parts]
    apply(whole, **what)
    check_goes_on(whole, before, parts_before)


def test_an_origin_that_is_set_leaves_a_whole_and_its_parts_where_they_are(snowman):
    _, whole, parts = snowman
    placed(whole)
    before, parts_before = world_vertices(whole), [world_vertices(part) for part in parts]
    set_origin(whole, (1, 0, -2))
    check_goes_on(whole, before, parts_before)


def test_transforms_are_applied_again_and_again(snowman):
    _, whole, parts = snowman
    for _ in range(5):
        placed(whole)
        apply(whole)
        assert settle() == 0
        set_origin(whole, (3, 2, 1))
        assert settle() == 0
        assert whole.gridmesh_joined.problem == ""
        whole.scale = (0.5, 0.5, 0.5)
        bpy.context.view_layer.update()
    before, parts_before = world_vertices(whole), [world_vertices(part) for part in parts]
    apply(whole)
    check_goes_on(whole, before, parts_before)


def test_undo_and_redo_of_an_applied_transform(snowman):
    drawing, whole, _ = snowman
    names = drawing.name, whole.name
    placed(whole)
    before = world_vertices(whole)
    bpy.ops.ed.undo_push(message="placed")
    apply(whole)
    bpy.ops.ed.undo_push(message="applied")
    settle()
    for step in (bpy.ops.ed.undo, bpy.ops.ed.redo, bpy.ops.ed.undo, bpy.ops.ed.redo, bpy.ops.ed.undo):
        step()
        assert settle() == 0
        whole = bpy.data.objects[names[1]]
        assert whole.gridmesh_joined.problem == ""
        assert np.allclose(world_vertices(whole), before, atol=1e-4)
    redraw(bpy.data.objects[names[0]], "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 1


def test_saved_after_a_transform_was_applied_it_goes_on(snowman, tmp_path):
    drawing, whole, _ = snowman
    names = drawing.name, whole.name
    placed(whole)
    before = world_vertices(whole)
    apply(whole)
    settle()
    path = str(tmp_path / "applied.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    drawing, whole = (bpy.data.objects[name] for name in names)
    assert settle() == 0
    assert np.allclose(world_vertices(whole), before, atol=1e-4)
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 1
    assert whole.gridmesh_joined.problem == ""


@pytest.mark.parametrize("which", ["whole", "copy"])
def test_a_copy_stays_where_it_is_when_transforms_of_one_of_both_are_applied(snowman, which):
    _, whole, _ = snowman
    placed(whole)
    copy = copy_of(whole)
    before = world_vertices(whole), world_vertices(copy)
    apply(whole if which == "whole" else copy)
    assert settle() == 0
    assert [ob.gridmesh_joined.problem for ob in (whole, copy)] == ["", ""]
    for ob, points in zip((whole, copy), before, strict=True):
        assert np.allclose(world_vertices(ob), points, atol=1e-4)
    following.parts_of(whole)[1].location.y += 0.2
    bpy.context.view_layer.update()
    assert settle() == 2
    check_same_reach(copy, whole, (5, 0, 0))


def test_twins_stay_when_transforms_are_applied():
    ball("Body")
    ball("Arm", 0.9, 0.5)
    body, arm = (bpy.data.objects[name] for name in ("Body", "Arm"))
    whole = join(body, arm, keep_parts=True)
    arm.gridmesh_part.twin = True
    bpy.context.view_layer.update()
    assert settle() == 1
    whole.location = (3, 0, 0)
    bpy.context.view_layer.update()
    settle()
    before = world_vertices(whole)
    apply(whole)
    assert settle() == 0
    assert np.allclose(world_vertices(whole), before, atol=1e-4)
    arm.location.z += 0.1
    bpy.context.view_layer.update()
    assert settle() == 1
    reach = world_vertices(whole)[:, 0]
    assert reach.min() + reach.max() == pytest.approx(6.0, abs=0.02)
    twin = characters.split(arm)[1]
    assert (twin.matrix_world.translation.x + arm.matrix_world.translation.x) == pytest.approx(6.0, abs=0.02)


def test_part_depth_goes_the_same_way_after_transforms_are_applied():
    ball("Body")
    ball("Arm", 0.9, 0.5)
    body, arm = (bpy.data.objects[name] for name in ("Body", "Arm"))
    whole = join(body, arm, keep_parts=True)
    following.parts.note(arm, whole, depth=0.0, reach=(0.0, 0.0, 1.0), twin=False)
    placed(whole)
    arm.gridmesh_part.depth = 0.5
    bpy.context.view_layer.update()
    settle()
    way = arm.matrix_world.translation.copy()
    arm.gridmesh_part.depth = 0.0
    bpy.context.view_layer.update()
    settle()
    apply(whole)
    settle()
    arm.gridmesh_part.depth = 0.5
    bpy.context.view_layer.update()
    assert np.allclose(arm.matrix_world.translation, way, atol=1e-4)


def test_moved_within_its_object_it_was_changed_by_hand(snowman):
    _, whole, _ = snowman
    whole.data.transform(Matrix.Translation((1, 0, 0)))
    mesh = vertices(whole.data)
    bpy.context.view_layer.update()
    assert settle() == 0
    assert whole.gridmesh_joined.problem == following.BY_HAND
    assert np.array_equal(vertices(whole.data), mesh)
