# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "gridmesh", "numpy==1.26.4"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = ".." }
# ///
"""From drawings to bodies, in Blender: grease-pencil strokes, the operator, a .blend, a picture, a table.

    uv run docs/gallery.py [SKETCH.json ...]

Each sketch is drawn as a grease-pencil stroke, and `object.gridmesh_from_strokes` makes a body of it. Leaves
`out/gridmesh.blend`, with every stroke above its body, and `out/gridmesh.png`, the picture of it.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import sys
import tempfile
import time
import traceback
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
DRAWINGS = [
    "whale",
    "guitar",
    "camel",
    "puzzle",
    "letter",
    "octopus",
    "frog",
    "brazil",
    "snowflake",
    "ampersand",
]

COLUMN, ROW, SIZE = 1.24, 2.62, 1.0
"""Width and height of a cell, and the size of a drawing in it."""

TILT = math.radians(20)
"""How far the camera leans back from looking straight down."""

PAPER, INK, WIRE = "#F3EFE6", "#20242C", "#1B2030"
COLOURS = [
    "#5AA9C9",
    "#E0873A",
    "#D9B04F",
    "#7FAE63",
    "#C8606C",
    "#9C7BC0",
    "#66B08A",
    "#E3B23C",
    "#7D9FD4",
    "#D97B93",
]


def read_sketch(path: Path) -> tuple[str, np.ndarray]:
    """Name and points, (n, 2), scaled to fit a square of `SIZE` around the origin."""
    sketch = json.loads(path.read_text(encoding="utf-8"))
    points = np.array(sketch["points"], float)
    low, high = points.min(axis=0), points.max(axis=0)
    return sketch["name"], (points - (low + high) / 2) * (SIZE / (high - low).max())


def linear(colour: str, alpha: float = 1.0) -> tuple[float, float, float, float]:
    """A web colour as Blender's linear one."""
    channels = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    return (*(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels), alpha)


# --------------------------------------------------------------------------------------- strokes and bodies


def draw_stroke(name: str, points: np.ndarray, at: tuple[float, float]):
    """A grease-pencil object with one closed stroke in the plane z = 0."""
    data = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new(name)
    stroke = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(stroke)
    drawing = data.layers.new("Lines", set_active=True).frames.new(1).drawing
    drawing.add_strokes([len(points)])
    place = np.column_stack([points, np.zeros(len(points))]).astype(np.float32)
    drawing.attributes["position"].data.foreach_set("vector", place.ravel())
    radius = drawing.attributes.get("radius") or drawing.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.full(len(points), 0.006, np.float32))
    drawing.strokes[0].cyclic = True
    drawing.tag_positions_changed()
    ink = bpy.data.materials.new(f"{name} ink")
    bpy.data.materials.create_gpencil_data(ink)
    ink.grease_pencil.color = linear(INK)
    data.materials.append(ink)
    stroke.location = (*at, 0.0)
    return stroke


def inflate_stroke(stroke, triangles: int):
    """The object that the operator makes of a stroke, and how long it took in seconds."""
    bpy.context.view_layer.update()
    for other in bpy.context.selected_objects:
        other.select_set(False)
    stroke.select_set(True)
    bpy.context.view_layer.objects.active = stroke
    before = set(bpy.data.objects)
    started = time.perf_counter()
    bpy.ops.object.gridmesh_from_strokes(triangles=triangles)
    seconds = time.perf_counter() - started
    (body,) = set(bpy.data.objects) - before
    return body, seconds


def measure(body, points: np.ndarray, stroke) -> dict[str, float]:
    """Numbers about a body, taken from Blender's mesh alone."""
    mesh = body.data
    vertices = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", vertices.ravel())
    corners = np.empty((len(mesh.polygons), 3), np.int32)
    mesh.loops.foreach_get("vertex_index", corners.ravel())
    edges = np.empty((len(mesh.edges), 2), np.int32)
    mesh.edges.foreach_get("vertices", edges.ravel())
    vertices = vertices.astype(float)
    sides = vertices[np.roll(corners, -1, axis=1)] - vertices[corners]
    lengths = np.linalg.norm(sides, axis=2)
    cosines = -(sides * np.roll(sides, 1, axis=1)).sum(axis=2) / (lengths * np.roll(lengths, 1, axis=1))
    valence = np.bincount(edges.ravel(), minlength=len(vertices))
    # The silhouette lies in the drawing plane, which is the object's own z = 0.
    rim = edges[(vertices[edges, 2] == 0).all(axis=1)]
    world = np.array(stroke.matrix_world)
    local = np.linalg.inv(np.array(body.matrix_world)) @ world
    drawn = (np.column_stack([points, np.zeros(len(points)), np.ones(len(points))]) @ local.T)[:, :2]
    start, end = vertices[rim[:, 0], :2], vertices[rim[:, 1], :2]
    edge = np.linalg.norm(end - start, axis=1).mean()
    off = max(
        farthest(drawn, start, end),
        farthest((start + end) / 2, drawn, np.roll(drawn, -1, axis=0)),
    )
    return {
        "triangles": len(corners),
        "irregular": int((valence != 6).sum()),
        "percent": 100 * (valence != 6).mean(),
        "angle": math.degrees(np.arccos(np.clip(cosines, -1, 1)).min()),
        "deviation": off / edge,
    }


def farthest(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    """Largest distance of a point to the nearest segment."""
    nearest = np.full(len(points), np.inf)
    for a, d in zip(start, end - start, strict=True):
        t = np.clip(((points - a) @ d) / max(d @ d, 1e-30), 0, 1)
        nearest = np.minimum(nearest, np.linalg.norm(points - a - t[:, None] * d, axis=1))
    return float(nearest.max())


# --------------------------------------------------------------------------------------------- the picture


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


def ink_line(stroke, points: np.ndarray, material):
    """The stroke as a thin tube for the picture: Cycles cannot draw grease pencil without a GPU."""
    curve = bpy.data.curves.new(f"{stroke.name} ink", "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = 0.0065
    curve.bevel_resolution = 2
    curve.materials.append(material)
    spline = curve.splines.new("POLY")
    spline.points.add(len(points) - 1)
    place = np.column_stack([points, np.zeros(len(points)), np.ones(len(points))])
    spline.points.foreach_set("co", place.astype(np.float32).ravel())
    spline.use_cyclic_u = True
    line = bpy.data.objects.new(curve.name, curve)
    bpy.context.scene.collection.objects.link(line)
    line.parent = stroke
    line.hide_viewport = True
    stroke.hide_render = True
    return line


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


# ------------------------------------------------------------------------------------------------ the job


def build(paths: list[Path], triangles: int, pixels: int, samples: int) -> list[dict]:
    """Fill the scene; returns one row of numbers for each drawing."""
    columns = min(5, len(paths))
    rows = math.ceil(len(paths) / columns)
    width, height = COLUMN * columns + 0.25, ROW * rows + 0.2
    ink, grey = plain_material("Ink", INK), plain_material("Label", "#6B6A66")
    table = []
    for k, path in enumerate(paths):
        name, points = read_sketch(path)
        x = (k % columns - (columns - 1) / 2) * COLUMN
        y = ((rows - 1) / 2 - k // columns) * ROW
        stroke = draw_stroke(name, points, (x, y + 0.72))
        body, seconds = inflate_stroke(stroke, triangles)
        numbers = measure(body, points, stroke)
        body.name = f"{name} body"
        # It lies on the paper; the lean of the camera shows it higher up than it is.
        rise = -min(corner[2] for corner in body.bound_box)
        body.location.z += rise
        body.location.y -= 1.16 + rise * math.tan(TILT)
        body.data.materials.clear()
        body.data.materials.append(body_material(name, COLOURS[k % len(COLOURS)], 0.55 * pixels / 2000))
        ink_line(stroke, points, ink)
        text = f"{numbers['triangles']} triangles, {numbers['irregular']} irregular vertices"
        label(text, (x, y - 1.16), 0.06, grey)
        table.append({"name": name, **numbers, "ms": 1000 * seconds})
    set_stage(width, height, pixels, samples)
    return table


def show(table: list[dict]) -> None:
    """Print the numbers as a table."""
    print(
        f"\n{'drawing':<12}{'triangles':>10}{'irregular':>11}{'%':>7}{'min angle':>11}{'deviation':>11}{'ms':>8}"
    )
    for row in table:
        print(
            f"{row['name']:<12}{row['triangles']:>10}{row['irregular']:>11}{row['percent']:>7.2f}"
            f"{row['angle']:>10.1f}°{row['deviation']:>9.2f} h{row['ms']:>8.1f}"
        )
    print(
        "irregular: vertices whose valence is not 6; min angle: of the inflated triangles; deviation: largest\n"
        "distance between drawing and silhouette, in edge lengths h; ms: the whole operator, once, cold\n"
    )


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


def main() -> None:
    """Run the job that the module's text describes."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sketch", nargs="*", type=Path, help="sketch files; ten drawings if none is given")
    parser.add_argument("--out", type=Path, default=ROOT / "out", help="folder for the results")
    parser.add_argument("--triangles", type=int, default=2000, help="triangles of each flat patch")
    parser.add_argument("--width", type=int, default=2000, help="width of the picture in pixels")
    parser.add_argument("--samples", type=int, default=6, help="render samples for each pixel")
    choice = parser.parse_args()
    paths = choice.sketch or [ROOT / "tests/sketches/drawings" / f"{name}.json" for name in DRAWINGS]
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    addon.register()
    table = build(paths, choice.triangles, choice.width, choice.samples)

    choice.out.mkdir(parents=True, exist_ok=True)
    blend, picture = choice.out / "gridmesh.blend", choice.out / "gridmesh.png"
    bpy.context.scene.render.filepath = str(picture.resolve())
    print("Rendering ...", flush=True)
    with quiet():
        bpy.ops.wm.save_as_mainfile(filepath=str(blend.resolve()), check_existing=False)
        bpy.ops.render.render(write_still=True)
    addon.unregister()
    show(table)
    print(f"{blend}\n{picture}")


if __name__ == "__main__":
    sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
    import system_libraries

    system_libraries.ensure()
    # Before Blender is imported: the user's own settings and add-ons stay out of it.
    os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-")
    import bpy

    import addon

    status = 1
    try:
        main()
        status = 0
    except Exception:
        traceback.print_exc()
    finally:
        # Blender 4.5 as a module may crash or hang while it cleans up after Python.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
