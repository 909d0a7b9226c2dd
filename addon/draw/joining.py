# SPDX-License-Identifier: GPL-3.0-or-later
"""An extended outline and what it meets of its own drawing.

Strokes inside others are holes: an outline that grew over another of the same drawing would make a hole of it, and
a body would be lost. Both become one.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from .. import frames
from ..live import engine
from ..live.reading import LostError, sketch_of
from ..outlines import Plane, Sketch, StrokeError, project, transformed
from .gesture import relation

Part = tuple[np.ndarray, list[np.ndarray]]
"""An outline and its holes, (n, 2) each."""

FLAT = 0.02
"""Outlines that stay within this part of their size of a plane lie in it."""


def join(
    gridmesh: Any, part: Part, ob: bpy.types.Object, plane: Plane, others: list[bpy.types.Object]
) -> tuple[list[Part], list[tuple[bpy.types.Object, Sketch]]]:
    """Unite a part of a body with the outlines of other bodies that it meets, if they lie in its plane.

    part : in `plane`, which is in the space of the body `ob`. Returns what it has become, the largest first, and the
    bodies that it took in with their sketches, in that space.
    """
    depsgraph = bpy.context.evaluated_depsgraph_get()
    waiting = []
    for other in others:
        try:
            sketch = sketch_into(ob, other, depsgraph)
        except (LostError, StrokeError, np.linalg.LinAlgError):
            continue  # without an outline there is nothing to meet
        if np.abs(project(sketch, plane)[:, 2]).max() <= FLAT * sketch.size:
            waiting.append((other, sketch))
    parts, taken = [part], []
    # Grown by one, it may meet another.
    while met := next((one for one in waiting if _meets(parts[0], _flat(one[1], plane))), None):
        waiting.remove(met)
        taken.append(met)
        parts = _united(gridmesh, parts[0], _flat(met[1], plane))
    return parts, taken


def sketch_into(ob: bpy.types.Object, other: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Sketch:
    """Return the sketch of another body in the space of `ob`."""
    matrix = np.linalg.inv(frames.place(ob)) @ frames.place(other)
    return transformed(sketch_of(other, depsgraph), matrix, other.gridmesh_live.close_gaps)


def absorb(others: list[bpy.types.Object]) -> list[tuple[bpy.types.Object, Matrix]]:
    """Take bodies away that are now a part of another; return their children and where these are."""
    children = [
        (child, child.matrix_world.copy())
        for other in others
        for child in other.children
        if child != frames.owned(other)
    ]
    for other in others:
        mesh = other.data
        engine.freeze(other)
        bpy.data.objects.remove(other)
        if not mesh.users:
            bpy.data.meshes.remove(mesh)
    return children


def adopt(ob: bpy.types.Object, children: list[tuple[bpy.types.Object, Matrix]]) -> None:
    """Make objects children of a body; they stay where they are."""
    for child, place in children:
        child.parent = ob
        child.matrix_world = place


def _flat(sketch: Sketch, plane: Plane) -> Part:
    return project(sketch, plane)[:, :2], [project(hole, plane)[:, :2] for hole in sketch.holes]


def _meets(one: Part, other: Part) -> bool:
    # Each outline filled against the other with its holes: one may lie in a hole of the other.
    return relation(*one, other[0]) != "apart" and relation(*other, one[0]) != "apart"


def _united(gridmesh: Any, one: Part, other: Part) -> list[Part]:
    parts = gridmesh.combine(one[0], other[0], one[1], how="union")
    for hole in other[1]:
        # What of the other's hole is not covered stays open.
        for open_part, _ in gridmesh.combine(hole, one[0], [], how="difference"):
            outline, holes = parts[0]
            parts = gridmesh.combine(outline, open_part, holes, how="difference") + parts[1:]
    return parts
