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
"""The picture of edge flow, docs/pictures/quads.png: triangles, QuadriFlow on them, quads, and those subdivided twice.

    uv run docs/quads.py [SKETCH.json ...]

Dots are poles, vertices with other than four edges.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import gallery
import studio

# isort: split
import bmesh
import bpy
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
NAMES = ["whale", "guitar", "octopus"]
COLUMN, ROW = 1.16, 1.36


def made(points: np.ndarray, at: tuple[float, float], **options):
    """A body of a drawing."""
    before = set(bpy.data.objects)
    gallery.draw_stroke("Drawing", points, at).hide_render = True
    for ob in bpy.context.selected_objects:
        ob.select_set(False)
    bpy.context.view_layer.update()
    drawing = next(ob for ob in bpy.data.objects if ob not in before and ob.type != "MESH")
    drawing.select_set(True)
    bpy.context.view_layer.objects.active = drawing
    before = set(bpy.data.objects)
    bpy.ops.object.gridmesh_from_strokes(**options)
    (body,) = set(bpy.data.objects) - before
    return body


def clay(name: str, colour: str):
    """A matt material without lines."""
    material, tree, surface = studio.node_material(name, colour)
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = studio.linear(colour)
    shader.inputs["Roughness"].default_value = 0.45
    tree.links.new(shader.outputs["BSDF"], surface)
    return material


def wires(body, material) -> None:
    """The edges of a body as thin bars: the renderer's own lines show quads cut into triangles."""
    copy = body.copy()
    copy.data = body.data.copy()
    copy.data.materials.clear()
    copy.data.materials.append(material)
    bars = copy.modifiers.new("Wires", "WIREFRAME")
    bars.thickness, bars.use_relative_offset, bars.use_even_offset = 0.0032, False, False
    bpy.context.scene.collection.objects.link(copy)


def dots(body, material) -> int:
    """Mark the vertices of the front with other than four edges; return how many the whole body has."""
    edges = np.array([edge.vertices[:] for edge in body.data.edges])
    poles = np.flatnonzero(np.bincount(edges.ravel()) != 4)
    ball = bpy.data.meshes.new("Dot")
    bm = bmesh.new()
    bmesh.ops.create_icosphere(bm, subdivisions=2, radius=0.012)
    bm.to_mesh(ball)
    bm.free()
    ball.materials.append(material)
    for at in poles.tolist():
        place = body.matrix_world @ body.data.vertices[at].co
        if body.data.vertices[at].co.z >= 0:
            dot = bpy.data.objects.new("Dot", ball)
            dot.location = place
            bpy.context.scene.collection.objects.link(dot)
    return len(poles)


def build(paths: list[Path], pixels: int, samples: int) -> None:
    """Fill the scene."""
    columns = 4
    width, height = COLUMN * columns + 0.1, ROW * len(paths) + 0.15
    line, ink, red = (
        clay("Wire", studio.WIRE),
        studio.plain_material("Label", "#6B6A66"),
        clay("Pole", "#D1352B"),
    )
    for row, path in enumerate(paths):
        _, points = gallery.read_sketch(path)
        y = ((len(paths) - 1) / 2 - row) * ROW
        for column in range(columns):
            x = (column - (columns - 1) / 2) * COLUMN
            body = made(points, (x, y - 0.02), **({"triangles": 1800} if column < 2 else {"quads": 900}))
            text = f"{len(body.data.polygons)} triangles"
            if column == 1:
                text = quadriflow(body)
            body.location.z += 0.3
            bpy.context.view_layer.update()
            body.data.materials.clear()
            body.data.materials.append(clay(path.stem, gallery.COLOURS[3 * row % len(gallery.COLOURS)]))
            if column == 3:
                body.modifiers.new("Subdivision", "SUBSURF").render_levels = 2
                text = "subdivided twice"
            else:
                wires(body, line)
                if column:
                    poles = dots(body, red)
                    text = f"{text or str(len(body.data.polygons)) + ' quads'}, {poles} poles"
                    if column == 2:
                        text = f"{len(body.data.polygons)} quads, {poles} poles"
            studio.label(text, (x, y - 0.6), 0.055, ink)
    studio.set_stage(width, height, pixels, samples)


def quadriflow(body) -> str:
    """Let Blender make quads of it."""
    for ob in bpy.context.selected_objects:
        ob.select_set(False)
    body.select_set(True)
    bpy.context.view_layer.objects.active = body
    bpy.ops.object.quadriflow_remesh(target_faces=1800)
    return f"QuadriFlow: {len(body.data.polygons)} quads"


def main() -> None:
    """Run the job that the module's text describes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sketch", nargs="*", type=Path)
    parser.add_argument("--out", type=Path, default=ROOT / "docs/pictures/quads.png")
    parser.add_argument("--width", type=int, default=1200)
    parser.add_argument("--samples", type=int, default=12)
    choice = parser.parse_args()
    paths = choice.sketch or [ROOT / "tests/sketches/drawings" / f"{name}.json" for name in NAMES]
    build(paths, choice.width, choice.samples)
    studio.render(choice.out)
    print(choice.out)


if __name__ == "__main__":
    studio.run(main)
