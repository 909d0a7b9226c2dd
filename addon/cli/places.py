# SPDX-License-Identifier: GPL-3.0-or-later
"""When two paths are the same file, and which outputs would overwrite what is needed. No bpy."""

from __future__ import annotations

import os
import re
import sys
import unicodedata
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .jobs import Job

_RESERVED = re.compile(r"(?i)(con|prn|aux|nul|com[1-9¹²³]|lpt[1-9¹²³])(\..*)?")


class Places:
    """Tells paths that lead to the same file by equal texts.

    Links and `..` are resolved; where names differ by case alone and the file system does not care, neither does this.
    Folders are looked at once.
    """

    def __init__(self) -> None:
        self._folders: dict[str, tuple[str, bool]] = {}

    def of(self, path: Path | str) -> str:
        """Text that is the same for all paths to this file, which need not exist."""
        parent, name = os.path.split(path)
        if parent not in self._folders:
            real = os.path.realpath(parent)
            self._folders[parent] = (real, _ignores_case(real))
        folder, folds = self._folders[parent]
        whole = os.path.join(folder, name)  # noqa: PTH118 (a million of them)
        if os.path.islink(whole):  # noqa: PTH114
            whole = os.path.realpath(whole)
        return _folded(whole) if folds else whole


def _ignores_case(folder: str) -> bool:
    """Whether names in a folder that differ by case alone are the same file."""
    if sys.platform in ("win32", "darwin"):
        return True
    parent, name = os.path.split(folder)
    other = name.swapcase()
    if other == name:
        return False
    try:
        return Path(folder).samefile(Path(parent, other))
    except OSError:
        return False


def _folded(text: str) -> str:
    return unicodedata.normalize("NFC", text).casefold()


def problem_of(path: str, platform: str = sys.platform) -> str | None:
    """Why no file here can have this path; None if one can."""
    if "\0" in path:
        return "it has a NUL character"
    try:
        # Windows itself takes them, but Blender opens nothing of that name.
        path.encode() if platform == "win32" else os.fsencode(path)
    except UnicodeEncodeError:
        return "it has half a character (a lone surrogate), which no file name can have"
    if platform == "win32":
        for part in re.split(r"[\\/]", path):
            if _RESERVED.fullmatch(part):
                return f"'{part}' is reserved by Windows"
    return None


def shown(path: object) -> str:
    """Path as a text that can be written anywhere: half characters as escapes."""
    return str(path).encode("utf-8", "backslashreplace").decode()


def marked(items: list[Job], names: Iterable[str], kept: Iterable[Path] = ()) -> list[Job]:
    """Items, each marked with what is wrong with its id and its paths.

    Of items with the same id or output the first is done. An output may be no input of the same or an earlier item, and
    none of the files that are to be kept; an input of a later one it may be, which then reads what the earlier one wrote.
    """
    places = Places()
    keep = {places.of(path): f"'{path}'" for path in kept}
    ids: dict[str, str] = {}
    outs: dict[str, str] = {}
    read: dict[str, str] = {}
    found = []
    for item, name in zip(items, names, strict=True):
        problem = _unusable(item)
        if problem is None:
            inputs = {places.of(path): name for path in item.named_files()}
            out = places.of(item.out)
            if item.id in ids:
                problem = ("duplicate_id", f"id '{item.id}' is that of {ids[item.id]} too; give it another")
            elif out in outs:
                problem = ("duplicate_out", f"out '{item.out}' is that of {outs[out]} too; give it another")
            elif out in keep:
                problem = (
                    "overwrites",
                    f"out '{item.out}' would overwrite {keep[out]}; give it another name",
                )
            elif out in inputs or out in read:
                whose = "its own input" if out in inputs else f"the input of {read[out]}"
                problem = ("overwrites", f"out '{item.out}' would overwrite {whose}; give it another name")
            else:
                ids[item.id] = outs[out] = name
            for path, of in inputs.items():
                read.setdefault(path, of)
        found.append(item if problem is None else replace(item, problem=problem))
    return found


def _unusable(item: Job) -> tuple[str, str] | None:
    for key, path in (("out", str(item.out)), *(("in", path) for path in item.named_files())):
        if reason := problem_of(path):
            return ("bad_path", f"{key} '{shown(path)}': {reason}")
    return None
