# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that does the work: a job a line on stdin, a result a line on stdout."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

MARK = "@gridmesh "
"""What a result begins with; Blender prints other lines."""


def serve() -> int:
    """Do jobs until stdin ends."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    for line in sys.stdin:
        item = json.loads(line)
        print(f"\n{MARK}{json.dumps(work(**item))}", flush=True)
    return 0


def work(source: str, out: str, params: dict[str, Any]) -> dict[str, Any]:
    """Do one job; what came of it, never an exception."""
    started = perf_counter()
    try:
        result = _work(Path(source), Path(out), dict(params))
    except Exception as error:  # one bad item never stops the rest; its line says what happened
        result = {"status": "error", "kind": _kind(error), "message": str(error) or repr(error)}
    return {**result, "milliseconds": round(1000 * (perf_counter() - started))}


def _kind(error: Exception) -> str:
    return getattr(error, "kind", None) or type(error).__name__.removesuffix("Error").lower()


def _work(source: Path, out: Path, params: dict[str, Any]) -> dict[str, Any]:
    from .. import api
    from . import inputs, jobs, outputs

    strokes = inputs.curves(source, source.read_bytes())
    gaps, holes = params.pop("close_gaps", 0.2), params.pop("holes", True)
    sketches, failures, notes = api.sketches_of(strokes, close_gaps=gaps, holes=holes)
    corner = params.get("corner_angle", math.radians(40.0))
    sketch_options = {key: value for key, value in params.items() if key in jobs.SKETCH}
    if not {"triangles", "edge_length"} & params.keys():
        sketch_options["triangles"] = 2000
    body_options = {key: value for key, value in params.items() if key in jobs.BODY} | {
        "corner_angle": corner
    }
    bodies, refused = api.build(sketches, sketch_options, body_options)
    reasons = [str(failure) for failure in failures + refused]
    if not bodies:
        return {"status": "error", "kind": "strokes", "message": "; ".join(reasons)}
    out.parent.mkdir(parents=True, exist_ok=True)
    outputs.write(out, bodies, corner)
    crossed = sum(body.report.get("self_intersections", 0) > 0 for body in bodies)
    if crossed:
        notes.append(f"{crossed} bodies cut through themselves")
    return {
        "status": "warning" if reasons or notes else "ok",
        "message": "; ".join(reasons + notes),
        "bodies": len(bodies),
        "triangles": sum(len(body.triangles) for body in bodies),
        "irregular": sum(body.report["irregular"] for body in bodies),
        "min_angle": min(body.report["min_angle"] for body in bodies),
    }
