# SPDX-License-Identifier: GPL-3.0-or-later
"""Run jobs one after the other, and report each. No bpy is imported, and no file of an item is opened."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..native import NATIVE_VERSION
from . import drafts, places
from .jobs import Job, JobError
from .process import Limits, Worker
from .report import Report, ReportError
from .telling import Teller

INTERRUPTED = 130
SIGNALS = (signal.SIGINT, signal.SIGTERM)


@dataclass(frozen=True)
class Settings:
    """What holds for all items of a run."""

    resume: bool = False
    limits: Limits = field(default_factory=Limits)
    scripts: bool = False
    """Whether .blend files may run their own scripts."""
    render: bool = False
    engine: str = "workbench"
    outside: bool = False
    """Whether files may refer to files outside their folder."""


def run(items: list[Job], report: Path, settings: Settings, jobs: Path | None = None) -> int:
    """Run all items; 0 if all are done, 1 if some failed, 130 if a signal ended the run before the last.

    jobs : the file that they come from.
    """
    _require_free(report, items, jobs)
    try:
        written = Report(report, resume=settings.resume)
    except ReportError as error:
        raise JobError(str(error)) from error
    worker = Worker(settings.limits, scripts=settings.scripts)
    stop = _Stop(worker)
    failed = finished = skipped = 0
    teller = Teller(len(items))
    if written.shared:
        teller.line(f"another run is writing to {report}: its lines stay")
    try:
        done = written.done() if settings.resume else {}
        for item in items:
            if stop.asked:
                break
            result = _one(item, done.get(item.id), worker, settings)
            finished += 1
            teller.item(finished, result)
            if result is None:
                skipped += 1
                continue
            failed += result["status"] == "error"
            written.write(result)  # on a full disk, files that there is room for are made all the same
    finally:
        worker.close()
        written.flush()
        written.close()
        stop.forget()
    teller.line(f"{finished - skipped - failed} done, {failed} failed, {skipped} skipped; report: {report}")
    if written.unwritten is not None:
        teller.line(f"the report is not complete: {written.unwritten}")
    if finished < len(items):
        teller.line(f"stopped with {len(items) - finished} items to go; run again with --resume")
        return INTERRUPTED
    return 1 if failed or written.unwritten is not None else 0


def _require_free(report: Path, items: list[Job], jobs: Path | None) -> None:
    """Raise JobError if the report would overwrite the jobs, or what an item reads or writes."""
    same = places.Places()
    place = same.of(report.absolute())
    if jobs is not None and same.of(jobs.absolute()) == place:
        raise JobError(f"the report '{report}' is the file of jobs itself; give --report another name")
    name = Path(place).name.casefold()  # few have it, and only they are worth a look at the disk
    for item in items:
        for path in (*item.named_files(), str(item.out)):
            if path.casefold().endswith(name) and not places.problem_of(path) and same.of(path) == place:
                text = f"the report '{report}' is a file of item '{item.id}'; give --report another name"
                raise JobError(text)


def _one(
    item: Job, before: tuple[str, str] | None, worker: Worker, settings: Settings
) -> dict[str, Any] | None:
    """Result of an item; None if it was done before."""
    out, picture = str(item.out), str(item.out.with_suffix(".png")) if settings.render else None
    beside = None if item.beside() is None else str(item.beside())
    outputs = [out, picture, beside]
    head = {
        "id": item.id,
        "op": item.op,
        "in": str(item.source),
        "out": out,
        "version": NATIVE_VERSION,
    }
    if item.problem is not None:
        return head | {"status": "error", "kind": item.problem[0], "message": item.problem[1]}
    look = {
        "do": "look",
        "asked": [NATIVE_VERSION, item.op, item.object, item.params, item.source.suffix, item.out.suffix],
        "named": item.named_files(),
        "outputs": outputs,
        "most": settings.limits.input_megabytes * 1e6,
        "outside": settings.outside,
        "before": before,
    }
    make = {
        "do": "make",
        "op": item.op,
        "source": str(item.source),
        "pattern": item.object,
        "params": item.params,
        "outputs": outputs,
        "settings": {"scripts": settings.scripts, "engine": settings.engine},
    }
    made = worker.do(look, {"do": "prepare"}, make)
    if made["status"] == "unchanged":
        return None
    if made["status"] == "error" and worker.process is None:  # a process that died could not tidy up
        for path in outputs:
            if path is not None:
                drafts.remove(Path(path), worker.number)
    return head | made


class _Stop:
    """Whether a signal asked to stop. The first lets the item at hand be finished, the second does not."""

    def __init__(self, worker: Worker) -> None:
        self.asked = False
        self.worker = worker
        self.before = [(number, signal.signal(number, self._hear)) for number in SIGNALS]

    def _hear(self, *_: object) -> None:
        if self.asked:
            self.worker.kill()
            return
        self.asked = True
        with contextlib.suppress(OSError, ValueError, AttributeError):  # nobody is there to read it
            # Not `print`: the signal may have come in the middle of one.
            os.write(sys.stderr.fileno(), b"\nfinishing this item; once more stops at once\n")

    def forget(self) -> None:
        """Let signals do what they did before."""
        for number, handler in self.before:
            # Blender's own handler is not Python's to know, nor to set again; no more than the exit comes after.
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
