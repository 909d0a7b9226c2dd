# SPDX-License-Identifier: GPL-3.0-or-later
"""A line drawn with the mouse: smoothed, closed, and which side of it a point is on. numpy only; pixels, y up."""

from __future__ import annotations

import numpy as np

STEP = 4.0
"""Pixels between points of the line; nearer ones show the steps of the mouse."""

CLOSING = 14.0
"""Pixels between the ends of a line that is meant to be closed."""

SHORTEST = 12.0
"""A shorter line is a click."""

_ROUNDS = 3


def length(points: np.ndarray) -> float:
    """Length of a polyline (n, 2)."""
    return float(_way(points)[-1])


def _way(points: np.ndarray) -> np.ndarray:
    """Length of a polyline (n, 2) up to each of its points."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def is_closed(points: np.ndarray) -> bool:
    """Whether a polyline (n, 2) comes back to where it began."""
    if len(points) < 4:
        return False
    gap = float(np.linalg.norm(points[-1] - points[0]))
    return gap <= CLOSING and length(points) >= 5 * CLOSING


def smoothed(points: np.ndarray) -> np.ndarray:
    """Points at even distances, without the steps of the mouse; a closed line ends with its first point."""
    points = np.asarray(points, float)
    closed = is_closed(points)
    if closed:
        points = np.vstack([points, points[:1]])
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate([[True], apart > 0])]
    if len(points) < 2:
        return points
    way = _way(points)
    n = max(2, round(way[-1] / STEP) + 1)
    at = np.linspace(0.0, way[-1], n)
    even = np.column_stack([np.interp(at, way, column) for column in points.T])
    for _ in range(_ROUNDS if n > 2 else 0):
        if closed:
            ring = even[:-1]
            ring = (np.roll(ring, 1, axis=0) + 2 * ring + np.roll(ring, -1, axis=0)) / 4
            even = np.vstack([ring, ring[:1]])
        else:
            even[1:-1] = (even[:-2] + 2 * even[1:-1] + even[2:]) / 4
    return even


def on_left(line: np.ndarray, point: np.ndarray) -> bool:
    """Whether the point is on the left of the line, its ends continued; inside, if the line is closed."""
    point = np.asarray(point, float)
    begin, step = line[:-1], np.diff(line, axis=0)
    if np.array_equal(line[0], line[-1]):
        spans = (begin[:, 1] > point[1]) != (line[1:, 1] > point[1])
        a, d = begin[spans], step[spans]
        return bool(np.count_nonzero(a[:, 0] + (point[1] - a[:, 1]) * d[:, 0] / d[:, 1] > point[0]) % 2)
    low, high = np.zeros(len(step)), np.ones(len(step))
    low[0], high[-1] = -np.inf, np.inf
    share = np.clip(
        ((point - begin) * step).sum(axis=1) / np.maximum((step**2).sum(axis=1), 1e-300), low, high
    )
    away = point - begin - share[:, None] * step
    squares = (away**2).sum(axis=1)
    nearest = np.flatnonzero(squares <= squares.min() * (1 + 1e-9))
    # At a corner two segments are equally near: the one that is less along the way tells.
    turn = step[nearest, 0] * away[nearest, 1] - step[nearest, 1] * away[nearest, 0]
    turn /= np.maximum(np.sqrt((step[nearest] ** 2).sum(axis=1)), 1e-300)
    return bool(turn[np.abs(turn).argmax()] > 0)


def extended(line: np.ndarray, ends: np.ndarray | None, reach: float) -> np.ndarray:
    """A line with its ends continued: to two points (2, 2), or straight on by `reach`; closed ones stay."""
    if np.array_equal(line[0], line[-1]):
        return line
    if ends is None:
        ahead = [line[0] - line[1], line[-1] - line[-2]]
        ahead = [way / max(float(np.linalg.norm(way)), 1e-9) for way in ahead]
        ends = np.stack([line[0] + reach * ahead[0], line[-1] + reach * ahead[1]])
    parts = [ends[:1]] if np.linalg.norm(ends[0] - line[0]) > 1e-6 else []
    parts.append(line)
    parts += [ends[1:]] if np.linalg.norm(ends[1] - line[-1]) > 1e-6 else []
    return np.vstack(parts)


def band(line: np.ndarray, width: float, *, left: bool) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of points (n, 2) on the line and `width` away from it, on one side: the edges of a shaded band.

    The line's direction is taken over a length of `width`, so that a shaky hand does not fray the band; in a bend that is
    narrower than the band the far edge waits rather than runs back. Within a closed line it is at most the
    area over the length wide, half the radius of a circle.
    """
    closed = np.array_equal(line[0], line[-1])
    way = _way(line)
    whole = float(way[-1])
    if closed:
        x, y = line[:-1].T
        doubled = float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
        if left:
            width = min(width, 0.5 * abs(doubled) / max(whole, 1e-300))
        left = left == (doubled > 0)
    reach = min(0.5 * width, 0.25 * whole)
    period = whole if closed else None
    ahead, back = (
        np.column_stack([np.interp(way + step, way, column, period=period) for column in line.T])
        for step in (reach, -reach)
    )
    along = ahead - back
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    far = line + across * (width if left else -width)
    for k in range(1, len(far)):
        if (far[k] - far[k - 1]) @ along[k] < 0:
            far[k] = far[k - 1]
    return line, far
