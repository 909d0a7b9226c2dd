# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing a cut in the viewport: a line with the left button, then a click on the side to keep."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from bpy_extras import view3d_utils
from mathutils import Vector

from .. import api
from ..text.telling import told
from . import cutline, cutsweep, cutting, drawnline
from .cutline import View
from .cutobject import Target

_NAVIGATION = {
    "MIDDLEMOUSE",
    "WHEELUPMOUSE",
    "WHEELDOWNMOUSE",
    "TRACKPADPAN",
    "TRACKPADZOOM",
    "MOUSEROTATE",
    "NDOF_MOTION",
    *(f"NUMPAD_{key}" for key in (*range(10), "PERIOD", "PLUS", "MINUS")),
}
_MOVES = {"MOUSEMOVE", "INBETWEEN_MOUSEMOVE"}

_DRAW = "Drag: draw the cut    Ctrl: straight line    Back to the start: closed cut    Esc: cancel"
_CHOOSE = "Click: keep this side    Enter or B: keep both    D: draw again    Esc: cancel"
_NOTHING = "The line crosses no selected mesh"
_AGAIN = f"That was a click. {_DRAW}"

_LINE, _AHEAD, _KEPT = (1.0, 0.75, 0.2, 1.0), (1.0, 0.75, 0.2, 0.35), (0.3, 0.75, 1.0, 0.45)
_BAND = 56.0


class Preview:
    """The line as it is drawn, over the viewport."""

    def __init__(self) -> None:
        self.region: Any = None
        self.points: list[tuple[float, float]] = []
        self.line: np.ndarray | None = None
        """The finished line."""
        self.extended = False
        """The ends are continued to infinity."""
        self.ends: np.ndarray | None = None
        """(2, 2) otherwise, where they end."""
        self.left: bool | None = None
        """The side that a click would keep."""
        self._handler = bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", "POST_PIXEL")

    def remove(self) -> None:
        """Take it off the viewport."""
        if self._handler is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handler, "WINDOW")
            self._handler = None

    def _draw(self) -> None:
        if bpy.context.region != self.region:
            return
        line = self.line if self.line is not None else np.array(self.points, float)
        if len(line) < 2:
            return
        import gpu

        gpu.state.blend_set("ALPHA")
        whole = line
        if self.ends is not None or (self.extended and not drawnline.is_closed(line)):
            whole = drawnline.extended(line, self.ends, float(self.region.width + self.region.height))
        if self.line is not None and self.left is not None:
            _draw_band(*drawnline.band(whole, _BAND, left=self.left))
        if len(whole) > len(line):
            _draw_line(whole, _AHEAD, 1.5)
        _draw_line(line, _LINE, 3.0)
        gpu.state.blend_set("NONE")


def _draw_line(points: np.ndarray, color: tuple[float, ...], width: float) -> None:
    import gpu
    from gpu_extras.batch import batch_for_shader

    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    batch = batch_for_shader(shader, "LINE_STRIP", {"pos": [(x, y, 0.0) for x, y in points.tolist()]})
    shader.bind()
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", width)
    shader.uniform_float("color", color)
    batch.draw(shader)


def _draw_band(near: np.ndarray, far: np.ndarray) -> None:
    """Shade from the line to nothing."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    places = [(x, y, 0.0) for pair in zip(near.tolist(), far.tolist(), strict=True) for x, y in pair]
    colors = [_KEPT, (*_KEPT[:3], 0.0)] * len(near)
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    batch = batch_for_shader(shader, "TRI_STRIP", {"pos": places, "color": colors})
    shader.bind()
    batch.draw(shader)


def status(problems: list[api.NativeError | cutsweep.CutError] | None) -> str:
    """Say what to do with a line. problems : why it cuts none of the meshes; None if it cuts one."""
    if problems is None:
        return _CHOOSE
    others = [str(error) for error in problems if getattr(error, "kind", "") != "stroke_misses"]
    said = others[0][:1].upper() + others[0][1:] if others else _NOTHING
    return f"{said}    D: draw again    Esc: cancel"


class DrawnCut:
    """The modal part of the operator. Mixed in; the operator brings `execute` and the properties."""

    _preview: Preview | None = None

    def begin_drawing(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Wait for a line; the tool of the toolbar begins it at once, with the press that called it."""
        if context.area is None or context.area.type != "VIEW_3D":
            self.report({"ERROR"}, told("A cut is drawn in a 3D view; start it from there"))
            return {"CANCELLED"}
        self._area, self._window = context.area, context.window
        self._preview = Preview()
        self._preview.extended = self.extend_ends
        self._drawing = False
        context.window.cursor_modal_set("KNIFE")
        context.workspace.status_text_set(told(_DRAW, "interface"))
        context.window_manager.modal_handler_add(self)
        pressed = event.type == "LEFTMOUSE" and event.value == "PRESS"
        if pressed and context.region is not None and context.region.type == "WINDOW":
            self._begin_line(context.region, event)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Draw; then choose the side."""
        try:
            return self._handle(context, event)
        except BaseException:
            self._end(context)
            raise

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender stops the operator, for instance since a file is loaded."""
        self._end(context)

    def _handle(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        preview = self._preview
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            self._end(context)
            return {"CANCELLED"}
        if preview.line is not None:
            return self._choose(context, event)
        if self._drawing:
            if event.type in _MOVES:
                self._extend(event)
            elif event.type == "LEFTMOUSE" and event.value == "RELEASE":
                self._extend(event)
                self._finish_line(context)
            self._area.tag_redraw()
            return {"RUNNING_MODAL"}
        if event.type in _NAVIGATION:
            return {"PASS_THROUGH"}
        if event.type == "LEFTMOUSE" and event.value == "PRESS":
            region = self._region_at(event)
            if region is not None:
                self._begin_line(region, event)
        return {"RUNNING_MODAL"}

    def _begin_line(self, region: Any, event: bpy.types.Event) -> None:
        self._preview.region, self._preview.points = region, []
        self._drawing = True
        self._extend(event)

    def _region_at(self, event: bpy.types.Event) -> Any:
        """Return the view under the mouse."""
        for region in self._area.regions:
            inside_x = region.x <= event.mouse_x < region.x + region.width
            if region.type == "WINDOW" and inside_x and region.y <= event.mouse_y < region.y + region.height:
                return region
        return None

    def _place(self, event: bpy.types.Event) -> tuple[float, float]:
        region = self._preview.region
        return float(event.mouse_x - region.x), float(event.mouse_y - region.y)

    def _extend(self, event: bpy.types.Event) -> None:
        points, place = self._preview.points, self._place(event)
        if event.ctrl and points:
            del points[1:]
        if not points or points[-1] != place:
            points.append(place)

    def _finish_line(self, context: bpy.types.Context) -> None:
        preview = self._preview
        self._drawing = False
        points = np.array(preview.points, float)
        if drawnline.length(points) < drawnline.SHORTEST:
            preview.points = []
            context.workspace.status_text_set(told(_AGAIN, "interface"))
            return
        preview.line = drawnline.smoothed(points)
        context.workspace.status_text_set(told(status(self._find_ends(context)), "interface"))

    def _find_ends(self, context: bpy.types.Context) -> list[api.NativeError | cutsweep.CutError] | None:
        """Find how far the ends of an open line are continued, over all meshes; if none can be cut, return why."""
        preview = self._preview
        if self.extend_ends:
            return None
        closed = np.array_equal(preview.line[0], preview.line[-1])
        region, region_data = preview.region, preview.region.data
        points, view = np.array(self._world_points(context), float), View.of(region_data)
        sweep, _ = cutline.sweep_of("VIEW", points, view)
        before = [preview.line[0] - preview.line[1], preview.line[-1] - preview.line[-2]]
        ends, farthest, crosses = [preview.line[0], preview.line[-1]], [0.0, 0.0], False
        problems = []
        for ob in self.targets(context):
            try:
                target = Target(ob)
                stroke, own = target.line(points, sweep, cyclic=False, close_gaps=0.0)
                reach = cutting.reach(target.model, stroke, own) + target.origin
            except (api.NativeError, cutsweep.CutError) as error:
                problems.append(error)  # of some of several it is told once the cut is made
                continue
            crosses = True
            for k, place in enumerate(reach):
                seen = view3d_utils.location_3d_to_region_2d(region, region_data, Vector(place))
                if seen is None:
                    continue
                ahead = float((np.array(seen) - preview.line[-k]) @ before[k])
                if ahead > farthest[k]:
                    ends[k], farthest[k] = np.array(seen), ahead
        if not closed:
            preview.ends = np.stack(ends)
        return None if crosses else problems

    def _choose(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        preview = self._preview
        if event.type in _MOVES:
            preview.left = drawnline.on_left(preview.line, np.array(self._place(event)))
            self._area.tag_redraw()
        elif event.value == "PRESS":
            if event.type == "LEFTMOUSE" and self._region_at(event) == preview.region:
                left = drawnline.on_left(preview.line, np.array(self._place(event)))
                return self._cut(context, "LEFT" if left else "RIGHT")
            if event.type in {"RET", "NUMPAD_ENTER", "B"}:
                return self._cut(context, "BOTH")
            if event.type == "D":
                preview.line, preview.left, preview.ends, preview.points = None, None, None, []
                context.workspace.status_text_set(told(_DRAW, "interface"))
                self._area.tag_redraw()
        return {"RUNNING_MODAL"}

    def _cut(self, context: bpy.types.Context, keep: str) -> set[str]:
        """Keep line and view in the properties, and do what a script would do."""
        preview = self._preview
        region_data = preview.region.data
        self.stroke.clear()
        for point in self._world_points(context):
            self.stroke.add().location = point
        if np.array_equal(preview.line[0], preview.line[-1]):
            self.stroke[-1].location = self.stroke[0].location
        self.remember_view(View.of(region_data))
        self.keep, self.direction, self.source = keep, "VIEW", "DRAWN"
        self._end(context)
        return self.execute(context)

    def _world_points(self, context: bpy.types.Context) -> list[Vector]:
        """The line at the distance of the active object."""
        region = self._preview.region
        ob = context.view_layer.objects.active
        middle = sum((Vector(corner) for corner in ob.bound_box), Vector()) / 8
        depth = ob.matrix_world @ middle
        places = self._preview.line.tolist()
        return [view3d_utils.region_2d_to_location_3d(region, region.data, place, depth) for place in places]

    def _end(self, context: bpy.types.Context) -> None:
        """Leave nothing behind in the window."""
        if self._preview is None:
            return
        self._preview.remove()
        self._preview = None
        self._window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        self._area.tag_redraw()
