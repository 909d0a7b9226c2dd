# SPDX-License-Identifier: GPL-3.0-or-later
"""Transforms that were applied to bodies and drawings, and origins that were set: taken over, so that nothing moves.

Blender moves what was in an object's matrix into its data. Of a body it goes into the body's `space`, whatever it is; of
a drawing that carries its bodies, out of their frames. The sketch in the body's own space stays what it was.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..bodies.outlines import Sketch
from ..data import frames, written
from . import family
from .reading import LostError, sketch_of

SAMPLES = 8
"""Points of a stroke that a body remembers."""

SAME = 1e-6
"""Part of their reach by which points differ that are the same but for single precision."""

_places: dict[int, np.ndarray] = {}
"""World matrices by `session_uid`, where bodies and drawings were seen last."""


_hands: dict[int, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
"""By `session_uid`, of bodies changed by hand: vertices (n, 3), space and world matrix, as they were seen last."""


def forget() -> None:
    """Forget what has been seen: in another file."""
    _places.clear()
    _hands.clear()
    written.forget()


def note(ob: bpy.types.Object) -> None:
    """Remember where an object is."""
    _places[ob.session_uid] = np.array(ob.matrix_world)


def look(ob: bpy.types.Object) -> None:
    """Remember where a body and its drawing are, and the mesh."""
    if not written.by_hand(ob.data):
        note(ob)
    if ob.gridmesh_live.source is not None:
        note(ob.gridmesh_live.source)


def trace(sketch: Sketch) -> np.ndarray:
    """All drawn points (n, 4) of a sketch, and the width there by the mean of all, as large as the sketch."""
    rows = []
    for one in (sketch, *sketch.holes):
        points, widths = one.stroke.points, one.stroke.widths
        known = widths is not None and len(widths) == len(points) and np.mean(widths) > 0
        column = np.asarray(widths) / np.mean(widths) * sketch.size if known else np.zeros(len(points))
        rows.append(np.column_stack([points, column]))
    return np.concatenate(rows)


def alike(ob: bpy.types.Object, one: np.ndarray | None, two: np.ndarray) -> bool:
    """Whether points in a body's space are the same but for the rounding of drawing, matrices and mesh."""
    if one is None or one.shape != two.shape:
        return False
    return bool(np.abs(one - two).max(initial=0.0) <= SAME * _reach(ob, two))


def _reach(ob: bpy.types.Object, points: np.ndarray) -> float:
    space = frames.space(ob)
    away = np.linalg.solve(space[:3, :3], space[:3, 3])
    return float(np.abs(points).max(initial=0.0) + np.abs(away).max() + np.abs(frames.frame(ob)[:3, 3]).max())


def samples(sketch: Sketch) -> np.ndarray:
    """Points (`SAMPLES`, 3) of a sketch by which it is known again."""
    points = np.asarray(sketch.stroke.points, float)
    return points[np.linspace(0, len(points), SAMPLES, endpoint=False).astype(int)]


def remember(ob: bpy.types.Object, sketch: Sketch) -> None:
    """Let a body remember the sketch that its mesh was made of."""
    live = ob.gridmesh_live
    live.samples = samples(sketch).ravel().tolist()
    _remember_link(ob)


def _link(ob: bpy.types.Object) -> np.ndarray:
    """Matrix (4, 4) from an object to its parent."""
    return np.array(ob.matrix_parent_inverse) @ np.array(ob.matrix_basis)


def _remember_link(ob: bpy.types.Object) -> None:
    values = _link(ob).astype(np.float32).ravel()
    if not np.array_equal(values, np.array(ob.gridmesh_live.carried, np.float32)):
        ob.gridmesh_live.carried = values.tolist()


def _remembered(live: Any) -> np.ndarray | None:
    values = np.array(live.samples, float).reshape(SAMPLES, 3)
    return values if values.any() else None


def _as_before(ob: bpy.types.Object) -> bool:
    """Whether the sketch of a body is the one that it remembers, or lies in it as it did."""
    live = ob.gridmesh_live
    before, now = frames.stored(ob), frames.frame(ob)
    if before is not None and np.abs(before - now).max() <= SAME * np.abs(now).max():
        return True
    known = _remembered(live)
    if known is None:
        return False
    try:
        sketch = sketch_of(ob, bpy.context.evaluated_depsgraph_get())
    except (LostError, np.linalg.LinAlgError):
        return False
    return alike(ob, known, samples(sketch))


def absorb(ob: bpy.types.Object) -> None:
    """Take over into a body's space what its mesh was moved by as a whole. Anything else is left: it is handwork.

    What was taken out of the object's matrix leaves the outline where it is. Where the mesh was moved in its object, in
    Edit Mode, an outline of its own goes along.
    """
    mesh = ob.data
    if not ob.is_editable or not mesh.is_editable or mesh.shape_keys is not None or written.is_edited(ob):
        return
    if not mesh.gridmesh_made or not written.by_hand(mesh):
        return
    matrix = written.motion(mesh)
    if matrix is None:
        _absorb_by_hand(ob)
        return
    source = ob.gridmesh_live.source
    group = [ob] if mesh.users < 2 else [one for one in family.bodies(source) if one.data == mesh]
    before = [list(one.gridmesh_live.space) for one in group]
    for one in group:
        one.gridmesh_live.space = (matrix @ frames.space(one)).ravel().tolist()
        link = np.array(one.gridmesh_live.carried, float).reshape(4, 4)
        if link[3, 3]:
            one.gridmesh_live.carried = (link @ np.linalg.inv(matrix)).ravel().tolist()
    holder = next((one for one in group if frames.nested(source, one)), None)
    if holder is not None and not _as_before(holder):
        seen, now = _places.get(holder.session_uid), np.array(holder.matrix_world)
        moved = seen is not None and _close(now, seen) and source.is_editable
        if moved:
            source.matrix_parent_inverse = Matrix(matrix.tolist()) @ source.matrix_parent_inverse
        elif seen is None or not _close(now @ matrix, seen):
            for one, values in zip(group, before, strict=True):
                one.gridmesh_live.space = values
            return
        elif frames.owned(holder) is not None and (known := frames.stored(holder)) is not None:
            # Applied under a parent that shears: Blender cannot leave the outline where it was.
            frames.nest(source, holder, known)
    written.sign(mesh)


def _absorb_by_hand(ob: bpy.types.Object) -> None:
    """Take over what was applied to a body whose mesh was changed by hand: it is rebuilt where it is."""
    live, uid = ob.gridmesh_live, ob.session_uid
    points = written.points_of(ob.data).reshape(-1, 3)
    space, world = frames.space(ob), np.array(ob.matrix_world)
    known = _hands.get(uid)
    _hands[uid] = points, space, world
    if known is None or len(known[0]) != len(points) or np.array_equal(known[0], points):
        return
    if not np.array_equal(known[1], space):
        return  # a step back or forth, of both
    matrix = written.affine(known[0].astype(float), points.astype(float))
    if matrix is None or not _close(world @ matrix, known[2]):
        return
    live.space = (matrix @ space).ravel().tolist()
    link = np.array(live.carried, float).reshape(4, 4)
    if link[3, 3]:
        live.carried = (link @ np.linalg.inv(matrix)).ravel().tolist()
    _hands[uid] = points, frames.space(ob), world


def reframe(ob: bpy.types.Object) -> None:
    """Leave a body where it is whose drawing, which carries it, had its transform applied.

    The drawing has gone the other way than its points: seen in the world just now, or from the body, which Blender has
    left where it was. After a step back or forth only that is known.
    """
    live = ob.gridmesh_live
    source = live.source
    if source is None or frames.nested(source, ob) or frames.carrier(source, live.layer)[0] != source:
        return
    ways = []
    seen, now = _places.get(source.session_uid), np.array(source.matrix_world)
    if seen is not None and not _close(now, seen):
        ways.append((seen, now))
    seen, now = np.array(live.carried, float).reshape(4, 4), _link(ob)
    if ob.parent == source and seen[3, 3] and not _close(now, seen):
        ways.append((np.linalg.inv(seen), np.linalg.inv(now)))
    known = _remembered(live)
    if known is None or not ob.is_editable or not ways:
        return
    try:
        found = samples(sketch_of(ob, bpy.context.evaluated_depsgraph_get()))
        if not alike(ob, known, found):
            before = frames.frame(ob)
            for seen, now in ways:
                frame = before @ np.linalg.inv(seen) @ now
                if alike(ob, known, frames.moved(found, frame @ np.linalg.inv(before))):
                    frames.remember(ob, frame)
                    break
    except (LostError, np.linalg.LinAlgError):
        return
    _remember_link(ob)


def _close(one: np.ndarray, two: np.ndarray) -> bool:
    return bool(np.abs(one - two).max() <= 4e-6 * max(np.abs(one).max(), np.abs(two).max()))
