# SPDX-License-Identifier: GPL-3.0-or-later
"""From the pixels of a picture to one mesh of all that it shows: the calls into `gridmesh`. numpy only, no bpy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..api import FACE_AREA, CancelledError, Progress, cancelling, faces_of, part_of
from ..native import native

PIXELS = 100_000_000
"""The most pixels of a picture, as the module has it; asked for before they are read."""

FINER = (1.0, 0.7, 0.5, 0.35, 0.25)
"""Edge lengths tried for parts that are too thin, relative to that of the others."""

_SQUARE = 0.75
"""How far whole pixels may reach over the outline of what they cover, at most."""

_AGAIN = 0.5
"""Parts whose edges are at least this long, relative to those of the others, are meshed again where their mesh lacks something."""

CUT_OFF = 0.4
"""Parts of whose outlines this many pixels stay outside, beyond the slack, are meshed finer: middles of pixels lie deeper inside."""

EMPTY = 0.03
"""Likewise parts whose mesh is larger than the outline by more than this share."""

EMPTY_OF_BODY = 0.01
"""The same for bodies, whose rims are opaque: seen from the front they overlap their pictures by 99 % where that can be held."""

BETWEEN = 0.0045
"""Likewise parts of bodies without a margin, if so much of their area lies between mesh and outline."""

FEW = 0.0015
"""But parts of bodies are not made finer for less than this share of all that the picture shows."""

_MOST = 4
"""Sizes tried at most for parts that are cut off."""

SHORT = 1 / 3
"""Bodies with edges shorter than this, in mean lengths of their edges, are tried in other sizes: it shows in a texture."""

_SIZES = (1.0, 0.94, 0.88)
"""Edge lengths tried for these, relative to that wanted: little finer each, as the lattice lies elsewhere at any other size."""

_TRACING = 0.3
"""Part of the time that tracing takes; the rest is meshing."""


class PictureError(ValueError):
    """Nothing can be made of a picture. The message says why and what to do, without naming the picture."""


@dataclass(frozen=True)
class Options:
    """How a picture is read, and what is made of it."""

    paper: bool = False
    """What is not paper counts, instead of what is not transparent."""
    threshold: float | None = None
    """None: the one that parts the pixels best."""
    smooth: float = 1.0
    min_area: float = 4.0
    margin: float = 0.0
    cover: bool = False
    """Without a margin the rim of the mesh lies across the outline, as much of it outside as inside; otherwise its vertices lie on it."""
    holes: bool = True
    triangles: int = 1000
    """Of one side, shared by the parts according to their area."""
    quads: int | None = None
    """The same of quads; None makes triangles."""
    body: dict[str, Any] | None = None
    """Keyword arguments of `gridmesh.inflate`; None for a flat sheet."""


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


def check_size(width: int, height: int) -> None:
    """Raise PictureError for a picture that has no pixels or too many."""
    if not 0 < width * height <= PIXELS:
        raise PictureError(
            f"it has {width} by {height} pixels; allowed: 1 to {PIXELS} pixels in all, scale it"
        )


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
            traced = gridmesh.trace_image(
                pixels,
                background="paper" if options.paper else "transparent",
                threshold="auto" if options.threshold is None else options.threshold,
                smooth=options.smooth,
                min_area=options.min_area,
                margin=options.margin,
                progress=part_of(progress, 0.0, _TRACING),
            )
            parts = list(traced) if options.holes else _filled(traced)
            if not parts:
                raise PictureError(_nothing(traced.dropped))
            surfaces = _meshed(gridmesh, parts, options, part_of(progress, _TRACING, 1.0))
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
        dropped=traced.dropped,
        refused=refused,
    )


def _nothing(dropped: int) -> str:
    if dropped:
        return f"all of its {dropped} islands are smaller than the least area; lower Least Area"
    return "nothing in it is covered; choose another background or a lower threshold"


def _meshed(gridmesh: Any, parts: list[Any], options: Options, progress: Progress | None) -> list[Any]:
    """Surface or GridMeshError for each part, all with edges of about the same length."""
    total = sum(_area(outline) + sum(map(_area, holes)) for outline, holes in parts)
    cells = "triangles" if options.quads is None else "quads"
    number = options.triangles if options.quads is None else options.quads
    if number <= 0:
        raise PictureError(f"{cells.capitalize()} of Each Side is {number}; allowed: 1 or more")
    length = np.sqrt(total / number / FACE_AREA[cells])
    few = 0.0 if options.body is None else FEW * total
    results: list[Any] = [None] * len(parts)
    left = list(range(len(parts)))
    for step, finer in enumerate(FINER):
        found = _surfaces(
            gridmesh,
            [parts[k] for k in left],
            {"cells": cells, "edge_length": finer * length, "least": False, **_bend(cells, options)},
            options,
            # Lines that are thin for the triangles wanted have many as it is.
            few if finer >= _AGAIN else None,
            part_of(progress, step / len(FINER), (step + 1) / len(FINER)),
        )
        for k, surface in zip(left, found, strict=True):
            results[k] = surface
        kinds = {k: getattr(results[k], "kind", "") for k in left}
        if "cancelled" in kinds.values():
            raise CancelledError
        left = [k for k in left if kinds[k] in {"too_coarse", "no_patch"}]
        if not left:
            break
    return results


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
    few: float | None,
    progress: Progress | None,
) -> list[Any]:
    """Surface or GridMeshError for each part; those that lack more than a few pixels are meshed again, finer."""
    body = chosen.body
    # Only flat corners have a single quad.
    options = {**options, "open_corners": body is None}
    if body is not None and "corner_angle" in body:
        options = {**options, "corner_angle": body["corner_angle"]}

    def surface(at: int, outline: np.ndarray, holes: list[np.ndarray]) -> Any:
        part = part_of(progress, at / len(parts), (at + 1) / len(parts))
        try:
            if body is None:
                return gridmesh.flat(_patch(gridmesh, (outline, holes), options, chosen, few, part))
            return _body(gridmesh, (outline, holes), options, chosen, few, part)
        except gridmesh.GridMeshError as error:
            return error

    return [surface(at, *part) for at, part in enumerate(parts)]


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
    few: float | None,
    progress: Progress | None,
) -> Any:
    """Body on the outline of a part; of a few sizes the first that has no short edge, or the one whose shortest is longest."""

    def make(sized: dict[str, Any], of_this: Progress | None) -> Any:
        patch = _patch(gridmesh, part, sized, chosen, few, part_of(of_this, 0.0, 0.7))
        return gridmesh.inflate(patch, progress=part_of(of_this, 0.7, 1.0), **chosen.body)

    # Quads at a rim are low by themselves.
    sizes = _SIZES if few is not None and options["cells"] == "triangles" else _SIZES[:1]
    made = []
    for body in _in_sizes(gridmesh, sizes, options, make, progress):
        made.append(body)
        if _shortest(body) >= SHORT:
            return body
    return max(made, key=_shortest)


def _shortest(surface: Any) -> float:
    """The shortest edge of a surface, in mean lengths of its edges."""
    faces = faces_of(surface)
    edges = np.sort(np.stack([faces, np.roll(faces, 1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    ends = surface.vertices[np.unique(edges, axis=0)]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    return float(lengths.min() / lengths.mean())


def _patch(
    gridmesh: Any,
    part: tuple[np.ndarray, list[np.ndarray]],
    options: dict[str, Any],
    chosen: Options,
    few: float | None,
    progress: Progress | None,
) -> Any:
    """Patch on the outline of a part, or one that covers it but for what the margin allows, or lies across it.

    It is finer where it lacks more than `few` pixels, unless that is None, and more than a share of its own area.
    """
    outline, holes = part
    if chosen.margin <= 0 and not chosen.cover:
        return gridmesh.mesh_sketch(outline, holes, progress=progress, **options)
    across = chosen.margin <= 0
    slack = max(0.0, chosen.margin - _SQUARE)
    drawn = _area(outline) + sum(map(_area, holes))
    share, tries = (EMPTY, 2) if chosen.body is None else (BETWEEN if across else EMPTY_OF_BODY, 3)
    much = max(share * drawn, few or 0.0)

    def lacks(one: Any) -> tuple[float, float]:
        """What is cut off, then the area between mesh and outline; each only from where it shows."""
        if across:
            area = one.report["between"] * drawn
        else:
            area = sum(_area(one.vertices[loop]) for loop in one.loops) - drawn
        return max(one.report["outside"], CUT_OFF), max(area, much)

    def make(sized: dict[str, Any], of_this: Progress | None) -> Any:
        return gridmesh.cover_sketch(outline, holes, slack=slack, across=across, progress=of_this, **sized)

    found = []
    for patch in _in_sizes(gridmesh, FINER[: 1 if few is None else _MOST], options, make, progress):
        found.append(patch)
        cut_off, area = lacks(min(found, key=lacks))
        if cut_off <= CUT_OFF and (area <= much or len(found) >= tries):
            break
    return min(found, key=lacks)


def _filled(traced: list[tuple[np.ndarray, list[np.ndarray]]]) -> list[tuple[np.ndarray, list[np.ndarray]]]:
    """Outlines without their holes, and without what lies in the holes; the largest come first."""
    kept: list[np.ndarray] = []
    for outline, _ in traced:
        if not any(_inside(outline[0], other) for other in kept):
            kept.append(outline)
    return [(outline, []) for outline in kept]


def _inside(point: np.ndarray, polygon: np.ndarray) -> bool:
    """Whether a point lies inside a polygon (even-odd)."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    crossed = (a[:, 1] <= point[1]) != (b[:, 1] <= point[1])
    a, b = a[crossed], b[crossed]
    x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool((x > point[0]).sum() % 2)


def _area(contour: np.ndarray) -> float:
    """Signed area; holes run clockwise."""
    following = np.roll(contour, -1, axis=0)
    return float((contour[:, 0] * following[:, 1] - contour[:, 1] * following[:, 0]).sum() / 2)
