# SPDX-License-Identifier: GPL-3.0-or-later
"""A finished stroke as it was seen: sight lines through its points, which may be laid into any plane.

numpy only, no bpy.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass, replace

import numpy as np

from ..bodies.outlines import OpenError, Plane, close

OVERSHOOT = 0.2
"""Ends that pass each other are cut off up to this part of the stroke's size."""

BEHIND = 1e-6
"""Sine of a sight line to a plane below which it does not meet it."""


@dataclass(frozen=True, eq=False)
class Trace:
    """Sight lines through the points of a stroke."""

    plane: Plane
    """Where a new body lies."""
    origins: np.ndarray
    """(n, 3) in the world."""
    directions: np.ndarray
    """(n, 3) unit vectors, away from the viewer."""
    pressures: np.ndarray
    """(n,) from 0 to 1."""
    seen: bool = False
    """Whether somebody saw it: then it may begin on a body at any depth."""
    free: bool = False
    """Whether the plane was not chosen but is that of the view: then a body that it begins on has the better one."""
    perspective: bool = False

    def __len__(self) -> int:
        return len(self.origins)

    def on(self, plane: Plane) -> np.ndarray | None:
        """Points (n, 2) of a plane that are seen along the sight lines; None if one of them does not meet it."""
        sines = self.directions @ plane.axes[2]
        if (np.abs(sines) < BEHIND).any():
            return None
        along = (plane.origin - self.origins) @ plane.axes[2] / sines
        if self.perspective and (along < 0).any():
            return None
        return plane.local(self.origins + along[:, None] * self.directions)[:, :2]

    def depth(self, plane: Plane) -> float:
        """How far away a plane is at the first point."""
        sine = float(self.directions[0] @ plane.axes[2])
        return float((plane.origin - self.origins[0]) @ plane.axes[2]) / sine

    def through(self, points: np.ndarray) -> Trace:
        """Return the same view of other points (n, 3) of the world."""
        if self.perspective:
            origins = np.broadcast_to(self.origins[0], points.shape)
            directions = points - origins
            directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        else:
            directions = np.broadcast_to(self.directions[0], points.shape)
            along = ((points - self.origins[0]) * directions).sum(axis=1)
            origins = points - along[:, None] * directions
        return replace(self, origins=origins, directions=directions)


def flat(plane: Plane, points: np.ndarray, pressures: np.ndarray, *, free: bool = True) -> Trace:
    """Trace of points (n, 2) of a plane, looked at along its normal: for scripts, which see nothing."""
    world = plane.world(np.column_stack([points, np.zeros(len(points))]))
    directions = np.broadcast_to(-plane.axes[2], world.shape)
    return Trace(plane, world, directions, np.asarray(pressures, float), free=free)


def closed(points: np.ndarray) -> np.ndarray:
    """A stroke (n, 2) as an outline: what overshoots where its ends meet is cut off; ends far apart are joined."""
    if len(points) < 4 or not np.ptp(points, axis=0).any():
        return points
    try:
        return close(points, OVERSHOOT)[0]
    except OpenError:
        return points


@dataclass(frozen=True, eq=False)
class Mirror:
    """A mirror that is seen edge on, as an upright line."""

    place: np.ndarray
    """(3,) a point of it, in the world."""
    normal: np.ndarray
    """(3,) unit vector across it."""

    def line(self, plane: Plane) -> tuple[np.ndarray, float]:
        """Where it cuts a plane: the points (2,) with `normal @ point == offset`."""
        across = plane.axes[:2] @ self.normal
        length = float(np.linalg.norm(across))
        if length < 1e-6:
            return np.array([1.0, 0.0]), float(plane.local(self.place[None])[0, 0])
        return across / length, float(self.normal @ (self.place - plane.origin)) / length

    def across(self, points: np.ndarray) -> np.ndarray:
        """Mirror image (n, 3) of points of the world."""
        return points - 2 * ((points - self.place) @ self.normal)[:, None] * self.normal

    def image(self, plane: Plane, points: np.ndarray) -> np.ndarray:
        """Mirror image (n, 2) of points of a plane."""
        normal, offset = self.line(plane)
        return points - 2 * (points @ normal - offset)[:, None] * normal


def pack(points: np.ndarray, pressures: np.ndarray) -> str:
    """Stroke (n, 2) as text, for scripts."""
    table = np.column_stack([points, pressures]).astype("<f8")
    return base64.b64encode(table.tobytes()).decode()


def unpack(text: str) -> tuple[np.ndarray, np.ndarray]:
    """Inverse of `pack`: points (n, 2) and pressures (n,).

    Raises
    ------
    ValueError
        If the text is no stroke.
    """
    raw = base64.b64decode(text, validate=True)
    if len(raw) % 24:
        raise ValueError(f"{len(raw)} bytes are no table of three columns")
    table = np.frombuffer(raw, "<f8").reshape(-1, 3)
    if not np.isfinite(table).all():
        raise ValueError("it has numbers that are not finite")
    return table[:, :2].copy(), np.clip(table[:, 2], 0.0, 1.0)
