"""Files with one JSON object a line: corpora of outlines, and journals of runs that can be stopped at any time."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any


def outlines(corpus: Path, every: int = 1) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every so many lines of a corpus that `corpus.py` made, each with the name that is its own: source and name."""
    with corpus.open() as lines:
        for k, line in enumerate(lines):
            if k % every == 0:
                row = json.loads(line)
                yield f"{row['source']} {row['name']}", row


def rows_of(journal: Path) -> list[dict[str, Any]]:
    """What is in a journal, nothing if there is none; a line that was torn when the run was stopped is left out."""
    if not journal.exists():
        return []
    return [json.loads(line) for line in journal.read_text().splitlines(keepends=True) if line.endswith("\n")]


def resumed(journal: Path) -> list[dict[str, Any]]:
    """The rows of a journal, of which nothing else is left in the file: the next line can be appended."""
    rows = rows_of(journal)
    journal.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return rows


def continued(journal: Path, cases: int, run: Callable[[int], dict[str, Any]]) -> list[dict[str, Any]]:
    """All rows of a journal, once `run` has done those of the first so many cases that are missing in it."""
    rows = resumed(journal)
    known = {row["case"] for row in rows}
    with journal.open("a") as lines:
        for number in range(cases):
            if number not in known:
                rows.append(run(number))
                lines.write(json.dumps(rows[-1]) + "\n")
                lines.flush()
    return rows
