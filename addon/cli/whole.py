# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a written file is whole. Blender's exporters do not tell when the disk is full. No bpy."""

from __future__ import annotations

import mmap
import struct
from pathlib import Path

_SIZES = {"char": 1, "uchar": 1, "short": 2, "ushort": 2, "int": 4, "uint": 4, "float": 4, "double": 8}
_CODES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I"}


def is_whole(path: Path, faces: int) -> bool:
    """Whether the file ends where what it says of itself ends.

    faces : how many an .obj file must have; it does not say so itself.
    """
    if not path.stat().st_size:
        return False
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        suffix = path.suffix.lower()
        if suffix == ".ply":
            return _ply_size(data) == len(data)
        if suffix == ".stl":
            return len(data) >= 84 and 84 + 50 * struct.unpack_from("<I", data, 80)[0] == len(data)
        if suffix == ".glb":
            return len(data) >= 12 and struct.unpack_from("<I", data, 8)[0] == len(data)
        if suffix == ".png":
            return b"IEND" in data[-12:]
        if suffix in (".jpg", ".jpeg", ".webp"):
            return True  # as it was read
        if suffix in (".gltf", ".json", ".tscn"):
            return data[-1:] == b"\n"
        if suffix == ".blend":
            return b"ENDB" in data[-40:]
        return (
            data[-1:] == b"\n" and sum(line.startswith(b"f ") for line in iter(data.readline, b"")) == faces
        )


def _ply_size(data: mmap.mmap) -> int | None:
    """Size that a binary PLY must have by its header; None if that is cut off, or so is a list."""
    end = data.find(b"end_header\n")
    if end < 0:
        return None
    at = end + len(b"end_header\n")
    count, properties = 0, []
    lines = [line.split() for line in data[:end].decode("ascii", "replace").splitlines()]
    for words in [*lines, ["element", "", "0"]]:
        if words[:1] == ["property"]:
            properties.append(words[1:-1])
        elif words[:1] == ["element"]:
            try:
                at = _after(data, at, count, properties)
            except struct.error:
                return None
            count, properties = int(words[2]), []
    return at


def _after(data: mmap.mmap, at: int, count: int, properties: list[list[str]]) -> int:
    """Where the rows of an element end that begin here."""
    if all(words[0] != "list" for words in properties):
        return at + count * sum(_SIZES[words[0]] for words in properties)
    for _ in range(count):
        for words in properties:
            if words[0] == "list":
                (length,) = struct.unpack_from("<" + _CODES[words[1]], data, at)
                at += _SIZES[words[1]] + length * _SIZES[words[2]]
            else:
                at += _SIZES[words[0]]
    return at
