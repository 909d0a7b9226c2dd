# SPDX-License-Identifier: GPL-3.0-or-later
"""How many triangles go across the thinnest limb of a body, and how many would do. numpy only, no bpy."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from ..native import native
from .outlines import Sketch, area, project

ENOUGH = 3.0
"""With fewer triangles across a limb looks angular."""

WANTED = 5.0

_MANY = 20_000
"""More than this are not recommended for a hair-thin part."""

_ROW = sqrt(3) / 2
"""Height of a row of triangles, in edge lengths."""


_FEWEST = 1000
"""So many are chosen where nothing is thin."""


@dataclass(frozen=True)
class Density:
    """Of a body with a limb."""

    across: float
    """Triangles across the thinnest limb."""
    wanted: int
    """About how many triangles of each side put five across."""

    @property
    def is_low(self) -> bool:
        """Whether it is worth telling."""
        return self.across < ENOUGH

    @property
    def text(self) -> str:
        """What to tell the user."""
        return "; ".join(
            [f"thinnest part: {self.across:.1f} across", f"{self.wanted} triangles of each side for 5"]
        )


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
    edge = float(limbs[0, 2]) / (_ROW * WANTED)
    inside = area(outline) - sum(area(hole) for hole in holes)
    return int(np.clip(inside / (_ROW / 2 * edge**2), _FEWEST, most))


def measure(sketch: Sketch, triangles: int) -> Density | None:
    """Measure a sketch that was meshed with so many triangles of one side; None if nothing of it is a limb.

    In O(n log n). Raises GridMeshError for drawings that have no mesh, and NativeError without the module.
    """
    holes = [project(hole, sketch.plane)[:, :2] for hole in sketch.holes]
    limbs = native("thickness").thickness(sketch.outline, holes)
    if not len(limbs) or triangles <= 0:
        return None
    width = float(limbs[0, 2])
    inside = area(sketch.outline) - sum(area(hole) for hole in holes)
    edge = sqrt(max(inside, 0.0) / (triangles * _ROW / 2))
    if edge <= 0:
        return None
    across = width / (_ROW * edge)
    wanted = triangles * (WANTED / across) ** 2
    return Density(across, int(min(np.ceil(wanted / 100) * 100, _MANY)))
