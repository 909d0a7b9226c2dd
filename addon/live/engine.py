# SPDX-License-Identifier: GPL-3.0-or-later
"""When bodies follow: after every change of their drawing, quickly; and in full when the change has ended.

While a stroke is dragged the lattice stays, with its bend, so that the mesh does not jump. When nothing has changed for a moment and
no tool is running, the best lattice is searched, so that the result depends on the stroke alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import bpy
import numpy as np

from ..api import Body
from ..bodies import profilecurve
from ..bodies.outlines import Plane, Sketch, Stroke
from ..data import frames, meshes, written
from ..native import NativeError
from ..ui.properties import may_bend
from . import applied, family, linework
from .family import bodies
from .reading import LostError, sketch_of
from .solve import ALGORITHM, Lattice, LeftError, SolveError, digest, solve
from .writing import write

PAUSE = 0.35
"""Seconds without a change after which a change has ended."""

in_background = False
"""Whether bodies follow without a window, too."""


@dataclass
class _State:
    """What is known of a body in this session."""

    seen: str
    """Fingerprint of what it was made of last, in full or quickly."""
    options: str
    frame: bytes
    """How the drawing lay to the body."""
    lattice: Lattice | None = None
    since: float = 0.0
    """When it changed last; 0 when it was made in full."""
    failed: str = ""
    """Fingerprint of what has no body."""
    points: np.ndarray | None = None
    """What was drawn; see `applied.trace`."""


BY_HAND = "its mesh was changed by hand; Rebuild from Outline gives that up, Freeze keeps it"
"""Why a body pauses whose mesh is not what was made of its stroke."""

_states: dict[int, _State] = {}
rendering = False
"""Set while a render runs, during which nothing is changed."""
_busy = False

timing: list[float] = []
"""Seconds of the last updates, newest last."""


def awake() -> bool:
    """Whether bodies may follow now."""
    return not rendering and not _busy and (in_background or not bpy.app.background)


def link(ob: bpy.types.Object, stroke: Stroke, source: bpy.types.Object, maker: Any, *, follow: bool) -> None:
    """Link a body that was just made from a stroke of `source`; `maker` has the options that it was made with.

    Both have to be evaluated: they stay where they are, and from then on lie to each other as they do.
    """
    live = ob.gridmesh_live
    live.linked, live.source, live.algorithm = True, source, ALGORITHM
    live.layer, live.stroke, live.count = stroke.layer, stroke.index, stroke.count
    live.copy_options(maker)
    points = maker.curve_points()
    if points is not None:
        profilecurve.put(ob, points)
    if frames.stored(ob) is None:
        known = meshes.LINK in ob
        place = frames.carrier_world(source, stroke.layer)
        frames.remember(
            ob, meshes.frame_of_link(ob, place) if known else frames.apart(source, stroke.layer, ob)
        )
    if meshes.LINK in ob:
        del ob[meshes.LINK]
    live.digest = ""
    family.claim(ob)
    family.meet(ob)
    family.note_place(ob)
    live.enabled = follow


def freeze(ob: bpy.types.Object) -> None:
    """Make a plain mesh of a body: it knows nothing of its stroke any more. An outline of its own goes."""
    outline = frames.owned(ob)
    if ob.data.users > 1:
        ob.data = ob.data.copy()  # those that share it go on
    ob.property_unset("gridmesh_live")
    ob.data.property_unset("gridmesh_made")
    profilecurve.remove(ob)
    if meshes.LINK in ob:
        del ob[meshes.LINK]
    _states.pop(ob.session_uid, None)
    if outline is not None and not bodies(outline):
        linework.remove(outline)


@contextmanager
def resting() -> Iterator[None]:
    """Let no body follow for a while."""
    global _busy
    before, _busy = _busy, True
    try:
        yield
    finally:
        _busy = before


def touch(ob: bpy.types.Object) -> None:
    """Let a body follow now if it is awake."""
    if awake():
        follow(ob, bpy.context.evaluated_depsgraph_get())


def settle() -> int:
    """Bring bodies and drawings in order, and make every body in full that is not; return how many were made."""
    if not awake():
        return 0
    family.mend()
    return refresh()


def refresh() -> int:
    """Make every body in full that is not; return how many were made."""
    if not awake():
        return 0
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return sum(follow(ob, depsgraph, full=True) for ob in bodies())


def replaced(ob: bpy.types.Object) -> None:
    """Make a body in full when it is looked at next: it has another outline, of which nothing was dragged."""
    _states.pop(family.writer(ob).session_uid, None)


def remake(ob: bpy.types.Object) -> bool:
    """Make a body in full because somebody asked, whether it follows or not, and whether there is a window or not.

    One that shares its mesh hands its options over to the body that writes that.
    """
    asked, ob = ob, hand_over(ob)
    _states.pop(ob.session_uid, None)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with resting():
        done = _updated(ob, depsgraph, True)
    _tell(asked.gridmesh_live, ob.gridmesh_live.problem)
    return done


def hand_over(ob: bpy.types.Object) -> bpy.types.Object:
    """Give the options of a body to the others that share its mesh and drawing; return the one that writes the mesh."""
    writer = family.writer(ob)
    if ob.data.users < 2:
        return writer
    own = ob.gridmesh_live
    for other in bodies(own.source):
        if other == ob or other.data != ob.data or not other.is_editable:
            continue
        live = other.gridmesh_live
        live.copy_options(own)
        live.quiet = True
        live.pen, live.pen_detail, live.algorithm = own.pen, own.pen_detail, own.algorithm
        live.quiet = False
        points = own.curve_points()
        if points is None:
            profilecurve.remove(other)
        else:
            profilecurve.put(other, points)
    return writer


def rebuild(ob: bpy.types.Object) -> None:
    """Make a body anew whose mesh was changed by hand, and let it follow again; the changes are lost."""
    if not written.is_edited(ob) and ob.is_editable and ob.data.is_editable:
        written.sign(ob.data)
    ob.gridmesh_live.digest = family.writer(ob).gridmesh_live.digest = ""
    remake(ob)
    ob.gridmesh_live.enabled = True


def fingerprint(live: Any, sketch: Sketch) -> str:
    """Fingerprint of all that a body depends on."""
    return digest(sketch, *_options(live))


def _options(live: Any) -> tuple[dict[str, Any], dict[str, Any] | None, float, float]:
    return live.sketch_options(), live.body_options(), live.pen, live.pen_detail if may_bend(live) else 0.0


def _hindrance(ob: bpy.types.Object) -> str:
    """Why a body cannot follow, whatever its stroke; empty if it can."""
    if not ob.is_editable or not ob.data.is_editable:
        return "it is linked from another file"
    if written.is_edited(ob):
        return "it is being edited; leave its mode"
    if ob.data.shape_keys is not None:
        return "it has shape keys, which fit no new mesh"
    if written.by_hand(ob.data):
        return BY_HAND
    if ob.gridmesh_live.algorithm != ALGORITHM:
        return "it was made by another version of GridMesh; press Adopt to make it anew with this one"
    return ""


def follow(ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph, *, full: bool = False) -> bool:
    """Bring a body up to date with its stroke; return whether its mesh was made anew."""
    if not ob.gridmesh_live.enabled:
        return False
    writer = family.writer(ob)
    if writer != ob:
        _tell(ob.gridmesh_live, writer.gridmesh_live.problem)
        return False
    started = perf_counter()
    with resting():
        done = _updated(ob, depsgraph, full)
    if done:
        timing.append(perf_counter() - started)
        del timing[:-200]
    return done


def _updated(ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph, full: bool) -> bool:
    live, uid = ob.gridmesh_live, ob.session_uid
    applied.absorb(ob)
    reason = _hindrance(ob)
    if reason:
        _tell(live, reason)
        return False
    try:
        sketch = sketch_of(ob, depsgraph)
    except LostError as error:
        _tell(live, str(error))
        return False
    _remember_frame(ob)
    frame = _frame(ob)
    mark, options = fingerprint(live, sketch), repr(_options(live))
    state, points = _states.get(uid), applied.trace(sketch)
    settled = state is not None and live.digest and state.seen == live.digest and state.options == options
    if settled and applied.alike(ob, state.points, points):  # a transform was applied
        live.digest = state.seen = mark
    if live.digest == mark or (not full and state is not None and state.seen == mark):
        if state is None or state.seen != mark:
            _states[uid] = _State(mark, options, frame, points=points)
        elif live.digest == mark:
            state.since, state.frame = 0.0, frame
        if (live.stroke, live.count) != (sketch.stroke.index, sketch.stroke.count):
            live.stroke, live.count = sketch.stroke.index, sketch.stroke.count
        _tell(live, "")
        return False
    if full and state is not None and state.failed == mark:
        state.since = 0.0
        return False
    lattice = None
    if not full and state is not None and state.options == options:
        lattice = state.lattice or _stored(live)
    state = _states[uid] = _State(mark, options, frame, lattice, perf_counter(), points=points)
    try:
        body, state.lattice = _solved(live, sketch, lattice)
    except (SolveError, NativeError) as error:
        _tell(live, str(error))
        if lattice is None:
            state.failed, state.since = mark, 0.0
        else:
            _wait()  # the best lattice may do, but to look for it would hold up the drag
        return False
    write(ob, meshes.in_space(body, frames.space(ob)), live.corner_angle, marks=lattice is None)
    slots = [state.lattice.edge_length, state.lattice.angle, *state.lattice.origin]
    live.lattice = [float(value) for value in slots]
    live.plane = [*state.lattice.plane.origin.tolist(), *state.lattice.plane.axes.ravel().tolist()]
    applied.remember(ob, sketch)
    live.stroke, live.count = sketch.stroke.index, sketch.stroke.count
    live.digest = mark if lattice is None else ""
    state.since = 0.0 if lattice is None else perf_counter()
    _tell(live, "")
    if lattice is not None:
        _wait()
    return True


def _frame(ob: bpy.types.Object) -> bytes:
    """How the drawing of a body lies to it, to be compared."""
    live = ob.gridmesh_live
    layers = live.source.data.layers if live.source.type == "GREASEPENCIL" else ()
    own = [frames.layer_matrix(layer).tobytes() for layer in layers if layer.name == live.layer]
    return b"".join([frames.frame(ob).tobytes(), *own])


def lies_otherwise(ob: bpy.types.Object) -> bool:
    """Whether the drawing of a body lies in another way to it than when that was looked at last; or it was not."""
    state = _states.get(ob.session_uid)
    return state is None or ob.gridmesh_live.source is None or state.frame != _frame(ob)


def _remember_frame(ob: bpy.types.Object) -> None:
    """Store how an outline lies in its body, also with the bodies that share the mesh."""
    source = ob.gridmesh_live.source
    if not frames.nested(source, ob):
        return
    matrix = frames.frame(ob)
    sharers = [ob] if ob.data.users < 2 else [other for other in bodies(source) if other.data == ob.data]
    for one in sharers:
        frames.remember(one, matrix)


def _solved(live: Any, sketch: Sketch, lattice: Lattice | None) -> tuple[Body, Lattice]:
    """Solve on the lattice that stays; if the stroke has left its plane, on the best one."""
    sketch_options, body_options, pen, detail = _options(live)
    if lattice is not None:
        try:
            return solve(sketch, sketch_options, body_options, lattice=lattice, pen=pen, pen_detail=detail)
        except LeftError:
            pass  # it was turned, bent or made far larger: there is nothing to keep
    return solve(sketch, sketch_options, body_options, pen=pen, pen_detail=detail)


def _stored(live: Any) -> Lattice | None:
    """Return the lattice of the body as it is, after a file was opened or a step undone; none that may be bent.

    Only a lattice that was made in this session is known with its bend.
    """
    if not live.lattice[0] or live.sketch_options().get("bend", 1.0):
        return None
    values = np.array(live.plane, float)
    plane = Plane(values[:3], values[3:].reshape(3, 3))
    return Lattice(plane, live.lattice[0], live.lattice[1], np.array(live.lattice[2:]))


def _tell(live: Any, problem: str) -> None:
    if live.problem != problem:
        live.problem = problem


# ------------------------------------------------------------------------------------------------ the end of a change


def forget() -> None:
    """Forget what is known of bodies: after a step back or forth, or in another file."""
    _states.clear()


def unsettled() -> bool:
    """Whether there are bodies that are not made in full."""
    return any(state.since for state in _states.values())


def _wait() -> None:
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.1)


def _tick() -> float | None:
    """Timer: make in full what has not changed for a moment, once no tool is running."""
    last = max((state.since for state in _states.values()), default=0.0)
    if not last:
        return None
    if perf_counter() - last < PAUSE or tool_runs():
        return 0.1
    refresh()
    for uid in _states.keys() - {ob.session_uid for ob in bpy.data.objects}:
        del _states[uid]
    return 0.1 if unsettled() and awake() else None


def tool_runs() -> bool:
    """Whether a tool is running that may go on changing the stroke: a drag is not over while it is."""
    aside = {"SCREEN_OT_animation_play", "SCREEN_OT_animation_step", "OBJECT_OT_gridmesh_draw"}
    return any(
        tool.bl_idname not in aside
        for window in bpy.context.window_manager.windows
        for tool in window.modal_operators
    )


def register() -> None:
    """Nothing to do before a body is changed."""


def unregister() -> None:
    """Stop; bodies stay as they are."""
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    _states.clear()
