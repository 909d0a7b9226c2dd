# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_bone_weights`: flat meshes follow the bones of an armature."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from bpy.props import FloatProperty, IntProperty

from ..api import CancelledError
from ..bodies.strokes import selected
from ..native import NativeError
from ..text.messages import counted, listed
from ..text.telling import told
from ..ui.progress import Pointer
from . import weights
from .weights import WeightError


class OBJECT_OT_gridmesh_bone_weights(bpy.types.Operator):  # noqa: N801
    """Let the selected flat meshes follow the bones of the active armature, each bone within its own limb"""  # noqa: D400

    bl_idname = "object.gridmesh_bone_weights"
    bl_label = "Weights from Bones"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    reach: FloatProperty(
        name="Joint Reach",
        description="How far a joint reaches into the limbs that meet there, relative to half their width",
        default=1.0,
        min=0.01,
        soft_min=0.2,
        soft_max=4.0,
        max=100.0,
    )
    most: IntProperty(
        name="Bones for a Vertex",
        description="The most bones that move a vertex",
        default=4,
        min=1,
        soft_max=8,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for an armature, and meshes that have one or are selected with it."""
        if context.mode == "OBJECT" and any(_armature(context, ob) for ob in _meshes(context)):
            return True
        cls.poll_message_set(told("Select flat meshes, and then an armature", "tooltips"))
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Weigh all meshes, and only then change them."""
        found: list[tuple[bpy.types.Object, bpy.types.Object, list[str], np.ndarray]] = []
        failures: list[str] = []
        chosen = [(ob, _armature(context, ob)) for ob in _meshes(context)]
        chosen = [(ob, armature) for ob, armature in chosen if armature is not None]
        try:
            with Pointer(context) as pointer:
                for at, (ob, armature) in enumerate(chosen):
                    part = pointer.part(at / len(chosen), (at + 1) / len(chosen))
                    try:
                        names, ends = weights.bones_of(armature)
                        if not names:
                            raise WeightError("the armature has no bones that deform")
                        if not ob.is_editable or not ob.data.is_editable:
                            raise WeightError("it is linked from another file; make it local")
                        values = weights.for_bones(ob, ends, most=self.most, reach=self.reach, progress=part)
                        found.append((ob, armature, names, values))
                    except WeightError as error:
                        failures.append(f"'{ob.name}': {error}")
        except NativeError as error:
            self.report({"ERROR"}, told(str(error)))
            return {"CANCELLED"}
        except CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was changed"))
            return {"CANCELLED"}
        if not found:
            self.report({"ERROR"}, told(listed(failures)))
            return {"CANCELLED"}
        for ob, armature, names, values in found:
            weights.put(ob, names, values)
            _follow(ob, armature)
        bones = sum(len(names) for _, _, names, _ in found)
        self.report({"INFO"}, told(f"{counted(len(found), 'mesh')}: weights for {counted(bones, 'bone')}"))
        for failure in failures:
            self.report({"WARNING"}, told(failure))
        return {"FINISHED"}

    def draw(self, _context: Any) -> None:
        """Draw the redo panel."""
        self.layout.use_property_split = True
        self.layout.prop(self, "reach")
        self.layout.prop(self, "most")


def _meshes(context: bpy.types.Context) -> list[bpy.types.Object]:
    return [ob for ob in selected(context) if ob.type == "MESH"]


def _armature(context: bpy.types.Context, ob: bpy.types.Object) -> bpy.types.Object | None:
    """Return the armature that is active, or else the one that the object follows."""
    active = context.view_layer.objects.active
    if active is not None and active.type == "ARMATURE":
        return active
    modifiers = (mod.object for mod in ob.modifiers if mod.type == "ARMATURE")
    return next((armature for armature in modifiers if armature is not None), None)


def _follow(ob: bpy.types.Object, armature: bpy.types.Object) -> None:
    """Let an object follow an armature, as Blender's *Armature Deform* does; where it is stays."""
    if not any(mod.type == "ARMATURE" and mod.object == armature for mod in ob.modifiers):
        modifier = ob.modifiers.new("Armature", "ARMATURE")
        modifier.object = armature
    if ob.parent is None:
        ob.parent = armature
        ob.matrix_parent_inverse = armature.matrix_world.inverted_safe()


classes = (OBJECT_OT_gridmesh_bone_weights,)
