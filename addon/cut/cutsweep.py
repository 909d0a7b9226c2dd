# SPDX-License-Identifier: GPL-3.0-or-later
"""A stroke, and the surface that it sweeps.

numpy only, no bpy. Points are float64 in the directions and lengths of the world.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..bodies import outlines


class CutError(ValueError):
    """A cut that cannot be made. The message says why and what to do."""

    def __init__(self, message: str, kind: str = "") -> None:
        """`kind` is the library's word for it, if it comes from there."""
        super().__init__(message)
        self.kind = kind


@dataclass(frozen=True, eq=False)
class Sweep:
    """How the stroke becomes a surface: along a direction, or through the eye of a perspective view."""

    direction: np.ndarray
    """(3,) unit vector away from the viewer; with an eye the middle of what it sees."""
    eye: np.ndarray | None = None

    @classmethod
    def along(cls, direction: Any) -> Sweep:
        """Sweep along a direction of any length but zero."""
        direction = np.asarray(direction, float)
        return cls(direction / np.linalg.norm(direction))

    def frame(self) -> np.ndarray:
        """Unit vectors (3, 3) in rows: right and up as the viewer sees them, and away from the viewer."""
        away = self.direction
        least = np.eye(3)[int(np.abs(away).argmin())]
        right = np.cross(least, away)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(right, away), away])

    def seen(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the viewer sees points (n, 3): (n, 2), and how far away (n,).

        Raises
        ------
        CutError
            If a point is behind the eye.
        """
        local = (points if self.eye is None else points - self.eye) @ self.frame().T
        if self.eye is None:
            return local[:, :2], local[:, 2]
        if (local[:, 2] <= 0).any():
            raise CutError(
                "the stroke reaches behind the view; move the view back, or set Direction to an axis"
            )
        return local[:, :2] / local[:, 2:], local[:, 2]

    def placed(self, flat: np.ndarray, depth: float) -> np.ndarray:
        """Points (n, 3) in space that are seen at (n, 2), all at one depth."""
        away = np.full((len(flat), 1), depth)
        if self.eye is None:
            return np.hstack([flat, away]) @ self.frame()
        return np.hstack([flat * depth, away]) @ self.frame() + self.eye


def normal_of(points: np.ndarray) -> np.ndarray:
    """Normal of the plane that a stroke (n, 3) was drawn in.

    Raises
    ------
    CutError
        If it is a straight line.
    """
    centred = points - points.mean(axis=0)
    _, widths, axes = np.linalg.svd(centred, full_matrices=False)
    if len(widths) < 2 or widths[1] <= 1e-4 * widths[0]:
        raise CutError(
            "a straight stroke lies in no plane of its own; set Direction to View or to the axis to cut along"
        )
    return axes[2]


def require_finite(points: np.ndarray) -> None:
    """Refuse a stroke (n, 3) with coordinates that are no numbers, or too large to work with."""
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise CutError(f"point {bad[0] + 1} of the stroke is not a finite number; delete it")
    if np.abs(points).max(initial=0.0) > outlines.LARGEST:
        raise CutError(f"the stroke reaches farther than {outlines.LARGEST:g}; scale it down")


def checked(points: np.ndarray, *, cyclic: bool, sweep: Sweep, close_gaps: float) -> np.ndarray:
    """Stroke (s, 3) for `gridmesh.cut`, closed by a repeated first point where it is meant to be.

    close_gaps : an open stroke whose ends are nearer than this part of its size is closed.

    Raises
    ------
    CutError
        If the stroke is no line.
    """
    flat, depth = sweep.seen(points)
    apart = np.linalg.norm(np.diff(flat, axis=0), axis=1)
    size = float(np.linalg.norm(np.ptp(flat, axis=0))) if len(flat) else 0.0
    if len(flat) < 2 or size <= 1e-9 * max(1.0, float(np.abs(flat).max())):
        raise CutError(
            "seen along the direction of the cut the stroke is a point; set Direction to another axis, "
            "or draw a longer stroke"
        )
    keep = np.concatenate([[True], apart > 1e-9 * size])
    flat, points = flat[keep], points[keep]
    if cyclic:
        return np.vstack([points, points[:1]])
    if close_gaps <= 0 or len(flat) < 4:
        return points
    try:
        closed, _ = outlines.close(flat, close_gaps)
    except outlines.OpenError:
        return points
    if len(closed) != len(flat):
        points = sweep.placed(closed, float(depth.mean()))
    return np.vstack([points, points[:1]])


def unrolled(points: np.ndarray, stroke: np.ndarray, sweep: Sweep) -> np.ndarray:
    """Points (n, 3) near the swept surface, laid out with it in the plane: along the stroke, and away: (n, 2)."""
    flat, depth = sweep.seen(points)
    line, _ = sweep.seen(stroke)
    middle = flat.mean(axis=0)
    flat, line = flat - middle, line - middle
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    begin, step = line[:-1], np.diff(line, axis=0)
    # The ends go straight on.
    low, high = np.zeros(len(step)), np.ones(len(step))
    if not np.array_equal(stroke[0], stroke[-1]):
        low[0], high[-1] = -np.inf, np.inf
    squares = np.maximum((step**2).sum(axis=1), 1e-300)
    along = np.empty(len(flat))
    block = max(1, 500_000 // len(step))
    for at in range(0, len(flat), block):
        points_here = flat[at : at + block]
        ahead = points_here @ step.T - (begin * step).sum(axis=1)
        share = np.clip(ahead / squares, low, high)
        # Squared distances, less that of each point to the origin.
        away = (begin**2).sum(axis=1) - 2 * points_here @ begin.T - share * (2 * ahead - share * squares)
        nearest = away.argmin(axis=1)
        rows = np.arange(len(nearest))
        along[at : at + block] = way[nearest] + share[rows, nearest] * np.sqrt(squares[nearest])
    scale = 1.0 if sweep.eye is None else float(np.median(depth))
    return np.column_stack([along * scale, depth])
