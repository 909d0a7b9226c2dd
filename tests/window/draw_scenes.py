"""Drawing bodies: every gesture of the tool, with the mouse in a window."""

import bpy
import mathutils
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from setting import (
    begin,
    bodies,
    extent,
    fresh,
    limb,
    modules,
    numbers_of,
    outlines,
    ring,
    stage,
    stroke,
    turn_view,
)


def left_behind():
    """Draw handlers cannot be counted; what a preview leaves would be a data block or a running tool."""
    tools = [tool.bl_idname for tool in stage.window.modal_operators]
    return len(bpy.data.objects), len(bpy.data.meshes), tools


def euler(ob):
    """Euler characteristic: 2 for a ball, 0 with a hole."""
    mesh = ob.data
    return len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons)


def points_of(ob):
    """Number of points of an outline."""
    return sum(len(stroke.points) for stroke in ob.data.layers[0].current_frame().drawing.strokes)


def draw_body():
    """Drag draws, the grid is seen meanwhile, release makes the body; undo takes it back."""
    yield from begin()
    timing = modules("draw.operator").timing
    timing.clear()
    path = ring(stage.middle(), 190, 60, wobble=0.25)
    yield from stroke(path, picture="draw_1_preview", at=0.8)
    assert len(bodies()) == len(outlines()) == 1
    assert euler(bodies()[0]) == 2
    assert points_of(outlines()[0]) >= len(path) - 1, "points that came between two events were not read"
    moves = 1000 * np.array(timing)
    print(
        f"NUMBERS draw: {len(bodies()[0].data.polygons)} triangles in the end; per move least {moves.min():.1f} ms, "
        f"median {np.median(moves):.1f} ms, most {moves.max():.1f} ms"
    )
    yield from stage.picture("draw_2_body")
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    assert not bodies(), "undo left the body"
    assert not outlines(), "undo left the outline"


def draw_left():
    """Esc, the right button and Ctrl-Z leave nothing behind."""
    yield from begin()
    before = left_behind()
    x, y = stage.middle()
    for end in ("ESC", "RIGHTMOUSE"):
        yield from stroke(ring((x, y), 150)[:25], end=end)
        assert left_behind() == before, end
    yield from stage.move(x, y)
    yield from stage.press("LEFTMOUSE", "PRESS")
    yield from stage.glide(ring((x, y), 150)[:20])
    yield from stage.key("Z", ctrl=True)
    yield from stage.press("LEFTMOUSE", "RELEASE")
    yield 0.5
    assert left_behind() == before, "Ctrl-Z"
    yield from stage.picture("draw_left")


def draw_hole():
    """Shift inside a body makes a hole; undo takes back that stroke alone."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y), 200, 60))
    yield from stroke(ring((x + 20, y), 70, 30), picture="draw_hole_1", shift=True)
    assert [euler(ob) for ob in bodies()] == [0], "no hole"
    yield from stage.picture("draw_hole_2")
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    assert [euler(ob) for ob in bodies()] == [2], "undo took more or less than the hole"


def draw_across():
    """Across the outline it extends, wherever it begins; with Shift it trims."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y), 150, 60))
    before = extent(bodies()[0])
    yield from stroke(ring((x + 150, y), 80, 40, start=np.pi), picture="draw_extend_1")
    assert len(bodies()) == 1
    assert extent(bodies()[0]) > before * 1.15, "not extended"
    yield from stage.picture("draw_extend_2")
    longer = extent(bodies()[0])
    yield from stroke(ring((x - 190, y), 100, 40, start=np.pi), picture="draw_trim_1", shift=True)
    assert len(bodies()) == 1
    assert extent(bodies()[0]) < longer * 0.95, "not trimmed"
    yield from stage.picture("draw_trim_2")
    high = extent(bodies()[0], 1)
    yield from stroke(ring((x, y + 150), 60, 30, start=-0.5 * np.pi), shift=True)
    assert len(bodies()) == 1
    assert extent(bodies()[0], 1) < high * 0.98, "not trimmed with Shift from inside"
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    assert abs(extent(bodies()[0], 1) - high) < 1e-6, "undo took more or less than the last stroke"


def draw_apart():
    """With Shift a stroke right across leaves two bodies, each with its outline."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y), 150, 48))
    bar = [(x - 15, y - 200 + 20 * k) for k in range(21)] + [(x + 15, y + 200 - 20 * k) for k in range(21)]
    yield from stroke(bar, shift=True)
    assert [euler(ob) for ob in bodies()] == [2, 2]
    assert len(outlines()) == 2
    yield from stage.picture("draw_apart")


def draw_planes():
    """Every plane, in a view from the side: the body lies in it."""
    yield from begin()
    view = stage.view.spaces.active.region_3d
    turn_view(1.1, 0.0, 0.6)
    bpy.context.scene.cursor.rotation_euler = (0.4, 0.2, 0)
    turn = view.view_rotation.to_matrix()
    x, y = stage.middle()
    wanted = {
        "VIEW": turn.col[2],
        "CURSOR": bpy.context.scene.cursor.matrix.to_3x3().col[2],
        "X": mathutils.Vector((1, 0, 0)),
        "Y": mathutils.Vector((0, 1, 0)),
        "Z": mathutils.Vector((0, 0, 1)),
    }
    with stage.override():
        options = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT").operator_properties(
            "object.gridmesh_draw"
        )
    options.triangles = 300
    try:
        for choice, normal in wanted.items():
            for ob in list(bpy.data.objects):
                bpy.data.objects.remove(ob)
            options.plane = choice
            yield from stroke(ring((x, y), 120, 30))
            (body,) = bodies()
            assert abs(body.matrix_world.to_3x3().col[2].dot(normal)) > 0.999, choice
        for ob in list(bpy.data.objects):
            bpy.data.objects.remove(ob)
        bpy.ops.mesh.primitive_cube_add(size=2)
        options.plane = "SURFACE"
        at = stage.region("WINDOW")
        top = location_3d_to_region_2d(at, view, (0.3, 0.2, 1.0))
        yield from stroke(ring((at.x + top.x - 60, at.y + top.y), 60, 30), picture="draw_surface_1", at=0.6)
        (body,) = bodies()
        assert abs(body.matrix_world.to_3x3().col[2].z) > 0.999, "surface"
        assert abs(body.matrix_world.translation.z - 1) < 1e-3
        yield from stage.picture("draw_surface_2")
    finally:
        options.plane = "VIEW"
        options.property_unset("triangles")


def words():
    """What the word at the mouse says from now on, with its hint; the last is what was shown when the stroke ended."""
    preview = modules("draw.preview").Preview
    said = []
    say = getattr(preview.say, "original", preview.say)

    def listened(self, word, hint, mouse):
        said.append((word, hint))
        say(self, word, hint, mouse)

    listened.original = say
    preview.say = listened
    return said


def draw_head():
    """A head drawn over a body from its top extends it, and is said to; with Shift, pressed on the way, it trims."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y - 60), 150, 60))
    (body,) = bodies()
    before = extent(body, 1)
    said = words()
    head = ring((x, y + 140), 90, 45, start=0.5 * np.pi)
    yield from stroke(head, picture="draw_head_1", at=0.85)
    assert [ob.name for ob in bodies()] == [body.name], "another body"
    assert extent(body, 1) > 1.2 * before, "not extended"
    assert said[0][0].startswith("New Body"), said[0]
    assert said[-1][0] == f"Extend '{body.name}'", said[-1]
    yield from stage.picture("draw_head_2")
    higher = extent(body, 1)
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    (body,) = bodies()
    assert abs(extent(body, 1) - before) < 1e-6, "undo took more or less than the head"
    yield from stage.key("Z", ctrl=True, shift=True)
    yield 0.5
    assert abs(extent(bodies()[0], 1) - higher) < 1e-6, "redo"
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    said.clear()
    yield from stage.move(*head[0])
    yield from stage.press("LEFTMOUSE", "PRESS")
    yield from stage.glide(head[1:36])
    assert said[-1][0].startswith("Extend"), said[-1]
    yield from stage.press("LEFT_SHIFT", "PRESS", shift=True)
    assert said[-1][0].startswith("Trim"), said[-1]
    yield from stage.picture("draw_head_trim")
    yield from stage.press("LEFT_SHIFT", "RELEASE")
    assert said[-1][0].startswith("Extend"), said[-1]
    yield from stage.press("LEFT_SHIFT", "PRESS", shift=True)
    yield from stage.glide(head[36:], shift=True)
    yield from stage.press("LEFTMOUSE", "RELEASE", shift=True)
    yield 1.0
    assert extent(bodies()[0], 1) < before * 0.99, "not trimmed"


def draw_redo():
    """The redo panel acts on the body that was extended, and takes another action, to and fro."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y), 130, 48))
    (body,) = bodies()
    body.gridmesh_live.depth = 0.8
    yield 0.5
    yield from stroke(ring((x + 130, y), 80, 36, start=np.pi))
    (body,) = bodies()
    wide, thick = extent(body), extent(body, 2)
    assert bpy.context.window_manager.operators[-1].name == "Extend Body"
    assert abs(bpy.context.window_manager.operators[-1].depth - 0.8) < 1e-6, (
        "the panel has not the body's depth"
    )
    hud = yield from stage.open_redo_panel()
    yield from stage.picture("draw_redo_1")
    done = yield from numbers_of(hud, "depth", "0.3")
    assert done, "no field for the depth"
    (body,) = bodies()
    assert abs(extent(body) - wide) < 0.02, "no longer extended"
    assert extent(body, 2) < 0.5 * thick, "the depth does not act"
    assert abs(body.gridmesh_live.depth - 0.3) < 1e-6
    yield from stage.picture("draw_redo_2")
    for action, count in (("TRIM", 1), ("NEW", 2), ("EXTEND", 1)):
        bpy.context.window_manager.operators[-1].action = action
        with stage.override():
            bpy.ops.ed.undo_redo("EXEC_DEFAULT", True)  # with the undo step that the panel makes
        yield 0.6
        last = bpy.context.window_manager.operators[-1]
        assert last.action == action, (last.action, action)
        assert len(bodies()) == count, action
    (body,) = bodies()
    assert abs(extent(body) - wide) < 0.02
    yield from stage.picture("draw_redo_3")
    yield from stage.move(*stage.middle())
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    (body,) = bodies()
    assert extent(body) < 0.9 * wide, "more than one step for a stroke"


def draw_click():
    """A click selects what is under the mouse, with Shift too, and beside all nothing; nothing is drawn."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 150, y), 90, 36))
    yield from stroke(ring((x + 150, y), 90, 36))
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0, 0, -1.5))
    yield 0.5
    left, right = (ob.name for ob in sorted(bodies(), key=lambda ob: ob.matrix_world.translation.x))
    count = len(bpy.data.objects)

    def chosen():
        return {ob.name for ob in bpy.context.view_layer.objects if ob.select_get()}

    yield from stage.click(x - 150, y)
    assert chosen() == {left}, chosen()
    assert bpy.context.view_layer.objects.active.name == left
    yield from stage.click(x + 150, y, shift=True)
    assert chosen() == {left, right}, chosen()
    assert bpy.context.view_layer.objects.active.name == right
    yield from stage.picture("draw_click")
    yield from stage.click(x, y + 250)
    assert chosen() == set(), chosen()
    assert len(bpy.data.objects) == count
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    assert chosen() == {left, right}, chosen()


def draw_turned():
    """From a view that is turned by a few degrees a body is extended where it is, in its own plane."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 60, y), 120, 48))
    (body,) = bodies()
    wide, thick = extent(body), extent(body, 2)
    turn_view(np.pi / 2 - np.radians(4), 0.0, np.radians(5))
    yield 0.4
    said = words()
    yield from stroke(ring((x + 70, y), 80, 40, start=np.pi), picture="draw_turned_1")
    assert said[-1][0].startswith("Extend"), said[-1]
    (body,) = bodies()
    assert extent(body) > 1.2 * wide, "not extended"
    turn_view(0.0, 0.0, 0.0)
    yield from stage.picture("draw_turned_2")
    assert extent(body, 2) < 1.4 * thick, "it is bent out of its plane"
    assert body.gridmesh_live.problem == ""


def draw_bridge():
    """Two bodies of outlines of their own, bridged, become one; nothing is left of the other."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 170, y), 100, 40))
    yield from stroke(ring((x + 170, y), 100, 40))
    assert len(bodies()) == len(outlines()) == 2
    said = words()
    bar = [(x - 150 + 10 * k, y + 35) for k in range(31)] + [(x + 150 - 10 * k, y - 35) for k in range(31)]
    yield from stroke(bar, picture="draw_bridge_1", at=0.9)
    assert "+" in said[-1][0], said[-1]
    (body,) = bodies()
    assert euler(body) == 2
    assert len(outlines()) == 1, "an outline is left over"
    yield from stage.picture("draw_bridge_2")
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    assert len(bodies()) == len(outlines()) == 2, "undo"


def draw_eye():
    """An eye inside a face is told not to be seen; P makes it a part, the plane of the surface puts it on the face."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y), 180, 60))
    face = bodies()[0].name
    said = words()
    eye = ring((x - 60, y + 50), 35, 24)
    yield from stroke(eye, picture="draw_eye_1", at=0.9)
    assert "not visible" in said[-1][1], said[-1]
    assert len(bodies()) == 2
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    said.clear()
    yield from stroke(eye, keys=("P",), picture="draw_eye_part", at=0.9)
    assert said[-1][0] == f"Part of '{face}', In Front", said[-1]
    part = next(ob for ob in bodies() if ob.name != face)
    whole = modules("join.following").whole_of(part)
    assert whole == modules("join.following").whole_of(bpy.data.objects[face])
    assert whole.visible_get()
    yield from stage.key("Z", ctrl=True)
    yield 0.5
    with stage.override():
        options = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT").operator_properties(
            "object.gridmesh_draw"
        )
    options.plane = "SURFACE"
    try:
        said.clear()
        yield from stroke(eye)
        assert said[-1] == ("New Body", ""), said[-1]
    finally:
        options.plane = "VIEW"
    assert len(bodies()) == 2
    yield from stage.picture("draw_eye_2")


def draw_mirrored():
    """X while drawing: across the mirror a symmetric body, beside it two limbs of a body; both sides are seen."""
    yield from begin()
    x, y = stage.middle()
    half = [
        (x + 140 * np.sin(t) * (1 + 0.3 * np.cos(t)), y - 170 * np.cos(t))
        for t in np.linspace(-0.1, np.pi + 0.1, 40)
    ]
    yield from stroke(half, keys=("X",), picture="draw_mirrored_1", at=0.8)
    (body,) = bodies()
    assert body.gridmesh_live.mirror == "AUTO"
    data = outlines()[0].data.layers[0].current_frame().drawing.attributes["position"].data
    points = np.array([point.vector for point in data])
    apart = np.abs(points[:, None] - (points * [-1, 1, 1])[None]).sum(axis=2).min(axis=1).max()
    assert apart < 1e-4, f"not symmetric: {apart}"
    wide = extent(body)
    said = words()
    yield from stroke(
        ring((x + 150, y + 20), 60, 30, start=np.pi), keys=("X",), picture="draw_mirrored_2", at=0.9
    )
    assert said[-1][0].startswith("Extend"), said[-1]
    (body,) = bodies()
    across = np.array([vertex.co[0] for vertex in body.data.vertices])
    assert extent(body) > wide * 1.2
    assert abs(across.min() + across.max()) < 0.02 * extent(body), "one side only"
    yield from stage.picture("draw_mirrored_3")


def draw_idle():
    """The tool waits: its icon and Cut's, its hints in the status bar, the options of new bodies in the header."""
    yield from begin()
    with stage.override():
        stage.view.spaces.active.show_region_toolbar = True
    x, y = stage.middle()
    yield from stage.picture("draw_idle_1")
    yield from stroke(ring((x, y), 120, 40))
    yield from stage.picture("draw_idle_2")


def draw_automatic():
    """Automatic: the grid that is seen while a limb grows is about as fine as that of the body; a limb gets five across."""
    yield from begin()
    x, y = stage.middle()
    with stage.override():
        options = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT").operator_properties(
            "object.gridmesh_draw"
        )
    assert options.resolution == "AUTO", "Automatic is not the default"
    fish = limb((x - 200, y), 0.0, 380, 22)
    seen, kind = [], modules("draw.preview").Preview
    show = kind.show

    def shown(self, *arguments):
        show(self, *arguments)
        seen.append(sum(len(triangles) for _, triangles in self._grids))

    kind.show = shown
    try:
        yield from stroke(fish, picture="draw_automatic_1", at=0.95)
    finally:
        kind.show = show
    (body,) = bodies()
    sides = len(body.data.polygons) // 2
    print(f"NUMBERS automatic: preview {seen[-1]} triangles, body {sides} of a side")
    assert 0.5 * sides < seen[-1] < 2 * sides, "the preview is not as fine as the body"
    assert modules("live.refine").of_body(body, bpy.context.evaluated_depsgraph_get()).across > 4.5
    yield from stage.picture("draw_automatic_2")


class Tablet:
    """An event as a pen makes it: simulated ones have no pressure."""

    def __init__(self, event, pressure):
        self._event, self.pressure, self.is_tablet = event, pressure, True

    def __getattr__(self, name):
        return getattr(self._event, name)


def draw_pressed():
    """A stroke that is pressed hard on the right and lightly on the left: its width, and a body that is fat there."""
    yield from begin()
    operator = modules("draw.operator").OBJECT_OT_gridmesh_draw
    with stage.override():
        options = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT").operator_properties(
            "object.gridmesh_draw"
        )
    x, y = stage.middle()
    add = operator._add

    def pressed(self, context, event):
        return add(self, context, Tablet(event, 0.2 if event.mouse_x < x else 1.0))

    operator._add, options.pen = pressed, 1.0
    try:
        yield from stroke(ring((x, y), 180, 48))
    finally:
        operator._add, options.pen = add, 0.0
    (body,) = bodies()
    across = np.array([vertex.co for vertex in body.data.vertices])
    left, right = across[across[:, 0] < -0.5, 2], across[across[:, 0] > 0.5, 2]
    assert np.ptp(right) > 1.5 * np.ptp(left), "the pressure does not drive the depth"
    data = outlines()[0].data.layers[0].current_frame().drawing.attributes["radius"].data
    radii = [point.value for point in data]
    assert abs(max(radii) / min(radii) - 5) < 0.01, "the pressure was not recorded"
    turn_view(1.0, 0.0, 0.35)
    yield from stage.picture("draw_pressed")


def pen():
    """The same outline without and with the pressure of the pen, drawn by a script."""
    yield from fresh()
    gesture = modules("draw.gesture")
    t = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    fish = np.stack([2.2 * np.cos(t), 0.8 * np.sin(t) * (1.2 + 0.5 * np.cos(t))], axis=1)
    front = np.eye(4)
    front[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    pressure = 0.15 + 0.85 * (0.5 + 0.5 * np.cos(t)) ** 1.5
    for k, width in enumerate((0.0, 1.0)):
        front[2, 3] = 1.5 - 3.0 * k
        drawn = {"stroke": gesture.pack(fish, pressure), "matrix": front.ravel().tolist()}
        assert bpy.ops.object.gridmesh_draw("EXEC_DEFAULT", **drawn, pen=width, triangles=1500) == {
            "FINISHED"
        }
    turn_view(1.0, 0.0, 0.35)
    yield 0.5
    yield from stage.picture("pen")


def draw_steady():
    """With *Stabilize Stroke* a shaky hand draws a round body, with no corner where the stroke began."""
    yield from begin()
    with stage.override():
        options = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT").operator_properties(
            "object.gridmesh_draw"
        )
    options.use_stabilizer = True
    try:
        shake = np.random.default_rng(1).normal(0, 4, (120, 2))
        path = np.array(ring(stage.middle(), 170, 120)) + shake
        yield from stroke([tuple(point) for point in path], picture="steady_1_preview", at=0.97)
        yield from stage.picture("steady_2_body")
    finally:
        options.property_unset("use_stabilizer")
    (outline,) = outlines()
    (drawn,) = outline.data.layers[0].current_frame().drawing.strokes
    points = np.array([point.position for point in drawn.points])
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radii = np.linalg.norm(points - middle, axis=1)
    assert radii.max() < 1.12 * radii.min(), f"from {radii.min()} to {radii.max()}"


SCENES = (
    *(
        draw_body,
        draw_left,
        draw_hole,
        draw_across,
        draw_apart,
        draw_head,
        draw_redo,
        draw_click,
        draw_turned,
    ),
    *(
        draw_bridge,
        draw_eye,
        draw_mirrored,
        draw_idle,
        draw_planes,
        draw_automatic,
        draw_pressed,
        draw_steady,
        pen,
    ),
)
