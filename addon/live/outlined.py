# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies with an outline of their own: a grease pencil object inside them, in their own space, which is not rendered."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..bodies.outlines import Stroke
from ..data import frames, placing, written
from . import engine
from .linework import LAYER, RADIUS, drawn, radii, write

__all__ = ["LAYER", "RADIUS", "OutlineError", "make", "radii", "write"]


class OutlineError(ValueError):
    """Outlines have no body. The message says why; nothing was changed."""


def make(
    context: bpy.types.Context,
    rings: list[np.ndarray],
    widths: list[np.ndarray],
    matrix: np.ndarray,
    options: Any,
    *,
    like: bpy.types.Object | None = None,
) -> bpy.types.Object:
    """Make a live body of one closed outline and its holes, with an outline object inside; return the body.

    rings : closed outlines (n, 2) or (n, 3), in the body's space, the first one around the others. widths : radius
    (n,) of the line at each point. matrix : (4, 4) from the body's space to the world. options : an operator, or
    another body's properties, with the options that the body gets. like : an object whose name and collections the
    body gets; None: the active collection, or one around it that is shown.

    Raises
    ------
    OutlineError
        If that has no body; then nothing is changed.
    """
    with placing.Transaction() as transaction:
        name = "Body" if like is None else like.name
        homes = [placing.home(context, transaction)] if like is None else like.users_collection
        ob = transaction.new(bpy.data.objects, name, transaction.new(bpy.data.meshes, name))
        ob.matrix_basis = Matrix(matrix.tolist())
        source = drawn(transaction, rings, widths, name, context.scene.frame_current)
        for one in homes:
            one.objects.link(ob)
            one.objects.link(source)
        frames.nest(source, ob, np.eye(4))
        written.sign(ob.data)
        stroke = Stroke(np.zeros((0, 3)), True, source.name, LAYER, 0, len(rings))
        frames.remember(ob, np.eye(4))
        engine.link(ob, stroke, source, options, follow=False)
        ob.gridmesh_live.pen = options.pen
        engine.remake(ob)
        if ob.gridmesh_live.problem:
            raise OutlineError(ob.gridmesh_live.problem)
        ob.gridmesh_live.enabled = True
    return ob
