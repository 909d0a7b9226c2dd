# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that cover what was drawn: outlines moved outward where the edges of a mesh cut it off. numpy only, no bpy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..api import faces_of

ROUNDS = 4
"""Meshes made anew at most."""

ENOUGH = 0.05
"""What may stay outside, in pixels."""

MOST = 0.25
"""How far an outline is moved at most, in edges: tips that the mesh cannot follow are left to `stretched`."""

MOVES = 12
"""Vertices that are moved by themselves at most, for each contour."""

WORTH = 0.2
"""Pixels outside for which a vertex is moved by itself."""

THINNEST = np.radians(12)
"""Corners of faces may become as small as this for a tip's sake."""

_FINE = 5
"""Points of an outline for each edge of the mesh."""


def covered(
    gridmesh: Any,
    outline: np.ndarray,
    holes: list[np.ndarray],
    slack: float,
    options: dict[str, Any],
    progress: Callable[[float], object] | None = None,
) -> Any:
    """Patch of an outline that holds all of it but for a rim of `slack`; the best of a few, if none does.

    Raises
    ------
    GridMeshError
        If the outline itself cannot be meshed.
    """

    def meshed(contours: list[np.ndarray], at: int, more: dict[str, Any]) -> Any:
        part = None
        if progress is not None:
            part = lambda fraction: progress((at + fraction) / (ROUNDS + 1))  # noqa: E731
        return gridmesh.mesh_sketch(contours[0], contours[1:], progress=part, **options, **more)

    patch = best = meshed([outline, *holes], 0, {})
    fine = [dense(contour, best.edge_length / _FINE) for contour in (outline, *holes)]
    moved = [np.zeros(len(contour)) for contour in fine]
    least = np.inf
    for at in range(1, ROUNDS + 1):
        needs = outside(fine, patch, slack)
        most = max(need.max() for need in needs)
        if most < least:
            least, best = most, patch
        if most <= ENOUGH:
            break
        reach = best.edge_length
        moved = [
            np.minimum(far + spread(contour, need, reach), MOST * reach)
            for contour, far, need in zip(fine, moved, needs, strict=True)
        ]
        wider = [contour + far[:, None] * normals(contour) for contour, far in zip(fine, moved, strict=True)]
        try:
            patch = meshed(wider, at, {"angle": best.angle, "self_crossing": "union"})
        except gridmesh.GridMeshError as error:
            if error.kind == "cancelled":
                raise
            break  # wider, it meets itself or is too thin elsewhere: the best so far serves
    else:
        needs = outside(fine, patch, slack)
        best = patch if max(need.max() for need in needs) < least else best
    return best


def stretched(
    patch: Any, outline: np.ndarray, holes: list[np.ndarray], slack: float
) -> tuple[dict[int, np.ndarray], float]:
    """New places of vertices of the boundary, by number, at tips of the outline that the patch cuts off; and what is left outside.

    Each makes less of the outline lie outside, and no face at it thin.
    """
    left = 0.0
    moved: dict[int, np.ndarray] = {}
    vertices, faces = np.array(patch.vertices), faces_of(patch)
    for k, contour in enumerate((outline, *holes)):
        fine = dense(contour, patch.edge_length / _FINE)
        loop = np.asarray(patch.loops[k])
        need = _outside(fine, [vertices[other] for other in patch.loops], k, slack)
        tried = need <= WORTH
        for _ in range(MOVES):
            if tried.all():
                break
            at = int(np.argmax(np.where(tried, -1.0, need)))
            tried[at] = True
            near = loop[np.argsort(np.linalg.norm(vertices[loop] - fine[at], axis=1), kind="stable")[:2]]
            for vertex in near.tolist():
                trial = vertices.copy()
                trial[vertex] = fine[at]
                around = faces[(faces == vertex).any(axis=1)]
                if _thinnest(trial[around]) < THINNEST:
                    continue
                after = _outside(fine, [trial[other] for other in patch.loops], k, slack)
                if (after**2).sum() < 0.9 * (need**2).sum():
                    vertices, need, moved[vertex] = trial, after, fine[at]
                    tried |= need <= WORTH
                    break
        left = max(left, float(need.max()))
    return moved, left


def _thinnest(faces: np.ndarray) -> float:
    """Least corner of faces (f, n, 2); below 0 if one is turned over or concave."""
    ahead, back = np.roll(faces, -1, axis=1) - faces, np.roll(faces, 1, axis=1) - faces
    turn = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    return float(np.arctan2(turn, (ahead * back).sum(axis=2)).min())


def dense(contour: np.ndarray, step: float) -> np.ndarray:
    """Points along a contour at most `step` apart, its own among them."""
    following = np.roll(contour, -1, axis=0)
    counts = np.maximum(1, np.ceil(np.linalg.norm(following - contour, axis=1) / step)).astype(int)
    first = np.repeat(np.arange(len(contour)), counts)
    share = (np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[first]
    return contour[first] + share[:, None] * (following - contour)[first]


def normals(contour: np.ndarray) -> np.ndarray:
    """Unit vectors out of the drawing at the points of a contour that has the drawing on its left."""
    along = np.roll(contour, -1, axis=0) - contour
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    both = along + np.roll(along, 1, axis=0)
    both /= np.maximum(np.linalg.norm(both, axis=1, keepdims=True), 1e-12)
    return np.column_stack([both[:, 1], -both[:, 0]])


def outside(contours: list[np.ndarray], patch: Any, slack: float) -> list[np.ndarray]:
    """For each contour how far its points lie outside the patch, less the slack; 0 inside."""
    loops = [patch.vertices[loop] for loop in patch.loops]
    return [_outside(contour, loops, k, slack) for k, contour in enumerate(contours)]


def _outside(points: np.ndarray, loops: list[np.ndarray], k: int, slack: float) -> np.ndarray:
    """How far points of the contour `k` lie outside its loop, less the slack; 0 inside."""
    a = loops[k]
    b = np.roll(a, -1, axis=0)
    need = np.zeros(len(points))
    for start in range(0, len(points), 2000):
        some = points[start : start + 2000]
        out = _inside(some, a, b) == (k > 0)  # the loop of a hole has the mesh around it
        if out.any():
            need[start : start + 2000][out] = _distance(some[out], a, b)
    return np.maximum(need - slack, 0.0)


def spread(contour: np.ndarray, need: np.ndarray, reach: float) -> np.ndarray:
    """A smooth course that is nowhere below the need: its largest value within `reach`, averaged."""
    n = len(contour)
    lengths = np.linalg.norm(np.roll(contour, -1, axis=0) - contour, axis=1)
    steps = min(max(1, round(reach / max(lengths.mean(), 1e-300))), (n - 1) // 2)
    if steps < 1:
        return np.full(n, need.max())
    window = np.arange(-steps, steps + 1)
    largest = need[(np.arange(n)[:, None] + window) % n].max(axis=1)
    half = np.arange(-(steps // 2), steps // 2 + 1)
    return largest[(np.arange(n)[:, None] + half) % n].mean(axis=1)


def _inside(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Whether points are inside a contour (even-odd)."""
    y = points[:, 1, None]
    crossed = (a[:, 1] <= y) != (b[:, 1] <= y)
    rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
    x = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return (crossed & (x > points[:, 0, None])).sum(axis=1) % 2 == 1


def _distance(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distance of each point from the nearest of the segments."""
    along = b - a
    squared = np.maximum((along**2).sum(axis=1), 1e-300)
    x, y = points[:, 0, None] - a[:, 0], points[:, 1, None] - a[:, 1]
    share = np.clip((x * along[:, 0] + y * along[:, 1]) / squared, 0, 1)
    x -= share * along[:, 0]
    y -= share * along[:, 1]
    return np.sqrt((x * x + y * y).min(axis=1))
