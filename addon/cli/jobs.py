# SPDX-License-Identifier: GPL-3.0-or-later
"""What is to be done: a file of jobs, read and checked as a whole before the first runs. No bpy."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..native import NATIVE_VERSION
from . import params as parameters

KEYS = {"id", "op", "in", "object", "params", "out"}
CURVES = (".json", ".csv", ".svg")
MESHES = (".obj", ".ply", ".stl", ".glb", ".gltf")
INPUTS = {
    "strokes": (*CURVES, ".blend"),
    "fill": (*MESHES, ".blend"),
    "cut": (*MESHES, ".blend"),
}
OUTPUTS = (".ply", ".obj", ".stl", ".glb", ".blend")


class JobError(ValueError):
    """The jobs cannot be run. The message names the lines."""


@dataclass(frozen=True)
class Job:
    """One item. Paths are absolute."""

    id: str
    op: str
    source: Path
    object: str | None
    """Pattern for names of objects; None: all that serve."""
    params: dict[str, Any]
    out: Path
    problem: tuple[str, str] | None = None
    """Kind and message of what is wrong with this item and no other."""

    def files(self) -> list[Path]:
        """All files that are read."""
        found = [self.source]
        stroke = self.params.get("stroke")
        if isinstance(stroke, str) and is_file(stroke):
            found.append(Path(stroke))
        if self.source.suffix.lower() == ".gltf":
            found += buffers(self.source)
        return found

    def size(self) -> int:
        """Bytes of all files that are read. Raises OSError if there is none."""
        return sum(path.stat().st_size for path in self.files())

    def key(self) -> str:
        """Hash of all that the result depends on. Raises OSError if a file cannot be read."""
        asked = [NATIVE_VERSION, self.op, self.object, self.params, self.source.suffix, self.out.suffix]
        digest = hashlib.sha256(json.dumps(asked, sort_keys=True).encode())
        for path in self.files():
            digest.update(b"\0")
            with path.open("rb") as file:
                while block := file.read(1 << 20):
                    digest.update(block)
        return digest.hexdigest()


def is_file(stroke: str) -> bool:
    """Whether this names a file of curves, and not an object."""
    return Path(stroke).suffix.lower() in CURVES


def buffers(path: Path) -> list[Path]:
    """Files that a .gltf file refers to; it may be any JSON, or none."""
    try:
        read = json.loads(path.read_bytes())
        parts = [*read.get("buffers", []), *read.get("images", [])]
        names = [part["uri"] for part in parts if isinstance(part.get("uri"), str)]
    except (ValueError, AttributeError, TypeError, RecursionError):
        return []  # the importer says what is wrong with it
    return [
        path.parent / _unquoted(name) for name in names if not name.startswith("data:") and "\0" not in name
    ]


def _unquoted(name: str) -> str:
    """Name without the %20 of a URI.

    An extension that imports `urllib`, even a part that reads no more than texts, counts as one that uses the network.
    """
    plain = re.sub(rb"%([0-9a-fA-F]{2})", lambda found: bytes.fromhex(found[1].decode()), name.encode())
    return os.fsdecode(plain)


def read(path: Path) -> list[Job]:
    """Read all jobs; relative paths are relative to the file.

    Of items with the same id or output the first is done, and the others become errors of their own.

    Raises
    ------
    JobError
        If lines are no jobs; it names all of them.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise JobError(f"{path}: {error}") from error
    found: list[Job] = []
    names: list[str] = []
    wrong: list[str] = []
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            found.append(_job(json.loads(line), path.parent.resolve()))
            names.append(f"line {number}")
        except (ValueError, RecursionError) as error:
            wrong.append(f"{path}, line {number}: {error}")
    if wrong:
        raise JobError("\n".join(wrong))
    if not found:
        raise JobError(f"{path}: it has no jobs; write one JSON object a line")
    return marked(found, names)


def marked(items: list[Job], names: Iterable[str]) -> list[Job]:
    """Items, those with the id or the output of an earlier one marked with what is wrong."""
    ids: dict[str, str] = {}
    outs: dict[Path, str] = {}
    found = []
    for item, name in zip(items, names, strict=True):
        problem = None
        if item.id in ids:
            problem = ("duplicate_id", f"id '{item.id}' is that of {ids[item.id]} too; give it another")
        elif item.out in outs:
            problem = ("duplicate_out", f"out '{item.out}' is that of {outs[item.out]} too; give it another")
        else:
            ids[item.id] = outs[item.out] = name
        found.append(replace(item, problem=problem))
    return found


def _job(item: Any, folder: Path) -> Job:
    if not isinstance(item, dict):
        raise JobError("it is no JSON object")
    if unknown := sorted(item.keys() - KEYS):
        raise JobError(f"unknown key '{unknown[0]}'; allowed: {', '.join(sorted(KEYS))}")
    for key in ("id", "op", "in", "out"):
        if not isinstance(item.get(key), str) or not item[key] or "\0" in item[key]:
            raise JobError(f"'{key}' must be a text that is not empty")
    name = item.get("object")
    if name is not None and (not isinstance(name, str) or not name):
        raise JobError("'object' must be a text that is not empty: a name, or a pattern such as 'Leaf*'")
    chosen = item.get("params", {})
    if not isinstance(chosen, dict):
        raise JobError("'params' must be a JSON object")
    return checked(
        item["id"], item["op"], folder / item["in"], name, dict(chosen), folder / item["out"], folder
    )


def checked(
    name: str, op: str, source: Path, pattern: str | None, chosen: dict[str, Any], out: Path, folder: Path
) -> Job:
    """Job of these parts; a stroke's file is relative to the folder.

    Raises
    ------
    JobError
        If something of it is not allowed.
    """
    if op not in parameters.OPS:
        raise JobError(f"op '{op}' is not known; allowed: {', '.join(parameters.OPS)}")
    for path, allowed in ((source, INPUTS[op]), (out, OUTPUTS)):
        if path.suffix.lower() not in allowed:
            raise JobError(f"'{path.name}' does not end in one of {', '.join(allowed)}")
    try:
        parameters.check(op, chosen)
    except parameters.ParameterError as error:
        raise JobError(str(error)) from error
    stroke = chosen.get("stroke")
    if isinstance(stroke, str):
        if is_file(stroke):
            chosen["stroke"] = str(folder / stroke)
        elif source.suffix.lower() != ".blend":
            raise JobError(
                f"stroke '{stroke}' is no file of curves ({', '.join(CURVES)}), and only a .blend file has strokes"
            )
    if pattern is not None and source.suffix.lower() in CURVES[:2]:
        raise JobError(f"'object' is for files with objects; '{source.name}' has none")
    return Job(name, op, source, pattern, chosen, out)


def select(items: list[Job], part: str | None, shard: str | None) -> list[Job]:
    """Items of a range "100-199" or "100", counted from 0, and of those the ones of a shard "3/8", counted from 1."""
    if part is not None:
        match = re.fullmatch(r"(\d+)(?:-(\d+))?", part)
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
        if first > last:
            raise JobError(f"--range {part}: write the first and the last item, as in 100-199")
        items = items[first : last + 1]
    if shard is not None:
        match = re.fullmatch(r"(\d+)/(\d+)", shard)
        if not match or not 1 <= int(match[1]) <= int(match[2]):
            raise JobError(f"--shard {shard}: write the shard and their number, as in 3/8")
        items = items[int(match[1]) - 1 :: int(match[2])]
    return items
