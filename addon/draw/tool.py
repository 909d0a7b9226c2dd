# SPDX-License-Identifier: GPL-3.0-or-later
"""The toolbar's entry for drawing bodies, its options in the header, and what the status bar says of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from ..data import frames
from ..ui.properties import fineness_of
from . import interaction
from .operator import OBJECT_OT_gridmesh_draw
from .simplifying import OBJECT_OT_gridmesh_simplify

ICONS = Path(__file__).parent / "icons"
"""Pictures for the toolbar, made by `docs/icons.py`."""

_PRESS = {"type": "LEFTMOUSE", "value": "PRESS"}


class GridMeshDrawTool(bpy.types.WorkSpaceTool):
    """Entry of the toolbar."""

    bl_space_type = "VIEW_3D"
    bl_context_mode = "OBJECT"
    bl_idname = "gridmesh.draw"
    bl_label = "GridMesh Draw"
    bl_description = (
        "Draw an outline, get a body.\nAcross the outline of a body it extends that; Shift takes away. "
        "A click selects"
    )
    bl_icon = str(ICONS / "gridmesh.draw")
    bl_cursor = "PAINT_CROSS"
    bl_keymap = (
        (OBJECT_OT_gridmesh_draw.bl_idname, _PRESS, None),
        (OBJECT_OT_gridmesh_draw.bl_idname, {**_PRESS, "shift": True}, None),
        (OBJECT_OT_gridmesh_draw.bl_idname, {**_PRESS, "ctrl": True}, None),
    )

    @staticmethod
    def draw_settings(context: bpy.types.Context, layout: Any, tool: Any) -> None:
        """Draw the options: those of the stroke, then those of the active live body or of new ones.

        The header has room for icons alone; the sidebar and the properties editor have names.
        """
        in_header = context.region is not None and context.region.type in {"TOOL_HEADER", "HEADER"}

        def draw(row: Any, data: Any, name: str, icon: str = "NONE") -> None:
            if in_header:
                row.prop(data, name, text="", icon=icon)
            else:
                row.prop(data, name)

        options = tool.operator_properties(OBJECT_OT_gridmesh_draw.bl_idname)
        layout.prop(options, "plane")
        layout.prop(options, "action")
        row = layout.row(align=True) if in_header else layout.column()
        row.prop(options, "use_part", icon="OUTLINER_OB_META" if in_header else "NONE")
        if options.use_part or options.action == "PART":
            draw(row, options, "part_lies")
            draw(row, options, "use_twin", "MOD_MIRROR")
            draw(row, options, "use_join", "AUTOMERGE_ON")
        draw(layout, options, "use_mirror", "MOD_MIRROR")
        row = layout.row(align=True) if in_header else layout.column()
        draw(row, options, "use_stabilizer", "SMOOTHCURVE")
        if options.use_stabilizer:
            row.prop(options, "stabilizer_radius")
            row.prop(options, "stabilizer_factor")
        layout.separator()
        body = chosen_body(context)
        if body is not None:
            layout.label(text=body.name, icon="OUTLINER_OB_MESH", translate=False)
        else:
            layout.label(text="New Bodies", icon="ADD")
        shown = options if body is None else body.gridmesh_live
        draw(layout, shown, "cells")
        draw(layout, shown, "resolution")
        if shown.resolution != "AUTO":
            layout.prop(shown, fineness_of(shown))
        layout.prop(shown, "profile")
        if body is None:
            layout.prop(shown, "curve")
        layout.prop(shown, "depth")
        layout.prop(shown, "pen")
        if body is not None:
            text = {"text": ""} if in_header else {}
            layout.operator(OBJECT_OT_gridmesh_simplify.bl_idname, icon="MOD_SIMPLIFY", **text)


def chosen_body(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the live body whose options the header shows: the active one, if it is selected."""
    active = context.view_layer.objects.active
    if active is None or active.type != "MESH" or not frames.is_linked(active) or not active.select_get():
        return None
    return active


def _hint(header: Any, context: bpy.types.Context) -> None:
    """Say in the status bar what the tool does while it waits."""
    workspace = context.workspace
    if workspace is None or interaction.drawing_now or context.mode != "OBJECT":
        return
    tool = workspace.tools.from_space_view3d_mode("OBJECT", create=False)
    if tool is None or tool.idname != GridMeshDrawTool.bl_idname:
        return
    row = header.layout.row(align=True)
    row.label(text="Draw, Click: Select", icon="MOUSE_LMB")
    row.label(text="Take Away", icon="EVENT_SHIFT")
    row.separator()


def register() -> None:
    """Add the tool to the toolbar."""
    bpy.utils.register_tool(GridMeshDrawTool, after={"builtin.measure"}, separator=True)
    bpy.types.STATUSBAR_HT_header.prepend(_hint)


def unregister() -> None:
    """Take it away."""
    if hasattr(GridMeshDrawTool, "_bl_tool"):
        bpy.utils.unregister_tool(GridMeshDrawTool)
    bpy.types.STATUSBAR_HT_header.remove(_hint)
