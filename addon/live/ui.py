# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators and panel of bodies that follow their drawing."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import EnumProperty

from ..bodies import profilecurve
from ..bodies.strokes import selected
from ..data import frames, written
from ..text.telling import told
from ..text.translations import CONTEXT
from ..ui import wrapping
from ..ui.properties import may_bend
from . import engine, migration, watch
from .solve import ALGORITHM


class OnBodies:
    """What needs bodies with a link in the selection."""

    @classmethod
    def chosen(cls, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Selected bodies that are linked to a drawing."""
        return [ob for ob in selected(context) if ob.type == "MESH" and frames.is_linked(ob)]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a body."""
        if cls.chosen(context):
            return True
        cls.poll_message_set(told("Select a body that is linked to its drawing", "tooltips"))
        return False


class OBJECT_OT_gridmesh_freeze(OnBodies, bpy.types.Operator):  # noqa: N801
    """Make plain meshes of the selected bodies; outlines drawn with the tool are removed"""  # noqa: D400 (the tooltip)

    bl_idname = "object.gridmesh_freeze"
    bl_label = "Freeze"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Cut the links."""
        for ob in self.chosen(context):
            engine.freeze(ob)
        return {"FINISHED"}


class OBJECT_OT_gridmesh_adopt(OnBodies, bpy.types.Operator):  # noqa: N801
    """Make the selected bodies anew with this version of GridMesh, and let them follow their drawing"""  # noqa: D400

    bl_idname = "object.gridmesh_adopt"
    bl_label = "Adopt"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Take the bodies over and make them in full, also in background: it was asked for."""
        problems = []
        for ob in self.chosen(context):
            live = ob.gridmesh_live
            live.algorithm, live.digest = ALGORITHM, ""
            engine.remake(ob)
            live.enabled = True
            if live.problem:
                problems.append(f"'{ob.name}': {live.problem}")
        if problems:
            self.report({"WARNING"}, told("\n".join(problems[:3])))
        return {"FINISHED"}


class OBJECT_OT_gridmesh_rebuild(OnBodies, bpy.types.Operator):  # noqa: N801
    """Make the selected bodies anew from their outlines; what was changed in their meshes by hand is lost"""  # noqa: D400

    bl_idname = "object.gridmesh_rebuild"
    bl_label = "Rebuild from Outline"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Give up what was changed by hand, and follow again; also in background: it was asked for."""
        problems = []
        for ob in self.chosen(context):
            engine.rebuild(ob)
            if ob.gridmesh_live.problem:
                problems.append(f"'{ob.name}': {ob.gridmesh_live.problem}")
        if problems:
            self.report({"WARNING"}, told("\n".join(problems[:3])))
        return {"FINISHED"}


class OBJECT_OT_gridmesh_curve(OnBodies, bpy.types.Operator):  # noqa: N801
    """Give the selected bodies a curve that reshapes their profile, from rim to top; edit it below"""  # noqa: D400

    bl_idname = "object.gridmesh_curve"
    bl_label = "Profile Curve"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    shape: EnumProperty(
        name="Shape",
        description="Curve to start from",
        items=[
            ("ROUND", "As It Is", "A straight line, which leaves the profile as it is"),
            *profilecurve.ITEMS,
            ("NONE", "None", "Take the curve away"),
        ],
        default="ROUND",
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: Any) -> str:
        """Say what the button does that is pointed at."""
        item = properties.bl_rna.properties["shape"].enum_items[properties.shape]
        return bpy.app.translations.pgettext_tip(item.description, CONTEXT)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Change the curves; those that follow are made anew, also in background: it was asked for."""
        problems = []
        for ob in self.chosen(context):
            if not ob.is_editable:
                problems.append(f"'{ob.name}': it is linked from another file")
                continue
            if self.shape == "NONE":
                profilecurve.remove(ob)
            else:
                profilecurve.put(ob, profilecurve.SHAPES[self.shape])
            if ob.gridmesh_live.enabled:
                engine.remake(ob)
            if ob.gridmesh_live.problem:
                problems.append(f"'{ob.name}': {ob.gridmesh_live.problem}")
        if problems:
            self.report({"WARNING"}, told("\n".join(problems[:3])))
        return {"FINISHED"}


class VIEW3D_PT_gridmesh_live(bpy.types.Panel):  # noqa: N801
    """The body's own options; a change is followed at once."""

    bl_label = "Live Body"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = watch.CATEGORY

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Show it for bodies with a link."""
        active = context.view_layer.objects.active
        return active is not None and active.type == "MESH" and frames.is_linked(active)

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draw the switch."""
        self.layout.prop(context.view_layer.objects.active.gridmesh_live, "enabled", text="")

    def draw(self, context: bpy.types.Context) -> None:
        """Draw what the body is made of."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        active = context.view_layer.objects.active
        live = active.gridmesh_live
        if migration.message:
            wrapping.label(layout, context, told(migration.message, "interface"), icon="INFO")
        if live.problem and live.enabled:
            column = layout.column()
            column.alert = True
            wrapping.label(column, context, told(live.problem, "interface"), icon="ERROR")
        if live.problem == engine.BY_HAND and written.by_hand(active.data):
            layout.operator(OBJECT_OT_gridmesh_rebuild.bl_idname, icon="FILE_REFRESH")
        if live.algorithm != ALGORITHM:
            layout.operator(OBJECT_OT_gridmesh_adopt.bl_idname)
        layout.prop(live, "source")
        live.draw_shape_options(layout)
        watch.watch()
        layout.prop(live, "pen")
        row = layout.row()
        row.active = may_bend(live)
        row.prop(live, "pen_detail")
        live.draw_sketch_options(layout)
        layout.operator(OBJECT_OT_gridmesh_freeze.bl_idname, icon="FREEZE")


classes = (
    OBJECT_OT_gridmesh_freeze,
    OBJECT_OT_gridmesh_adopt,
    OBJECT_OT_gridmesh_rebuild,
    OBJECT_OT_gridmesh_curve,
    VIEW3D_PT_gridmesh_live,
)
