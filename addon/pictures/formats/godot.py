# SPDX-License-Identifier: GPL-3.0-or-later
"""A sprite as a scene of Godot 4: a Polygon2D for each part, with the Skeleton2D that moves them if bones are given. numpy only, no bpy."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np

from .rig import Rig
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
    skeleton, paths = "", []
    if sheet.rig is not None:
        skeleton = _free("Skeleton2D", {_node(label) for label, _ in parts})
        paths = _paths(sheet.rig)
        lines += ["", f'[node name={_quoted(skeleton)} type="Skeleton2D" parent="."]']
        lines += _bones(sheet.rig, paths, skeleton)
    for label, part in parts:
        lines += [
            "",
            f'[node name={_quoted(_node(label))} type="Polygon2D" parent="."]',
            *_polygon(part, sheet),
            *_weights(part, paths, skeleton),
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


def _paths(rig: Rig) -> list[str]:
    """Paths of the bones' nodes from the skeleton; siblings differ, also by what Godot allows in names."""
    found: list[str] = []
    for bone in rig.bones:
        above = "" if bone.parent is None else f"{found[bone.parent]}/"
        found.append(_free(above + _node(bone.name), set(found)))
    return found


def _free(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    return name


def _bones(rig: Rig, paths: list[str], skeleton: str) -> list[str]:
    lines = []
    for k, (bone, path) in enumerate(zip(rig.bones, paths, strict=True)):
        above, _, name = path.rpartition("/")
        x, y, angle = rig.at_rest(k)
        y, angle = -y, -angle  # y down
        c, s = math.cos(angle), math.sin(angle)
        lines += [
            "",
            f'[node name={_quoted(name)} type="Bone2D" parent={_quoted(f"{skeleton}/{above}".rstrip("/"))}]',
            f"position = Vector2({_numbers(np.array([x, y]))})",
            f"rotation = {angle:.7g}",
            f"rest = Transform2D({c:.7g}, {s:.7g}, {-s:.7g}, {c:.7g}, {_numbers(np.array([x, y]))})",
            "auto_calculate_length_and_angle = false",
            f"length = {bone.length:.7g}",
            "bone_angle = 0.0",
        ]
    return lines


def _weights(part: Part, paths: list[str], skeleton: str) -> list[str]:
    if part.weights is None:
        return []
    columns = (", ".join(f"{weight:g}" for weight in column.tolist()) for column in part.weights.T)
    bones = (
        f"{_quoted(path)}, PackedFloat32Array({column})" for path, column in zip(paths, columns, strict=True)
    )
    return [f"skeleton = NodePath({_quoted(f'../{skeleton}')})", f"bones = [{', '.join(bones)}]"]


def _numbers(values: np.ndarray) -> str:
    return ", ".join(f"{number:g}" for number in np.round(values, 4).ravel() + 0.0)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _node(name: str) -> str:
    """Name without what Godot does not allow in names of nodes."""
    return "".join("_" if letter in '.:@/"%' else letter for letter in name)
