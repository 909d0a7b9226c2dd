# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs for the files, folders and patterns of a command line. No bpy."""

from __future__ import annotations

import glob
from pathlib import Path
from typing import Any

from . import jobs, places
from .jobs import Job, JobError

STEM = "{name}"
"""In names of the output and of a file of bones: stands for that of the input without its ending."""


def listed(op: str, words: list[str], pattern: str | None, chosen: dict[str, Any], out: str) -> list[Job]:
    """One job for each input file, in the order of the words and of the names.

    Raises
    ------
    JobError
        If there are no files, or the output's name does not tell them apart.
    """
    try:
        sources = [path for word in words for path in _files(op, word)]
    except OSError as error:  # a folder that may not be read, a name too long
        raise JobError(str(error)) from error
    sources = list(dict.fromkeys(sources))
    if len(sources) > 1 and STEM not in out:
        raise JobError(f"{len(sources)} inputs and one output; write {STEM} in it, as in 'bodies/{STEM}.ply'")
    here = Path.cwd()
    found = [
        jobs.checked(
            jobs.Job(str(path), op, path, pattern, _own(chosen, path), here / out.replace(STEM, path.stem)),
            here,
        )
        for path in sources
    ]
    return places.marked(found, [f"'{path}'" for path in sources])


def _own(chosen: dict[str, Any], path: Path) -> dict[str, Any]:
    """Parameters for one input."""
    named = {key: chosen[key].replace(STEM, path.stem) for key in ("bones",) if key in chosen}
    return {**chosen, **named}


def _files(op: str, word: str) -> list[Path]:
    """Files that a word means; one that names a single file need not exist."""
    path = Path.cwd() / word
    if path.is_dir():
        found = sorted(
            file for file in path.iterdir() if file.suffix.lower() in jobs.INPUTS[op] and file.is_file()
        )
        if not found:
            raise JobError(f"'{word}' has no files that end in {', '.join(jobs.INPUTS[op])}")
        return found
    if glob.has_magic(word) and not path.exists():
        matches = sorted(Path(file).absolute() for file in glob.glob(word, recursive=True))  # noqa: PTH207 (takes absolute patterns)
        found = [file for file in matches if file.suffix.lower() in jobs.INPUTS[op]]
        if not found:
            raise JobError(f"'{word}' matches no files that end in {', '.join(jobs.INPUTS[op])}")
        return found
    return [path]
