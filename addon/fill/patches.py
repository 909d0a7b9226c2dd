# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches of meshes as arrays: holes filled, areas meshed anew, two or more loops joined. numpy only, no bpy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from ..api import Progress, cancelling
from ..native import native

NO_PATCH = "no triangles between these loops make one patch; subdivide the smallest, or join fewer at once"
"""Said of three loops or more."""

APART = "some of the loops look away from each other, as both ends of a pipe do, and one patch would meet itself; choose Pairs under Loops"
"""Why one patch is refused that would have to turn round."""

MEETS = "a tube between two of the loops would meet the mesh or itself; select these two alone to join them all the same"
"""Said of one of several pairs of loops."""


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A mesh as arrays, in the directions and lengths of the world but about the object's origin."""

    positions: np.ndarray
    """(n, 3), those of the active shape key."""
    triangles: np.ndarray
    polygons: np.ndarray
    """(m,) the face that each triangle is a part of."""
    to_local: np.ndarray
    """(3, 3), back to the object's space."""
    poses: list[np.ndarray]
    """Positions of every shape key, `positions` among them; none without shape keys."""


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
    at: Snapshot, loops: Sequence[Sequence[int]], progress: Progress | None = None, **options: Any
) -> list[Filled | str]:
    """Fill loops of a mesh: for each the patch, or the reason why there is none.

    loops : vertex indices in order. options : `smooth`, `sharp`, `creases` and `cells` of `gridmesh.fill_holes`. Raises
    NativeError without the module, and CancelledError if `progress` or Ctrl-C asked to stop.
    """
    gridmesh = native("fill_holes")
    indices = [np.asarray(loop, np.int32) for loop in loops]

    try:
        with cancelling(gridmesh):
            fills = gridmesh.fill_holes(
                at.positions, at.triangles, indices, polygons=at.polygons, progress=progress, **options
            )
            return [_filled(gridmesh, fill, at, progress) for fill in fills]
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
    at: Snapshot, area: np.ndarray, progress: Progress | None = None, **options: Any
) -> Regridded | str:
    """Mesh an area anew, or tell why it cannot be.

    area : (f,) numbers of triangles, a disk. options : `keep_shape`, `smooth` and `cells` of `gridmesh.regrid`. Raises
    NativeError without the module, and CancelledError if `progress` or Ctrl-C asked to stop.
    """
    gridmesh = native("regrid")
    try:
        with cancelling(gridmesh):
            done = gridmesh.regrid(
                at.positions, at.triangles, area, polygons=at.polygons, progress=progress, **options
            )
    except gridmesh.GridMeshError as error:
        return str(error)
    rim = at.positions[done.fill.loop]
    edge = float(np.linalg.norm(rim - np.roll(rim, 1, axis=0), axis=1).mean())
    return Regridded(
        vertices=done.fill.vertices,
        triangles=done.fill.triangles,
        quads=done.fill.quads,
        source_faces=done.source_faces,
        source_weights=done.source_weights,
        unused=done.unused,
        report={
            **done.fill.report,
            "off": done.off,
            "lost": done.lost / edge if options.get("keep_shape", True) else 0.0,
        },
    )


def bridge(
    at: Snapshot,
    loop: Sequence[int],
    other: Sequence[int],
    progress: Progress | None = None,
    **options: Any,
) -> Filled | str:
    """Join two loops of a mesh by a tube: the patch, or the reason why there is none.

    options : `smooth`, `rows`, `twist` and `cells` of `gridmesh.bridge`. Raises NativeError without the module, and
    CancelledError if `progress` or Ctrl-C asked to stop.
    """
    ends = [np.asarray(it, np.int32) for it in (loop, other)]
    return _made(native("bridge").bridge, at, ends, progress, options)


def look_apart(at: Snapshot, loops: Sequence[Sequence[int]]) -> bool:
    """Whether two of some loops look away from each other, as both ends of a pipe: one patch between all would meet itself.

    False where a loop cannot be joined at all.
    """
    gridmesh = native("look_apart")
    try:
        return gridmesh.look_apart(at.positions, at.triangles, [np.asarray(it, np.int32) for it in loops])
    except gridmesh.GridMeshError:
        return False


def bridge_pairs(
    at: Snapshot, loops: Sequence[Sequence[int]], progress: Progress | None = None, **options: Any
) -> list[tuple[int, int, Filled | str]] | str:
    """Join loops of a mesh two by two, the nearest first: the places of both and the tube or the reason why there is none.

    options : `smooth`, `rows`, `twist` and `cells` of `gridmesh.bridge_pairs`. A tube that would meet the mesh or another is refused.
    Raises NativeError without the module, and CancelledError if `progress` or Ctrl-C asked to stop.
    """
    gridmesh = native("bridge_pairs")
    indices = [np.asarray(loop, np.int32) for loop in loops]
    try:
        with cancelling(gridmesh):
            pairs = gridmesh.bridge_pairs(
                at.positions,
                at.triangles,
                indices,
                polygons=at.polygons,
                strict=True,
                progress=progress,
                **options,
            )
            return [(one, other, _filled(gridmesh, tube, at, progress)) for one, other, tube in pairs]
    except gridmesh.GridMeshError as error:
        return str(error)


def fill_loops(
    at: Snapshot, loops: Sequence[Sequence[int]], progress: Progress | None = None, **options: Any
) -> Filled | str:
    """Join loops of a mesh by one patch that has them all as its boundary: the patch, or the reason why there is none.

    loops : vertex indices in order, of each loop. `extend` of the patch takes values one loop after the other. options :
    `smooth` and `cells` of `gridmesh.fill_hole`. Raises NativeError without the module, and CancelledError if `progress` or
    Ctrl-C asked to stop.
    """
    indices = [np.asarray(loop, np.int32) for loop in loops]
    return _made(
        native("fill_hole").fill_hole,
        at,
        [indices],
        progress,
        options,
        refusals={"no_patch": NO_PATCH, "fill_intersects": APART},
    )


def _made(
    make: Callable[..., Any],
    at: Snapshot,
    loops: Sequence[Any],
    progress: Progress | None,
    options: dict[str, Any],
    *,
    refusals: Mapping[str, str] = MappingProxyType({}),
) -> Filled | str:
    """The patch that a function of the module makes, or the reason why there is none.

    refusals : what is said in place of the module's own words, by the kind of its error.
    """
    gridmesh = native()
    try:
        with cancelling(gridmesh):
            made = make(
                at.positions, at.triangles, *loops, polygons=at.polygons, progress=progress, **options
            )
            return _filled(gridmesh, made, at, progress)
    except gridmesh.GridMeshError as error:
        return refusals.get(error.kind, str(error))


def _filled(gridmesh: Any, fill: Any, at: Snapshot, progress: Progress | None) -> Filled | str:
    if isinstance(fill, gridmesh.GridMeshError):
        return MEETS if fill.kind == "fill_intersects" else str(fill)

    def go_on(_: float) -> object:
        # The fill itself has reported the whole.
        return None if progress is None else progress(1.0)

    try:
        solved = [
            fill.vertices if pose is at.positions else fill.refit(pose, progress=go_on) for pose in at.poses
        ]
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise
        return f"in another shape key {error}"
    return Filled(
        fill.vertices, fill.triangles, fill.quads, fill.creases, solved, dict(fill.report), fill.extend
    )
