# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a written file is whole. Blender's exporters do not tell when the disk is full. No bpy."""

from __future__ import annotations

import mmap
import struct
from pathlib import Path

from . import ply


def is_whole(path: Path, faces: int) -> bool:
    """Whether the file ends where what it says of itself ends.

    faces : how many an .obj file must have; it does not say so itself.
    """
    if not path.stat().st_size:
        return False
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        suffix = path.suffix.lower()
        if suffix == ".ply":
            return ply.binary_size(data) == len(data)
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
