# SPDX-License-Identifier: GPL-3.0-or-later
"""The profile curve of a body: drawn by hand, stored with the body.

Blender lets no extension store curves of its own, but modifiers have some. So the curve is that of a modifier that is
switched off and does nothing: it belongs to the body, is copied, appended, undone and deleted with it, and nothing is
left over; and a change of it in the panel is a change of the body, which follows.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import bpy
import numpy as np

NAME = "GridMesh Profile"
"""Of the modifier."""

SAMPLES = 33

LEAST = 0.01
"""Heights are at least this part of the largest one, so that front and back stay apart."""

Points = tuple[tuple[float, float, str], ...]
"""Places of the points in the unit square, and the kinds of their handles."""

SHAPES: dict[str, Points] = {
    "ROUND": ((0, 0, "AUTO"), (1, 1, "AUTO")),
    "PLATEAU": ((0, 0, "AUTO"), (0.25, 0.55, "AUTO"), (0.55, 0.92, "AUTO"), (1, 1, "AUTO")),
    "POINTED": ((0, 0, "AUTO"), (0.5, 0.2, "AUTO"), (0.8, 0.5, "AUTO"), (1, 1, "AUTO")),
    "RING": ((0, 0, "AUTO"), (0.4, 0.6, "AUTO"), (0.72, 1, "AUTO"), (0.9, 0.72, "AUTO"), (1, 0.35, "AUTO")),
    "HAT": ((0, 0, "AUTO"), (0.25, 0.22, "AUTO"), (0.6, 0.28, "AUTO"), (0.8, 0.6, "AUTO"), (1, 1, "AUTO")),
}
"""To start from."""

ITEMS = (
    ("PLATEAU", "Plateau", "Steep at the rim, level on top"),
    ("POINTED", "Pointed", "Flat at the rim, with a point in the middle"),
    ("RING", "Ring", "Highest around a hollow in the middle"),
    ("HAT", "Hat", "A dome with a brim"),
)
"""Those that change the profile, as Blender's lists want them."""


def holder(ob: bpy.types.Object) -> bpy.types.Modifier | None:
    """Return the modifier of a body whose curve is that of its profile; None if it has none."""
    # The name has a number where another modifier has it already.
    own = (one for one in ob.modifiers if one.type == "VERTEX_WEIGHT_EDIT" and one.name.startswith(NAME))
    return next(own, None)


def points(ob: bpy.types.Object | None) -> Points | None:
    """Points of a body's curve; None if it has none."""
    found = holder(ob) if ob is not None else None
    if found is None:
        return None
    return tuple((*point.location, point.handle_type) for point in found.map_curve.curves[0].points)


def put(ob: bpy.types.Object, wanted: Points) -> None:
    """Give a body a curve, in place of the one it has."""
    found = holder(ob)
    if found is None:
        found = ob.modifiers.new(NAME, "VERTEX_WEIGHT_EDIT")
        found.show_viewport = found.show_render = found.show_in_editmode = found.show_expanded = False
        found.falloff_type = "CURVE"
    mapping = found.map_curve
    there = mapping.curves[0].points
    while len(there) > 2:
        there.remove(there[1])
    for point, place in ((there[0], wanted[0]), (there[1], wanted[-1])):
        point.location, point.handle_type = place[:2], place[2]
    for x, y, kind in wanted[1:-1]:
        there.new(x, y).handle_type = kind
    mapping.update()
    ob.update_tag()


def remove(ob: bpy.types.Object) -> None:
    """Take the curve away."""
    found = holder(ob)
    if found is not None:
        ob.modifiers.remove(found)


def values(ob: bpy.types.Object) -> list[float] | None:
    """Return `curve` of `gridmesh.inflate` for a body; None without a curve, and for one that changes nothing."""
    found = holder(ob)
    return None if found is None else _sampled(found.map_curve)


@cache
def values_of(wanted: Points) -> tuple[float, ...] | None:
    """Return the values of a curve that no body has: those that it will have on a body."""
    mesh = bpy.data.meshes.new(NAME)
    ob = bpy.data.objects.new(NAME, mesh)
    try:
        put(ob, wanted)
        found = values(ob)
    finally:
        bpy.data.objects.remove(ob)
        bpy.data.meshes.remove(mesh)
    return None if found is None else tuple(found)


def _sampled(mapping: Any) -> list[float] | None:
    mapping.initialize()
    curve = mapping.curves[0]
    places = np.linspace(0.0, 1.0, SAMPLES)
    heights = np.array([mapping.evaluate(curve, float(x)) for x in places])
    if np.abs(heights - places).max() < 1e-4:
        return None
    heights = np.maximum(heights, LEAST)
    heights[0] = 0.0
    # Blender computes in single precision: what it adds by chance is cut off.
    return [float(height) for height in np.round(heights, 6)]
