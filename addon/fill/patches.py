# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches of meshes as arrays: holes filled, areas meshed anew, two or more loops joined. numpy only, no bpy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..api import Progress, cancelling
from ..native import native

NO_PATCH = "no triangles between these loops make one patch; subdivide the smallest, or join fewer at once"
"""Said of three loops or more."""


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
    """From values at the loops' vertices (k, c), one loop after the other, to values at the new ones (j, c)."""


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
    hard, as of `gridmesh.fill_hole`. cells : "triangles" or "quads". Raises NativeError without the module, and
    CancelledError if `progress` or Ctrl-C asked to stop.
    """
    gridmesh = native("fill_holes")
    indices = [np.asarray(loop, np.int32) for loop in loops]

    try:
        with cancelling(gridmesh):
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
            return [_filled(gridmesh, fill, vertices, poses, progress) for fill in fills]
    except gridmesh.GridMeshError as error:
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
    surface. polygons : (m,), of which each triangle is a part. cells : "triangles" or "quads". Raises
    NativeError without the module, and CancelledError if `progress` or Ctrl-C asked to stop.
    """
    gridmesh = native("regrid")
    try:
        with cancelling(gridmesh):
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
    except gridmesh.GridMeshError as error:
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
    cells: str = "triangles",
    progress: Progress | None = None,
) -> Filled | str:
    """Join two loops of a mesh by a tube: the patch, or the reason why there is none.

    rows : of faces, None for as many as suit. twist : radians from the best fit. The others are as of `fill`. Raises
    NativeError without the module, and CancelledError if `progress` or Ctrl-C asked to stop.
    """
    options = {"smooth": smooth, "rows": rows, "twist": twist, "polygons": polygons, "cells": cells}
    ends = [np.asarray(it, np.int32) for it in (loop, other)]
    gridmesh = native("bridge")
    return _made(
        lambda **more: gridmesh.bridge(vertices, triangles, *ends, **options, **more),
        vertices,
        poses,
        progress,
    )


def fill_loops(
    vertices: np.ndarray,
    triangles: np.ndarray,
    loops: Sequence[Sequence[int]],
    *,
    smooth: str,
    polygons: np.ndarray | None = None,
    poses: Sequence[np.ndarray] = (),
    cells: str = "triangles",
    progress: Progress | None = None,
) -> Filled | str:
    """Join loops of a mesh by one patch that has them all as its boundary: the patch, or the reason why there is none.

    loops : vertex indices in order, of each loop. `extend` of the patch takes values one loop after the other. The others are
    as of `fill`. Raises NativeError without the module, and CancelledError if `progress` or Ctrl-C asked to stop.
    """
    options = {"smooth": smooth, "polygons": polygons, "cells": cells}
    indices = [np.asarray(loop, np.int32) for loop in loops]
    gridmesh = native("fill_hole")
    return _made(
        lambda **more: gridmesh.fill_hole(vertices, triangles, indices, **options, **more),
        vertices,
        poses,
        progress,
        no_patch=NO_PATCH,
    )


def _made(
    make: Callable[..., Any],
    vertices: np.ndarray,
    poses: Sequence[np.ndarray],
    progress: Progress | None,
    no_patch: str = "",
) -> Filled | str:
    """The patch that a call of the module makes, or the reason why there is none. no_patch : said where the module finds none."""
    gridmesh = native()
    try:
        with cancelling(gridmesh):
            return _filled(gridmesh, make(progress=progress), vertices, poses, progress)
    except gridmesh.GridMeshError as error:
        return no_patch if no_patch and error.kind == "no_patch" else str(error)


def _filled(
    gridmesh: Any,
    fill: Any,
    vertices: np.ndarray,
    poses: Sequence[np.ndarray],
    progress: Progress | None,
) -> Filled | str:
    if isinstance(fill, gridmesh.GridMeshError):
        return str(fill)

    def go_on(_: float) -> object:
        # The fill itself has reported the whole.
        return None if progress is None else progress(1.0)

    try:
        solved = [fill.vertices if pose is vertices else fill.refit(pose, progress=go_on) for pose in poses]
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise
        return f"in another shape key {error}"
    return Filled(
        fill.vertices, fill.triangles, fill.quads, fill.creases, solved, dict(fill.report), fill.extend
    )
