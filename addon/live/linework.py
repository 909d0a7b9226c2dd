# SPDX-License-Identifier: GPL-3.0-or-later
"""Outline objects: grease pencil objects of closed strokes that belong to a body, thin and not rendered."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..bodies.outlines import Sketch
from ..data import placing

LAYER = "Outline"

RADIUS = 0.0015
"""Radius of the line at full pressure, in parts of the outline's size: less than two pixels in a third of a view."""

INK = "GridMesh Outline"
"""Name of the material of outlines."""

INK_COLOR = (0.01, 0.01, 0.01, 1.0)


def radii(pressures: np.ndarray, size: float) -> np.ndarray:
    """Radius (n,) of the line from the pressure (n,) of the pen, 0 to 1, in an outline of a size."""
    return RADIUS * size * np.clip(pressures, 0.02, 1.0)


def drawn(
    transaction: placing.Transaction, rings: list[np.ndarray], widths: list[np.ndarray], name: str, at: int
) -> bpy.types.Object:
    """Make an outline object of closed strokes, without linking it to a collection.

    rings, widths : see `write`. name : of its body. at : the frame that it is on.
    """
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


def redrawn(
    transaction: placing.Transaction, sketch: Sketch, name: str, at: int
) -> tuple[bpy.types.Object, int]:
    """Make an outline object of a sketch and its holes; return it and its number of strokes."""
    parts = [sketch, *sketch.holes]
    rings = [one.plane.world(np.column_stack([one.outline, np.zeros(len(one.outline))])) for one in parts]
    widths = [_widths(one) for one in parts]
    return drawn(transaction, rings, widths, name, at), len(parts)


def _widths(sketch: Sketch) -> np.ndarray:
    """Radius (n,) at each point of an outline: that of the drawn point which is nearest."""
    widths = sketch.stroke.widths
    if widths is None or len(widths) != len(sketch.stroke.points):
        return np.full(len(sketch.outline), RADIUS * sketch.size)
    return nearest(sketch.outline, sketch.plane.local(sketch.stroke.points)[:, :2], widths)


def nearest(ring: np.ndarray, known: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Value (n,) at each point of a ring (n, 2): that of the known point (m, 2) which is nearest."""
    out = np.empty(len(ring))
    for at in range(0, len(ring), 256):
        apart = ring[at : at + 256, None] - known[None]
        out[at : at + 256] = values[np.einsum("ijk,ijk->ij", apart, apart).argmin(axis=1)]
    return out


def _ink(transaction: placing.Transaction) -> bpy.types.Material:
    found = bpy.data.materials.get(INK)
    if found is not None and found.is_grease_pencil and found.is_editable:
        return found
    ink = transaction.new(bpy.data.materials, INK)
    bpy.data.materials.create_gpencil_data(ink)
    ink.grease_pencil.color = INK_COLOR
    return ink


def write(drawing: Any, gone: list[int], rings: list[np.ndarray], widths: list[np.ndarray]) -> None:
    """Take strokes out of a drawing and append closed ones.

    rings : (n, 2) or (n, 3) in the layer's space. widths : radius (n,) of the line at each point.
    """
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


def remove(source: bpy.types.Object) -> None:
    """Remove an outline object, and its data if nobody else has it."""
    data = source.data
    bpy.data.objects.remove(source)
    if data is not None and not data.users:
        bpy.data.batch_remove([data])
