# SPDX-License-Identifier: GPL-3.0-or-later
"""A sprite as a scene of Godot 4: a Polygon2D for each part, ready for a Skeleton2D. numpy only, no bpy."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .sheet import IMAGES, Part, Sheet


def write(path: Path, sheet: Sheet, name: str) -> None:
    """Write the scene in pixels, y down; `name` is the picture's in the folder `IMAGES`, with its ending.

    Godot reads a path without `res://` from the folder of the scene.
    """
    parts = list(sheet.parts())
    lines = [
        "[gd_scene load_steps=2 format=3]",
        "",
        f'[ext_resource type="Texture2D" path={_quoted(f"{IMAGES}/{name}")} id="1"]',
        "",
        f'[node name={_quoted(_node(sheet.name))} type="Node2D"]',
    ]
    for label, part in parts:
        lines += [
            "",
            f'[node name={_quoted(_node(label))} type="Polygon2D" parent="."]',
            *_polygon(part, sheet),
        ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def _polygon(part: Part, sheet: Sheet) -> list[str]:
    inner = len(part.points) - len(part.loops[0])
    triangles = ", ".join(f"PackedInt32Array({a}, {b}, {c})" for a, b, c in part.triangles.tolist())
    return [
        'texture = ExtResource("1")',
        f"polygon = PackedVector2Array({_numbers(part.points * [1, -1])})",
        f"uv = PackedVector2Array({_numbers(part.uv * [sheet.width, sheet.height])})",
        f"polygons = [{triangles}]",
        f"internal_vertex_count = {inner}",
    ]


def _numbers(values: np.ndarray) -> str:
    return ", ".join(f"{number:g}" for number in np.round(values, 4).ravel() + 0.0)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _node(name: str) -> str:
    """Name without what Godot does not allow in names of nodes."""
    return "".join("_" if letter in '.:@/"%' else letter for letter in name)
