# SPDX-License-Identifier: GPL-3.0-or-later
"""The right name in the undo history for what was changed in the redo panel.

Blender names an undo step after the operator, and the redo panel runs the same operator again. Where that has done
something else than its name says, it is undone once more when Blender is idle, and the operator of that name does it.
"""

from __future__ import annotations

from typing import Any

import bpy

_waiting: tuple[str, str, str] | None = None
"""Operator that was run, the stroke that it was run for, and the operator that it should be."""


def later(operator: Any, idname: str) -> None:
    """Run `idname` in place of an operator that is just finishing; without a window nothing is done."""
    global _waiting
    if bpy.app.background:
        return
    _waiting = operator.bl_idname, operator.stroke, idname
    if not bpy.app.timers.is_registered(_rename):
        bpy.app.timers.register(_rename, first_interval=0.0)


def _rename() -> None:
    global _waiting
    if _waiting is None:
        return
    (name, stroke, wanted), _waiting = _waiting, None
    manager = bpy.context.window_manager
    window = manager.windows[0]
    last = manager.operators[-1] if len(manager.operators) else None
    group, short = name.split(".")
    if last is None or last.bl_idname != f"{group.upper()}_OT_{short}" or last.stroke != stroke:
        return  # something else was done meanwhile
    if any(len(one.modal_operators) for one in manager.windows):
        return
    names = [option.identifier for option in last.properties.bl_rna.properties]
    values = {name: getattr(last.properties, name) for name in names if name not in {"rna_type", "matrix"}}
    area = next((area for area in window.screen.areas if area.type == "VIEW_3D"), None)
    region = next((region for region in area.regions if region.type == "WINDOW"), None) if area else None
    with bpy.context.temp_override(window=window, area=area, region=region):
        if bpy.ops.ed.undo.poll() and bpy.ops.ed.undo() == {"FINISHED"}:
            getattr(bpy.ops.object, wanted.split(".")[1])("EXEC_DEFAULT", True, **values)


def unregister() -> None:
    """Forget what was to be done."""
    global _waiting
    _waiting = None
    if bpy.app.timers.is_registered(_rename):
        bpy.app.timers.unregister(_rename)
