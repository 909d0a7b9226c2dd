# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies of one drawing as one: those of upper layers lie on those of lower ones, then all are joined."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from mathutils import Matrix
from mathutils.bvhtree import BVHTree

from .. import api
from ..data import frames
from . import joining
from .uniting import JoinError

_PARALLEL = np.cos(np.radians(10.0))
"""Drawings in planes that are turned by less against each other lie in layers one before the other."""


def join(
    context: bpy.types.Context,
    bodies: Sequence[api.Body],
    objects: Sequence[bpy.types.Object],
    depth: float,
    progress: api.Progress | None = None,
) -> joining.Done:
    """Move bodies by the order of their layers, and join them to one, in the largest; where that fails they stay where they are.

    depth : 0 leaves all in the plane of their strokes, 1 has the middle of each on the surface of what is below.
    Raises as `joining.join` does.
    """
    context.view_layer.update()
    before = [ob.matrix_world.copy() for ob in objects]
    stack(context, bodies, objects, depth)
    largest = max(range(len(objects)), key=lambda at: bodies[at].sketch.size)
    ordered = [objects[largest], *(ob for at, ob in enumerate(objects) if at != largest)]
    try:
        return joining.join(context, ordered, joining.Options(), progress)
    except (JoinError, api.NativeError, api.CancelledError):
        for ob, matrix in zip(objects, before, strict=True):
            ob.matrix_world = matrix
        raise


def stack(
    context: bpy.types.Context,
    bodies: Sequence[api.Body],
    objects: Sequence[bpy.types.Object],
    depth: float,
) -> None:
    """Move bodies along the normal of their plane, so that those of a layer lie on those of the layers below it."""
    axes = bodies[0].sketch.plane.axes
    flat = [abs(body.sketch.plane.axes[2] @ axes[2]) > _PARALLEL for body in bodies]
    ranks = [_rank(context, body) for body in bodies]
    below: list[tuple[np.ndarray, np.ndarray]] = []
    for rank in sorted(set(ranks)):
        tree = _tree(below)
        for body, ob, own, level in zip(bodies, objects, ranks, flat, strict=True):
            if own != rank:
                continue
            points = frames.moved(np.asarray(body.vertices), np.array(ob.matrix_world)) @ axes.T
            if tree is not None and level:
                heights = _heights(tree, points, body.sketch.plane.origin @ axes[2])
                lift = depth * float(np.mean(heights)) if len(heights) else 0.0
                ob.matrix_world = Matrix.Translation((lift * axes[2]).tolist()) @ ob.matrix_world
                points[:, 2] += lift
            below.append((points, np.asarray(body.faces)))
    context.view_layer.update()


def _rank(context: bpy.types.Context, body: api.Body) -> int:
    """Number of the layer of a body's stroke, from below; 0 where there are no layers."""
    stroke = body.sketch.stroke
    source = context.view_layer.objects.get(stroke.source)
    layers = source.data.layers if source is not None and source.type == "GREASEPENCIL" else ()
    return next((at for at, layer in enumerate(layers) if layer.name == stroke.layer), 0)


def _tree(below: Sequence[tuple[np.ndarray, np.ndarray]]) -> BVHTree | None:
    if not below:
        return None
    first = np.cumsum([0, *(len(points) for points, _ in below)])
    faces = [face for (_, own), start in zip(below, first, strict=False) for face in (own + start).tolist()]
    return BVHTree.FromPolygons(np.concatenate([points for points, _ in below]).tolist(), faces)


def _heights(tree: BVHTree, points: np.ndarray, middle: float) -> list[float]:
    """How far before the plane of its stroke what is below a body has its surface, at those of its points where anything is."""
    top = 2 * float(np.abs(points).max()) + 1
    found = (tree.ray_cast((x, y, top), (0, 0, -1))[0] for x, y in points[:, :2].tolist())
    return [place[2] - middle for place in found if place is not None]
