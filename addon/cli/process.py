# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker process as its owner sees it: fed with jobs, stopped when it takes too long, started again when it dies."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import limits
from .worker import MARK

_TAIL = 20_000
"""Bytes of what a dead worker said that are looked at."""


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
        self.killed = ""
        self.said = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115 (closed with the worker)

    def do(self, item: dict[str, Any]) -> dict[str, Any]:
        """Result of a job; an error if the process died over it or was stopped."""
        self.killed = ""
        if self.process is None:
            self._start()
            if self._answer() is None:
                return self._buried()
        self.said.seek(0)
        self.said.truncate()
        reason = f"it took longer than {self.limits.seconds:g} seconds; raise --max-seconds"
        timer = threading.Timer(self.limits.seconds, self.kill, [reason])
        if self.limits.seconds > 0:
            timer.start()
        try:
            self.process.stdin.write(json.dumps(item) + "\n")
            self.process.stdin.flush()
            answer = self._answer()
        except BrokenPipeError:
            answer = None  # it died
        finally:
            timer.cancel()
        return self._buried() if answer is None else answer

    def _answer(self) -> dict[str, Any] | None:
        """Next thing that the worker says; None if it died."""
        for line in self.process.stdout:
            if line.startswith(MARK):
                return json.loads(line.removeprefix(MARK))
        return None

    def kill(self, reason: str) -> None:
        """End the process now; its item becomes an error with this reason."""
        if self.process is not None:
            self.killed = reason
            self.process.kill()

    def close(self) -> None:
        """Let the process end."""
        if self.process is not None:
            self.process.stdin.close()
            self.process.stdout.close()
            self.process.wait()
        self.said.close()

    def _start(self) -> None:
        self.process = subprocess.Popen(
            [*_command(scripts=self.scripts), str(self.limits.memory_megabytes)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.said,
            encoding="utf-8",
            errors="replace",
            cwd=Path(__file__).parents[2],
            start_new_session=True,  # Ctrl-C is for this process; the item at hand is finished
        )

    def _buried(self) -> dict[str, Any]:
        """What a process that died tells of its end."""
        code = self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()
        self.process = None
        if self.killed:
            return {"status": "error", "kind": "stopped", "message": self.killed}
        size = self.said.seek(0, 2)
        self.said.seek(max(0, size - _TAIL))
        last = self.said.read()
        if limits.ran_out(last):
            text = (
                f"it needs more than {self.limits.memory_megabytes:g} megabytes of memory; raise --max-memory"
            )
            return {"status": "error", "kind": "out_of_memory", "message": text}
        lines = [line.strip() for line in last.decode("utf-8", "replace").splitlines() if line.strip()]
        text = f"the worker process ended with code {code}" + (f": {lines[-1][:200]}" if lines else "")
        return {"status": "error", "kind": "crashed", "message": text}


def _command(*, scripts: bool) -> list[str]:
    """How a worker is started: by Blender if this is Blender, else by Python with the `bpy` module."""
    application = getattr(sys.modules.get("bpy"), "app", None)
    if application is not None and application.binary_path:
        policy = "--enable-autoexec" if scripts else "--disable-autoexec"
        return [application.binary_path, "--background", policy, "--command", "gridmesh", "worker"]
    package = __package__.rpartition(".")[0]
    return [sys.executable, "-m", package, "worker"]
