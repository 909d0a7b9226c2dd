# SPDX-License-Identifier: GPL-3.0-or-later
"""A stroke with the mouse or a pen, from press to release: what it would do is decided and shown at every move."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface
from mathutils import Vector

from ..bodies.strokes import selected
from ..join import characters, following, showing
from ..live import engine
from ..text.telling import told
from . import parts, planes, shapes
from .decision import Decision, DecisionError, Shape, Wanted, decide
from .gesture import Gesture
from .memory import Memory
from .preview import Preview
from .steady import Pixel, Steady
from .trace import Mirror, Trace

drawing_now = False
"""Whether a stroke is being drawn."""


def _words() -> dict[str, str]:
    """What a stroke does, in the user's language."""
    return {
        "NEW": pgettext_iface("New Body"),
        "EXTEND": pgettext_iface("Extend"),
        "TRIM": pgettext_iface("Trim"),
        "HOLE": pgettext_iface("Hole in"),
        "PART": pgettext_iface("Part of"),
        "": pgettext_iface("Nothing"),
    }


def mirror_place(context: bpy.types.Context) -> np.ndarray:
    """Point (3,) that the mirror goes through: the origin of the active live body, else the 3D cursor."""
    active = context.view_layer.objects.active
    if active is not None and active.type == "MESH" and following.changes(active):
        return np.array(active.matrix_world.translation, float)
    return np.array(context.scene.cursor.location, float)


class Interaction:
    """What is known of a stroke while it is drawn.

    options : those of the operator, with the plane, the action that was chosen and the stabilizer.
    """

    def __init__(self, context: bpy.types.Context, event: bpy.types.Event, options: Any) -> None:
        global drawing_now
        self.button = event.type
        self.options = options
        self.mirrored = options.use_mirror
        self.lies, self.twin = options.part_lies, options.use_twin
        self._part = options.use_part or options.action == "PART"
        self._problem = ""
        self._view = context.region_data
        pixel = _pixel(context, event)
        try:
            self._plane = planes.chosen(context, options.plane, pixel)
        except planes.PlaneError as error:
            # A click selects all the same.
            self._problem = str(error)
            self._plane = planes.chosen(context, "VIEW", pixel)
        self._bodies: list[Shape] | None = None
        self._mirror = _mirror(context)
        length = options.edge_length if options.resolution == "EDGE_LENGTH" else None
        kind = options.cells.lower()
        number = None if options.resolution == "AUTO" else getattr(options, kind)
        self._gesture = Gesture(number, length, kind)
        self._steady: Steady | None = None
        if options.use_stabilizer:
            radius = options.stabilizer_radius * context.preferences.system.ui_scale
            self._steady = Steady(radius, options.stabilizer_factor)
        self._preview = Preview(context)
        drawing_now = True
        self._tell(context, "")

    def add(self, context: bpy.types.Context, event: bpy.types.Event) -> bool:
        """Append where the mouse is; return whether the stroke has grown."""
        pixel = _pixel(context, event)
        if self._steady is None:
            return self._append(context, event, pixel)
        behind = self._steady.follow(pixel)
        grown = behind is not None and self._append(context, event, behind)
        if grown:
            self._steady.add(behind)
        return self._close(context) or grown

    def _append(self, context: bpy.types.Context, event: bpy.types.Event, pixel: Pixel) -> bool:
        """Append what is seen at a pixel; return whether it is a new point."""
        point = planes.on_plane(context, self._plane, pixel)
        # A mouse has no pressure: it draws at full width.
        pressure = event.pressure if event.is_tablet else 1.0
        return point is not None and self._gesture.add(pixel, point, pressure, planes.ray(context, pixel))

    def _close(self, context: bpy.types.Context) -> bool:
        """Close a steady stroke while the mouse is at its start; return whether that changes it."""
        left_out, pixels = self._steady.lap()
        points = [planes.on_plane(context, self._plane, pixel) for pixel in pixels]
        if any(point is None for point in points):
            left_out, pixels, points = 0, [], []
        rays = [planes.ray(context, pixel) for pixel in pixels]
        return self._gesture.close(left_out, list(zip(points, rays, strict=True)))

    def key(self, event: bpy.types.Event) -> bool:
        """Take a key; return whether it changes what is shown."""
        if event.type in {"LEFT_SHIFT", "RIGHT_SHIFT", "LEFT_CTRL", "RIGHT_CTRL"}:
            return True
        if event.value == "PRESS" and event.type == "P":
            self._part = not self._part
            return True
        if event.value == "PRESS" and event.type == "D":
            at = parts.NEXT.index(self.lies) + 1 if self.lies in parts.NEXT else 0
            self.lies = parts.NEXT[at % len(parts.NEXT)]
            return True
        if event.value == "PRESS" and event.type == "T":
            self.twin = not self.twin
            return True
        if event.value == "PRESS" and event.type == "X":
            self.mirrored = not self.mirrored
            return True
        return False

    def trace(self) -> Trace:
        """Return the stroke so far."""
        free = self.options.plane == "VIEW"
        return self._gesture.trace(self._plane, free=free, perspective=self._view.is_perspective)

    def wanted(self, event: bpy.types.Event) -> Wanted:
        """Return what is asked for by the header and the keys."""
        joins = self.options.use_join
        if self.options.action not in {"AUTO", "PART"}:
            return Wanted(self.options.action, joins=joins)
        taken = event.shift or event.ctrl
        return Wanted("AUTO", subtract=taken, part=self._part, lies=self.lies, twin=self.twin, joins=joins)

    def decided(self, event: bpy.types.Event) -> list[Decision]:
        """Decide what the stroke does now.

        Raises
        ------
        DecisionError
            If it does nothing.
        """
        if self._problem:
            raise DecisionError(self._problem)
        if not len(self._gesture):
            raise DecisionError("the stroke is too short; drag to draw an outline")
        if self._bodies is None:  # once, and not for a click
            self._bodies = shapes.seen(shapes.read(bpy.context))
        mirror = self._mirror if self.mirrored else None
        return decide(self.trace(), self._bodies, self.wanted(event), mirror)

    def memory(self, event: bpy.types.Event, options: dict[str, Any]) -> Memory:
        """Return what is to be remembered of the stroke."""
        return Memory(self.trace(), self.wanted(event), self._mirror, options)

    def show(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        """Show the stroke, what it would do and the keys."""
        if not len(self._gesture) or self.is_click(context):
            return
        mirror = self._mirror if self.mirrored else None
        try:
            decisions = self.decided(event)
        except DecisionError as error:
            decisions, word, hint = [], _words()[""], told(str(error), "interface")
        else:
            word, hint = _word(decisions[0]), told(decisions[0].hint, "interface")
        plane = decisions[0].plane if decisions else self._plane
        if decisions and decisions[0].twin is not None:
            mirror = decisions[0].twin
        mouse = _pixel(context, event)
        self._preview.show(self.trace(), plane, decisions, self._gesture, mirror)
        self._preview.say(word, hint, mouse)
        self._tell(context, f"{word}    {hint}    " if hint else f"{word}    ")

    def _tell(self, context: bpy.types.Context, text: str) -> None:
        keys = (
            pgettext_iface("Shift, Ctrl: Take Away"),
            pgettext_iface("P: Part"),
            *((pgettext_iface("D: Part Lies"), pgettext_iface("T: Twin")) if self._part else ()),
            pgettext_iface("X: Mirror"),
            pgettext_iface("Esc, Right Click: Leave"),
        )
        context.workspace.status_text_set(told(text + "    ".join(keys), "interface"))

    def is_click(self, context: bpy.types.Context) -> bool:
        """Whether the mouse was not dragged yet."""
        inputs = context.preferences.inputs
        return (
            self._gesture.across < max(3, inputs.drag_threshold_mouse) * context.preferences.system.ui_scale
        )

    def click(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Select what is under the mouse, with Shift too; an outline stands for its body."""
        before, chosen = set(selected(context)), context.view_layer.objects.active
        if chosen not in before:
            chosen = None
        x, y = _pixel(context, event)
        bpy.ops.view3d.select(
            "EXEC_DEFAULT", False, toggle=event.shift, deselect_all=not event.shift, location=(int(x), int(y))
        )
        layer = context.view_layer
        for ob in set(selected(context)) - before:
            bodies = [body for body in engine.bodies(ob) if body.visible_get() and not body.hide_select]
            if bodies:
                ob.select_set(False)
                for body in bodies:
                    body.select_set(True)
                if layer.objects.active == ob:
                    layer.objects.active = bodies[0]
        active = layer.objects.active
        if active is not None and not event.shift:
            owned = [body for body in engine.bodies(active) if body.select_get()]
            layer.objects.active = owned[0] if owned else active
            self._pick(context, event, chosen)
        showing.put_away(following.wholes())
        bpy.ops.ed.undo_push(message="Select")
        return {"FINISHED"}

    def _pick(
        self, context: bpy.types.Context, event: bpy.types.Event, before: bpy.types.Object | None
    ) -> None:
        """Pick the part under the mouse where a joined body is clicked that was selected and active already, or a part of it."""
        active = context.view_layer.objects.active
        if before is None or not following.is_whole(active) or following.whole_of(before) != active:
            return
        origin, direction = planes.ray(context, _pixel(context, event))
        depsgraph = context.evaluated_depsgraph_get()
        hit, place, *_ = context.scene.ray_cast(depsgraph, Vector(origin), Vector(direction))
        part = characters.nearest(active, place) if hit else None
        if part is not None:
            characters.pick(part)

    def end(self, context: bpy.types.Context) -> None:
        """Take the preview away."""
        global drawing_now
        drawing_now = False
        self._preview.remove()
        if context.workspace is not None:
            context.workspace.status_text_set(None)


def _word(decision: Decision) -> str:
    """Say what would be done, and to which body."""
    names = " + ".join(f"'{name}'" for name in (decision.body, *decision.joined) if name)
    said = f"{_words()[decision.action]} {names}".strip()
    if decision.action == "PART":
        return f"{said}, {_depths()[np.sign(decision.depth)]}"
    return said


def _depths() -> dict[float, str]:
    """Where a part lies, in the user's language."""
    return {
        1.0: pgettext_iface("In Front"),
        0.0: pgettext_iface("Middle"),
        -1.0: pgettext_iface("Behind"),
    }


def _pixel(context: bpy.types.Context, event: bpy.types.Event) -> tuple[float, float]:
    return event.mouse_x - context.region.x, event.mouse_y - context.region.y


def _mirror(context: bpy.types.Context) -> Mirror:
    place = mirror_place(context)
    view = context.region_data
    turn = np.array(view.view_rotation.to_matrix(), float)
    right, up = turn[:, 0], turn[:, 1]
    if not view.is_perspective:
        return Mirror(place, right)
    eye = np.array(view.view_matrix.inverted().translation, float)
    across = np.cross(place - eye, up)
    length = float(np.linalg.norm(across))
    return Mirror(place, across / length if length > 1e-9 else right)
