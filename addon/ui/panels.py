# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab in the sidebar and the entries in Blender's own menus."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from ..bodies import strokes
from ..bodies.operator import OBJECT_OT_gridmesh_from_strokes
from ..bridge.operator import MESH_OT_gridmesh_bridge
from ..cut import cutline
from ..cut.operator import OBJECT_OT_gridmesh_cut
from ..data import meshes
from ..fill.operator import MESH_OT_gridmesh_fill
from ..join.operator import OBJECT_OT_gridmesh_join
from ..pictures.images import shows_picture
from ..pictures.operator import OBJECT_OT_gridmesh_from_image
from ..pictures.updating import OBJECT_OT_gridmesh_update_image
from ..pictures.weights_operator import OBJECT_OT_gridmesh_bone_weights
from ..regrid.operator import MESH_OT_gridmesh_regrid
from . import preset_files

# Menus that get an entry; which of them exist depends on the Blender version.
STROKE_MENUS = (
    "VIEW3D_MT_object_convert",
    "VIEW3D_MT_edit_greasepencil",
    "VIEW3D_MT_greasepencil_edit_context_menu",
    "VIEW3D_MT_paint_grease_pencil",
    "VIEW3D_MT_edit_curve",
    "VIEW3D_MT_edit_curve_context_menu",
    "VIEW3D_MT_edit_curves",
)
CUT_MENUS = ("VIEW3D_MT_object", "VIEW3D_MT_edit_mesh")
FILL_MENUS = ("VIEW3D_MT_edit_mesh_faces", "VIEW3D_MT_edit_mesh_context_menu")

BRIDGE_MENUS = ("VIEW3D_MT_edit_mesh_edges",)
JOIN_MENUS = ("VIEW3D_MT_object", "VIEW3D_MT_object_context_menu")


class VIEW3D_PT_gridmesh(bpy.types.Panel):  # noqa: N801
    """Make meshes from what is drawn."""

    bl_label = "GridMesh"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "GridMesh"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw a button for each thing that can be done here."""
        if context.mode == "EDIT_MESH":
            self._draw_fill()
        else:
            self._draw_strokes(context)
        if OBJECT_OT_gridmesh_join.poll(context):
            self.layout.column().operator(OBJECT_OT_gridmesh_join.bl_idname, icon="SELECT_EXTEND")
        if OBJECT_OT_gridmesh_cut.poll(context):
            _draw_cut(self.layout, context)

    def _draw_fill(self) -> None:
        idname = MESH_OT_gridmesh_fill.bl_idname
        column = self.layout.column()
        column.operator(idname, icon="MESH_GRID").holes = "SELECTED"
        column.operator(idname, text="Fill All Holes").holes = "ALL"
        column.operator(MESH_OT_gridmesh_bridge.bl_idname)
        column.operator(MESH_OT_gridmesh_regrid.bl_idname, icon="MOD_REMESH")

    def _draw_strokes(self, context: bpy.types.Context) -> None:
        idname = OBJECT_OT_gridmesh_from_strokes.bl_idname
        column = self.layout.column()
        drawings, bodies = strokes.source_objects(context), meshes.selected_bodies(context)
        row = column.row()
        row.enabled = bool(drawings)
        row.operator(idname, icon="MESH_DATA").source = "OBJECTS"
        row = column.row()
        row.enabled = bool(drawings)
        row.menu(VIEW3D_MT_gridmesh_presets.__name__, icon="PRESET")
        row = column.row()
        row.enabled = bool(drawings or bodies)
        again = row.operator(idname, text="Update Bodies", icon="FILE_REFRESH")
        again.source, again.update_existing = "OBJECTS", True
        if strokes.annotation(context.scene) is not None:
            column.operator(idname, text="Annotations to Mesh").source = "ANNOTATIONS"
        column.operator(OBJECT_OT_gridmesh_from_image.bl_idname, icon="IMAGE_DATA")
        if OBJECT_OT_gridmesh_update_image.poll(context):
            column.operator(OBJECT_OT_gridmesh_update_image.bl_idname, icon="FILE_REFRESH")
        if OBJECT_OT_gridmesh_bone_weights.poll(context):
            column.operator(OBJECT_OT_gridmesh_bone_weights.bl_idname, icon="BONE_DATA")
        if not (drawings or bodies or any(map(shows_picture, strokes.selected(context)))):
            self.layout.label(text="Select a drawing or a curve", icon="INFO")


class VIEW3D_MT_gridmesh_presets(bpy.types.Menu):  # noqa: N801
    """Make meshes from strokes with the options of a preset."""

    bl_label = "Presets"

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw an entry for each preset that comes with the extension."""
        idname = OBJECT_OT_gridmesh_from_strokes.bl_idname
        for label, properties in preset_files.shipped(idname).items():
            entry = self.layout.operator(idname, text=label)
            entry.source = "OBJECTS"
            for name, value in properties.items():
                setattr(entry, name, value)


def _draw_cut(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    idname = OBJECT_OT_gridmesh_cut.bl_idname
    column = layout.column()
    column.operator(idname, text="Draw Cut", icon="GREASEPENCIL").source = "DRAWN"
    row = column.row()
    row.enabled = bool(cutline.stroke_objects(context))
    row.operator(idname, text="Cut along Stroke").source = "OBJECTS"


def _stroke_entry(menu: Any, context: bpy.types.Context) -> None:
    if strokes.source_objects(context):
        menu.layout.separator()
        menu.layout.operator(OBJECT_OT_gridmesh_from_strokes.bl_idname).source = "OBJECTS"


def _fill_entry(menu: Any, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator(MESH_OT_gridmesh_fill.bl_idname).holes = "SELECTED"
    menu.layout.operator(MESH_OT_gridmesh_regrid.bl_idname)


def _bridge_entry(menu: Any, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator(MESH_OT_gridmesh_bridge.bl_idname)


def _cut_entry(menu: Any, context: bpy.types.Context) -> None:
    if not OBJECT_OT_gridmesh_cut.poll(context):
        return
    idname = OBJECT_OT_gridmesh_cut.bl_idname
    menu.layout.separator()
    menu.layout.operator_context = "INVOKE_REGION_WIN"
    menu.layout.operator(idname, text="Draw Cut & Cap").source = "DRAWN"
    if cutline.stroke_objects(context):
        menu.layout.operator(idname, text="Cut & Cap along Stroke").source = "OBJECTS"


def _join_entry(menu: Any, context: bpy.types.Context) -> None:
    if OBJECT_OT_gridmesh_join.poll(context):
        menu.layout.separator()
        menu.layout.operator(OBJECT_OT_gridmesh_join.bl_idname)


def _entries() -> Iterator[tuple[Any, Any]]:
    """Menus of this version, and what is drawn at their end."""
    for names, entry in (
        (STROKE_MENUS, _stroke_entry),
        (FILL_MENUS, _fill_entry),
        (BRIDGE_MENUS, _bridge_entry),
        (CUT_MENUS, _cut_entry),
        (JOIN_MENUS, _join_entry),
    ):
        for name in names:
            menu = getattr(bpy.types, name, None)
            if menu is not None:
                yield menu, entry


def register() -> None:
    """Add the entries to the menus that this version has."""
    for menu, entry in _entries():
        menu.append(entry)


def unregister() -> None:
    """Take the entries out again."""
    for menu, entry in _entries():
        menu.remove(entry)


classes = (VIEW3D_MT_gridmesh_presets, VIEW3D_PT_gridmesh)
