# SPDX-License-Identifier: GPL-3.0-or-later
"""From the pixels of a picture to outlines of what it shows: the call of `gridmesh.trace_image`. numpy only, no bpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..api import Progress
from ..bodies.outlines import area
from .level import LEVELS, level_of

PIXELS = 100_000_000
"""The most pixels of a picture, as the module has it; asked for before they are read."""

_PORE = 4.0
"""Holes in what is faint are filled below so many times the least area, times how faint it is: a mesh would be much finer to go around them."""


class PictureError(ValueError):
    """Nothing can be made of a picture. The message says why and what to do, without naming the picture."""


@dataclass(frozen=True)
class Options:
    """How a picture is read, and what is made of it."""

    paper: bool = False
    """What is not paper counts, instead of what is not transparent."""
    threshold: float | None = None
    """None: on paper the one that parts the pixels best, elsewhere one at which glows and shadows are inside."""
    smooth: float = 1.0
    min_area: float = 4.0
    margin: float = 0.0
    cover: bool = False
    """Without a margin the rim of the mesh lies across the outline, as much of it outside as inside; otherwise its vertices lie on it."""
    holes: bool = True
    triangles: int = 1000
    """Of one side, shared by the parts according to their area."""
    quads: int | None = None
    """The same of quads; None makes triangles."""
    body: dict[str, Any] | None = None
    """Keyword arguments of `gridmesh.inflate`; None for a flat sheet."""


def check_size(width: int, height: int) -> None:
    """Raise PictureError for a picture that has no pixels or too many."""
    if not 0 < width * height <= PIXELS:
        raise PictureError(
            f"it has {width} by {height} pixels; allowed: 1 to {PIXELS} pixels in all, scale it"
        )


@dataclass(frozen=True, eq=False)
class Outlines:
    """What a picture shows."""

    parts: list[Any]
    """An outline and its holes for each, in pixels from the lower left corner; the largest first."""
    dropped: int
    """Islands that were too small."""
    faint: float
    """How many times fainter than an edge the rim is: 1 where the outline follows half cover."""


def traced(
    gridmesh: Any, pixels: np.ndarray, options: Options, progress: Progress | None, wider: float = 0.0
) -> Outlines:
    """Trace what a picture shows, at the level of the margin asked for, with one wider by this many pixels."""
    threshold: float | str = "auto" if options.threshold is None else options.threshold
    faint = 1.0
    if options.threshold is None and not options.paper:
        threshold = level_of(pixels[..., 3], options.margin, options.body is not None)
        faint = LEVELS[0] / threshold
    found = gridmesh.trace_image(
        pixels,
        background="paper" if options.paper else "transparent",
        threshold=threshold,
        smooth=options.smooth,
        min_area=options.min_area,
        margin=options.margin + wider,
        progress=progress,
    )
    parts = list(found) if options.holes else _filled(found)
    if faint > 1:
        parts = _without_pores(parts, _PORE * faint * options.min_area)
    return Outlines(parts, found.dropped, faint)


def _without_pores(
    parts: list[tuple[np.ndarray, list[np.ndarray]]], least: float
) -> list[tuple[np.ndarray, list[np.ndarray]]]:
    """Outlines without holes of less than this area, and without what lies in these."""
    pores = [hole for _, holes in parts for hole in holes if area(hole) < least]
    return [
        (outline, [hole for hole in holes if area(hole) >= least])
        for outline, holes in parts
        if not any(_inside(outline[0], pore) for pore in pores)
    ]


def _filled(traced: list[tuple[np.ndarray, list[np.ndarray]]]) -> list[tuple[np.ndarray, list[np.ndarray]]]:
    """Outlines without their holes, and without what lies in the holes; the largest come first."""
    kept: list[np.ndarray] = []
    for outline, _ in traced:
        if not any(_inside(outline[0], other) for other in kept):
            kept.append(outline)
    return [(outline, []) for outline in kept]


def _inside(point: np.ndarray, polygon: np.ndarray) -> bool:
    """Whether a point lies inside a polygon (even-odd)."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    crossed = (a[:, 1] <= point[1]) != (b[:, 1] <= point[1])
    a, b = a[crossed], b[crossed]
    x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool((x > point[0]).sum() % 2)
