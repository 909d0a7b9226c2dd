"""docs/gallery.py, the main job: run as a user runs it, its results opened again."""

import re
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).parents[2]
DRAWINGS = [ROOT / f"tests/sketches/drawings/{name}.json" for name in ("frog", "letter")]


def test_the_gallery_leaves_a_scene_and_a_picture(tmp_path):
    command = [sys.executable, ROOT / "docs/gallery.py", *DRAWINGS, "--out", tmp_path, "--width", "300"]
    result = subprocess.run([*command, "--samples", "2"], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr

    for drawing in DRAWINGS:
        numbers = re.search(
            rf"^{drawing.stem} +(\d+) +(\d+) +([\d.]+) +([\d.]+)° +([\d.]+) h", result.stdout, re.M
        )
        triangles, irregular, percent, angle, deviation = map(float, numbers.groups())
        assert abs(triangles / 4000 - 1) <= 0.1
        assert irregular >= 6
        assert percent < 8
        assert angle > 1
        assert deviation <= 2.5

    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "gridmesh.blend"))
    for drawing in DRAWINGS:
        stroke, body = bpy.data.objects[drawing.stem], bpy.data.objects[f"{drawing.stem} body"]
        assert stroke.type == "GREASEPENCIL"
        assert body.type == "MESH"
        assert not body.data.validate()
        assert np.isclose(stroke.location.x, body.matrix_world.translation.x, atol=0.5)

    picture = bpy.data.images.load(str(tmp_path / "gridmesh.png"))
    pixels = np.array(picture.pixels[:]).reshape(-1, 4)
    assert picture.size[0] == 300
    # Light paper, dark ink, and the colours of two bodies.
    brightness = pixels[:, :3].mean(axis=1)
    assert np.median(brightness) > 0.7
    assert brightness.min() < 0.3
    assert (np.ptp(pixels[:, :3], axis=1) > 0.2).mean() > 0.05
