# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of files that are being written, and what becomes of those whose writer was killed. No bpy."""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
from pathlib import Path

_COMMON = ".gridmesh-"
_HOST = hashlib.sha256(platform.node().encode("utf-8", "replace")).hexdigest()[:6]


def prefix(path: Path, process: int) -> str:
    """How names of drafts for this file begin. It holds no part of the file's name: that may be long, or no text."""
    return f"{_start(path)}{process}-"


def _start(path: Path) -> str:
    return f"{_COMMON}{hashlib.sha256(os.fsencode(path.name)).hexdigest()[:10]}-{_HOST}-"


def remove(path: Path, process: int | None = None) -> None:
    """Remove the drafts for this file that this process left; None: those of any process of this machine that has ended."""
    start = _start(path) if process is None else prefix(path, process)
    try:
        left = [file for file in path.parent.iterdir() if file.name.startswith(start)]
    except OSError:
        return  # no folder, no drafts
    for file in left:
        writer = file.name.removeprefix(_start(path)).partition("-")[0]
        if process is not None or (writer.isdecimal() and not _lives(int(writer))):
            with contextlib.suppress(OSError):  # another run was faster, or it is in use
                file.unlink()


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
