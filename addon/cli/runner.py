# SPDX-License-Identifier: GPL-3.0-or-later
"""Run jobs in a worker process that is started again when a file crashes it, and report each. No bpy is imported."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO, Any

from ..native import NATIVE_VERSION
from .jobs import Job, JobError
from .worker import MARK

INTERRUPTED = 130
SIGNALS = (signal.SIGINT, signal.SIGTERM)


def run(items: list[Job], report: Path, *, resume: bool, limit: float) -> int:
    """Run all items; 0 if all are done, 1 if some failed, 130 if a signal ended the run before the last."""
    done = _done(report) if resume else {}
    stop = threading.Event()
    before = [(number, signal.signal(number, lambda *_: stop.set())) for number in SIGNALS]
    worker = Worker()
    failed = finished = skipped = 0
    try:
        with _opened(report, resume) as file:
            for item in items:
                if stop.is_set():
                    break
                result = _one(item, done.get(item.id), worker, limit)
                finished += 1
                if result is None:
                    skipped += 1
                    continue
                failed += result["status"] == "error"
                file.write(json.dumps(result, ensure_ascii=False).encode() + b"\n")
                file.flush()
                os.fsync(file.fileno())
                _tell(finished, len(items), result)
    finally:
        worker.close()
        for number, handler in before:
            signal.signal(number, handler)
    print(
        f"{finished - skipped - failed} done, {failed} failed, {skipped} skipped; report: {report}",
        flush=True,
    )
    if finished < len(items):
        print(f"stopped with {len(items) - finished} items to go; run again with --resume", flush=True)
        return INTERRUPTED
    return 1 if failed else 0


def _one(item: Job, before: dict[str, Any] | None, worker: Worker, limit: float) -> dict[str, Any] | None:
    """Result of an item; None if it was done before."""
    head = {"id": item.id, "in": str(item.source), "out": str(item.out), "version": NATIVE_VERSION}
    try:
        size = item.source.stat().st_size
        if size > limit:
            reason = f"it has {size / 1e6:.1f} megabytes, {limit / 1e6:g} are allowed; raise --max-megabytes"
            return head | {"status": "error", "kind": "too_large", "message": reason}
        key = item.key(item.source.read_bytes())
    except OSError as error:
        return head | {"status": "error", "kind": type(error).__name__.lower(), "message": str(error)}
    if before is not None and before.get("key") == key and before.get("digest") == _digest(item.out):
        return None
    asked = {"source": str(item.source), "out": str(item.out), "params": item.params}
    result = head | {"key": key} | worker.do(asked)
    return result if result["status"] == "error" else result | {"digest": _digest(item.out)}


def _digest(path: Path) -> str | None:
    """Hash of a file; None if there is none."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
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
        file = report.open("ab" if resume else "wb")
    except OSError as error:
        raise JobError(f"the report cannot be written: {error}") from error
    if file.tell():
        file.write(b"\n")  # the last line may have been cut off
    return file


def _tell(at: int, total: int, result: dict[str, Any]) -> None:
    message = f": {result['message']}" if result.get("message") else ""
    print(f"[{at}/{total}] {result['status']} {result['id']}{message}", flush=True)


class Worker:
    """A process that does jobs one after the other; it is started with the first."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[str] | None = None

    def do(self, item: dict[str, Any]) -> dict[str, Any]:
        """Result of a job; an error of kind "crashed" if the process died over it."""
        if self.process is None:
            self.process = subprocess.Popen(
                _command(),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                encoding="utf-8",
                errors="replace",
                cwd=Path(__file__).parents[2],
                start_new_session=True,  # Ctrl-C is for this process; the item at hand is finished
            )
        try:
            self.process.stdin.write(json.dumps(item) + "\n")
            self.process.stdin.flush()
            for line in self.process.stdout:
                if line.startswith(MARK):
                    return json.loads(line.removeprefix(MARK))
        except BrokenPipeError:
            pass  # it died; told below
        code = self.process.wait()
        self.process = None
        return {"status": "error", "kind": "crashed", "message": f"the worker process ended with code {code}"}

    def close(self) -> None:
        """Let the process end."""
        if self.process is not None:
            self.process.stdin.close()
            self.process.wait()


def _command() -> list[str]:
    """How a worker is started: by Blender if this is Blender, else by Python with the `bpy` module."""
    binary = getattr(sys.modules.get("bpy"), "app", None)
    if binary is not None and binary.binary_path:
        return [binary.binary_path, "--background", "--command", "gridmesh", "worker"]
    package = __package__.rpartition(".")[0]
    return [sys.executable, "-m", package, "worker"]
