# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines with holes: united, compared, and which points are inside.

numpy only, no bpy.
"""

from __future__ import annotations

import numpy as np

from ..bodies.outlines import area
from ..native import native

Part = tuple[np.ndarray, list[np.ndarray]]
"""An outline and its holes, (n, 2) each."""


def relation(outline: np.ndarray, holes: list[np.ndarray], stroke: np.ndarray) -> str:
    """How a stroke (n, 2) lies to a drawing: "apart", "inside", "around" or "across".

    Holes count as outside. Raises what `gridmesh.combine` raises for strokes that enclose nothing.
    """
    gridmesh = native("combine")
    own = area(outline) - sum(area(hole) for hole in holes)
    rest = sum(_area(part) for part in gridmesh.combine(outline, stroke, holes, how="difference"))
    both = sum(_area(part) for part in gridmesh.combine(outline, stroke, holes, how="union"))
    drawn, taken = both - rest, own - rest
    least = 1e-6 * max(own, drawn)
    if taken <= least:
        return "apart"
    if rest <= least:
        return "around"
    return "inside" if drawn - taken <= least else "across"


def _area(part: Part) -> float:
    outline, holes = part
    return area(outline) - sum(area(hole) for hole in holes)


def united(one: Part, other: Part) -> list[Part]:
    """What is in either of two parts, the largest first."""
    gridmesh = native("combine")
    parts = gridmesh.combine(one[0], other[0], one[1], how="union")
    for hole in other[1]:
        # What of the other's hole is not covered stays open.
        for open_part, _ in gridmesh.combine(hole, one[0], [], how="difference"):
            outline, holes = parts[0]
            parts = gridmesh.combine(outline, open_part, holes, how="difference") + parts[1:]
    return parts


def covered(strokes: list[np.ndarray]) -> list[Part]:
    """What strokes (n, 2) cover: their outer outlines, united where they meet."""
    gridmesh = native("combine")
    parts = gridmesh.combine(strokes[0], strokes[0], [], how="union")[:1]
    for stroke in strokes[1:]:
        parts = united(parts[0], (stroke, []))
    return parts


def inside(part: Part, points: np.ndarray) -> np.ndarray:
    """Whether points (n, 2) lie inside an outline with holes, by the parity of crossings."""
    odd = np.zeros(len(points), bool)
    for ring in (part[0], *part[1]):
        a, b = ring, np.roll(ring, -1, axis=0)
        spans = (a[None, :, 1] > points[:, 1, None]) != (b[None, :, 1] > points[:, 1, None])
        rise = np.where(spans, b[None, :, 1] - a[None, :, 1], 1.0)
        x = a[None, :, 0] + (points[:, 1, None] - a[None, :, 1]) * (b - a)[None, :, 0] / rise
        odd ^= (np.count_nonzero(spans & (x > points[:, 0, None]), axis=1) % 2).astype(bool)
    return odd
