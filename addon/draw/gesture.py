# SPDX-License-Identifier: GPL-3.0-or-later
"""A stroke while it is being drawn, and the grid inside it.

numpy only, no bpy.
"""

from __future__ import annotations

import numpy as np

from ..api import FACE_AREA, faces_of
from ..bodies.density import automatic
from ..bodies.outlines import Plane, area
from ..native import native
from .regions import Part
from .steady import SPACING
from .trace import Trace, pack, unpack  # noqa: F401 (scripts take them from here)

FEWEST = 8
"""A stroke of fewer points is no outline."""

MOST = 4000
"""Triangles of a preview whose number is left to the stroke; of quads half as many."""


class Gesture:
    """Points with pressure, and a lattice that stays while the stroke grows.

    faces : number wanted in the end; None for what the stroke so far suggests, at most `MOST`. The preview has
    between two thirds and four thirds of it: its edges are lengthened in steps as the stroke grows, so that the grid
    stands still in between. cells : "triangles" or "quads".
    """

    def __init__(self, faces: int | None, edge_length: float | None = None, cells: str = "triangles") -> None:
        self.faces, self.given, self.cells = faces, edge_length, cells
        self._suggested: tuple[float, int] | None = None
        self.edge_length = edge_length
        self._pixels: list[tuple[float, float]] = []
        self._points: list[tuple[float, float]] = []
        self._rays: list[tuple[np.ndarray, np.ndarray]] = []
        self._pressures: list[float] = []
        self._left_out = 0
        self._after: list[tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]] = []

    def __len__(self) -> int:
        return len(self._points)

    @property
    def across(self) -> float:
        """Extent in pixels."""
        return float(np.ptp(self._pixels, axis=0).max()) if self._pixels else 0.0

    def add(
        self,
        pixel: tuple[float, float],
        point: np.ndarray,
        pressure: float,
        ray: tuple[np.ndarray, np.ndarray] | None = None,
    ) -> bool:
        """Append a point of the plane that was seen at a pixel; return whether it is a new one.

        ray : origin and direction of the sight line through the pixel.
        """
        if self._pixels:
            x, y = self._pixels[-1]
            if (pixel[0] - x) ** 2 + (pixel[1] - y) ** 2 < SPACING**2:
                return False
        self._pixels.append((float(pixel[0]), float(pixel[1])))
        self._points.append((float(point[0]), float(point[1])))
        self._pressures.append(pressure)
        if ray is not None:
            self._rays.append(ray)
        return True

    def close(self, left_out: int, after: list[tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]]) -> bool:
        """Leave the first points out of the stroke, and have others come after the last: points of the plane and their sight lines.

        They replace those of before; returns whether there are or were any.
        """
        changed = bool(left_out or self._left_out)
        self._left_out, self._after = left_out, after
        return changed

    @property
    def points(self) -> np.ndarray:
        """(n, 2) in the plane."""
        after = [point for point, _ in self._after]
        return np.array([*self._points[self._left_out :], *after], float).reshape(-1, 2)

    @property
    def pressures(self) -> np.ndarray:
        """(n,) from 0 to 1."""
        return np.array(self._pressures[self._left_out :] + self._pressures[-1:] * len(self._after), float)

    def trace(self, plane: Plane, *, free: bool, perspective: bool) -> Trace:
        """Return the stroke so far, as it was seen."""
        rays = [*self._rays[self._left_out :], *(ray for _, ray in self._after)]
        origins, directions = (np.array(side, float).reshape(-1, 3) for side in zip(*rays, strict=True))
        directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        return Trace(plane, origins, directions, self.pressures, True, free, perspective)

    def preview(self, part: Part | None = None) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertices (v, 2) and faces (f, 3) or (f, 4) of the grid inside the stroke closed by a line; None if there is none.

        part : what is filled instead, for instance the stroke and its image.
        """
        outline, holes = part if part is not None else (self.points, [])
        if len(outline) < FEWEST:
            return None
        gridmesh = native("mesh_sketch")
        if self.given is None:
            extent = max(_extent(outline), 1e-30)
            ideal = np.sqrt(extent / (self.faces or self._automatic(outline, holes)) / FACE_AREA[self.cells])
            if self.edge_length is None or not 0.75 < ideal / self.edge_length < 1.35:
                self.edge_length = float(ideal)
        try:
            patch = gridmesh.mesh_sketch(
                outline,
                holes,
                cells=self.cells,
                edge_length=self.edge_length,
                angle=0.0,
                origin=outline[0],
                self_crossing="union",
                open_corners=False,
                least=False,
            )
        except gridmesh.GridMeshError:
            return None  # too narrow for the grid, or it encloses nothing yet: the line alone is shown
        return patch.vertices, faces_of(patch)

    def _automatic(self, outline: np.ndarray, holes: list[np.ndarray]) -> int:
        """Number of faces for the stroke so far, measured anew when it has grown by a twelfth."""
        length = float(np.linalg.norm(np.diff(outline, axis=0), axis=1).sum())
        if self._suggested is None or not 0.92 < length / self._suggested[0] < 1.08:
            self._suggested = length, automatic(outline, holes, MOST)
        return self._suggested[1] // (2 if self.cells == "quads" else 1)


def _extent(points: np.ndarray) -> float:
    """Area that the stroke encloses, and at least a part of its box while it is a hook."""
    box = np.ptp(points, axis=0)
    return max(area(points), 0.2 * float(box[0] * box[1]))
