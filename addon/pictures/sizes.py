# SPDX-License-Identifier: GPL-3.0-or-later
"""How fine the parts of a picture are meshed: what a mesh may lack, and edges of about one length over all. numpy only, no bpy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..api import faces_of

STEPS = (1.0, 1.1, 1.2, 1.35, 1.5, 1.65, 1.8, 2.0, 2.25, 2.5, 2.75, 3.0) + (
    *(3.3, 3.6, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0, 9.0),
)
"""The numbers of cells that pictures are meshed with, but for powers of ten: the same whatever is asked for, so that fewer asked never give more."""

FARTHEST = 16.0
"""Times the number asked for up to which every step is tried for what is too thin; beyond it every fourth."""

MOST_TIMES = 250.0
"""And lines as thin as a pixel or two are tried up to so many times, as long as no more cells than `MOST_CELLS` would fill the picture."""

MOST_CELLS = 100_000

THIN = 4.0
"""What no size below so many times the number asked for could follow is thin all over, and meshed with the first that can."""

FEW = 500
"""Meshes of fewer cells may lack more, in proportion: edges leave an area out that grows as the square of their length."""

WORTH_CUT_OFF = 1.0
"""Binary logarithm of the times as many cells that a mesh may have to cut off no more than it may; the more it cuts off the more may be spent."""

WORTH_AREA = 2.0
"""The same for a mesh whose area is as much again as it may be."""

WORTH_MOST = (5.0, 3.0)
"""The most that is spent for what is cut off: by meshes that are to cover, and by those across outlines. With less, gross cuts are left."""

WORTH_MOST_AREA = 1.6
"""The same for the area. With half of it bodies have a tenth fewer faces, and seven of fifty overlap their pictures by less than 99 %, not one."""

WORTH_SHORT = 1.5
"""And for one with an edge that is short in a texture."""

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


def step_of(number: float) -> int:
    """The step nearest to a number of cells."""
    decade = int(np.floor(np.log10(number)))
    near = [len(STEPS) * decade + k for k in range(len(STEPS) + 1)]
    return min(near, key=lambda step: abs(np.log(number_of(step) / number)))


def number_of(step: int) -> float:
    """The number of cells of a step."""
    decade, k = divmod(step, len(STEPS))
    return STEPS[k] * 10.0**decade


def last_step(number: int) -> int:
    """The last step tried where that many cells are asked for."""
    return step_of(max(FARTHEST * number, min(MOST_TIMES * number, MOST_CELLS)))


def steps(first: int, number: int) -> Iterator[int]:
    """Steps from one on, as they are tried where that many cells are asked for."""
    last, all_up_to = last_step(number), number * FARTHEST
    return (
        step
        for step in range(first, last + 1)
        if step % 4 == 0 or number_of(step) <= all_up_to or step == last
    )


@dataclass(frozen=True)
class Lacks:
    """What the mesh of a part may lack."""

    drawn: float
    """The area of the part."""
    much: float
    """The area between mesh and outline that is allowed; of the mesh beyond it, if it is to cover."""
    cut_off: float
    across: bool

    def of(self, patch: Any) -> dict[str, float]:
        """What it lacks, each as the binary logarithm of the times as many cells that may be spent to lack it no more."""
        outside = patch.report["outside"]
        more = sum(area(patch.vertices[loop]) for loop in patch.loops) - self.drawn
        cut_off = max(0.0, float(np.log2(max(outside, 1e-9) / self.cut_off)))
        if self.across:
            # What lies between within an inlet that is filled is told by the area alone; a tip that is cut off counts as a square, too.
            more = (
                max(patch.report["between"] * self.drawn, abs(more)) + max(0.0, outside - self.cut_off) ** 2
            )
        elif cut_off > 0:
            cut_off += WORTH_CUT_OFF
        empty = WORTH_AREA * max(0.0, float(np.log2(max(more, 1e-9) / self.much)))
        lacks = {
            "cut_off": min(cut_off, WORTH_MOST[self.across]),
            "area": min(empty, WORTH_MOST_AREA),
        }
        return {what: worth for what, worth in lacks.items() if worth > 0}


def lacks_of(
    parts: list[Any], number: float, cell: float, is_body: bool, margin: float, faint: float = 1.0
) -> list[Lacks]:
    """What each part may lack: the share of the picture that may be lost, parted along the outlines.

    It is for a mesh of so many cells in all, of this area where edges are one long.
    So the sizes of the parts differ little: edges of one length lose about as much anywhere along outlines. Of rims that are fainter than
    edges more may be cut off.
    """
    drawn = [area(outline) + sum(map(area, holes)) for outline, holes in parts]
    rims = [sum(_length(contour) for contour in [outline, *holes]) for outline, holes in parts]
    across = margin <= 0
    fewer = max(1.0, FEW / number)
    if not is_body:
        in_margin = max(0.0, margin - SOFT) * sum(rims) / sum(drawn)
        share = max(EMPTY * fewer - in_margin, EMPTY_AT_LEAST)
    elif across:
        least, most = BETWEEN
        share = max(least, most - PIXELS * sum(rims) / sum(drawn)) * fewer
    else:
        share = EMPTY_OF_BODY * fewer
    pixels, edges = CUT_OFF_ACROSS
    edge_length = float(np.sqrt(sum(drawn) / number / cell))
    cut_off = faint * (max(pixels, edges * edge_length) if across else CUT_OFF)
    return [
        Lacks(own, share * sum(drawn) * rim / sum(rims), cut_off, across)
        for own, rim in zip(drawn, rims, strict=True)
    ]


@dataclass(frozen=True, eq=False)
class Made:
    """The surface of a part, or the error, at a step."""

    surface: Any
    step: int
    lacks: dict[str, float]

    @property
    def score(self) -> float:
        """The less the better: binary logarithm of the cells, as many times as what it lacks is worth."""
        return float(np.log2(number_of(self.step))) + sum(self.lacks.values())


def is_coarse(surface: Any) -> bool:
    """Whether no mesh of this size could follow a part."""
    return getattr(surface, "kind", "") in {"too_coarse", "no_patch"}


def best(first: int, number: int, make: Callable[[int, float], Made | None]) -> Made | None:
    """The best of all steps from the first on: only what it has and lacks itself decides, so that from a later one on none with fewer cells is the best.

    `make` makes that of a step, or nothing if its score is not below one. As many as asked for are made where they lack nothing; steps whose number alone
    is worse than the best so far are not tried.
    """
    found: Made | None = None
    refused: Made | None = None
    for step in steps(first, number):
        score = np.inf if found is None else found.score
        if np.log2(number_of(step)) >= score:
            break
        made = make(step, score)
        if made is None:
            continue
        if hasattr(made.surface, "vertices"):
            if made.score < score:
                found = made
            if found is made and number_of(step) > THIN * number and refused is not None:
                break
        elif not is_coarse(made.surface):
            # Nothing finer helps, as where an outline meets itself.
            return found or made
        else:
            refused = refused or made
    return found or refused


def even(results: list[Made], finer: Callable[[int, int], Made | None]) -> list[int]:
    """Make parts finer, in place, as long as edges of others are short for the picture and that helps; returns which were.

    `finer` makes the part from a step on; what is no surface, or has an edge that is short for itself, is left.
    """
    first = {k: made.step for k, made in enumerate(results)}
    changed = set()
    for _ in range(_ROUNDS):
        edges = {
            k: edge_lengths(made.surface)
            for k, made in enumerate(results)
            if hasattr(made.surface, "vertices")
        }
        if not edges:
            break
        mean = float(np.concatenate(list(edges.values())).mean())
        ratio = min(float(own.min()) for own in edges.values()) / (SHORT * mean)
        coarse = [k for k, own in edges.items() if own.mean() > mean and own.min() > 1.1 * SHORT * mean]
        if ratio >= 1 or not coarse:
            break
        for k in coarse:
            number = number_of(first[k]) / max(_STEP, 0.95 * ratio) ** 2
            first[k] = max(first[k] + 1, step_of(number))
            made = finer(k, first[k])
            if made is None or not hasattr(made.surface, "vertices") or shortest(made.surface) < SHORT:
                continue
            if edge_lengths(made.surface).mean() < edges[k].mean():
                results[k] = made
                changed.add(k)
    return sorted(changed)


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
