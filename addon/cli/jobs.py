# SPDX-License-Identifier: GPL-3.0-or-later
"""What is to be done: a file of jobs, read and checked as a whole before the first runs. No bpy."""

from __future__ import annotations

import codecs
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..pictures.formats.sheet import IMAGES
from . import files, places
from . import params as parameters

KEYS = {"id", "op", "in", "object", "params", "out"}
CURVES = (".json", ".csv", ".svg")
MESHES = (".obj", ".ply", ".stl", ".glb", ".gltf")
INPUTS = {
    "strokes": (*CURVES, ".blend"),
    "fill": (*MESHES, ".blend"),
    "regrid": (*MESHES, ".blend"),
    "cut": (*MESHES, ".blend"),
    "join": (*MESHES, ".blend"),
    "sprites": (".png", ".jpg", ".jpeg", ".webp"),
}
_OUTPUTS = (".ply", ".obj", ".stl", ".glb", ".blend")
OUTPUTS = {
    **dict.fromkeys(("strokes", "fill", "regrid", "cut", "join"), _OUTPUTS),
    "sprites": (".glb", ".gltf", ".blend", ".json", ".tscn"),
}
BESIDE = (".json", ".tscn")
"""Outputs of sprites that name a picture, which is put into a folder beside them."""

LONGEST = 16 << 20
"""Bytes of the longest line of a file of jobs."""
_NAMED = 1000
"""Bad lines that are named; the others are counted."""


class JobError(ValueError):
    """The jobs cannot be run. The message names the lines."""


@dataclass(frozen=True, slots=True)
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

    def named_files(self) -> list[str]:
        """Files that are read, as far as the job names them; those may name more."""
        stroke = self.params.get("stroke")
        named = [stroke] if isinstance(stroke, str) and is_file(stroke) else []
        return [str(self.source), *named, *filter(None, [self.params.get("bones")])]

    def beside(self) -> Path | None:
        """File that is written beside the output, if any: the picture of a sprite."""
        if self.op != "sprites" or self.out.suffix.lower() not in BESIDE:
            return None
        return self.out.parent / IMAGES / f"{self.out.stem}{self.source.suffix.lower()}"


def is_file(stroke: str) -> bool:
    """Whether this names a file of curves, and not an object."""
    return Path(stroke).suffix.lower() in CURVES


def read(path: Path) -> list[Job]:
    """Read all jobs; relative paths are relative to the file.

    Of items with the same id or output the first is done, and the others become errors of their own; so do outputs that
    would overwrite an input or this file.

    Raises
    ------
    JobError
        If lines are no jobs; it names them.
    """
    folder = path.parent.resolve()
    found: list[Job] = []
    names: list[str] = []
    wrong: list[str] = []
    more = 0
    for number, line in _lines(path):
        try:
            if len(line) > LONGEST:
                raise JobError(f"it is longer than {LONGEST >> 20} megabytes")
            found.append(_job(json.loads(line.decode("utf-8")), folder))
            names.append(f"line {number}")
        except (ValueError, RecursionError) as error:
            if len(wrong) < _NAMED:
                wrong.append(f"{places.shown(path)}, line {number}: {places.shown(error)}")
            else:
                more += 1
            if len(line) > LONGEST:
                break  # what follows is the rest of it
    if wrong:
        raise JobError("\n".join([*wrong, *([f"and {more} more"] if more else [])]))
    if not found:
        raise JobError(f"{path}: it has no jobs; write one JSON object a line")
    return places.marked(found, names, [path])


def _lines(path: Path) -> Iterator[tuple[int, bytes]]:
    """Lines that are not empty, with their numbers. Only a line feed ends a line: JSON may hold all other separators."""
    try:
        with files.opened(path) as file:
            number = 0
            while line := file.readline(LONGEST + 1):
                number += 1
                if number == 1:
                    line = line.removeprefix(codecs.BOM_UTF8)
                if line.strip():
                    yield number, line
    except (OSError, files.FileError) as error:
        raise JobError(f"{path}: {error}") from error


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
    job = Job(item["id"], item["op"], folder / item["in"], name, dict(chosen), folder / item["out"])
    return checked(job, folder)


def checked(job: Job, folder: Path) -> Job:
    """The job, if all of it is allowed; the files of a stroke and of bones, relative to the folder, as absolute paths.

    Raises
    ------
    JobError
        If something of it is not allowed.
    """
    op, source, out, chosen = job.op, job.source, job.out, dict(job.params)
    if op not in parameters.OPS:
        raise JobError(f"op '{op}' is not known; allowed: {', '.join(parameters.OPS)}")
    for path, allowed in ((source, INPUTS[op]), (out, OUTPUTS[op])):
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
    if "bones" in chosen:
        if out.suffix.lower() not in BESIDE:
            raise JobError(f"bones are for {' and '.join(BESIDE)}; '{out.name}' gets none")
        chosen["bones"] = str(folder / chosen["bones"])
    if job.object is not None and (op == "sprites" or source.suffix.lower() in CURVES[:2]):
        raise JobError(f"'object' is for files with objects; '{source.name}' has none")
    return replace(job, params=chosen)


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
