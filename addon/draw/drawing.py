# SPDX-License-Identifier: GPL-3.0-or-later
"""Carry out what was decided: outlines, which stay as grease pencil objects, and bodies that follow them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from .. import api
from ..bodies import profilecurve, strokes
from ..bodies.outlines import Plane, Stroke, StrokeError, prepare
from ..data import frames, meshes, written
from ..join import characters, following
from ..live import engine, outlined
from ..live.linework import nearest
from ..live.outlined import OutlineError, radii
from ..native import native
from ..text.messages import of_stroke
from . import shapes
from .decision import Decision, Part, united
from .gesture import FEWEST
from .joining import absorb, adopt, indices, same_layer
from .memory import Memory
from .pencil import layer_of, renumber

NOTHING = "the stroke encloses nothing"


class DrawError(ValueError):
    """A stroke was refused; nothing was changed. The message says why."""


@dataclass(frozen=True, eq=False)
class _Plan:
    """What becomes of a decision."""

    decision: Decision
    parts: list[Part]
    """In the plane of the decision or, where a body is changed, in that body's."""


@dataclass(frozen=True, eq=False)
class _Ink:
    """Where the pen was pressed how hard."""

    points: np.ndarray
    """(n, 3) in the world."""
    pressures: np.ndarray


def carry_out(
    context: bpy.types.Context,
    memory: Memory,
    decisions: list[Decision],
    bodies: dict[str, shapes.Drawn],
    options: Any,
    *,
    apply_options: bool,
) -> tuple[list[bpy.types.Object], list[str]]:
    """Make what was decided; return the bodies that are new or changed, the first decision's first, and what could not be joined.

    bodies : as they were read for the decisions. options : for new bodies and, with `apply_options`, for those that
    are changed; otherwise these keep their own.

    Raises
    ------
    DrawError
        If it has no body; then nothing is changed.
    """
    if len(memory.trace) < FEWEST:
        raise DrawError("the stroke is too short; drag to draw an outline")
    try:
        plans = [_planned(decision, bodies, options, apply_options) for decision in decisions]
    except native("combine").GridMeshError as error:
        raise _refused(error) from error
    made: list[bpy.types.Object] = []
    problems: list[str] = []
    survivors: dict[str, str] = {}
    for number, plan in enumerate(plans):
        changes = plan.decision.action not in {"NEW", "PART"}
        own = bodies[plan.decision.body].shape.plane if changes else plan.decision.plane
        ink = _ink(memory, plan.decision, own)
        if plan.decision.action in {"NEW", "PART"}:
            for part in plan.parts:
                made.append(_new(context, plan.decision, part, ink, options))
                problems.append(_belong(context, plan.decision, made[-1], options))
            continue
        if number:
            bodies = shapes.read(context)
            plan = _again(plan, bodies, survivors)
        changed = _changed(context, plan, bodies, ink, options if apply_options else None)
        characters.add_like(changed[0], changed[1:])
        made += changed
        survivors.update(dict.fromkeys(plan.decision.joined, plan.decision.body))
    made = list(dict.fromkeys(made))
    for whole in dict.fromkeys(filter(None, map(following.whole_of, made))):
        context.view_layer.update()
        following.update(whole)
        problems.append(whole.gridmesh_joined.problem)
    _select(context, [characters.seen(ob) for ob in made])
    return made, [problem for problem in problems if problem]


def _refused(error: Any, sketch_options: dict[str, Any] | None = None) -> DrawError:
    """Say of a stroke what the library says of an outline."""
    if error.kind == "zero_area":
        return DrawError(NOTHING)
    return DrawError(of_stroke(api.reason_of(error, sketch_options)))


def _ink(memory: Memory, decision: Decision, own: Plane) -> _Ink:
    """Return where the pen went, and its mirror image: what is nearest counts.

    own : plane of what is drawn; of a stroke over a twin that of the body itself.
    """
    points = memory.trace.on(decision.plane)
    if points is None:
        raise DrawError("the stroke leaves the plane; turn the view or choose another plane")
    both = np.concatenate([points, memory.mirror.image(decision.plane, points)])
    world = own.world(np.column_stack([both, np.zeros(len(both))]))
    return _Ink(world, np.tile(memory.trace.pressures, 2))


def _planned(decision: Decision, bodies: dict[str, shapes.Drawn], options: Any, apply_options: bool) -> _Plan:
    """Find out what outlines come of a decision, and whether they have a body."""
    if decision.action in {"NEW", "PART"}:
        parts = decision.parts()
        if not parts:
            raise DrawError(NOTHING)
        refuse(parts, options)
        return _Plan(decision, parts)
    plan = _combined(decision, bodies)
    drawn = bodies[decision.body]
    flat = [(drawn.back(outline), [drawn.back(hole) for hole in holes]) for outline, holes in plan.parts]
    refuse(flat, options if apply_options else drawn.ob.gridmesh_live)
    return plan


def _combined(decision: Decision, bodies: dict[str, shapes.Drawn]) -> _Plan:
    gridmesh = native("combine")
    ob, shape = bodies[decision.body].ob, bodies[decision.body].shape
    if written.by_hand(ob.data):
        raise DrawError(f"'{ob.name}': {engine.BY_HAND}")
    parts = [shape.part]
    for stroke in decision.strokes:
        if decision.action == "EXTEND":
            parts = united(parts[0], (stroke, []))
        else:
            parts = [
                rest
                for part in parts
                for rest in gridmesh.combine(part[0], stroke, part[1], how="difference")
            ]
    for name in decision.joined:
        parts = united(parts[0], bodies[name].shape.on(shape.plane))
    if not parts:
        raise DrawError("nothing would be left; delete the body instead")
    return _Plan(decision, parts)


def _again(plan: _Plan, bodies: dict[str, shapes.Drawn], survivors: dict[str, str]) -> _Plan:
    """Lay a decision onto the bodies that are there after the one before."""
    old = plan.decision
    name = survivors.get(old.body, old.body)
    plane = bodies[name].shape.plane
    places = [_world(old.plane, stroke) for stroke in old.strokes]
    if np.linalg.det(old.plane.axes) < 0:  # drawn over the twin of the body
        places = [bodies[name].shape.across.across(points) for points in places]
    laid = [plane.local(points)[:, :2] for points in places]
    joined = tuple(one for one in old.joined if one in bodies and one != name)
    return _combined(replace(old, plane=plane, strokes=laid, body=name, joined=joined), bodies)


def refuse(parts: list[Part], options: Any) -> None:
    """Refuse what would have no body before anything is changed."""
    gridmesh = native("mesh_sketch")
    wanted = {**options.sketch_options(), "self_crossing": "union"}
    for outline, holes in parts:
        try:
            gridmesh.mesh_sketch(outline, holes, least=False, **wanted)
        except gridmesh.GridMeshError as error:
            raise _refused(error, wanted) from error


def _new(
    context: bpy.types.Context, decision: Decision, part: Part, ink: _Ink, options: Any
) -> bpy.types.Object:
    """Make a body of a part, with its outline."""
    outline, holes = part
    rings = [_world(decision.plane, ring) for ring in (outline, *holes)]
    options.use_union = True  # a hand's stroke crosses itself where it closes
    mirror = options.mirror
    if decision.symmetric and len(decision.strokes) > 1:
        options.mirror = "AUTO"
    try:
        plane = prepare(Stroke(rings[0], True, "", "", 0, 1), close_gaps=1.0).plane
        size = float(np.linalg.norm(np.ptp(outline, axis=0)))
        widths = [radii(nearest(ring, ink.points, ink.pressures), size) for ring in rings]
        body = outlined.make(
            context, [plane.local(ring)[:, :2] for ring in rings], widths, plane.matrix, options
        )
    except (OutlineError, StrokeError) as error:
        raise DrawError(of_stroke(str(error))) from error
    finally:
        options.mirror = mirror
    return body


def _belong(context: bpy.types.Context, decision: Decision, body: bpy.types.Object, options: Any) -> str:
    """Join a part to the body that it was drawn over, or make it a child of that; return why it could not be joined."""
    owner = bpy.data.objects.get(decision.body) if decision.body else None
    if owner is None:
        return ""
    if not options.use_join or "SHEET" in (options.shape, owner.gridmesh_live.shape):
        following.hang(body, owner)
        context.view_layer.update()
        return ""
    problem = characters.add(
        owner, body, characters.Lies(decision.depth, decision.reach, decision.twin is not None)
    )
    said = not problem or problem in decision.hint
    return "" if said else f"'{body.name}' stays apart: {problem}"


def _world(plane: Plane, points: np.ndarray) -> np.ndarray:
    return plane.world(np.column_stack([points, np.zeros(len(points))]))


def _make(
    context: bpy.types.Context, source: bpy.types.Object, wanted: list[int], options: Any
) -> list[bpy.types.Object]:
    """Bodies of strokes of an outline object, linked to it."""
    read = strokes.read_grease_pencil(source, context.evaluated_depsgraph_get())
    sketches, failures, _ = api.sketches_of(read.strokes, close_gaps=1.0, holes=True)
    sketches = [sketch for sketch in sketches if sketch.stroke.index in wanted]
    bodies, refused = api.build(
        sketches, {**options.sketch_options(), "least": False}, options.body_options()
    )
    failures += refused
    if failures or not bodies:
        raise DrawError(of_stroke(failures[0].reason) if failures else NOTHING)
    made: list[bpy.types.Object] = []
    meshes.place(
        context, bodies, update=False, collection="SOURCE", crease_angle=options.corner_angle, made=made
    )
    context.view_layer.update()
    for body, ob in zip(bodies, made, strict=True):
        engine.link(ob, body.sketch.stroke, source, options, follow=True)
        frames.carry(ob, source, body.sketch.stroke.layer)
        ob.gridmesh_live.pen = options.pen
        if options.pen > 0:
            engine.remake(ob)
    return made


def _changed(
    context: bpy.types.Context, plan: _Plan, bodies: dict[str, shapes.Drawn], ink: _Ink, options: Any
) -> list[bpy.types.Object]:
    """Give a body the outlines of a plan; what it has joined goes, what fell apart becomes bodies of their own.

    options : taken over by the body; None to leave it its own.
    """
    drawn, taken = bodies[plan.decision.body], [bodies[name] for name in plan.decision.joined]
    ob, live, plane = drawn.ob, drawn.ob.gridmesh_live, drawn.shape.plane
    source, name = live.source, live.layer
    if options is not None:
        give(ob, options)
    known = _inked([drawn, *taken], ink)
    parts, made = plan.parts, [ob]
    if frames.owned(ob) is not None:  # each outline has a body of its own
        made += [_split(context, drawn, part, known) for part in parts[1:]]
        parts = parts[:1]
    rings = [_world(plane, ring) for outline, inner in parts for ring in (outline, *inner)]
    starts = np.cumsum([0, *(1 + len(inner) for _, inner in parts)])[:-1]
    widths = [nearest(ring, *known) for ring in rings]
    layer = layer_of(source, name)
    to_layer = np.linalg.inv(drawn.matrix @ frames.frame(ob) @ frames.layer_matrix(layer))
    gone = [at for one in (drawn, *taken) if same_layer(one, drawn) for at in indices(one)]
    follow = live.enabled
    orphans = absorb(taken, drawn)
    kept = renumber(source, name, gone, len(rings))
    flat = [frames.moved(ring, to_layer) for ring in rings]
    outlined.write(layer_of(source, name).current_frame().drawing, gone, flat, widths)
    live.stroke, live.count = kept, kept + len(rings)
    engine.replaced(ob)
    context.view_layer.update()
    engine.remake(ob)
    adopt(ob, orphans)
    if len(parts) > 1:
        made += _make(context, source, [kept + int(start) for start in starts[1:]], _Like(live))
    for body in made[1:]:
        body.gridmesh_live.enabled = follow
        for material in ob.data.materials:
            body.data.materials.append(material)
    return made


def _split(
    context: bpy.types.Context, drawn: shapes.Drawn, part: Part, known: tuple[np.ndarray, np.ndarray]
) -> bpy.types.Object:
    """Make a body of its own of a part that a body fell into."""
    ob = drawn.ob
    rings = [_world(drawn.shape.plane, ring) for ring in (part[0], *part[1])]
    widths = [nearest(ring, *known) for ring in rings]
    local = [frames.to_local(ob, ring) for ring in rings]
    middle = (local[0].min(axis=0) + local[0].max(axis=0)) / 2
    try:
        body = outlined.make(
            context,
            [ring - middle for ring in local],
            widths,
            np.eye(4),
            _Like(ob.gridmesh_live),
            like=ob,
        )
    except OutlineError as error:
        raise DrawError(of_stroke(str(error))) from error
    _lay_like(context, body, ob, middle)
    return body


def _lay_like(
    context: bpy.types.Context, body: bpy.types.Object, other: bpy.types.Object, middle: np.ndarray
) -> None:
    """Let a body lie as another one does, sheared if that is, its own origin where `middle` of the other's space is."""
    space = frames.space(other)
    offset = Matrix.Translation(frames.moved(middle[None], space)[0])
    place = other.matrix_world @ offset
    body.parent, body.parent_type, body.parent_bone = other.parent, other.parent_type, other.parent_bone
    body.matrix_parent_inverse = other.matrix_parent_inverse
    body.rotation_mode = other.rotation_mode
    body.matrix_basis = other.matrix_basis @ offset
    space[:3, 3] = 0.0
    if not np.array_equal(space, np.eye(4)):
        body.gridmesh_live.space, body.gridmesh_live.digest = space.ravel().tolist(), ""
        frames.nest(body.gridmesh_live.source, body, np.eye(4))
        engine.remake(body)
    context.view_layer.update()
    if not np.allclose(body.matrix_world, place, rtol=1e-5, atol=1e-6):
        body.matrix_world = place  # the other has constraints
        context.view_layer.update()


def _inked(drawn: list[shapes.Drawn], ink: _Ink) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) of the world where the line has a known radius, and the radii: old strokes and the new one."""
    points, values = [], []
    for one in drawn:
        for sketch in (one.sketch, *one.sketch.holes):
            line = sketch.stroke
            points.append(one.world(line.points))
            widths = radii(np.ones(len(line.points)), one.sketch.size)
            values.append(line.widths if line.widths is not None else widths)
    points.append(ink.points)
    values.append(radii(ink.pressures, drawn[0].sketch.size))
    return np.concatenate(points), np.concatenate(values)


class _Like:
    """Options of a body, for others like it."""

    def __init__(self, live: Any) -> None:
        self._live = live
        self.pen, self.corner_angle = live.pen, live.corner_angle

    def __getattr__(self, name: str) -> Any:
        return getattr(self._live, name)


def give(ob: bpy.types.Object, options: Any) -> None:
    """Let a body take over options. Without a curve it keeps the one it has."""
    live = ob.gridmesh_live
    live.copy_options(options)
    live.quiet = True
    live.pen = options.pen
    live.quiet = False
    points = options.curve_points()
    if points is not None:
        profilecurve.put(ob, points)


def _select(context: bpy.types.Context, bodies: list[bpy.types.Object]) -> None:
    for ob in strokes.selected(context):
        ob.select_set(False)
    for ob in bodies:
        ob.select_set(True)
    context.view_layer.objects.active = bodies[0]
