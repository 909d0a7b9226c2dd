# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_update_image`: sprites and bodies are made anew from their pictures."""

from __future__ import annotations

import bpy

from ..api import CancelledError
from ..bodies.strokes import selected
from ..data.meshes import obstacle_of_mesh
from ..native import NativeError
from ..text.messages import counted, listed
from ..text.telling import told
from ..ui.progress import Pointer
from . import images, placing
from .cutouts import Cutout, cut_out
from .tracing import PictureError


class OBJECT_OT_gridmesh_update_image(bpy.types.Operator):  # noqa: N801
    """Read the pictures of the selected sprites and bodies again, and make their meshes anew"""  # noqa: D400

    bl_idname = "object.gridmesh_update_image"
    bl_label = "Update from Picture"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for something made from a picture."""
        if context.mode == "OBJECT" and _made(context):
            return True
        cls.poll_message_set(told("Select a sprite or a body made from a picture", "tooltips"))
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Make all anew that can be, and only then change them."""
        done: list[tuple[bpy.types.Object, Cutout, bpy.types.Image]] = []
        failures: list[str] = []
        try:
            with Pointer(context) as pointer:
                for ob in _made(context):
                    try:
                        done.append((ob, *_anew(ob, pointer)))
                    except PictureError as error:
                        failures.append(f"'{ob.name}': {error}")
        except NativeError as error:
            self.report({"ERROR"}, told(str(error)))
            return {"CANCELLED"}
        except CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was made"))
            return {"CANCELLED"}
        for ob, cutout, image in done:
            placing.update(ob, cutout, image)
        if not done:
            self.report({"ERROR"}, told(listed(failures)))
            return {"CANCELLED"}
        self.report({"INFO"}, told(f"{counted(len(done), 'mesh')} updated"))
        for failure in failures:
            self.report({"WARNING"}, told(failure))
        return {"FINISHED"}


def _anew(ob: bpy.types.Object, pointer: Pointer) -> tuple[Cutout, bpy.types.Image]:
    reason = obstacle_of_mesh(ob)
    image = placing.picture_of(ob)
    if reason:
        raise PictureError(reason)
    if image is None:
        raise PictureError("its material has no picture any more; make it anew from the picture")
    if image.source == "FILE" and not image.is_dirty and image.packed_file is None:
        image.reload()
    _, options = placing.recall(ob)
    return cut_out(images.pixels(image), options, pointer), image


def _made(context: bpy.types.Context) -> list[bpy.types.Object]:
    return [ob for ob in selected(context) if placing.made_from_picture(ob)]


classes = (OBJECT_OT_gridmesh_update_image,)
