# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator that leaves fewer points of outlines, for editing them by hand."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.props import FloatProperty

from ..bodies.strokes import selected
from ..data import frames, written
from ..live import engine, outlined
from ..native import NativeError
from ..text.messages import counted, listed
from ..text.telling import told
from . import shapes
from .drawing import DrawError, refuse
from .fewer import simplified
from .pencil import layer_of


class OBJECT_OT_gridmesh_simplify(bpy.types.Operator):  # noqa: N801
    """Leave fewer points of the outlines of the selected live bodies, so that they are easier to edit"""  # noqa: D400

    bl_idname = "object.gridmesh_simplify"
    bl_label = "Simplify Outline"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    tolerance: FloatProperty(
        name="Tolerance",
        description="How far the outline may move, in parts of its size",
        default=0.002,
        min=0.0,
        soft_max=0.05,
        precision=4,
        step=0.1,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a live body or its outline."""
        if context.mode == "OBJECT" and _chosen(context):
            return True
        cls.poll_message_set(
            told("Select a live body that was drawn with the tool, in Object Mode", "tooltips")
        )
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Simplify each outline that has a body afterwards, too."""
        drawn = shapes.read(context)
        before = after = done = 0
        problems = []
        for ob in _chosen(context):
            try:
                if ob.name not in drawn:
                    raise DrawError(ob.gridmesh_live.problem or "it is hidden")
                counts = _simplified(context, drawn[ob.name], self.tolerance)
            except (DrawError, NativeError) as error:
                problems.append(f"'{ob.name}': {error}")
                continue
            before, after, done = before + counts[0], after + counts[1], done + 1
        if problems:
            self.report({"WARNING"}, told(listed(problems)))
        if not done:
            return {"CANCELLED"}
        self.report(
            {"INFO"}, told(f"Simplified {counted(done, 'outline')}: {before} points before, {after} now")
        )
        return {"FINISHED"}


def _chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Live bodies with an outline of their own, of which one or the other is selected."""
    chosen = set(selected(context))
    found = [ob for ob in engine.bodies() if ob in chosen or ob.gridmesh_live.source in chosen]
    return [ob for ob in found if frames.owned(ob) is not None]


def _simplified(context: bpy.types.Context, drawn: shapes.Drawn, tolerance: float) -> tuple[int, int]:
    """Simplify the outline of a body; return its number of points before and now.

    Raises
    ------
    DrawError
        If the body would be lost; then nothing is changed.
    """
    ob, sketch = drawn.ob, drawn.sketch
    live = ob.gridmesh_live
    if written.by_hand(ob.data):
        raise DrawError(engine.BY_HAND)
    strokes = [one.stroke for one in (sketch, *sketch.holes)]
    kept = [simplified(stroke.points, tolerance * sketch.size) for stroke in strokes]
    rings = [stroke.points[indices] for stroke, indices in zip(strokes, kept, strict=True)]
    flat = [sketch.plane.local(ring)[:, :2] for ring in rings]
    refuse([(flat[0], flat[1:])], live)
    widths = [
        stroke.widths[indices]
        if stroke.widths is not None
        else np.full(len(indices), outlined.RADIUS * sketch.size)
        for stroke, indices in zip(strokes, kept, strict=True)
    ]
    layer = layer_of(live.source, live.layer)
    to_layer = np.linalg.inv(frames.frame(ob) @ frames.layer_matrix(layer))
    gone = [stroke.index for stroke in strokes]
    stay = [index for index in range(sketch.stroke.count) if index not in gone]
    rewritten = [frames.moved(ring, to_layer) for ring in rings]
    outlined.write(layer.current_frame().drawing, gone, rewritten, widths)
    live.stroke, live.count = len(stay), len(stay) + len(rings)
    engine.replaced(ob)
    context.view_layer.update()
    engine.remake(ob)
    return sum(len(stroke.points) for stroke in strokes), sum(len(ring) for ring in rings)


classes = (OBJECT_OT_gridmesh_simplify,)
