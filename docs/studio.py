"""What the scripts of pictures share: Blender as a module with the extension, paper, light, materials, plain files.

Importing it makes ready what `import bpy` needs, so it comes before `bpy`. The user's own settings and add-ons stay out.
"""

from __future__ import annotations

import contextlib
import math
import os
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

import system_libraries  # noqa: E402

system_libraries.ensure()
os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-")

import bpy  # noqa: E402

import addon  # noqa: E402

PAPER, INK, WIRE = "#F3EFE6", "#20242C", "#1B2030"
TILT = math.radians(20)
"""How far the camera leans back from looking straight down."""


def linear(colour: str, alpha: float = 1.0) -> tuple[float, float, float, float]:
    """A web colour as Blender's linear one."""
    channels = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    return (*(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels), alpha)


# ------------------------------------------------------------------------------------------- paper, materials


def node_material(name: str, colour: str):
    """An empty node tree and the output's surface socket."""
    material = bpy.data.materials.new(name)
    material.diffuse_color = linear(colour)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    return material, tree, tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]


def body_material(name: str, colour: str, pixels: float):
    """Clay of a colour, with the edges of the triangles as thin lines."""
    material, tree, surface = node_material(name, colour)
    clay = tree.nodes.new("ShaderNodeBsdfPrincipled")
    clay.inputs["Base Color"].default_value = linear(colour)
    clay.inputs["Roughness"].default_value = 0.42
    lines = tree.nodes.new("ShaderNodeBsdfDiffuse")
    lines.inputs["Color"].default_value = linear(WIRE)
    wire = tree.nodes.new("ShaderNodeWireframe")
    wire.use_pixel_size = True
    wire.inputs["Size"].default_value = pixels
    soft = tree.nodes.new("ShaderNodeMath")
    soft.operation = "MULTIPLY"
    soft.inputs[1].default_value = 0.8
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(wire.outputs["Fac"], soft.inputs[0])
    tree.links.new(soft.outputs["Value"], mix.inputs["Fac"])
    tree.links.new(clay.outputs["BSDF"], mix.inputs[1])
    tree.links.new(lines.outputs["BSDF"], mix.inputs[2])
    tree.links.new(mix.outputs["Shader"], surface)
    return material


def plain_material(name: str, colour: str):
    """One matt colour."""
    material, tree, surface = node_material(name, colour)
    matt = tree.nodes.new("ShaderNodeBsdfDiffuse")
    matt.inputs["Color"].default_value = linear(colour)
    tree.links.new(matt.outputs["BSDF"], surface)
    return material


def label(text: str, at: tuple[float, float], size: float, material) -> None:
    """A line of text on the paper, centred."""
    curve = bpy.data.curves.new(text, "FONT")
    curve.body = text
    curve.align_x = "CENTER"
    curve.size = size
    curve.materials.append(material)
    line = bpy.data.objects.new(text, curve)
    bpy.context.scene.collection.objects.link(line)
    line.location = (*at, 0.001)


def set_stage(width: float, height: float, pixels: int, samples: int) -> None:
    """Paper, light, camera and render settings for a page of this size around the origin, so many pixels wide."""
    scene = bpy.context.scene
    paper = bpy.data.meshes.new("Paper")
    far = 20 * max(width, height)
    paper.from_pydata([(-far, -far, 0), (far, -far, 0), (far, far, 0), (-far, far, 0)], [], [(0, 1, 2, 3)])
    paper.materials.append(plain_material("Paper", PAPER))
    ground = bpy.data.objects.new("Paper", paper)
    ground.hide_select = True
    scene.collection.objects.link(ground)

    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle, sun.color = 2.6, 0.35, (1.0, 0.96, 0.9)
    light = bpy.data.objects.new("Sun", sun)
    light.rotation_euler = (math.radians(38), math.radians(-30), 0)
    scene.collection.objects.link(light)
    world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    sky = world.node_tree.nodes["Background"]
    sky.inputs["Color"].default_value = linear("#DCE6F2")
    sky.inputs["Strength"].default_value = 0.62
    scene.world = world

    lens = bpy.data.cameras.new("Camera")
    lens.type = "ORTHO"
    seen_height = height * math.cos(TILT)
    # Blender fits the longer side of the picture.
    lens.ortho_scale = max(width, seen_height)
    camera = bpy.data.objects.new("Camera", lens)
    distance = 3 * lens.ortho_scale
    lens.clip_end = 100 * distance
    camera.location = (0, -distance * math.sin(TILT), distance * math.cos(TILT))
    camera.rotation_euler = (TILT, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera

    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = pixels, round(pixels * seen_height / width)
    render.image_settings.file_format = "PNG"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = True
    scene.cycles.denoising_prefilter = "FAST"
    scene.cycles.max_bounces = 1
    scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    scene.view_settings.view_transform = "Standard"


# ---------------------------------------------------------------------------------------- running, rendering


def run(main: Callable[[], None]) -> NoReturn:
    """Call `main` in an empty scene with the extension registered; the process ends with 1 if it raises."""
    status = 1
    try:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        addon.register()
        main()
        addon.unregister()
        status = 0
    except SystemExit as ended:
        status = ended.code if isinstance(ended.code, int) else 1
        if isinstance(ended.code, str):
            print(ended.code, file=sys.stderr)
    except Exception:
        traceback.print_exc()
    finally:
        # Blender 4.5 as a module may crash or hang while it cleans up after Python.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def render(picture: Path) -> None:
    """Render the scene into a PNG that holds nothing but the picture: no path, no date, no name."""
    settings = bpy.context.scene.render
    settings.image_settings.file_format = "PNG"
    settings.image_settings.color_mode, settings.image_settings.compression = "RGB", 100
    settings.filepath = str(picture.resolve())
    with quiet():
        bpy.ops.render.render(write_still=True)
    picture.write_bytes(bare(picture.read_bytes()))


def bare(png: bytes) -> bytes:
    """A PNG with the chunks of its picture alone (those that a decoder must know, by their capital letter)."""
    kept, at = [png[:8]], 8
    while at < len(png):
        end = at + 12 + int.from_bytes(png[at : at + 4], "big")
        if png[at + 4 : at + 5].isupper():
            kept.append(png[at:end])
        at = end
    return b"".join(kept)


@contextlib.contextmanager
def quiet():
    """Keep Blender's own messages, written by C code line by line, off the screen."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = os.dup(1), os.dup(2)
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for number, kept_one in enumerate(kept, 1):
            os.dup2(kept_one, number)
            os.close(kept_one)
