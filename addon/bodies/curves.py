# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines out of curve and text objects: as Blender samples them, without bevel, extrusion and fill."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np

from ..api import Failure
from ..data import frames
from . import sampling
from .outlines import Stroke


def read(context: bpy.types.Context, ob: bpy.types.Object) -> tuple[list[Stroke], list[Failure], list[str]]:
    """Strokes of a curve or text object, what could not be read, and why there are none.

    Modifiers and shape keys are respected. The object and its data are not changed, but for writing back what
    is being edited.
    """
    if ob.mode == "EDIT":
        ob.update_from_editmode()
    with _bare(context, ob) as mesh:
        return strokes_of(ob, mesh)


def strokes_of(
    ob: bpy.types.Object, mesh: bpy.types.Mesh | None, frame: np.ndarray | None = None
) -> tuple[list[Stroke], list[Failure], list[str]]:
    """Strokes of a curve or text object out of the mesh of its wires or flat faces; see `read`.

    frame : (4, 4) from the object's space to where they are wanted; None: the world.
    """
    points, lines, failure = _outlines(mesh) if mesh is not None else (np.zeros((0, 3)), [], "")
    if failure:
        return [], [Failure(f"'{ob.name}'", failure)], []
    if not lines:
        if ob.type == "FONT":
            return [], [], [f"'{ob.name}' has no text; draw a closed shape in it"]
        return [], [], [f"'{ob.name}' has no splines of two or more points; draw a closed shape in it"]
    with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is refused by name later
        points = frames.moved(points, np.array(ob.matrix_world) if frame is None else frame)
    splines = _splines(ob, lines)
    slots = [slot.material for slot in ob.material_slots]
    strokes = []
    for index, (line, cyclic) in enumerate(lines):
        spline = splines[index] if splines else None
        if spline is not None and spline.hide:
            continue
        slot = spline.material_index if spline is not None else 0
        strokes.append(
            Stroke(
                points=points[line],
                cyclic=cyclic,
                source=ob.name,
                layer="",
                index=index,
                count=len(lines),
                selected=None if spline is None else _selected(spline),
                material=slots[slot] if slot < len(slots) else None,
            )
        )
    return strokes, [], [] if strokes else [f"all splines of '{ob.name}' are hidden; show the one to use"]


@contextmanager
def _bare(context: bpy.types.Context, ob: bpy.types.Object) -> Iterator[bpy.types.Mesh | None]:
    """Mesh of a copy of the object that has neither bevel nor extrusion nor fill, for a short time.

    None if the object is empty.
    Only where modifiers or shape keys ask for it is the copy put into the scene and evaluated there.
    """
    data = ob.data.copy()
    data.extrude = data.bevel_depth = data.offset = 0.0
    data.bevel_mode = "ROUND"
    if data.dimensions == "2D" or ob.type == "FONT":
        data.fill_mode = "NONE"
    evaluate = any(modifier.show_viewport for modifier in ob.modifiers) or data.shape_keys is not None
    if evaluate:
        copy = ob.copy()
        copy.data = data
        context.scene.collection.objects.link(copy)
    else:
        copy = bpy.data.objects.new(ob.name, data)
    try:
        seen = copy.evaluated_get(context.evaluated_depsgraph_get()) if evaluate else copy
        yield seen.to_mesh()
        seen.to_mesh_clear()
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.curves.remove(data)


def _outlines(mesh: bpy.types.Mesh) -> tuple[np.ndarray, list[tuple[np.ndarray, bool]], str]:
    """Vertices (n, 3) and polylines of a mesh of wires, or of the borders of its faces; and what is wrong."""
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    edges = np.empty(len(mesh.edges) * 2, np.int32)
    mesh.edges.foreach_get("vertices", edges)
    loop_edges = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", loop_edges)
    border = sampling.border(edges.reshape(-1, 2), loop_edges)
    try:
        lines = sampling.polylines(border)
    except sampling.SamplingError as error:
        return points, [], str(error)
    if len(edges) and not lines:
        return points, [], "its modifiers make a closed surface of it, which has no outline; turn them off"
    return points.reshape(-1, 3).astype(float), lines, ""


def _splines(ob: bpy.types.Object, lines: list[tuple[np.ndarray, bool]]) -> list[Any]:
    """Splines that the polylines were made from, or an empty list where modifiers leave no way to tell."""
    if ob.type == "FONT":
        return []
    splines = [
        spline for spline in ob.data.splines if max(len(spline.points), len(spline.bezier_points)) >= 2
    ]
    return splines if len(splines) == len(lines) else []


def _selected(spline: bpy.types.Spline) -> bool:
    """Whether a control point of the spline is selected."""
    bezier = spline.type == "BEZIER"
    points, key = (spline.bezier_points, "select_control_point") if bezier else (spline.points, "select")
    flags = np.empty(len(points), bool)
    points.foreach_get(key, flags)
    return bool(flags.any())
