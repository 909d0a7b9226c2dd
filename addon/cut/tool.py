# SPDX-License-Identifier: GPL-3.0-or-later
"""The toolbar's entry for cutting by hand: drag across the active mesh, click the side to keep."""

from __future__ import annotations

from typing import Any

import bpy

from ..draw.tool import ICONS
from .operator import OBJECT_OT_gridmesh_cut


class GridMeshCutTool(bpy.types.WorkSpaceTool):
    """Entry of the toolbar."""

    bl_space_type = "VIEW_3D"
    bl_context_mode = "OBJECT"
    bl_idname = "gridmesh.cut"
    bl_label = "GridMesh Cut"
    bl_description = (
        "Cut the selected meshes.\nDrag across them, then click the side to keep; Enter keeps both"
    )
    bl_icon = str(ICONS / "gridmesh.cut")
    bl_cursor = "KNIFE"
    bl_keymap = (
        (
            OBJECT_OT_gridmesh_cut.bl_idname,
            {"type": "LEFTMOUSE", "value": "PRESS"},
            {"properties": [("source", "DRAWN")]},
        ),
    )

    @staticmethod
    def draw_settings(_context: bpy.types.Context, layout: Any, tool: Any) -> None:
        """Draw the options in the header."""
        options = tool.operator_properties(OBJECT_OT_gridmesh_cut.bl_idname)
        layout.prop(options, "extend_ends")
        layout.prop(options, "use_cap")
        layout.prop(options, "smooth")
        layout.prop(options, "cells")
        layout.prop(options, "gap")
        layout.prop(options, "pieces")


def register() -> None:
    """Add the tool to the toolbar."""
    bpy.utils.register_tool(GridMeshCutTool, after={"gridmesh.draw"})


def unregister() -> None:
    """Take it away."""
    if hasattr(GridMeshCutTool, "_bl_tool"):
        bpy.utils.unregister_tool(GridMeshCutTool)
