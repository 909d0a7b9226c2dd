# SPDX-License-Identifier: GPL-3.0-or-later
"""The stroke of a body, read without making or changing anything: this runs while Blender is in the middle of edits."""

from __future__ import annotations

import bpy
import numpy as np

from .. import api
from ..bodies import curves, strokes
from ..bodies.outlines import Sketch
from ..data import frames


class LostError(Exception):
    """A body has no stroke to follow. The message says why."""


def sketch_of(ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Sketch:
    """Return the sketch that a linked body is made of, holes included, in the body's own space.

    Raises
    ------
    LostError
        If there is none.
    """
    live = ob.gridmesh_live
    source = live.source
    if source is None or not source.users_scene:
        raise LostError("its drawing is gone")
    read = read_source(source, depsgraph, frames.frame(ob))
    same = [stroke for stroke in read.strokes if stroke.layer == live.layer]
    if not same:
        reasons = [*map(str, read.failures), *read.notes]
        raise LostError(
            reasons[0] if reasons else f"'{source.name}' has no layer '{live.layer}' with strokes"
        )
    sketches, failures, _ = api.sketches_of(same, close_gaps=live.close_gaps, holes=live.use_holes)
    if same[0].count == live.count:
        found = next((sketch for sketch in sketches if sketch.stroke.index == live.stroke), None)
        if found is None:
            label = next((s.label for s in same if s.index == live.stroke), None)
            reason = next((failure.reason for failure in failures if failure.label == label), None)
            raise LostError(reason or "its stroke is hidden, or lies inside another and is a hole there")
        return found
    # Strokes came or went: the numbers are others. It is the one that lies where the body was drawn.
    before = np.array(live.plane[:3], float)
    near = [(float(np.linalg.norm(sketch.plane.origin - before)), sketch) for sketch in sketches]
    near = [(apart, sketch) for apart, sketch in near if apart < 0.25 * sketch.size]
    if not near:
        raise LostError("its stroke is gone")
    return min(near, key=lambda pair: pair[0])[1]


def read_source(
    source: bpy.types.Object, depsgraph: bpy.types.Depsgraph, frame: np.ndarray | None = None
) -> strokes.Reading:
    """Read the strokes of an object as it is seen. frame : (4, 4) to where they are wanted; None: the world."""
    if source.type == "GREASEPENCIL":
        return strokes.read_grease_pencil(source, depsgraph, frame)
    if source.type == "CURVES":
        return strokes.read_hair(source, depsgraph, frame)
    if source.type not in strokes.SOURCE_TYPES:
        raise LostError(f"'{source.name}' is no drawing")
    reason = thick(source)
    if reason:
        raise LostError(reason)
    seen = source.evaluated_get(depsgraph)
    mesh = seen.to_mesh()
    try:
        if mesh is None:
            raise LostError(f"'{source.name}' is empty")
        found, failures, notes = curves.strokes_of(source, mesh, frame)
    finally:
        seen.to_mesh_clear()
    return strokes.Reading(found, failures, notes)


def thick(source: bpy.types.Object) -> str:
    """Why a curve cannot be followed; empty if it can."""
    if source.type not in {"CURVE", "FONT"}:
        return ""
    data = source.data
    if data.bevel_depth or data.extrude or data.offset or data.bevel_mode == "OBJECT":
        return (
            f"'{source.name}' has a bevel, an extrusion or an offset; set them to 0 to let bodies follow it"
        )
    return ""
