"""Drawing bodies, editing their strokes and looking at their quality, with mouse and keyboard."""

import bpy
import numpy as np


def _module(name):
    """A module of the extension, however it is installed."""
    import importlib
    import sys

    operator = next(m for m in sys.modules if m.endswith(("gridmesh.draw.operator", "addon.draw.operator")))
    return importlib.import_module(operator.removesuffix("draw.operator") + name)


def bodies():
    return _module("live.engine").bodies()


def outlines():
    return [ob for ob in bpy.data.objects if ob.type == "GREASEPENCIL"]


def handlers():
    """Draw handlers cannot be counted; what a preview leaves would be a data block or a running tool."""
    window = bpy.context.window_manager.windows[0]
    return len(bpy.data.objects), len(bpy.data.meshes), [tool.bl_idname for tool in window.modal_operators]


def height(ob, axis=0):
    points = np.empty(len(ob.data.vertices) * 3, np.float32)
    ob.data.vertices.foreach_get("co", points)
    return float(np.ptp(points.reshape(-1, 3)[:, axis]))


def euler(ob):
    mesh = ob.data
    return len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons)


def ring(centre, radius, n=36, start=0.0, wobble=0.0):
    t = start + np.linspace(0, 2 * np.pi, n)
    r = radius * (1 + wobble * np.cos(3 * t))
    return [(centre[0] + a * np.cos(b), centre[1] + a * np.sin(b)) for a, b in zip(r, t, strict=True)]


def make(stage, fresh):
    def begin():
        yield from fresh()
        with stage.override():
            bpy.ops.wm.tool_set_by_id(name="gridmesh.draw")
        yield 0.5

    def stroke(path, *, picture=None, at=0.7, end="LEFTMOUSE", **held):
        yield from stage.move(*path[0])
        yield from stage.press("LEFTMOUSE", "PRESS", **held)
        for k, (x, y) in enumerate(path[1:]):
            yield from stage.move(x, y)
            if picture and k == int(at * len(path)):
                yield from stage.picture(picture)
        if end == "LEFTMOUSE":
            yield from stage.press("LEFTMOUSE", "RELEASE", **held)
        else:
            yield from stage.press(end, "PRESS")
            yield from stage.press(end, "RELEASE")
            yield from stage.press("LEFTMOUSE", "RELEASE")
        yield 1.0

    def draw_body():
        """Drag draws, the grid is seen meanwhile, release makes the body; undo takes it back."""
        yield from begin()
        x, y = stage.middle()
        timing = _module("draw.operator").timing
        timing.clear()
        yield from stroke(ring((x, y), 190, 60, wobble=0.25), picture="draw_1_preview", at=0.8)
        assert len(bodies()) == len(outlines()) == 1
        assert euler(bodies()[0]) == 2
        moves = 1000 * np.array(timing)
        print(f"NUMBERS draw: {len(bodies()[0].data.polygons)} triangles in the end; "
              f"per move median {np.median(moves):.1f} ms, most {moves.max():.1f} ms")  # fmt: skip
        yield from stage.picture("draw_2_body")
        yield from stage.key("Z", ctrl=True)
        yield 0.5
        assert not bodies(), "undo left the body"
        assert not outlines(), "undo left the outline"

    def draw_left():
        """Esc, the right button and Ctrl-Z leave nothing behind."""
        yield from begin()
        before = handlers()
        x, y = stage.middle()
        for end in ("ESC", "RIGHTMOUSE"):
            yield from stroke(ring((x, y), 150)[:25], end=end)
            assert handlers() == before, end
        yield from stage.move(x, y)
        yield from stage.press("LEFTMOUSE", "PRESS")
        for point in ring((x, y), 150)[:20]:
            yield from stage.move(*point)
        yield from stage.key("Z", ctrl=True)
        yield from stage.press("LEFTMOUSE", "RELEASE")
        yield 0.5
        assert handlers() == before, "Ctrl-Z"
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
        """From inside across the outline extends, from outside trims."""
        yield from begin()
        x, y = stage.middle()
        yield from stroke(ring((x, y), 150, 60))
        before = height(bodies()[0])
        yield from stroke(ring((x + 150, y), 80, 40, start=np.pi), picture="draw_extend_1")
        assert len(bodies()) == 1
        assert height(bodies()[0]) > before * 1.15, "not extended"
        yield from stage.picture("draw_extend_2")
        longer = height(bodies()[0])
        yield from stroke(ring((x - 190, y), 100, 40, start=np.pi), picture="draw_trim_1")
        assert len(bodies()) == 1
        assert height(bodies()[0]) < longer * 0.95, "not trimmed"
        yield from stage.picture("draw_trim_2")

    def live_edit():
        """Points of the outline are moved: the body follows, and goes back with undo."""
        yield from begin()
        x, y = stage.middle()
        yield from stroke(ring((x, y), 170, 120, wobble=0.2))
        engine = _module("live.engine")
        body = bodies()[0]
        body.gridmesh_live.triangles = 2500
        yield 0.5
        source = body.gridmesh_live.source
        with stage.override():
            bpy.ops.wm.tool_set_by_id(name="builtin.select_box")
            for ob in bpy.context.view_layer.objects:
                ob.select_set(ob == source)
            bpy.context.view_layer.objects.active = source
            bpy.ops.object.mode_set(mode="EDIT")
            bpy.ops.grease_pencil.select_all(action="DESELECT")
            bpy.context.scene.tool_settings.use_proportional_edit = True
            bpy.context.scene.tool_settings.proportional_size = 0.6
        drawing = source.data.layers[0].current_frame().drawing
        drawing.strokes[0].points[10].select = True
        bpy.ops.ed.undo_push(message="Select a point")
        yield 0.5
        before, width = body.gridmesh_live.digest, height(body)
        assert before, "it is not made in full"
        engine.timing.clear()
        yield from stage.move(x + 100, y)
        yield from stage.key("G")
        for k in range(30):
            yield from stage.move(x + 100 + 4 * k, y + 3 * k)
        assert body.gridmesh_live.digest == "", "it did not follow while being dragged"
        yield from stage.picture("live_1_dragged")
        yield 1.0
        assert body.gridmesh_live.digest == "", "the drag is not over"
        yield from stage.press("LEFTMOUSE", "PRESS")
        yield from stage.press("LEFTMOUSE", "RELEASE")
        yield 1.5
        assert body.gridmesh_live.digest not in ("", before), "it is not made in full after the drag"
        updates = 1000 * np.array(engine.timing[:-1])
        print(f"NUMBERS live: {len(body.data.polygons)} triangles, {len(updates)} updates, "
              f"median {np.median(updates):.1f} ms, most {updates.max():.1f} ms")  # fmt: skip
        yield from stage.picture("live_2_released")
        yield from stage.key("Z", ctrl=True)
        yield 1.0
        body = bodies()[0]
        assert body.gridmesh_live.digest == before, "undo left the body behind"
        assert abs(height(body) - width) < 1e-6
        with stage.override():
            bpy.ops.object.mode_set(mode="OBJECT")

    def live_panel():
        """The panel of a live body; Freeze leaves a plain mesh."""
        yield from begin()
        x, y = stage.middle()
        yield from stroke(ring((x - 80, y), 150, 60, wobble=0.2))
        yield from stage.open_sidebar()
        yield from stage.picture("live_panel")
        with stage.override():
            assert bpy.ops.object.gridmesh_freeze("EXEC_DEFAULT", True) == {"FINISHED"}
        yield 0.3
        assert not bodies()
        assert len([ob for ob in bpy.data.objects if ob.type == "MESH"]) == 1

    def draw_planes():
        """Every plane, in a view from the side: the body lies in it."""
        yield from begin()
        import mathutils

        view = stage.view.spaces.active.region_3d
        view.view_rotation = mathutils.Euler((1.1, 0, 0.6)).to_quaternion()
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
            tool = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT")
            options = tool.operator_properties("object.gridmesh_draw")
        options.triangles = 300
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
        from bpy_extras.view3d_utils import location_3d_to_region_2d

        top = location_3d_to_region_2d(at, view, (0.3, 0.2, 1.0))
        yield from stroke(ring((at.x + top.x - 60, at.y + top.y), 60, 30), picture="draw_surface_1", at=0.6)
        (body,) = bodies()
        assert abs(body.matrix_world.to_3x3().col[2].z) > 0.999, "surface"
        assert abs(body.matrix_world.translation.z - 1) < 1e-3
        yield from stage.picture("draw_surface_2")
        options.plane = "VIEW"
        options.triangles = 2000

    def pen():
        """The pressure of the pen makes the body thick; a script draws, for no event here has pressure."""
        yield from begin()
        import importlib

        import mathutils

        gesture = importlib.import_module(_module("draw.gesture").__name__)
        t = np.linspace(0, 2 * np.pi, 120, endpoint=False)
        fish = np.stack([2.2 * np.cos(t), 0.8 * np.sin(t) * (1.2 + 0.5 * np.cos(t))], axis=1)
        front = np.eye(4)
        front[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
        pressure = 0.15 + 0.85 * (0.5 + 0.5 * np.cos(t)) ** 1.5
        for k, width in enumerate((0.0, 1.0)):
            front[2, 3] = 1.2 - 2.4 * k
            done = bpy.ops.object.gridmesh_draw(
                "EXEC_DEFAULT",
                stroke=gesture.pack(fish, pressure),
                matrix=front.ravel().tolist(),
                pen=width,
                triangles=1500,
            )
            assert done == {"FINISHED"}
        view = stage.view.spaces.active.region_3d
        view.view_rotation = mathutils.Euler((1.0, 0, 0.35)).to_quaternion()
        yield 0.5
        yield from stage.picture("pen")

    def quality():
        """Irregular vertices in the viewport, of a body and of a mesh that is not ours."""
        yield from begin()
        x, y = stage.middle()
        yield from stroke(ring((x - 110, y), 150, 60, wobble=0.25))
        bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, location=(2.6, 0, 0), radius=1.1)
        for ob in bpy.context.view_layer.objects:
            ob.select_set(ob.type == "MESH")
        bpy.context.view_layer.objects.active = bodies()[0]
        bpy.context.window_manager.gridmesh_quality = True
        view = stage.view.spaces.active
        view.overlay.show_wireframes = True
        yield 0.5
        yield from stage.picture("quality")
        bpy.context.window_manager.gridmesh_quality = False

    return draw_body, draw_left, draw_hole, draw_across, live_edit, live_panel, draw_planes, pen, quality
