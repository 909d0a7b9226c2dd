# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies that cannot be seen, since each lies inside another that was made with it. No operators."""

from __future__ import annotations

from collections.abc import Sequence

import bmesh
import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..data import frames

_SAMPLES = 500
"""About how many vertices of a body are looked at."""

_DIRECTION = Vector((0.29, 0.23, 0.93)).normalized()
"""Of the rays that tell inside from outside; not along an axis, where edges of regular meshes lie one above the other."""

_MOST = 100
"""Times that a ray meets a mesh; a body that is met more often is not taken to be around anything."""


def pairs(objects: Sequence[bpy.types.Object]) -> list[tuple[int, int]]:
    """Indices of the closed bodies that lie inside another as a whole, each with that of the smallest around it."""
    points = [_placed(ob) for ob in objects]
    lows = np.array([own.min(axis=0) for own in points])
    highs = np.array([own.max(axis=0) for own in points])
    trees: dict[int, BVHTree] = {}
    found = []
    for at, own in enumerate(points):
        around = np.flatnonzero((lows < lows[at]).all(axis=1) & (highs > highs[at]).all(axis=1))
        some = own[:: max(1, len(own) // _SAMPLES)]
        for other in sorted(around.tolist(), key=lambda one: np.linalg.norm(highs[one] - lows[one])):
            tree = trees.get(other) or trees.setdefault(other, _tree(objects[other]))
            inverse = np.array(objects[other].matrix_world.inverted_safe())
            step = 1e-5 * max(objects[other].dimensions)
            if all(_encloses(tree, Vector(place), step) for place in frames.moved(some, inverse).tolist()):
                found.append((at, other))
                break
    return found


def _placed(ob: bpy.types.Object) -> np.ndarray:
    """Vertices (n, 3) in the world."""
    points = np.empty(3 * len(ob.data.vertices), np.float32)
    ob.data.vertices.foreach_get("co", points)
    return frames.moved(points.reshape(-1, 3).astype(float), np.array(ob.matrix_world))


def _tree(ob: bpy.types.Object) -> BVHTree:
    mesh = bmesh.new()
    try:
        mesh.from_mesh(ob.data)
        return BVHTree.FromBMesh(mesh)
    finally:
        mesh.free()


def _encloses(tree: BVHTree, place: Vector, step: float) -> bool:
    """Whether a point lies inside a closed mesh, by the parity of what a ray from it meets. step : beyond a hit."""
    for crossed in range(_MOST):
        hit, *_ = tree.ray_cast(place, _DIRECTION)
        if hit is None:
            return crossed % 2 == 1
        place = hit + step * _DIRECTION
    return False


def warning(count: int, *, layers: bool, holes: bool) -> str:
    """Say that bodies are hidden, and what lets them be seen.

    layers : the strokes of some are on layers above, which *Join Overlapping Strokes* lets stand out.
    holes : *Holes* is off, and would have made holes of some.
    """
    if count == 1:
        if layers:
            return "1 body lies hidden inside another; turn on Join Overlapping Strokes, which lets upper layers stand out"
        if holes:
            return "1 body lies hidden inside another; move it forward, or turn on Holes to make a hole of it"
        return "1 body lies hidden inside another; move it forward"
    if layers:
        return f"{count} bodies lie hidden inside others; turn on Join Overlapping Strokes, which lets upper layers stand out"
    if holes:
        return f"{count} bodies lie hidden inside others; move them forward, or turn on Holes to make holes of them"
    return f"{count} bodies lie hidden inside others; move them forward"
