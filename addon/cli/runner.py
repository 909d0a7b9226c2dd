# SPDX-License-Identifier: GPL-3.0-or-later
"""Run jobs one after the other, and report each. No bpy is imported."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from ..native import NATIVE_VERSION
from .jobs import Job, JobError
from .process import Limits, Worker
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


def run(items: list[Job], report: Path, settings: Settings) -> int:
    """Run all items; 0 if all are done, 1 if some failed, 130 if a signal ended the run before the last."""
    done = _done(report) if settings.resume else {}
    worker = Worker(settings.limits, scripts=settings.scripts)
    stop = _Stop(worker)
    failed = finished = skipped = 0
    teller = Teller(len(items))
    unwritten = None
    try:
        with _opened(report, settings.resume) as file:
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
                try:
                    file.write(
                        b"\n" * (unwritten is not None)
                        + json.dumps(result, ensure_ascii=False).encode()
                        + b"\n"
                    )
                    os.fsync(file.fileno())
                except (
                    OSError
                ) as error:  # a full disk: the files that there is room for are made all the same
                    unwritten = error
    finally:
        worker.close()
        stop.forget()
    teller.line(f"{finished - skipped - failed} done, {failed} failed, {skipped} skipped; report: {report}")
    if unwritten is not None:
        teller.line(f"the report is not complete: {unwritten}")
    if finished < len(items):
        teller.line(f"stopped with {len(items) - finished} items to go; run again with --resume")
        return INTERRUPTED
    return 1 if failed or unwritten is not None else 0


def _one(
    item: Job, before: dict[str, Any] | None, worker: Worker, settings: Settings
) -> dict[str, Any] | None:
    """Result of an item; None if it was done before."""
    head = {
        "id": item.id,
        "op": item.op,
        "in": str(item.source),
        "out": str(item.out),
        "version": NATIVE_VERSION,
    }
    picture = item.out.with_suffix(".png") if settings.render else None
    if item.problem is not None:
        return head | _error(*item.problem)
    try:
        size, limit = item.size(), settings.limits.input_megabytes * 1e6
        if size > limit:
            text = f"it has {size / 1e6:.1f} megabytes, {limit / 1e6:g} are allowed; raise --max-megabytes"
            return head | _error("too_large", text)
        key = item.key()
    except OSError as error:
        return head | _error(type(error).__name__.lower(), str(error))
    pictured = picture is None or picture.exists()
    if (
        before is not None
        and before.get("key") == key
        and before.get("digest") == _digest(item.out)
        and pictured
    ):
        return None
    asked = {
        "op": item.op,
        "source": str(item.source),
        "pattern": item.object,
        "params": item.params,
        "out": str(item.out),
        "scripts": settings.scripts,
        "picture": None if picture is None else str(picture),
        "engine": settings.engine,
    }
    result = head | {"key": key} | worker.do(asked)
    return result if result["status"] == "error" else result | {"digest": _digest(item.out)}


def _error(kind: str, message: str) -> dict[str, Any]:
    return {"status": "error", "kind": kind, "message": message}


class _Stop:
    """Whether a signal asked to stop. The first lets the item at hand be finished, the second does not."""

    def __init__(self, worker: Worker) -> None:
        self.asked = False
        self.worker = worker
        self.before = [(number, signal.signal(number, self._hear)) for number in SIGNALS]

    def _hear(self, *_: object) -> None:
        if self.asked:
            self.worker.kill("stopped by the user")
        else:
            # Not `print`: the signal may have come in the middle of one.
            os.write(sys.stderr.fileno(), b"\nfinishing this item; once more stops at once\n")
        self.asked = True

    def forget(self) -> None:
        """Let signals do what they did before."""
        for number, handler in self.before:
            # Blender's own handler is not Python's to know, nor to set again; no more than the exit comes after.
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def _digest(path: Path) -> str | None:
    """Hash of a file; None if there is none."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return None


def _done(report: Path) -> dict[str, dict[str, Any]]:
    """Items that the report says are done; a line that was cut off by a kill says nothing."""
    found: dict[str, dict[str, Any]] = {}
    for line in report.read_bytes().splitlines() if report.exists() else ():
        try:
            result = json.loads(line)
        except ValueError:
            continue
        if isinstance(result, dict) and result.get("digest") is not None:
            found[result["id"]] = result
    return found


def _opened(report: Path, resume: bool) -> IO[bytes]:
    try:
        report.parent.mkdir(parents=True, exist_ok=True)
        file = report.open("ab" if resume else "wb", buffering=0)
        if file.tell():
            file.write(b"\n")  # the last line may have been cut off
    except OSError as error:
        raise JobError(f"the report cannot be written: {error}") from error
    return file
