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
import json
import math
import time
from pathlib import Path

import studio

# isort: split
import bpy
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

INK = "#20242C"
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
    ink.grease_pencil.color = studio.linear(INK)
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


# ------------------------------------------------------------------------------------------------ the job


def build(paths: list[Path], triangles: int, pixels: int, samples: int) -> list[dict]:
    """Fill the scene; returns one row of numbers for each drawing."""
    columns = min(5, len(paths))
    rows = math.ceil(len(paths) / columns)
    width, height = COLUMN * columns + 0.25, ROW * rows + 0.2
    ink, grey = studio.plain_material("Ink", INK), studio.plain_material("Label", "#6B6A66")
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
        body.location.y -= 1.16 + rise * math.tan(studio.TILT)
        body.data.materials.clear()
        body.data.materials.append(
            studio.body_material(name, COLOURS[k % len(COLOURS)], 0.55 * pixels / 2000)
        )
        ink_line(stroke, points, ink)
        text = f"{numbers['triangles']} triangles, {numbers['irregular']} irregular vertices"
        studio.label(text, (x, y - 1.16), 0.06, grey)
        table.append({"name": name, **numbers, "ms": 1000 * seconds})
    studio.set_stage(width, height, pixels, samples)
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
    table = build(paths, choice.triangles, choice.width, choice.samples)

    choice.out.mkdir(parents=True, exist_ok=True)
    blend, picture = choice.out / "gridmesh.blend", choice.out / "gridmesh.png"
    print("Rendering ...", flush=True)
    with studio.quiet():
        bpy.ops.wm.save_as_mainfile(filepath=str(blend.resolve()), check_existing=False)
    studio.render(picture)
    show(table)
    print(f"{blend}\n{picture}")


if __name__ == "__main__":
    studio.run(main)
