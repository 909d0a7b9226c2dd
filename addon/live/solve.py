# SPDX-License-Identifier: GPL-3.0-or-later
"""The body of a sketch: on the best lattice, or on one that stays where it is while the stroke is being dragged.

numpy only, no bpy.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..api import Body, faces_of, native, reason_of, smooths_rim
from ..bodies.outlines import Plane, Sketch, area, project

ALGORITHM = 4
"""Raised when the same stroke and options give another body. A body made by another one is left alone until asked."""

TILTED = 0.9999
"""Planes whose normals have a smaller cosine are two."""

GROWN = 4.0
"""A lattice is kept while a drawing grows to so many times its area, and its mesh to as many faces."""


class SolveError(Exception):
    """A stroke has no body. The message says why."""


class LeftError(SolveError):
    """A stroke has left the plane of the lattice that it was to keep, or has become too large for it."""


@dataclass(frozen=True, eq=False)
class Lattice:
    """A lattice in a drawing plane."""

    plane: Plane
    edge_length: float
    angle: float
    origin: np.ndarray
    """(2,) in the plane."""
    area: float = math.inf
    """Area of the drawing that it was searched for."""
    patch: Any = None
    """What was meshed on it last: it knows how the lattice bends. None after a file was opened: then it is straight."""


def solve(
    sketch: Sketch,
    sketch_options: dict[str, Any],
    body_options: dict[str, Any] | None,
    *,
    lattice: Lattice | None = None,
    pen: float = 0.0,
    pen_detail: float = 0.0,
) -> tuple[Body, Lattice]:
    """Mesh a sketch, and inflate it unless `body_options` is None.

    lattice : keep it, and its plane; the body is in the frame of that plane. None: the best one, so that the
        body depends on the sketch and the options alone.
    pen, pen_detail : how much the width of the pen drives the depth, and how many faces there are; 0 to 1.

    Raises
    ------
    SolveError
        If there is none.
    NativeError
        Without the module.
    """
    gridmesh = native("mesh_sketch", "inflate", "flat")
    # Only flat corners have a single quad.
    options = {**sketch_options, "open_corners": body_options is None}
    if lattice is not None and area(sketch.outline) > GROWN * lattice.area:
        raise LeftError("the stroke has become too large for its lattice")
    covered = area(sketch.outline)
    if lattice is not None and options.get("mirror") is None:
        covered = lattice.area
        sketch = moved(sketch, lattice.plane)
        for name in ("triangles", "edge_length", "angle", "quads"):
            options.pop(name, None)
        if lattice.patch is not None:
            options["keep"] = lattice.patch
        else:
            options |= {"edge_length": lattice.edge_length, "angle": lattice.angle, "origin": lattice.origin}
    many = shares(sketch, pen_detail)
    if many is not None and options.get("self_crossing") != "union":
        options["density"] = many.tolist()
    holes = [project(hole, sketch.plane)[:, :2] for hole in sketch.holes]
    try:
        patch = _patch(gridmesh, sketch.outline, holes, options)
        if body_options is None:
            surface = gridmesh.flat(patch)
        else:
            surface = gridmesh.inflate(patch, **_with_pen(body_options, sketch, pen))
    except gridmesh.GridMeshError as error:
        raise SolveError(reason_of(error, options)) from error
    body = Body(
        sketch=sketch,
        vertices=surface.vertices,
        faces=faces_of(surface),
        uv=surface.uv,
        silhouette=list(surface.silhouette),
        corner=list(surface.corner),
        report={**patch.report, **surface.report},
        smooth_rim=smooths_rim(body_options),
    )
    return body, Lattice(sketch.plane, patch.edge_length, patch.angle, np.array(patch.origin), covered, patch)


_last: list[Any] = []
"""The drawing and the options that were meshed last, and the patch."""


def _patch(gridmesh: Any, outline: np.ndarray, holes: list[np.ndarray], options: dict[str, Any]) -> Any:
    """Return the patch of a drawing; at once where only the shape of the body was changed since the last one."""
    kept = options.get("keep")
    shown = {name: value for name, value in options.items() if name != "keep"}
    key = (outline.tobytes(), [hole.tobytes() for hole in holes], repr(shown), kept)
    if not _last or _last[0] != key:
        patch = gridmesh.mesh_sketch(outline, holes, least=False, **options)
        _last[:] = key, patch
    return _last[1]


def moved(sketch: Sketch, plane: Plane) -> Sketch:
    """Return the sketch in the frame of another plane.

    Raises
    ------
    LeftError
        If that is tilted against the sketch's own, or faces the other way.
    """
    if sketch.plane.axes[2] @ plane.axes[2] < TILTED:
        raise LeftError("the stroke has left its plane")
    points = project(sketch, plane)
    if np.abs(points[:, 2]).max() > 1e-3 * sketch.size:
        raise LeftError("the stroke has left its plane")
    return Sketch(
        stroke=sketch.stroke,
        plane=plane,
        outline=np.ascontiguousarray(points[:, :2]),
        size=sketch.size,
        off_plane=sketch.off_plane,
        closed_gap=sketch.closed_gap,
        holes=sketch.holes,
    )


def shares(sketch: Sketch, pen: float) -> np.ndarray | None:
    """Share (n,) of the pen's width at each point of the outline in its mean, as far as `pen` says. None without widths."""
    widths = sketch.stroke.widths
    if widths is None or pen <= 0 or len(widths) != len(sketch.stroke.points):
        return None
    mean = float(np.mean(widths))
    if not np.isfinite(mean) or mean <= 0:
        return None
    # Closing may have cut ends off: each point has the width of the drawn point nearest to it.
    drawn = sketch.plane.local(sketch.stroke.points)[:, :2]
    at = np.empty(len(sketch.outline), int)
    for block in range(0, len(at), 256):
        apart = sketch.outline[block : block + 256, None] - drawn[None]
        at[block : block + 256] = np.einsum("ijk,ijk->ij", apart, apart).argmin(axis=1)
    return np.maximum(1 + pen * (widths[at] / mean - 1), 0.05)


def _with_pen(options: dict[str, Any], sketch: Sketch, pen: float) -> dict[str, Any]:
    factors = shares(sketch, pen)
    if factors is None:
        return options
    options = dict(options)
    depth = options.pop("depth", 1.0)
    for side in ("front", "back"):
        options[side] = factors * options.get(side, depth)
    return options


def digest(sketch: Sketch, *options: Any) -> str:
    """Fingerprint of a stroke in the world, its holes, and options."""
    hashed = hashlib.blake2b(digest_size=16)
    for one in (sketch, *sketch.holes):
        hashed.update(np.ascontiguousarray(one.stroke.points, float).tobytes() + bytes([one.stroke.cyclic]))
        if one.stroke.widths is not None:
            hashed.update(np.ascontiguousarray(one.stroke.widths, float).tobytes())
    hashed.update(repr(options).encode())
    return hashed.hexdigest()
