# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of pictures that are dropped into a window: `object.gridmesh_from_image` asks what they are to become."""

from __future__ import annotations

import bpy

ENDINGS = (".png", ".jpg", ".jpeg", ".webp", ".tga", ".tif", ".tiff", ".bmp", ".exr")
"""Of the files that are read."""

_AREAS = {"VIEW_3D", "OUTLINER"}
"""Where they can be dropped; Blender asks which of those that take them is meant."""


class OBJECT_FH_gridmesh_picture(bpy.types.FileHandler):  # noqa: N801
    """Pictures become sprites or bodies where they are dropped."""

    bl_idname = "OBJECT_FH_gridmesh_picture"
    bl_label = "Picture to Mesh"
    bl_import_operator = "object.gridmesh_from_image"
    bl_file_extensions = ";".join(ENDINGS)

    @classmethod
    def poll_drop(cls, context: bpy.types.Context) -> bool:
        """Ask for Object Mode and an area for objects."""
        area = context.area
        return context.mode == "OBJECT" and area is not None and area.type in _AREAS


classes = (OBJECT_FH_gridmesh_picture,)
