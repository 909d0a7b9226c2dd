# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of what was made, beside it: from the front and above, on grey."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from .outputs import OutputError, safely

ENGINES = ("workbench", "cycles")
"""Workbench needs a graphics card, or the libraries that stand in for one; Cycles needs neither."""

_AWAY = Vector((0.5, -1.0, 0.6)).normalized()
"""From the middle of the picture to the eye. Drawings lie in the plane z = 0 or stand in y = 0: both are seen."""


def render(path: Path, objects: list[bpy.types.Object], engine: str, size: int = 512) -> None:
    """Write a picture of the objects alone.

    Raises
    ------
    OutputError
        If Blender cannot render here.
    """
    scene = bpy.data.scenes.new("gridmesh")
    camera = bpy.data.objects.new("gridmesh", bpy.data.cameras.new("gridmesh"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    for ob in objects:
        scene.collection.objects.link(ob)
    try:
        _aim(camera, scene.view_layers[0], objects)
        _light(scene, engine)
        settings = scene.render
        settings.resolution_x = settings.resolution_y = size
        settings.resolution_percentage = 100
        settings.image_settings.file_format = "PNG"

        def make(draft: Path) -> None:
            settings.filepath = str(draft)
            if bpy.ops.render.render(write_still=True, scene=scene.name) != {"FINISHED"}:
                raise OutputError("Blender did not render")

        safely(path, make)
    finally:
        own = [ob for ob in scene.collection.objects if ob not in objects]
        bpy.data.batch_remove([scene, *own, *(ob.data for ob in own), *filter(None, [scene.world])])


def _aim(camera: bpy.types.Object, layer: bpy.types.ViewLayer, objects: list[bpy.types.Object]) -> None:
    """Put the camera so that it sees all corners of the objects' bounding boxes."""
    corners = [ob.matrix_world @ Vector(corner) for ob in objects for corner in ob.bound_box]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    size = max(float(np.linalg.norm(high - low)), 1e-6)
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 1.05 * size
    camera.data.clip_start, camera.data.clip_end = 0.01 * size, 10 * size
    turn = _AWAY.to_track_quat("Z", "Y")
    sides = np.array(corners) @ np.array(turn.to_matrix())
    extent = np.ptp(sides[:, :2], axis=0)
    camera.data.ortho_scale = 1.1 * max(float(extent.max()), 1e-6)
    camera.matrix_world = turn.to_matrix().to_4x4()
    middle = (sides.min(axis=0) + sides.max(axis=0)) / 2
    camera.location = turn @ Vector(middle) + 3 * size * _AWAY
    layer.update()


def _light(scene: bpy.types.Scene, engine: str) -> None:
    scene.view_settings.view_transform = "Standard"
    if engine == "workbench":
        scene.render.engine = "BLENDER_WORKBENCH"
        shading = scene.display.shading
        shading.light, shading.color_type = "STUDIO", "SINGLE"
        shading.single_color = (0.6, 0.6, 0.6)
        shading.show_cavity = True
        return
    import addon_utils

    if addon_utils.enable("cycles", default_set=False) is None:
        raise OutputError("this Blender has no Cycles")
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 16
    scene.cycles.use_denoising = False
    scene.world = bpy.data.worlds.new("gridmesh")
    sun = bpy.data.objects.new("gridmesh sun", bpy.data.lights.new("gridmesh", "SUN"))
    sun.data.energy = 3.0
    sun.rotation_euler = (0.7, 0.2, 0.4)
    scene.collection.objects.link(sun)
