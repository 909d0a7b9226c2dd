# SPDX-License-Identifier: GPL-3.0-or-later
"""Input files: which an item reads, how large they are, what is in them. Only regular files are ever opened. No bpy.

Runs in the worker, where the limits of time and memory hold.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import stat
import struct
from collections.abc import Iterable
from pathlib import Path
from typing import IO, Any

from . import places

_BLOCK = 1 << 20
_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)
_ESCAPED = re.compile(r"(?:%[0-9a-fA-F]{2})+")


class FileError(ValueError):
    """A file may not be read. The message says why."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


def require_regular(path: Path, status: os.stat_result) -> None:
    """Raise FileError if this is anything but a file with contents: to read others may never end."""
    if not stat.S_ISREG(status.st_mode):
        what = next((name for test, name in _KINDS if test(status.st_mode)), "no file")
        raise FileError("not_a_file", f"'{places.shown(path)}' is {what}; only regular files are read")


def opened(path: Path) -> IO[bytes]:
    """Open a regular file for reading; anything else raises FileError, and is not waited for."""
    require_regular(path, path.stat())  # before it is opened: that alone does something to some devices
    number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        require_regular(path, os.fstat(number))
        return os.fdopen(number, "rb")
    except BaseException:
        with contextlib.suppress(OSError):  # fdopen may have closed it
            os.close(number)
        raise


def read_bytes(path: Path) -> bytes:
    """Contents of a regular file, no more than it has when it is opened."""
    with opened(path) as file:
        return file.read(os.fstat(file.fileno()).st_size)


def digest_of(path: Path) -> str | None:
    """Hash of a regular file; None if there is none."""
    try:
        digest = hashlib.sha256()
        _feed(digest, path)
    except (OSError, FileError):
        return None
    return digest.hexdigest()


def key_of(asked: list[Any], named: Iterable[str], most: float, *, outside: bool) -> tuple[str, list[Path]]:
    """Hash of all that a result depends on, and the files that were read for it.

    asked : what else it depends on, as JSON. named : files that the job names; those that they refer to are added.
    most : bytes of all together. outside : whether files may refer to files outside their folder.

    Raises
    ------
    FileError
        If a file is not regular, all are too large, or one refers to a file outside its folder.
    OSError
        If one cannot be read.
    """
    found = [Path(name) for name in named]
    _require_size(found, most)
    for path in list(found):
        found += referred(path, outside=outside)
    _require_size(found, most)
    digest = hashlib.sha256(json.dumps(asked, sort_keys=True).encode())
    for path in found:
        digest.update(b"\0")
        _feed(digest, path)
    return digest.hexdigest(), found


def _require_size(paths: list[Path], most: float) -> None:
    size = 0
    for path in paths:
        status = path.stat()
        require_regular(path, status)
        size += status.st_size
    if size > most:
        text = f"it has {size / 1e6:.1f} megabytes, {most / 1e6:g} are allowed; raise --max-megabytes"
        raise FileError("too_large", text)


def _feed(digest: Any, path: Path) -> None:
    with opened(path) as file:
        left = os.fstat(file.fileno()).st_size  # a file that grows has an end too
        while left > 0 and (block := file.read(min(_BLOCK, left))):
            digest.update(block)
            left -= len(block)


def referred(path: Path, *, outside: bool) -> list[Path]:
    """Files that Blender's importer opens for this one: buffers and images of glTF, materials of OBJ.

    Raises
    ------
    FileError
        If one is outside the folder of this file and may not be.
    """
    suffix = path.suffix.lower()
    if suffix in (".gltf", ".glb"):
        found = [_of_uri(path, uri) for uri in _uris(read_bytes(path))]
    elif suffix == ".obj":
        found = [one for one in _materials(path) if one.exists()]  # the importer does without the others
    else:
        return []
    for one in found:
        _require_inside(path, one, outside=outside)
    return list(dict.fromkeys(found))


def _uris(data: bytes) -> list[str]:
    """URIs of files in a glTF file of either kind; it may be any JSON, or none."""
    try:
        if data[:4] == b"glTF":
            (length,) = struct.unpack_from("<I", data, 12)
            data = data[20 : 20 + length]
        read = json.loads(data.decode("utf-8"))
        parts = [*(read.get("buffers") or ()), *(read.get("images") or ())]
        uris = [part["uri"] for part in parts if isinstance(part.get("uri"), str)]
    except (ValueError, AttributeError, TypeError, RecursionError, struct.error):
        return []  # the importer says what is wrong with it
    # Without `;base64,` the importer takes what begins with `data:` for the name of a file.
    return [uri for uri in uris if uri and not (uri.startswith("data:") and ";base64," in uri)]


def _of_uri(path: Path, uri: str) -> Path:
    """File that a URI means, found as Blender's importer finds it."""
    if re.match(r"(?i)[a-z][a-z0-9+.-]+://", uri):
        raise FileError("outside", f"'{_clipped(uri)}' is an address; nothing is fetched")
    name = _ESCAPED.sub(_unescaped, uri)
    if reason := places.problem_of(name):
        raise FileError("bad_path", f"URI '{_clipped(uri)}': {reason}")
    return path.parent / os.path.normpath(name)


def _unescaped(found: re.Match[str]) -> str:
    """Text of %20 and the like.

    An extension that imports `urllib`, even a part that reads no more than texts, counts as one that uses the network.
    """
    return bytes.fromhex(found[0].replace("%", "")).decode("utf-8", "replace")


def _materials(path: Path) -> list[Path]:
    """Libraries of materials of an OBJ file: those that it names, and the one that is named as it is."""
    found = [path.with_suffix(".mtl")]
    with opened(path) as file:
        while line := file.readline(_BLOCK):
            words = line.split(None, 1)
            if len(words) == 2 and words[0] == b"mtllib":
                name = os.fsdecode(words[1].strip().strip(b'"')).lstrip("/\\")
                if name and not places.problem_of(name):
                    found.append(path.parent / name)
    return found


def _require_inside(path: Path, one: Path, *, outside: bool) -> None:
    folder = path.parent.resolve()
    if not outside and not one.resolve().is_relative_to(folder):
        text = f"it refers to '{_clipped(str(one))}', outside its folder; --allow-outside lets it"
        raise FileError("outside", text)


def _clipped(text: str) -> str:
    return places.shown(text if len(text) <= 200 else text[:197] + "...")
