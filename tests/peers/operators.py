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
"""Time and quality of the operators in Blender, without a window; and what they add to the Rust calls.

    uv run tests/peers/operators.py

The stroke r = 1 + 0.3 cos 3t becomes a body of about 6200 triangles: milliseconds from the operator's call to its return, irregular
vertices and smallest angle of the mesh object that is there afterwards. Then bodies of 10,000 and 100,000 triangles, and a
hole: milliseconds of the operator and of the calls of `gridmesh` in it. The best of several runs, in turn.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from time import perf_counter

os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-blender-")
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import bpy
import numpy as np

import addon
from addon import api

RUNS = 9
inside = 0.0
"""Seconds that the last operator spent in calls of `gridmesh`."""


def main():
    addon.register()
    print(f"Blender {bpy.app.version_string}, Python {sys.version.split()[0]}, {os.cpu_count()} processors")
    watch("build")
    watch("fill")
    seconds, _ = best(lambda: stroke(180), lambda: bpy.ops.object.gridmesh_from_strokes(triangles=3100))
    mesh = bpy.context.object.data
    irregular, angle = quality(mesh)
    print(
        f"\nr = 1 + 0.3 cos 3t, {len(mesh.polygons)} triangles: {1000 * seconds:.1f} ms, "
        f"{100 * irregular:.2f} % irregular vertices, smallest angle {angle:.1f} degrees"
    )
    print("\noperator, triangles: whole, calls of gridmesh, the rest (ms)")
    for triangles in (10_000, 100_000):
        whole, calls = best(
            lambda: stroke(180), lambda n=triangles: bpy.ops.object.gridmesh_from_strokes(triangles=n // 2)
        )
        show("strokes", len(bpy.context.object.data.polygons), whole, calls)
    for segments in (100, 320):
        whole, calls = best(
            lambda n=segments: holed(n), lambda: bpy.ops.mesh.gridmesh_fill(holes="ALL", max_edges=0)
        )
        bpy.context.object.update_from_editmode()
        show("fill", len(bpy.context.object.data.polygons), whole, calls)
    addon.unregister()
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5 can crash in its own clean-up


def watch(name):
    """Measure the time in a function of `api`, which is that of Rust and of the conversion of arrays."""
    function = getattr(api, name)

    def timed(*arguments, **options):
        global inside
        started = perf_counter()
        try:
            return function(*arguments, **options)
        finally:
            inside = perf_counter() - started

    setattr(api, name, timed)


def best(prepare, operate):
    """Least seconds of an operator, and of the calls in the run with the least rest."""
    whole, calls = [], []
    for _ in range(RUNS):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        prepare()
        started = perf_counter()
        assert operate() == {"FINISHED"}
        whole.append(perf_counter() - started)
        calls.append(inside)
    at = min(range(RUNS), key=lambda run: whole[run])
    return whole[at], calls[at]


def show(name, triangles, whole, calls):
    print(f"{name:8} {triangles:7}: {1000 * whole:7.1f} {1000 * calls:7.1f} {1000 * (whole - calls):7.1f}")


def stroke(n):
    """Grease pencil with the stroke, n points."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = 1 + 0.3 * np.cos(3 * t)
    points = np.stack([r * np.cos(t), r * np.sin(t), 0 * t], axis=1)
    v3 = hasattr(bpy.data, "grease_pencils_v3")  # before Blender 5.0
    data = (bpy.data.grease_pencils_v3 if v3 else bpy.data.grease_pencils).new("Stroke")
    ob = bpy.data.objects.new("Stroke", data)
    bpy.context.scene.collection.objects.link(ob)
    drawing = data.layers.new("Lines").frames.new(1).drawing
    drawing.add_strokes([n])
    drawing.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    drawing.strokes[0].cyclic = True
    drawing.tag_positions_changed()
    ob.select_set(True)
    bpy.context.view_layer.objects.active = ob
    bpy.context.view_layer.update()


def holed(segments):
    """A sphere without its cap, in Edit Mode."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2)
    bpy.ops.object.mode_set(mode="EDIT")
    import bmesh

    bm = bmesh.from_edit_mesh(bpy.context.object.data)
    bmesh.ops.delete(bm, geom=[vertex for vertex in bm.verts if vertex.co.z > 0.6], context="VERTS")
    bmesh.update_edit_mesh(bpy.context.object.data)


def quality(mesh):
    """Part of the vertices that have not six edges, and the smallest angle in degrees."""
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    triangles, points = corners.reshape(-1, 3), points.reshape(-1, 3).astype(float)
    valence = np.bincount(corners, minlength=len(points))  # as many faces as edges: the body is closed
    angles = []
    for k in range(3):
        a, b = (points[triangles[:, (k + j) % 3]] - points[triangles[:, k]] for j in (1, 2))
        cosine = np.einsum("ij,ij->i", a, b) / (np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1))
        angles.append(np.degrees(np.arccos(np.clip(cosine, -1, 1))).min())
    return np.mean(valence != 6), min(angles)


main()
