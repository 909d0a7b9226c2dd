"""Drawing bodies: every gesture of the tool, with the mouse in a window."""

import bpy
import mathutils
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from setting import begin, bodies, extent, fresh, modules, outlines, ring, stage, stroke, turn_view


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
    """From inside across the outline extends, from outside trims; with Shift it trims wherever it begins."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y), 150, 60))
    before = extent(bodies()[0])
    yield from stroke(ring((x + 150, y), 80, 40, start=np.pi), picture="draw_extend_1")
    assert len(bodies()) == 1
    assert extent(bodies()[0]) > before * 1.15, "not extended"
    yield from stage.picture("draw_extend_2")
    longer = extent(bodies()[0])
    yield from stroke(ring((x - 190, y), 100, 40, start=np.pi), picture="draw_trim_1")
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
    """A stroke right across leaves two bodies of one outline object."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x, y), 150, 48))
    bar = [(x - 15, y - 200 + 20 * k) for k in range(21)] + [(x + 15, y + 200 - 20 * k) for k in range(21)]
    yield from stroke(bar)
    assert [euler(ob) for ob in bodies()] == [2, 2]
    assert len(outlines()) == 1
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
        options.plane, options.triangles = "VIEW", 2000


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


SCENES = (draw_body, draw_left, draw_hole, draw_across, draw_apart, draw_planes, draw_pressed, pen)
