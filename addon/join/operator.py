# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_join`: the selected meshes become one closed body."""

from __future__ import annotations

from time import perf_counter

import bpy
from bpy.props import BoolProperty, FloatProperty

from .. import api
from ..data import defaults
from ..text.messages import listed
from ..text.telling import told
from ..ui.patching import ResultShown
from ..ui.progress import Pointer
from . import joining
from .uniting import JoinError


class OBJECT_OT_gridmesh_join(ResultShown, bpy.types.Operator):  # noqa: N801
    """Join the selected meshes to one closed body in the active object, blended where they meet"""  # noqa: D400 (the tooltip)

    bl_idname = "object.gridmesh_join"
    bl_label = "Grid Join"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    blend: FloatProperty(
        name="Blend Width",
        description="Edge lengths to each side of the line where two parts meet that become a smooth transition; 0 keeps "
        "the crease",
        default=defaults.BLEND,
        min=0.0,
        soft_max=10.0,
        max=1000.0,
    )
    edge_length: FloatProperty(
        name="Edge Length",
        description="The edge length that Blend Width counts in; 0 for that of each part",
        subtype="DISTANCE",
        default=0.0,
        min=0.0,
        options={"SKIP_SAVE"},
    )
    strict: BoolProperty(
        name="Strict",
        description="Refuse joints that meet themselves or the parts, instead of warning of them",
        default=False,
    )
    keep_parts: BoolProperty(
        name="Keep Parts",
        description="Keep the selected objects, hidden, and make the body a new object; without, they become it",
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for two meshes in Object Mode."""
        if context.mode == "OBJECT" and len(join_objects(context)) > 1:
            return True
        cls.poll_message_set(
            told("Select two closed meshes or more in Object Mode, one of them active", "tooltips")
        )
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Read and join the meshes, and only then change the scene."""
        started = perf_counter()
        options = joining.Options(self.blend, self.edge_length or None, self.strict, self.keep_parts)
        try:
            with Pointer(context) as pointer:
                done = joining.join(context, join_objects(context), options, pointer)
        except (api.NativeError, JoinError) as error:
            self.report({"ERROR"}, told(listed([str(error)])))
            return {"CANCELLED"}
        except api.CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was joined"))
            return {"CANCELLED"}
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
        layout.prop(self, "keep_parts")


def join_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Meshes to be joined, the active one first; none if no mesh is active."""
    active = context.view_layer.objects.active
    if active is None or active.type != "MESH":
        return []
    others = [ob for ob in context.selected_objects if ob.type == "MESH" and ob != active]
    return [active, *others]


classes = (OBJECT_OT_gridmesh_join,)
