# SPDX-License-Identifier: GPL-3.0-or-later
"""A stroke while it is being drawn, in its plane, and the grid inside it.

numpy only, no bpy.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from ..native import native
from ..outlines import area

FEWEST = 8
"""A stroke of fewer points is a click."""

SPACING = 2.0
"""Points nearer than this, in pixels, are one."""


class Gesture:
    """Points with pressure, and a lattice that stays while the stroke grows.

    triangles : number wanted in the end. The preview has between one and two thirds and four thirds of it: its
    edges are lengthened in steps as the stroke grows, so that the grid stands still in between.
    """

    def __init__(self, triangles: int, edge_length: float | None = None) -> None:
        self.triangles, self.given = triangles, edge_length
        self.edge_length = edge_length
        self._pixels: list[tuple[float, float]] = []
        self._points: list[tuple[float, float]] = []
        self._pressures: list[float] = []

    def __len__(self) -> int:
        return len(self._points)

    def add(self, pixel: tuple[float, float], point: np.ndarray, pressure: float) -> bool:
        """Append a point of the plane that was seen at a pixel; return whether it is a new one."""
        if self._pixels:
            x, y = self._pixels[-1]
            if (pixel[0] - x) ** 2 + (pixel[1] - y) ** 2 < SPACING**2:
                return False
        self._pixels.append((float(pixel[0]), float(pixel[1])))
        self._points.append((float(point[0]), float(point[1])))
        self._pressures.append(pressure)
        return True

    @property
    def points(self) -> np.ndarray:
        """(n, 2) in the plane."""
        return np.array(self._points, float).reshape(-1, 2)

    @property
    def pressures(self) -> np.ndarray:
        """(n,) from 0 to 1."""
        return np.array(self._pressures, float)

    def preview(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertices (v, 2) and triangles (t, 3) of the grid inside the stroke closed by a line; None if there is none."""
        points = self.points
        if len(points) < FEWEST:
            return None
        gridmesh = native("mesh_sketch")
        if self.given is None:
            ideal = np.sqrt(max(_extent(points), 1e-30) / self.triangles * 4 / np.sqrt(3))
            if self.edge_length is None or not 0.75 < ideal / self.edge_length < 1.35:
                self.edge_length = float(ideal)
        try:
            patch = gridmesh.mesh_sketch(
                points,
                edge_length=self.edge_length,
                angle=0.0,
                origin=points[0],
                self_crossing="union",
                least=False,
            )
        except gridmesh.GridMeshError:
            return None  # too narrow for the grid, or it encloses nothing yet: the line alone is shown
        return patch.vertices, patch.triangles


def _extent(points: np.ndarray) -> float:
    """Area that the stroke encloses, and at least a part of its box while it is a hook."""
    box = np.ptp(points, axis=0)
    return max(area(points), 0.2 * float(box[0] * box[1]))


def pack(points: np.ndarray, pressures: np.ndarray) -> str:
    """Stroke as text, for the operator's memory."""
    table = np.column_stack([points, pressures]).astype("<f8")
    return base64.b64encode(table.tobytes()).decode()


def unpack(text: str) -> tuple[np.ndarray, np.ndarray]:
    """Inverse of `pack`: points (n, 2) and pressures (n,).

    Raises
    ------
    ValueError
        If the text is no stroke.
    """
    table = np.frombuffer(base64.b64decode(text, validate=True), "<f8")
    if len(table) % 3:
        raise ValueError(f"{len(table)} numbers are no table of three columns")
    table = table.reshape(-1, 3)
    return table[:, :2].copy(), table[:, 2].copy()


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


def _area(part: Any) -> float:
    outline, holes = part
    return area(outline) - sum(area(hole) for hole in holes)
