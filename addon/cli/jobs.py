# SPDX-License-Identifier: GPL-3.0-or-later
"""The file of jobs: read and checked as a whole, before the first runs. No bpy."""

from __future__ import annotations

import hashlib
import json
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..native import NATIVE_VERSION

KEYS = {"id", "op", "in", "params", "out"}
INPUTS = (".json", ".csv")
OUTPUTS = (".ply", ".obj", ".stl", ".glb", ".blend")
SKETCH = {"triangles", "edge_length", "boundary", "max_distance", "angle", "corner_angle", "self_crossing"}
BODY = {"depth", "profile"}
OWN = {"close_gaps", "holes"}


class JobError(ValueError):
    """The jobs cannot be run. The message names the line."""


@dataclass(frozen=True)
class Job:
    """One item. Paths are absolute."""

    id: str
    source: Path
    params: dict[str, Any]
    out: Path

    def key(self, data: bytes) -> str:
        """Hash of all that the result depends on."""
        asked = json.dumps([NATIVE_VERSION, self.params, self.source.suffix, self.out.suffix], sort_keys=True)
        return hashlib.sha256(asked.encode() + b"\0" + data).hexdigest()


def read(path: Path) -> list[Job]:
    """Read all jobs; relative paths are relative to the file.

    Raises
    ------
    JobError
        If a line is not a job, or two jobs have the same id or output.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise JobError(f"{path}: {error}") from error
    found: list[Job] = []
    ids: dict[str, int] = {}
    outs: dict[Path, int] = {}
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            job = _job(json.loads(line), path.parent.resolve())
        except (ValueError, RecursionError) as error:
            raise JobError(f"{path}, line {number}: {error}") from error
        for seen, value, what in ((ids, job.id, "id"), (outs, job.out, "out")):
            if value in seen:
                raise JobError(f"{path}, line {number}: {what} '{value}' is that of line {seen[value]} too")
            seen[value] = number
        found.append(job)
    if not found:
        raise JobError(f"{path}: it has no jobs; write one JSON object a line")
    return found


def _job(item: Any, folder: Path) -> Job:
    if not isinstance(item, dict):
        raise JobError("it is no JSON object")
    if unknown := sorted(item.keys() - KEYS):
        raise JobError(f"unknown key '{unknown[0]}'; allowed: {', '.join(sorted(KEYS))}")
    for key in ("id", "op", "in", "out"):
        if not isinstance(item.get(key), str) or not item[key] or "\0" in item[key]:
            raise JobError(f"'{key}' must be a text that is not empty")
    if item["op"] != "strokes":
        raise JobError(f"op '{item['op']}' is not known; allowed: strokes")
    params = item.get("params", {})
    if not isinstance(params, dict):
        raise JobError("'params' must be a JSON object")
    if unknown := sorted(params.keys() - SKETCH - BODY - OWN):
        raise JobError(f"unknown parameter '{unknown[0]}'; allowed: {', '.join(sorted(SKETCH | BODY | OWN))}")
    if "triangles" in params and "edge_length" in params:
        raise JobError("give triangles or edge_length, not both")
    gaps = params.get("close_gaps", 0.2)
    if isinstance(gaps, bool) or not isinstance(gaps, int | float) or not 0 <= gaps <= 1:
        raise JobError("close_gaps must be a number from 0 to 1")
    if not isinstance(params.get("holes", True), bool):
        raise JobError("holes must be true or false")
    if any(isinstance(value, float) and not math.isfinite(value) for value in params.values()):
        raise JobError("a parameter is not a finite number")
    source, out = folder / item["in"], folder / item["out"]
    for path, allowed in ((source, INPUTS), (out, OUTPUTS)):
        if path.suffix.lower() not in allowed:
            raise JobError(f"'{path.name}' does not end in one of {', '.join(allowed)}")
    return Job(item["id"], source, params, out)


def select(items: list[Job], part: str | None, shard: str | None) -> list[Job]:
    """Items of a range "100-199", counted from 0, and of those the ones of a shard "3/8", counted from 1."""
    if part is not None:
        match = re.fullmatch(r"(\d+)-(\d+)", part)
        if not match or int(match[1]) > int(match[2]):
            raise JobError(f"--range {part}: write the first and the last item, as in 100-199")
        items = items[int(match[1]) : int(match[2]) + 1]
    if shard is not None:
        match = re.fullmatch(r"(\d+)/(\d+)", shard)
        if not match or not 1 <= int(match[1]) <= int(match[2]):
            raise JobError(f"--shard {shard}: write the shard and their number, as in 3/8")
        items = items[int(match[1]) - 1 :: int(match[2])]
    return items
