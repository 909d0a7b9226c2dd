# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh divided along a stroke: the call of `gridmesh.cut`, and what becomes of the mesh's own elements.

numpy only, no bpy. Points are float64 in the directions and lengths of the world.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import api
from ..text.messages import counted
from .cutsweep import CutError, Sweep

WEIGHT = 1e-9
"""Barycentric weights below this count as zero."""


@dataclass(frozen=True, eq=False)
class Model:
    """The mesh to be cut."""

    vertices: np.ndarray
    """(n, 3)."""
    corners: np.ndarray
    offsets: np.ndarray
    """(m + 1,): face f has the corners `corners[offsets[f]:offsets[f + 1]]`."""
    mirrors: Sequence[tuple[np.ndarray, np.ndarray]] = ()
    """Planes that the mesh is open at, since its mirror image goes on there: a point and a normal each."""
    mirror_distance: float = 0.0
    """Vertices no farther from such a plane lie on it."""

    def face(self, index: int) -> np.ndarray:
        """Vertices of a face."""
        return self.corners[self.offsets[index] : self.offsets[index + 1]]

    def edge_length(self) -> float:
        """Length for the edges of a cut that suits the mesh: its mean, but at least 20 across the whole."""
        if not len(self.corners):
            return 0.0
        is_used = np.zeros(len(self.vertices), bool)
        is_used[self.corners] = True
        used = self.vertices[is_used]
        ends = self.corners.copy()
        ends[:-1] = self.corners[1:]
        last = self.offsets[1:] - 1
        ends[last] = self.corners[self.offsets[:-1]]
        mean = np.linalg.norm(self.vertices[ends] - self.vertices[self.corners], axis=1).mean()
        return float(min(mean, np.linalg.norm(np.ptp(used, axis=0)) / 20))


@dataclass(frozen=True, eq=False)
class Part:
    """One piece, in terms of the model: what stays, what goes, what comes.

    Elements of the piece count the model's vertices that stay first, in the order of `old`, then new ones.
    """

    side: str
    old: np.ndarray
    """The model's vertices that the piece takes over."""
    kept: np.ndarray
    """The model's faces that stay as they are."""
    places: np.ndarray
    """(j, 3) new vertices."""
    sources: np.ndarray
    """(j, 3) the model's vertices of which each new one is a combination, for data."""
    weights: np.ndarray
    faces: list[list[int]]
    """New faces, caps aside."""
    source_face: list[int]
    """The model's face that each of them was a part of."""
    caps: list[list[int]]
    """Faces of the caps: triangles and quads."""
    cap_triangles: np.ndarray
    """(t, 3) the same, quads cut in two."""
    area: float
    """Area of the piece without caps."""

    @property
    def is_empty(self) -> bool:
        """Whether it has no faces."""
        return not (len(self.kept) or self.faces or self.caps)


@dataclass(frozen=True, eq=False)
class Division:
    """A divided model."""

    parts: list[Part]
    report: dict[str, Any]


def divide(
    model: Model,
    stroke: np.ndarray,
    sweep: Sweep,
    *,
    together: bool,
    progress: api.Progress | None = None,
    **options: Any,
) -> Division:
    """Cut the model.

    together : the parts stay in one mesh, so that no vertex of the model is in two of them.
    options : those of `gridmesh.cut`.

    Raises
    ------
    CutError
        If the cut is refused, with the library's message, or one side has no faces.
    api.CancelledError
        If `progress` or Ctrl-C asked to stop.
    """
    options |= {"mirrors": [list(plane) for plane in model.mirrors], "mirror_distance": model.mirror_distance}
    done = _call("cut", model, stroke, sweep, progress=progress, **options)
    taken = np.zeros(len(model.vertices), bool)
    parts = []
    # The larger part first: it keeps the vertices that both have.
    for piece in sorted(done.pieces, key=lambda piece: -_area(piece)):
        part = _part(model, piece, taken)
        parts.append(part)
        if together:
            taken[part.old] = True
    if any(part.is_empty for part in parts):
        raise CutError("a side of the stroke has nothing of the mesh; draw the stroke across it")
    return Division(parts, dict(done.report))


def reach(model: Model, stroke: np.ndarray, sweep: Sweep) -> np.ndarray:
    """Points (2, 3) up to which the ends of a stroke are continued where they are not extended to infinity.

    Raises
    ------
    CutError
        If the stroke does not cross the model.
    """
    return _call("cut_reach", model, stroke, sweep)


def _call(name: str, model: Model, stroke: np.ndarray, sweep: Sweep, **options: Any) -> Any:
    """Call a function of the library; its errors as ours."""
    gridmesh = api.native(name)
    how = {"direction": sweep.direction} if sweep.eye is None else {"eye": sweep.eye}
    faces = (model.corners.astype(np.int32), model.offsets.astype(np.int32))
    try:
        with api.cancelling(gridmesh):
            return getattr(gridmesh, name)(model.vertices, faces, stroke, **how, **options)
    except gridmesh.GridMeshError as error:
        raise CutError(str(error), error.kind) from error


def _area(piece: Any) -> float:
    """Area of a piece without its caps."""
    starts, ends = piece.offsets[:-1], piece.offsets[1:]
    of_model = piece.source_face >= 0
    return float(_areas(piece.vertices, piece.corners, starts[of_model], ends[of_model]).sum())


def _areas(vertices: np.ndarray, corners: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Area of each face, as a fan."""
    total = np.zeros((len(starts), 3))
    first = vertices[corners[starts]]
    for k in range(1, int((ends - starts).max(initial=2)) - 1):
        rows = np.flatnonzero(starts + k + 1 < ends)
        a, b = (vertices[corners[starts[rows] + at]] - first[rows] for at in (k, k + 1))
        total[rows] += np.cross(a, b)
    return np.linalg.norm(total, axis=1) / 2


def _part(model: Model, piece: Any, taken: np.ndarray) -> Part:
    """Tell the piece's new elements from those of the model."""
    vertices, corners, offsets = piece.vertices, piece.corners, piece.offsets
    source_vertices, source_weights = _settled(model, piece)
    first, sole = piece.source_vertices[:, 0], piece.source_weights[:, 0] == 1.0
    same = sole & (vertices == model.vertices[first]).all(axis=1)
    rising = np.concatenate([[True], first[1:] > first[:-1]])
    stop = np.flatnonzero(~(same & rising))
    n_old = int(stop[0]) if len(stop) else len(vertices)
    free = ~taken[first[:n_old]]

    number = np.empty(len(vertices), np.int64)
    is_old = np.zeros(len(vertices), bool)
    is_old[:n_old] = free
    number[is_old] = np.arange(np.count_nonzero(is_old))
    number[~is_old] = np.count_nonzero(is_old) + np.arange(np.count_nonzero(~is_old))
    in_model = np.where(is_old, first, -1)

    kept = _kept(model, in_model[corners], offsets, piece.source_face)
    is_cap = piece.source_face < 0
    made = np.flatnonzero(~kept & ~is_cap)
    named = number[corners].tolist()

    def rings(faces: np.ndarray) -> list[list[int]]:
        starts, ends = offsets[faces].tolist(), offsets[faces + 1].tolist()
        return [named[start:end] for start, end in zip(starts, ends, strict=True)]

    caps = rings(np.flatnonzero(is_cap))
    fans = [(cap[0], cap[k - 1], cap[k]) for cap in caps for k in range(2, len(cap))]
    return Part(
        side=piece.side,
        old=first[is_old].astype(np.int64),
        kept=piece.source_face[kept].astype(np.int64),
        places=vertices[~is_old],
        sources=source_vertices[~is_old],
        weights=source_weights[~is_old],
        faces=rings(made),
        source_face=piece.source_face[made].tolist(),
        caps=caps,
        cap_triangles=np.array(fans, np.int64).reshape(-1, 3),
        area=_area(piece),
    )


def _settled(model: Model, piece: Any) -> tuple[np.ndarray, np.ndarray]:
    """Sources and weights of the piece's vertices, for those on the surface with the nearest point of the model.

    Where the faces along a cut are rebuilt, vertices move along the surface after they got their sources.
    """
    sources, weights = piece.source_vertices.astype(np.int64), np.array(piece.source_weights)
    outside = np.zeros(len(sources), bool)
    of_model = np.repeat(piece.source_face >= 0, np.diff(piece.offsets))
    outside[piece.corners[of_model]] = True
    off = np.linalg.norm((model.vertices[sources] * weights[..., None]).sum(axis=1) - piece.vertices, axis=1)
    size = float(np.linalg.norm(np.ptp(model.vertices, axis=0)))
    moved = np.flatnonzero(outside & (off > 1e-9 * size))
    if not len(moved):
        return sources, weights
    # Faces around: those that the piece's faces there come from, and all that share a vertex with their sources.
    around: dict[int, set[int]] = {index: set() for index in moved.tolist()}
    owner = np.repeat(np.arange(len(piece.source_face)), np.diff(piece.offsets))
    for at in np.flatnonzero(np.isin(piece.corners, moved) & of_model).tolist():
        around[int(piece.corners[at])].add(int(piece.source_face[owner[at]]))
    needed = np.unique(sources[moved])
    faces_at: dict[int, list[int]] = {index: [] for index in needed.tolist()}
    face_of = np.repeat(np.arange(len(model.offsets) - 1), np.diff(model.offsets))
    for at in np.flatnonzero(np.isin(model.corners, needed)).tolist():
        faces_at[int(model.corners[at])].append(int(face_of[at]))
    for index in moved.tolist():
        faces = around[index].union(*(faces_at[source] for source in sources[index].tolist()))
        fans = [fan for face in sorted(faces) for fan in _fan(model.face(face))]
        triangles = np.array(fans, np.int64)
        nearest, share = nearest_point(model.vertices[triangles], piece.vertices[index])
        sources[index], weights[index] = triangles[nearest], share
    return sources, weights


def _fan(face: np.ndarray) -> list[tuple[int, int, int]]:
    return [(int(face[0]), int(face[k]), int(face[k + 1])) for k in range(1, len(face) - 1)]


def nearest_point(triangles: np.ndarray, point: np.ndarray) -> tuple[int, np.ndarray]:
    """Find the triangle (of (t, 3, 3)) that is nearest to the point, and the weights of its corners there."""
    a, b, c = triangles.transpose(1, 0, 2)
    u, v, w = b - a, c - a, point - a
    uu, uv, vv, uw, vw = (np.einsum("ij,ij->i", p, q) for p, q in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    area = uu * vv - uv * uv
    sound = np.maximum(area, 1e-300)
    s, t = (vv * uw - uv * vw) / sound, (uu * vw - uv * uw) / sound
    inside = (area > 1e-14 * uu * vv) & (s >= 0) & (t >= 0) & (s + t <= 1)
    shares = [np.where(inside[:, None], np.column_stack([1 - s - t, s, t]), np.nan)]
    for first, second in ((0, 1), (1, 2), (2, 0)):
        begin, along = triangles[:, first], triangles[:, second] - triangles[:, first]
        length = np.maximum((along**2).sum(axis=1), 1e-300)
        way = np.clip(((point - begin) * along).sum(axis=1) / length, 0.0, 1.0)
        share = np.zeros((len(triangles), 3))
        share[:, first], share[:, second] = 1 - way, way
        shares.append(share)
    every = np.concatenate(shares)
    places = np.einsum("ij,ijk->ik", every, np.concatenate([triangles] * 4))
    best = int(np.nanargmin(((places - point) ** 2).sum(axis=1)))
    return best % len(triangles), every[best]


def _kept(model: Model, corners: np.ndarray, offsets: np.ndarray, source: np.ndarray) -> np.ndarray:
    """Which faces have the very corners of their source."""
    sizes = np.diff(offsets)
    kept = (source >= 0) & (sizes == np.diff(model.offsets)[source])
    starts = model.offsets[:-1][source]
    place = np.arange(len(corners)) - np.repeat(offsets[:-1], sizes) + np.repeat(starts, sizes)
    place[~np.repeat(kept, sizes)] = 0
    differs = corners != model.corners[place]
    return kept & (np.add.reduceat(differs, offsets[:-1]) == 0)


def warnings_of(report: dict[str, Any], *, capped: bool) -> list[str]:
    """What the cut tells about itself that a user should look at."""
    warnings = []
    if capped and report["open_lines"]:
        n = report["open_lines"]
        lines = counted(n, "cut line")
        to_do = "close the mesh first (Grid Patch Fill), or delete that wall, to get one"
        warnings.append(
            f"{lines} ends at the border of the mesh, or at a wall inside it, and has no cap; {to_do}"
            if n == 1
            else f"{lines} end at the border of the mesh, or at a wall inside it, and have no cap; {to_do}"
        )
    if capped and report["uncapped"]:
        n = report["uncapped"]
        warnings.append(f"{counted(n, 'cut line')} left open, since nothing of the mesh lies inside")
    if report["reduced_caps"]:
        n = report["reduced_caps"]
        caps = counted(n, "cap")
        warnings.append(
            f"{caps} bulges less than the mesh around it, or lies flat; rounder, it would break through the mesh"
            if n == 1
            else f"{caps} bulge less than the mesh around them, or lie flat; rounder, they would break through the mesh"
        )
    if report["flat_caps"]:
        n = report["flat_caps"]
        caps = counted(n, "cap")
        warnings.append(
            f"{caps} lies flat, since it has holes, goes around a closed stroke or ends at a plane of symmetry; only others bulge"
            if n == 1
            else f"{caps} lie flat, since they have holes, go around a closed stroke or end at a plane of symmetry; only others bulge"
        )
    if report["folded"]:
        n = report["folded"]
        caps = counted(n, "cap")
        warnings.append(
            f"{caps} is folded, since the mesh cuts through itself there"
            if n == 1
            else f"{caps} are folded, since the mesh cuts through itself there"
        )
    return warnings
