"""Bodies that follow their stroke, and what is seen of their quality, with mouse and keyboard in a window."""

from time import perf_counter, process_time

import bpy
import numpy as np
from setting import (
    begin,
    bodies,
    extent,
    fresh,
    modules,
    outlines,
    ring,
    select,
    stage,
    stroke,
    tool,
    turn_view,
)


def edited(source, point, *, proportional=0.0):
    """The outline in Edit Mode with one point selected."""
    select(source)
    settings = bpy.context.scene.tool_settings
    with stage.override():
        bpy.ops.wm.tool_set_by_id(name="builtin.select_box")
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.grease_pencil.select_all(action="DESELECT")
    settings.use_proportional_edit = proportional > 0
    if proportional:
        settings.proportional_size = proportional
    drawing = source.data.layers[0].current_frame().drawing
    drawing.strokes[0].points[point].select = True
    bpy.ops.ed.undo_push(message="Select a point")
    yield 0.5


def click():
    """Click where the mouse is."""
    yield from stage.press("LEFTMOUSE", "PRESS")
    yield from stage.press("LEFTMOUSE", "RELEASE")
    yield 1.5


def live_edit():
    """Points of the outline are moved: the body follows, and goes back with undo."""
    yield from begin()
    x, y = stage.middle()
    x -= 100
    yield from stroke(ring((x, y), 170, 120, wobble=0.2))
    body = bodies()[0]
    body.gridmesh_live.triangles = 2500
    yield 0.5
    yield from edited(body.gridmesh_live.source, 10, proportional=0.6)
    before, width = body.gridmesh_live.digest, extent(body)
    assert before, "it is not made in full"
    yield from stage.move(x + 100, y)
    yield from stage.key("G")
    for k in range(15):
        yield from stage.move(x + 100 + 8 * k, y + 6 * k)
    assert body.gridmesh_live.digest == "", "it did not follow while being dragged"
    yield from stage.picture("live_1_dragged")
    yield 1.0
    assert body.gridmesh_live.digest == "", "the drag is not over"
    yield from click()
    assert body.gridmesh_live.digest not in ("", before), "it is not made in full after the drag"
    yield from stage.picture("live_2_released")
    yield from stage.key("Z", ctrl=True)
    yield 1.0
    body = bodies()[0]
    assert body.gridmesh_live.digest == before, "undo left the body behind"
    assert abs(extent(body) - width) < 1e-6
    with stage.override():
        bpy.ops.object.mode_set(mode="OBJECT")


def live_sculpt():
    """The outline is sculpted, with the brush that grabs: the body follows during the stroke of the brush."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y), 150, 90))
    body = bodies()[0]
    select(body.gridmesh_live.source)
    with stage.override():
        bpy.ops.object.mode_set(mode="SCULPT_GREASE_PENCIL")
        bpy.ops.brush.asset_activate(
            asset_library_type="ESSENTIALS",
            relative_asset_identifier="brushes/essentials_brushes-gp_sculpt.blend/Brush/Grab",
        )
    yield 1.0
    before, width = body.gridmesh_live.digest, extent(body)
    yield from stage.move(x + 150, y)
    yield from stage.press("LEFTMOUSE", "PRESS")
    for k in range(15):
        yield from stage.move(x + 150 + 6 * k, y)
    assert extent(body) > width * 1.05, "it did not follow the brush"
    yield from stage.picture("live_sculpt")
    yield from stage.press("LEFTMOUSE", "RELEASE")
    yield 1.5
    assert body.gridmesh_live.digest not in ("", before), "it is not made in full after the stroke"
    yield from stage.move(x, y)
    yield from stage.key("Z", ctrl=True)
    yield 1.0
    (body,) = bodies()
    assert body.gridmesh_live.digest == before, "undo left the body behind"
    with stage.override():
        bpy.ops.object.mode_set(mode="OBJECT")


def live_move():
    """The outline alone is moved with G: the mesh comes along inside the object; Esc brings both back, and undo."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 100, y), 120, 60, wobble=0.2))
    yield from tool("builtin.select_box")
    body = bodies()[0]
    start, place, triangles = middle(body), body.matrix_world.copy(), len(body.data.polygons)
    select(body.gridmesh_live.source)
    bpy.ops.ed.undo_push(message="Select")
    for end in ("ESC", "LEFTMOUSE"):
        yield from stage.move(x, y)
        yield from stage.key("G")
        for k in range(12):
            yield from stage.move(x + 12 * k, y + 4 * k)
        assert np.linalg.norm(middle(body) - start) > 0.5, "it did not come along"
        yield from stage.press(end, "PRESS")
        yield from stage.press(end, "RELEASE")
        yield 1.5
        moved = np.linalg.norm(middle(body) - start)
        assert (moved > 0.5) == (end == "LEFTMOUSE"), end
    assert body.matrix_world == place, "the object was moved"
    assert abs(len(body.data.polygons) - triangles) < 0.1 * triangles
    yield from stage.picture("live_moved")
    yield from stage.key("Z", ctrl=True)
    yield 1.0
    (body,) = bodies()
    assert np.linalg.norm(middle(body) - start) < 1e-5, "undo left the body behind"


def middle(body):
    """Middle of a body's bounds, in its own space."""
    points = np.empty(len(body.data.vertices) * 3, np.float32)
    body.data.vertices.foreach_get("co", points)
    points = points.reshape(-1, 3).astype(float)
    return (points.min(axis=0) + points.max(axis=0)) / 2


def live_panel():
    """The panel of a live body: its switch, and Freeze, which leaves a plain mesh; each by a click."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 80, y), 150, 60, wobble=0.2))
    yield from stage.open_sidebar()
    yield from stage.picture("live_panel")
    at = stage.region("UI")
    switch = "gridmesh_live.enabled", (at.x + 29, at.x + 24, at.x + 34), at.y + 500, at.y + 420
    yield from stage.press_property(*switch)
    assert not bodies()[0].gridmesh_live.enabled, "the switch does nothing"
    yield from stage.press_property(*switch)
    assert bodies()[0].gridmesh_live.enabled
    yield from stage.press_button("UI", "gridmesh_freeze")
    assert not bodies(), "it is not frozen"
    assert len([ob for ob in bpy.data.objects if ob.type == "MESH"]) == 1
    yield from stage.move(x, y)
    yield from stage.key("Z", ctrl=True)
    yield 1.0
    assert len(bodies()) == 1, "undo does not thaw it"


def live_curve():
    """The profile curve of a body: a shape to start from by a click, then a point of it is dragged, and undone."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 110, y), 150, 60, wobble=0.2))
    turn_view()
    yield from stage.open_sidebar()
    body = bodies()[0]
    yield from stage.press_button("UI", "gridmesh_curve")
    curves = modules("bodies.profilecurve")
    assert curves.points(body) == curves.SHAPES["ROUND"], "the button adds no curve"
    yield from press_shape("RING")
    assert len(curves.points(body)) == len(curves.SHAPES["RING"]), "the button of the ring does nothing"
    yield from stage.picture("live_curve_1_ring")
    row = yield from press_shape("PLATEAU")
    start = curves.points(body)
    before, digest = heights(body), body.gridmesh_live.digest
    assert digest, "it is not made in full"
    own = modules("live.engine").timing
    own.clear()
    at = on_curve(row, *start[1][:2])
    yield from stage.move(*at)
    yield from stage.press("LEFTMOUSE", "PRESS")
    seen = []
    for k in range(1, 13):
        yield from stage.move(at[0] + k, at[1] - 4 * k)
        seen.append(body.gridmesh_live.digest)
    yield from stage.press("LEFTMOUSE", "RELEASE")
    yield 0.5
    assert curves.points(body)[1] != start[1], "the point was not dragged"
    assert len(set(seen)) > 3, "the body did not follow while the point was dragged"
    print(
        f"NUMBERS curve: {len(body.data.polygons)} triangles, {len(own)} updates, "
        f"least {1000 * min(own):.1f} ms, median {1000 * np.median(own):.1f} ms"
    )
    assert abs(heights(body) - before).max() > 0.01
    yield from stage.picture("live_curve")
    yield from stage.move(x, y)
    yield from stage.key("Z", ctrl=True)
    yield 1.0
    (body,) = bodies()
    assert curves.points(body) == start, "undo does not take the drag back"
    assert abs(heights(body) - before).max() == 0, "undo left the body behind"


def heights(body):
    """Heights of a body's vertices."""
    points = np.empty(len(body.data.vertices) * 3, np.float32)
    body.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)[:, 2]


def on_curve(row, x, y):
    """Where a point of the unit square is on the window; row : height of the buttons above the curve."""
    at = stage.region("UI")
    return at.x + 8 + 237 * x, row - 203 + 168 * y


def press_shape(shape):
    """Click one of the buttons in the row above the curve."""
    row = yield from stage.buttons("UI", "gridmesh_curve")
    at = stage.region("UI")
    for x in range(at.x + 6, at.x + at.width - 20, 9):
        yield from stage.move(x, row[0][1] - 6)
        if f"'{shape}'" in stage.asked("UI"):
            yield from stage.click(x, row[0][1] - 6)
            yield 0.8
            return row[0][1]
    raise AssertionError(f"no button for {shape}")


def live_timing():
    """One point of a stroke of 500 moves to and fro: how long a body of 5000 triangles takes."""
    yield from fresh()
    t = np.linspace(0, 2 * np.pi, 500, endpoint=False)
    shape = (1.6 * (1 + 0.25 * np.cos(3 * t)))[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)
    front = np.eye(4)
    front[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    bpy.ops.object.gridmesh_draw(
        "EXEC_DEFAULT",
        stroke=modules("draw.gesture").pack(shape, np.ones(500)),
        matrix=front.ravel().tolist(),
        triangles=2500,
    )
    yield 1.0
    body = bodies()[0]
    yield from edited(outlines()[0], 40)
    wall, cpu, own = [], [], modules("live.engine").timing
    began = []

    def start(*_):
        if not began:
            began[:] = perf_counter(), process_time()

    def end(*_):
        # Again for each round of Blender's update; the last one counts.
        if began:
            seen[:] = perf_counter() - began[0], process_time() - began[1]

    seen = []
    x, y = stage.middle()
    yield from stage.move(x, y)
    yield from stage.key("G")
    own.clear()
    bpy.app.handlers.depsgraph_update_pre.append(start)
    bpy.app.handlers.depsgraph_update_post.append(end)
    try:
        for k in range(60):
            began.clear()
            seen.clear()
            followed = len(own)
            yield from stage.move(x + k % 7, y + k % 5)
            if seen and len(own) > followed:
                wall.append(1000 * seen[0])
                cpu.append(1000 * seen[1])
    finally:
        bpy.app.handlers.depsgraph_update_pre.remove(start)
        bpy.app.handlers.depsgraph_update_post.remove(end)
    yield from stage.picture("live_timing")
    yield from click()
    assert len(own) > 30, "the body did not follow every move"
    inside = 1000 * np.array(own[:-1])
    print(
        f"NUMBERS live: {len(body.data.polygons)} triangles, {len(inside)} updates, with Blender's own least "
        f"{min(wall):.1f} ms, median {np.median(wall):.1f} ms, median of processor time {np.median(cpu):.1f} ms; "
        f"the body alone least {inside.min():.1f} ms, median {np.median(inside):.1f} ms"
    )
    with stage.override():
        bpy.ops.object.mode_set(mode="OBJECT")


def quality():
    """Irregular vertices in the viewport, of a body and of a mesh that is not ours; switched on in the menu."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 150, y), 150, 60, wobble=0.25))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, location=(2.1, 0, 0), radius=1.3)
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob.type == "MESH")
    bpy.context.view_layer.objects.active = bodies()[0]
    stage.view.spaces.active.overlay.show_wireframes = True
    yield 0.5
    manager = bpy.context.window_manager
    try:
        yield from stage.move(x, y)
        with stage.override():
            bpy.ops.wm.call_panel(name="VIEW3D_PT_overlay", keep_open=True)
        yield 0.8
        yield from stage.picture("quality_menu")
        yield from stage.click(x, y + 121)  # the first entry; Blender names nothing in menus that pop up
        assert manager.gridmesh_quality, "the switch in the Overlays menu does nothing"
        yield from stage.move(x, y)
        yield from stage.key("ESC")
        yield 0.5
        yield from stage.picture("quality")
    finally:
        manager.gridmesh_quality = False


SCENES = (live_edit, live_sculpt, live_move, live_panel, live_curve, live_timing, quality)
