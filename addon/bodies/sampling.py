# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as polylines: Bezier, Catmull-Rom and NURBS strokes, sampled as Blender draws them. numpy only."""

from __future__ import annotations

import numpy as np

RESOLUTION = 12
"""Points per segment where a stroke does not say."""

# What the attribute `knots_mode` means.
_NORMAL, _ENDPOINT = 0, 1


class SamplingError(ValueError):
    """A kind of curve that is not read. The message says which and what to do."""


def bezier(
    points: np.ndarray, left: np.ndarray, right: np.ndarray, cyclic: bool, resolution: int = RESOLUTION
) -> np.ndarray:
    """Sample a Bezier spline with control points and handles (n, 3); its points are among the samples."""
    if len(points) < 2:
        return points
    after = np.roll(np.arange(len(points)), -1)
    first = np.arange(len(points) if cyclic else len(points) - 1)
    t = (np.arange(resolution) / resolution)[None, :, None]
    p0, p1 = points[first, None], right[first, None]
    p2, p3 = left[after[first], None], points[after[first], None]
    samples = (1 - t) ** 3 * p0 + 3 * t * (1 - t) ** 2 * p1 + 3 * t**2 * (1 - t) * p2 + t**3 * p3
    samples = samples.reshape(-1, points.shape[1])
    return samples if cyclic else np.concatenate([samples, points[-1:]])


def catmull_rom(points: np.ndarray, cyclic: bool, resolution: int = RESOLUTION) -> np.ndarray:
    """Sample a uniform Catmull-Rom spline through points (n, 3), as a Bezier spline."""
    if len(points) < 3:
        return points
    if cyclic:
        tangent = (np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)) / 6
    else:
        padded = np.concatenate([points[:1], points, points[-1:]])
        tangent = (padded[2:] - padded[:-2]) / 6
    return bezier(points, points - tangent, points + tangent, cyclic, resolution)


def nurbs(
    points: np.ndarray,
    weights: np.ndarray,
    cyclic: bool,
    order: int = 4,
    knots_mode: int = _NORMAL,
    resolution: int = RESOLUTION,
) -> np.ndarray:
    """Sample a uniform rational B-spline with control points (n, 3) and weights (n,).

    Raises
    ------
    SamplingError
        If its knots are neither uniform nor uniform with repeated ends.
    """
    n = len(points)
    order = min(max(order, 2), n)
    if n < 3:
        return points
    if knots_mode not in (_NORMAL, _ENDPOINT) or (cyclic and knots_mode == _ENDPOINT):
        raise SamplingError(
            "its NURBS knots are of a kind that is not read; set the curve type to Poly or Bezier"
        )
    control = np.column_stack([points * weights[:, None], weights])
    degree = order - 1
    if cyclic:
        control = np.concatenate([control, control[:degree]])
    knots = np.arange(len(control) + order, dtype=float)
    if knots_mode == _ENDPOINT:
        knots = np.clip(knots, degree, n)
    spans = np.arange(degree, len(control))
    t = (spans[:, None] + np.arange(resolution) / resolution).ravel()
    span = np.repeat(spans, resolution)
    if not cyclic:
        t, span = np.append(t, len(control)), np.append(span, spans[-1])
    samples = _de_boor(control, knots, degree, t, span)
    return samples[:, :-1] / samples[:, -1:]


def _de_boor(
    control: np.ndarray, knots: np.ndarray, degree: int, t: np.ndarray, span: np.ndarray
) -> np.ndarray:
    """De Boor's algorithm for all parameters at once; `span` is the knot interval of each."""
    work = control[span[:, None] + np.arange(-degree, 1)]
    for level in range(1, degree + 1):
        for j in range(degree, level - 1, -1):
            low = knots[span + j - degree]
            high = knots[span + j + 1 - level]
            share = ((t - low) / (high - low))[:, None]
            work[:, j] = (1 - share) * work[:, j - 1] + share * work[:, j]
    return work[:, degree]


def polylines(edges: np.ndarray) -> list[tuple[np.ndarray, bool]]:
    """Walk edges (m, 2) into polylines: arrays of vertex indices and whether each is closed.

    They come in the order of their lowest vertex; an open one starts at its end of lower index.

    Raises
    ------
    SamplingError
        If more than two edges meet at a vertex.
    """
    around: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    branch = next((vertex for vertex, others in around.items() if len(others) > 2), None)
    if branch is not None:
        raise SamplingError("its edges branch; turn off the modifiers or options that make faces of it")
    walked: list[tuple[np.ndarray, bool]] = []
    seen: set[int] = set()

    def walk(start: int, step: int) -> list[int]:
        line = [start]
        while step not in seen and step != start:
            line.append(step)
            seen.add(step)
            onward = [other for other in around[step] if other != line[-2]]
            if not onward:
                break
            step = onward[0]
        return line

    for vertex in sorted(around):
        if vertex not in seen and len(around[vertex]) == 1:
            seen.add(vertex)
            walked.append((np.array(walk(vertex, around[vertex][0])), False))
    for vertex in sorted(around):
        if vertex not in seen:
            seen.add(vertex)
            walked.append((np.array(walk(vertex, around[vertex][0])), True))
    return sorted(walked, key=lambda line: int(line[0].min()))


def border(edges: np.ndarray, loop_edges: np.ndarray) -> np.ndarray:
    """Edges (m, 2) that bound faces on one side only, and edges without faces.

    loop_edges : edge index of every face corner.
    """
    faces = np.bincount(loop_edges, minlength=len(edges)) if len(loop_edges) else np.zeros(len(edges), int)
    return edges[faces <= 1]
