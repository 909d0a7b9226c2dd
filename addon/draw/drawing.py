# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished strokes into outlines, which stay as grease pencil objects, and bodies that follow them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from .. import api, meshes, strokes
from ..live import engine
from ..live.reading import LostError, sketch_of
from ..live.solve import TOO_THIN, Patience, reason_of
from ..native import native
from ..outlines import Plane, Sketch, project
from .gesture import FEWEST, relation
from .joining import absorb, adopt, join

RADIUS = 0.005
"""Radius of the line at full pressure, in parts of the outline's size."""

LAYER = "Outline"

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
    """(n, 2) in the body's plane."""


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
    except native("combine").GridMeshError as error:
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
        except LostError:
            continue  # without an outline there is nothing to draw on
        own = sketch.plane
        cosine, apart = SAME_PLANE
        same = abs(own.axes[2] @ plane.axes[2]) > cosine
        same = same and abs(own.local(plane.origin[None])[0, 2]) < apart * sketch.size
        if not same and not (subtract and ob == under):
            continue
        stroke = own.local(world)[:, :2]
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
    gridmesh = native("mesh_sketch")
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    options.use_union = True  # a hand's stroke crosses itself where it closes
    blocks = bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils
    with meshes.Transaction() as transaction:
        data = transaction.new(blocks, "Outline")
        source = transaction.new(bpy.data.objects, "Outline", data)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        home = Plane(plane.world(np.append(middle, 0.0)[None])[0], plane.axes)
        source.matrix_basis = Matrix(home.matrix.tolist())
        context.collection.objects.link(source)
        layer = data.layers.new(LAYER, set_active=True)
        layer.frames.new(context.scene.frame_current)
        _write(layer.current_frame().drawing, [], [points - middle], [_radii(pressures, size)])
        context.view_layer.update()
        bodies = _make(context, source, [0], options, gridmesh)
    _select(context, bodies)
    return Drawn("new", bodies)


def _make(
    context: bpy.types.Context, source: bpy.types.Object, wanted: list[int], options: Any, gridmesh: Any
) -> list[bpy.types.Object]:
    """Bodies of strokes of an outline object, linked to it."""
    read = strokes.read_grease_pencil(source, context.evaluated_depsgraph_get())
    sketches, failures, _ = api.sketches_of(read.strokes, close_gaps=1.0, holes=True)
    sketches = [sketch for sketch in sketches if sketch.stroke.index in wanted]
    try:
        bodies, refused = api.build(sketches, options.sketch_options(), options.body_options(), Patience())
    except api.CancelledError as error:
        raise DrawError(TOO_THIN) from error
    failures += refused
    if failures or not bodies:
        raise DrawError(failures[0].reason if failures else "the stroke encloses nothing")
    made: list[bpy.types.Object] = []
    meshes.place(
        context, bodies, update=False, collection="SOURCE", crease_angle=options.corner_angle, made=made
    )
    for body, ob in zip(bodies, made, strict=True):
        engine.link(ob, body.sketch.stroke, source, options, follow=True)
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
    holes = [project(hole, sketch.plane)[:, :2] for hole in sketch.holes]
    how = "union" if found.action == "extend" else "difference"
    parts = gridmesh.combine(sketch.outline, found.stroke, holes, how=how)
    if not parts:
        raise DrawError("nothing would be left; delete the body instead")
    source = live.source
    others = [
        other for other in engine.bodies(source) if other != ob and other.gridmesh_live.layer == live.layer
    ]
    taken: list[tuple[bpy.types.Object, Sketch]] = []
    if found.action == "extend":
        parts, taken = join(gridmesh, parts[0], sketch.plane, others)
    _try(gridmesh, parts, live)
    layer = next(layer for layer in source.data.layers if layer.name == live.layer)
    drawing = layer.current_frame().drawing
    rings = [ring for outline, inner in parts for ring in (outline, *inner)]
    starts = np.cumsum([0, *(1 + len(inner) for _, inner in parts)])[:-1]
    sketches = [sketch, *(one for _, one in taken)]
    radii = [_carried(ring, sketches, found.stroke, pressures) for ring in rings]
    to_layer = np.linalg.inv(strokes.layer_to_world(source, layer))
    flat = [sketch.plane.world(np.column_stack([ring, np.zeros(len(ring))])) for ring in rings]
    flat = [points @ to_layer[:3, :3].T + to_layer[:3, 3] for points in flat]
    gone = [drawn.stroke.index for one in sketches for drawn in (one, *one.holes)]
    kept = [index for index in range(sketch.stroke.count) if index not in gone]
    follow = live.enabled
    children = absorb([other for other, _ in taken])
    others = [other for other in others if all(other != one for one, _ in taken)]
    _write(drawing, gone, flat, radii)
    count = len(kept) + len(rings)
    for other in others:
        if other.gridmesh_live.stroke in kept:
            other.gridmesh_live.stroke = kept.index(other.gridmesh_live.stroke)
        other.gridmesh_live.count = count
    live.stroke, live.count = len(kept), count
    context.view_layer.update()
    engine.remake(ob)
    adopt(ob, children)
    bodies = [ob]
    if len(parts) > 1:
        wanted = [len(kept) + int(start) for start in starts[1:]]
        more = _make(context, source, wanted, _Like(live), gridmesh)
        for body in more:
            body.gridmesh_live.enabled = follow
            for material in ob.data.materials:
                body.data.materials.append(material)
        bodies += more
    _select(context, bodies)
    return Drawn(found.action, bodies)


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
            gridmesh.mesh_sketch(outline, holes, progress=Patience(), **live.sketch_options())
        except gridmesh.GridMeshError as error:
            raise DrawError(reason_of(error)) from error


def _carried(
    ring: np.ndarray, sketches: list[Sketch], stroke: np.ndarray, pressures: np.ndarray
) -> np.ndarray:
    """Radius (n,) at each point of a new outline: of the drawn point that is nearest, old or new."""
    sketch = sketches[0]
    old = [drawn for one in sketches for drawn in (one, *one.holes)]
    points = [sketch.plane.local(one.stroke.points)[:, :2] for one in old]
    fallback = RADIUS * sketch.size
    radii = [
        one.stroke.widths if one.stroke.widths is not None else np.full(len(one.stroke.points), fallback)
        for one in old
    ]
    points.append(stroke)
    radii.append(_radii(pressures, sketch.size))
    known, values = np.concatenate(points), np.concatenate(radii)
    out = np.empty(len(ring))
    for at in range(0, len(ring), 256):
        apart = ring[at : at + 256, None] - known[None]
        out[at : at + 256] = values[np.einsum("ijk,ijk->ij", apart, apart).argmin(axis=1)]
    return out


def _radii(pressures: np.ndarray, size: float) -> np.ndarray:
    return RADIUS * size * np.clip(pressures, 0.02, 1.0)


def _write(drawing: Any, gone: list[int], rings: list[np.ndarray], radii: list[np.ndarray]) -> None:
    """Take strokes out of a drawing and append closed ones; rings : (n, 2) or (n, 3) in the layer's space."""
    if gone:
        drawing.remove_strokes(indices=sorted(gone))
    before = len(drawing.strokes)
    drawing.add_strokes([len(ring) for ring in rings])
    total = sum(len(ring) for ring in rings)
    attribute = drawing.attributes["position"]
    points = np.empty(len(attribute.data) * 3, np.float32)
    attribute.data.foreach_get("vector", points)
    new = np.concatenate(rings)
    points.reshape(-1, 3)[-total:] = 0.0
    points.reshape(-1, 3)[-total:, : new.shape[1]] = new
    attribute.data.foreach_set("vector", points)
    attribute = drawing.attributes.get("radius")
    if attribute is None:
        attribute = drawing.attributes.new("radius", "FLOAT", "POINT")
    values = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", values)
    values[-total:] = np.concatenate(radii)
    attribute.data.foreach_set("value", values)
    for stroke in list(drawing.strokes)[before:]:
        stroke.cyclic = True
    drawing.tag_positions_changed()


def _select(context: bpy.types.Context, bodies: list[bpy.types.Object]) -> None:
    for ob in strokes.selected(context):
        ob.select_set(False)
    for ob in bodies:
        ob.select_set(True)
    context.view_layer.objects.active = bodies[0]
