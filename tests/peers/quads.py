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
"""Bodies of quads beside what Blender makes of our bodies of triangles: QuadriFlow, Tris to Quads, and Grid Fill.

    uv run tests/peers/quads.py [--quads 2000] [--every 1] [SKETCH.json ...]

Ten drawings of tests/sketches become bodies of so many quads. For each way: quads in percent of all faces; poles, vertices with other
than four edges; the least and the greatest corner, degrees (medians of the drawings, and the worst); the drawing's distance from the
mesh, largest, in median edges; whether a second run gives the same bytes; seconds of one run in turn, whole operator or call. Grid
Fill closes a flat outline of as many vertices as our sheet has; its rim is the drawing's by what it is given.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path
from time import perf_counter

os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-blender-")

import bpy
import gridmesh
import numpy as np
from mathutils.bvhtree import BVHTree

ROOT = Path(__file__).resolve().parents[2]
NAMES = [
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


def outline_of(path):
    points = np.array(json.loads(path.read_text(encoding="utf-8"))["points"], float)
    return (points - points.mean(axis=0)) / np.ptp(points, axis=0).max()


def object_of(vertices, faces):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(np.asarray(vertices).tolist(), [], np.asarray(faces).tolist())
    ob = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    ob.select_set(True)
    return ob


def read(mesh):
    points = np.array([vertex.co[:] for vertex in mesh.vertices])
    return points, [tuple(polygon.vertices) for polygon in mesh.polygons]


def quadriflow(body, target):
    ob = object_of(body.vertices, body.triangles)
    done = bpy.ops.object.quadriflow_remesh(
        target_faces=target, use_preserve_sharp=False, use_preserve_boundary=True
    )
    assert done == {"FINISHED"}
    return read(ob.data)


def tris_to_quads(body, _target):
    ob = object_of(body.vertices, body.triangles)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.tris_convert_to_quads()
    bpy.ops.object.mode_set(mode="OBJECT")
    return read(ob.data)


def ours(outline, target):
    patch = gridmesh.mesh_sketch(outline, quads=target // 2)
    body = gridmesh.inflate(patch)
    return body.vertices, body.quads.tolist()


def sheet(outline, target):
    patch = gridmesh.mesh_sketch(outline, quads=target // 2)
    return np.column_stack([patch.vertices, np.zeros(len(patch.vertices))]), patch.quads.tolist()


def grid_fill(rim):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    mesh = bpy.data.meshes.new("Rim")
    n = len(rim)
    mesh.from_pydata(rim.tolist(), [(k, (k + 1) % n) for k in range(n)], [])
    ob = bpy.data.objects.new("Rim", mesh)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.fill_grid()
    bpy.ops.object.mode_set(mode="OBJECT")
    return read(ob.data)


def measured(points, faces, outline):
    """Numbers of a mesh of triangles and quads."""
    sides = np.array([pair for face in faces for pair in zip(face, face[1:] + face[:1], strict=True)])
    edges, uses = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    valence = np.bincount(edges.ravel(), minlength=len(points))
    regular = np.full(len(points), 4)
    regular[np.unique(edges[uses == 1])] = 3
    used = valence > 0
    angles = []
    for k in (3, 4):
        of = np.array([face for face in faces if len(face) == k])
        if len(of):
            at = points[of]
            ahead, back = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
            normal = np.cross(at[:, 2] - at[:, 0], at[:, -1] - at[:, 1])[:, None]
            turn = np.einsum("fkx,fkx->fk", np.cross(ahead, back), np.broadcast_to(normal, ahead.shape))
            angle = np.arctan2(np.linalg.norm(np.cross(ahead, back), axis=2), (ahead * back).sum(2))
            angles.append(np.degrees(np.where(turn < 0, 2 * np.pi - angle, angle)).ravel())
    angles = np.concatenate(angles)
    tree = BVHTree.FromPolygons(points.tolist(), faces)
    along = np.concatenate(
        [outline + t * (np.roll(outline, -1, axis=0) - outline) for t in (0.0, 0.25, 0.5, 0.75)]
    )
    off = max(tree.find_nearest((x, y, 0.0))[3] for x, y in along)
    edge = np.median(np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1))
    return {
        "faces": len(faces),
        "quads": 100 * np.mean([len(face) == 4 for face in faces]),
        "poles": int((valence != regular)[used].sum()),
        "least": angles.min(),
        "most": angles.max(),
        "off": off / edge,
    }


def timed(function, *arguments):
    started = perf_counter()
    result = function(*arguments)
    return result, perf_counter() - started


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sketch", nargs="*", type=Path)
    parser.add_argument("--quads", type=int, default=2000, help="of both sides together")
    args = parser.parse_args()
    paths = args.sketch or [ROOT / "tests/sketches/drawings" / f"{name}.json" for name in NAMES]
    rows = {"gridmesh": [], "QuadriFlow": [], "Tris to Quads": [], "gridmesh, sheet": [], "Grid Fill": []}
    for path in paths:
        outline = outline_of(path)
        of_triangles = gridmesh.inflate(gridmesh.mesh_sketch(outline, triangles=args.quads))
        ways = {
            "gridmesh": (ours, outline, args.quads),
            "QuadriFlow": (quadriflow, of_triangles, args.quads),
            "Tris to Quads": (tris_to_quads, of_triangles, args.quads),
            "gridmesh, sheet": (sheet, outline, args.quads),
        }
        for way, (function, *arguments) in ways.items():
            (points, faces), seconds = timed(function, *arguments)
            again, _ = function(*arguments)
            same = len(again) == len(points) and np.array_equal(again, points)
            rows[way].append({**measured(points, faces, outline), "seconds": seconds, "same": same})
            if way == "gridmesh, sheet":
                rim = points[: len(gridmesh.mesh_sketch(outline, quads=args.quads // 2).loops[0])]
        try:
            (points, faces), seconds = timed(grid_fill, rim[: len(rim) // 2 * 2])
        except RuntimeError as error:
            print(f"{path.stem}: Grid Fill: {str(error).strip()}")
            continue
        rows["Grid Fill"].append({**measured(points, faces, outline), "seconds": seconds, "same": True})
    print(f"\nBlender {bpy.app.version_string}; {len(paths)} drawings, medians and (worst)")
    print(
        f"{'way':16} {'n':>3} {'faces':>6} {'quads %':>8} {'poles':>12} {'least':>14} {'greatest':>15} {'off':>12} {'same':>5} {'seconds':>8}"
    )
    for way, found in rows.items():
        if not found:
            continue
        of = {key: np.array([row[key] for row in found]) for key in found[0]}
        cells = [f"{way:16} {len(found):3} {np.median(of['faces']):6.0f} {np.median(of['quads']):8.1f}"]
        for key, worst in (("poles", np.max), ("least", np.min), ("most", np.max), ("off", np.max)):
            digits = 0 if key == "poles" else 2 if key == "off" else 1
            cells.append(f"{np.median(of[key]):7.{digits}f} ({worst(of[key]):.{digits}f})")
        print(*cells, f"{of['same'].mean():5.2f} {np.median(of['seconds']):8.3f}")
    ratio = np.array([row["seconds"] for row in rows["QuadriFlow"]]) / [
        row["seconds"] for row in rows["gridmesh"]
    ]
    print(f"QuadriFlow's time over ours: least {ratio.min():.0f}, median {np.median(ratio):.0f}")
    for k, path in enumerate(paths):
        print(
            f"{path.stem:12} poles: gridmesh {rows['gridmesh'][k]['poles']}, QuadriFlow {rows['QuadriFlow'][k]['poles']}"
        )
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5 can crash in its own clean-up


main()
