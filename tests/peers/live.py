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
"""How long a body takes to follow its stroke, and the preview to follow the pen, without a window.

    uv run tests/peers/live.py [MOVES]

One point of a stroke of 500 is moved MOVES times (200) by less than an edge: milliseconds from the changed stroke to the end of Blender's update,
in which a body of 5000 triangles has followed, or one of 2500 quads; wall clock and processor time. Then the preview of a stroke of
2000 triangles for each event of the mouse.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-blender-")
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import bpy
import numpy as np

import addon
from addon.draw.gesture import Gesture, pack
from addon.live import engine

MOVES = int(sys.argv[1]) if len(sys.argv) > 1 else 200


def main():
    addon.register()
    engine.in_background = True
    print(f"Blender {bpy.app.version_string}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
    drag("triangles", 2500)
    drag("quads", 1250)
    preview()
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5 can crash in its own clean-up


def outline(n=500):
    """(n, 2) points of a round shape with three lobes."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return (1.6 * (1 + 0.25 * np.cos(3 * t)))[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)


def drag(cells, count):
    """Move a point, as Edit Mode does it, and let the body follow."""
    points = outline()
    bpy.ops.object.gridmesh_draw(
        stroke=pack(points, np.ones(len(points))),
        matrix=np.eye(4).ravel().tolist(),
        cells=cells.upper(),
        **{cells: count},
    )
    body = bpy.context.view_layer.objects.active
    engine.settle()
    edge = body.gridmesh_live.lattice[0]
    drawing = body.gridmesh_live.source.data.layers[0].current_frame().drawing
    data = drawing.attributes["position"].data
    home = np.empty(len(data) * 3, np.float32)
    data.foreach_get("vector", home)
    random = np.random.default_rng(3)
    wall, cpu = [], []
    engine.timing.clear()
    for _ in range(MOVES):
        moved = home.reshape(-1, 3).copy()
        moved[40, :2] += random.uniform(-0.6, 0.6, 2) * edge
        began = perf_counter(), process_time()
        data.foreach_set("vector", moved.ravel())
        drawing.tag_positions_changed()
        bpy.context.view_layer.update()
        wall.append(1000 * (perf_counter() - began[0]))
        cpu.append(1000 * (process_time() - began[1]))
    own = 1000 * np.array(engine.timing)
    print(
        f"live: {len(body.data.polygons)} {cells}, {len(own)} updates for {MOVES} moves; all in: least "
        f"{min(wall):.1f} ms, median {np.median(wall):.1f} ms; processor: least {min(cpu):.1f} ms, "
        f"median {np.median(cpu):.1f} ms; GridMesh's part: least {own.min():.1f} ms, median {np.median(own):.1f} ms"
    )


def preview():
    """A stroke of 2000 triangles, event after event, as it is drawn."""
    gesture = Gesture(2000)
    wall, cpu, sizes = [], [], []
    for x, y in outline(400):
        began = perf_counter(), process_time()
        gesture.add((120 * x, 120 * y), np.array([x, y]), 1.0)
        grid = gesture.preview()
        wall.append(1000 * (perf_counter() - began[0]))
        cpu.append(1000 * (process_time() - began[1]))
        sizes.append(0 if grid is None else len(grid[1]))
    full = np.array(sizes) > 1500
    print(
        f"preview: {sizes[-1]} triangles in the end, {full.sum()} events with more than 1500; of these: least "
        f"{np.array(wall)[full].min():.1f} ms, median {np.median(np.array(wall)[full]):.1f} ms, "
        f"most {max(wall):.1f} ms; processor median {np.median(np.array(cpu)[full]):.1f} ms"
    )


main()
