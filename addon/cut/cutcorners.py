# SPDX-License-Identifier: GPL-3.0-or-later
"""Data of face corners at a cut: UVs, colours and other values that may differ from face to face.

A corner whose vertex lies in the face that it was a part of takes the face's values there. Where the faces along a cut
were rebuilt, a corner may lie in a neighbour of its face: then it takes the neighbour's values where these continue
those of the face, and otherwise (beyond a seam) the face's, continued straight on.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .cutting import WEIGHT, Model, Part

_REACH = 0.5
"""A neighbour's UVs continue those of a face if they are off by no more than this part of their distance."""

Combination = list[tuple[int, float]]
"""Corners of the model, by number, with weights."""


class Corners:
    """The corners of the rebuilt faces of a part, each as a combination of the model's."""

    def __init__(self, verts: list[Any], faces: list[Any], part: Part, model: Model) -> None:
        """Find the combinations.

        verts, faces : BMVerts and BMFaces of the model, with their indices, before anything is taken out.
        """
        self._verts, self._faces, self._model = verts, faces, model
        self._loops: list[Any] = []
        self._of_face: dict[int, dict[int, int]] = {}
        self._around: dict[int, list[int]] = {}
        self._frames: dict[int, tuple[tuple[int, int, int], np.ndarray, np.ndarray]] = {}
        self._plain: list[tuple[int, int, float]] = []
        self._foreign: list[tuple[int, int, Combination, list[Combination]]] = []
        support: dict[int, Combination] = {}
        old, n_old = part.old.tolist(), len(part.old)
        places = np.vstack([model.vertices[part.old], part.places])
        vertex = []
        for face, source in zip(part.faces, part.source_face, strict=True):
            own = self._corners_of(source)
            for index in face:
                row = len(vertex)
                vertex.append(index)
                combination = support.get(index)
                if combination is None:
                    if index < n_old:
                        combination = [(old[index], 1.0)]
                    else:
                        new = index - n_old
                        combination = _merged(part.sources[new].tolist(), part.weights[new].tolist())
                    support[index] = combination
                if all(v in own for v, _ in combination):
                    self._plain += [(row, own[v], w) for v, w in combination]
                else:
                    straight = self._straight_on(source, places[index])
                    others = self._containing(combination)
                    self._foreign.append((row, source, straight, others))
        self.vertex = np.array(vertex, np.int64)
        """The part's vertex at each corner."""

    def interpolated(self, layer: Any, *, is_uv: bool) -> np.ndarray:
        """Values (corners, c) of a layer of floats."""
        values = self._read(layer, is_uv=is_uv)
        out = np.zeros((len(self.vertex), values.shape[1]))
        if self._plain:
            rows, corners, weights = (np.array(column) for column in zip(*self._plain, strict=True))
            np.add.at(out, rows, values[corners] * weights[:, None])
        for row, source, straight, others in self._foreign:
            out[row] = self._chosen(values, source, straight, others, is_uv=is_uv)
        return out

    def nearest(self, layer: Any) -> list[Any]:
        """Values of a layer that cannot be mixed: of the corner that counts most."""
        most: list[tuple[float, int]] = [(-1.0, 0)] * len(self.vertex)
        for row, corner, weight in self._plain:
            if weight > most[row][0]:
                most[row] = (weight, corner)
        for row, _, straight, others in self._foreign:
            corner, weight = max((others or [straight])[0], key=lambda one: one[1])
            most[row] = (weight, corner)
        return [self._loops[corner][layer] for _, corner in most]

    def _chosen(
        self,
        values: np.ndarray,
        source: int,
        straight: Combination,
        others: list[Combination],
        *,
        is_uv: bool,
    ) -> np.ndarray:
        expected = _combined(values, straight)
        if not others:
            return expected
        found = [_combined(values, other) for other in others]
        best = min(found, key=lambda value: float(((value - expected) ** 2).sum()))
        if not is_uv:
            return best
        own = values[list(self._corners_of(source).values())]
        middle = own.mean(axis=0)
        size = float(np.linalg.norm(own - middle, axis=1).max()) + float(np.linalg.norm(expected - middle))
        return best if np.linalg.norm(best - expected) <= _REACH * size else expected

    def _read(self, layer: Any, *, is_uv: bool) -> np.ndarray:
        if is_uv:
            return np.array([loop[layer].uv for loop in self._loops], float).reshape(-1, 2)
        rows = [np.atleast_1d(loop[layer]) for loop in self._loops]
        return np.array(rows, float) if rows else np.zeros((0, 1))

    def _corners_of(self, face: int) -> dict[int, int]:
        """Numbers of the face's corners, by vertex."""
        found = self._of_face.get(face)
        if found is None:
            found = {}
            for loop in self._faces[face].loops:
                found[loop.vert.index] = len(self._loops)
                self._loops.append(loop)
            self._of_face[face] = found
        return found

    def _containing(self, combination: Combination) -> list[Combination]:
        """Find the combination's corners in each face of the model that has all its vertices."""
        faces = self._faces_around(combination[0][0])
        for vertex, _ in combination[1:]:
            there = set(self._faces_around(vertex))
            faces = [face for face in faces if face in there]
        return [[(self._corners_of(face)[v], w) for v, w in combination] for face in faces]

    def _faces_around(self, vertex: int) -> list[int]:
        found = self._around.get(vertex)
        if found is None:
            found = [face.index for face in self._verts[vertex].link_faces if face.index >= 0]
            self._around[vertex] = found
        return found

    def _straight_on(self, face: int, place: np.ndarray) -> Combination:
        """Find the place as an affine combination of three corners of the face."""
        found = self._frames.get(face)
        if found is None:
            found = self._frames[face] = self._frame(face)
        (first, second, third), origin, across = found
        s, t = (across @ (place - origin)).tolist()
        return [(first, 1 - s - t), (second, s), (third, t)]

    def _frame(self, face: int) -> tuple[tuple[int, int, int], np.ndarray, np.ndarray]:
        """Three corners of a face, the place of the first, and the matrix to the others' shares."""
        corners = self._model.face(face)
        points = self._model.vertices[corners]
        rest = points[1:] - points[0]
        areas = np.linalg.norm(np.cross(rest[:-1], rest[1:]), axis=1)
        k = int(areas.argmax())
        own = self._corners_of(face)
        chosen = own[int(corners[0])], own[int(corners[k + 1])], own[int(corners[k + 2])]
        return chosen, points[0], np.linalg.pinv(rest[k : k + 2].T)


def _merged(sources: list[int], weights: list[float]) -> Combination:
    total: dict[int, float] = {}
    for source, weight in zip(sources, weights, strict=True):
        if weight > WEIGHT:
            total[source] = total.get(source, 0.0) + weight
    return list(total.items())


def _combined(values: np.ndarray, combination: Combination) -> np.ndarray:
    return sum((values[corner] * weight for corner, weight in combination), np.zeros(values.shape[1]))
