# SPDX-License-Identifier: GPL-3.0-or-later
"""A sprite as glTF 2.0, with its picture in it: .glb, or .gltf with everything in one text. numpy only, no bpy."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from .sheet import Sheet

_FLOAT, _UNSIGNED, _CLAMP, _LINEAR = 5126, 5125, 33071, 9729
_VERTICES, _INDICES = 34962, 34963
_MIME = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg", ".webp": "image/webp"}


def write(path: Path, sheet: Sheet, unit: float) -> None:
    """Write the sprite upright, y up, facing z; `unit` pixels are a metre."""
    points = (sheet.points / unit).astype("<f4")
    faces = sheet.cutout.faces.astype("<u4")
    normals = [] if sheet.flat else [("NORMAL", _normals(points, faces).astype("<f4"))]
    attributes = [("POSITION", points), *normals, ("TEXCOORD_0", sheet.uv.astype("<f4"))]
    blocks = [(data.tobytes(), _VERTICES) for _, data in attributes]
    blocks += [(faces.tobytes(), _INDICES), (sheet.picture, None)]
    views, data = _joined(blocks)
    accessors: list[dict[str, Any]] = []
    for at, (_, values) in enumerate(attributes):
        accessors.append(_accessor(at, _FLOAT, len(values), f"VEC{values.shape[1]}"))
    accessors[0] |= {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    accessors.append(_accessor(len(attributes), _UNSIGNED, faces.size, "SCALAR"))
    texture: dict[str, Any] = {"sampler": 0, "source": 0}
    used = ["KHR_materials_unlit"] if sheet.flat else []
    required = []
    if sheet.ending == ".webp":
        texture = {"sampler": 0, "extensions": {"EXT_texture_webp": {"source": 0}}}
        used.append("EXT_texture_webp")
        required.append("EXT_texture_webp")
    primitive = {
        "attributes": {name: at for at, (name, _) in enumerate(attributes)},
        "indices": len(attributes),
        "material": 0,
    }
    text: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "GridMesh"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": sheet.name, "mesh": 0}],
        "meshes": [{"name": sheet.name, "primitives": [primitive]}],
        "materials": [_material(sheet)],
        "textures": [texture],
        "samplers": [{"magFilter": _LINEAR, "minFilter": _LINEAR, "wrapS": _CLAMP, "wrapT": _CLAMP}],
        "images": [{"name": sheet.name, "bufferView": len(views) - 1, "mimeType": _MIME[sheet.ending]}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    if used:
        text["extensionsUsed"] = used
    if required:
        text["extensionsRequired"] = required
    if path.suffix.lower() == ".glb":
        path.write_bytes(_binary(text, data))
    else:
        coded = base64.b64encode(data).decode("ascii")
        text["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{coded}"
        path.write_text(json.dumps(text, ensure_ascii=False) + "\n", encoding="utf-8", newline="\n")


def _accessor(view: int, kind: int, count: int, shape: str) -> dict[str, Any]:
    return {"bufferView": view, "componentType": kind, "count": count, "type": shape}


def _material(sheet: Sheet) -> dict[str, Any]:
    material: dict[str, Any] = {
        "name": sheet.name,
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 1},
    }
    if sheet.flat:
        material |= {"doubleSided": True, "extensions": {"KHR_materials_unlit": {}}}
        if sheet.transparent:
            material["alphaMode"] = "BLEND"
    return material


def _normals(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Normals of the vertices: the mean of those around, by their area."""
    corners = points[faces].astype(float)
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros((len(points), 3))
    for k in range(3):
        np.add.at(normals, faces[:, k], crossed)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(lengths > 0, normals / np.where(lengths > 0, lengths, 1.0), [0.0, 0.0, 1.0])


def _joined(blocks: list[tuple[bytes, int | None]]) -> tuple[list[dict[str, Any]], bytes]:
    """Views into one buffer, each aligned to four bytes, and the buffer."""
    views, data = [], b""
    for block, target in blocks:
        view = {"buffer": 0, "byteOffset": len(data), "byteLength": len(block)}
        views.append(view if target is None else view | {"target": target})
        data += block + bytes(-len(block) % 4)
    return views, data


def _binary(text: dict[str, Any], data: bytes) -> bytes:
    coded = json.dumps(text, ensure_ascii=False, separators=(",", ":")).encode("utf-8")
    coded += b" " * (-len(coded) % 4)
    size = 12 + 8 + len(coded) + 8 + len(data)
    return b"".join(
        [
            struct.pack("<4sII", b"glTF", 2, size),
            struct.pack("<I4s", len(coded), b"JSON"),
            coded,
            struct.pack("<I4s", len(data), b"BIN\0"),
            data,
        ]
    )
