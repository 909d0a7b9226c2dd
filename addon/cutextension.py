# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a model's vertices, carried on over the cut and the caps. numpy only, no bpy."""

from __future__ import annotations

from typing import Any

import numpy as np

from .cutting import Part


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
