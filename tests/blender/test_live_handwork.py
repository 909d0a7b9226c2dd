"""What was done to the mesh of a live body by hand is never lost: the body pauses, says so, and goes on when asked."""

import bpy
import numpy as np
import pytest
from drawings import activate, bean, check_body, grease_pencil, run_one, triangles, vertices

from addon.data import frames, written
from addon.live import engine

pytestmark = pytest.mark.usefixtures("awake")


@pytest.fixture
def drawn():
    drawing = grease_pencil([bean()])
    body = run_one(follow=True)
    engine.settle()
    return drawing, body


def reshape(drawing, amount):
    attribute = drawing.data.layers[0].current_frame().drawing.attributes["position"]
    points = (bean() * [amount, 1, 1]).astype(np.float32)
    attribute.data.foreach_set("vector", points.ravel())
    drawing.data.layers[0].current_frame().drawing.tag_positions_changed()
    bpy.context.view_layer.update()
    engine.settle()


def in_edit_mode(body, *calls):
    activate(body)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    for call in calls:
        call()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()


def point_moved(body):
    body.data.vertices[11].co.z += 0.2
    body.data.update()


def subdivided(body):
    in_edit_mode(body, bpy.ops.mesh.subdivide)


def remeshed(body):
    activate(body)
    body.data.remesh_voxel_size = 0.1
    bpy.ops.object.voxel_remesh()


def applied(body):
    body.modifiers.new("Subdivision", "SUBSURF")
    activate(body)
    bpy.ops.object.modifier_apply(modifier="Subdivision")


def joined(body):
    bpy.ops.mesh.primitive_cube_add(location=(4, 0, 0))
    activate(body, bpy.context.object)
    bpy.ops.object.join()


def dissolved(body):
    in_edit_mode(body, bpy.ops.mesh.tris_convert_to_quads)


HANDS = [point_moved, subdivided, remeshed, applied, joined, dissolved]


@pytest.mark.parametrize("hand", HANDS)
def test_what_a_hand_has_changed_is_kept(drawn, hand):
    drawing, body = drawn
    hand(body)
    bpy.context.view_layer.update()
    engine.settle()
    before, count = vertices(body.data), len(body.data.polygons)
    assert body.gridmesh_live.problem == engine.BY_HAND
    reshape(drawing, 1.3)
    body.gridmesh_live.triangles = 900
    bpy.context.view_layer.update()
    engine.settle()
    assert np.array_equal(vertices(body.data), before)
    assert len(body.data.polygons) == count
    assert body.gridmesh_live.problem == engine.BY_HAND


@pytest.mark.parametrize("hand", HANDS)
def test_rebuilt_it_follows_again(drawn, hand):
    drawing, body = drawn
    hand(body)
    reshape(drawing, 1.3)
    activate(body)
    assert bpy.ops.object.gridmesh_rebuild() == {"FINISHED"}
    assert body.gridmesh_live.problem == ""
    check_body(body)
    width = np.ptp(vertices(body.data)[:, 0])
    reshape(drawing, 1.0)
    assert np.ptp(vertices(body.data)[:, 0]) < 0.9 * width


def test_frozen_it_keeps_the_handwork(drawn):
    drawing, body = drawn
    point_moved(body)
    before = vertices(body.data)
    activate(body)
    bpy.ops.object.gridmesh_freeze()
    reshape(drawing, 1.3)
    assert np.array_equal(vertices(body.data), before)
    assert not frames.is_linked(body)
    assert body.data.gridmesh_made == ""


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT", "VERTEX_PAINT", "WEIGHT_PAINT", "TEXTURE_PAINT"])
def test_a_mode_that_changed_nothing_is_no_handwork(drawn, mode):
    drawing, body = drawn
    activate(body)
    for _ in range(2):
        bpy.ops.object.mode_set(mode=mode)
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    engine.settle()
    assert body.gridmesh_live.problem == ""
    width = np.ptp(vertices(body.data)[:, 0])
    reshape(drawing, 1.3)
    assert np.ptp(vertices(body.data)[:, 0]) > 1.1 * width


def test_colours_weights_and_materials_are_no_handwork(drawn):
    drawing, body = drawn
    body.data.color_attributes.new("Paint", "BYTE_COLOR", "CORNER")
    body.vertex_groups.new(name="Skin").add([1, 2], 1.0, "REPLACE")
    body.data.materials.append(bpy.data.materials.new("Skin"))
    body.data.shade_flat()
    assert not written.by_hand(body.data)
    reshape(drawing, 1.3)
    assert body.gridmesh_live.problem == ""


def test_undo_of_handwork_goes_on_following():
    grease_pencil([bean()])
    body = run_one(follow=True)
    engine.settle()
    name = body.name
    bpy.ops.ed.undo_push(message="made")
    point_moved(body)
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="by hand")
    changed = vertices(body.data)
    bpy.ops.ed.undo()
    body = bpy.data.objects[name]
    assert body.gridmesh_live.problem == ""
    assert not written.by_hand(body.data)
    bpy.ops.ed.redo()
    body = bpy.data.objects[name]
    assert np.array_equal(vertices(body.data), changed)
    engine.settle()
    assert body.gridmesh_live.problem == engine.BY_HAND
    bpy.ops.ed.undo()
    reshape(bpy.data.objects["Drawing"], 1.3)
    assert bpy.data.objects[name].gridmesh_live.problem == ""


def test_saved_and_opened_it_is_still_known(drawn, tmp_path):
    _, body = drawn
    point_moved(body)
    before = vertices(body.data)
    path = str(tmp_path / "hand.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    body = bpy.data.objects["Drawing.mesh"]
    reshape(bpy.data.objects["Drawing"], 1.3)
    assert np.array_equal(vertices(body.data), before)
    assert body.gridmesh_live.problem == engine.BY_HAND


def test_a_copy_made_single_is_no_handwork(drawn):
    drawing, body = drawn
    activate(body)
    bpy.ops.object.duplicate(linked=True)
    copy = bpy.context.object
    copy.data = copy.data.copy()
    engine.settle()
    reshape(drawing, 1.3)
    assert body.gridmesh_live.problem == copy.gridmesh_live.problem == ""
    assert np.array_equal(triangles(body.data), triangles(copy.data)) or len(copy.data.polygons) > 0


def test_the_panel_offers_both_ways_out(drawn):
    _, body = drawn
    point_moved(body)
    bpy.context.view_layer.update()
    activate(body)
    assert bpy.ops.object.gridmesh_rebuild.poll()
    assert bpy.ops.object.gridmesh_freeze.poll()
    assert "Rebuild from Outline" in body.gridmesh_live.problem
    assert "Freeze" in body.gridmesh_live.problem


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT", "WEIGHT_PAINT"])
def test_a_mesh_that_is_edited_at_a_linked_copy_is_left(drawn, mode):
    """It was written under the mode that held it."""
    drawing, body = drawn
    activate(body)
    bpy.ops.object.duplicate(linked=True)
    bpy.context.view_layer.update()
    engine.settle()
    copy = bpy.context.object
    assert copy != body
    assert copy.data == body.data
    activate(copy)
    bpy.ops.object.mode_set(mode=mode)
    before = vertices(body.data).copy()
    body.gridmesh_live.depth = 2.0
    reshape(drawing, 1.5)
    assert np.array_equal(vertices(body.data), before)
    assert "leave its mode" in body.gridmesh_live.problem
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    engine.settle()
    assert body.gridmesh_live.problem == ""
    wide, high = np.ptp(vertices(body.data), axis=0)[[0, 2]]
    assert wide == pytest.approx(1.5 * np.ptp(before[:, 0]), rel=0.02)
    assert high > 1.8 * np.ptp(before[:, 2])
    check_body(body)


def test_lines_of_messages_fit():
    from addon.ui.wrapping import lines

    text = "it has shape keys, which fit no new Donaudampfschifffahrtsgesellschaftskapitän mesh"
    for width in (5, 12, 30, 200):
        found = lines(text, width, len)
        assert max(map(len, found)) <= width
        assert "".join(found).replace(" ", "") == text.replace(" ", "")
    assert lines("", 10, len) == []
    assert lines("ab", 0, len) == ["a", "b"]
