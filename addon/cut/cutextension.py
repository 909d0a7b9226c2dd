# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a model's vertices, carried on over the cut and the caps. numpy only, no bpy."""

from __future__ import annotations

import numpy as np

from .. import api
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
        in_cap[part.cap_triangles] = True
        in_cap[[index for face in part.faces for index in face]] = False
        self.inside = np.flatnonzero(in_cap[n_old:])
        """New vertices inside caps."""
        rim = np.setdiff1d(part.cap_triangles, self.inside + n_old)
        self.rim_old = rim[rim < n_old]
        """Old vertices on the rims of caps, numbered as in the part."""
        self._caps, self._places = part.cap_triangles, np.vstack([old_places, part.places])

    def __call__(self, needed: np.ndarray, rim_old: np.ndarray) -> np.ndarray:
        """Carry on values (len(needed), c) and those at the rim's old vertices (len(rim_old), c): (j, c)."""
        values = (needed[self._at] * self._weights[..., None]).sum(axis=1)
        return self.of_new(values, rim_old)

    def of_new(self, values: np.ndarray, rim_old: np.ndarray) -> np.ndarray:
        """Carry on values (j, c) that are known at the new vertices that are not inside a cap."""
        if not len(self.inside):
            return values
        n_old = len(self._places) - len(values)
        everywhere = np.zeros((len(self._places), values.shape[1]))
        everywhere[self.rim_old] = rim_old
        everywhere[n_old:] = values
        gridmesh = api.native("harmonic")
        return gridmesh.harmonic(self._places, self._caps, self.inside + n_old, everywhere)[n_old:]


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
