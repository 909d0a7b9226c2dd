# SPDX-License-Identifier: GPL-3.0-or-later
"""From the pixels of a picture to one mesh of all that it shows: the calls into `gridmesh`. numpy only, no bpy."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..api import FACE_AREA, Progress, cancelling, faces_of, part_of
from ..bodies.outlines import area
from ..native import native
from .tracing import Options, Outlines, PictureError, check_size, traced

_MISSING = 0.01
"""Share of the area that may be missing because lines are too thin, before all is widened."""

_WIDER = (0.5, 1.0)
"""By how many pixels."""

_TRACING = 0.3
"""Part of the time that tracing takes; the rest is meshing."""

_MORE = 1.2
"""How many times as many faces as were asked for are told."""

_WHY = {
    "thin": "fewer cannot follow its thin lines",
    "cut_off": "fewer cut off more of its tips",
    "area": "fewer follow its outline less closely",
    "short": "fewer have short edges",
    None: "its thin parts and corners take more",
    "beside": "fewer have short edges in its thin parts beside long ones",
}


@dataclass(frozen=True, eq=False)
class _Meshed:
    """The parts of a picture as they are meshed."""

    surfaces: list[Any]
    """Surface or GridMeshError for each."""
    why: str | None
    """Why most of what is finer than asked for is so; nothing if nothing is."""


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
    asked: int = 0
    """Faces of one side that were asked for."""
    finer: str = ""
    """Why it has more, if it has."""
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
    gridmesh = native("trace_image", "mesh_cutout", "mesh_sketch")
    height, width = pixels.shape[:2]
    check_size(width, height)
    try:
        with cancelling(gridmesh):
            outlines = traced(gridmesh, pixels, options, part_of(progress, 0.0, _TRACING))
            if not outlines.parts:
                raise PictureError(_nothing(outlines.dropped))
            meshed = _meshed(gridmesh, outlines, options, part_of(progress, _TRACING, 1.0))
            widened = 0.0
            if _is_thin(outlines.parts, meshed.surfaces):
                outlines, meshed, widened = _widened(gridmesh, pixels, (outlines, meshed), options, progress)
            surfaces = meshed.surfaces
            _tell_numbers(gridmesh, outlines.parts, surfaces, options, progress)
    except gridmesh.GridMeshError as error:
        raise PictureError(str(error)) from error
    refused = [str(surface) for surface in surfaces if isinstance(surface, gridmesh.GridMeshError)]
    found = [surface for surface in surfaces if not isinstance(surface, gridmesh.GridMeshError)]
    if not found:
        raise PictureError(refused[0])
    starts = np.cumsum([0, *(len(surface.vertices) for surface in found)])
    vertices = np.concatenate([surface.vertices for surface in found])
    faces = np.concatenate(
        [faces_of(surface) + start for surface, start in zip(found, starts, strict=False)]
    ).astype(np.int32)
    asked = options.triangles if options.quads is None else options.quads
    more = len(faces) > _MORE * asked * (1 if options.body is None else 2)
    return Cutout(
        vertices=vertices,
        faces=faces,
        uv=vertices[faces.ravel(), :2] / [width, height],
        silhouette=[
            loop + start for surface, start in zip(found, starts, strict=False) for loop in surface.silhouette
        ],
        starts=starts[:-1],
        corner=[row for surface in found for row in surface.corner],
        parts=len(found),
        dropped=outlines.dropped,
        refused=refused,
        asked=asked,
        finer=_WHY[meshed.why] if more else "",
        widened=widened,
    )


def _is_thin(parts: list[Any], surfaces: list[Any]) -> bool:
    """Whether lines are too thin in more of the picture than specks."""
    missing = sum(
        _drawn(part)
        for part, surface in zip(parts, surfaces, strict=True)
        if getattr(surface, "kind", "") in {"too_coarse", "no_patch"}
    )
    return missing > _MISSING * sum(map(_drawn, parts))


def _widened(
    gridmesh: Any,
    pixels: np.ndarray,
    first: tuple[Outlines, _Meshed],
    options: Options,
    progress: Progress | None,
) -> tuple[Outlines, _Meshed, float]:
    """Outlines and surfaces with a wider margin, if lines are no longer too thin with it, and by how much it is wider; else the first ones."""
    for more in _WIDER:
        outlines = traced(gridmesh, pixels, options, part_of(progress, 1.0, 1.0), more)
        wider = replace(options, margin=options.margin + more)
        meshed = _meshed(gridmesh, outlines, wider, part_of(progress, 1.0, 1.0))
        if not _is_thin(outlines.parts, meshed.surfaces):
            return outlines, meshed, more
    return *first, 0.0


def _nothing(dropped: int) -> str:
    if dropped:
        return f"all of its {dropped} islands are smaller than the least area; lower it"
    return "nothing in it is covered; choose another background or a lower threshold"


def _meshed(gridmesh: Any, outlines: Outlines, options: Options, progress: Progress | None) -> _Meshed:
    """Surface or GridMeshError for each part, all with edges of about the same length."""
    number, cells, _ = _asked(outlines.parts, options)
    surfaces, why = gridmesh.mesh_cutout(
        outlines.parts,
        margin=max(0.0, options.margin),
        cover=options.cover,
        faint=outlines.faint,
        body=options.body,
        progress=progress,
        **{cells: number},
    )
    return _Meshed(surfaces, why)


def _asked(parts: list[Any], options: Options) -> tuple[int, str, float]:
    """The number asked for, of which cells, and the length of their edges."""
    cells = "triangles" if options.quads is None else "quads"
    number = options.triangles if options.quads is None else options.quads
    if number <= 0:
        raise PictureError(f"{cells} is {number}; allowed: 1 or more")
    return number, cells, float(np.sqrt(sum(map(_drawn, parts)) / number / FACE_AREA[cells]))


def _tell_numbers(
    gridmesh: Any, parts: list[Any], surfaces: list[Any], options: Options, progress: Progress | None
) -> None:
    """Have the errors of parts that no size could follow tell the numbers that can, in place."""
    for k, surface in enumerate(surfaces):
        if getattr(surface, "kind", "") == "too_coarse":
            surfaces[k] = _too_few(gridmesh, parts, k, options, part_of(progress, 1.0, 1.0))


def _too_few(gridmesh: Any, parts: list[Any], k: int, options: Options, progress: Progress | None) -> Any:
    """The error for a part that no size could follow, with the number for the whole picture that would."""
    number, cells, length = _asked(parts, options)
    # As sprites of triangles are meshed.
    lattice = {"bend": 0.0} if options.body is None and cells == "triangles" else {}
    try:
        gridmesh.mesh_sketch(
            *parts[k], cells=cells, edge_length=length, least=True, progress=progress, **lattice
        )
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise
        if error.least is None:
            return error
        least = int(np.ceil(error.least * sum(map(_drawn, parts)) / _drawn(parts[k])))
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


def _drawn(part: tuple[np.ndarray, list[np.ndarray]]) -> float:
    outline, holes = part
    return area(outline) - sum(map(area, holes))
