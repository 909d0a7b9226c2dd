# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a cut runs: the stroke of another object, and the direction that it is swept along."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ..bodies import outlines, strokes
from .cutsweep import CutError, Sweep, normal_of

# Away from the viewer of the right, the front and the top view.
AXES = {"X": (-1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, -1.0)}

_DRAWINGS = strokes.SOURCE_TYPES - {"FONT"}


@dataclass(frozen=True, eq=False)
class View:
    """A view, as the redo panel remembers it."""

    eye: np.ndarray
    direction: np.ndarray
    perspective: bool

    @classmethod
    def of(cls, region_data: Any) -> View:
        """Read it from a 3D view."""
        away = np.array(region_data.view_matrix.inverted().to_3x3(), float) @ (0.0, 0.0, -1.0)
        eye = np.array(region_data.view_matrix.inverted().translation, float)
        return cls(eye, away / np.linalg.norm(away), bool(region_data.is_perspective))


def stroke_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Objects in the selection whose strokes can cut the active one."""
    active = context.view_layer.objects.active
    return [ob for ob in strokes.selected(context) if ob is not active and ob.type in _DRAWINGS]


def read(context: bpy.types.Context, number: int) -> tuple[outlines.Stroke, list[str]]:
    """Read the stroke to cut along, and what the user should know of the choice.

    number : counted from 1 over all strokes found; 0 for the selected one, or else the last.

    Raises
    ------
    CutError
        If there is none.
    """
    objects = stroke_objects(context)
    if not objects:
        raise CutError(
            "no stroke is selected; select a grease pencil or curve object, then the mesh, or draw the cut"
        )
    reading = strokes.read_objects(context, objects)
    found = [stroke for stroke in reading.strokes if len(stroke.points)]
    if not found:
        reasons = [*map(str, reading.failures), *reading.notes]
        raise CutError(reasons[0] if reasons else "the selected objects have no strokes; draw one")
    if number > len(found):
        raise CutError(f"there is no stroke {number}: the selected objects have {len(found)}; lower Stroke")
    if number:
        return found[number - 1], []
    chosen = [stroke for stroke in found if stroke.selected]
    if len(found) == 1 or len(chosen) == 1:
        return (chosen or found)[0], []
    last = found[-1]
    return last, [f"cut along {last.label}, the last one; set Stroke to use another"]


def sweep_of(direction: str, points: np.ndarray, view: View | None) -> tuple[Sweep, list[str]]:
    """Return how the stroke (n, 3) becomes a surface, and what the user should know of it.

    direction : "VIEW", "PLANE", "X", "Y" or "Z".

    Raises
    ------
    CutError
        If the direction cannot be told.
    """
    if direction in AXES:
        return Sweep.along(AXES[direction]), []
    if direction == "VIEW" and view is not None:
        return Sweep(view.direction, view.eye if view.perspective else None), []
    normal = outlines.facing(normal_of(points))
    notes = (
        ["there is no view here: cut along the normal of the stroke's plane"] if direction == "VIEW" else []
    )
    return Sweep.along(-normal), notes
