# SPDX-License-Identifier: GPL-3.0-or-later
"""The report: a line for each item, whole whatever happens. No bpy.

Several runs may write to one report: each line is appended by one call, under a lock. A run that begins anew empties the
report unless another is writing to it. What a full disk does not take is taken back, kept, and written when there is room.
"""

from __future__ import annotations

import contextlib
import json
import os
import stat
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep
from typing import Any

from . import files

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None

_HEAD = b'{"id":'
"""What the lines of a report begin with."""
_LONGEST = 1 << 20
_IN_USE, _WRITING = 1 << 40, (1 << 40) + 1
"""Bytes that are locked, far behind the end: by all runs together, and by the one that is writing."""
_PATIENCE = 5.0
"""Seconds that a lock is waited for: its owner may have been halted."""


class ReportError(Exception):
    """The report cannot be written. The message says why."""


class Report:
    """A report that is open."""

    def __init__(self, path: Path, *, resume: bool) -> None:
        self.unwritten: OSError | None = None
        """Why lines were not written, while there are such."""
        self.shared = False
        """Whether another run is writing to it too."""
        self._kept: list[bytes] = []
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._open(path)
        except (OSError, files.FileError) as error:
            raise ReportError(f"the report cannot be written: {error}") from error
        try:
            if self._plain:
                self._begin(path, resume=resume)
        except OSError as error:
            self.close()
            raise ReportError(f"the report cannot be written: {error}") from error
        except BaseException:
            self.close()
            raise

    def _open(self, path: Path) -> None:
        flags = os.O_APPEND | os.O_CREAT | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        self._plain = True
        if path.exists():
            mode = path.stat().st_mode
            self._plain = not stat.S_ISCHR(mode)  # such as /dev/null
            if self._plain:
                files.require_regular(path, path.stat())
        self._file = os.open(path, flags | (os.O_RDWR if self._plain else os.O_WRONLY), 0o666)

    def _begin(self, path: Path, *, resume: bool) -> None:
        """Empty the report, or what is left of a line that was cut off."""
        head = os.read(self._file, 4096).lstrip(b"\n\0")
        if head and not (head.startswith(_HEAD) or _HEAD.startswith(head)):
            raise ReportError(f"'{path}' has something in it that is no report; give --report another name")
        alone = self._lock("LOCK_EX", _IN_USE, 0.0)
        self.shared = not alone
        with self._writing() as locked:
            if alone and not resume:
                os.ftruncate(self._file, 0)
            if locked:
                self._drop_cut_off()
        self._lock("LOCK_SH", _IN_USE, _PATIENCE)

    def _drop_cut_off(self) -> None:
        """Take back a last line without an end; no run is writing it."""
        end = size = os.fstat(self._file).st_size
        while end > 0:
            start = max(0, end - _LONGEST)
            os.lseek(self._file, start, os.SEEK_SET)
            at = os.read(self._file, end - start).rfind(b"\n")
            if at >= 0:
                end = start + at + 1
                break
            end = start
        if end < size:
            os.ftruncate(self._file, end)

    def done(self) -> dict[str, tuple[str, str]]:
        """Of each item that the report says is done: hashes of what it was made from, and of what was made."""
        found: dict[str, tuple[str, str]] = {}
        if not self._plain:
            return found
        os.lseek(self._file, 0, os.SEEK_SET)
        with os.fdopen(self._file, "rb", closefd=False) as file:  # to close another one would unlock it
            while line := file.readline(_LONGEST):
                try:
                    result = json.loads(line)
                except (ValueError, RecursionError):  # what is damaged says nothing
                    continue
                if isinstance(result, dict):
                    texts = [result.get(key) for key in ("id", "key", "digest")]
                    if all(isinstance(text, str) for text in texts):
                        found[texts[0]] = (texts[1], texts[2])
        return found

    def write(self, result: dict[str, Any]) -> None:
        """Add a line, after those that there was no room for."""
        # Half characters, as in names that are no UTF-8, become \\udc.. escapes, which JSON reads as what they are.
        self._kept.append(json.dumps(result, ensure_ascii=False).encode("utf-8", "backslashreplace") + b"\n")
        self.flush()

    def flush(self) -> None:
        """Write what is not written yet, if there is room."""
        try:
            while self._kept:
                with self._writing() as locked:
                    self._append(self._kept[0], locked=locked)
                del self._kept[0]
            self.unwritten = None
            if self._plain:
                os.fsync(self._file)
        except OSError as error:
            self.unwritten = error

    def _append(self, line: bytes, *, locked: bool) -> None:
        size = os.fstat(self._file).st_size
        try:
            written = os.write(self._file, line)
            while written < len(line):  # the rest says why
                written += os.write(self._file, line[written:])
        except OSError:
            if self._plain and locked:
                os.ftruncate(self._file, size)
            raise

    @contextlib.contextmanager
    def _writing(self) -> Iterator[bool]:
        locked = self._lock("LOCK_EX", _WRITING, _PATIENCE)
        try:
            yield locked
        finally:
            self._lock("LOCK_UN", _WRITING, 0.0)

    def _lock(self, how: str, byte: int, seconds: float) -> bool:
        """Lock a byte, or unlock it; whether that was done. Where there are no locks, it is as if nobody else was here."""
        if fcntl is None or not self._plain:
            return True
        flags = getattr(fcntl, how) | (0 if how == "LOCK_UN" else fcntl.LOCK_NB)
        give_up = monotonic() + seconds
        while True:
            try:
                fcntl.lockf(self._file, flags, 1, byte)
                return True
            except (BlockingIOError, PermissionError):
                if monotonic() >= give_up:
                    return False
                sleep(0.002)
            except OSError:  # a file system without locks
                return True

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)
