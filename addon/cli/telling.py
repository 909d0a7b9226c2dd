# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run says: a bar on a terminal, a line for each item in a log. No bpy."""

from __future__ import annotations

import shutil
import sys
from time import monotonic
from typing import Any, TextIO

_WIDTH = 30
"""Characters of the bar."""


class Teller:
    """Says how far the run is. On a terminal only items that are not ok get lines of their own."""

    def __init__(self, total: int, stream: TextIO | None = None) -> None:
        self.total = total
        self.stream = stream or sys.stdout
        self.terminal = self.stream is not None and self.stream.isatty()
        self.failed = 0
        self.started = monotonic()
        self.drawn = False
        self.deaf = self.stream is None

    def item(self, at: int, result: dict[str, Any] | None) -> None:
        """Tell what came of an item, the one with this number from 1; None: it was done before."""
        if result is not None:
            self.failed += result["status"] == "error"
            if not self.terminal or result["status"] != "ok":
                message = f": {_line(result['message'])}" if result.get("message") else ""
                self.line(f"[{at}/{self.total}] {result['status']} {_line(result['id'])}{message}")
        if self.terminal:
            self._bar(at)

    def line(self, text: str) -> None:
        """Print a line; the bar, if there is one, goes below."""
        self._write(("\r\x1b[K" if self.drawn else "") + text + "\n")
        self.drawn = False

    def _bar(self, at: int) -> None:
        full = _WIDTH * at // self.total
        left = (monotonic() - self.started) / at * (self.total - at)
        text = f"[{'#' * full}{'.' * (_WIDTH - full)}] {at}/{self.total}"
        text += f", {self.failed} failed" if self.failed else ""
        text += f", {left // 60:.0f}:{left % 60:02.0f} left" if at < self.total else ""
        width = shutil.get_terminal_size().columns - 1
        self._write(f"\r\x1b[K{text[:width]}")
        self.drawn = True

    def _write(self, text: str) -> None:
        if self.deaf:
            return
        encoding = self.stream.encoding or "utf-8"
        try:
            self.stream.write(text.encode(encoding, "backslashreplace").decode(encoding))
            self.stream.flush()
        except (OSError, ValueError):  # who read it has gone; the run goes on, and the report has it all
            self.deaf = True


def _line(text: str) -> str:
    """Text that cannot break a line or command a terminal."""
    return "".join(letter if letter.isprintable() else " " for letter in " / ".join(text.splitlines()))
