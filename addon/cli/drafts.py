# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of files that are being written, and what becomes of those whose writer was killed. No bpy."""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
from collections.abc import Callable
from pathlib import Path

_COMMON = ".gridmesh-"
_HOST = hashlib.sha256(platform.node().encode("utf-8", "replace")).hexdigest()[:6]


def prefix(path: Path, process: int) -> str:
    """How names of drafts for this file begin. It holds no part of the file's name: that may be long, or no text."""
    name = hashlib.sha256(os.fsencode(path.name)).hexdigest()[:10]
    return f"{_COMMON}{_HOST}-{process}-{name}-"


def remove(path: Path, process: int) -> None:
    """Remove the drafts for this file that a process left."""
    start = prefix(path, process)
    _unlink(path.parent, lambda name: name.startswith(start))


def sweep(folder: Path) -> None:
    """Remove the drafts in a folder of all processes of this machine that have ended."""
    start = f"{_COMMON}{_HOST}-"

    def left(name: str) -> bool:
        writer = name.removeprefix(start).partition("-")[0]
        return name.startswith(start) and writer.isdecimal() and not _lives(int(writer))

    _unlink(folder, left)


def _unlink(folder: Path, chosen: Callable[[str], bool]) -> None:
    try:
        with os.scandir(folder) as entries:
            found = [entry.path for entry in entries if chosen(entry.name)]
    except OSError:
        return  # no folder, no drafts
    for path in found:
        with contextlib.suppress(OSError):  # another run was faster, or it is in use
            Path(path).unlink()


def _lives(process: int) -> bool:
    """Whether there is such a process. On Windows, to ask would end it; but files in use cannot be removed there."""
    if os.name != "posix":
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True
