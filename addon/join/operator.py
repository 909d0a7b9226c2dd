# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_join`: the selected meshes become one closed body."""

from __future__ import annotations

from time import perf_counter

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import api
from ..text.messages import listed
from ..text.telling import told
from ..ui import wrapping
from ..ui.patching import ResultShown
from ..ui.progress import Pointer
from . import blending, characters, following, joining, parts
from .uniting import JoinError


class OBJECT_OT_gridmesh_join(ResultShown, bpy.types.Operator):  # noqa: N801
    """Join the selected meshes to one closed body in the active object, blended where they meet"""  # noqa: D400 (the tooltip)

    bl_idname = "object.gridmesh_join"
    bl_label = "Grid Join"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    blend: blending.blend()
    edge_length: blending.edge_length(options={"SKIP_SAVE"})
    strict: blending.strict()
    follow: BoolProperty(
        name="Follow the Parts",
        description="Let the body follow where live bodies are joined, or parts are kept: it is joined anew when one of them changes",
        default=True,
    )
    keep_parts: BoolProperty(
        name="Keep Parts",
        description="Keep the selected objects, hidden, and make the body a new object; without, they become it",
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for meshes in Object Mode."""
        if context.mode == "OBJECT" and join_objects(context):
            return True
        cls.poll_message_set(
            told(
                "Select closed meshes in Object Mode, one of them active; or one with pieces that overlap",
                "tooltips",
            )
        )
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Read and join the meshes, and only then change the scene."""
        started = perf_counter()
        objects = join_objects(context)
        keep = self.keep_parts or (self.follow and any(following.changes(ob) for ob in objects))
        options = joining.Options(self.blend, self.edge_length or None, self.strict, keep)
        needless = [] if keep else following.hidden_parts(objects)
        try:
            with Pointer(context) as pointer:
                done = joining.join(context, objects, options, pointer)
        except (api.NativeError, JoinError) as error:
            self.report({"ERROR"}, told(listed([str(error)])))
            return {"CANCELLED"}
        except api.CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was joined"))
            return {"CANCELLED"}
        following.discard(needless)
        if keep and self.follow:
            following.remember(done.ob, objects, options)
        self.result = done.result(perf_counter() - started)
        self.report({"INFO"}, told(self.result))
        if done.notes:
            self.report({"INFO"}, told(listed(done.notes)))
        if done.warnings:
            self.report({"WARNING"}, told(listed(done.warnings)))
        return {"FINISHED"}

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.draw_result()
        layout.prop(self, "blend")
        layout.prop(self, "edge_length")
        layout.prop(self, "strict")
        layout.prop(self, "follow")
        layout.prop(self, "keep_parts")


class OBJECT_OT_gridmesh_apply_join(bpy.types.Operator):  # noqa: N801
    """Make a plain mesh of the active joined body; its hidden parts are removed"""  # noqa: D400 (the tooltip)

    bl_idname = "object.gridmesh_apply_join"
    bl_label = "Apply Join"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    keep_parts: BoolProperty(
        name="Keep Parts",
        description="Show the parts again instead of removing them",
        default=False,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a joined body."""
        return _asks_for_whole(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forget the parts."""
        characters.apply(context.view_layer.objects.active, keep_parts=self.keep_parts)
        return {"FINISHED"}


class OBJECT_OT_gridmesh_show_parts(bpy.types.Operator):  # noqa: N801
    """Show the parts of the active joined body to be edited and hide the body, or the other way round"""  # noqa: D400

    bl_idname = "object.gridmesh_show_parts"
    bl_label = "Show Parts"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a joined body."""
        return _asks_for_whole(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Swap what is to be seen."""
        following.swap(context.view_layer.objects.active)
        return {"FINISHED"}


class OBJECT_OT_gridmesh_pick_part(bpy.types.Operator):  # noqa: N801
    """Show a part of the joined body over it and select it, to be moved, edited or deleted; the body follows"""  # noqa: D400

    bl_idname = "object.gridmesh_pick_part"
    bl_label = "Pick Part"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    name: StringProperty(options={"HIDDEN", "SKIP_SAVE"})
    """Name of the part."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a joined body."""
        return _asks_for_whole(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Pick it."""
        whole = following.whole_of(context.view_layer.objects.active)
        part = next((part for part in following.parts_of(whole) if part.name == self.name), None)
        if part is None:
            self.report({"ERROR"}, told(f"'{whole.name}' has no part '{self.name}'"))
            return {"CANCELLED"}
        characters.pick(part)
        return {"FINISHED"}


class OBJECT_OT_gridmesh_split_part(bpy.types.Operator):  # noqa: N801
    """Take the active part out of the joined body; it is a body of its own again, and so is its twin"""  # noqa: D400

    bl_idname = "object.gridmesh_split_part"
    bl_label = "Split Off Part"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a part."""
        active = context.view_layer.objects.active
        whole = None if active is None else following.whole_of(active)
        if context.mode == "OBJECT" and whole not in (None, active):
            return True
        cls.poll_message_set(told("Make a part of a joined body the active object", "tooltips"))
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Split it off."""
        characters.split(context.view_layer.objects.active)
        return {"FINISHED"}


def _asks_for_whole(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    active = context.view_layer.objects.active
    if context.mode == "OBJECT" and active is not None and following.whole_of(active) is not None:
        return True
    cls.poll_message_set(told("Make a joined body, or one of its parts, the active object", "tooltips"))
    return False


class VIEW3D_PT_gridmesh_joined(bpy.types.Panel):  # noqa: N801
    """The options of a joined body; a change is followed at once."""

    bl_label = "Joined Body"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "GridMesh"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Show it for joined bodies that remember their parts, and for those."""
        active = context.view_layer.objects.active
        return active is not None and following.whole_of(active) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draw what it is made of."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        whole = following.whole_of(context.view_layer.objects.active)
        joined = whole.gridmesh_joined
        if joined.problem:
            column = layout.column()
            column.alert = True
            wrapping.label(column, context, told(joined.problem, "interface"), icon="ERROR")
        layout.prop(joined, "blend")
        layout.prop(joined, "edge_length")
        layout.prop(joined, "strict")
        self._draw_parts(layout, context, whole)
        hidden = not whole.visible_get()
        text = "Hide Parts" if hidden else "Show Parts"
        layout.operator(OBJECT_OT_gridmesh_show_parts.bl_idname, text=text, icon="HIDE_OFF")
        layout.operator(OBJECT_OT_gridmesh_apply_join.bl_idname, icon="FREEZE")

    @staticmethod
    def _draw_parts(layout: bpy.types.UILayout, context: bpy.types.Context, whole: bpy.types.Object) -> None:
        """Draw a button for each part; below the one that is active, how it lies."""
        column = layout.column(align=True)
        column.label(text="Parts")
        for part in following.parts_of(whole):
            active = part == context.view_layer.objects.active
            entry = column.operator(
                OBJECT_OT_gridmesh_pick_part.bl_idname,
                text=part.name,
                translate=False,
                icon="RADIOBUT_ON" if active else "RADIOBUT_OFF",
            )
            entry.name = part.name
            if active and part != whole:
                box = column.box().column()
                if parts.has_depth(part):
                    box.prop(part.gridmesh_part, "depth")
                box.prop(part.gridmesh_part, "twin")
                box.operator(OBJECT_OT_gridmesh_split_part.bl_idname, icon="UNLINKED")


def join_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Meshes to be joined, the active one first; none if no mesh is active."""
    active = context.view_layer.objects.active
    if active is None or active.type != "MESH":
        return []
    others = [ob for ob in context.selected_objects if ob.type == "MESH" and ob != active]
    return [active, *others]


classes = (
    OBJECT_OT_gridmesh_join,
    OBJECT_OT_gridmesh_apply_join,
    OBJECT_OT_gridmesh_show_parts,
    OBJECT_OT_gridmesh_pick_part,
    OBJECT_OT_gridmesh_split_part,
    VIEW3D_PT_gridmesh_joined,
)
