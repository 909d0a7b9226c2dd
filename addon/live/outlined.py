# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies with an outline of their own: a grease pencil object inside them, in their own space, which is not rendered."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from .. import frames, meshes
from ..outlines import Stroke
from . import engine

LAYER = "Outline"

RADIUS = 0.0015
"""Radius of the line at full pressure, in parts of the outline's size: some pixels less than two in a third of a view."""

INK = "GridMesh Outline"
"""Name of the material of outlines."""

INK_COLOR = (0.01, 0.01, 0.01, 1.0)


class OutlineError(ValueError):
    """Outlines have no body. The message says why; nothing was changed."""


def radii(pressures: np.ndarray, size: float) -> np.ndarray:
    """Radius (n,) of the line from the pressure (n,) of the pen, 0 to 1, in an outline of a size."""
    return RADIUS * size * np.clip(pressures, 0.02, 1.0)


def make(
    context: bpy.types.Context,
    rings: list[np.ndarray],
    widths: list[np.ndarray],
    matrix: np.ndarray,
    options: Any,
    *,
    name: str = "Body",
    collections: list[bpy.types.Collection] | None = None,
) -> bpy.types.Object:
    """Make a live body of one closed outline and its holes, with an outline object inside; return the body.

    rings : closed outlines (n, 2) or (n, 3), in the body's space, the first one around the others. widths : radius
    (n,) of the line at each point. matrix : (4, 4) from the body's space to the world. options : an operator, or
    another body's properties, with the options that the body gets. collections : where the objects go; None: the
    active collection, or one around it that is shown.

    Raises
    ------
    OutlineError
        If that has no body; then nothing is changed.
    """
    with meshes.Transaction() as transaction:
        homes = collections or [meshes.home(context, transaction)]
        ob = transaction.new(bpy.data.objects, name, transaction.new(bpy.data.meshes, name))
        ob.matrix_basis = Matrix(matrix.tolist())
        source = drawn(transaction, rings, widths, name, context.scene.frame_current)
        for one in homes:
            one.objects.link(ob)
            one.objects.link(source)
        frames.nest(source, ob, np.eye(4))
        meshes.sign(ob.data)
        stroke = Stroke(np.zeros((0, 3)), True, source.name, LAYER, 0, len(rings))
        frames.remember(ob, np.eye(4))
        engine.link(ob, stroke, source, options, follow=False)
        ob.gridmesh_live.pen = options.pen
        engine.remake(ob)
        if ob.gridmesh_live.problem:
            raise OutlineError(ob.gridmesh_live.problem)
        ob.gridmesh_live.enabled = True
    return ob


def drawn(
    transaction: meshes.Transaction, rings: list[np.ndarray], widths: list[np.ndarray], name: str, at: int
) -> bpy.types.Object:
    """Make an outline object of closed strokes, without linking it to a collection. at : the frame that it is on."""
    blocks = bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils
    data = transaction.new(blocks, f"{name} Outline")
    source = transaction.new(bpy.data.objects, f"{name} Outline", data)
    data.materials.append(_ink(transaction))
    layer = data.layers.new(LAYER, set_active=True)
    layer.frames.new(at)
    write(layer.frames[0].drawing, [], rings, widths)
    source.gridmesh_outline = True
    source.hide_render = True
    return source


def _ink(transaction: meshes.Transaction) -> bpy.types.Material:
    found = bpy.data.materials.get(INK)
    if found is not None and found.is_grease_pencil:
        return found
    ink = transaction.new(bpy.data.materials, INK)
    bpy.data.materials.create_gpencil_data(ink)
    ink.grease_pencil.color = INK_COLOR
    return ink


def write(drawing: Any, gone: list[int], rings: list[np.ndarray], widths: list[np.ndarray]) -> None:
    """Take strokes out of a drawing and append closed ones; rings : (n, 2) or (n, 3) in the layer's space."""
    if gone:
        drawing.remove_strokes(indices=sorted(gone))
    before = len(drawing.strokes)
    drawing.add_strokes([len(ring) for ring in rings])
    total = sum(len(ring) for ring in rings)
    attribute = drawing.attributes["position"]
    points = np.empty(len(attribute.data) * 3, np.float32)
    attribute.data.foreach_get("vector", points)
    new = np.concatenate(rings)
    points.reshape(-1, 3)[-total:] = 0.0
    points.reshape(-1, 3)[-total:, : new.shape[1]] = new
    attribute.data.foreach_set("vector", points)
    attribute = drawing.attributes.get("radius")
    if attribute is None:
        attribute = drawing.attributes.new("radius", "FLOAT", "POINT")
    values = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", values)
    values[-total:] = np.concatenate(widths)
    attribute.data.foreach_set("value", values)
    for stroke in list(drawing.strokes)[before:]:
        stroke.cyclic = True
    drawing.tag_positions_changed()
