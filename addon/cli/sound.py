# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an input file is what it says: Blender's importers take what is left of a damaged one without a word. No bpy."""

from __future__ import annotations

import math
import mmap
import re
import struct
from pathlib import Path

from . import files, ply

_BLOCK = 1 << 20
_CUT_OFF = "its last line has no end: it may be cut off"
_WHOLE = re.compile(rb"[+-]?[0-9]+")
_FACE = re.compile(rb"[ \t]*f[ \t]")


def require_whole(path: Path) -> list[str]:
    """What is wrong with a file that can be read all the same.

    Raises
    ------
    FileError
        If it cannot.
    """
    suffix = path.suffix.lower()
    if suffix == ".stl":
        return _of_stl(path)
    if suffix == ".ply":
        return _of_ply(path)
    if suffix == ".obj":
        _check_obj(path)
        return [] if _end(path, 1) in (b"", b"\n", b"\r") else [_CUT_OFF]
    return []


def _check_obj(path: Path) -> None:
    """Raise FileError for a vertex that is not at a finite place, and for a face that refers to a missing one.

    Numbers of vertices begin at 1; negative ones count back from the last vertex before the face. Lines that are no
    numbers at all are left to the importer.
    """
    vertices, faces = 0, []
    with files.opened(path) as file:
        for number, line in enumerate(iter(lambda: file.readline(_BLOCK), b""), 1):
            words = line.split()
            if words[:1] == [b"v"]:
                vertices += 1
                if not all(map(_is_finite, words[1:4])):
                    raise files.FileError(
                        "load", f"it is damaged: line {number} has a coordinate that is not finite"
                    )
            elif words[:1] == [b"f"]:
                for word in words[1:]:
                    index = word.split(b"/")[0]
                    if not _WHOLE.fullmatch(index):
                        continue
                    at = int(index[:20])
                    if at == 0 or at < -vertices:
                        raise files.FileError(
                            "load",
                            f"it is damaged: line {number} refers to vertex {at} of {vertices} before it",
                        )
                    if at > vertices:
                        faces.append((number, at))
    # Vertices may follow the faces that refer to them.
    for number, at in faces:
        if at > vertices:
            raise files.FileError("load", f"it is damaged: line {number} refers to vertex {at} of {vertices}")


def _is_finite(word: bytes) -> bool:
    """Whether a word is a finite number, or none."""
    try:
        return math.isfinite(float(word))
    except ValueError:
        return True


def left_out(path: Path, loaded: int) -> list[str]:
    """What to say of a file of which this many faces were loaded."""
    if path.suffix.lower() != ".obj":
        return []
    with files.opened(path) as file:
        count = 0
        for line in iter(lambda: file.readline(_BLOCK), b""):
            count += _FACE.match(line) is not None
    if count <= loaded:
        return []
    text = f"{count - loaded} of {count} faces were left out by Blender's importer"
    return [f"{text}: they refer to missing vertices, or are double"]


def _of_stl(path: Path) -> list[str]:
    with files.opened(path) as file:
        head = file.read(84)
    size = path.stat().st_size
    claimed = struct.unpack_from("<I", head, 80)[0] if len(head) == 84 else None
    if claimed is not None and size == 84 + 50 * claimed:
        return []
    if head.lstrip()[:5].lower() != b"solid":
        if claimed is None:
            raise files.FileError("load", "it is no STL: it has no header")
        room = (size - 84) // 50
        raise files.FileError(
            "load", f"it is damaged: it says that it has {claimed} triangles, and has room for {room}"
        )
    if b"endsolid" not in _end(path, 4096).lower():
        return ["it has no 'endsolid': it may be cut off"]
    return []


def _of_ply(path: Path) -> list[str]:
    size = path.stat().st_size
    if not size:
        return []  # the importer says so
    with files.opened(path) as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        if ply.is_ascii(data) and data[-1:] not in (b"\n", b"\r"):
            if fault := ply.fault(data):
                raise files.FileError("load", f"it is damaged: {fault}")
            return [_CUT_OFF]
        wanted = ply.binary_size(data)
        if wanted is not None and wanted > size:
            raise files.FileError("load", "it is damaged: it ends before what its header says")
        if fault := ply.fault(data):
            raise files.FileError("load", f"it is damaged: {fault}")
    return []


def _end(path: Path, size: int) -> bytes:
    with files.opened(path) as file:
        file.seek(max(0, path.stat().st_size - size))
        return file.read(size)
