# SPDX-License-Identifier: GPL-3.0-or-later
"""From the pixels of a picture to one mesh of all that it shows: the calls into `gridmesh`. numpy only, no bpy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..api import FACE_AREA, CancelledError, Progress, cancelling, faces_of, part_of
from ..native import native
from .sizes import FINER, SHORT, Lacks, area, even, finest, lacks_of, shortest
from .tracing import Options, Outlines, PictureError, check_size, traced

_SQUARE = 0.75
"""How far whole pixels may reach over the outline of what they cover, at most."""

_AGAIN = 0.5
"""Parts whose edges are at least this long, relative to those of the others, are meshed again where their mesh lacks something."""

_MOST = 4
"""Sizes tried at most for parts that are cut off."""

_SIZES = (1.0, 0.94, 0.88)
"""Edge lengths tried for bodies with short edges, relative to that wanted: little finer each, as the lattice lies elsewhere at any other size."""

_MISSING = 0.01
"""Share of the area that may be missing because lines are too thin, before all is widened."""

_WIDER = (0.5, 1.0)
"""By how many pixels."""

_TRACING = 0.3
"""Part of the time that tracing takes; the rest is meshing."""


@dataclass(frozen=True, eq=False)
class Cutout:
    """Mesh of all parts of a picture, in pixels from its lower left corner, z towards the viewer."""

    vertices: np.ndarray
    faces: np.ndarray
    """(f, 3) triangles, or (f, 4) quads."""
    uv: np.ndarray
    """By corner, exactly over the picture."""
    silhouette: list[np.ndarray]
    starts: np.ndarray
    """First vertex of each part."""
    corner: list[np.ndarray]
    """Turning angle of the corner of the outline at each vertex of the silhouette; 0 elsewhere."""
    parts: int
    dropped: int
    """Islands that were too small."""
    refused: list[str]
    """Why parts are missing."""
    widened: float = 0.0
    """How many pixels the margin is wider than asked for, because lines were too thin to be meshed."""


def cut_out(pixels: np.ndarray, options: Options, progress: Progress | None = None) -> Cutout:
    """Trace a picture (h, w, 4), rows from the top, colours and alpha from 0 to 1, and mesh what it shows.

    Raises
    ------
    PictureError
        If there is nothing to mesh.
    CancelledError
        If `progress` or Ctrl-C asked to stop.
    NativeError
        Without the module.
    """
    gridmesh = native("trace_image", "mesh_sketch", "flat", "inflate")
    height, width = pixels.shape[:2]
    check_size(width, height)
    try:
        with cancelling(gridmesh):
            outlines = traced(gridmesh, pixels, options, part_of(progress, 0.0, _TRACING))
            if not outlines.parts:
                raise PictureError(_nothing(outlines.dropped))
            surfaces = _meshed(gridmesh, outlines, options, part_of(progress, _TRACING, 1.0))
            widened = 0.0
            if _is_thin(outlines.parts, surfaces):
                outlines, surfaces, widened = _widened(
                    gridmesh, pixels, (outlines, surfaces), options, progress
                )
            _tell_numbers(gridmesh, outlines.parts, surfaces, options, progress)
    except gridmesh.GridMeshError as error:
        raise PictureError(str(error)) from error
    refused = [str(surface) for surface in surfaces if isinstance(surface, gridmesh.GridMeshError)]
    meshed = [surface for surface in surfaces if not isinstance(surface, gridmesh.GridMeshError)]
    if not meshed:
        raise PictureError(refused[0])
    starts = np.cumsum([0, *(len(surface.vertices) for surface in meshed)])
    vertices = np.concatenate([surface.vertices for surface in meshed])
    faces = np.concatenate(
        [faces_of(surface) + start for surface, start in zip(meshed, starts, strict=False)]
    ).astype(np.int32)
    return Cutout(
        vertices=vertices,
        faces=faces,
        uv=vertices[faces.ravel(), :2] / [width, height],
        silhouette=[
            loop + start
            for surface, start in zip(meshed, starts, strict=False)
            for loop in surface.silhouette
        ],
        starts=starts[:-1],
        corner=[row for surface in meshed for row in surface.corner],
        parts=len(meshed),
        dropped=outlines.dropped,
        refused=refused,
        widened=widened,
    )


def _is_coarse(surface: Any) -> bool:
    """Whether no size could follow a part."""
    return getattr(surface, "kind", "") in {"too_coarse", "no_patch"}


def _is_thin(parts: list[Any], surfaces: list[Any]) -> bool:
    """Whether lines are too thin in more of the picture than specks."""
    missing = sum(_drawn(part) for part, surface in zip(parts, surfaces, strict=True) if _is_coarse(surface))
    return missing > _MISSING * sum(map(_drawn, parts))


def _widened(
    gridmesh: Any,
    pixels: np.ndarray,
    first: tuple[Outlines, list[Any]],
    options: Options,
    progress: Progress | None,
) -> tuple[Outlines, list[Any], float]:
    """Outlines and surfaces with a wider margin, if lines are no longer too thin with it, and by how much it is wider; else the first ones."""
    for more in _WIDER:
        outlines = traced(gridmesh, pixels, options, part_of(progress, 1.0, 1.0), more)
        wider = replace(options, margin=options.margin + more)
        surfaces = _meshed(gridmesh, outlines, wider, part_of(progress, 1.0, 1.0))
        if not _is_thin(outlines.parts, surfaces):
            return outlines, surfaces, more
    return *first, 0.0


def _nothing(dropped: int) -> str:
    if dropped:
        return f"all of its {dropped} islands are smaller than the least area; lower Least Area"
    return "nothing in it is covered; choose another background or a lower threshold"


def _meshed(gridmesh: Any, outlines: Outlines, options: Options, progress: Progress | None) -> list[Any]:
    """Surface or GridMeshError for each part, all with edges of about the same length."""
    parts = outlines.parts
    number, cells, length = _asked(parts, options)
    lacks = lacks_of(parts, length, options.body is not None, options.margin, outlines.faint)
    results: list[Any] = [None] * len(parts)

    def mesh(which: list[int], finer: float, of_these: Progress | None) -> dict[int, Any]:
        made = _surfaces(
            gridmesh,
            [parts[k] for k in which],
            {"cells": cells, "edge_length": finer * length, "least": False, **_bend(cells, options)},
            options,
            # Lines that are thin for the triangles wanted have many as it is.
            [lacks[k] if finer >= _AGAIN else None for k in which],
            of_these,
        )
        if any(getattr(surface, "kind", "") == "cancelled" for surface in made):
            raise CancelledError
        return dict(zip(which, made, strict=True))

    left = list(range(len(parts)))
    sizes = finest(number)
    for step, finer in enumerate(sizes):
        # Most parts are made at once.
        now = part_of(progress, 1 - 0.5**step, 1 - 0.5 ** (step + 1))
        for k, surface in mesh(left, finer, now).items():
            results[k] = surface
        left = [k for k in left if _is_coarse(results[k])]
        if not left:
            break
    if len(parts) > 1 and cells == "triangles":
        even(results, lambda which, finer: mesh(which, finer, part_of(progress, 1.0, 1.0)))
    return results


def _asked(parts: list[Any], options: Options) -> tuple[int, str, float]:
    """The number asked for, of which cells, and the length of their edges."""
    cells = "triangles" if options.quads is None else "quads"
    number = options.triangles if options.quads is None else options.quads
    if number <= 0:
        raise PictureError(f"{cells.capitalize()} of Each Side is {number}; allowed: 1 or more")
    return number, cells, float(np.sqrt(sum(map(_drawn, parts)) / number / FACE_AREA[cells]))


def _tell_numbers(
    gridmesh: Any, parts: list[Any], surfaces: list[Any], options: Options, progress: Progress | None
) -> None:
    """Have the errors of parts that no size could follow tell the numbers that can, in place."""
    for k, surface in enumerate(surfaces):
        if getattr(surface, "kind", "") == "too_coarse":
            surfaces[k] = _too_few(
                gridmesh, parts[k], sum(map(_drawn, parts)), options, _asked(parts, options), progress
            )


def _too_few(
    gridmesh: Any,
    part: tuple[np.ndarray, list[np.ndarray]],
    total: float,
    options: Options,
    asked: tuple[int, str, float],
    progress: Progress | None,
) -> Any:
    """The error for a part that no size could follow, with the number for the whole picture that would."""
    number, cells, length = asked
    try:
        gridmesh.mesh_sketch(
            *part,
            cells=cells,
            edge_length=length,
            least=True,
            progress=part_of(progress, 1.0, 1.0),
            **_bend(cells, options),
        )
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise CancelledError from error
        if error.least is None:
            return error
        least = int(np.ceil(error.least * total / _drawn(part)))
        few = {
            "triangles": f"{number} triangles are too few to follow this drawing",
            "quads": f"{number} quads are too few to follow this drawing",
        }
        refused = gridmesh.GridMeshError(few[cells] + "; " + f"{least} work (or a smaller edge length)")
        refused.kind, refused.least = error.kind, least
        return refused
    return gridmesh.GridMeshError(
        "this drawing can be followed, but not covered" + "; " + "use a margin of 0"
    )


def _bend(cells: str, options: Options) -> dict[str, float]:
    """Lattice options of the kind of mesh: sprites of triangles lie on a straight lattice.

    Its even sizes leave less that is empty around the ends of limbs, for some more irregular vertices, which nobody sees on what
    is flat.
    """
    return {"bend": 0.0} if options.body is None and cells == "triangles" else {}


def _surfaces(
    gridmesh: Any,
    parts: list[Any],
    options: dict[str, Any],
    chosen: Options,
    lacks: list[Lacks | None],
    progress: Progress | None,
) -> list[Any]:
    """Surface or GridMeshError for each part; those that lack more than they may are meshed again, finer."""
    body = chosen.body
    # Only flat corners have a single quad.
    options = {**options, "open_corners": body is None}
    if body is not None and "corner_angle" in body:
        options = {**options, "corner_angle": body["corner_angle"]}

    def surface(at: int) -> Any:
        part = part_of(progress, at / len(parts), (at + 1) / len(parts))
        try:
            if body is None:
                return gridmesh.flat(_patch(gridmesh, parts[at], options, chosen, lacks[at], part))
            return _body(gridmesh, parts[at], options, chosen, lacks[at], part)
        except gridmesh.GridMeshError as error:
            return error

    return [surface(at) for at in range(len(parts))]


def _in_sizes(
    gridmesh: Any,
    sizes: tuple[float, ...],
    options: dict[str, Any],
    make: Callable[[dict[str, Any], Progress | None], Any],
    progress: Progress | None,
) -> Iterator[Any]:
    """What is made with edges of each of these lengths, relative to that wanted; no more where one is refused after the first."""
    for step, size in enumerate(sizes):
        sized = {**options, "edge_length": size * options["edge_length"]}
        try:
            made = make(sized, part_of(progress, step / len(sizes), (step + 1) / len(sizes)))
        except gridmesh.GridMeshError as error:
            if step == 0 or error.kind == "cancelled":
                raise
            return
        yield made


def _body(
    gridmesh: Any,
    part: tuple[np.ndarray, list[np.ndarray]],
    options: dict[str, Any],
    chosen: Options,
    lacks: Lacks | None,
    progress: Progress | None,
) -> Any:
    """Body on the outline of a part; of a few sizes the first that has no short edge, or the one whose shortest is longest."""

    def make(sized: dict[str, Any], of_this: Progress | None) -> Any:
        patch = _patch(gridmesh, part, sized, chosen, lacks, part_of(of_this, 0.0, 0.7))
        return gridmesh.inflate(patch, progress=part_of(of_this, 0.7, 1.0), **chosen.body)

    # Quads at a rim are low by themselves.
    sizes = _SIZES if lacks is not None and options["cells"] == "triangles" else _SIZES[:1]
    made = []
    for body in _in_sizes(gridmesh, sizes, options, make, progress):
        made.append(body)
        if shortest(body) >= SHORT:
            return body
    return max(made, key=shortest)


def _patch(
    gridmesh: Any,
    part: tuple[np.ndarray, list[np.ndarray]],
    options: dict[str, Any],
    chosen: Options,
    lacks: Lacks | None,
    progress: Progress | None,
) -> Any:
    """Patch on the outline of a part, or one that covers it but for what the margin allows, or lies across it.

    It is finer where it lacks more than it may, unless nothing is said of that.
    """
    outline, holes = part
    if chosen.margin <= 0 and not chosen.cover:
        return gridmesh.mesh_sketch(outline, holes, progress=progress, **options)
    across = chosen.margin <= 0
    slack = max(0.0, chosen.margin - _SQUARE)

    def make(sized: dict[str, Any], of_this: Progress | None) -> Any:
        return gridmesh.cover_sketch(outline, holes, slack=slack, across=across, progress=of_this, **sized)

    if lacks is None:
        return make(options, progress)
    found = []
    for patch in _in_sizes(gridmesh, FINER[:_MOST], options, make, progress):
        found.append(patch)
        if lacks.are_enough(found):
            break
    return min(found, key=lacks.of)


def _drawn(part: tuple[np.ndarray, list[np.ndarray]]) -> float:
    outline, holes = part
    return area(outline) + sum(map(area, holes))
