"""Joined bodies that are deleted: their hidden parts and outlines go along, and undo brings all back as it was."""

import bpy
import numpy as np
import pytest
from drawings import bean, circle, mesh_objects, world_vertices
from test_join import ball, join
from test_join_copies import copy_of, delete
from test_join_following import settle, snowman
from test_live_together import draw, edit

from addon.data import frames
from addon.join import characters, following, showing
from addon.live import engine

__all__ = ["snowman"]
pytestmark = pytest.mark.usefixtures("awake")


def drawn():
    """A whole of two bodies with outlines of their own, of the tool; and the parts."""
    draw(bean())
    settle()
    (body,) = engine.bodies()
    draw(circle(60, 0.7, (1.0, 1.0)), action="NEW")
    settle()
    whole = join(*engine.bodies())
    settle()
    parts = following.parts_of(whole)
    assert body in parts
    assert all(frames.owned(part) for part in parts)
    return whole, parts


def in_scene():
    return sorted(ob.name for ob in bpy.context.scene.objects)


def test_a_deleted_whole_takes_its_parts_along(snowman):
    drawing, whole, _ = snowman
    delete(whole)
    settle()
    assert in_scene() == [drawing.name]
    assert mesh_objects() == []


@pytest.mark.parametrize("how", ["remove", "operator"])
def test_a_deleted_whole_takes_the_outlines_of_its_parts_along_and_undo_brings_all_back(how):
    whole, parts = drawn()
    name, names = whole.name, [part.name for part in parts]
    outlines = [frames.owned(part).name for part in parts]
    everything, before = in_scene(), world_vertices(whole)
    bpy.ops.ed.undo_push(message="made")
    delete(whole, how)
    bpy.ops.ed.undo_push(message="deleted")
    settle()
    assert in_scene() == []
    for _ in range(2):
        bpy.ops.ed.undo()
        assert settle() == 0
        assert in_scene() == everything
        whole = bpy.data.objects[name]
        parts = following.parts_of(whole)
        assert [part.name for part in parts] == names
        assert all(following.whole_of(part) == whole for part in parts)
        assert [frames.owned(part).name for part in parts] == outlines
        assert not any(part.visible_get() for part in parts)
        assert np.allclose(world_vertices(whole), before, atol=1e-5)
        assert whole.gridmesh_joined.problem == ""
        bpy.ops.ed.redo()
        settle()
        assert in_scene() == []
    bpy.ops.ed.undo()
    settle()
    whole = bpy.data.objects[name]
    edit(frames.owned(following.parts_of(whole)[0]))
    assert settle() == 1
    assert whole.gridmesh_joined.problem == ""


def test_parts_that_are_seen_or_used_stay_when_the_whole_is_deleted():
    ball("Body")
    ball("Arm", 0.9, 0.5)
    ball("Leg", -0.9, 0.5)
    objects = [bpy.data.objects[name] for name in ("Body", "Arm", "Leg")]
    whole = join(*objects, keep_parts=True)
    settle()
    characters.pick(objects[1])
    user = ball("User", 5.0)
    user.modifiers.new("Mirror", "MIRROR").mirror_object = objects[2]
    delete(whole)
    settle()
    assert in_scene() == ["Arm", "Leg", "User"]


def test_parts_that_a_copy_has_stay_when_the_whole_is_deleted_and_go_with_the_copy(snowman):
    drawing, whole, parts = snowman
    copy = copy_of(whole)
    delete(whole)
    settle()
    assert following.parts_of(copy) == parts
    delete(copy)
    settle()
    assert in_scene() == [drawing.name]


def test_parts_of_an_applied_whole_stay_when_they_are_hidden_and_it_is_deleted(snowman):
    _, whole, parts = snowman
    following.apply(whole, keep_parts=True)
    for part in parts:
        showing.reveal(part, seen=False)
    delete(whole)
    settle()
    assert all(part.users_scene for part in parts)


def test_a_whole_that_is_a_part_goes_with_its_own_parts():
    whole = join(ball("Body"), ball("Arm", 0.9, 0.5), keep_parts=True)
    larger = join(whole, ball("Leg", -0.9, 0.5), keep_parts=True)
    settle()
    delete(larger)
    settle()
    assert in_scene() == []


def test_saved_after_the_whole_was_deleted_nothing_of_it_is_left(snowman, tmp_path):
    drawing, whole, _ = snowman
    name = drawing.name
    delete(whole)
    path = str(tmp_path / "deleted.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    settle()
    assert in_scene() == [name]
