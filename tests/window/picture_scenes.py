"""Pictures become meshes. Runs inside Blender."""

import bpy
import numpy as np
from setting import fresh, mesh_objects, stage


def picture():
    """A picture becomes a body; its panel says where the picture is to be seen."""
    yield from fresh()
    values = np.zeros((64, 64, 4), np.float32)
    x, y = np.meshgrid(np.linspace(-1, 1, 64), np.linspace(-1, 1, 64))
    inside = x**2 + y**2 < 0.7 + 0.2 * np.cos(5 * np.arctan2(y, x))
    values[inside] = (0.9, 0.4, 0.1, 1.0)
    image = bpy.data.images.new("Star", 64, 64, alpha=True)
    image.pixels.foreach_set(values.ravel())
    image.pack()
    shown = bpy.data.objects.new("Star", None)
    shown.empty_display_type = "IMAGE"
    shown.data, shown.empty_display_size = image, 3.0
    shown.rotation_euler.x = np.pi / 2
    bpy.context.scene.collection.objects.link(shown)
    shown.select_set(True)
    bpy.context.view_layer.objects.active = shown
    yield from stage.open_sidebar()
    yield from stage.press_button("UI", "gridmesh_from_image")
    (body,) = mesh_objects()
    assert shown.hide_get()
    assert len(body.data.polygons) > 500
    yield from stage.open_redo_panel()
    yield from stage.picture("picture_1_gray")
    stage.view.spaces.active.shading.color_type = "TEXTURE"
    yield 0.5
    yield from stage.picture("picture_2_shown")


SCENES = (picture,)
