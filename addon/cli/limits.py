# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory a worker may take, and how its owner knows that it took more. No bpy.

The owner watches the worker from outside and ends it above its limit: then it is known why it ended. An allocation that
is refused, on the other hand, ends a process in as many ways as there are libraries. So what the system itself refuses is
far above the limit, where a process comes only in one step, faster than it can be watched.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

_SIGNS = (
    b"memory allocation of",
    b"Malloc returns null",
    b"Calloc returns null",
    b"alloc array",
    b"bad_alloc",
    b"MemoryError",
    b"Cannot allocate memory",
    b"Out of memory",
    b"out of memory",
)
"""What Rust, C++, Python and Blender write before they give up for lack of memory."""
_ROOM = 2_000
"""Megabytes, beside twice the limit, that the system lets a process have."""


def limit(megabytes: float) -> None:
    """Let the system refuse this process memory far above this; 0: any. On Linux alone.

    That is writable memory: address space that is only reserved, as allocators do for each thread,
    would make a limit on all of it depend on the number of processors.
    """
    if megabytes <= 0 or sys.platform != "linux":
        return
    import resource

    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    size = int((2 * megabytes + _ROOM) * 1e6)
    if most != resource.RLIM_INFINITY:
        size = min(size, most)
    resource.setrlimit(resource.RLIMIT_DATA, (size, size))


def end_with_owner() -> None:
    """Let the system end this process when the one that started it is gone. On Linux alone."""
    if sys.platform != "linux":
        return
    import ctypes

    set_death_signal = 1
    ctypes.CDLL(None).prctl(set_death_signal, signal.SIGKILL, 0, 0, 0)


def in_use(number: int) -> float:
    """Writable memory of the process with this number, megabytes; 0 where the system does not tell."""
    try:
        with open(f"/proc/{number}/statm", "rb") as file:  # noqa: PTH123 (fifty times a second)
            return int(file.read().split()[5]) * _PAGE / 1e6
    except (OSError, IndexError, ValueError):  # it has ended, or this is no Linux
        return 0.0


_PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 0


def peak() -> int | None:
    """Largest memory in use of this process until now, megabytes; None where the system does not tell."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    return next((int(line.split()[1]) // 1000 for line in lines if line.startswith("VmHWM:")), None)


def system_kills() -> int:
    """How many processes this system has ended until now since it had no memory left; 0 where it does not tell."""
    try:
        lines = Path("/proc/vmstat").read_text(encoding="ascii").splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("oom_kill ")), 0)


def ran_out(said: bytes) -> bool:
    """Whether a process that wrote this at its end had too little memory."""
    return any(sign in said for sign in _SIGNS)
