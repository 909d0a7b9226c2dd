# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the work is, shown at the mouse pointer while an operator runs.

Blender handles no events meanwhile, so Esc cannot be seen (longer work waits in `operators.waiting`); Ctrl-C in the
terminal that Blender was started from stops the work where Python gets it, and the operator leaves the scene as it was.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from types import TracebackType

import bpy

_STEPS = 100


class Pointer:
    """Context manager; as a callable it is the progress that `gridmesh` asks for."""

    def __init__(self, context: bpy.types.Context) -> None:
        shown = context.window is not None and not bpy.app.background
        self._manager = context.window_manager if shown else None
        self._thread = threading.get_ident()
        self._step = 0

    def __enter__(self) -> Pointer:
        if self._manager is not None:
            self._manager.progress_begin(0, _STEPS)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._manager is not None:
            self._manager.progress_end()

    def part(self, begin: float, end: float) -> Callable[[float], bool]:
        """Progress of a part of the work, from one fraction to another."""
        return lambda fraction: self(begin + fraction * (end - begin))

    def __call__(self, fraction: float) -> bool:
        """Show the fraction. The library's own threads call too: to them Blender's data is closed."""
        step = int(_STEPS * fraction)
        if self._manager is not None and step > self._step and threading.get_ident() == self._thread:
            self._manager.progress_update(step)
            self._step = step
        return True
