# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges at which a body has a crease along its silhouette, so that smooth shading stops there.

numpy only, no bpy. Creases elsewhere (the ridge of a peak, the fold above a re-entrant corner) run across the grid:
marked, they would be saw teeth, and in thin limbs the coarse mesh itself would be taken for creases. Smooth shading
shows both better.
"""

from __future__ import annotations

import numpy as np

CONTRAST = 2.0
"""A crease turns by so many times what the edges beside it do: elsewhere the mesh is merely coarse."""


def rim_creases(
    vertices: np.ndarray,
    triangles: np.ndarray,
    silhouette: list[np.ndarray],
    edges: np.ndarray,
    triangle_edges: np.ndarray,
    angle: float,
) -> np.ndarray:
    """Find the edges (m,) bool of the silhouette where front and back meet at more than `angle`.

    silhouette : loops of vertex indices. edges : (m, 2) vertex indices. triangle_edges : (t, 3) edge indices of
    each triangle's sides. Edges that no other crease continues are left out: they would change no shading.
    """
    turns = face_angles(vertices, triangles, len(edges), triangle_edges)
    after = np.full(len(vertices), -1)
    for loop in silhouette:
        after[loop] = np.roll(loop, -1)
    a, b = edges.T
    rim = (after[a] == b) | (after[b] == a)
    sides = triangle_edges.ravel()
    order = np.argsort(sides, kind="stable")
    first = np.searchsorted(sides[order], np.arange(len(edges)))
    sharp = rim & (turns > angle)
    for edge in np.flatnonzero(sharp):
        beside = triangle_edges[order[first[edge] : first[edge] + 2] // 3].ravel()
        # The second lowest of four: where a crease turns off, one or two of them belong to it.
        sharp[edge] = turns[edge] > CONTRAST * np.sort(turns[beside[beside != edge]])[1]
    ends = np.bincount(edges[sharp].ravel(), minlength=len(vertices))
    return sharp & (ends[edges] > 1).any(axis=1)


def face_angles(
    vertices: np.ndarray, triangles: np.ndarray, n_edges: int, triangle_edges: np.ndarray
) -> np.ndarray:
    """Angle (m,) in radians between the normals of the two triangles at each edge; 0 where there are not two."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]
    sides = triangle_edges.ravel()
    order = np.argsort(sides, kind="stable")
    counts = np.bincount(sides, minlength=n_edges)
    first = np.concatenate([[0], np.cumsum(counts)])[:-1]
    pairs = np.flatnonzero(counts == 2)
    faces = order // 3
    cosines = np.einsum("ij,ij->i", normals[faces[first[pairs]]], normals[faces[first[pairs] + 1]])
    turns = np.zeros(n_edges)
    turns[pairs] = np.arccos(np.clip(cosines, -1, 1))
    return turns
