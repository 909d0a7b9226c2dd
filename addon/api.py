# SPDX-License-Identifier: GPL-3.0-or-later
"""From strokes in space to bodies: the calls into `gridmesh`, and what can go wrong on the way.

numpy only, no bpy: everything here runs in plain Python. Points are float64 in world units.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from .bodies.nesting import nest
from .bodies.outlines import Plane, Sketch, Stroke, StrokeError, area, prepare, project
from .native import MANIFEST, NATIVE_VERSION, NativeError, native  # noqa: F401 (known to callers from here)

Progress = Callable[[float], object]
"""Called with the fraction that is done, from any thread; cancels by returning False."""


class CancelledError(Exception):
    """The user asked to stop. Nothing was made."""


@contextmanager
def cancelling(gridmesh: Any) -> Iterator[None]:
    """Raise CancelledError where a call of the module ends since `progress` or Ctrl-C asked it to."""
    try:
        yield
    except KeyboardInterrupt as error:
        raise CancelledError from error
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise CancelledError from error
        raise


def part_of(progress: Progress | None, begin: float, end: float) -> Progress | None:
    """Progress of a part of the work, from `begin` to `end`."""
    return None if progress is None else lambda fraction: progress(begin + fraction * (end - begin))


@dataclass(frozen=True, eq=False)
class Body:
    """A finished mesh in the frame of `plane`."""

    sketch: Sketch
    vertices: np.ndarray
    faces: np.ndarray
    """(f, 3) triangles, or (f, 4) quads."""
    uv: np.ndarray
    silhouette: list[np.ndarray]
    corner: list[np.ndarray]
    """Turning angle of the drawn corner at each vertex of the silhouette; 0 elsewhere."""
    report: dict[str, Any]
    smooth_rim: bool = False
    """Whether the rim was placed for a subdivision that no crease along it stops; see `smooths_rim`."""


def smooths_rim(body_options: dict[str, Any] | None) -> bool:
    """Whether options of `gridmesh.inflate` place the rim of quads for a smooth subdivision: not that of a peak, an edge."""
    return bool(body_options and body_options.get("subdivided")) and body_options.get("profile") != "peak"


@dataclass(frozen=True)
class Failure:
    """A stroke that did not become a body, and why."""

    label: str
    reason: str

    def __str__(self) -> str:
        return f"{self.label}: {self.reason}"


def sketches_of(
    strokes: list[Stroke], *, close_gaps: float, holes: bool
) -> tuple[list[Sketch], list[Failure], list[str]]:
    """Prepare every stroke; strokes that cannot be are returned with the reason, and what else to tell."""
    sketches: list[Sketch] = []
    failures: list[Failure] = []
    for stroke in strokes:
        try:
            sketches.append(prepare(stroke, close_gaps))
        except StrokeError as error:
            failures.append(Failure(stroke.label, str(error)))
    outer, notes = nest(sketches) if holes else (sketches, [])
    return outer, failures, notes


def faces_of(mesh: Any) -> np.ndarray:
    """Faces of a patch or a surface, which are all triangles (f, 3) or all quads (f, 4)."""
    return mesh.quads if len(mesh.quads) else mesh.triangles


def kind_of(faces: np.ndarray) -> str:
    """What faces are called."""
    return "quad" if faces.shape[1] == 4 else "triangle"


TOO_THIN = "the stroke is too thin for a mesh this coarse; use more triangles or shorter edges"
TOO_THIN_FOR_QUADS = (
    "the stroke is too thin for quads this coarse; use more quads or shorter edges, or set Faces to Triangles"
)


def reason_of(error: Any, sketch_options: dict[str, Any] | None = None) -> str:
    """What to say of an error of the module where the number of faces that would do was not searched for."""
    if error.kind != "too_coarse":
        return str(error)
    quads = sketch_options is not None and sketch_options.get("cells") == "quads"
    return TOO_THIN_FOR_QUADS if quads else TOO_THIN


_PLACE = re.compile(r"\b(at|near)\s\((-?\d+\.\d+),\s(-?\d+\.\d+)\)")
"""Where the module says that something of a drawing is."""


def in_space(reason: str, plane: Plane) -> str:
    """What is said of a place in a drawing plane, which only the module knows, said of that in the world."""

    def world(found: re.Match[str]) -> str:
        place = plane.world(np.array([float(found[2]), float(found[3]), 0.0]))
        return found[1] + " (" + ", ".join(f"{number:.6f}" for number in place + 0.0) + ")"

    return _PLACE.sub(world, reason)


def build(
    sketches: list[Sketch],
    sketch_options: dict[str, Any],
    body_options: dict[str, Any] | None,
    progress: Progress | None = None,
) -> tuple[list[Body], list[Failure]]:
    """Mesh every sketch, several at once, and inflate it unless `body_options` is None.

    sketch_options, body_options : keyword arguments of `gridmesh.mesh_sketch` and `gridmesh.inflate`.
    Sketches that are refused are returned with the reason. Raises NativeError without the module, and
    CancelledError if `progress` or Ctrl-C asked to stop.
    """
    gridmesh = native("mesh_sketch", "map_sketches", "inflate", "flat")
    bodies: list[Body] = []
    failures: list[Failure] = []
    with cancelling(gridmesh):
        surfaces = _surfaces(gridmesh, sketches, sketch_options, body_options, progress)
    for sketch, surface in zip(sketches, surfaces, strict=True):
        if isinstance(surface, gridmesh.GridMeshError):
            if surface.kind == "cancelled":
                raise CancelledError from surface
            reason = str(surface) if sketch_options.get("least", True) else reason_of(surface, sketch_options)
            failures.append(Failure(sketch.stroke.label, in_space(reason, sketch.plane)))
            continue
        bodies.append(
            Body(
                sketch=sketch,
                vertices=surface.vertices,
                faces=faces_of(surface),
                uv=surface.uv,
                silhouette=list(surface.silhouette),
                corner=list(surface.corner),
                report=dict(surface.report),
                smooth_rim=smooths_rim(body_options),
            )
        )
    return bodies, failures


_MESHING = 0.8
"""Part of the time that meshing takes; the rest is inflation."""


def _surfaces(
    gridmesh: Any,
    sketches: list[Sketch],
    sketch_options: dict[str, Any],
    body_options: dict[str, Any] | None,
    progress: Progress | None,
) -> list[Any]:
    """Surface or GridMeshError for every sketch."""
    drawings = [
        (sketch.outline, [project(hole, sketch.plane)[:, :2] for hole in sketch.holes]) for sketch in sketches
    ]
    if body_options is not None and len(drawings) > 1:
        try:
            options = {**sketch_options, **body_options}
            return list(gridmesh.map_sketches(drawings, progress=progress, **options))
        except gridmesh.GridMeshError as error:  # cancelled, or an option that is wrong for all
            return [error] * len(drawings)

    def surface(at: int, outline: np.ndarray, holes: list[np.ndarray]) -> Any:
        meshing = 1.0 if body_options is None else _MESHING
        first = part_of(progress, at / len(drawings), (at + meshing) / len(drawings))
        second = part_of(progress, (at + meshing) / len(drawings), (at + 1) / len(drawings))
        try:
            opened = body_options is None
            patch = gridmesh.mesh_sketch(
                outline, holes, progress=first, open_corners=opened, **sketch_options
            )
            if body_options is None:
                return gridmesh.flat(patch)
            return gridmesh.inflate(patch, progress=second, **body_options)
        except gridmesh.GridMeshError as error:
            return error

    return [surface(at, outline, holes) for at, (outline, holes) in enumerate(drawings)]


AUTOMATIC = 4000.0
"""What a drawing gets about where the number of triangles is left to it; of quads half as many."""

FACE_AREA = {"triangles": float(np.sqrt(3) / 4), "quads": 1.0}
"""Area of a face, in squared edge lengths."""


def expected_triangles(sketches: list[Sketch], sketch_options: dict[str, Any]) -> float:
    """About how many flat triangles these sketches get with these options; a quad counts as two."""
    quads = sketch_options.get("cells") == "quads"
    number = sketch_options.get("quads" if quads else "triangles")
    if number is not None:
        each = AUTOMATIC if number == "auto" else float(number) * (2 if quads else 1)
        return each * len(sketches)
    length = sketch_options["edge_length"]
    if length <= 0:
        return 0.0
    each = FACE_AREA["quads"] / 2 if quads else FACE_AREA["triangles"]
    return sum(area(sketch.outline) for sketch in sketches) / (each * length**2)


def suggested_edge_length(sketches: list[Sketch], number: int, cells: str = "triangles") -> float | None:
    """Edge length at which the largest sketch has about that many faces; None if none has an area."""
    areas = (area(sketch.outline) - sum(area(hole.outline) for hole in sketch.holes) for sketch in sketches)
    largest = max(areas, default=0.0)
    if largest <= 0 or number <= 0:
        return None
    return float(np.sqrt(largest / number / FACE_AREA[cells]))
