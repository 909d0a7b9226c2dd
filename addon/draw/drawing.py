# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished strokes into outlines, which stay as grease pencil objects, and bodies that follow them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from .. import api, frames, meshes, strokes
from ..live import engine, outlined
from ..live.linework import nearest
from ..live.outlined import OutlineError, radii
from ..live.reading import LostError, sketch_of
from ..native import native
from ..outlines import Plane, Sketch, Stroke, StrokeError, prepare, project
from .gesture import FEWEST, relation
from .joining import absorb, adopt, join

SAME_PLANE = (0.999, 0.02)
"""Cosine between normals, and distance in parts of the body's size, within which a stroke is in a body's plane."""


class DrawError(ValueError):
    """A stroke was refused; nothing was changed. The message says why."""


@dataclass(frozen=True)
class Drawn:
    """What a stroke has become."""

    action: str
    """"new", "hole", "extend" or "trim"."""
    bodies: list[bpy.types.Object]


@dataclass(frozen=True, eq=False)
class _Target:
    """A body that a stroke changes."""

    ob: bpy.types.Object
    sketch: Sketch
    action: str
    stroke: np.ndarray
    """(n, 2) in the plane of the body's sketch, which is in the body's own space."""


def apply(
    context: bpy.types.Context,
    plane: Plane,
    points: np.ndarray,
    pressures: np.ndarray,
    options: Any,
    *,
    subtract: bool = False,
    under: bpy.types.Object | None = None,
) -> Drawn:
    """Make a new body of a stroke, or change the one that it was drawn on.

    points : (n, 2) in the plane. subtract : make a hole, or trim, instead of extending. under : the body that was
    seen where the stroke began, which may be in another plane. options : what the operator was asked for.

    Raises
    ------
    DrawError
        If it has no body; then nothing is changed.
    """
    if len(points) < FEWEST:
        raise DrawError("the stroke is too short; drag to draw an outline")
    world = plane.world(np.column_stack([points, np.zeros(len(points))]))
    try:
        found = target(context, plane, world, subtract, under)
        if found is not None:
            return _changed(context, found, world, pressures, options)
        if subtract:
            raise DrawError("there is no body under the stroke; begin inside or beside one in the same plane")
        return _new(context, plane, points, pressures, options)
    except (native("combine").GridMeshError, OutlineError) as error:
        raise DrawError(str(error)) from error


def target(
    context: bpy.types.Context,
    plane: Plane,
    world: np.ndarray,
    subtract: bool,
    under: bpy.types.Object | None,
) -> _Target | None:
    """Find the body that a stroke changes, and how: the one it begins in, or else has most points in."""
    depsgraph = context.evaluated_depsgraph_get()
    best: tuple[tuple[bool, int], _Target] | None = None
    for ob in engine.bodies():
        source = ob.gridmesh_live.source
        if not ob.visible_get() or source is None or source.type != "GREASEPENCIL":
            continue
        try:
            sketch = sketch_of(ob, depsgraph)
            here = frames.plane_local(ob, plane)
            stroke = sketch.plane.local(frames.to_local(ob, world))[:, :2]
        except (LostError, np.linalg.LinAlgError):
            continue  # without an outline, or scaled to nothing, there is nothing to draw on
        own = sketch.plane
        cosine, apart = SAME_PLANE
        same = abs(own.axes[2] @ here.axes[2]) > cosine
        same = same and abs(own.local(here.origin[None])[0, 2]) < apart * sketch.size
        if not same and not (subtract and ob == under):
            continue
        holes = [project(hole, own)[:, :2] for hole in sketch.holes]
        how = relation(sketch.outline, holes, stroke)
        inside = _inside(sketch.outline, holes, stroke)
        action = _action(how, begins_inside=bool(inside[0]), subtract=subtract)
        if action is None:
            continue
        rank = bool(inside[0]), int(inside.sum())
        if best is None or rank > best[0]:
            best = rank, _Target(ob, sketch, action, stroke)
    return None if best is None else best[1]


def _action(how: str, *, begins_inside: bool, subtract: bool) -> str | None:
    """What a stroke does to a drawing: one that begins inside extends it, one from outside trims it."""
    if how == "inside":
        return "hole" if subtract else None
    if how == "across":
        return "trim" if subtract or not begins_inside else "extend"
    return None


def _inside(outline: np.ndarray, holes: list[np.ndarray], points: np.ndarray) -> np.ndarray:
    """Whether points (n, 2) lie inside a drawing, by the parity of crossings."""
    odd = np.zeros(len(points), bool)
    for ring in (outline, *holes):
        a, b = ring, np.roll(ring, -1, axis=0)
        spans = (a[None, :, 1] > points[:, 1, None]) != (b[None, :, 1] > points[:, 1, None])
        rise = np.where(spans, b[None, :, 1] - a[None, :, 1], 1.0)
        x = a[None, :, 0] + (points[:, 1, None] - a[None, :, 1]) * (b - a)[None, :, 0] / rise
        odd ^= (np.count_nonzero(spans & (x > points[:, 0, None]), axis=1) % 2).astype(bool)
    return odd


def _new(
    context: bpy.types.Context, plane: Plane, points: np.ndarray, pressures: np.ndarray, options: Any
) -> Drawn:
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    options.use_union = True  # a hand's stroke crosses itself where it closes
    world = plane.world(np.column_stack([points, np.zeros(len(points))]))
    widths = radii(pressures, size)
    try:
        sketch = prepare(Stroke(world, False, "", "", 0, 1, widths=widths), close_gaps=1.0)
    except StrokeError as error:
        raise DrawError(str(error)) from error
    carried = nearest(sketch.outline, sketch.plane.local(world)[:, :2], widths)
    body = outlined.make(context, [sketch.outline], [carried], sketch.plane.matrix, options)
    _select(context, [body])
    return Drawn("new", [body])


def _make(
    context: bpy.types.Context, source: bpy.types.Object, wanted: list[int], options: Any, gridmesh: Any
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
        raise DrawError(failures[0].reason if failures else "the stroke encloses nothing")
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
    context: bpy.types.Context, found: _Target, world: np.ndarray, pressures: np.ndarray, options: Any
) -> Drawn:
    """Unite the outline of a body with a stroke, or cut that from it."""
    gridmesh = native("combine")
    sketch, ob = found.sketch, found.ob
    live = ob.gridmesh_live
    if meshes.by_hand(ob.data):
        raise DrawError(engine.BY_HAND)
    holes = [project(hole, sketch.plane)[:, :2] for hole in sketch.holes]
    how = "union" if found.action == "extend" else "difference"
    parts = gridmesh.combine(sketch.outline, found.stroke, holes, how=how)
    if not parts:
        raise DrawError("nothing would be left; delete the body instead")
    source = live.source
    own = frames.owned(ob)
    others = [
        other for other in engine.bodies() if other != ob and (frames.owned(other) or _beside(other, ob))
    ]
    taken: list[tuple[bpy.types.Object, Sketch]] = []
    if found.action == "extend":
        parts, taken = join(gridmesh, parts[0], ob, sketch.plane, others)
    _try(gridmesh, parts, live)
    layer = next(layer for layer in source.data.layers if layer.name == live.layer)
    drawing = layer.current_frame().drawing
    sketches = [sketch, *(one for _, one in taken)]
    more = parts[1:] if own is not None else []  # each outline has a body of its own
    parts = parts[:1] if own is not None else parts
    bodies = [ob, *(_split(context, ob, sketch.plane, part, sketches, found, pressures) for part in more)]
    rings = [ring for outline, inner in parts for ring in (outline, *inner)]
    starts = np.cumsum([0, *(1 + len(inner) for _, inner in parts)])[:-1]
    widths = [_carried(ring, sketches, found.stroke, pressures) for ring in rings]
    to_layer = np.linalg.inv(frames.frame(ob) @ frames.layer_matrix(layer))
    flat = [frames.moved(_flat(ring, sketch.plane), to_layer) for ring in rings]
    here = [sketch, *(one for other, one in taken if _beside(other, ob))]
    gone = [drawn.stroke.index for one in here for drawn in (one, *one.holes)]
    kept = [index for index in range(sketch.stroke.count) if index not in gone]
    follow = live.enabled
    children = absorb([other for other, _ in taken])
    others = [other for other in engine.bodies() if other != ob and _beside(other, ob)]
    outlined.write(drawing, gone, flat, widths)
    count = len(kept) + len(rings)
    for other in others:
        if other.gridmesh_live.stroke in kept:
            other.gridmesh_live.stroke = kept.index(other.gridmesh_live.stroke)
        other.gridmesh_live.count = count
    live.stroke, live.count = len(kept), count
    context.view_layer.update()
    engine.remake(ob)
    adopt(ob, children)
    if len(parts) > 1:
        wanted = [len(kept) + int(start) for start in starts[1:]]
        bodies += _make(context, source, wanted, _Like(live), gridmesh)
    for body in bodies[1:]:
        body.gridmesh_live.enabled = follow
        for material in ob.data.materials:
            body.data.materials.append(material)
    _select(context, bodies)
    return Drawn(found.action, bodies)


def _beside(other: bpy.types.Object, ob: bpy.types.Object) -> bool:
    """Whether two bodies are of one layer of one drawing."""
    one, two = ob.gridmesh_live, other.gridmesh_live
    return one.source == two.source and one.layer == two.layer


def _flat(ring: np.ndarray, plane: Plane) -> np.ndarray:
    return plane.world(np.column_stack([ring, np.zeros(len(ring))]))


def _split(
    context: bpy.types.Context,
    ob: bpy.types.Object,
    plane: Plane,
    part: tuple[np.ndarray, list[np.ndarray]],
    sketches: list[Sketch],
    found: _Target,
    pressures: np.ndarray,
) -> bpy.types.Object:
    """Make a body of its own of a part that a body fell into."""
    rings = [part[0], *part[1]]
    widths = [_carried(ring, sketches, found.stroke, pressures) for ring in rings]
    flat = [_flat(ring, plane) for ring in rings]
    middle = (flat[0].min(axis=0) + flat[0].max(axis=0)) / 2
    place = np.array(ob.matrix_world)
    place[:3, 3] = frames.moved(middle[None], place)[0]
    body = outlined.make(
        context,
        [ring - middle for ring in flat],
        widths,
        place,
        _Like(ob.gridmesh_live),
        name=ob.name,
        collections=list(ob.users_collection),
    )
    if ob.parent is not None:
        world = body.matrix_world.copy()
        body.parent, body.parent_type, body.parent_bone = ob.parent, ob.parent_type, ob.parent_bone
        context.view_layer.update()
        body.matrix_world = world
    return body


class _Like:
    """Options of a body, for others like it."""

    def __init__(self, live: Any) -> None:
        self._live = live
        self.pen, self.corner_angle = live.pen, live.corner_angle

    def __getattr__(self, name: str) -> Any:
        return getattr(self._live, name)


def _try(gridmesh: Any, parts: list[Any], live: Any) -> None:
    """Refuse what would have no body before anything is changed."""
    for outline, holes in parts:
        try:
            gridmesh.mesh_sketch(outline, holes, least=False, **live.sketch_options())
        except gridmesh.GridMeshError as error:
            raise DrawError(api.reason_of(error)) from error


def _carried(
    ring: np.ndarray, sketches: list[Sketch], stroke: np.ndarray, pressures: np.ndarray
) -> np.ndarray:
    """Radius (n,) at each point of a new outline: of the drawn point that is nearest, old or new."""
    sketch = sketches[0]
    old = [drawn for one in sketches for drawn in (one, *one.holes)]
    points = [sketch.plane.local(one.stroke.points)[:, :2] for one in old]
    fallback = outlined.RADIUS * sketch.size
    values = [
        one.stroke.widths if one.stroke.widths is not None else np.full(len(one.stroke.points), fallback)
        for one in old
    ]
    points.append(stroke)
    values.append(radii(pressures, sketch.size))
    return nearest(ring, np.concatenate(points), np.concatenate(values))


def _select(context: bpy.types.Context, bodies: list[bpy.types.Object]) -> None:
    for ob in strokes.selected(context):
        ob.select_set(False)
    for ob in bodies:
        ob.select_set(True)
    context.view_layer.objects.active = bodies[0]
