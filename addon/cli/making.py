# SPDX-License-Identifier: GPL-3.0-or-later
"""The operations on meshes and strokes of a loaded file, through what the operators are made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from .. import api
from ..api import Body
from ..bodies import strokes
from ..bodies.outlines import Stroke
from ..cut import cutline, cutsweep, cutting
from ..cut.cutobject import Caps, Target
from ..data import defaults
from ..fill import filling
from ..fill.editmesh import EditMesh
from ..join import joining, uniting
from ..regrid import regridding
from ..text.messages import counted
from . import jobs, loading, outputs, params
from .loading import LoadError
from .outputs import placed


class MakeError(ValueError):
    """Nothing could be made. The message says why."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


@dataclass
class Made:
    """Objects to be written, numbers, and what the user should know."""

    objects: list[bpy.types.Object]
    numbers: dict[str, Any]
    notes: list[str] = field(default_factory=list)

    def write(self, out: Path, _beside: Path | None) -> None:
        """Write the output."""
        outputs.write(out, self.objects)

    def tidy(self, source: Path) -> None:
        """Empty the session of what was made of this file."""
        loading.tidy(source, self.objects)


def strokes_to_bodies(source: Path, pattern: str | None, options: dict[str, Any], *, scripts: bool) -> Made:
    """Make a body of each closed stroke."""
    found, reasons, notes = loading.drawn(source, pattern, scripts=scripts)
    sketches, failures, more = api.sketches_of(
        found, close_gaps=options.get("close_gaps", defaults.CLOSE_GAPS), holes=options.get("holes", True)
    )
    corner = options.get("corner_angle", defaults.CORNER_ANGLE)
    sketch_options = {key: value for key, value in options.items() if key in params.SKETCH}
    if "quads" in options:
        sketch_options["cells"] = "quads"
    if not {"triangles", "quads", "edge_length"} & options.keys():
        quads = options.get("cells") == "quads"
        sketch_options |= {"quads": defaults.QUADS} if quads else {"triangles": defaults.TRIANGLES}
    sketch_options.setdefault("density", defaults.DETAIL)
    body_options = {key: value for key, value in options.items() if key in params.BODY}
    bodies, refused = api.build(sketches, sketch_options, {**body_options, "corner_angle": corner})
    reasons = reasons + [str(failure) for failure in failures + refused]
    if not bodies:
        raise MakeError("strokes", "; ".join(reasons))
    crossed = sum(body.report.get("self_intersections", 0) > 0 for body in bodies)
    notes = reasons + notes + more + ([f"{crossed} bodies cut through themselves"] if crossed else [])
    return Made(
        placed(source.stem, bodies, corner), _numbers("bodies", len(bodies), _of_bodies(bodies)), notes
    )


def _of_bodies(bodies: list[Body]) -> list[dict[str, Any]]:
    return [{**body.report, f"{api.kind_of(body.faces)}s": len(body.faces)} for body in bodies]


def _numbers(what: str, n: int, reports: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        what: n,
        "triangles": sum(int(report["triangles"]) for report in reports),
        **({"quads": quads} if (quads := sum(int(report.get("quads", 0)) for report in reports)) else {}),
        "irregular": sum(int(report["irregular"]) for report in reports),
        "min_angle": min(
            (
                float(report["min_angle"])
                for report in reports
                if report["triangles"] or report.get("quads", 0)
            ),
            default=None,
        ),
    }


def fill(source: Path, pattern: str | None, options: dict[str, Any], *, scripts: bool) -> Made:
    """Fill the holes of every mesh."""
    found, notes = loading.meshes(source, pattern, scripts=scripts, weld=options.get("weld"))
    most = options.get("max_open_edges", defaults.MAX_OPEN_EDGES)
    reports: list[dict[str, Any]] = []
    reasons: list[str] = []
    larger = outer = 0
    for ob in found:
        n_open = _open_edges(ob.data)
        if n_open > most:
            text = f"'{ob.name}' has {n_open} open edges, {most} are allowed; raise max_open_edges"
            raise MakeError("too_many_holes", text)
        if not n_open:
            continue
        if not ob.is_editable or not ob.data.is_editable:
            raise MakeError("linked", f"'{ob.name}' is linked from another file; make it local first")
        job = _filled(ob, options)
        reports += job.reports
        reasons += [f"'{ob.name}': {problem.reason}" for problem in job.found.problems]
        larger += job.found.larger + job.found.hidden
        outer += job.found.outer
    if reasons and not reports:
        raise MakeError("holes", "; ".join(reasons))
    notes = notes + reasons + filling.warnings_of(reports)
    if larger:
        notes.append(f"{counted(larger, 'hole')} left open: hidden, or with more than max_edges edges")
    if outer:
        touching = source.suffix.lower() == ".obj" and not options.get("weld")
        hint = "; weld joins sheets that only touch" if touching else ""
        notes.append(f"{counted(outer, 'outer border')} of flat sheets left open{hint}")
    return Made(found, _numbers("holes", len(reports), reports), notes)


def _filled(ob: bpy.types.Object, options: dict[str, Any]) -> filling.Job:
    """Fill the holes of one mesh; the job tells what came of it."""
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        job = filling.Job(EditMesh(ob))
        job.find_all(options.get("max_edges", defaults.MAX_HOLE_EDGES))
        job.fill(
            options.get("smooth", "tangent"),
            lambda _: True,
            cells=options.get("cells", defaults.CELLS.lower()),
        )
        if job.patches:
            filling.add_all([job])
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
    return job


def regrid(source: Path, pattern: str | None, options: dict[str, Any], *, scripts: bool) -> Made:
    """Mesh areas of every mesh anew. Meshes that have none of what is selected stay as they are."""
    found, notes = loading.meshes(source, pattern, scripts=scripts, weld=options.get("weld"))
    reports: list[dict[str, Any]] = []
    reasons: list[str] = []
    for ob in found:
        if not ob.is_editable or not ob.data.is_editable:
            raise MakeError("linked", f"'{ob.name}' is linked from another file; make it local first")
        job = _regridded(ob, options)
        reports += [region.made.report for region in job.regions]
        reasons += job.problems
    if not reports:
        chosen = options.get("select")
        nothing = f"no face belongs to '{chosen}'" if chosen else "it has no faces"
        raise MakeError("areas", "; ".join(reasons) or nothing)
    notes = notes + reasons + filling.warnings_of(reports)
    return Made(found, _numbers("areas", len(reports), reports), notes)


def _regridded(ob: bpy.types.Object, options: dict[str, Any]) -> regridding.Job:
    """Mesh areas of one mesh anew; the job tells what came of it."""
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        job = regridding.Job(EditMesh(ob))
        job.find_named(options.get("select"))
        if job.areas:
            job.solve(
                options.get("smooth", "tangent"),
                lambda _: True,
                keep_shape=options.get("keep_shape", True),
                cells=options.get("cells", defaults.CELLS.lower()),
            )
        if job.regions:
            regridding.replace_all([job])
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
    return job


def _open_edges(mesh: bpy.types.Mesh) -> int:
    """How many edges have one face or none."""
    edges = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", edges)
    return int((np.bincount(edges, minlength=len(mesh.edges)) < 2).sum())


def cut(source: Path, pattern: str | None, options: dict[str, Any], *, scripts: bool) -> Made:
    """Cut every mesh along the stroke. Those that it does not meet stay as they are."""
    found, notes = loading.meshes(source, pattern, scripts=scripts, weld=options.get("weld"))
    points, cyclic, direction = _line(options)
    cutsweep.require_finite(points)
    sweep, _ = cutline.sweep_of(options.get("direction", direction).upper(), points, None)
    keep, together = options.get("keep", "both"), options.get("together", False)
    smooth, cap = options.get("smooth", "flat"), options.get("cap", True)
    objects: list[bpy.types.Object] = []
    reports: list[dict[str, Any]] = []
    pieces, missed = 0, []
    for ob in found:
        target = Target(ob)
        stroke = cutsweep.checked(
            points - target.origin,
            cyclic=cyclic,
            sweep=sweep,
            close_gaps=options.get("close_gaps", defaults.CUT_CLOSE_GAPS),
        )
        try:
            division = cutting.divide(
                target.model,
                stroke,
                sweep,
                together=together,
                keep=keep,
                cap=cap,
                edge_length=options.get("edge_length") or None,
                gap=options.get("gap", 0.0),
                smooth=smooth,
                cells=options.get("cells", "triangles"),
                extend_ends=options.get("extend_ends", True),
            )
        except cutsweep.CutError as error:
            missed.append(f"'{ob.name}': {error}")
            objects.append(ob)
            continue
        caps = Caps(smooth == "flat", False, None)
        objects += target.apply(bpy.context, division.parts, stroke, sweep, caps, together=together)
        reports.append(_of_caps(division, gap=bool(options.get("gap"))))
        pieces += len(division.parts)
        notes += cutting.warnings_of(division.report, capped=cap)
    if not reports:
        raise MakeError("cut", "; ".join(missed))
    return Made(objects, _numbers("pieces", pieces, reports), notes + missed)


def _of_caps(division: cutting.Division, *, gap: bool) -> dict[str, Any]:
    report = division.report
    sides = 1 if gap else len(division.parts)
    return {
        "triangles": sum(len(cap) == 3 for part in division.parts for cap in part.caps),
        "quads": sum(len(cap) == 4 for part in division.parts for cap in part.caps),
        "irregular": report["cap_irregular"] * sides,
        "min_angle": report["cap_min_angle"],
    }


def _line(options: dict[str, Any]) -> tuple[np.ndarray, bool, str]:
    """Points of the stroke, whether it is closed, and what it is swept along unless that is said."""
    stroke, closed = options["stroke"], options.get("closed")
    if isinstance(stroke, list):
        points = np.array(stroke, float)
        if points.shape[1] == 2:
            points = np.column_stack([points, np.zeros(len(points))])
        return points, bool(closed), "z"
    if jobs.is_file(stroke):
        found, direction = loading.line(Path(stroke), cyclic=bool(closed)), "z"
    else:
        found, direction = _of_object(stroke), "plane"
    if len(found) != 1:
        raise LoadError(f"the stroke '{Path(stroke).name}' has {len(found)} curves; one is needed")
    return np.asarray(found[0].points, float), found[0].cyclic if closed is None else closed, direction


def _of_object(name: str) -> list[Stroke]:
    ob = bpy.context.view_layer.objects.get(name)
    if ob is None or ob.type not in strokes.SOURCE_TYPES:
        raise LoadError(f"it has no drawing or curve named '{name}' to cut along")
    reading = strokes.read_objects(bpy.context, [ob])
    if not reading.strokes:
        raise LoadError("; ".join([*map(str, reading.failures), *reading.notes]))
    return reading.strokes


def join(source: Path, pattern: str | None, options: dict[str, Any], *, scripts: bool) -> Made:
    """Join all meshes to one. Of a file with one mesh, its pieces."""
    found, notes = loading.meshes(source, pattern, scripts=scripts, weld=options.get("weld"), instances=True)
    if len(found) == 1:
        found = loading.pieces(found[0])
    if len(found) < 2:
        raise MakeError("one_part", f"'{found[0].name}' is the only mesh, and in one piece; two are needed")
    chosen = joining.Options(
        options.get("blend", defaults.BLEND),
        options.get("edge_length") or None,
        options.get("strict", False),
    )
    try:
        done = joining.join(bpy.context, found, chosen)
    except uniting.JoinError as error:
        raise MakeError(error.kind or "join", str(error)) from error
    sides = np.array([len(polygon.vertices) for polygon in done.ob.data.polygons])
    report = {**done.report, "triangles": int((sides == 3).sum()), "quads": int((sides == 4).sum())}
    numbers = {**_numbers("parts", len(found), [report]), "collars": int(done.report["collars"])}
    return Made([done.ob], numbers, notes + done.notes + done.warnings)


OPS = {"strokes": strokes_to_bodies, "fill": fill, "regrid": regrid, "cut": cut, "join": join}
