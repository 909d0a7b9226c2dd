# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "gridmesh", "numpy==1.26.4"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""Two loops joined by `gridmesh.bridge` and by Blender's Bridge Edge Loops. From the folder of the project:

    uv run tests/peers/bridges.py

The pairs of loops of the campaign (5 to 200 vertices, sizes to 1 : 3, tilted to 60 degrees, waved, half of them with faces
beyond). Blender gets as many cuts as our tube has rows less one, smooth and straight, its quads are cut along their shorter diagonals.
Prints a table in Markdown, medians over the pairs: new vertices and loop vertices of other than the wanted valence, least
angle, mean radius ratio, loop vertices with a fan of more than 8, processor time.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import bpy
import numpy as np

# isort: split
import bmesh

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaign"))

import bridges
from bridges import all_sides, case, measure

FAN = 8
"""A loop vertex with more edges of the tube has a fan."""


class Tube:
    """What `measure` reads of a tube of Blender's."""

    def __init__(self, vertices, triangles) -> None:
        self.vertices, self.triangles = vertices, triangles
        self.report = {"self_intersections": 0, "grid": "blender"}


def blender(it, rows, interpolation):
    """The tube by Bridge Edge Loops, and the seconds; None if Blender makes none that has all edges."""
    mesh = bpy.data.meshes.new("loops")
    edges = [e for loop in it.loops for e in np.c_[loop, np.roll(loop, -1)].tolist()]
    mesh.from_pydata(it.vertices.tolist(), [] if len(it.triangles) else edges, it.triangles.tolist())
    bm = bmesh.new()
    bm.from_mesh(mesh)
    bm.verts.ensure_lookup_table()
    chosen = [bm.edges.get([bm.verts[a], bm.verts[b]]) for a, b in edges]
    for edge in chosen:
        edge.select_set(True)
    bm.to_mesh(mesh)
    bm.free()
    ob = bpy.data.objects.new("loops", mesh)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, True, False)
    start = time.process_time()
    try:
        bpy.ops.mesh.bridge_edge_loops(number_cuts=rows - 1, interpolation=interpolation)
    except RuntimeError:
        bpy.ops.object.mode_set(mode="OBJECT")
        return None
    seconds = time.process_time() - start
    bpy.ops.object.mode_set(mode="OBJECT")
    bm = bmesh.new()
    bm.from_mesh(mesh)
    bm.faces.ensure_lookup_table()
    bmesh.ops.triangulate(
        bm, faces=[face for face in bm.faces if len(face.verts) > 3], quad_method="SHORT_EDGE"
    )
    bm.verts.index_update()
    faces = np.array([[v.index for v in face.verts] for face in bm.faces], np.int64).reshape(-1, 3)
    points = np.array([v.co[:] for v in bm.verts], float)
    bm.free()
    bpy.data.objects.remove(ob)
    old = {frozenset(t) for t in it.triangles.tolist()}
    own = np.array([t for t in faces.tolist() if frozenset(t) not in old], np.int64).reshape(-1, 3)
    wanted = {frozenset(e) for e in edges}
    if not wanted <= {frozenset(side) for side in all_sides(own).tolist()}:
        return None
    return Tube(points[len(it.vertices) :], own), seconds


def row(name, found, tried):
    """A row of the table."""
    of = lambda get: float(np.median([get(m) for m in found]))  # noqa: E731
    return (
        f"| {name} | {len(found)} of {tried} | {100 * of(lambda m: m[0].irregular):.1f} | {of(lambda m: m[0].excess):.2f} "
        f"| {of(lambda m: m[0].angle):.1f} | {of(lambda m: m[0].ratio):.3f} | {of(lambda m: m[1]):.0f} "
        f"| {1000 * of(lambda m: m[0].seconds):.1f} |"
    )


def fans(it, tube):
    """Loop vertices with more edges of the tube than `FAN`."""
    edges = np.unique(np.sort(all_sides(tube.triangles), axis=1), axis=0)
    return int((np.bincount(edges.ravel(), minlength=len(it.vertices))[np.concatenate(it.loops)] > FAN).sum())


def main() -> None:
    """Join, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    results = {"**gridmesh**": [], "Bridge Edge Loops, straight": [], "Bridge Edge Loops, smooth": []}
    for number in range(options.cases):
        it = case(options.seed, number)
        fill, found = bridges.run(it)
        results["**gridmesh**"].append((found, fans(it, fill)))
        for name, interpolation in (("straight", "LINEAR"), ("smooth", "SURFACE")):
            made = blender(it, fill.report["rows"], interpolation)
            if made is not None:
                tube, seconds = made
                results[f"Bridge Edge Loops, {name}"].append((measure(it, tube, seconds), fans(it, tube)))
    print("| tube | made | irregular, % | excess at loops | least angle, ° | radius ratio | fans | ms |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for name, found in results.items():
        print(row(name, found, options.cases))


if __name__ == "__main__":
    main()
