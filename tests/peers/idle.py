# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "numpy==1.26.4", "gridmesh"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""What the extension costs who does not use it: registration, and its handlers in a scene of 10,000 objects.

uv run tests/peers/idle.py [--objects 10000] [--updates 2000]

Processor time of the main thread, without a live body, and with one that is not touched. Registration counts from the
second run on: the first one compiles the sources, unless Python is told not to keep that (PYTHONDONTWRITEBYTECODE).
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))


def registered() -> float:
    """Milliseconds to import and register the extension, the first time."""
    started = time.thread_time()
    import addon

    addon.register()
    return 1e3 * (time.thread_time() - started)


def handlers() -> list:
    """The extension's handlers of dependency-graph updates."""
    return [call for call in bpy.app.handlers.depsgraph_update_post if call.__module__.startswith("addon")]


def fill_scene(count: int) -> list[bpy.types.Object]:
    """Add this many cubes, which share ten meshes."""
    meshes = [bpy.data.meshes.new(f"Mesh {k}") for k in range(10)]
    objects = [bpy.data.objects.new(f"Object {k}", meshes[k % 10]) for k in range(count)]
    for ob in objects:
        bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.update()
    return objects


def cost(moved: list[bpy.types.Object], updates: int) -> float:
    """Milliseconds that all handlers take for an update, on average; one object moves in each."""
    own = handlers()
    assert own, "no handlers"
    for call in own:
        bpy.app.handlers.depsgraph_update_post.remove(call)
    spent = 0.0
    for k in range(updates):
        ob = moved[k % len(moved)]
        ob.location.x += 0.1
        bpy.context.view_layer.update()
        graph = bpy.context.evaluated_depsgraph_get()
        started = time.thread_time()
        for call in own:
            call(bpy.context.scene, graph)
        spent += time.thread_time() - started
    bpy.app.handlers.depsgraph_update_post.extend(own)
    return 1e3 * spent / updates


def live_body() -> None:
    """Make a body that follows its curve."""
    curve = bpy.data.curves.new("Drawing", "CURVE")
    spline = curve.splines.new("POLY")
    spline.points.add(3)
    for point, place in zip(spline.points, ((0, 0), (2, 0), (2, 1), (0, 1)), strict=True):
        point.co = (*place, 0, 1)
    spline.use_cyclic_u = True
    ob = bpy.data.objects.new("Drawing", curve)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    ob.select_set(True)
    bpy.ops.object.gridmesh_from_strokes(follow=True, triangles=200)


def main() -> None:
    """Print what was measured."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--objects", type=int, default=10_000)
    parser.add_argument("--updates", type=int, default=2000)
    chosen = parser.parse_args()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    print(f"registration: {registered():.1f} ms")
    objects = fill_scene(chosen.objects)
    print(f"handlers, {chosen.objects} objects: {cost(objects[:50], chosen.updates):.4f} ms an update")
    live_body()
    print(f"the same with a live body at rest: {cost(objects[:50], chosen.updates // 10):.4f} ms an update")
    import addon

    addon.unregister()
    sys.stdout.flush()
    os._exit(0)  # bpy 4.5 can crash in its own clean-up


if __name__ == "__main__":
    main()
