# SPDX-License-Identifier: GPL-3.0-or-later
"""How fine the parts of a picture are meshed: what a mesh may lack, and edges of about one length over all. numpy only, no bpy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..api import faces_of

FINER = (1.0, 0.7, 0.5, 0.35, 0.25)
"""Edge lengths tried for parts that are too thin, relative to that of the others."""

FINEST = (0.18, 0.125, 0.09, 0.063)
"""And for lines as thin as a pixel or two, as long as no more cells than `MOST_CELLS` would fill the picture."""

MOST_CELLS = 100_000

CUT_OFF = 0.58
"""Parts of whose outlines this many pixels stay outside, beyond the slack, are meshed finer: middles of pixels lie deeper inside.

Outlines pass the middles by a sixth of a pixel at most, and the slack is a quarter at a margin of one.
"""

CUT_OFF_ACROSS = (0.5, 0.14)
"""The same for rims across the outline, and in edge lengths, if that is more: they are to follow large pictures no closer than small ones."""

EMPTY = 0.03
"""This share of a mesh may be empty, what lies in the margin included; where it would be more, pictures are meshed finer."""

EMPTY_AT_LEAST = 0.007
"""So much larger than their outlines meshes may be whatever lies in the margin."""

SOFT = 0.5
"""Width, in pixels, of the part of a margin in which soft rims of pictures are seen."""

EMPTY_OF_BODY = 0.01
"""The same for bodies, whose rims are opaque: seen from the front they overlap their pictures by 99 % where that can be held."""

BETWEEN = (0.004, 0.006)
"""Likewise bodies without a margin, if so much of their area lies between mesh and outline: the least and the most that is allowed."""

PIXELS = 0.03
"""Width, in pixels, of the seam along an outline in which pixels lie on the other side as it is: small pictures are allowed less."""

SHORT = 1 / 3
"""Edges shorter than this, in mean lengths of the edges of a picture, show in a texture."""

_ROUNDS = 8
"""Times that parts are made finer because others are."""

_STEP = 0.7
"""The least edge length in one of these rounds, relative to what it was."""


@dataclass(frozen=True)
class Lacks:
    """What the mesh of a part may lack."""

    drawn: float
    """The area of the part."""
    much: float
    """The area between mesh and outline that is allowed; of the mesh beyond it, if it is to cover."""
    cut_off: float
    across: bool
    tries: int

    def of(self, patch: Any) -> tuple[int, float]:
        """What is cut off, in powers of two of what is allowed, then the area; each only from where it shows.

        Across an outline a tip that is cut off counts as a square.
        """
        outside = patch.report["outside"]
        more = sum(area(patch.vertices[loop]) for loop in patch.loops) - self.drawn
        if self.across:
            # What lies between within an inlet that is filled is told by the area alone.
            lost = max(patch.report["between"] * self.drawn, abs(more))
            return 0, max(lost + max(0.0, outside - self.cut_off) ** 2, self.much)
        return max(0, int(np.ceil(np.log2(max(outside / self.cut_off, 1.0))))), max(more, self.much)

    def are_enough(self, found: list[Any]) -> bool:
        """Whether no finer mesh need be tried after these."""
        whole = [patch for patch in found if patch.report["outside"] <= self.cut_off]
        return bool(whole) and (self.of(min(whole, key=self.of))[1] <= self.much or len(whole) >= self.tries)


def lacks_of(
    parts: list[Any], edge_length: float, is_body: bool, margin: float, faint: float = 1.0
) -> list[Lacks]:
    """What each part may lack: the share of the picture that may be lost, parted along the outlines.

    So the sizes of the parts differ little: edges of one length lose about as much anywhere along outlines. Of rims that are fainter than
    edges more may be cut off.
    """
    drawn = [area(outline) + sum(map(area, holes)) for outline, holes in parts]
    rims = [sum(_length(contour) for contour in [outline, *holes]) for outline, holes in parts]
    across = margin <= 0
    if not is_body:
        in_margin = max(0.0, margin - SOFT) * sum(rims) / sum(drawn)
        share, tries = max(EMPTY - in_margin, EMPTY_AT_LEAST), 2
    elif across:
        least, most = BETWEEN
        share, tries = max(least, most - PIXELS * sum(rims) / sum(drawn)), 3
    else:
        share, tries = EMPTY_OF_BODY, 3
    pixels, edges = CUT_OFF_ACROSS
    cut_off = faint * (max(pixels, edges * edge_length) if across else CUT_OFF)
    return [
        Lacks(own, share * sum(drawn) * rim / sum(rims), cut_off, across, tries)
        for own, rim in zip(drawn, rims, strict=True)
    ]


def finest(number: int) -> tuple[float, ...]:
    """Edge lengths to try for a picture of this many cells, each only where the one before is too coarse."""
    return FINER + tuple(finer for finer in FINEST if number <= MOST_CELLS * finer**2)


def even(results: list[Any], mesh: Callable[[list[int], float], dict[int, Any]]) -> None:
    """Make parts finer, in place, as long as edges of others are short for the picture and that helps.

    `mesh` makes parts with edges of this length, relative to that wanted; what is no surface, or has an edge that is short for itself, is left.
    """
    sizes = dict.fromkeys(range(len(results)), 1.0)
    for _ in range(_ROUNDS):
        edges = {
            k: edge_lengths(surface) for k, surface in enumerate(results) if hasattr(surface, "vertices")
        }
        if not edges:
            return
        mean = float(np.concatenate(list(edges.values())).mean())
        ratio = min(float(own.min()) for own in edges.values()) / (SHORT * mean)
        coarse = [k for k, own in edges.items() if own.mean() > mean and own.min() > 1.1 * SHORT * mean]
        if ratio >= 1 or not coarse:
            return
        for k in coarse:
            sizes[k] *= max(_STEP, 0.95 * ratio)
        for size in sorted({sizes[k] for k in coarse}):
            for k, surface in mesh([k for k in coarse if sizes[k] == size], size).items():
                if not hasattr(surface, "vertices") or shortest(surface) < SHORT:
                    continue
                if edge_lengths(surface).mean() < edges[k].mean():
                    results[k] = surface


def shortest(surface: Any) -> float:
    """The shortest edge of a surface, in mean lengths of its edges."""
    lengths = edge_lengths(surface)
    return float(lengths.min() / lengths.mean())


def edge_lengths(surface: Any) -> np.ndarray:
    """The length of each edge of a surface."""
    faces, count = faces_of(surface).astype(np.int64), len(surface.vertices)
    others = np.roll(faces, 1, axis=1)
    # One number for each pair: rows are sorted ten times slower.
    low, high = np.divmod(np.unique(np.minimum(faces, others) * count + np.maximum(faces, others)), count)
    return np.linalg.norm(surface.vertices[low] - surface.vertices[high], axis=1)


def area(contour: np.ndarray) -> float:
    """Signed area; holes run clockwise."""
    following = np.roll(contour, -1, axis=0)
    return float((contour[:, 0] * following[:, 1] - contour[:, 1] * following[:, 0]).sum() / 2)


def _length(contour: np.ndarray) -> float:
    return float(np.linalg.norm(contour - np.roll(contour, 1, axis=0), axis=1).sum())
