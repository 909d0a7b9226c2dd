# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries for the keymap, without a key: none of Blender's is taken, and each operator can be given one.

Preferences > Keymap finds them by the name "grid".
"""

from __future__ import annotations

import bpy

ENTRIES = (
    ("Object Mode", "object.gridmesh_from_strokes"),
    ("Grease Pencil Paint Mode", "object.gridmesh_from_strokes"),
    ("Grease Pencil Edit Mode", "object.gridmesh_from_strokes"),
    ("Mesh", "mesh.gridmesh_fill"),
    ("Mesh", "mesh.gridmesh_regrid"),
    ("Mesh", "mesh.gridmesh_bridge"),
    ("Object Mode", "object.gridmesh_cut"),
    ("Mesh", "object.gridmesh_cut"),
    ("Object Mode", "object.gridmesh_join"),
    ("Object Mode", "object.gridmesh_from_image"),
    ("Object Mode", "object.gridmesh_update_image"),
    ("Object Mode", "object.gridmesh_bone_weights"),
)

_made: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


def register() -> None:
    """Add the entries to the keymaps."""
    configuration = bpy.context.window_manager.keyconfigs.addon
    for name, idname in ENTRIES:
        keymap = configuration.keymaps.new(name=name, space_type="EMPTY")
        _made.append((keymap, keymap.keymap_items.new(idname, "NONE", "PRESS")))


def unregister() -> None:
    """Take them out again, also where some are."""
    while _made:
        keymap, item = _made.pop()
        keymap.keymap_items.remove(item)
