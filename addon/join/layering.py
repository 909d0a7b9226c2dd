# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies of one drawing as one: those of upper layers lie on those of lower ones, then all are joined."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty
from mathutils import Matrix
from mathutils.bvhtree import BVHTree

from .. import api
from ..data import defaults, frames
from ..ui.progress import Pointer
from . import blending, following, joining
from .uniting import JoinError

_PARALLEL = np.cos(np.radians(10.0))
"""Drawings in planes that are turned by less against each other lie in layers one before the other."""


class JoinsBodies:
    """Mixed into operators that make bodies of strokes: all become one, those of upper layers before those of lower ones."""

    use_join: BoolProperty(
        name="Join Overlapping Strokes",
        description="Make one object of all bodies, joined with smooth transitions where they overlap; upper layers lie before lower ones",
        default=False,
        options={"SKIP_SAVE"},
    )
    layer_depth: FloatProperty(
        name="Layer Depth",
        description="How far bodies of a layer stand out of those of the layers below, relative to half their thickness",
        subtype="FACTOR",
        default=defaults.LAYER_DEPTH,
        min=0.0,
        soft_max=1.0,
        max=2.0,
    )
    blend: blending.blend()

    @property
    def joins(self) -> bool:
        """Whether all bodies are to become one; sheets cannot."""
        return self.use_join and self.shape == "BODY"

    def stack(self, context: bpy.types.Context, bodies: list[api.Body], made: list[bpy.types.Object]) -> None:
        """Move the bodies by the order of their layers, if they are to be joined."""
        if self.joins:
            stack(context, bodies, made, self.layer_depth)

    def join(
        self,
        context: bpy.types.Context,
        bodies: list[api.Body],
        made: list[bpy.types.Object],
        warnings: list[str],
    ) -> joining.Done | None:
        """Join the bodies, in the largest, if that is asked for and can be done; add to `warnings` what the user should know.

        If they follow their strokes they stay, hidden, and the whole follows them.
        """
        if not self.joins or len(made) < 2:
            return None
        largest = max(range(len(made)), key=lambda at: bodies[at].sketch.size)
        ordered = [made[largest], *(ob for at, ob in enumerate(made) if at != largest)]
        options = joining.Options(self.blend, keep_parts=self.follow)
        try:
            with Pointer(context) as pointer:
                done = joining.join(context, ordered, options, pointer)
        except (JoinError, api.NativeError, api.CancelledError) as error:
            warnings.insert(0, f"The bodies stay apart: {error}")
            return None
        if self.follow:
            following.remember(done.ob, ordered, options)
        warnings += done.warnings
        return done

    def draw_join(self, layout: bpy.types.UILayout) -> None:
        """Draw the options."""
        layout.prop(self, "use_join")
        column = layout.column()
        column.active = self.use_join
        column.prop(self, "layer_depth")
        column.prop(self, "blend")


def stack(
    context: bpy.types.Context,
    bodies: Sequence[api.Body],
    objects: Sequence[bpy.types.Object],
    depth: float,
) -> None:
    """Move bodies along the normal of their plane, so that those of a layer stand out of those of the layers below it.

    depth : by how much of half their thickness. What reaches before what is below anyway stays in its plane.
    """
    context.view_layer.update()
    axes = bodies[0].sketch.plane.axes
    flat = [abs(body.sketch.plane.axes[2] @ axes[2]) > _PARALLEL for body in bodies]
    ranks = [rank_of(context, body) for body in bodies]
    below: list[tuple[np.ndarray, np.ndarray]] = []
    for rank in sorted(set(ranks)):
        tree = _tree(below)
        for body, ob, own, level in zip(bodies, objects, ranks, flat, strict=True):
            if own != rank:
                continue
            points = frames.moved(np.asarray(body.vertices), np.array(ob.matrix_world)) @ axes.T
            if tree is not None and level:
                heights = _heights(tree, points, body.sketch.plane.origin @ axes[2])
                half = float(np.ptp(points[:, 2])) / 2
                lift = max(float(np.mean(heights)) - (1 - depth) * half, 0.0) if heights else 0.0
                ob.matrix_world = Matrix.Translation((lift * axes[2]).tolist()) @ ob.matrix_world
                points[:, 2] += lift
            below.append((points, np.asarray(body.faces)))
    context.view_layer.update()


def rank_of(context: bpy.types.Context, body: api.Body) -> int:
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
