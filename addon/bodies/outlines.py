# SPDX-License-Identifier: GPL-3.0-or-later
"""From strokes in space to closed outlines in a plane: drawing planes and closing.

numpy only, no bpy. Points are float64 in world units.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

SMALLEST, LARGEST = 1e-6, 1e9
"""Sizes of a stroke that a mesh in single precision can hold with sound normals."""

STRAIGHT = 1e-6
"""A stroke narrower than this part of its length is a straight line."""

NOTABLE = 0.01
"""A stroke farther from its plane than this part of its size is worth a warning."""


class StrokeError(ValueError):
    """A stroke cannot become a body. The message says why and what to do, without naming the stroke."""


class OpenError(StrokeError):
    """A stroke is open and its ends are too far apart."""


@dataclass(frozen=True, eq=False)
class Stroke:
    """One drawn stroke in world space, and where it came from."""

    points: np.ndarray
    """(n, 3) float64, world units."""
    cyclic: bool
    source: str
    """Name of the object (or annotation) that holds it."""
    layer: str
    """Name of its layer; empty where the source has no layers."""
    index: int
    """Position in the layer, counted from 0."""
    count: int
    """Strokes in the layer."""
    selected: bool | None = True
    """None where modifiers made the stroke, so that nobody can tell."""
    material: Any = None
    """Whatever the reader wants to hand through to the mesh."""
    filled: bool = False
    """Whether it is drawn with a fill of its own, apart from what its material says."""
    painted: bool = False
    """Whether colours are painted over those of its material."""
    widths: np.ndarray | None = None
    """(n,) radius of the pen at each point, in the drawing's own units; None where it is not known."""

    @property
    def label(self) -> str:
        """How messages name the stroke, counted from 1."""
        if self.layer:
            return f"'{self.source}', layer '{self.layer}', stroke {self.index + 1} of {self.count}"
        return f"'{self.source}', stroke {self.index + 1} of {self.count}"

    @property
    def key(self) -> tuple[str, str, int]:
        """What a body remembers of its stroke."""
        return self.source, self.layer, self.index


@dataclass(frozen=True, eq=False)
class Plane:
    """A drawing plane: `axes` has the unit vectors x, y (in the plane) and z (its normal) as rows."""

    origin: np.ndarray
    axes: np.ndarray

    def local(self, points: np.ndarray) -> np.ndarray:
        """Coordinates (n, 3) in the plane's frame."""
        return (np.asarray(points, float) - self.origin) @ self.axes.T

    def world(self, points: np.ndarray) -> np.ndarray:
        """Inverse of `local`."""
        return np.asarray(points, float) @ self.axes + self.origin

    @property
    def matrix(self) -> np.ndarray:
        """(4, 4) matrix from the plane's frame to the world."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.axes.T, self.origin
        return matrix


@dataclass(eq=False)
class Sketch:
    """A closed outline in its plane, ready for `gridmesh`, and the strokes that are holes in it."""

    stroke: Stroke
    plane: Plane
    outline: np.ndarray
    """(n, 2) float64 in the plane's frame; the middle of its bounds is the origin."""
    size: float
    """Diagonal of the bounds, world units."""
    off_plane: float
    """Largest distance of a point from the plane, world units."""
    closed_gap: float = 0.0
    """Length of the straight line that closes an open stroke, world units."""
    holes: list[Sketch] = field(default_factory=list)


def fit_plane(points: np.ndarray) -> Plane:
    """Best-fit plane through points (n, 3) that are finite and not on one line.

    The normal points up (+Z of the world). On a plane that is vertical within 6 degrees it points to the
    front (-Y), and where the plane stands across the front, to the right (+X). The x axis is level, except
    on planes that are horizontal within 25 degrees, where it follows the world's X. The origin is the middle
    of the points' bounds in this frame.

    Raises
    ------
    StrokeError
        If the points lie on one line.
    """
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    centred = points - middle
    mean = centred.mean(axis=0)
    _, widths, directions = np.linalg.svd(centred - mean, full_matrices=False)
    if widths[1] <= STRAIGHT * widths[0]:
        raise StrokeError("it is a straight line; draw a closed shape")
    normal = facing(directions[2])
    level = np.array([1.0, 0.0, 0.0]) if normal[2] > 0.9 else np.array([-normal[1], normal[0], 0.0])
    x = level - normal * (level @ normal)
    x /= np.linalg.norm(x)
    axes = np.stack([x, np.cross(normal, x), normal])
    local = centred @ axes.T
    centre = (local.min(axis=0) + local.max(axis=0)) / 2
    centre[2] = mean @ normal
    return Plane(origin=middle + centre @ axes, axes=axes)


def facing(normal: np.ndarray) -> np.ndarray:
    """Choose the sign of a plane's normal, and take away the noise of one that is meant to be an axis."""
    normal = np.where(np.abs(normal) < 1e-6, 0.0, normal)
    normal = normal / np.linalg.norm(normal)
    if abs(normal[2]) > 0.1:
        sign = np.sign(normal[2])
    elif abs(normal[1]) > 0.1:
        sign = -np.sign(normal[1])
    else:
        sign = np.sign(normal[0])
    return sign * normal + 0.0


def prepare(stroke: Stroke, close_gaps: float) -> Sketch:
    """Check a stroke, find its plane and close it.

    close_gaps : largest gap between the ends of an open stroke that is closed by a straight line, and longest
        end that is cut off where an open stroke overshoots; both in parts of the stroke's size.

    Raises
    ------
    StrokeError
        If the stroke cannot be closed or is not a shape.
    """
    points = np.asarray(stroke.points, float)
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise StrokeError(f"point {bad[0] + 1} of {len(points)} is not a finite number; delete it")
    if len(points) == 0:
        raise StrokeError("it has no points; draw a closed shape")
    largest = float(np.abs(points).max())
    if largest > LARGEST:
        raise StrokeError(
            f"it reaches to {largest:.3g}, coordinates up to {LARGEST:g} are supported; "
            "scale it down or move it to the world origin"
        )
    distinct = len(np.unique(points[:64], axis=0))
    if distinct < 3:
        distinct = len(np.unique(points, axis=0))
    if distinct == 1:
        raise StrokeError("it has 1 distinct point, at least 3 are needed; draw a closed shape")
    if distinct < 3:
        raise StrokeError(f"it has {distinct} distinct points, at least 3 are needed; draw a closed shape")
    extent = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))
    if extent < SMALLEST:
        raise StrokeError(f"it is {extent:.3g} across, at least {SMALLEST:g} is needed; scale it up")
    plane = fit_plane(points)
    local = plane.local(points)
    flat, gap = (local[:, :2], 0.0) if stroke.cyclic else close(local[:, :2], close_gaps)
    low, high = flat.min(axis=0), flat.max(axis=0)
    centre = np.append((low + high) / 2, 0.0)
    return Sketch(
        stroke=stroke,
        plane=Plane(plane.world(centre), plane.axes),
        outline=np.ascontiguousarray(flat - centre[:2]),
        size=float(np.linalg.norm(high - low)),
        off_plane=float(np.abs(local[:, 2]).max()),
        closed_gap=gap,
    )


def transformed(sketch: Sketch, matrix: np.ndarray, close_gaps: float) -> Sketch:
    """Return the sketch of the same strokes in another space; matrix : (4, 4) to there.

    Raises
    ------
    StrokeError
        If there is none: the matrix makes a line of it, or leaves the range of single precision.
    """
    points = np.asarray(sketch.stroke.points, float) @ matrix[:3, :3].T + matrix[:3, 3]
    again = prepare(replace(sketch.stroke, points=points), close_gaps)
    again.holes = [transformed(hole, matrix, close_gaps) for hole in sketch.holes]
    return again


def closable(stroke: Stroke, close_gaps: float) -> bool:
    """Whether the stroke is closed, or its ends are near enough, or it is bad in a way worth a message."""
    if stroke.cyclic:
        return True
    try:
        prepare(stroke, close_gaps)
    except OpenError:
        return False
    except StrokeError:
        return True
    return True


def close(points: np.ndarray, tolerance: float) -> tuple[np.ndarray, float]:
    """Close an open planar stroke (n, 2), n >= 3, the way it was meant.

    Where its ends cross, both are cut off at the crossing; where they pass each other at a distance, at the
    nearest approach; otherwise the ends are joined as they are. Nothing longer than `tolerance` times the
    size of the stroke is cut off or bridged. Returns the outline (closed implicitly) and the gap bridged.

    Raises
    ------
    OpenError
        If the gap is larger.
    """
    size = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))
    limit = tolerance * size
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    reach = min(limit, arc[-1] / 3)
    head = np.flatnonzero(arc[:-1] < reach)
    tail = np.flatnonzero(arc[1:] > arc[-1] - reach)
    gap = float(np.linalg.norm(points[-1] - points[0]))
    crossing = _last_crossing(points, head, tail, arc, reach)
    if crossing is not None:
        first, last, at = crossing
        return np.concatenate([at[None], points[first + 1 : last + 1]]), 0.0
    nearest = _nearest_approach(points, head, tail)
    # Ends that merely come together are left alone; ends that pass each other are much nearer before.
    if nearest is not None and nearest[2] < 0.5 * gap and nearest[1] - nearest[0] >= 2:
        first, last, apart = nearest
        return points[first : last + 1], apart
    if gap > limit:
        enough = np.ceil(100 * gap / size) / 100
        raise OpenError(
            f"it is open: its ends are {gap:.3g} apart; make the stroke cyclic "
            f"or raise Close Gaps from {tolerance:.2f} to {enough:.2f}"
        )
    return points, gap


def _last_crossing(
    points: np.ndarray, head: np.ndarray, tail: np.ndarray, arc: np.ndarray, reach: float
) -> tuple[int, int, np.ndarray] | None:
    """Find the crossing of a segment of `head` with one of `tail` that cuts off most.

    Returns the two segments and the point, or None.
    """
    if not len(head) or not len(tail) or head[-1] + 1 >= tail[0]:
        return None
    b, v = points[tail], points[tail + 1] - points[tail]
    best, found = -1.0, None
    for block in blocks(head, len(tail)):
        a, u = points[block], points[block + 1] - points[block]
        between = b[None] - a[:, None]
        area = u[:, None, 0] * v[None, :, 1] - u[:, None, 1] * v[None, :, 0]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            s = (between[..., 0] * v[None, :, 1] - between[..., 1] * v[None, :, 0]) / area
            t = (between[..., 0] * u[:, None, 1] - between[..., 1] * u[:, None, 0]) / area
        meets = (area != 0) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
        s, t = np.where(meets, s, 0.0), np.where(meets, t, 0.0)
        before = arc[block][:, None] + s * (arc[block + 1] - arc[block])[:, None]
        after = arc[-1] - arc[tail][None] - t * (arc[tail + 1] - arc[tail])[None]
        meets &= (before <= reach) & (after <= reach)
        cut = np.where(meets, before + after, -1.0)
        i, j = np.unravel_index(int(cut.argmax()), cut.shape)
        if cut[i, j] > best:
            best, found = float(cut[i, j]), (int(block[i]), int(tail[j]), a[i] + s[i, j] * u[i])
    return found


def _nearest_approach(
    points: np.ndarray, head: np.ndarray, tail: np.ndarray
) -> tuple[int, int, float] | None:
    """Find the point of `head` and the end of a segment of `tail` that are nearest, and their distance."""
    if not len(head) or not len(tail):
        return None
    ends = points[tail + 1]
    best, found = np.inf, None
    for block in blocks(head, len(tail)):
        apart = np.linalg.norm(points[block][:, None] - ends[None], axis=2)
        i, j = np.unravel_index(int(apart.argmin()), apart.shape)
        if apart[i, j] < best:
            best, found = float(apart[i, j]), (int(block[i]), int(tail[j]) + 1, float(apart[i, j]))
    return found


def blocks(rows: np.ndarray, columns: int) -> list[np.ndarray]:
    """Split the rows of a large table so that a block has about half a million cells."""
    height = max(1, 500_000 // max(1, columns))
    return [rows[at : at + height] for at in range(0, len(rows), height)]


def project(sketch: Sketch, plane: Plane) -> np.ndarray:
    """Points of the sketch's outline in the frame of another plane, (n, 3)."""
    flat = np.column_stack([sketch.outline, np.zeros(len(sketch.outline))])
    return plane.local(sketch.plane.world(flat))


def area(outline: np.ndarray) -> float:
    """Area that a closed outline (n, 2) encloses."""
    x, y = outline.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)
