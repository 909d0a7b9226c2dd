# SPDX-License-Identifier: GPL-3.0-or-later
"""Transforms that were applied to joined bodies, and origins that were set: taken over, so that they go on following their parts.

Blender moves what was in an object's matrix into its mesh and leaves its children, the parts, where they are in the world. It goes into
the `space` of the whole. A mesh that was moved in its object, in Edit Mode, was changed by hand.
"""

from __future__ import annotations

import bpy
import numpy as np

from ..data import written
from . import lying, marks, parts

SAME = 4e-6
"""Part of their largest entries by which matrices differ that are the same but for single precision."""

_seen: dict[int, np.ndarray] = {}
"""World matrices of wholes by `session_uid`, where they were seen last with the mesh that was made of them."""


def forget() -> None:
    """Forget what was seen: in another file."""
    _seen.clear()


def changed_by_hand(ob: bpy.types.Object) -> bool:
    """Whether the mesh of a whole is not what was made of it. What was applied to it is taken over before."""
    mesh = ob.data
    if not written.by_hand(mesh):
        _seen[ob.session_uid] = np.array(ob.matrix_world)
        return False
    if not ob.is_editable or not mesh.is_editable or not mesh.gridmesh_made or written.is_edited(ob):
        return True
    motion = written.motion(mesh)
    if motion is None:
        return True
    group = [ob] if mesh.users < 2 else [one for one in bpy.data.objects if one.data == mesh]
    group = [one for one in group if one == ob or (parts.is_whole(one) and one.is_editable)]
    if not _absorb(ob, motion):
        return True
    for one in group:
        if one != ob:
            _take_over(one, motion)
    made = mesh.gridmesh_made
    written.sign(mesh)
    for one in group:
        joined = one.gridmesh_joined
        if joined.made == made:
            joined.made = mesh.gridmesh_made
        _seen[one.session_uid] = np.array(one.matrix_world)
    return False


def _absorb(ob: bpy.types.Object, motion: np.ndarray) -> bool:
    """Take a motion of the mesh over into the space of a whole if it was taken out of the object's matrix; say whether it was."""
    joined = ob.gridmesh_joined
    stayed = marks.is_same(lying.fingerprint(ob), joined.digest)
    before = list(joined.space)
    _take_over(ob, motion)
    now = lying.fingerprint(ob)
    is_same = marks.is_same(now, joined.digest)
    seen, world = _seen.get(ob.session_uid), np.array(ob.matrix_world)
    if (is_same and not stayed) or (seen is not None and _close(world @ motion, seen)):
        if is_same:
            joined.digest = now
        return True
    joined.space = before
    return False


def _take_over(ob: bpy.types.Object, motion: np.ndarray) -> None:
    """Let the parts of a whole lie to its mesh as before when that was moved."""
    space = np.array(ob.gridmesh_joined.space, float).reshape(4, 4)
    space = motion @ space if space[3, 3] else motion
    ob.gridmesh_joined.space = space.ravel().tolist()


def _close(one: np.ndarray, two: np.ndarray) -> bool:
    return bool(np.abs(one - two).max() <= SAME * max(np.abs(one).max(), np.abs(two).max()))
