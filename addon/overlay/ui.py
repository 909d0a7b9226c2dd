# SPDX-License-Identifier: GPL-3.0-or-later
"""`mesh.gridmesh_quality`, and the switch of the overlay in the viewport's Overlays menu."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty, IntProperty

from ..data import frames
from ..live import refine
from ..text.telling import told
from . import viewport

SWITCH = "gridmesh_quality"
"""Property of the window manager: not saved with the file."""


class MESH_OT_gridmesh_quality(bpy.types.Operator):  # noqa: N801
    """Count irregular vertices of the selected meshes and find the sharpest angle"""  # noqa: D400 (the tooltip)

    bl_idname = "mesh.gridmesh_quality"
    bl_label = "Mesh Quality"
    bl_options = {"REGISTER"}  # noqa: RUF012

    # What was found, for scripts: they read it from the window manager's last operator, or call `of_object`.
    irregular: IntProperty(options={"HIDDEN", "SKIP_SAVE"})
    least: IntProperty(options={"HIDDEN", "SKIP_SAVE"}, description="-1 where lattices have no say")
    sharpest: FloatProperty(options={"HIDDEN", "SKIP_SAVE"}, subtype="ANGLE")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a mesh."""
        if viewport.shown(context):
            return True
        cls.poll_message_set(told("Select a mesh object", "tooltips"))
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Measure and report; nothing is changed."""
        depsgraph = context.evaluated_depsgraph_get()
        all_of_them = [(ob, viewport.of_object(ob, depsgraph)) for ob in viewport.shown(context)]
        for ob, found in all_of_them:
            self.report({"INFO"}, told(f"'{ob.name}': {found.text}"))
            across = refine.of_body(ob, depsgraph) if frames.is_linked(ob) else None
            if across is not None and across.is_low:
                self.report({"WARNING"}, told(f"'{ob.name}': {across.text}"))
        found = [quality for _, quality in all_of_them]
        self.irregular = sum(len(quality.irregular) for quality in found)
        known = all(quality.least is not None for quality in found)
        self.least = sum(quality.least or 0 for quality in found) if known else -1
        angles = [quality.worst_angle for quality in found if quality.worst_face >= 0]
        self.sharpest = min(angles) if angles else float(np.nan)
        return {"FINISHED"}


def _entry(menu: Any, context: bpy.types.Context) -> None:
    column = menu.layout.column()
    column.label(text="GridMesh")
    column.prop(context.window_manager, SWITCH)


def register() -> None:
    """Add the switch."""

    def turn(manager: Any, _context: bpy.types.Context) -> None:
        viewport.turn(getattr(manager, SWITCH))

    switch = BoolProperty(
        name="Mesh Quality",
        description="Show irregular vertices of the selected meshes by their number of edges, and the numbers",
        default=False,
        update=turn,
    )
    setattr(bpy.types.WindowManager, SWITCH, switch)
    bpy.types.VIEW3D_PT_overlay.append(_entry)


def unregister() -> None:
    """Take everything away again."""
    viewport.turn(False)
    bpy.types.VIEW3D_PT_overlay.remove(_entry)
    if hasattr(bpy.types.WindowManager, SWITCH):
        delattr(bpy.types.WindowManager, SWITCH)


classes = (MESH_OT_gridmesh_quality,)
