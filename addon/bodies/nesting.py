# SPDX-License-Identifier: GPL-3.0-or-later
"""Which closed outlines are holes of others.

numpy only, no bpy. Points are float64 in world units.
"""

from __future__ import annotations

import numpy as np

from .outlines import Sketch, blocks, project


def nest(sketches: list[Sketch]) -> tuple[list[Sketch], list[str]]:
    """Make sketches inside others their holes, by the even-odd rule.

    A sketch inside an odd number of others of the same source and layer that lie in its plane becomes a hole
    of the smallest one; the others are returned, in order. Sketches that cross are not inside each other:
    what is worth telling about them is returned too. Cost is quadratic in the sketches of a layer.
    """
    layers: dict[tuple[str, str], list[Sketch]] = {}
    for sketch in sketches:
        layers.setdefault(sketch.stroke.key[:2], []).append(sketch)
    outer: list[Sketch] = []
    notes: list[str] = []
    for members in layers.values():
        centres = np.array([sketch.plane.origin for sketch in members])
        sizes = np.array([sketch.size for sketch in members])
        for one in members:
            near = np.linalg.norm(centres - one.plane.origin, axis=1) < (sizes + one.size) / 2
            larger = np.flatnonzero(near & (sizes > one.size))
            parents = []
            for other in (members[at] for at in larger):
                relation = _relation(one, other)
                if relation == "inside":
                    parents.append(other)
                elif relation == "crossing":
                    number = other.stroke.index + 1
                    notes.append(f"{one.stroke.label}: it crosses stroke {number} and is no hole in it")
            if len(parents) % 2 == 0:
                outer.append(one)
            else:
                min(parents, key=lambda parent: parent.size).holes.append(one)
    order = {id(sketch): at for at, sketch in enumerate(sketches)}
    return sorted(outer, key=lambda sketch: order[id(sketch)]), notes


def _relation(one: Sketch, other: Sketch) -> str:
    """How `one` lies to the larger `other`: "inside" it in its plane, "crossing" it there, or "apart"."""
    if abs(one.plane.axes[2] @ other.plane.axes[2]) < 0.99:
        return "apart"
    points = project(one, other.plane)
    if np.abs(points[:, 2]).max() > 0.05 * other.size:
        return "apart"
    if _cross(points[:, :2], other.outline):
        return "crossing"
    return "inside" if contains(other.outline, points[0, :2]) else "apart"


def _cross(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two closed outlines cross, each passing to the other side of the other; touching is none."""
    a, u = one, np.roll(one, -1, axis=0) - one
    b, v = other, np.roll(other, -1, axis=0) - other
    low, high = one.min(axis=0), one.max(axis=0)
    near = (np.maximum(b, b + v) >= low).all(axis=1) & (np.minimum(b, b + v) <= high).all(axis=1)
    b, v = b[near], v[near]
    for block in blocks(np.arange(len(a)), len(b)):
        p, d = a[block][:, None], u[block][:, None]
        before, after = _turn(d, b - p), _turn(d, b + v - p)
        begin, end = _turn(v, p - b), _turn(v, p + d - b)
        if ((before * after < 0) & (begin * end < 0)).any():
            return True
    return False


def _turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Twice the area of the triangle of two vectors in the plane, positive where b is left of a."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def contains(outline: np.ndarray, point: np.ndarray) -> bool:
    """Whether the closed outline (n, 2) winds around the point, by the parity of crossings."""
    a, b = outline, np.roll(outline, -1, axis=0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[spans], b[spans]
    crossing = a[:, 0] + (point[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return bool(np.count_nonzero(crossing > point[0]) % 2)
