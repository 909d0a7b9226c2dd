# SPDX-License-Identifier: GPL-3.0-or-later
"""What a mesh carries besides its shape, carried on into a patch: UVs, colours, weights, numbers.

numpy only. Layers come from a BMesh, but bpy is not imported. Data of vertices is extended from the loop as it is;
data of face corners as it is on the neighbours of the loop, so that a UV map goes on where it ends. Values inside a
patch are harmonic, so never outside the range of those around it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

SAME = 1e-5
"""Corner data that differs by less, relative to its range, is not torn."""

LEAST_WEIGHT = 1e-6
"""Smaller weights are not worth a place in a vertex group."""

Extend = Callable[[np.ndarray], np.ndarray]

_FLOATS = ("float", "float_vector", "float_color", "color")
_CORNERS = ("uv", *_FLOATS)
_PLAIN = ("int", "bool", "string")

# Layers that describe the old geometry: a crease or a bevel is not to be smeared over a patch.
_OF_GEOMETRY = ("crease", "bevel_weight", "custom_normal")


class Surroundings:
    """Data at the loops of a patch, read before the patch is there."""

    def __init__(self, bm: Any, *loops: Sequence[Any]) -> None:
        """Read it.

        bm : BMesh. loops : BMVerts in order, of each loop of a patch.
        """
        self.loop = loop = [vertex for loop in loops for vertex in loop]
        neighbours = [[_neighbour(a, b) for a, b in _edges(loop)] for loop in loops]
        self.faces = [corners[0].face for part in neighbours for corners in part if corners is not None]
        """The face at each edge of the loops that has one."""
        parts: list[Any] = [_Vertices(layer, loop) for layer in layers_of(bm.verts.layers, _FLOATS)]
        deform = bm.verts.layers.deform.active
        if deform is not None:
            parts += [_Weights(deform, group, loop) for group in groups_of(loop, deform)]
        arcs = [np.array([(a.co - b.co).length for a, b in _edges(loop)]) for loop in loops]
        corners = [_Corners(layer, neighbours, arcs) for layer in layers_of(bm.loops.layers, _CORNERS)]
        parts += [part for part in corners if part.values is not None]
        self._parts = [part for part in parts if np.isfinite(part.values).all()]
        self._common = [
            (layer, loop[0][layer])
            for layer in layers_of(bm.verts.layers, _PLAIN)
            if not layer.name.startswith(".") and all(vertex[layer] == loop[0][layer] for vertex in loop)
        ]
        self.torn = sum(part.torn for part in corners)
        """Layers of corner data that do not agree along the loop: the patch continues the longest stretch."""
        self.broken = len(parts) - len(self._parts)
        """Layers left out, since a value at the loop is not a finite number."""

    def write(self, new: Sequence[Any], faces: Sequence[Any], extend: Extend) -> None:
        """Give it to the patch's new BMVerts and BMFaces.

        extend : from values at the loop's vertices (k, c) to values at the new ones (j, c).
        """
        for layer, value in self._common:  # numbers and names have no middle
            for vertex in new:
                vertex[layer] = value
        if not self._parts:
            return
        columns = np.concatenate([part.values for part in self._parts], axis=1)
        inside = extend(columns) if len(new) else np.zeros((0, columns.shape[1]))
        # What rounding adds must not leave the range either.
        inside = np.clip(inside, columns.min(axis=0), columns.max(axis=0))
        at = 0
        for part in self._parts:
            width = part.values.shape[1]
            part.write(self.loop, new, faces, inside[:, at : at + width])
            at += width


def model_face(faces: Sequence[Any]) -> Any:
    """Return a face with the material and smoothness of most; None of none."""
    if not faces:
        return None
    material = Counter(face.material_index for face in faces).most_common(1)[0][0]
    smooth = Counter(face.smooth for face in faces).most_common(1)[0][0]
    same = [face for face in faces if face.material_index == material]
    return next((face for face in same if face.smooth == smooth), same[0])


def new_face_set(bm: Any) -> tuple[Any, int] | None:
    """Layer of sculpting's face sets and a number that none has yet; None if the mesh has none."""
    layer = bm.faces.layers.int.get(".sculpt_face_set")
    return None if layer is None else (layer, max((face[layer] for face in bm.faces), default=0) + 1)


def settle(before: np.ndarray, after: np.ndarray, arc: np.ndarray) -> tuple[np.ndarray | None, bool]:
    """Find one value for each vertex of a loop where its two edges may have different ones.

    before, after : (k, c) values at each vertex on the edge before it and the one after it, NaN where an edge has
    no face. arc : (k,) length of the edge after each vertex. The longest stretch of edges that agree is kept; over
    the rest the values run straight from its end to its beginning. Returns them, None if no edge has any, and
    whether there was a rest.
    """
    known = np.isfinite(after).all(axis=1) & np.isfinite(np.roll(before, -1, axis=0)).all(axis=1)
    if not known.any():
        return None, False
    n = len(after)
    scale = np.nanmax(np.abs(after)) + 1e-30
    with np.errstate(invalid="ignore"):
        joint = np.abs(before - after).max(axis=1) <= SAME * scale
    goes_on = known & np.roll(known, 1) & joint  # the edge before the vertex and the one after it agree
    if goes_on.all():
        return after.copy(), False
    starts = np.flatnonzero(known & ~goes_on)
    runs = []
    for start in starts:
        length = 1
        while length < n and goes_on[(start + length) % n]:
            length += 1
        runs.append((float(arc[(start + np.arange(length)) % n].sum()), -int(start), length))
    _, start, length = max(runs)
    start = -start
    values = np.empty_like(after)
    kept = (start + np.arange(length)) % n
    values[kept] = after[kept]
    end = (start + length) % n
    last = before[end]
    if length == n:  # torn at one vertex alone
        return values, True
    rest = (end + np.arange(n - length)) % n
    way = np.concatenate([[0.0], np.cumsum(arc[rest])])
    share = (way[:-1] / max(way[-1], 1e-300))[:, None]
    values[rest] = (1 - share) * last + share * after[start]
    return values, True


class _Vertices:
    """A layer of floats, vectors or colours of vertices."""

    def __init__(self, layer: Any, loop: Sequence[Any]) -> None:
        self.layer = layer
        self.scalar = isinstance(loop[0][layer], float)
        self.values = np.array([np.atleast_1d(vertex[layer]) for vertex in loop], float)

    def write(self, _loop: Any, new: Sequence[Any], _faces: Any, inside: np.ndarray) -> None:
        for vertex, value in zip(new, inside.tolist(), strict=True):
            vertex[self.layer] = value[0] if self.scalar else value


class _Weights:
    """One vertex group. Vertices that are not in it count as 0."""

    def __init__(self, layer: Any, group: int, loop: Sequence[Any]) -> None:
        self.layer, self.group = layer, group
        self.values = np.array([[vertex[layer].get(group, 0.0)] for vertex in loop], float)
        self.everywhere = all(group in vertex[layer] for vertex in loop)

    def write(self, _loop: Any, new: Sequence[Any], _faces: Any, inside: np.ndarray) -> None:
        for vertex, (weight,) in zip(new, inside.tolist(), strict=True):
            if self.everywhere or weight > LEAST_WEIGHT:
                vertex[self.layer][self.group] = weight


class _Corners:
    """A layer of floats, vectors or colours of face corners, UV maps among them."""

    def __init__(self, layer: Any, loops: Sequence[Sequence[Any]], arcs: Sequence[np.ndarray]) -> None:
        self.layer = layer
        known = next((corners for loop in loops for corners in loop if corners is not None), None)
        self.values, self.torn = None, False
        if known is None:
            return
        self.is_uv = hasattr(known[0][layer], "uv")
        self.scalar = isinstance(known[0][layer], float)
        width = len(self._read(known[0]))
        found = [self._settled(loop, arc, width) for loop, arc in zip(loops, arcs, strict=True)]
        self.torn = any(torn for _, torn in found)
        # A loop of wires has what the others have in the mean.
        mean = np.concatenate([values for values, _ in found if values is not None]).mean(axis=0)
        self.values = np.concatenate(
            [
                np.broadcast_to(mean, (len(arc), width)) if values is None else values
                for (values, _), arc in zip(found, arcs, strict=True)
            ]
        )

    def _settled(
        self, neighbours: Sequence[Any], arc: np.ndarray, width: int
    ) -> tuple[np.ndarray | None, bool]:
        after = np.full((len(neighbours), width), np.nan)
        before = after.copy()
        for at, corners in enumerate(neighbours):
            if corners is not None:
                after[at] = self._read(corners[0])
                before[(at + 1) % len(neighbours)] = self._read(corners[1])
        return settle(before, after, arc)

    def _read(self, corner: Any) -> np.ndarray:
        value = corner[self.layer]
        return np.atleast_1d(value.uv if self.is_uv else value)

    def write(self, loop: Sequence[Any], new: Sequence[Any], faces: Any, inside: np.ndarray) -> None:
        value = dict(zip(loop, self.values.tolist(), strict=True))
        value.update(zip(new, inside.tolist(), strict=True))
        for face in faces:
            for corner in face.loops:
                if self.is_uv:
                    corner[self.layer].uv = value[corner.vert]
                else:
                    at = value[corner.vert]
                    corner[self.layer] = at[0] if self.scalar else at


def layers_of(access: Any, kinds: Sequence[str]) -> Iterator[Any]:
    """Layers of these kinds, one after the other."""
    for kind in kinds:
        for layer in getattr(access, kind).values():
            if not layer.name.startswith(_OF_GEOMETRY):
                yield layer


def groups_of(loop: Sequence[Any], layer: Any) -> list[int]:
    """Vertex groups that any of these vertices is in, ascending."""
    return sorted({group for vertex in loop for group in vertex[layer].keys()})  # noqa: SIM118


def _edges(loop: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    return zip(loop, [*loop[1:], loop[0]], strict=True)


def _neighbour(a: Any, b: Any) -> tuple[Any, Any] | None:
    """Return the corners at two neighbours on the loop of the face between them; None if there is none."""
    for edge in a.link_edges:
        if edge.other_vert(a) == b and edge.link_loops:
            corner = edge.link_loops[0]
            onward = corner.link_loop_next
            return (corner, onward) if corner.vert == a else (onward, corner)
    return None
