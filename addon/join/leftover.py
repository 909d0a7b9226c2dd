# SPDX-License-Identifier: GPL-3.0-or-later
"""Hidden parts whose joined body a user has deleted: they go as well, with their outlines.

Blender takes the parent away from the children of what is deleted. So they differ in the two steps, and undo reads them anew.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..data import frames
from . import deleted, parts


def hold(whole: bpy.types.Object, own: Sequence[bpy.types.Object]) -> None:
    """Let the parts that hang on a whole know that they do."""
    for part in own:
        if part.parent == whole and part.is_editable and not part.gridmesh_part.held:
            part.gridmesh_part.held = True


def found() -> list[bpy.types.Object]:
    """Hidden parts that hang on nothing any more. Walks all objects of the file."""
    return [ob for ob in bpy.data.objects if ob.type == "MESH" and _is_left(ob)]


def remove() -> int:
    """Remove hidden parts that hang on nothing any more and are used by nothing else; return how many there were."""
    condemned = found()
    if not condemned:
        return 0
    users = bpy.data.user_map(subset=condemned)
    condemned = [part for part in condemned if not _is_used(part, users[part])]
    for part in condemned:
        deleted.remove_with_outline(part)
    return len(condemned) + (remove() if condemned else 0)


def _is_left(ob: bpy.types.Object) -> bool:
    if ob.parent is not None or ob.library is not None or ob.override_library is not None:
        return False
    if not ob.hide_render or ob.use_fake_user or not ob.users_scene:
        return False
    return parts.is_held(ob) and not ob.visible_get()


def _is_used(part: bpy.types.Object, users: set[bpy.types.ID]) -> bool:
    """Whether an object in a scene, but for its outline, or anything but a collection or a scene refers to a part."""
    outline = frames.owned(part) if frames.is_linked(part) else None
    for user in users:
        if isinstance(user, bpy.types.Object):
            own = user.parent == part and parts.is_held(user)  # of a whole that was a part itself
            if user not in (part, outline) and user.users_scene and not own:
                return True
        elif not isinstance(user, (bpy.types.Collection, bpy.types.Scene)):
            return True
    return False
