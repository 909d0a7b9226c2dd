# SPDX-License-Identifier: GPL-3.0-or-later
"""A sprite as Spine JSON: a skeleton with one bone, a slot with a mesh attachment for each part. numpy only, no bpy."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from .sheet import IMAGES, Part, Sheet

VERSION = "4.2.22"
"""Of the format."""


def write(path: Path, sheet: Sheet, name: str) -> None:
    """Write the skeleton in pixels; `name` is the picture's in the folder `IMAGES`, without its ending."""
    parts = list(sheet.parts())
    low, high = sheet.points.min(axis=0), sheet.points.max(axis=0)
    text = {
        "skeleton": {
            "spine": VERSION,
            "x": _rounded(low[0]),
            "y": _rounded(low[1]),
            "width": _rounded(high[0] - low[0]),
            "height": _rounded(high[1] - low[1]),
            "images": f"./{IMAGES}/",
        },
        "bones": [{"name": "root"}],
        "slots": [{"name": label, "bone": "root", "attachment": label} for label, _ in parts],
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
        "vertices": np.round(part.points, 4).ravel().tolist(),
        "hull": len(part.loops[0]),
        "edges": (2 * part.edges()).ravel().tolist(),  # places in the list of coordinates
        "width": sheet.width,
        "height": sheet.height,
    }


def _rounded(value: float) -> float:
    return round(float(value), 4)
