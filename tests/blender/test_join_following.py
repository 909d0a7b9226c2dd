"""Joined bodies that follow their parts: strokes redrawn, moved, copied, deleted, undone; shown, applied."""

import math

import bpy
import numpy as np
import pytest
from cuts import check_sound, volume
from drawings import activate, circle, grease_pencil, mesh_objects, run, vertices
from mathutils import Matrix
from test_join import ball, faces_in_world, join

from addon.data import frames
from addon.join import following
from addon.live import engine

pytestmark = pytest.mark.usefixtures("awake")


def redraw(drawing, layer, points):
    frame = drawing.data.layers[layer].current_frame().drawing
    frame.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    frame.tag_positions_changed()
    bpy.context.view_layer.update()


def settle():
    engine.settle()
    return following.refresh()


def copy_of(whole):
    """A copy beside it, which follows the same parts."""
    copy = whole.copy()
    copy.data = whole.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    copy.location.x += 5.0
    bpy.context.view_layer.update()
    assert settle() == 0
    return copy


def top(ob):
    return max(point[1] for face in faces_in_world(ob) for point in face)


@pytest.fixture
def snowman():
    """A drawing of two strokes, the whole, and its parts, which follow them."""
    drawing = grease_pencil([circle()], layer="Body")
    grease_pencil([circle(radius=0.6, centre=(0.0, 1.2))], layer="Head", ob=drawing)
    bodies = run(follow=True)
    engine.settle()
    whole = join(*bodies)
    settle()
    return drawing, whole, following.parts_of(whole)


@pytest.mark.smoke
def test_the_whole_follows_a_stroke(snowman):
    drawing, whole, parts = snowman
    assert len(parts) == 2
    assert all(frames.is_linked(part) and not part.visible_get() for part in parts)
    assert top(whole) == pytest.approx(1.8, abs=0.02)
    assert settle() == 0, "nothing has changed"
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 1
    check_sound(whole)
    assert top(whole) == pytest.approx(2.0, abs=0.02)
    assert bpy.context.selected_objects == [whole]


def test_it_is_what_a_fresh_join_gives(snowman):
    drawing, whole, parts = snowman
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.1, 1.2)))
    settle()
    followed = vertices(whole.data)
    bpy.ops.object.gridmesh_show_parts()
    fresh = join(*parts, keep_parts=True, follow=False)
    assert np.allclose(vertices(fresh.data), followed, atol=1e-5)


def test_moved_it_takes_its_parts_along(snowman):
    drawing, whole, parts = snowman
    before = [part.matrix_world.translation.copy() for part in parts]
    mesh = vertices(whole.data)
    whole.location.x += 3.0
    bpy.context.view_layer.update()
    assert settle() == 0
    assert np.array_equal(vertices(whole.data), mesh)
    for part, place in zip(parts, before, strict=True):
        assert part.matrix_world.translation.x == pytest.approx(place.x + 3.0, abs=1e-5)
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 1
    check_sound(whole)
    assert top(whole) == pytest.approx(2.0, abs=0.02)


def test_turned_scaled_and_moved_far_it_keeps_its_mesh_and_weights(snowman):
    """Matrices of single precision differ in the last digits then."""
    _, whole, parts = snowman
    whole.vertex_groups.new(name="Arm").add(range(100), 0.5, "REPLACE")
    mesh = vertices(whole.data)
    ways = [
        Matrix.Rotation(math.radians(37), 4, (0.2, -0.5, 0.8)),
        Matrix.Scale(0.01, 4),
        Matrix.Translation((300, -20, 7)),
        Matrix.Rotation(math.radians(-75), 4, "Z"),
        Matrix.Scale(250, 4),
    ]
    for way in ways:
        whole.matrix_world = way @ whole.matrix_world
        bpy.context.view_layer.update()
        assert settle() == 0
        assert np.array_equal(vertices(whole.data), mesh)
        assert sum(len(vertex.groups) for vertex in whole.data.vertices) == 100
    parts[1].location.y += 0.2
    bpy.context.view_layer.update()
    assert settle() == 1


def test_a_moved_part_is_joined_where_it_is(snowman):
    _, whole, parts = snowman
    parts[1].location.y += 0.2
    bpy.context.view_layer.update()
    assert settle() == 1
    assert top(whole) == pytest.approx(2.0, abs=0.02)


def test_a_copy_follows_in_its_own_place(snowman):
    drawing, whole, _ = snowman
    copy = copy_of(whole)
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 2
    assert np.allclose(vertices(copy.data), vertices(whole.data), atol=1e-5)


def test_a_deleted_part_is_missing(snowman):
    _, whole, parts = snowman
    bpy.data.objects.remove(parts[1])
    assert settle() == 1
    check_sound(whole)
    assert top(whole) == pytest.approx(1.0, abs=0.02)


def test_options_of_the_whole_count_at_once(snowman):
    _, whole, _ = snowman
    before = vertices(whole.data)
    whole.gridmesh_joined.blend = 4.0
    assert len(vertices(whole.data)) != len(before)
    check_sound(whole)


def test_what_cannot_be_joined_leaves_it_and_says_why(snowman):
    _, whole, parts = snowman
    before = vertices(whole.data)
    parts[1].scale.x = 0.0
    bpy.context.view_layer.update()
    assert settle() == 0
    assert "no thickness" in whole.gridmesh_joined.problem
    assert np.array_equal(vertices(whole.data), before)
    parts[1].scale.x = 1.5
    bpy.context.view_layer.update()
    assert settle() == 1
    assert not whole.gridmesh_joined.problem


def test_changed_by_hand_it_is_left(snowman):
    drawing, whole, _ = snowman
    whole.data.vertices[0].co.z += 1.0
    before = vertices(whole.data)
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 0
    assert whole.gridmesh_joined.problem == following.BY_HAND
    assert np.array_equal(vertices(whole.data), before)


def test_changed_by_hand_it_says_so_at_once(snowman):
    _, whole, _ = snowman
    before = whole.data.vertices[0].co.copy()
    whole.data.vertices[0].co.z += 1.0
    assert settle() == 0
    assert whole.gridmesh_joined.problem == following.BY_HAND
    whole.data.vertices[0].co = before
    assert settle() == 0
    assert whole.gridmesh_joined.problem == ""


def test_a_whole_without_parts_is_left(snowman):
    """As a copy is whose parts were deleted with the original."""
    _, whole, parts = snowman
    mesh = vertices(whole.data)
    for part in parts:
        bpy.data.objects.remove(part)
    assert not following.draft(whole)
    assert settle() == 0
    assert np.array_equal(vertices(whole.data), mesh)


def test_undo_and_redo(snowman):
    drawing, whole, _ = snowman
    names = drawing.name, whole.name
    bpy.ops.ed.undo_push(message="base")
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    settle()
    bpy.ops.ed.undo_push(message="wider")
    bpy.ops.ed.undo()
    settle()
    assert top(bpy.data.objects[names[1]]) == pytest.approx(1.8, abs=0.02)
    bpy.ops.ed.redo()
    settle()
    assert top(bpy.data.objects[names[1]]) == pytest.approx(2.0, abs=0.02)


def test_saved_and_opened_it_goes_on(snowman, tmp_path):
    drawing, whole, _ = snowman
    names = drawing.name, whole.name
    path = str(tmp_path / "snowman.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    drawing, whole = (bpy.data.objects[name] for name in names)
    assert settle() == 0
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 1
    assert top(whole) == pytest.approx(2.0, abs=0.02)


def test_appended_its_parts_stay_hidden(snowman, tmp_path):
    _, whole, parts = snowman
    names = whole.name, [part.name for part in parts]
    mesh = vertices(whole.data)
    path = tmp_path / "character.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.append(filename=names[0], directory=f"{path}/Object/")
    settle()
    whole = bpy.data.objects[names[0]]
    parts = following.parts_of(whole)
    assert sorted(part.name for part in parts) == sorted(names[1])
    assert whole.visible_get()
    assert not any(part.visible_get() for part in parts)
    assert not any(frames.owned(part).visible_get() for part in parts if frames.owned(part) is not None)
    assert np.array_equal(vertices(whole.data), mesh)


def test_parts_are_shown_and_hidden_again(snowman):
    _, whole, parts = snowman
    assert bpy.ops.object.gridmesh_show_parts() == {"FINISHED"}
    assert not whole.visible_get()
    assert all(part.visible_get() for part in parts)
    assert bpy.context.view_layer.objects.active in parts
    assert bpy.ops.object.gridmesh_show_parts() == {"FINISHED"}
    assert whole.visible_get()
    assert not any(part.visible_get() for part in parts)


@pytest.mark.parametrize("keep", [False, True])
def test_applied_it_is_a_plain_mesh(snowman, keep):
    drawing, whole, parts = snowman
    names = [part.name for part in parts]
    before = vertices(whole.data)
    assert bpy.ops.object.gridmesh_apply_join(keep_parts=keep) == {"FINISHED"}
    assert following.whole_of(whole) is None
    assert all((name in bpy.data.objects) == keep for name in names)
    if keep:
        assert all(bpy.data.objects[name].visible_get() for name in names)
        assert all(frames.is_linked(bpy.data.objects[name]) for name in names)
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    settle()
    assert np.array_equal(vertices(whole.data), before)


@pytest.mark.parametrize("follow", [False, True])
def test_a_whole_can_be_a_part(snowman, follow):
    drawing, whole, parts = snowman
    n_parts = len(parts)
    ball("Hat", 0.0, 0.5)
    hat = bpy.data.objects["Hat"]
    hat.location = (0, 2.0, 0)
    bpy.context.view_layer.update()
    larger = join(whole, hat, follow=follow)
    check_sound(larger)
    assert top(larger) == pytest.approx(2.5, abs=0.02)
    assert (larger == whole) != follow
    assert following.is_whole(larger) == follow
    assert len(mesh_objects()) == (n_parts + 3 if follow else 1)
    redraw(drawing, "Body", circle(radius=1.2))
    settle()
    settle()
    bottom = min(point[1] for face in faces_in_world(larger) for point in face)
    assert bottom == pytest.approx(-1.2 if follow else -1.0, abs=0.02)


def test_plain_meshes_that_are_kept_are_followed_too():
    body, head = ball("Body"), ball("Head", 1.1, 0.7)
    whole = join(body, head, keep_parts=True)
    before = volume(whole)
    for vertex in head.data.vertices:
        vertex.co *= 1.2
    head.data.update()
    assert settle() == 1
    check_sound(whole)
    assert volume(whole) > before


def test_strokes_that_are_joined_and_followed():
    drawing = grease_pencil([circle()], layer="Body")
    grease_pencil([circle(radius=0.4, centre=(0.0, 0.9))], layer="Head", ob=drawing)
    before = set(mesh_objects())
    activate(drawing)
    run(use_join=True, follow=True)
    (whole,) = [ob for ob in mesh_objects() if ob not in before and following.is_whole(ob)]
    settle()
    check_sound(whole)
    redraw(drawing, "Body", circle(radius=1.2))
    assert settle() == 1
    check_sound(whole)


def test_undo_after_it_has_followed_finds_its_mesh(snowman):
    """Undo takes objects that are alike in two steps as they are: between the steps the mesh must stay the same data block."""
    drawing, whole, parts = snowman
    name, mesh = whole.name, whole.data
    bpy.ops.ed.undo_push(message="base")
    activate(parts[1])
    bpy.ops.ed.undo_push(message="nothing of the whole")
    redraw(drawing, "Head", circle(radius=0.8, centre=(0.0, 1.2)))
    assert settle() == 1
    assert whole.data == mesh
    bpy.ops.ed.undo()
    whole = bpy.data.objects[name]
    assert whole.data in bpy.data.meshes[:]
    settle()
    check_sound(whole)
    assert top(whole) == pytest.approx(1.8, abs=0.02)
