# SPDX-License-Identifier: GPL-3.0-or-later
"""Handlers of the application: functions in lists that Blender calls."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import bpy

Handlers = Iterable[tuple[list[Any], Callable[..., None]]]
"""Each list with the function that is to be in it."""


def start(handlers: Handlers) -> None:
    """Have them called from now on; those that are already stay once."""
    for functions, function in handlers:
        if function not in functions:
            functions.append(function)


def stop(handlers: Handlers, timer: Callable[[], float | None]) -> None:
    """Have them called no more, nor a timer that they start."""
    for functions, function in handlers:
        if function in functions:
            functions.remove(function)
    if bpy.app.timers.is_registered(timer):
        bpy.app.timers.unregister(timer)
