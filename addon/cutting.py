# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh divided along a stroke: the call of `gridmesh.cut`, and what becomes of the mesh's own elements.

numpy only, no bpy. Points are float64 in the directions and lengths of the world.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import api, outlines

WEIGHT = 1e-9
"""A vertex with less of another one is no combination with it."""


class CutError(ValueError):
    """A cut that cannot be made. The message says why and what to do."""


@dataclass(frozen=True, eq=False)
class Sweep:
    """How the stroke becomes a surface: along a direction, or through the eye of a perspective view."""

    direction: np.ndarray
    """(3,) unit vector away from the viewer; with an eye the middle of what it sees."""
    eye: np.ndarray | None = None

    @classmethod
    def along(cls, direction: Any) -> Sweep:
        """Sweep along a direction of any length but zero."""
        direction = np.asarray(direction, float)
        return cls(direction / np.linalg.norm(direction))

    def frame(self) -> np.ndarray:
        """Unit vectors (3, 3) in rows: right and up as the viewer sees them, and away from the viewer."""
        away = self.direction
        least = np.eye(3)[int(np.abs(away).argmin())]
        right = np.cross(least, away)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(right, away), away])

    def seen(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the viewer sees points (n, 3): (n, 2), and how far away (n,).

        Raises
        ------
        CutError
            If a point is behind the eye.
        """
        local = (points if self.eye is None else points - self.eye) @ self.frame().T
        if self.eye is None:
            return local[:, :2], local[:, 2]
        if (local[:, 2] <= 0).any():
            raise CutError(
                "the stroke reaches behind the view; move the view back, or set Direction to an axis"
            )
        return local[:, :2] / local[:, 2:], local[:, 2]

    def placed(self, flat: np.ndarray, depth: float) -> np.ndarray:
        """Points (n, 3) in space that are seen at (n, 2), all at one depth."""
        away = np.full((len(flat), 1), depth)
        if self.eye is None:
            return np.hstack([flat, away]) @ self.frame()
        return np.hstack([flat * depth, away]) @ self.frame() + self.eye


def normal_of(points: np.ndarray) -> np.ndarray:
    """Normal of the plane that a stroke (n, 3) was drawn in.

    Raises
    ------
    CutError
        If it is a straight line.
    """
    centred = points - points.mean(axis=0)
    _, widths, axes = np.linalg.svd(centred, full_matrices=False)
    if len(widths) < 2 or widths[1] <= 1e-4 * widths[0]:
        raise CutError(
            "a straight stroke lies in no plane of its own; set Direction to View or to the axis to cut along"
        )
    return axes[2]


def require_finite(points: np.ndarray) -> None:
    """Refuse a stroke (n, 3) with coordinates that are no numbers, or too large to work with."""
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise CutError(f"point {bad[0] + 1} of the stroke is not a finite number; delete it")
    if np.abs(points).max(initial=0.0) > outlines.LARGEST:
        raise CutError(f"the stroke reaches farther than {outlines.LARGEST:g}; scale it down")


def checked(points: np.ndarray, *, cyclic: bool, sweep: Sweep, close_gaps: float) -> np.ndarray:
    """Stroke (s, 3) for `gridmesh.cut`, closed by a repeated first point where it is meant to be.

    close_gaps : an open stroke whose ends are nearer than this part of its size is closed.

    Raises
    ------
    CutError
        If the stroke is no line.
    """
    flat, depth = sweep.seen(points)
    apart = np.linalg.norm(np.diff(flat, axis=0), axis=1)
    size = float(np.linalg.norm(np.ptp(flat, axis=0))) if len(flat) else 0.0
    if len(flat) < 2 or size <= 1e-9 * max(1.0, float(np.abs(flat).max())):
        raise CutError(
            "seen along the direction of the cut the stroke is a point; set Direction to another axis, "
            "or draw a longer stroke"
        )
    keep = np.concatenate([[True], apart > 1e-9 * size])
    flat, points = flat[keep], points[keep]
    if cyclic:
        return np.vstack([points, points[:1]])
    if close_gaps <= 0 or len(flat) < 4:
        return points
    try:
        closed, _ = outlines.close(flat, close_gaps)
    except outlines.OpenError:
        return points
    if len(closed) != len(flat):
        points = sweep.placed(closed, float(depth.mean()))
    return np.vstack([points, points[:1]])


@dataclass(frozen=True, eq=False)
class Model:
    """The mesh to be cut."""

    vertices: np.ndarray
    """(n, 3)."""
    corners: np.ndarray
    offsets: np.ndarray
    """(m + 1,): face f has the corners `corners[offsets[f]:offsets[f + 1]]`."""

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
    caps: np.ndarray
    """(t, 3) triangles of the caps."""
    area: float
    """Area of the piece without caps."""

    @property
    def is_empty(self) -> bool:
        """Whether it has no faces."""
        return not (len(self.kept) or self.faces or len(self.caps))


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
        If the cut is refused; the message is the library's.
    api.CancelledError
        If `progress` or Ctrl-C asked to stop.
    """
    gridmesh = api.native("cut")
    how = {"direction": sweep.direction} if sweep.eye is None else {"eye": sweep.eye}
    faces = (model.corners.astype(np.int32), model.offsets.astype(np.int32))
    try:
        done = gridmesh.cut(model.vertices, faces, stroke, progress=progress, **how, **options)
    except KeyboardInterrupt as error:
        raise api.CancelledError from error
    except gridmesh.GridMeshError as error:
        if error.kind == "cancelled":
            raise api.CancelledError from error
        raise CutError(str(error)) from error
    taken = np.zeros(len(model.vertices), bool)
    parts = []
    # The larger part first: it keeps the vertices that both have.
    for piece in sorted(done.pieces, key=lambda piece: -_area(piece)):
        part = _part(model, piece, taken)
        parts.append(part)
        if together:
            taken[part.old] = True
    return Division(parts, dict(done.report))


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
    renamed = number[corners]
    named, starts, ends = renamed.tolist(), offsets[made].tolist(), offsets[made + 1].tolist()
    return Part(
        side=piece.side,
        old=first[is_old].astype(np.int64),
        kept=piece.source_face[kept].astype(np.int64),
        places=vertices[~is_old],
        sources=source_vertices[~is_old],
        weights=source_weights[~is_old],
        faces=[named[start:end] for start, end in zip(starts, ends, strict=True)],
        source_face=piece.source_face[made].tolist(),
        caps=renamed[np.repeat(is_cap, np.diff(offsets))].reshape(-1, 3),
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


class Extension:
    """Values of the model's vertices, carried on to a part's new ones.

    Those on the cut are combined as the cut divides the edges; those inside a cap are harmonic, so that there is
    no step and nothing outside the range of what is around.
    """

    def __init__(self, part: Part, old_places: np.ndarray) -> None:
        """Prepare it.

        old_places : (o, 3) positions of the part's old vertices.
        """
        self.needed, at = np.unique(part.sources, return_inverse=True)
        """The model's vertices whose values are asked for."""
        self._at, self._weights = at.reshape(part.sources.shape), part.weights
        n_old, n_new = len(part.old), len(part.places)
        in_cap = np.zeros(n_old + n_new, bool)
        in_cap[part.caps] = True
        in_cap[[index for face in part.faces for index in face]] = False
        self.inside = np.flatnonzero(in_cap[n_old:])
        """New vertices inside caps."""
        self._cap = _Graph(n_old, n_new, self.inside, part.caps, np.vstack([old_places, part.places]))
        self.rim_old = self._cap.rim_old
        """Old vertices on the rims of caps, numbered as in the part."""

    def __call__(self, needed: np.ndarray, rim_old: np.ndarray) -> np.ndarray:
        """Carry on values (len(needed), c) and those at the rim's old vertices (len(rim_old), c): (j, c)."""
        values = (needed[self._at] * self._weights[..., None]).sum(axis=1)
        return self._cap.solve(values, rim_old)

    def of_new(self, values: np.ndarray, rim_old: np.ndarray) -> np.ndarray:
        """Carry on values (j, c) that are known at the new vertices that are not inside a cap."""
        return self._cap.solve(values, rim_old)


def edges_of(triangles: np.ndarray) -> np.ndarray:
    """All sides (3t, 2) of triangles, the smaller vertex first."""
    return np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)


def rims_of(triangles: np.ndarray) -> np.ndarray:
    """Edges (r, 2) with one triangle."""
    edges, times = _distinct(edges_of(triangles))
    return edges[times == 1]


def _distinct(pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distinct pairs, and how often each is there."""
    width = int(pairs.max(initial=0)) + 1
    keys, times = np.unique(pairs[:, 0].astype(np.int64) * width + pairs[:, 1], return_counts=True)
    return np.column_stack([keys // width, keys % width]), times


def connected(triangles: np.ndarray, n: int) -> np.ndarray:
    """For each of n vertices the least one that triangles connect it with."""
    least = np.arange(n)
    edges, _ = _distinct(edges_of(triangles))
    while True:
        before = least
        low = np.minimum(least[edges[:, 0]], least[edges[:, 1]])
        least = least.copy()
        np.minimum.at(least, edges[:, 0], low)
        np.minimum.at(least, edges[:, 1], low)
        least = least[least]
        if np.array_equal(least, before):
            return least


class _Graph:
    """Harmonic functions on caps. On a flat one what is linear at the rim is linear inside."""

    def __init__(
        self, n_old: int, n_new: int, inside: np.ndarray, triangles: np.ndarray, places: np.ndarray
    ) -> None:
        self.n_old, self.inside = n_old, inside
        unknown = np.full(n_old + n_new, -1)
        unknown[inside + n_old] = np.arange(len(inside))
        rows, ends, weights = [], [], []
        for k in range(3):
            a, b, opposite = (triangles[:, (k + step) % 3] for step in range(3))
            u, v = places[a] - places[opposite], places[b] - places[opposite]
            area = np.linalg.norm(np.cross(u, v), axis=1)
            cotangent = (u * v).sum(axis=1) / np.maximum(area, 1e-12 * ((u * u).sum(axis=1) + 1e-300))
            rows += [a, b]
            ends += [b, a]
            weights += [cotangent, cotangent]
        row, end, weight = np.concatenate(rows), np.concatenate(ends), np.concatenate(weights)
        inner = unknown[row] >= 0
        row, end, weight = unknown[row[inner]], end[inner], weight[inner]
        order = np.argsort(row, kind="stable")
        self.ends, self.weights = end[order], weight[order][:, None]
        self.starts = np.searchsorted(row[order], np.arange(len(inside)))
        self.degree = np.bincount(row, weight, minlength=len(inside))[:, None]
        self.unknown = unknown
        self.rim = np.setdiff1d(triangles, inside + n_old)
        self.rim_old = self.rim[self.rim < n_old]

    def solve(self, values: np.ndarray, rim_old: np.ndarray) -> np.ndarray:
        """Replace the values (j, c) of inner vertices; start from what they are."""
        if not len(self.inside):
            return values
        everywhere = np.zeros((self.n_old + len(values), values.shape[1]))
        everywhere[self.rim_old] = rim_old
        everywhere[self.n_old :] = values
        everywhere[self.inside + self.n_old] = 0.0
        known = np.add.reduceat(everywhere[self.ends] * self.weights, self.starts, axis=0)
        neighbour = self.unknown[self.ends]
        weights = np.where((neighbour >= 0)[:, None], self.weights, 0.0)

        def applied(x: np.ndarray) -> np.ndarray:
            return self.degree * x - np.add.reduceat(x[neighbour] * weights, self.starts, axis=0)

        found = _conjugate_gradients(applied, known, values[self.inside])
        # Where triangles are obtuse a harmonic function may leave the range of its rim by a little.
        rim = everywhere[self.rim]
        values = values.copy()
        values[self.inside] = np.clip(found, rim.min(axis=0), rim.max(axis=0))
        return values


def _conjugate_gradients(
    applied: Any, right: np.ndarray, x: np.ndarray, tolerance: float = 1e-7
) -> np.ndarray:
    """Solve a symmetric positive definite system for several right sides at once."""
    residual = right - applied(x)
    step = residual.copy()
    size = (residual**2).sum(axis=0)
    enough = tolerance**2 * np.maximum((right**2).sum(axis=0), 1e-300)
    for _ in range(2 * len(x) + 10):
        if (size <= enough).all():
            break
        along = applied(step)
        length = size / np.maximum((step * along).sum(axis=0), 1e-300)
        x = x + length * step
        residual = residual - length * along
        before, size = size, (residual**2).sum(axis=0)
        step = residual + size / np.maximum(before, 1e-300) * step
    return x


def unrolled(points: np.ndarray, stroke: np.ndarray, sweep: Sweep) -> np.ndarray:
    """Points (n, 3) near the swept surface, laid out with it in the plane: along the stroke, and away: (n, 2)."""
    flat, depth = sweep.seen(points)
    line, _ = sweep.seen(stroke)
    middle = flat.mean(axis=0)
    flat, line = flat - middle, line - middle
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    begin, step = line[:-1], np.diff(line, axis=0)
    # The ends go straight on.
    low, high = np.zeros(len(step)), np.ones(len(step))
    if not np.array_equal(stroke[0], stroke[-1]):
        low[0], high[-1] = -np.inf, np.inf
    squares = np.maximum((step**2).sum(axis=1), 1e-300)
    along = np.empty(len(flat))
    block = max(1, 500_000 // len(step))
    for at in range(0, len(flat), block):
        points_here = flat[at : at + block]
        ahead = points_here @ step.T - (begin * step).sum(axis=1)
        share = np.clip(ahead / squares, low, high)
        # Squared distances, less that of each point to the origin.
        away = (begin**2).sum(axis=1) - 2 * points_here @ begin.T - share * (2 * ahead - share * squares)
        nearest = away.argmin(axis=1)
        rows = np.arange(len(nearest))
        along[at : at + block] = way[nearest] + share[rows, nearest] * np.sqrt(squares[nearest])
    scale = 1.0 if sweep.eye is None else float(np.median(depth))
    return np.column_stack([along * scale, depth])
