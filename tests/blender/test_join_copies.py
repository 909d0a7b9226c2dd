"""Copies of joined bodies: they share the parts of their original, and stay where they are when that goes."""

import bpy
import numpy as np
import pytest
from drawings import circle, vertices, world_vertices
from test_join_following import copy_of, redraw, settle, snowman, top

from addon.join import following, showing

__all__ = ["snowman"]
pytestmark = pytest.mark.usefixtures("awake")


def delete(ob, how="operator"):
    if how == "remove":
        bpy.data.objects.remove(ob)
    else:
        showing.choose(ob)
        bpy.ops.object.delete()
    bpy.context.view_layer.update()


def check_follows(drawing, copy, before):
    assert np.allclose(world_vertices(copy), before, atol=1e-4)
    assert copy.gridmesh_joined.problem == ""
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 1
    assert top(copy) == pytest.approx(2.0, abs=0.02)
    across = world_vertices(copy)[:, 0]
    assert 0.5 * (across.min() + across.max()) == pytest.approx(5.0, abs=0.02)


@pytest.mark.parametrize("how", ["remove", "operator"])
def test_a_copy_stays_and_has_the_parts_when_the_original_is_deleted(snowman, how):
    drawing, whole, parts = snowman
    copy = copy_of(whole)
    before = world_vertices(copy)
    delete(whole, how)
    assert settle() == 0
    assert following.parts_of(copy) == parts
    assert all(following.whole_of(part) == copy for part in parts)
    assert not any(part.visible_get() for part in parts)
    check_follows(drawing, copy, before)
    parts[1].location.y += 0.2
    bpy.context.view_layer.update()
    assert settle() == 1
    assert top(copy) == pytest.approx(2.2, abs=0.02)


@pytest.mark.parametrize("keep", [False, True])
def test_a_copy_stays_and_follows_when_its_original_is_applied(snowman, keep):
    drawing, whole, parts = snowman
    copy = copy_of(whole)
    before = world_vertices(copy)
    following.apply(whole, keep_parts=keep)
    bpy.context.view_layer.update()
    following.draft(copy)
    assert settle() == 0
    assert all(part.visible_get() == keep for part in parts)
    check_follows(drawing, copy, before)


def test_undo_of_a_deleted_original_gives_it_the_parts_back(snowman):
    _, whole, parts = snowman
    names = whole.name, [part.name for part in parts]
    copy = copy_of(whole)
    name, before = copy.name, world_vertices(copy)
    bpy.ops.ed.undo_push(message="copied")
    delete(whole)
    bpy.ops.ed.undo_push(message="deleted")
    settle()
    for _ in range(2):
        bpy.ops.ed.undo()
        assert settle() == 0
        whole, copy = bpy.data.objects[names[0]], bpy.data.objects[name]
        assert [part.name for part in following.parts_of(whole)] == names[1]
        assert all(following.whole_of(part) == whole for part in following.parts_of(whole))
        assert np.allclose(world_vertices(copy), before, atol=1e-4)
        bpy.ops.ed.redo()
        assert settle() == 0
        copy = bpy.data.objects[name]
        assert all(following.whole_of(part) == copy for part in following.parts_of(copy))
        assert np.allclose(world_vertices(copy), before, atol=1e-4)


def test_a_copy_without_parts_says_so(snowman):
    _, whole, parts = snowman
    copy = copy_of(whole)
    mesh = vertices(copy.data)
    for part in parts:
        bpy.data.objects.remove(part)
    assert settle() == 0
    assert copy.gridmesh_joined.problem == following.GONE
    assert np.array_equal(vertices(copy.data), mesh)
