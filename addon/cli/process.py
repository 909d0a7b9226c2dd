# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker process as its owner sees it: fed with jobs, watched, stopped when it takes too much, started again when it dies."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Any

from . import limits
from .worker import MARK

_TAIL = 20_000
"""Bytes of what a dead worker said that are looked at."""
_CHATTER = 64 << 20
"""Bytes that a worker may say before the file of it is emptied."""
_PERIOD = 0.02
"""Seconds between two looks at a worker."""
_PATIENCE = 10.0
"""Seconds that a worker gets to end by itself; Blender can hang in its own clean-up."""
_KILLED = 10.0
"""Seconds that a killed worker gets to be gone; a process that waits for a dead disk never is."""


@dataclass(frozen=True)
class Limits:
    """What an item may take."""

    input_megabytes: float = 100.0
    memory_megabytes: float = 4000.0
    seconds: float = 600.0


class Worker:
    """A process that does jobs one after the other; it is started with the first."""

    def __init__(self, allowed: Limits, *, scripts: bool) -> None:
        self.limits, self.scripts = allowed, scripts
        self.process: subprocess.Popen[str] | None = None
        self.number = 0
        """Of the last process."""
        self.said = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115 (closed with the worker)
        # Not a SimpleQueue: where a signal is handled for longer than its get() was to wait, that waits without end.
        self._answers: queue.Queue[str | None] = queue.Queue()
        self._ready = False
        self._reason: tuple[str, str] | None = None
        self._ended = False
        self._idle = 0.0
        self._kills = 0

    def do(self, *requests: dict[str, Any]) -> dict[str, Any]:
        """Result of the last of these requests, or of the first that is not "ok", within the limits for all of them together.

        An error if the process died over one or was stopped.
        """
        left = self.limits.seconds if self.limits.seconds > 0 else float("inf")
        answer: dict[str, Any] = {}
        for request in requests:
            self._reason, self._kills = None, limits.system_kills()
            if self._ended:
                return _error("stopped", "stopped by the user")
            if self.process is None:
                self._start()
                if self._answer() is None:
                    return self._buried()
            self.said.seek(0)
            self.said.truncate()
            started = monotonic()
            timed = request.get("do") != "prepare"  # Blender's own start is not the item's
            reply = self._asked(request, left if timed else None)
            if reply is None:
                return self._buried()
            answer = answer | reply
            if timed:
                left = max(0.0, left - (monotonic() - started))
            else:
                self._idle = limits.in_use(self.number)
            if answer.get("status") != "ok":
                break
        self._renew()
        return answer

    def _asked(self, request: dict[str, Any], seconds: float | None) -> dict[str, Any] | None:
        try:
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
        except OSError:
            return None  # it died
        return self._answer(seconds)

    def _answer(self, seconds: float | None = None) -> dict[str, Any] | None:
        """Next thing that the worker says; None if it died, or took too much and was killed.

        seconds : how long it may take; None: as long, and as much memory, as it likes.
        """
        give_up = None if seconds is None else monotonic() + seconds
        most = self.limits.memory_megabytes
        while True:
            with contextlib.suppress(queue.Empty):
                line = self._answers.get(timeout=_PERIOD)
                if line is None:
                    return None
                if line.startswith(MARK):
                    return json.loads(line.removeprefix(MARK))
                continue
            self._quieten()
            if give_up is None:
                continue
            if most > 0 and limits.in_use(self.number) > most:
                self._kill("out_of_memory", self._too_much())
            elif monotonic() > give_up:
                text = f"it took longer than {self.limits.seconds:g} seconds; raise --max-seconds"
                self._kill("stopped", text)

    def _too_much(self) -> str:
        return f"it needs more than {self.limits.memory_megabytes:g} megabytes of memory; raise --max-memory"

    def _quieten(self) -> None:
        """Forget what the worker said if a file makes it talk without end."""
        if getattr(os.fstat(self.said.fileno()), "st_blocks", 0) * 512 > _CHATTER:
            self.said.truncate(0)

    def _renew(self) -> None:
        """End a process that kept much of the memory of an item: the next one gets all of what it may take."""
        most = self.limits.memory_megabytes
        if self.process is not None and most > 0:
            kept = limits.in_use(self.number) - self._idle
            if kept > max(0.0, most - self._idle) / 2:
                self._end()

    def kill(self) -> None:
        """End the process now, and start no other: the item at hand becomes an error. For handlers of signals."""
        self._ended = True
        self._kill("stopped", "stopped by the user")

    def _kill(self, kind: str, reason: str) -> None:
        if self.process is not None:
            self._reason = self._reason or (kind, reason)
            self.process.kill()

    def close(self) -> None:
        """Let the process end."""
        if self.process is not None:
            self._end()
        self.said.close()

    def _end(self) -> None:
        """Let the process end by itself, or else not; its number, or the signal's that ended it."""
        process, self.process, self._ready = self.process, None, False
        with contextlib.suppress(OSError):  # what it did not read is of no use now
            process.stdin.close()
        try:
            self._code = process.wait(0 if self._ended else _PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(_KILLED)
            self._code = -9

    def _start(self) -> None:
        self.process = subprocess.Popen(
            [*_command(scripts=self.scripts), str(self.limits.memory_megabytes)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.said,
            encoding="utf-8",
            errors="replace",
            cwd=Path(__file__).parents[2],
            # Ctrl-C is for this process; the item at hand is finished.
            start_new_session=True,
            creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
        )
        self.number = self.process.pid
        self._answers = queue.Queue()
        threading.Thread(target=_read, args=(self.process.stdout, self._answers), daemon=True).start()
        if self._ended:  # the signal came meanwhile
            self.kill()

    def _buried(self) -> dict[str, Any]:
        """What a process that died tells of its end."""
        self._end()
        code = self._code
        if self._reason:
            return _error(*self._reason)
        size = self.said.seek(0, 2)
        self.said.seek(max(0, size - _TAIL))
        last = self.said.read()
        if limits.ran_out(last):
            return _error("out_of_memory", self._too_much())
        if code == -9 and limits.system_kills() > self._kills:
            return _error("out_of_memory", "the system ended the worker process: it had no memory left")
        lines = [line.strip() for line in last.decode("utf-8", "replace").splitlines() if line.strip()]
        text = f"the worker process ended with {_named(code)}" + (f": {lines[-1][:200]}" if lines else "")
        return _error("crashed", text)


def _error(kind: str, message: str) -> dict[str, Any]:
    return {"status": "error", "kind": kind, "message": message}


def _named(code: int) -> str:
    """Exit code, or the name of the signal that it stands for."""
    with contextlib.suppress(ValueError):
        if code < 0:
            return f"code {code} ({signal.Signals(-code).name})"
    return f"code {code}"


def _read(stream: Any, answers: queue.Queue[str | None]) -> None:
    """Pass on what a process says; None at its end."""
    try:
        with stream:
            for line in stream:
                answers.put(line)
    finally:
        answers.put(None)


def _command(*, scripts: bool) -> list[str]:
    """How a worker is started: by Blender if this is Blender, else by Python with the `bpy` module."""
    application = getattr(sys.modules.get("bpy"), "app", None)
    if application is not None and application.binary_path:
        policy = "--enable-autoexec" if scripts else "--disable-autoexec"
        return [application.binary_path, "--background", policy, "--command", "gridmesh", "worker"]
    package = __package__.rpartition(".")[0]
    return [sys.executable, "-m", package, "worker"]
