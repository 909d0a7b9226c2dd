# SPDX-License-Identifier: GPL-3.0-or-later
"""How many faces go across the thinnest limb of a body, and how many would do. numpy only, no bpy."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from ..native import native
from .outlines import Sketch, area, project

ENOUGH = 3.0
"""With fewer faces across a limb looks angular."""

WANTED = 5.0

_MANY = 20_000
"""More than this are not recommended for a hair-thin part."""

_ROW = {"triangle": sqrt(3) / 2, "quad": 1.0}
"""Height of a row of faces, in edge lengths."""

_AREA = {"triangle": sqrt(3) / 4, "quad": 1.0}
"""Area of a face, in squared edge lengths."""


_FEWEST = 1000
"""So many are chosen where nothing is thin."""


@dataclass(frozen=True)
class Density:
    """Of a body with a limb."""

    across: float
    """Faces across the thinnest limb."""
    wanted: int
    """About how many faces of each side put five across."""
    kind: str = "triangle"
    """Or "quad"."""

    @property
    def is_low(self) -> bool:
        """Whether it is worth telling."""
        return self.across < ENOUGH

    @property
    def text(self) -> str:
        """What to tell the user."""
        if self.kind == "quad":
            enough = f"{self.wanted} quads of each side for 5"
        else:
            enough = f"{self.wanted} triangles of each side for 5"
        return "; ".join([f"thinnest part: {self.across:.1f} across", enough])


def automatic(outline: np.ndarray, holes: list[np.ndarray], most: int = _MANY) -> int:
    """Return about how many triangles of one side `triangles="auto"` chooses for a drawing in its plane.

    The fewest for what is no drawing yet. Raises NativeError without the module.
    """
    gridmesh = native("thickness")
    try:
        limbs = gridmesh.thickness(outline, holes)
    except gridmesh.GridMeshError:
        return _FEWEST
    if not len(limbs):
        return _FEWEST
    edge = float(limbs[0, 2]) / (_ROW["triangle"] * WANTED)
    inside = area(outline) - sum(area(hole) for hole in holes)
    return int(np.clip(inside / (_AREA["triangle"] * edge**2), _FEWEST, most))


def measure(sketch: Sketch, faces: int, kind: str = "triangle") -> Density | None:
    """Measure a sketch that was meshed with so many faces of one side; None if nothing of it is a limb, or it crosses itself.

    kind : "triangle" or "quad". In O(n log n). Raises NativeError without the module.
    """
    gridmesh = native("thickness")
    holes = [project(hole, sketch.plane)[:, :2] for hole in sketch.holes]
    try:
        limbs = gridmesh.thickness(sketch.outline, holes)
    except gridmesh.GridMeshError:
        # It was meshed with its crossings resolved; where limbs run into each other none is thinnest.
        return None
    if not len(limbs) or faces <= 0:
        return None
    width = float(limbs[0, 2])
    inside = area(sketch.outline) - sum(area(hole) for hole in holes)
    edge = sqrt(max(inside, 0.0) / (faces * _AREA[kind]))
    if edge <= 0:
        return None
    across = width / (_ROW[kind] * edge)
    wanted = faces * (WANTED / across) ** 2
    return Density(across, int(min(np.ceil(wanted / 100) * 100, _MANY)), kind)
