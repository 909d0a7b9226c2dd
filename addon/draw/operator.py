# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_draw`, from press to release of the mouse button, and the tool in the toolbar that calls it.

Each stroke is a call of its own, so Blender's undo takes back one stroke at a time. What was drawn is kept in the
operator's memory: the redo panel, and scripts, run the same stroke again without a window.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, StringProperty

from ..native import NativeError, native
from ..operators.messages import counted
from ..outlines import Plane
from ..properties import CurveOption, SketchOptions
from ..telling import told
from . import drawing, planes
from .gesture import Gesture, pack, unpack
from .preview import Preview

_DONE = {"new": "Drew {}", "hole": "Made a hole in {}", "extend": "Extended {}", "trim": "Trimmed {}"}

timing: list[float] = []
"""Seconds that the last mouse moves took, newest last."""


class OBJECT_OT_gridmesh_draw(SketchOptions, CurveOption, bpy.types.Operator):  # noqa: N801
    """Draw the outline of a body; across a body's outline to extend or trim it, with Shift to make a hole"""  # noqa: D400

    bl_idname = "object.gridmesh_draw"
    bl_label = "GridMesh Draw"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    plane: EnumProperty(
        name="Plane", description="Where the stroke lies", items=planes.CHOICES, default="VIEW"
    )
    pen: FloatProperty(
        name="Pen Width",
        description="How much the pressure of the pen drives the depth of the body",
        subtype="FACTOR",
        default=0.0,
        min=0.0,
        max=1.0,
    )
    subtract: BoolProperty(
        name="Subtract",
        description="Make a hole in the body under the stroke, or trim it",
        default=False,
        options={"SKIP_SAVE"},
    )
    stroke: StringProperty(options={"HIDDEN", "SKIP_SAVE"})
    matrix: FloatVectorProperty(size=16, options={"HIDDEN", "SKIP_SAVE"})
    under: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for object mode."""
        if context.mode == "OBJECT":
            return True
        cls.poll_message_set(told("Leave the mode: bodies are drawn in Object Mode", "tooltips"))
        return False

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Begin a stroke at the mouse."""
        if context.region_data is None:
            self.report({"WARNING"}, told("Draw in a 3D view"))
            return {"CANCELLED"}
        try:
            native("mesh_sketch", "combine")
            pixel = (event.mouse_region_x, event.mouse_region_y)
            self._plane = planes.chosen(context, self.plane, pixel)
        except (NativeError, planes.PlaneError) as error:
            self.report({"ERROR"}, told(str(error)))
            return {"CANCELLED"}
        self.subtract = event.shift
        found = planes.body_under(context, pixel)
        self.under = found.name if found is not None else ""
        length = self.edge_length if self.resolution == "EDGE_LENGTH" else None
        self._gesture = Gesture(self.triangles, length)
        self._preview = Preview(context, self._plane, subtract=self.subtract)
        self._button = event.type
        self._add(context, event)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set(
            told("Release: make the body    Esc, Right Click: leave it", "interface")
        )
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Follow the mouse; every way out takes the preview away."""
        started = perf_counter()
        if event.type in {"MOUSEMOVE", "INBETWEEN_MOUSEMOVE"}:
            if self._add(context, event) and event.type == "MOUSEMOVE":
                self._preview.show(self._gesture.points, self._gesture.preview())
                timing.append(perf_counter() - started)
                del timing[:-500]
            return {"RUNNING_MODAL"}
        if event.type in {"ESC", "RIGHTMOUSE"} or (event.type == "Z" and event.ctrl):
            self._end(context)
            return {"CANCELLED"}
        if event.type == self._button and event.value == "RELEASE":
            self._add(context, event)
            self._end(context)
            self.stroke = pack(self._gesture.points, self._gesture.pressures)
            self.matrix = self._plane.matrix.ravel().tolist()
            return self.execute(context)
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the tool: a file is opened, or a window closed."""
        self._end(context)

    def _add(self, context: bpy.types.Context, event: bpy.types.Event) -> bool:
        pixel = (event.mouse_x - context.region.x, event.mouse_y - context.region.y)
        point = planes.on_plane(context, self._plane, pixel)
        # A mouse has no pressure: it draws at full width.
        pressure = event.pressure if event.is_tablet else 1.0
        return point is not None and self._gesture.add(pixel, point, pressure)

    def _end(self, context: bpy.types.Context) -> None:
        self._preview.remove()
        if context.workspace is not None:
            context.workspace.status_text_set(None)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Make of the remembered stroke what it was drawn for."""
        started = perf_counter()
        if not self.stroke:
            self.report({"WARNING"}, told("Nothing is drawn; use the GridMesh Draw tool in a 3D view"))
            return {"CANCELLED"}
        try:
            points, pressures = unpack(self.stroke)
        except ValueError as error:
            self.report({"ERROR"}, told(f"The stroke cannot be read: {error}"))
            return {"CANCELLED"}
        self.resolve_curve(context)
        matrix = np.array(self.matrix, float).reshape(4, 4)
        plane = Plane(matrix[:3, 3], matrix[:3, :3].T)
        under = bpy.data.objects.get(self.under) if self.under else None
        try:
            drawn = drawing.apply(
                context, plane, points, pressures, self, subtract=self.subtract, under=under
            )
        except (drawing.DrawError, NativeError) as error:
            text = str(error)
            self.report({"WARNING"}, told(text[:1].upper() + text[1:]))
            return {"CANCELLED"}
        triangles = sum(len(ob.data.polygons) for ob in drawn.bodies)
        what = counted(len(drawn.bodies), "body")
        milliseconds = 1000 * (perf_counter() - started)
        done = _DONE[drawn.action].format(what)
        self.report({"INFO"}, told(f"{done}: {triangles} triangles, {milliseconds:.0f} ms"))
        return {"FINISHED"}

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "subtract")
        self.draw_shape_options(layout)
        layout.prop(self, "pen")
        self.draw_sketch_options(layout)


class GridMeshDrawTool(bpy.types.WorkSpaceTool):
    """Entry of the toolbar."""

    bl_space_type = "VIEW_3D"
    bl_context_mode = "OBJECT"
    bl_idname = "gridmesh.draw"
    bl_label = "GridMesh Draw"
    bl_description = (
        "Draw an outline, get a body.\nBegin inside a body and cross its outline to extend it, outside to trim it; "
        "Shift makes a hole"
    )
    bl_icon = "ops.gpencil.draw.poly"
    bl_cursor = "PAINT_CROSS"
    bl_keymap = (
        (OBJECT_OT_gridmesh_draw.bl_idname, {"type": "LEFTMOUSE", "value": "PRESS"}, None),
        (OBJECT_OT_gridmesh_draw.bl_idname, {"type": "LEFTMOUSE", "value": "PRESS", "shift": True}, None),
    )

    @staticmethod
    def draw_settings(_context: bpy.types.Context, layout: Any, tool: Any) -> None:
        """Draw the options in the header."""
        options = tool.operator_properties(OBJECT_OT_gridmesh_draw.bl_idname)
        layout.prop(options, "plane")
        layout.prop(options, "triangles")
        layout.prop(options, "profile")
        layout.prop(options, "curve")
        layout.prop(options, "depth")
        layout.prop(options, "pen")


def register() -> None:
    """Add the tool to the toolbar."""
    bpy.utils.register_tool(GridMeshDrawTool, after={"builtin.measure"}, separator=True)


def unregister() -> None:
    """Take it away."""
    if hasattr(GridMeshDrawTool, "_bl_tool"):
        bpy.utils.unregister_tool(GridMeshDrawTool)


classes = (OBJECT_OT_gridmesh_draw,)
