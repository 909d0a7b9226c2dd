# SPDX-License-Identifier: GPL-3.0-or-later
"""Fewer points for an outline, none of which moves.

numpy only, no bpy.
"""

from __future__ import annotations

import numpy as np

FEWEST = 4
"""Points that an outline keeps at least."""


def simplified(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Indices, ascending, of the points of a closed line (n, d) that stay.

    No point that goes is farther than `tolerance` from the line through those that stay (Douglas and Peucker). Of
    the points that are farthest apart two stay in any case. About n log n in time.
    """
    n = len(points)
    if n <= FEWEST:
        return np.arange(n)
    first = int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())
    line = np.roll(points, -first, axis=0)
    line = np.concatenate([line, line[:1]])
    middle = int(np.linalg.norm(line - line[0], axis=1).argmax())
    kept = {0, middle}
    waiting = [(0, middle), (middle, n)]
    while waiting:
        begin, end = waiting.pop()
        if end - begin < 2:
            continue
        off = _distances(line[begin + 1 : end], line[begin], line[end])
        farthest = int(off.argmax())
        if off[farthest] > tolerance:
            at = begin + 1 + farthest
            kept.add(at)
            waiting += [(begin, at), (at, end)]
    for part in (range(1, middle), range(middle + 1, n)):
        # A loop of two straight lines is none.
        if len(kept) < FEWEST and not kept.intersection(part) and len(part):
            kept.add(part[len(part) // 2])
    return np.sort((np.array(sorted(kept)) + first) % n)


def _distances(points: np.ndarray, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Distances (n,) of points from the straight line between two others."""
    along = end - begin
    squared = float(along @ along)
    if squared == 0.0:
        return np.linalg.norm(points - begin, axis=1)
    part = np.clip((points - begin) @ along / squared, 0.0, 1.0)
    return np.linalg.norm(points - begin - part[:, None] * along, axis=1)
