# SPDX-License-Identifier: GPL-3.0-or-later
"""Planes at which a mesh is open because its mirror image goes on there."""

from __future__ import annotations

import bpy
import numpy as np


def mirror_planes(ob: bpy.types.Object) -> tuple[list[tuple[np.ndarray, np.ndarray]], float]:
    """Planes of the Mirror modifiers that join both halves there, about the object's origin; and how far off they do."""
    planes, within = [], 0.0
    for modifier in ob.modifiers:
        if modifier.type != "MIRROR" or not modifier.show_viewport or not modifier.use_mirror_merge:
            continue
        about = modifier.mirror_object or ob
        linear = np.array(about.matrix_world.to_3x3(), float)
        if abs(np.linalg.det(linear)) < 1e-30:
            continue  # it mirrors to nothing
        point = np.array(about.matrix_world.translation - ob.matrix_world.translation, float)
        for axis in range(3):
            if modifier.use_axis[axis]:
                normal = np.linalg.inv(linear)[axis]
                length = float(np.linalg.norm(normal))
                planes.append((point, normal / length))
                within = max(within, modifier.merge_threshold / length)
    return planes, within
