"""The drawings of the comparison: closed polygons, the outline first, holes after it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass
class Drawing:
    name: str
    contours: list[np.ndarray]
    """(n, 2) each, the outline counter-clockwise, holes clockwise."""

    @property
    def area(self) -> float:
        return sum(map(signed_area, self.contours))

    @property
    def size(self) -> float:
        return float(np.hypot(*np.ptp(self.contours[0], axis=0)))


def load() -> list[Drawing]:
    """The drawings beside this file."""
    drawings = []
    text = Path(__file__).with_name("drawings.jsonl").read_text(encoding="utf-8")
    for row in map(json.loads, text.splitlines()):
        contours = [turned(np.array(points, float), k == 0) for k, points in enumerate(row["contours"])]
        drawings.append(Drawing(f"{row['name']} ({row['source']})", contours))
    return drawings


def edge_length(drawing: Drawing, n_triangles: int) -> float:
    """Of equilateral triangles that cover the drawing."""
    return (drawing.area / n_triangles * 4 / 3**0.5) ** 0.5


def signed_area(contour: np.ndarray) -> float:
    following = np.roll(contour, -1, axis=0)
    return float((contour[:, 0] * following[:, 1] - contour[:, 1] * following[:, 0]).sum() / 2)


def turned(contour: np.ndarray, counter_clockwise: bool) -> np.ndarray:
    """The contour in the direction wanted."""
    return contour if (signed_area(contour) > 0) == counter_clockwise else contour[::-1].copy()


def resampled(contour: np.ndarray, n: int) -> np.ndarray:
    """n points evenly along the contour, (n, 2)."""
    closed = np.concatenate([contour, contour[:1]])
    arc = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    at = np.linspace(0, arc[-1], n, endpoint=False)
    return np.column_stack([np.interp(at, arc, closed[:, k]) for k in range(2)])


def is_simple(contours: list[np.ndarray]) -> bool:
    """Whether no two sides of the polygons meet, neighbours apart."""
    start = np.concatenate(contours)
    end = np.concatenate([np.roll(contour, -1, axis=0) for contour in contours])
    after = np.concatenate(
        [
            offset + np.roll(np.arange(len(c)), -1)
            for c, offset in zip(contours, offsets(contours), strict=True)
        ]
    )
    low, high = np.minimum(start, end), np.maximum(start, end)
    for k in range(len(start)):
        a, b = start[k], end[k]
        side_a, side_b = cross(end - start, a - start), cross(end - start, b - start)
        side_start, side_end = cross(b - a, start - a), cross(b - a, end - a)
        # Sides on one straight line are on neither side of each other: their boxes must overlap too.
        overlap = (low <= np.maximum(a, b)).all(axis=1) & (high >= np.minimum(a, b)).all(axis=1)
        meets = overlap & (side_a * side_b <= 0) & (side_start * side_end <= 0)
        meets[[k, after[k], np.flatnonzero(after == k)[0]]] = False
        if meets.any():
            return False
    return True


def offsets(contours: list[np.ndarray]) -> np.ndarray:
    """The number of each contour's first point when all are counted."""
    return np.concatenate([[0], np.cumsum([len(contour) for contour in contours])[:-1]])


def sides(contours: list[np.ndarray]) -> np.ndarray:
    """Numbers of the end points of every side, (n, 2), all points being counted."""
    numbers = [np.arange(len(c)) + offset for c, offset in zip(contours, offsets(contours), strict=True)]
    return np.concatenate([np.column_stack([own, np.roll(own, -1)]) for own in numbers])


def cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def point_inside(contour: np.ndarray) -> np.ndarray:
    """Some point inside a polygon: the middle of the widest stretch of a horizontal line across it."""
    heights = np.unique(contour[:, 1])
    widest = np.argmax(np.diff(heights))
    y = (heights[widest] + heights[widest + 1]) / 2
    following = np.roll(contour, -1, axis=0)
    crosses = (contour[:, 1] < y) != (following[:, 1] < y)
    a, b = contour[crosses], following[crosses]
    x = np.sort(a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
    k = 2 * np.argmax(x[1::2] - x[::2])
    return np.array([(x[k] + x[k + 1]) / 2, y])
