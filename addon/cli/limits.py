# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory a worker may take, and what it said when it took more. No bpy."""

from __future__ import annotations

import sys
from pathlib import Path

_SIGNS = (
    b"memory allocation of",
    b"Malloc returns null",
    b"Calloc returns null",
    b"alloc array",
    b"bad_alloc",
)
"""What Rust and Blender write before they give up for lack of memory."""


def limit(megabytes: float) -> None:
    """Let this process have no more memory than this; 0: any. Kept on Linux alone.

    The limit is on writable memory: address space that is only reserved, as allocators do for each thread,
    would make a limit on all of it depend on the number of processors.
    """
    if megabytes <= 0 or sys.platform != "linux":
        return
    import resource

    size = int(megabytes * 1e6)
    resource.setrlimit(resource.RLIMIT_DATA, (size, size))


def peak() -> int | None:
    """Largest memory in use of this process until now, megabytes; None where the system does not tell."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    return next((int(line.split()[1]) // 1000 for line in lines if line.startswith("VmHWM:")), None)


def ran_out(said: bytes) -> bool:
    """Whether a process that wrote this at its end had too little memory."""
    return any(sign in said for sign in _SIGNS)
