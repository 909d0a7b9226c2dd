"""What all scenes share: the stage, an empty scene, drawings. Runs inside Blender."""

import importlib
import sys
from pathlib import Path

import bpy
import numpy as np
from stage import Stage

stage = Stage(Path(sys.argv[-1]))


def fresh(mode="OBJECT", axis="FRONT"):
    """The scene that Blender starts with, without its objects, seen along an axis."""
    bpy.ops.wm.read_homefile(load_ui=False)
    yield 0.6
    for ob in list(bpy.data.objects):
        bpy.data.objects.remove(ob)
    view = stage.view.spaces.active
    view.overlay.show_cursor = view.overlay.show_wireframes = False
    with stage.override():
        view.show_region_ui = view.show_region_hud = False
    view.shading.type = "SOLID"
    with stage.override():
        bpy.ops.view3d.view_axis(type=axis)
    view.region_3d.view_perspective = "ORTHO"
    view.region_3d.view_distance = 7
    view.region_3d.view_location = (0, 0, 0)
    bpy.ops.ed.undo_push(message="Empty")
    yield 0.6


def mesh_objects():
    return [ob for ob in bpy.data.objects if ob.type == "MESH"]


def clover(size=150, n=60):
    """Points in the window, of a shape about the middle of the view."""
    x, y = stage.middle()
    t = np.linspace(0, 2 * np.pi, n)
    r = size * (1 + 0.3 * np.cos(3 * t))
    return [(x - 60 + r_ * np.sin(t_), y + r_ * np.cos(t_)) for r_, t_ in zip(r, t, strict=True)]


def grease_pencil(strokes, name="Drawing"):
    """A grease pencil object with strokes (n, 3), selected."""
    v3 = hasattr(bpy.data, "grease_pencils_v3")  # before Blender 5.0
    data = (bpy.data.grease_pencils_v3 if v3 else bpy.data.grease_pencils).new(name)
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    material = bpy.data.materials.new("Ink")
    bpy.data.materials.create_gpencil_data(material)
    material.grease_pencil.color = (0.07, 0.36, 0.62, 1)
    data.materials.append(material)
    drawing = data.layers.new("Lines").frames.new(1).drawing
    drawing.add_strokes([len(stroke) for stroke in strokes])
    drawing.attributes["position"].data.foreach_set(
        "vector", np.concatenate(strokes).astype(np.float32).ravel()
    )
    for stroke in drawing.strokes:
        stroke.cyclic = True
    drawing.tag_positions_changed()
    select(ob)
    bpy.ops.ed.undo_push(message="Drawing")  # the redo panel goes back to it
    return ob


def select(ob):
    bpy.context.view_layer.update()  # what is new is only now in it
    for other in bpy.context.view_layer.objects:
        other.select_set(other == ob)
    bpy.context.view_layer.objects.active = ob


def whale(n=160):
    """(n, 3) points of a round shape with a tail, in the plane y = 0."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = 1 + 0.28 * np.cos(t) + 0.3 * np.cos(3 * t + 0.5) + 0.08 * np.sin(5 * t)
    return np.stack([1.3 * r * np.cos(t), 0 * t, r * np.sin(t)], axis=1)


def turn_view(x=1.15, y=0.0, z=0.6):
    """See the scene from the side and above."""
    import mathutils

    view = stage.view.spaces.active.region_3d
    view.view_rotation = mathutils.Euler((x, y, z)).to_quaternion()


def numbers_of(hud, name, value):
    """Type a value into the field of an option, found by what Ctrl-C copies from it; whether the option has it."""
    manager = bpy.context.window_manager
    for y in range(hud.y + hud.height - 30, hud.y + 10, -11):
        manager.clipboard = ""
        yield from stage.move(hud.x + int(hud.width * 0.72), y)
        yield 0.1
        yield from stage.key("C", ctrl=True)
        if _same(manager.clipboard, getattr(manager.operators[-1], name)):
            yield from stage.click(*stage.mouse)
            yield from stage.key("A", ctrl=True)
            yield from stage.write(value)
            yield from stage.key("RET")
            yield 1.5
            return _same(value, getattr(manager.operators[-1], name))
    return False


def _same(text, value):
    """Whether a text is a number, to six digits after the point."""
    try:
        return abs(float(text) - value) < 1e-6
    except ValueError:
        return False


def modules(name):
    """A module of the extension, however it is installed."""
    operator = next(m for m in sys.modules if m.endswith(("gridmesh.draw.operator", "addon.draw.operator")))
    return importlib.import_module(operator.removesuffix("draw.operator") + name)


def typed(*keys):
    """Press keys one after another; numbers are written."""
    for key in keys:
        yield from stage.write(key) if key.strip("-0123456789.") == "" else stage.key(key)
    yield 0.8


def undo():
    yield from stage.key("Z", ctrl=True)
    yield 1.0


def redo():
    yield from stage.key("Z", ctrl=True, shift=True)
    yield 1.0


def reopened():
    """Save the file and open it again."""
    path = bpy.app.tempdir + "saved.blend"
    with stage.override():
        bpy.ops.wm.save_as_mainfile(filepath=path)
    yield 0.5
    bpy.ops.wm.open_mainfile(filepath=path)
    yield 1.5


def points_of(ob):
    """Vertices of a mesh object in the world, (n, 3)."""
    bpy.context.view_layer.update()
    points = np.empty(len(ob.data.vertices) * 3, np.float32)
    ob.data.vertices.foreach_get("co", points)
    return modules("data.frames").moved(points.reshape(-1, 3).astype(float), np.array(ob.matrix_world))


def bodies():
    """Live bodies."""
    return modules("live.engine").bodies()


def outlines():
    """Grease pencil objects."""
    return [ob for ob in bpy.data.objects if ob.type == "GREASEPENCIL"]


def extent(ob, axis=0):
    """Size of an object along an axis of its own."""
    points = np.empty(len(ob.data.vertices) * 3, np.float32)
    ob.data.vertices.foreach_get("co", points)
    return float(np.ptp(points.reshape(-1, 3)[:, axis]))


def ring(centre, radius, n=36, start=0.0, wobble=0.0):
    """Points in the window on a closed line about a centre."""
    t = start + np.linspace(0, 2 * np.pi, n)
    r = radius * (1 + wobble * np.cos(3 * t))
    return [(centre[0] + a * np.cos(b), centre[1] + a * np.sin(b)) for a, b in zip(r, t, strict=True)]


def limb(start, angle, length, half):
    """Points in the window around a limb with a round end, which begins within a body."""
    along = np.array([np.cos(angle), np.sin(angle)])
    aside = np.array([-along[1], along[0]])
    there = [start + along * d + aside * half for d in np.linspace(0, length, 12)]
    turn = [
        start + along * (length + half * np.sin(a)) + aside * half * np.cos(a)
        for a in np.linspace(0.2, np.pi - 0.2, 8)
    ]
    back = [start + along * d - aside * half for d in np.linspace(length, 0, 12)]
    return [tuple(map(float, point)) for point in (*there, *turn, *back)]


def tool(name):
    """Take a tool of the toolbar."""
    with stage.override():
        bpy.ops.wm.tool_set_by_id(name=name)
    yield 0.5


def begin():
    """An empty scene, and the tool that draws."""
    yield from fresh()
    yield from tool("gridmesh.draw")


def stroke(path, *, picture=None, at=0.7, end="LEFTMOUSE", keys=(), **held):
    """Draw with the left button, as a hand does: several points for each that the window is drawn for.

    keys : pressed in the middle of the stroke. held : keys that are held all along.
    """
    yield from stage.move(*path[0])
    yield from stage.press("LEFTMOUSE", "PRESS", **held)
    for k in range(1, len(path), 3):
        yield from stage.glide(path[k : k + 3], **held)
        if k <= len(path) // 2 < k + 3:
            for key in keys:
                yield from stage.key(key)
        if picture and k <= int(at * len(path)) < k + 3:
            yield from stage.picture(picture)
    if end == "LEFTMOUSE":
        yield from stage.press("LEFTMOUSE", "RELEASE", **held)
    else:
        yield from stage.press(end, "PRESS")
        yield from stage.press(end, "RELEASE")
        yield from stage.press("LEFTMOUSE", "RELEASE")
    yield 1.0
