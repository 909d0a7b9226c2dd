# SPDX-License-Identifier: GPL-3.0-or-later
"""A joined body while one of its parts is being changed: all parts as they are, in one mesh, without joints.

That takes milliseconds where joining takes tenths of a second. Only numbers of the mesh are written, no data blocks are made: so it may
be done while a tool is running.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

import bpy
import numpy as np
from mathutils import Matrix

from ..data import frames, written
from .parts import Placed
from .uniting import reversed_faces

OFTEN = 1 / 60
"""Seconds between two looks while something changes."""

timing: list[float] = []
"""Seconds of the last drafts, newest last."""

_shown: dict[int, str] = {}
"""By the `session_uid` of wholes: fingerprint of what is shown of them as a draft."""


@dataclass(frozen=True, eq=False)
class _Faces:
    """Part of a mesh, in the space of the whole."""

    points: np.ndarray
    """(n, 3)."""
    corners: np.ndarray
    starts: np.ndarray
    """(m,): where the corners of each face begin."""
    slots: np.ndarray
    """(m,): material slot in the whole."""


def shown(ob: bpy.types.Object) -> str:
    """Fingerprint of the draft that a whole shows; empty if it shows none."""
    return _shown.get(ob.session_uid, "")


def forget(ob: bpy.types.Object | None = None) -> None:
    """Forget that a whole shows a draft, or all of them."""
    if ob is None:
        _shown.clear()
    else:
        _shown.pop(ob.session_uid, None)


def show(ob: bpy.types.Object, placed: Sequence[Placed], fingerprint: str) -> bool:
    """Give a whole the faces of its parts; say whether that could be done.

    It is to be joined anew then, which its empty digest says.
    """
    mesh = ob.data
    linear = np.array(ob.matrix_world.to_3x3(), float)
    if mesh.shape_keys is not None or not mesh.is_editable or abs(np.linalg.det(linear)) == 0:
        return False
    started = perf_counter()
    to_whole = ob.matrix_world.inverted()
    slots = {material: at for at, material in reversed(list(enumerate(mesh.materials)))}
    found = [_faces(part, to_whole @ place, slots) for part, place in placed]
    _write(mesh, found)
    written.sign(mesh)
    ob.gridmesh_joined.digest = ""
    _shown[ob.session_uid] = fingerprint
    timing.append(perf_counter() - started)
    del timing[:-200]
    return True


def _faces(part: bpy.types.Object, place: Matrix, slots: dict[bpy.types.Material | None, int]) -> _Faces:
    mesh = part.data
    corners = written.corners_of(mesh)
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    matrix = np.array(place, float)
    if np.linalg.det(matrix[:3, :3]) < 0:
        corners = reversed_faces(corners, np.append(starts, len(corners)))
    own = np.array([slots.get(slot.material, 0) for slot in part.material_slots] or [0], np.int32)
    indices = np.zeros(len(starts), np.int32)
    mesh.polygons.foreach_get("material_index", indices)
    points = frames.moved(written.points_of(mesh).reshape(-1, 3).astype(float), matrix)
    return _Faces(points, corners, starts, own[np.clip(indices, 0, len(own) - 1)])


def _write(mesh: bpy.types.Mesh, found: Sequence[_Faces]) -> None:
    """Put faces into a mesh; where they are the same as before, only the vertices."""
    first = np.cumsum([0, *(len(one.points) for one in found)])
    begin = np.cumsum([0, *(len(one.corners) for one in found)])
    points = np.concatenate([one.points for one in found]).astype(np.float32)
    corners = np.concatenate([one.corners + at for one, at in zip(found, first, strict=False)])
    corners = corners.astype(np.int32)
    if len(mesh.vertices) != len(points) or not np.array_equal(written.corners_of(mesh), corners):
        mesh.clear_geometry()
        mesh.vertices.add(len(points))
        mesh.loops.add(len(corners))
        starts = np.concatenate([one.starts + at for one, at in zip(found, begin, strict=False)])
        mesh.polygons.add(len(starts))
        mesh.loops.foreach_set("vertex_index", corners)
        mesh.polygons.foreach_set("loop_start", starts.astype(np.int32))
        mesh.polygons.foreach_set("material_index", np.concatenate([one.slots for one in found]))
        mesh.vertices.foreach_set("co", points.ravel())
        mesh.update(calc_edges=True)
        return
    mesh.vertices.foreach_set("co", points.ravel())
    mesh.update()
