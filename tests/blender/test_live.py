"""Bodies that follow their stroke."""

import difflib

import bpy
import numpy as np
import pytest
from drawings import (
    activate,
    bean,
    check_body,
    circle,
    curve,
    grease_pencil,
    run_one,
    triangles,
    vertices,
    world_vertices,
)

from addon.data import frames
from addon.live import engine

pytestmark = pytest.mark.usefixtures("awake")


def redraw(ob, points):
    drawing = ob.data.layers[0].current_frame().drawing
    drawing.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    drawing.tag_positions_changed()
    bpy.context.view_layer.update()


def bytes_of(body):
    mesh = body.data
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    uv = np.empty(len(mesh.loops) * 2, np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", uv)
    return vertices(mesh).tobytes() + corners.tobytes() + uv.tobytes() + repr(body.matrix_world).encode()


def bump(points, amount, at=40, width=4.0):
    away = (np.arange(len(points)) - at) / width
    return points * (1 + amount * np.exp(-0.5 * away**2))[:, None]


@pytest.fixture
def drawn():
    drawing = grease_pencil([bean()])
    body = run_one(follow=True)
    engine.settle()
    return drawing, body


@pytest.mark.smoke
def test_the_body_follows_in_place(drawn):
    drawing, body = drawn
    mesh, before, height = body.data, bytes_of(body), np.ptp(vertices(body.data)[:, 1])
    material = bpy.data.materials.new("Mine")
    mesh.materials.append(material)
    body.modifiers.new("Subdivision", "SUBSURF")
    redraw(drawing, bump(bean(), 0.3))
    assert body.data == mesh
    assert bytes_of(body) != before
    assert np.ptp(vertices(mesh)[:, 1]) > height + 0.05
    assert list(mesh.materials) == [material]
    assert [modifier.name for modifier in body.modifiers] == ["Subdivision"]
    engine.settle()
    check_body(body)
    assert body.gridmesh_live.problem == ""


def test_to_and_fro_gives_the_same_bytes(drawn):
    drawing, body = drawn
    before = bytes_of(body)
    for step in range(100):
        redraw(drawing, bump(bean(), 0.01 * (step % 7)))
    assert bytes_of(body) != before
    redraw(drawing, bean())
    engine.settle()
    assert bytes_of(body) == before


def turns(body):
    """Turns of the lattice path that is the silhouette, from how many triangles of the front each vertex has."""
    corners = np.empty(len(body.data.loops), np.int32)
    body.data.loops.foreach_get("vertex_index", corners)
    front = corners.reshape(-1, 3)[: len(body.data.polygons) // 2]
    edges = np.sort(front[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    return np.bincount(front.ravel())[np.unique(edges[uses == 1])].tolist()


@pytest.mark.parametrize("cells", ["TRIANGLES", "QUADS"])
def test_a_drawing_that_is_scaled_up_gets_no_mass_of_faces_meanwhile(cells, drawn):
    drawing, body = drawn
    body.gridmesh_live.cells = cells
    bpy.context.view_layer.update()
    engine.settle()
    before, height = len(body.data.polygons), np.ptp(vertices(body.data)[:, 1])
    for factor in (1.5, 3, 6, 12, 24):
        redraw(drawing, bean() * factor)
        assert np.ptp(vertices(body.data)[:, 1]) == pytest.approx(factor * height, rel=0.05), (
            "it does not follow"
        )
        assert len(body.data.polygons) < 6 * before
    engine.settle()
    assert len(body.data.polygons) == pytest.approx(before, rel=0.15)


def test_the_mesh_does_not_pop(drawn):
    drawing, body = drawn
    body.gridmesh_live.triangles = 2000
    bpy.context.view_layer.update()
    engine.settle()
    edge = body.gridmesh_live.lattice[0]
    random = np.random.default_rng(5)
    changed, before, amount = [], turns(body), 0.0
    for _ in range(60):
        amount += random.uniform(-0.9, 0.9) * edge
        redraw(drawing, bump(bean(), amount, width=8.0))
        now = turns(body)
        alike = difflib.SequenceMatcher(None, now, before, autojunk=False).get_matching_blocks()
        changed.append(1 - sum(block.size for block in alike) / len(now))
        before = now
    print(f"boundary changed by a move: median {np.median(changed):.3f}, most {max(changed):.3f}")
    assert max(changed) > 0, "nothing has moved"
    assert np.median(changed) <= 0.1


def test_the_result_depends_on_the_stroke_alone(drawn):
    drawing, body = drawn
    for step in range(5):
        redraw(drawing, bump(bean(), 0.05 * step, at=70))
    redraw(drawing, bump(bean(), 0.2))
    engine.settle()
    activate(drawing)
    other = run_one(update_existing=False)
    assert np.array_equal(triangles(other.data), triangles(body.data))
    assert np.abs(world_vertices(other) - world_vertices(body)).max() < 1e-5


def test_vertex_data_is_kept_where_the_triangles_are(drawn):
    drawing, body = drawn
    group = body.vertex_groups.new(name="Weights")
    group.add([0, 5], 0.5, "REPLACE")
    redraw(drawing, bump(bean(), 1e-4))
    assert body.vertex_groups["Weights"].weight(5) == 0.5


def test_options_of_the_body_are_followed(drawn):
    _, body = drawn
    body.gridmesh_live.triangles = 1500
    bpy.context.view_layer.update()
    assert abs(len(body.data.polygons) / 3000 - 1) < 0.1
    body.gridmesh_live.shape = "SHEET"
    bpy.context.view_layer.update()
    assert np.ptp(vertices(body.data)[:, 2]) == 0


def test_moving_the_drawing_moves_the_body(drawn):
    drawing, body = drawn
    place = body.matrix_world.translation.copy()
    before = vertices(body.data)
    drawing.location = (3, 1, 0.5)
    drawing.rotation_euler = (0.3, 0, 0)
    bpy.context.view_layer.update()
    engine.settle()
    bpy.context.view_layer.update()
    assert (body.matrix_world.translation - place).length > 2
    assert len(vertices(body.data)) == pytest.approx(len(before), rel=0.05)
    child_rotation = body.matrix_world.to_quaternion().angle
    assert child_rotation == pytest.approx(0.3, abs=1e-3)


def test_switched_off_nothing_happens(drawn):
    drawing, body = drawn
    before = bytes_of(body)
    body.gridmesh_live.enabled = False
    redraw(drawing, bump(bean(), 0.3))
    assert bytes_of(body) == before
    body.gridmesh_live.enabled = True
    assert bytes_of(body) != before


def test_frozen_it_is_a_plain_mesh(drawn):
    drawing, body = drawn
    activate(body)
    assert bpy.ops.object.gridmesh_freeze() == {"FINISHED"}
    before = bytes_of(body)
    assert not frames.is_linked(body)
    assert list(body.keys()) == []
    redraw(drawing, bump(bean(), 0.3))
    engine.settle()
    assert bytes_of(body) == before
    assert not bpy.ops.object.gridmesh_freeze.poll()


def test_in_the_background_it_waits_until_asked(drawn, monkeypatch):
    drawing, body = drawn
    monkeypatch.setattr(engine, "in_background", False)
    before = bytes_of(body)
    redraw(drawing, bump(bean(), 0.3))
    assert engine.settle() == 0
    assert bytes_of(body) == before
    activate(body)
    bpy.ops.object.gridmesh_adopt()
    assert bytes_of(body) != before


def test_another_version_is_left_alone_until_adopted(drawn):
    drawing, body = drawn
    body.gridmesh_live.algorithm = 0
    before = bytes_of(body)
    redraw(drawing, bump(bean(), 0.3))
    assert bytes_of(body) == before
    assert "Adopt" in body.gridmesh_live.problem
    activate(body)
    bpy.ops.object.gridmesh_adopt()
    assert bytes_of(body) != before
    assert body.gridmesh_live.problem == ""


def test_renamed_and_deleted(drawn):
    drawing, body = drawn
    drawing.name, body.name = "Other", "Thing"
    before = bytes_of(body)
    redraw(drawing, bump(bean(), 0.2))
    assert bytes_of(body) != before
    before = bytes_of(body)
    activate(drawing)
    bpy.ops.object.delete()
    bpy.context.view_layer.update()
    engine.settle()
    assert bytes_of(body) == before
    assert body.gridmesh_live.source is None
    assert "gone" in body.gridmesh_live.problem
    assert "Other" not in bpy.data.objects or bpy.data.objects["Other"].users == 0


def test_duplicates_follow_their_own_drawing(drawn):
    drawing, body = drawn
    activate(body, drawing)
    bpy.ops.object.duplicate()
    copies = [ob for ob in bpy.context.selected_objects if ob not in (drawing, body)]
    copy = next(ob for ob in copies if ob.type == "MESH")
    source = next(ob for ob in copies if ob.type != "MESH")
    assert copy.gridmesh_live.source == source
    before, other = bytes_of(body), bytes_of(copy)
    redraw(source, bump(bean(), 0.3))
    assert bytes_of(body) == before
    assert bytes_of(copy) != other


def test_saved_opened_and_appended(drawn, tmp_path):
    drawing, body = drawn
    redraw(drawing, bump(bean(), 0.1))
    path = str(tmp_path / "live.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    saved = bytes_of(body)
    bpy.ops.wm.open_mainfile(filepath=path)
    body = bpy.data.objects["Drawing.mesh"]
    bpy.context.view_layer.update()
    engine.settle()
    assert bytes_of(body) == saved
    redraw(bpy.data.objects["Drawing"], bump(bean(), 0.3))
    assert bytes_of(body) != saved
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(path) as (there, here):
        here.objects = [name for name in there.objects if name == "Drawing.mesh"]
    body = here.objects[0]
    bpy.context.scene.collection.objects.link(body)
    source = body.gridmesh_live.source
    assert source is not None
    bpy.context.scene.collection.objects.link(source)
    bpy.context.view_layer.update()
    before = bytes_of(body)
    redraw(source, bump(bean(), 0.4))
    assert bytes_of(body) != before


def test_undo_and_redo():
    drawing = grease_pencil([bean()])
    bpy.ops.ed.undo_push(message="base")
    bpy.ops.object.gridmesh_from_strokes("EXEC_DEFAULT", True, triangles=500, follow=True)
    engine.settle()
    name = "Drawing.mesh"
    first = bytes_of(bpy.data.objects[name])
    bpy.ops.ed.undo_push(message="made")
    redraw(bpy.data.objects["Drawing"], bump(bean(), 0.3))
    second = None
    engine.settle()
    second = bytes_of(bpy.data.objects[name])
    bpy.ops.ed.undo_push(message="edited")
    bpy.ops.ed.undo()
    assert bytes_of(bpy.data.objects[name]) == first
    bpy.ops.ed.redo()
    assert bytes_of(bpy.data.objects[name]) == second
    assert drawing is not None


def test_a_stroke_before_it_is_deleted():
    drawing = grease_pencil([circle(60, 0.5, (5, 0)), bean()])
    activate(drawing)
    bpy.ops.object.gridmesh_from_strokes(triangles=500, follow=True)
    engine.settle()
    left, right = sorted(engine.bodies(), key=lambda ob: ob.matrix_world.translation.x)
    before = bytes_of(left)
    gone = bytes_of(right)
    drawing.data.layers[0].current_frame().drawing.remove_strokes(indices=[0])
    drawing.data.update_tag()
    bpy.context.view_layer.update()
    engine.settle()
    assert bytes_of(left) == before
    assert left.gridmesh_live.stroke == 0
    assert bytes_of(right) == gone
    assert "gone" in right.gridmesh_live.problem


def test_curves_are_followed_and_thick_ones_named():
    ob = curve([bean()])
    body = run_one(follow=True)
    engine.settle()
    before = bytes_of(body)
    for point in ob.data.splines[0].points[30:50]:
        point.co.x *= 1.05
    ob.data.update_tag()
    bpy.context.view_layer.update()
    assert bytes_of(body) != before
    ob.data.bevel_depth = 0.1
    bpy.context.view_layer.update()
    assert "bevel" in body.gridmesh_live.problem


def test_crossing_itself_it_waits(drawn):
    drawing, body = drawn
    before = bytes_of(body)
    points = bean()
    points[40] = -2 * points[40]
    redraw(drawing, points)
    assert bytes_of(body) == before
    assert body.gridmesh_live.problem
    redraw(drawing, bean())
    engine.settle()
    assert bytes_of(body) == before
    assert body.gridmesh_live.problem == ""


def widening():
    """A live body of a bean whose line gets wider and wider."""
    drawing = grease_pencil([bean()])
    data = drawing.data.layers[0].current_frame().drawing
    radius = np.linspace(0.01, 0.05, 120, dtype=np.float32)
    if data.attributes.get("radius") is None:
        data.attributes.new("radius", "FLOAT", "POINT")
    data.attributes["radius"].data.foreach_set("value", radius)
    body = run_one(follow=True)
    engine.settle()
    return body


def test_the_pen_gives_more_faces():
    body = widening()

    def share():
        points = vertices(body.data)
        angle = np.arctan2(points[:, 1], points[:, 0]) % (2 * np.pi)
        return (angle > 4.8).sum() / (angle < 1.5).sum()

    even, count = share(), len(body.data.polygons)
    body.gridmesh_live.pen_detail = 1.0
    bpy.context.view_layer.update()
    assert share() > 1.15 * even
    assert len(body.data.polygons) == pytest.approx(count, rel=0.1)
    body.gridmesh_live.bend = 0.0
    bpy.context.view_layer.update()
    straight = share()
    body.gridmesh_live.pen_detail = 0.0
    bpy.context.view_layer.update()
    assert share() == straight
    assert body.gridmesh_live.problem == ""


def test_the_pen_makes_it_thick():
    body = widening()
    even = vertices(body.data)
    body.gridmesh_live.pen = 1.0
    bpy.context.view_layer.update()
    thick = vertices(body.data)
    assert len(thick) == len(even)
    change = np.abs(thick[:, 2]) - np.abs(even[:, 2])
    angle = np.arctan2(even[:, 1], even[:, 0]) % (2 * np.pi)
    inside = np.abs(even[:, 2]) > 0.1
    assert change[inside & (angle < 1.5)].mean() < -0.05
    assert change[inside & (angle > 4.8)].mean() > 0.05
