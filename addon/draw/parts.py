# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a part of a body lies: in the plane of the view, in front of the body, behind it or in its middle.

numpy only, no bpy.
"""

from __future__ import annotations

import numpy as np

from ..bodies.outlines import Plane
from .regions import inside
from .trace import Trace

DEPTHS = {"FRONT": 1.0, "MIDDLE": 0.0, "BEHIND": -1.0}
"""How far in front of the middle of the body a part lies, in distances from there to the surface."""

NEXT = ("FRONT", "MIDDLE", "BEHIND")
"""In which order a key goes through them."""


def base(trace: Trace, plane: Plane, middle: np.ndarray, *, near: bool) -> Plane:
    """Plane that a part lies in at depth 0.

    plane, middle : of the body, the latter (3,) in the world. near : the view is hardly turned against that plane: it is taken
    itself. Otherwise the part faces the view, through the middle of the body; a plane that was chosen stays.
    """
    if near:
        x, _, z = plane.axes
        return Plane(plane.origin, np.stack([x, np.cross(z, x), z]))  # that of a twin is left-handed
    return Plane(middle, trace.plane.axes) if trace.free else trace.plane


def toward(trace: Trace, plane: Plane) -> np.ndarray:
    """Normal (3,) of a plane on the side of the viewer."""
    normal = plane.axes[2]
    return -normal if float(trace.directions.mean(axis=0) @ normal) > 0 else normal


def reach(plane: Plane, stroke: np.ndarray, surface: np.ndarray, *, toward: np.ndarray) -> float:
    """Mean distance from a plane to where the surface of a body is, beyond the inside of a stroke; 0 if it is not there.

    stroke : (n, 2) in the plane. surface : (k, 3) points in the world. toward : (3,) the normal on the side that counts.
    """
    if not len(surface):
        return 0.0
    local = plane.local(surface)
    heights = (surface - plane.origin) @ toward
    ahead = heights > 0
    under = ahead & inside((stroke, []), local[:, :2])
    if not under.any():
        apart = ((local[:, :2] - stroke.mean(axis=0)) ** 2).sum(axis=1)
        apart[~ahead] = np.inf
        under = np.isfinite(apart) & (apart <= 4 * apart.min())
    return float(heights[under].mean()) if under.any() else 0.0
