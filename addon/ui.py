# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab in the sidebar and the entries in Blender's own menus."""

from __future__ import annotations

from typing import Any

import bpy

from . import meshes, strokes
from .operators.strokes import OBJECT_OT_gridmesh_from_strokes

# Menus that get an entry; which of them exist depends on the Blender version.
MENUS = (
    "VIEW3D_MT_object_convert",
    "VIEW3D_MT_edit_greasepencil",
    "VIEW3D_MT_greasepencil_edit_context_menu",
    "VIEW3D_MT_paint_grease_pencil",
    "VIEW3D_MT_edit_curve",
    "VIEW3D_MT_edit_curve_context_menu",
    "VIEW3D_MT_edit_curves",
)


class VIEW3D_PT_gridmesh(bpy.types.Panel):  # noqa: N801
    """Make meshes from what is drawn."""

    bl_label = "GridMesh"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "GridMesh"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw a button for each kind of drawing that is there."""
        idname = OBJECT_OT_gridmesh_from_strokes.bl_idname
        column = self.layout.column()
        drawings, bodies = strokes.source_objects(context), meshes.selected_bodies(context)
        row = column.row()
        row.enabled = bool(drawings)
        row.operator(idname, icon="MESH_DATA").source = "OBJECTS"
        row = column.row()
        row.enabled = bool(drawings or bodies)
        again = row.operator(idname, text="Update Bodies", icon="FILE_REFRESH")
        again.source, again.update_existing = "OBJECTS", True
        if strokes.annotation(context.scene) is not None:
            column.operator(idname, text="Annotations to Mesh").source = "ANNOTATIONS"
        if not drawings and not bodies:
            self.layout.label(text="Select a drawing or a curve", icon="INFO")


def _entry(menu: Any, context: bpy.types.Context) -> None:
    if strokes.source_objects(context):
        menu.layout.separator()
        menu.layout.operator(OBJECT_OT_gridmesh_from_strokes.bl_idname).source = "OBJECTS"


def add_menus() -> None:
    """Add the entry to the menus that this version has."""
    for name in MENUS:
        menu = getattr(bpy.types, name, None)
        if menu is not None:
            menu.append(_entry)


def remove_menus() -> None:
    """Take the entry out again."""
    for name in MENUS:
        menu = getattr(bpy.types, name, None)
        if menu is not None:
            menu.remove(_entry)


classes = (VIEW3D_PT_gridmesh,)
