# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a thread, while the operator waits for it in the window: Esc stops it, the status bar says how far it is.

An operator that is called from a script, or without a window, does its work at once.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from time import perf_counter
from typing import Any

import bpy

from .. import api
from ..text.telling import told

NAVIGATION = {"MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "NDOF_MOTION"}
"""Events that Blender still gets: the view can be turned meanwhile, and nothing else be done."""


class _Work(threading.Thread):
    """A call and what became of it. It gets no Blender data: only the main thread may touch that."""

    def __init__(self, call: Callable[[api.Progress], Any]) -> None:
        super().__init__(name="gridmesh", daemon=True)
        self._call = call
        self.fraction = 0.0
        self.stopped = False
        self.result: Any = None
        self.error: BaseException | None = None
        self.seconds = 0.0

    def run(self) -> None:
        started = perf_counter()
        try:
            self.result = self._call(self._progress)
        except BaseException as error:  # raised again where the operator waits
            self.error = error
        self.seconds = perf_counter() - started

    def _progress(self, fraction: float) -> bool:
        self.fraction = max(self.fraction, fraction)
        return not self.stopped


class Waiting:
    """Mixed into operators. `execute` calls `wait` for long work, and is called again when the work is done."""

    may_wait = False
    """Whether there is a window and a user; `invoke` sets it."""

    def wait(self, context: bpy.types.Context, call: Callable[[api.Progress], Any]) -> set[str]:
        """Start the work and wait for it; `execute` is called again and takes the result by `take_done`."""
        self.may_wait = False
        self._work = _Work(call)
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        self._work.start()
        return {"RUNNING_MODAL"}

    def waited(self) -> float:
        """Seconds of the work whose result is to be taken."""
        work = self.__dict__.get("_work")
        return work.seconds if work is not None else 0.0

    def take_done(self) -> Any:
        """Result of work that was waited for, once; None if there was none."""
        work = self.__dict__.pop("_work", None)
        if work is None:
            return None
        if work.error is not None:
            raise work.error
        return work.result

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Wait, show how far the work is, and stop it when asked to."""
        work = self._work
        if event.type == "ESC" and event.value == "PRESS":
            work.stopped = True
        if event.type in NAVIGATION:
            return {"PASS_THROUGH"}
        if event.type == "TIMER":
            if not work.is_alive():
                self._leave(context)
                return self.execute(context)
            far = f"{self.bl_label}: {100 * work.fraction:.0f}%"
            text = f"{far}   Stopping" if work.stopped else f"{far}   Esc: Stop"
            context.workspace.status_text_set(told(text, "interface"))
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Stop the work where Blender ends the operator."""
        self._work.stopped = True
        self._work.join()
        self._leave(context)

    def _leave(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)
