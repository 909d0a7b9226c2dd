# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that carry out a stroke: one for each thing that it can do, so that the undo history says what was done.

`object.gridmesh_draw` decides which of them it is, in a window from press to release of the mouse button. It has no
undo step of its own; the operator that it calls has one, and the redo panel.
"""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..native import NativeError, native
from ..text.messages import counted
from ..text.telling import told
from . import drawing, memory, options, planes, shapes, simplifying
from .decision import Decision, DecisionError, Wanted, decide
from .interaction import Interaction, mirror_place

_DONE = {
    "NEW": "Drew {}",
    "EXTEND": "Extended {}",
    "TRIM": "Trimmed {}",
    "HOLE": "Made a hole in {}",
    "PART": "Added {} as part",
}

timing: list[float] = []
"""Seconds that the last mouse moves took, newest last."""

_said: list[tuple[str, str]] = []
"""What an operator had to say that was called by another, which says it in its place."""
_called = False


class _Action(options.StrokeOptions):
    """Do something with a remembered stroke; done again from the redo panel, do what that says."""

    bl_options = {"REGISTER", "UNDO", "INTERNAL"}  # noqa: RUF012

    body: StringProperty(options={"HIDDEN", "SKIP_SAVE"})
    """Body that is changed."""
    done: StringProperty(options={"HIDDEN", "SKIP_SAVE"})
    """What was done before, and to which body; empty the first time."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for object mode."""
        return _may_draw(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Decide, and carry it out."""
        started = perf_counter()
        try:
            made, hint = self._carry_out(context)
        except (drawing.DrawError, DecisionError, memory.ForgottenError, NativeError) as error:
            return self._say("WARNING", str(error), {"CANCELLED"})
        faces = sum(len(ob.data.polygons) for ob in made)
        done = _DONE[self.action].format(counted(len(made), "body"))
        face = "quad" if self.cells == "QUADS" else "triangle"
        numbers = [f"{done}: {counted(faces, face)}"]
        if self.shape != "SHEET":
            numbers.append(f"{faces // 2} a side")
        text = ", ".join([*numbers, f"{1000 * (perf_counter() - started):.0f} ms"])
        return self._say("INFO", f"{text}; {hint}" if hint else text, {"FINISHED"})

    def _carry_out(self, context: bpy.types.Context) -> tuple[list[bpy.types.Object], str]:
        if not self.stroke:
            raise drawing.DrawError("nothing is drawn; use the GridMesh Draw tool in a 3D view")
        remembered = _remembered(self, context)
        bodies = shapes.read(context)
        # What was decided while it was drawn is decided again; what is asked for in the panel is done as asked.
        wanted = remembered.wanted if self.action == remembered.action else Wanted(self.action)
        wanted = replace(wanted, lies=self.part_lies, twin=self.use_twin, joins=self.use_join)
        mirror = remembered.mirror if self.use_mirror else None
        decisions = decide(remembered.trace, shapes.seen(bodies), wanted, mirror)
        first = decisions[0]
        again = self._options_of(first, bodies, remembered)
        self.resolve_curve(context)
        made, problems = drawing.carry_out(context, remembered, decisions, bodies, self, apply_options=again)
        remembered.action = remembered.action or first.action
        self.action, self.body = first.action, first.body if first.action != "PART" else made[0].name
        self.done = f"{first.action} {first.body}"
        return made, "; ".join(filter(None, [first.hint, *problems]))

    def _options_of(
        self, first: Decision, bodies: dict[str, shapes.Drawn], remembered: memory.Memory
    ) -> bool:
        """Show the options of what is changed now, unless that is what was changed before; return whether it is."""
        if self.done == f"{first.action} {first.body}":
            return True
        if first.action not in {"NEW", "PART"}:
            options.put(self, options.of_body(bodies[first.body].ob.gridmesh_live))
        elif self.done:
            options.put(self, remembered.options)
        return False

    def _say(self, level: str, text: str, result: set[str]) -> set[str]:
        text = text[:1].upper() + text[1:]
        if _called:
            _said.append((level, text))
        else:
            self.report({level}, told(text))
        return result

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "action")
        layout.prop(self, "use_mirror")
        if self.action == "PART":
            options.draw_part(layout, self)
        if self.body:
            layout.label(text=self.body, icon="OUTLINER_OB_MESH", translate=False)
        self.draw_shape_options(layout)
        layout.prop(self, "pen")
        self.draw_sketch_options(layout)


class OBJECT_OT_gridmesh_draw_body(_Action, bpy.types.Operator):  # noqa: N801
    """Make a new body of the stroke"""  # noqa: D400 (the tooltip)

    bl_idname = "object.gridmesh_draw_body"
    bl_label = "Draw Body"


class OBJECT_OT_gridmesh_extend_body(_Action, bpy.types.Operator):  # noqa: N801
    """Add the stroke to a body"""  # noqa: D400

    bl_idname = "object.gridmesh_extend_body"
    bl_label = "Extend Body"


class OBJECT_OT_gridmesh_trim_body(_Action, bpy.types.Operator):  # noqa: N801
    """Take the stroke away from a body"""  # noqa: D400

    bl_idname = "object.gridmesh_trim_body"
    bl_label = "Trim Body"


class OBJECT_OT_gridmesh_make_hole(_Action, bpy.types.Operator):  # noqa: N801
    """Make a hole in a body"""  # noqa: D400

    bl_idname = "object.gridmesh_make_hole"
    bl_label = "Make Hole"


class OBJECT_OT_gridmesh_add_part(_Action, bpy.types.Operator):  # noqa: N801
    """Make a body of the stroke that belongs to another one"""  # noqa: D400

    bl_idname = "object.gridmesh_add_part"
    bl_label = "Add Part"


OPERATORS = {
    "NEW": OBJECT_OT_gridmesh_draw_body,
    "EXTEND": OBJECT_OT_gridmesh_extend_body,
    "TRIM": OBJECT_OT_gridmesh_trim_body,
    "HOLE": OBJECT_OT_gridmesh_make_hole,
    "PART": OBJECT_OT_gridmesh_add_part,
}


class OBJECT_OT_gridmesh_draw(options.StrokeOptions, bpy.types.Operator):  # noqa: N801
    """Draw the outline of a body, or across the outline of one to extend it; Shift takes away"""  # noqa: D400

    bl_idname = "object.gridmesh_draw"
    bl_label = "GridMesh Draw"
    # Without undo and redo: what it calls has both.
    bl_options = set()  # noqa: RUF012

    plane: EnumProperty(
        name="Plane",
        description="Where the stroke lies; facing the view, it takes the plane of the body that it meets",
        items=planes.CHOICES,
        default="VIEW",
    )
    use_part: BoolProperty(
        name="Part",
        description="A stroke over a body becomes a part of it, a stroke of its own that the body is joined with",
        default=False,
    )
    use_stabilizer: BoolProperty(
        name="Stabilize Stroke",
        description="Let the stroke follow the mouse at a distance, which smooths it",
        default=False,
    )
    stabilizer_radius: IntProperty(
        name="Radius",
        description="How far the stroke stays behind, in pixels",
        subtype="PIXEL",
        default=35,
        min=0,
        soft_min=10,
        soft_max=100,
    )
    stabilizer_factor: FloatProperty(
        name="Factor",
        description="How slowly the stroke follows",
        subtype="FACTOR",
        default=0.75,
        min=0.0,
        max=0.99,
    )
    subtract: BoolProperty(options={"HIDDEN", "SKIP_SAVE"})
    """For scripts: take away, as with Shift."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for object mode."""
        return _may_draw(cls, context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Begin a stroke at the mouse."""
        if context.region_data is None:
            self.report({"WARNING"}, told("Draw in a 3D view"))
            return {"CANCELLED"}
        try:
            native("mesh_sketch", "combine")
        except NativeError as error:
            self.report({"ERROR"}, told(str(error)))
            return {"CANCELLED"}
        self._interaction = Interaction(context, event, self)
        self._add(context, event)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Follow the mouse; every way out takes the preview away."""
        started = perf_counter()
        if event.type in {"MOUSEMOVE", "INBETWEEN_MOUSEMOVE"}:
            if self._add(context, event) and event.type == "MOUSEMOVE":
                self._interaction.show(context, event)
                timing.append(perf_counter() - started)
                del timing[:-500]
            return {"RUNNING_MODAL"}
        if event.type in {"ESC", "RIGHTMOUSE"} or (event.type == "Z" and event.ctrl):
            self._interaction.end(context)
            return {"CANCELLED"}
        if event.type == self._interaction.button and event.value == "RELEASE":
            self._add(context, event)
            self._interaction.end(context)
            if self._interaction.is_click(context):
                return self._interaction.click(context, event)
            return self._finished(context, event)
        if self._interaction.key(event):
            self._interaction.show(context, event)
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the tool: a file is opened, or a window closed."""
        self._interaction.end(context)

    def _add(self, context: bpy.types.Context, event: bpy.types.Event) -> bool:
        return self._interaction.add(context, event)

    def _finished(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        interaction = self._interaction
        try:
            decisions = interaction.decided(event)
        except DecisionError as error:
            return self._told("WARNING", str(error), {"CANCELLED"})
        self.use_mirror = interaction.mirrored
        self.part_lies, self.use_twin = interaction.lies, interaction.twin
        return self._call(interaction.memory(event, options.of_operator(self)), decisions[0].action)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Draw a stroke that a script gives, as text of `gesture.pack` in the plane of a matrix."""
        if not self.stroke:
            return self._told(
                "WARNING", "nothing is drawn; use the GridMesh Draw tool in a 3D view", {"CANCELLED"}
            )
        try:
            remembered = _remembered(self, context)
            remembered.options = options.of_operator(self)
            bodies = shapes.read(context)
            mirror = remembered.mirror if self.use_mirror else None
            found = shapes.seen(bodies)
            wanted = replace(remembered.wanted, lies=self.part_lies, twin=self.use_twin)
            decisions = decide(remembered.trace, found, wanted, mirror)
        except (DecisionError, memory.ForgottenError, NativeError) as error:
            return self._told("WARNING", str(error), {"CANCELLED"})
        return self._call(remembered, decisions[0].action)

    def _call(self, remembered: memory.Memory, action: str) -> set[str]:
        """Call the operator that does it, which makes the undo step."""
        global _called
        remembered.action = action
        name = OPERATORS[action].bl_idname.removeprefix("object.")
        _said.clear()
        _called = True
        try:
            result = getattr(bpy.ops.object, name)(
                "EXEC_DEFAULT",
                True,
                stroke=memory.keep(remembered),
                action=action,
                use_mirror=self.use_mirror,
                **remembered.options,
            )
        finally:
            _called = False
        for level, text in _said:
            self.report({level}, told(text))
        return result

    def _told(self, level: str, text: str, result: set[str]) -> set[str]:
        self.report({level}, told(text[:1].upper() + text[1:]))
        return result


def _may_draw(cls: Any, context: bpy.types.Context) -> bool:
    if context.mode == "OBJECT":
        return True
    cls.poll_message_set(told("Leave the mode: bodies are drawn in Object Mode", "tooltips"))
    return False


def _remembered(operator: Any, context: bpy.types.Context) -> memory.Memory:
    """Return the stroke that an operator has the name of, or the points."""
    known = memory.recall(operator.stroke)
    if known is not None:
        return known
    wanted = Wanted(
        operator.action,
        subtract=getattr(operator, "subtract", False),
        part=getattr(operator, "use_part", False),
    )
    free = getattr(operator, "plane", "VIEW") == "VIEW"
    place = mirror_place(context)
    return memory.given(operator.stroke, list(operator.matrix), wanted, free=free, place=place)


classes = (OBJECT_OT_gridmesh_draw, *OPERATORS.values(), *simplifying.classes)
