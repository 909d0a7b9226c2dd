# SPDX-License-Identifier: GPL-3.0-or-later
"""What an area of a mesh carries besides its shape, carried over to the patch on the same surface.

numpy only. Layers come from a BMesh, but bpy is not imported. Each new vertex lies on an old triangle and gets what is
there. Corner data that is torn inside the area, as a UV map at a seam, is one island on each side: a new face takes
the island that most of its corners lie in, and no value across the tear.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..data.attributes import LEAST_WEIGHT, SAME, layers_of

_FLOATS = ("float", "float_vector", "float_color", "color")
_CORNERS = ("uv", *_FLOATS)
_PLAIN = ("int", "bool", "string")


@dataclass(frozen=True, eq=False)
class Places:
    """Where the corners of a patch lie on the area that it replaces."""

    positions: np.ndarray
    """(n, 3) of the old mesh."""
    triangles: np.ndarray
    """(t, 3) of the area, into the old mesh."""
    polygons: np.ndarray
    """(t,) the face that each is a part of."""
    sources: np.ndarray
    """(j,) the triangle of the area on which each new vertex lies."""
    weights: np.ndarray
    """(j, 3) of that triangle's corners."""
    points: np.ndarray
    """(j, 3) of the new vertices."""
    faces: list[list[int]]
    """Those of the patch: the n old vertices come first."""

    def at_vertices(self, values: np.ndarray) -> np.ndarray:
        """Values (j, c) at the new vertices from those at the old ones (n, c)."""
        return np.einsum("jk,jkc->jc", self.weights, values[self.triangles[self.sources]])


class Carried:
    """Data of an area, read before the area goes."""

    def __init__(self, bm: Any, places: Places) -> None:
        self._places = places
        self._verts = {int(v): bm.verts[v] for v in np.unique(places.triangles)}
        self._bm = bm
        self._vertices = [_of_vertices(layer, self._verts) for layer in layers_of(bm.verts.layers, _FLOATS)]
        self._plain = [
            (layer, {v: vertex[layer] for v, vertex in self._verts.items()})
            for layer in layers_of(bm.verts.layers, _PLAIN)
            if not layer.name.startswith(".")
        ]
        deform = bm.verts.layers.deform.active
        self._deform = deform
        self._groups = (
            {v: dict(vertex[deform].items()) for v, vertex in self._verts.items()} if deform else {}
        )
        polygons = {int(p): bm.faces[p] for p in np.unique(places.polygons)}
        loops = {(p, corner.vert.index): corner for p, face in polygons.items() for corner in face.loops}
        corners = [
            [loops[int(p), int(v)] for v in triangle]
            for p, triangle in zip(places.polygons, places.triangles, strict=True)
        ]
        self._corners = [_Corners(layer, corners, places) for layer in layers_of(bm.loops.layers, _CORNERS)]
        self._faces = {p: _of_face(bm, face) for p, face in polygons.items()}

    def write(self, new: list[Any], faces: list[Any]) -> None:
        """Give it to the new BMVerts (j) and BMFaces (f)."""
        places = self._places
        for layer, scalar, values in self._vertices:
            table = np.zeros((len(places.positions), len(next(iter(values.values())))))
            table[list(values)] = list(values.values())
            for vertex, value in zip(new, places.at_vertices(table).tolist(), strict=True):
                vertex[layer] = value[0] if scalar else value
        nearest = places.triangles[places.sources, places.weights.argmax(axis=1)] if len(new) else []
        for layer, values in self._plain:
            for vertex, v in zip(new, nearest, strict=True):
                vertex[layer] = values[int(v)]
        if self._deform is not None:
            self._write_groups(new)
        for part in self._corners:
            part.write(faces)
        for face, polygon in zip(faces, self.polygons_of(), strict=True):
            values, face.material_index, face.smooth = self._faces[polygon]
            for layer, value in values:
                face[layer] = value

    def polygons_of(self) -> list[int]:
        """The old face that most corners of each new one lie on."""
        places = self._places
        n = len(places.positions)
        around: dict[int, list[int]] = {}
        for polygon, triangle in zip(places.polygons.tolist(), places.triangles.tolist(), strict=True):
            for v in triangle:
                around.setdefault(v, []).append(polygon)
        found = []
        for face in places.faces:
            seen = [int(places.polygons[places.sources[v - n]]) for v in face if v >= n]
            if not seen:
                seen = [polygon for v in face for polygon in dict.fromkeys(around[v])]
            found.append(Counter(seen).most_common(1)[0][0])
        return found

    def _write_groups(self, new: list[Any]) -> None:
        places = self._places
        for vertex, source, weights in zip(new, places.sources, places.weights, strict=True):
            ends = [self._groups[int(v)] for v in places.triangles[source]]
            for group in sorted({group for end in ends for group in end}):
                value = sum(w * end.get(group, 0.0) for w, end in zip(weights.tolist(), ends, strict=True))
                if value > LEAST_WEIGHT or all(group in end for end in ends):
                    vertex[self._deform][group] = min(max(value, 0.0), 1.0)


def _of_vertices(layer: Any, verts: dict[int, Any]) -> tuple[Any, bool, dict[int, np.ndarray]]:
    values = {v: vertex[layer] for v, vertex in verts.items()}
    scalar = isinstance(next(iter(values.values())), float)
    return layer, scalar, {v: np.atleast_1d(np.asarray(value, float)) for v, value in values.items()}


def _of_face(bm: Any, face: Any) -> tuple[list[tuple[Any, Any]], int, bool]:
    layers = layers_of(bm.faces.layers, (*_FLOATS, *_PLAIN))
    return [(layer, _copied(face[layer])) for layer in layers], face.material_index, face.smooth


def _copied(value: Any) -> Any:
    return value.copy() if hasattr(value, "copy") else value


class _Corners:
    """A layer of UVs, floats, vectors or colours of face corners."""

    def __init__(self, layer: Any, corners: list[list[Any]], places: Places) -> None:
        self.layer, self.places = layer, places
        first = corners[0][0][layer]
        self.is_uv, self.scalar = hasattr(first, "uv"), isinstance(first, float)
        read = (lambda corner: corner[layer].uv) if self.is_uv else (lambda corner: corner[layer])
        self.values = np.array(
            [[np.atleast_1d(read(corner)) for corner in three] for three in corners], float
        )
        self.island = _islands(places.triangles, self.values)

    def write(self, faces: list[Any]) -> None:
        for face, values in zip(faces, self.inside(), strict=True):
            for corner, value in zip(face.loops, values, strict=True):
                if self.is_uv:
                    corner[self.layer].uv = value
                else:
                    corner[self.layer] = value[0] if self.scalar else value

    def inside(self) -> list[list[list[float]]]:
        """Values at the corners of the new faces."""
        places, n = self.places, len(self.places.positions)
        own = np.einsum("jk,jkc->jc", places.weights, self.values[places.sources])
        around: dict[int, dict[int, np.ndarray]] = {}
        for t, triangle in enumerate(places.triangles.tolist()):
            for k, v in enumerate(triangle):
                around.setdefault(v, {}).setdefault(int(self.island[t]), self.values[t, k])
        found = []
        for face in places.faces:
            seen = [int(self.island[places.sources[v - n]]) for v in face if v >= n]
            if not seen:
                seen = [island for v in face for island in around[v]]
            island = Counter(seen).most_common(1)[0][0]
            values = []
            for v in face:
                if v < n and island in around[v]:
                    values.append(around[v][island])
                elif v >= n and self.island[places.sources[v - n]] == island:
                    values.append(own[v - n])
                else:
                    values.append(
                        self._nearest(island, places.positions[v] if v < n else places.points[v - n])
                    )
            found.append([value.tolist() for value in values])
        return found

    def _nearest(self, island: int, point: np.ndarray) -> np.ndarray:
        """Value of an island where it is nearest to a point beside it."""
        members = np.flatnonzero(self.island == island)
        corners = self.places.positions[self.places.triangles[members]]
        at, weights = nearest_on_edges(corners, point)
        return weights @ self.values[members[at]]


def nearest_on_edges(triangles: np.ndarray, point: np.ndarray) -> tuple[int, np.ndarray]:
    """Find the triangle (of (t, 3, 3)) with the edge nearest to a point, and the weights of its corners there."""
    begin, end = triangles, np.roll(triangles, -1, axis=1)
    along = end - begin
    length = np.maximum(np.einsum("tkx,tkx->tk", along, along), np.finfo(float).tiny)
    share = np.clip(np.einsum("tkx,tkx->tk", point - begin, along) / length, 0.0, 1.0)
    apart = np.linalg.norm(begin + share[..., None] * along - point, axis=2)
    t, k = np.unravel_index(int(apart.argmin()), apart.shape)
    weights = np.zeros(3)
    weights[k], weights[(k + 1) % 3] = 1 - share[t, k], share[t, k]
    return int(t), weights


def _islands(triangles: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Number (t,) of the island of each triangle: neighbours are in one where their values agree along the edge."""
    scale = SAME * (np.abs(values).max() + 1e-30)
    root = list(range(len(triangles)))

    def find(t: int) -> int:
        while root[t] != t:
            root[t] = root[root[t]]
            t = root[t]
        return t

    sides: dict[tuple[int, int], tuple[int, np.ndarray]] = {}
    for t, (triangle, three) in enumerate(zip(triangles.tolist(), values, strict=True)):
        for k in range(3):
            a, b = triangle[k], triangle[(k + 1) % 3]
            ends = three[[k, (k + 1) % 3]] if a < b else three[[(k + 1) % 3, k]]
            other = sides.setdefault((min(a, b), max(a, b)), (t, ends))
            if other[0] != t and np.abs(other[1] - ends).max() <= scale:
                root[find(t)] = find(other[0])
    return np.array([find(t) for t in range(len(triangles))])
