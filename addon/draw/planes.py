# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a stroke in the viewport lies in space."""

from __future__ import annotations

import bpy
import numpy as np
from bpy_extras import view3d_utils
from mathutils import Vector

from ..bodies.outlines import Plane

CHOICES = [
    ("VIEW", "View", "Facing the view, through the 3D cursor"),
    ("CURSOR", "Cursor", "Plane of the 3D cursor's X and Y"),
    ("SURFACE", "Surface", "Tangent to the surface where the stroke begins; facing the view beside surfaces"),
    ("X", "X Axis", "Across the X axis, through the 3D cursor"),
    ("Y", "Y Axis", "Across the Y axis, through the 3D cursor"),
    ("Z", "Z Axis", "Across the Z axis, through the 3D cursor"),
]

EDGE_ON = 0.05
"""Planes seen at a smaller sine cannot be drawn on."""


class PlaneError(ValueError):
    """The plane cannot be drawn on. The message says why."""


def ray(context: bpy.types.Context, pixel: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Origin and direction of the sight line through a pixel of the region."""
    region, view = context.region, context.region_data
    origin = view3d_utils.region_2d_to_origin_3d(region, view, pixel)
    direction = view3d_utils.region_2d_to_vector_3d(region, view, pixel)
    return np.array(origin, float), np.array(direction, float)


def chosen(context: bpy.types.Context, choice: str, pixel: tuple[float, float]) -> Plane:
    """Return the plane for a stroke that begins at a pixel; its normal faces the viewer.

    Raises
    ------
    PlaneError
        If it is seen edge on.
    """
    origin, direction = ray(context, pixel)
    cursor = context.scene.cursor
    point, normal = np.array(cursor.location, float), None
    if choice == "CURSOR":
        normal = np.array(cursor.matrix.to_3x3().col[2], float)
    elif choice in "XYZ":
        normal = np.eye(3)["XYZ".index(choice)]
    elif choice == "SURFACE":
        depsgraph = context.evaluated_depsgraph_get()
        hit, place, facing, *_ = context.scene.ray_cast(depsgraph, Vector(origin), Vector(direction))
        if hit:
            point, normal = np.array(place, float), np.array(facing, float)
    if normal is None:
        normal = np.array(context.region_data.view_rotation @ Vector((0, 0, 1)), float)
    normal = normal / np.linalg.norm(normal)
    sine = float(normal @ direction)
    if abs(sine) < EDGE_ON:
        raise PlaneError("the plane is seen edge on; turn the view or choose another plane")
    if sine > 0:
        normal = -normal
    right = np.array(context.region_data.view_rotation @ Vector((1, 0, 0)), float)
    x = right - normal * (right @ normal)
    if np.linalg.norm(x) < 1e-6:
        x = np.cross(normal, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    return Plane(point, np.stack([x, np.cross(normal, x), normal]))


def on_plane(context: bpy.types.Context, plane: Plane, pixel: tuple[float, float]) -> np.ndarray | None:
    """Point (2,) of the plane that is seen at a pixel; None if it is behind the viewer or edge on."""
    origin, direction = ray(context, pixel)
    normal = plane.axes[2]
    sine = float(normal @ direction)
    if abs(sine) < 1e-6:
        return None
    along = float(normal @ (plane.origin - origin)) / sine
    if along < 0 and context.region_data.is_perspective:
        return None
    return plane.local(origin + along * direction)[:2]
