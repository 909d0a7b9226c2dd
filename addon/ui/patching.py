# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators have in common: those that tell numbers, and those that put patches into meshes being edited."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
from bpy.props import EnumProperty, StringProperty

from .. import api
from ..data import defaults
from ..text.messages import faces_counted
from ..text.telling import told
from .properties import PATCH_FACES


class ResultShown:
    """Mixed into operators: the numbers of what was made, in the redo panel."""

    result: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def draw_result(self) -> bpy.types.UILayout:
        """Draw the numbers, and return the layout for the options below."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        if self.result:
            numbers = layout.column(align=True)
            for part in told(self.result, "interface").split(", ", 1):  # on one line they would be cut off
                numbers.label(text=part, translate=False)
        return layout


class PatchOptions(ResultShown):
    """Mixed into operators that put patches into meshes: how these continue what is around them."""

    smooth: EnumProperty(
        name="Smoothness",
        description="How a patch continues the surface around it",
        items=[
            ("FLAT", "Flat", "Stretched into the hole like a soap film"),
            ("TANGENT", "Tangent", "With the slope of the surface"),
            ("CURVATURE", "Curvature", "With the slope and the curvature of the surface"),
        ],
        default="TANGENT",
    )

    def has_module(self, function: str) -> bool:
        """Whether the native module is there with this function; if not, it is told."""
        try:
            api.native(function)
        except api.NativeError as error:
            self.report({"ERROR"}, told(str(error)))
            return False
        return True


class PatchFaces(PatchOptions):
    """Mixed into operators whose patches are of triangles or of quads."""

    cells: EnumProperty(
        name="Faces",
        description="What patches are made of",
        items=PATCH_FACES,
        default=defaults.CELLS,
    )

    @classmethod
    def can_edit(cls, context: bpy.types.Context, needs: str) -> bool:
        """Whether a mesh is being edited and can be seen; if not, the tooltip says so. needs : what it says outside of Edit Mode."""
        if context.mode == "EDIT_MESH" and edited_meshes(context):
            return True
        hidden = "The mesh that is being edited is hidden; show it, or leave Edit Mode"
        cls.poll_message_set(told(hidden if context.mode == "EDIT_MESH" else needs, "tooltips"))
        return False


def edited_meshes(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Objects whose meshes are being edited, as far as they can be seen; each mesh once."""
    return [ob for ob in context.objects_in_mode_unique_data if ob.type == "MESH"]


def faces_made(jobs: Sequence[Any]) -> str:
    """How many quads and triangles were added to the meshes of jobs."""
    return faces_counted(len(face.verts) for job in jobs for face in job.added.faces)
