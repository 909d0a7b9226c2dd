# SPDX-License-Identifier: GPL-3.0-or-later
"""From strokes in space to bodies: the calls into `gridmesh`, and what can go wrong on the way.

numpy only, no bpy: everything here runs in plain Python. Points are float64 in world units.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .bodies.outlines import Sketch, Stroke, StrokeError, area, nest, prepare, project
from .native import MANIFEST, NATIVE_VERSION, NativeError, native  # noqa: F401 (known to callers from here)

Progress = Callable[[float], object]
"""Called with the fraction that is done, from any thread; cancels by returning False."""


class CancelledError(Exception):
    """The user asked to stop. Nothing was made."""


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
    try:
        surfaces = _surfaces(gridmesh, sketches, sketch_options, body_options, progress)
    except KeyboardInterrupt as error:
        raise CancelledError from error
    for sketch, surface in zip(sketches, surfaces, strict=True):
        if isinstance(surface, gridmesh.GridMeshError):
            if surface.kind == "cancelled":
                raise CancelledError from surface
            reason = str(surface) if sketch_options.get("least", True) else reason_of(surface, sketch_options)
            failures.append(Failure(sketch.stroke.label, reason))
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
        first = _part(progress, at / len(drawings), (at + meshing) / len(drawings))
        second = _part(progress, (at + meshing) / len(drawings), (at + 1) / len(drawings))
        try:
            patch = gridmesh.mesh_sketch(outline, holes, progress=first, **sketch_options)
            if body_options is None:
                return gridmesh.flat(patch)
            return gridmesh.inflate(patch, progress=second, **body_options)
        except gridmesh.GridMeshError as error:
            return error

    return [surface(at, outline, holes) for at, (outline, holes) in enumerate(drawings)]


def _part(progress: Progress | None, begin: float, end: float) -> Progress | None:
    """Progress of a part of the work, from `begin` to `end`."""
    return None if progress is None else lambda fraction: progress(begin + fraction * (end - begin))


@dataclass(frozen=True, eq=False)
class Filled:
    """A patch for a hole."""

    vertices: np.ndarray
    """(j, 3) the new ones."""
    triangles: np.ndarray
    """(t, 3), the mesh's vertices first, then the new ones."""
    quads: np.ndarray
    """(q, 4) in the same way. Together they are the new faces."""
    creases: np.ndarray
    """(e, 2), hard edges of the patch."""
    poses: list[np.ndarray]
    """(j, 3) the new vertices in every pose."""
    report: dict[str, Any]
    extend: Callable[[np.ndarray], np.ndarray]
    """From values at the loop's vertices (k, c) to values at the new ones (j, c)."""


def fill(
    vertices: np.ndarray,
    triangles: np.ndarray,
    loops: Sequence[Sequence[int]],
    *,
    smooth: str,
    polygons: np.ndarray | None = None,
    poses: Sequence[np.ndarray] = (),
    sharp: float | None = None,
    creases: np.ndarray | None = None,
    cells: str = "triangles",
    progress: Progress | None = None,
) -> list[Filled | str]:
    """Fill loops of a mesh: for each the patch, or the reason why there is none.

    vertices : (n, 3), triangles : (m, 3), the mesh. loops : vertex indices in order. polygons : (m,), of which
    each triangle is a part. poses : (n, 3) each, other positions of the same mesh. sharp, creases : which edges are
    hard, as of `gridmesh.fill_hole`. cells : "triangles" or "quads". Raises NativeError without the module, and CancelledError if `progress` or
    Ctrl-C asked to stop.
    """
    gridmesh = native("fill_holes")
    indices = [np.asarray(loop, np.int32) for loop in loops]

    try:
        fills = gridmesh.fill_holes(
            vertices,
            triangles,
            indices,
            smooth=smooth,
            polygons=polygons,
            sharp=sharp,
            creases=creases,
            cells=cells,
            progress=progress,
        )
        return [_filled(gridmesh, fill, vertices, poses) for fill in fills]
    except KeyboardInterrupt as error:
        raise CancelledError from error
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise CancelledError from error
        return [str(error)] * len(indices)


@dataclass(frozen=True, eq=False)
class Regridded:
    """A patch that takes the place of an area of a mesh."""

    vertices: np.ndarray
    """(j, 3) the new ones."""
    triangles: np.ndarray
    """(t, 3), the mesh's vertices first, then the new ones."""
    quads: np.ndarray
    """(q, 4) in the same way. Together they are the new faces."""
    source_faces: np.ndarray
    """(j,) the old triangle on which each new vertex lies."""
    source_weights: np.ndarray
    """(j, 3) of its corners."""
    unused: np.ndarray
    """(u,) vertices that only the area used."""
    report: dict[str, Any]


def regrid(
    vertices: np.ndarray,
    triangles: np.ndarray,
    area: np.ndarray,
    *,
    keep_shape: bool,
    smooth: str,
    polygons: np.ndarray | None = None,
    cells: str = "triangles",
    progress: Progress | None = None,
) -> Regridded | str:
    """Mesh an area anew, or tell why it cannot be.

    vertices : (n, 3), triangles : (m, 3), the mesh. area : (f,) numbers of triangles, a disk. keep_shape : on the old
    surface. polygons : (m,), of which each triangle is a part. cells : "triangles" or "quads". Raises NativeError without the module, and
    CancelledError if `progress` or Ctrl-C asked to stop.
    """
    gridmesh = native("regrid")
    try:
        done = gridmesh.regrid(
            vertices,
            triangles,
            area,
            keep_shape=keep_shape,
            smooth=smooth,
            polygons=polygons,
            cells=cells,
            progress=progress,
        )
    except KeyboardInterrupt as error:
        raise CancelledError from error
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise CancelledError from error
        return str(error)
    return Regridded(
        vertices=done.fill.vertices,
        triangles=done.fill.triangles,
        quads=done.fill.quads,
        source_faces=done.source_faces,
        source_weights=done.source_weights,
        unused=done.unused,
        report={**done.fill.report, "off": done.off},
    )


def bridge(
    vertices: np.ndarray,
    triangles: np.ndarray,
    loop: Sequence[int],
    other: Sequence[int],
    *,
    smooth: str,
    rows: int | None = None,
    twist: float = 0.0,
    polygons: np.ndarray | None = None,
    poses: Sequence[np.ndarray] = (),
    progress: Progress | None = None,
) -> Filled | str:
    """Join two loops of a mesh by a tube: the patch, or the reason why there is none.

    rows : of triangles, None for as many as suit. twist : radians from the best fit. The others are as of `fill`. Raises
    NativeError without the module, and CancelledError if `progress` or Ctrl-C asked to stop.
    """
    gridmesh = native("bridge")
    try:
        made = gridmesh.bridge(
            vertices,
            triangles,
            np.asarray(loop, np.int32),
            np.asarray(other, np.int32),
            smooth=smooth,
            rows=rows,
            twist=twist,
            polygons=polygons,
            progress=progress,
        )
        return _filled(gridmesh, made, vertices, poses)
    except KeyboardInterrupt as error:
        raise CancelledError from error
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise CancelledError from error
        return str(error)


def _filled(gridmesh: Any, fill: Any, vertices: np.ndarray, poses: Sequence[np.ndarray]) -> Filled | str:
    if isinstance(fill, gridmesh.GridMeshError):
        return str(fill)
    try:
        solved = [fill.vertices if pose is vertices else fill.refit(pose) for pose in poses]
    except gridmesh.GridMeshError as error:
        return f"in another shape key {error}"
    return Filled(
        fill.vertices, fill.triangles, fill.quads, fill.creases, solved, dict(fill.report), fill.extend
    )


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
