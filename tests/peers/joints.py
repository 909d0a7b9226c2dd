# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "gridmesh", "manifold3d==3.2.1", "numpy==1.26.4"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""Bodies joined by `gridmesh.join`, by manifold3d, and by Blender's Boolean modifier with and without Voxel Remesh. From the folder of the project:

    uv run tests/peers/joints.py [CURVES] [--cases 30]

The bodies of the campaign. Prints a table in Markdown, medians over the cases: irregular vertices, least angle in degrees, longest to
shortest edge, triangles, processor time. manifold3d is left out
where it is not installed.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaign"))

import gridmesh
import joins

try:
    import manifold3d
except ImportError:
    manifold3d = None


def ours(parts):
    """By `gridmesh.join`."""
    made = gridmesh.join(parts)
    return made.vertices, joins.fanned(made)[0]


def manifold(parts):
    """By manifold3d, in single precision as it takes meshes."""
    solids = [
        manifold3d.Manifold(manifold3d.Mesh(vertices.astype(np.float32), triangles.astype(np.uint32)))
        for vertices, triangles in parts
    ]
    mesh = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add).to_mesh()
    return mesh.vert_properties[:, :3].astype(float), mesh.tri_verts.astype(np.int64)


def objects(parts):
    """Blender's objects of the parts."""
    found = []
    for vertices, triangles in parts:
        mesh = bpy.data.meshes.new("part")
        mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
        ob = bpy.data.objects.new("part", mesh)
        bpy.context.scene.collection.objects.link(ob)
        found.append(ob)
    return found


def blender(parts, solver, voxel=None):
    """By the Boolean modifier, and Voxel Remesh if a size is given."""
    first, *others = objects(parts)
    for other in others:
        modifier = first.modifiers.new("union", "BOOLEAN")
        modifier.operation, modifier.solver, modifier.object = "UNION", solver, other
    if voxel:
        modifier = first.modifiers.new("voxels", "REMESH")
        modifier.mode, modifier.voxel_size = "VOXEL", voxel
    evaluated = first.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    vertices = np.empty(3 * len(mesh.vertices))
    mesh.vertices.foreach_get("co", vertices)
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    evaluated.to_mesh_clear()
    for ob in (first, *others):
        bpy.data.meshes.remove(ob.data)
    return vertices.reshape(-1, 3), triangles.reshape(-1, 3).astype(np.int64)


def measured(vertices, triangles):
    """Irregular vertices, least angle, ratio of edges."""
    edges = np.unique(np.sort(joins.sides(triangles), axis=1), axis=0)
    valence = np.bincount(edges.ravel(), minlength=len(vertices))
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    return (
        (valence[valence > 0] != 6).mean(),
        joins.least_angle(vertices[triangles]),
        lengths.max() / max(lengths.min(), 1e-300),
    )


def main() -> None:
    """Join the bodies of the cases in every way and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--cases", type=int, default=30)
    options = parser.parse_args()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    ways = {"gridmesh.join": lambda parts, _: ours(parts)}
    if manifold3d:
        ways["manifold3d"] = lambda parts, _: manifold(parts)
    ways["Blender, exact"] = lambda parts, _: blender(parts, "EXACT")
    ways["Blender, fast"] = lambda parts, _: blender(parts, "FAST")
    ways["Blender, exact, Voxel Remesh"] = lambda parts, edge: blender(parts, "EXACT", 0.8 * edge)
    rows = {name: [] for name in ways}
    for number in range(options.cases):
        it = joins.case(1, number, options.folder)
        if it is None:
            continue
        vertices, triangles = it.parts[0]
        edge = np.linalg.norm(vertices[triangles[:, 0]] - vertices[triangles[:, 1]], axis=1).mean()
        for name, way in ways.items():
            start = time.process_time()
            vertices, triangles = way(it.parts, edge)
            seconds = time.process_time() - start
            rows[name].append((*measured(vertices, triangles), len(triangles), seconds))
    print(
        "| | irregular | least angle | longest : shortest edge | triangles | ms |\n|---|---|---|---|---|---|"
    )
    for name, found in rows.items():
        odd, angle, ratio, count, seconds = np.median(found, axis=0)
        print(f"| {name} | {odd:.1%} | {angle:.2f} | {ratio:.3g} | {count:.0f} | {1000 * seconds:.0f} |")


if __name__ == "__main__":
    main()
