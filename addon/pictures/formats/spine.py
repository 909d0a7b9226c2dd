# SPDX-License-Identifier: GPL-3.0-or-later
"""A sprite as Spine JSON: bones, and a slot with a mesh attachment for each part, weighted if bones are given. numpy only, no bpy."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from .rig import Rig
from .sheet import IMAGES, Part, Sheet

VERSION = "4.2.22"
"""Of the format."""


def write(path: Path, sheet: Sheet, name: str) -> None:
    """Write the skeleton in pixels; `name` is the picture's in the folder `IMAGES`, without its ending."""
    parts = list(sheet.parts())
    low, high = sheet.points.min(axis=0), sheet.points.max(axis=0)
    bones = _bones(sheet.rig)
    root = bones[0]["name"]
    text = {
        "skeleton": {
            "spine": VERSION,
            "x": _rounded(low[0]),
            "y": _rounded(low[1]),
            "width": _rounded(high[0] - low[0]),
            "height": _rounded(high[1] - low[1]),
            "images": f"./{IMAGES}/",
        },
        "bones": bones,
        "slots": [{"name": label, "bone": root, "attachment": label} for label, _ in parts],
        "skins": [
            {
                "name": "default",
                "attachments": {label: {label: _attachment(part, sheet, name)} for label, part in parts},
            }
        ],
        "animations": {},
    }
    path.write_text(json.dumps(text, ensure_ascii=False) + "\n", encoding="utf-8", newline="\n")


def _attachment(part: Part, sheet: Sheet, name: str) -> dict[str, Any]:
    return {
        "type": "mesh",
        "path": name,
        "uvs": np.round(part.uv, 7).ravel().tolist(),
        "triangles": part.triangles.ravel().tolist(),
        "vertices": _vertices(part, sheet.rig),
        "hull": len(part.loops[0]),
        "edges": (2 * part.edges()).ravel().tolist(),  # places in the list of coordinates
        "width": sheet.width,
        "height": sheet.height,
    }


def _bones(rig: Rig | None) -> list[dict[str, Any]]:
    """The root in the lower middle of the picture, then the sprite's own, each relative to its parent."""
    if rig is None:
        return [{"name": "root"}]
    names = [bone.name for bone in rig.bones]
    root = "root"
    while root in names:
        root += "_"
    found: list[dict[str, Any]] = [{"name": root}]
    for k, bone in enumerate(rig.bones):
        x, y, angle = rig.at_rest(k)
        parent = root if bone.parent is None else names[bone.parent]
        place = {"rotation": _rounded(math.degrees(angle)), "x": _rounded(x), "y": _rounded(y)}
        found.append({"name": bone.name, "parent": parent, "length": _rounded(bone.length), **place})
    return found


def _vertices(part: Part, rig: Rig | None) -> list[float]:
    """Places of vertices; with bones for each vertex their number, and of each its number, the place in its axes, its weight."""
    if rig is None or part.weights is None:
        return np.round(part.points, 4).ravel().tolist()
    seen = [np.round(bone.seen_from(part.points), 4) for bone in rig.bones]
    found: list[float] = []
    for at, row in enumerate(part.weights):
        used = np.flatnonzero(row).tolist()
        found.append(len(used))
        for k in used:
            found += [k + 1, *seen[k][at].tolist(), float(row[k])]  # bone 0 is the root
    return found


def _rounded(value: float) -> float:
    return round(float(value), 4)
