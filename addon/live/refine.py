# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_refine`: enough triangles for the thin parts of live bodies; and where that is offered."""

from __future__ import annotations

from typing import Any

import bpy

from ..bodies import density
from ..data import frames
from ..native import NativeError
from ..overlay import viewport
from ..text.telling import told
from . import engine
from . import ui as live_ui
from .reading import LostError, sketch_of

_known: dict[int, tuple[tuple[str, int], density.Density | None]] = {}
"""By the object's session uid: what it was made of, and what was measured."""


def of_body(ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> density.Density | None:
    """Triangles across the thinnest limb of a live body; None if it has none, or no drawing."""
    live = ob.gridmesh_live
    key = (live.digest, len(ob.data.polygons))
    kind = "quad" if live.cells == "QUADS" else "triangle"
    known = _known.get(ob.session_uid)
    if known is not None and known[0] == key:
        return known[1]
    if not live.digest:
        return None  # it is being dragged
    try:
        sketch = sketch_of(ob, depsgraph)
        sides = 1 if live.shape == "SHEET" else 2
        found = density.measure(sketch, len(ob.data.polygons) // sides, kind)
    except (LostError, NativeError):
        found = None  # the body's own panel says what is wrong with the drawing
    if len(_known) > 200:
        _known.clear()
    _known[ob.session_uid] = key, found
    return found


class OBJECT_OT_gridmesh_refine(live_ui.OnBodies, bpy.types.Operator):  # noqa: N801
    """Give the selected live bodies as many triangles as put five across their thinnest limbs"""  # noqa: D400

    bl_idname = "object.gridmesh_refine"
    bl_label = "Enough Triangles"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def chosen(cls, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Those of them that can be changed."""
        return [ob for ob in super().chosen(context) if ob.is_editable]

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Leave the number of triangles to the drawing, and make the bodies anew."""
        problems = []
        for ob in self.chosen(context):
            live = ob.gridmesh_live
            live.quiet = True
            live.resolution = "AUTO"
            live.quiet = False
            engine.remake(ob)
            if live.problem:
                problems.append(f"'{ob.name}': {live.problem}")
        if problems:
            self.report({"WARNING"}, told("\n".join(problems[:3])))
        return {"FINISHED"}


def _offer(panel: Any, context: bpy.types.Context) -> None:
    """Draw below a live body's options that it has too few triangles."""
    ob = context.view_layer.objects.active
    found = of_body(ob, context.evaluated_depsgraph_get())
    if found is None or not found.is_low:
        return
    column = panel.layout.column(align=True)
    for part in found.text.split("; "):
        column.label(text=told(part, "interface"), icon="INFO" if part.startswith("thinnest") else "BLANK1")
    column.operator(OBJECT_OT_gridmesh_refine.bl_idname)


def _note(ob: bpy.types.Object, context: bpy.types.Context) -> list[str]:
    """What the overlay writes of a body with too few triangles."""
    found = of_body(ob, context.evaluated_depsgraph_get()) if frames.is_linked(ob) else None
    return found.text.split("; ") if found is not None and found.is_low else []


def register() -> None:
    """Offer it in the panel of live bodies, and tell of it in the overlay."""
    live_ui.VIEW3D_PT_gridmesh_live.append(_offer)
    viewport.notes.append(_note)


def unregister() -> None:
    """Take it away."""
    live_ui.VIEW3D_PT_gridmesh_live.remove(_offer)
    if _note in viewport.notes:
        viewport.notes.remove(_note)
    _known.clear()


classes = (OBJECT_OT_gridmesh_refine,)
