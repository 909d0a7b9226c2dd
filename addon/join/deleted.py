# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of joined bodies that a user has deleted: while the whole points to them Blender keeps them, in no scene.

Between undo steps nothing may be taken out of the list of parts, or removed: Blender takes an object that is alike in two steps as it
is, with what was changed between them. So such a part is put aside only, and let go by the next operator, or when the file is opened.
"""

from __future__ import annotations

import bpy

from ..data import frames


def put_aside(whole: bpy.types.Object) -> None:
    """Take the outlines of deleted parts out of the scene, too."""
    for entry in whole.gridmesh_joined.parts:
        part = entry.ob
        if part is None or part.users_scene or not frames.is_linked(part):
            continue
        outline = part.gridmesh_live.source
        if outline is not None and outline.gridmesh_outline and outline.parent == part:
            for collection in list(outline.users_collection):
                collection.objects.unlink(outline)


def let_go(whole: bpy.types.Object) -> None:
    """Forget deleted parts and remove them with their outlines. Only where an undo step follows, or begins."""
    entries = whole.gridmesh_joined.parts
    gone = [at for at, entry in enumerate(entries) if entry.ob is None or not entry.ob.users_scene]
    for at in reversed(gone):
        part = entries[at].ob
        entries.remove(at)
        if part is not None and part.library is None:
            _remove_outline(part)
            _remove(part)


def remove_with_outline(part: bpy.types.Object) -> None:
    """Remove a part and the outline that is its own."""
    outline = frames.owned(part) if frames.is_linked(part) else None
    _remove(part)
    if outline is not None:
        _remove(outline)


def _remove_outline(part: bpy.types.Object) -> None:
    if not frames.is_linked(part):
        return
    outline = part.gridmesh_live.source
    if (
        outline is not None
        and outline.gridmesh_outline
        and outline.parent == part
        and not outline.users_scene
    ):
        _remove(outline)


def _remove(ob: bpy.types.Object) -> None:
    data = ob.data
    bpy.data.objects.remove(ob)
    if data is not None and not data.users:
        bpy.data.batch_remove([data])
