# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets a body follow its profile curve while a point of it is dragged.

Blender tells of a change in the widget when the mouse button is released, and not before. So as long as the widget is to
be seen, somebody looks at the curve.
"""

from __future__ import annotations

from time import perf_counter

import bpy

from ..bodies import profilecurve
from ..data import frames
from . import engine

CATEGORY = "GridMesh"
"""Tab of the sidebar that the widget is in."""

OFTEN, SELDOM = 1 / 30, 0.15
"""Seconds between two looks, while the curve is being changed and otherwise."""

_seen: dict[int, profilecurve.Points | None] = {}
_changed = 0.0


def watch() -> None:
    """Look at the curves that are to be seen from now on. Called when the widget is drawn."""
    if not bpy.app.background and not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=SELDOM)


def _shown() -> list[bpy.types.Object]:
    """Bodies whose curve is to be seen in a window."""
    found = []
    for window in bpy.context.window_manager.windows:
        active = window.view_layer.objects.active
        if active is None or profilecurve.holder(active) is None or not frames.is_linked(active):
            continue
        views = (area for area in window.screen.areas if area.type == "VIEW_3D")
        sides = (region for area in views for region in area.regions if region.type == "UI")
        if any(region.width > 1 and region.active_panel_category == CATEGORY for region in sides):
            found.append(active)
    return found


def _look() -> float | None:
    """Timer: let bodies follow whose curve is another one than at the last look; end with the widget."""
    global _changed
    shown = _shown()
    if not shown:
        _seen.clear()
        return None
    for ob in shown:
        points = profilecurve.points(ob)
        if _seen.get(ob.session_uid, points) != points:
            _changed = perf_counter()
            engine.touch(ob)
    _seen.clear()
    _seen.update({ob.session_uid: profilecurve.points(ob) for ob in shown})
    return OFTEN if perf_counter() - _changed < 1.0 else SELDOM


def register() -> None:
    """Nothing to do before a widget is drawn."""


def unregister() -> None:
    """Look no more."""
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
    _seen.clear()
