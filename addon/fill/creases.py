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
    faces: np.ndarray,
    silhouette: list[np.ndarray],
    edges: np.ndarray,
    face_edges: np.ndarray,
    angle: float,
) -> np.ndarray:
    """Find the edges (m,) bool of the silhouette where front and back meet at more than `angle`.

    silhouette : loops of vertex indices. edges : (m, 2) vertex indices. face_edges : (f, k) edge indices of
    the sides of each of the faces (f, k). Edges that no other crease continues are left out: they would change no shading.
    """
    n_sides = faces.shape[1]
    turns = face_angles(vertices, faces, len(edges), face_edges)
    after = np.full(len(vertices), -1)
    for loop in silhouette:
        after[loop] = np.roll(loop, -1)
    a, b = edges.T
    rim = (after[a] == b) | (after[b] == a)
    sides = face_edges.ravel()
    order = np.argsort(sides, kind="stable")
    first = np.searchsorted(sides[order], np.arange(len(edges)))
    sharp = rim & (turns > angle)
    for edge in np.flatnonzero(sharp):
        corners = order[first[edge] : first[edge] + 2]
        if n_sides == 4:  # the opposite sides; the others turn as the outline does
            beside, least = face_edges[corners // 4, (corners + 2) % 4], 0
        else:  # where a crease turns off, one or two of four belong to it
            beside, least = face_edges[corners // 3].ravel(), 1
        sharp[edge] = turns[edge] > CONTRAST * np.sort(turns[beside[beside != edge]])[least]
    ends = np.bincount(edges[sharp].ravel(), minlength=len(vertices))
    return sharp & (ends[edges] > 1).any(axis=1)


def face_angles(vertices: np.ndarray, faces: np.ndarray, n_edges: int, face_edges: np.ndarray) -> np.ndarray:
    """Angle (m,) in radians between the normals of the two faces at each edge; 0 where there are not two.

    faces : (f, 3) triangles, or (f, 4) quads, whose normal is that of their diagonals.
    """
    corners = [vertices[faces[:, k]] for k in range(faces.shape[1])]
    if len(corners) == 4:
        normals = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    else:
        normals = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]
    sides = face_edges.ravel()
    order = np.argsort(sides, kind="stable")
    counts = np.bincount(sides, minlength=n_edges)
    first = np.concatenate([[0], np.cumsum(counts)])[:-1]
    pairs = np.flatnonzero(counts == 2)
    owner = order // faces.shape[1]
    cosines = np.einsum("ij,ij->i", normals[owner[first[pairs]]], normals[owner[first[pairs] + 1]])
    turns = np.zeros(n_edges)
    turns[pairs] = np.arccos(np.clip(cosines, -1, 1))
    return turns
