"""Drawing bodies: what the operator makes of a stroke. The gestures themselves are tried in a window."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from drawings import bean, check_body, circle, fingerprint, world_vertices
from mathutils import Matrix

from addon.data import frames
from addon.draw import preview
from addon.draw.gesture import Gesture, pack, unpack
from addon.live import engine

pytestmark = pytest.mark.usefixtures("awake")


def draw(points, pressure=None, matrix=None, **options):
    """Draw a stroke in the plane z = 0, or that of a matrix."""
    flat = np.asarray(points, float)[:, :2]
    pressure = np.ones(len(flat)) if pressure is None else pressure
    options = {"triangles": 600, **options}
    place = np.eye(4) if matrix is None else matrix
    return bpy.ops.object.gridmesh_draw(
        "EXEC_DEFAULT", True, stroke=pack(flat, pressure), matrix=place.ravel().tolist(), **options
    )


def only_body():
    (body,) = engine.bodies()
    return body


@pytest.mark.smoke
def test_a_stroke_becomes_a_body_with_its_outline():
    assert draw(bean()) == {"FINISHED"}
    body = only_body()
    check_body(body)
    assert body.gridmesh_live.source.type == "GREASEPENCIL"
    assert body.gridmesh_live.enabled
    assert bpy.context.view_layer.objects.active == body
    low, high = world_vertices(body).min(axis=0), world_vertices(body).max(axis=0)
    assert np.allclose([low[:2], high[:2]], [bean()[:, :2].min(axis=0), bean()[:, :2].max(axis=0)], atol=0.03)


def test_a_hole_is_made_with_shift():
    draw(circle(100, 2))
    assert draw(circle(40, 0.5, (0.4, 0)), subtract=True) == {"FINISHED"}
    check_body(only_body(), genus=1)


def test_from_inside_it_extends():
    draw(circle(100, 2))
    before = np.ptp(world_vertices(only_body())[:, 0])
    assert draw(circle(60, 0.8, (2, 0), start=np.pi)) == {"FINISHED"}
    check_body(only_body())
    assert np.ptp(world_vertices(only_body())[:, 0]) == pytest.approx(before + 0.8, abs=0.05)


def test_with_shift_it_trims():
    draw(circle(100, 2))
    assert draw(circle(60, 0.8, (2, 0)), subtract=True) == {"FINISHED"}
    check_body(only_body())
    assert world_vertices(only_body())[:, 0].max() < 1.95


def test_trimmed_apart_it_becomes_two():
    draw(circle(100, 2))
    bar = [(x, -3) for x in np.linspace(-0.3, 0.3, 10)] + [(x, 3) for x in np.linspace(0.3, -0.3, 10)]
    assert draw(bar, subtract=True) == {"FINISHED"}
    bodies = engine.bodies()
    assert len(bodies) == 2
    for body in bodies:
        check_body(body)
        assert body.gridmesh_live.problem == ""
    assert all(body.gridmesh_live.source.parent == body for body in bodies)
    assert engine.settle() in (0, 1, 2)
    assert len({np.sign(world_vertices(body)[:, 0].mean()) for body in bodies}) == 2


def parted():
    """A disk of radius 2, parted by a bar; the left and the right body."""
    draw(circle(100, 2))
    bar = [(x, -3) for x in np.linspace(-0.3, 0.3, 10)] + [(x, 3) for x in np.linspace(0.3, -0.3, 10)]
    draw(bar, subtract=True)
    engine.settle()
    return sorted(engine.bodies(), key=lambda ob: world_vertices(ob)[:, 0].mean())


SHEARED = Matrix.Diagonal((1, 1, 2, 1)) @ Matrix.Rotation(0.6, 4, "Y") @ Matrix.Diagonal((1, 2, 1.5, 1))


@pytest.mark.parametrize("how", ["parent", "applied", "both"])
def test_parts_of_a_sheared_body_are_sheared_as_it_was(how):
    draw(circle(100, 2))
    body = only_body()
    if how != "applied":
        above = bpy.data.objects.new("above", None)
        bpy.context.collection.objects.link(above)
        above.matrix_world = SHEARED
        body.parent = above
        bpy.context.view_layer.update()
    if how != "parent":
        body.matrix_basis = Matrix.Rotation(0.4, 4, "Y") @ Matrix.Diagonal((1, 1, 1.5, 1))
        bpy.context.view_layer.update()
        bpy.ops.object.transform_apply()
        body.rotation_euler, body.scale = (0.3, 0.2, 0.1), (1, 1.2, 1.8)
    bpy.context.view_layer.update()
    engine.settle()
    world = frames.place(body)
    inside = frames.moved(world_vertices(body), np.linalg.inv(world))
    assert np.hypot(*inside[:, :2].T).max() == pytest.approx(2.0, abs=0.01)
    bar = [(x, -3) for x in np.linspace(-0.3, 0.3, 10)] + [(x, 3) for x in np.linspace(0.3, -0.3, 10)]
    # In the body's plane: the stroke falls on it where it was drawn without the shear.
    flat = frames.moved(np.c_[bar, np.zeros(len(bar))], world)
    axes = np.linalg.qr(world[:3, :2])[0]
    plane = np.eye(4)
    plane[:3, :3], plane[:3, 3] = np.c_[axes, np.cross(*axes.T)], world[:3, 3]
    assert draw(frames.moved(flat, np.linalg.inv(plane))[:, :2], matrix=plane, action="TRIM") == {"FINISHED"}
    bodies = engine.bodies()
    assert len(bodies) == 2
    for part in bodies:
        check_body(part)
        assert part.gridmesh_live.problem == ""
        inside = frames.moved(world_vertices(part), np.linalg.inv(world))
        assert np.hypot(*inside[:, :2].T).max() == pytest.approx(2.0, abs=0.01), "not sheared as the body was"
        assert np.abs(frames.place(part)[:3, :3] - world[:3, :3]).max() < 1e-5
    after = np.concatenate([world_vertices(part) for part in bodies])
    engine.settle()
    again = np.concatenate([world_vertices(part) for part in bodies])
    assert np.abs(again - after).max() < 1e-5


@pytest.mark.parametrize("start", [np.pi, 0])
def test_a_bridge_joins_what_a_bar_has_parted(start):
    left, right = parted()
    child = bpy.data.objects.new("child", None)
    bpy.context.collection.objects.link(child)
    child.parent, child.location = (right if start else left), (3, 0, 0)  # of the body that goes
    bpy.context.view_layer.update()
    place = child.matrix_world.copy()
    assert draw(circle(60, 1, start=start)) == {"FINISHED"}
    engine.settle()
    body = only_body()
    check_body(body)
    assert body.gridmesh_live.problem == ""
    assert np.ptp(world_vertices(body)[:, 0]) == pytest.approx(4, abs=0.05)
    assert child.parent == body
    assert np.allclose(child.matrix_world, place)
    assert all(mesh.users for mesh in bpy.data.meshes)
    strokes = body.gridmesh_live.source.data.layers[0].current_frame().drawing.strokes
    assert len(strokes) == body.gridmesh_live.count == 1


def test_a_bridge_leaves_holes_that_it_does_not_cover():
    parted()
    draw(circle(40, 0.3, (1.1, 0)), subtract=True)
    draw(circle(40, 0.3, (-1.1, 0)), subtract=True)
    assert draw(circle(60, 0.5, start=np.pi)) == {"FINISHED"}
    engine.settle()
    check_body(only_body(), genus=2)


def test_what_an_extension_does_not_reach_stays():
    left, right = parted()
    before = world_vertices(left)
    assert draw(circle(40, 0.5, (2, 0), start=np.pi)) == {"FINISHED"}
    engine.settle()
    assert len(engine.bodies()) == 2
    check_body(right)
    assert np.array_equal(world_vertices(left), before)


def test_a_hole_drawn_over_a_hole_keeps_others_of_the_drawing():
    left, right = parted()
    before = world_vertices(left)
    assert draw(circle(40, 0.3, (1.1, 0)), subtract=True) == {"FINISHED"}
    engine.settle()
    check_body(right, genus=1)
    assert np.array_equal(world_vertices(left), before)
    assert left.gridmesh_live.problem == ""


def test_apart_is_another_body():
    draw(circle(60, 1))
    draw(circle(60, 1, (5, 0)))
    assert len(engine.bodies()) == 2


@pytest.mark.parametrize("points", [circle(4), [(0, 0)] * 20, [(x, 0) for x in range(20)]])
def test_what_is_no_outline_leaves_nothing(points):
    before = fingerprint()
    assert draw(points) == {"CANCELLED"}
    assert fingerprint() == before


def test_subtracting_from_nothing_leaves_nothing():
    before = fingerprint()
    assert draw(circle(40), subtract=True) == {"CANCELLED"}
    assert fingerprint() == before


def test_a_cut_that_leaves_nothing_sound_is_refused():
    draw(circle(100, 2))
    engine.settle()
    before = fingerprint()
    assert draw(circle(100, 1.999, (0, 0)), subtract=True, triangles=600) == {"CANCELLED"}
    assert fingerprint() == before


def test_undo_takes_back_one_stroke():
    bpy.ops.ed.undo_push(message="base")
    draw(circle(100, 2))
    draw(circle(40, 0.5), subtract=True)
    bpy.ops.ed.undo()
    check_body(only_body())
    bpy.ops.ed.undo()
    assert engine.bodies() == []
    assert [ob for ob in bpy.data.objects if ob.type == "GREASEPENCIL"] == []


def test_pressure_is_recorded_and_makes_it_thick():
    pressure = np.where(circle(100)[:, 0] > 0, 1.0, 0.3)
    draw(circle(100), pressure, pen=1.0)
    body = only_body()
    points = world_vertices(body)
    right, left = points[points[:, 0] > 0.5, 2].max(), points[points[:, 0] < -0.5, 2].max()
    assert right > 1.5 * left
    drawing = body.gridmesh_live.source.data.layers[0].current_frame().drawing
    radius = np.empty(100, np.float32)
    drawing.attributes["radius"].data.foreach_get("value", radius)
    assert radius.max() == pytest.approx(radius.min() / 0.3, rel=1e-3)


def test_the_outline_drawn_is_followed():
    draw(circle(100, 2))
    body = only_body()
    source = body.gridmesh_live.source
    drawing = source.data.layers[0].current_frame().drawing
    points = circle(100, 2) * [1.5, 1, 1]
    drawing.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    drawing.tag_positions_changed()
    bpy.context.view_layer.update()
    engine.settle()
    assert np.ptp(world_vertices(body)[:, 0]) == pytest.approx(6, abs=0.1)


def test_the_preview_stands_still_while_the_stroke_grows():
    gesture = Gesture(1000)
    lengths, sizes = [], []
    for point in circle(200, 1.0, turn=1.9 * np.pi, closed=False):
        gesture.add(tuple(300 * point[:2]), point[:2], 1.0)
        grid = gesture.preview()
        if grid is not None:
            lengths.append(gesture.edge_length)
            sizes.append(len(grid[1]))
    assert len(set(lengths)) < 25
    assert max(sizes) < 2200
    assert 500 < sizes[-1] < 1900


def test_a_stroke_as_text():
    points, pressure = circle(30)[:, :2], np.linspace(0, 1, 30)
    again = unpack(pack(points, pressure))
    assert np.array_equal(again[0], points)
    assert np.array_equal(again[1], pressure)
    assert draw(bean()) == {"FINISHED"}
    assert bpy.ops.object.gridmesh_draw("EXEC_DEFAULT") == {"CANCELLED"}


@pytest.mark.parametrize(
    ("sidebar", "free"),
    [
        (None, 1000),
        ((1099, 1), 1000),  # closed
        ((820, 280), 720),  # over the view
        ((1100, 280), 1000),  # beside it
        ((100, 280), 1000),  # on the left
    ],
)
def test_words_at_the_mouse_are_not_written_below_the_sidebar(sidebar, free):
    view = SimpleNamespace(type="WINDOW", x=100, width=1000)
    side = [SimpleNamespace(type="UI", x=sidebar[0], width=sidebar[1])] if sidebar else []
    assert preview.free_width(SimpleNamespace(regions=[view, *side]), view) == free
