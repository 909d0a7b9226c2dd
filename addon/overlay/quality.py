# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of any mesh in numbers: irregular vertices, the least there can be, the sharpest angle.

numpy only, no bpy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Quality:
    """What `measure` found."""

    vertices: int
    """Vertices that a face uses."""
    faces: int
    irregular: np.ndarray
    """(k,) indices of the irregular vertices."""
    curvature: np.ndarray
    """(k,) of each, 1 - edges / 2 + the sum of 1 / corners over its faces: in a triangle mesh
    (6 - valence) / 6 inside and (4 - valence) / 6 on a border. All of a mesh add up to its Euler number."""
    border: np.ndarray
    """(k,) whether it lies on a border."""
    valence: np.ndarray
    """(k,) edges of each."""
    least: int | None
    """The fewest that lattice bodies or sheets of this topology have. Of triangles: 6, and 3 for every handle of a
    closed body and for every border but one of a sheet; of quads 8 for every contour of a body's drawing, and half as many
    of a sheet's. None where lattices have no say: mixed faces, edges of three faces, sheets with handles."""
    sides: int
    """Corners of all faces: 3 or 4; 0 where they are mixed or others."""
    worst_angle: float
    """The sharpest corner of a face, radians; 0 where a face has no area, nan where there is no face."""
    worst_face: int
    """The face that has it; -1 where there is none."""
    non_manifold: int
    """Edges of three or more faces, and vertices where fans of faces meet in a point only."""
    components: int
    borders: int
    genus: int | None
    """Handles of all components together; None where it is not manifold or one-sided."""

    @property
    def text(self) -> str:
        """The numbers in a line, for people."""
        irregular = len(self.irregular)
        if self.sides == 4:
            parts = [f"{self.faces} quads", "1 pole" if irregular == 1 else f"{irregular} poles"]
        else:
            parts = [
                f"{self.faces} faces",
                "1 irregular vertex" if irregular == 1 else f"{irregular} irregular vertices",
            ]
        if self.least is not None:
            parts[-1] = f"{parts[-1]} (least {self.least})"
        if self.worst_face >= 0:
            parts.append(f"sharpest angle {np.degrees(self.worst_angle):.1f}°")
        if self.non_manifold:
            parts.append(f"{self.non_manifold} non-manifold places")
        return ", ".join(parts)


def measure(vertices: np.ndarray, corners: np.ndarray, offsets: np.ndarray) -> Quality:
    """Measure a mesh of any polygons.

    vertices : (n, 3). corners : (c,) vertex indices, face by face. offsets : (f + 1,) where each face begins.
    A vertex is regular if six triangles, or four quadrilaterals, or another fitting mix of faces meet there; on
    a border three triangles, or two quadrilaterals. Loose vertices and edges do not count. O(c log c).
    """
    corners, offsets = np.asarray(corners, np.int64), np.asarray(offsets, np.int64)
    n, n_faces = len(vertices), len(offsets) - 1
    sizes = np.diff(offsets)
    sides = int(sizes[0]) if n_faces and sizes[0] in (3, 4) and (sizes == sizes[0]).all() else 0
    face = np.repeat(np.arange(n_faces), sizes)
    after, before = _beside(offsets, sizes, len(corners))
    a, b = corners, corners[after]
    low, high = np.minimum(a, b), np.maximum(a, b)
    keys, edge, uses = np.unique(low * max(n, 1) + high, return_inverse=True, return_counts=True)
    ends = np.stack([keys // max(n, 1), keys % max(n, 1)], axis=1)
    valence = np.bincount(ends.ravel(), minlength=n)
    used = valence > 0
    share = np.bincount(corners, weights=1 / np.maximum(sizes[face], 1), minlength=n)
    curvature = np.where(used, 1 - valence / 2 + share, 0.0)
    on_border = np.zeros(n, bool)
    on_border[ends[uses == 1]] = True
    irregular = np.flatnonzero(np.abs(curvature) > 1e-6)

    angles = _angles(np.asarray(vertices, float), corners, after, before)
    worst = int(angles.argmin()) if len(angles) else -1

    fans = _fans(corners, before, edge, n)
    pinched = np.count_nonzero(used & (fans > 1))
    crowded = int(np.count_nonzero(uses > 2))
    component = _roots(n, ends)
    topology = _topology(component, used, ends, uses, face, corners)
    simple = crowded + pinched == 0 and _orientable(edge, uses, a, face, n_faces)
    genus = least = None
    if simple and topology is not None:
        euler, borders = topology
        genus = int(((2 - borders - euler) // 2).sum())
        plain = bool(((borders == 0) | (2 - borders - euler == 0)).all())
        if plain and sides == 3:
            least = int(np.where(borders == 0, 6 + 3 * (2 - euler) // 2, 6 + 3 * (borders - 1)).sum())
        elif plain and sides == 4:
            least = int(np.where(borders == 0, 8 + 8 * (2 - euler) // 2, 4 * borders).sum())
    return Quality(
        vertices=int(used.sum()),
        faces=n_faces,
        irregular=irregular,
        curvature=curvature[irregular],
        border=on_border[irregular],
        valence=valence[irregular],
        least=least,
        sides=sides,
        worst_angle=float(angles[worst]) if worst >= 0 else float("nan"),
        worst_face=int(face[worst]) if worst >= 0 else -1,
        non_manifold=crowded + int(pinched),
        components=0 if topology is None else len(topology[0]),
        borders=0 if topology is None else int(topology[1].sum()),
        genus=genus,
    )


def _beside(offsets: np.ndarray, sizes: np.ndarray, n_corners: int) -> tuple[np.ndarray, np.ndarray]:
    """Index of the next and of the previous corner of the same face."""
    at = np.arange(n_corners)
    filled = sizes > 0
    first, last = offsets[:-1][filled], offsets[1:][filled] - 1
    after, before = at + 1, at - 1
    after[last], before[first] = first, last
    return after, before


def _angles(points: np.ndarray, corners: np.ndarray, after: np.ndarray, before: np.ndarray) -> np.ndarray:
    here = points[corners]
    u, v = points[corners[after]] - here, points[corners[before]] - here
    across = np.linalg.norm(np.cross(u, v), axis=1)
    return np.abs(np.arctan2(across, np.einsum("ij,ij->i", u, v)))


def _fans(corners: np.ndarray, before: np.ndarray, edge: np.ndarray, n: int) -> np.ndarray:
    """Number of fans of faces around each vertex; corners are of one fan if an edge joins them."""
    # Each corner has the edge to the next corner and that to the previous one, both at its own vertex.
    arms = np.concatenate([edge, edge[before]])
    who = np.tile(np.arange(len(corners)), 2)
    key = arms * max(n, 1) + np.tile(corners, 2)
    order = np.argsort(key, kind="stable")
    key, who = key[order], who[order]
    same = key[1:] == key[:-1]
    root = _roots(len(corners), np.stack([who[1:][same], who[:-1][same]], axis=1))
    heads = np.flatnonzero(root == np.arange(len(corners)))
    return np.bincount(corners[heads], minlength=n)


def _roots(n: int, links: np.ndarray) -> np.ndarray:
    """Smallest member (n,) of each one's component, by pointer jumping; links : (m, 2)."""
    root = np.arange(n)
    a, b = links[:, 0], links[:, 1]
    while len(a):
        ra, rb = root[a], root[b]
        apart = ra != rb
        if not apart.any():
            break
        a, b, ra, rb = a[apart], b[apart], ra[apart], rb[apart]
        np.minimum.at(root, np.maximum(ra, rb), np.minimum(ra, rb))
        while True:
            jumped = root[root]
            if (jumped == root).all():
                break
            root = jumped
    return root


def _topology(
    component: np.ndarray,
    used: np.ndarray,
    ends: np.ndarray,
    uses: np.ndarray,
    face: np.ndarray,
    corners: np.ndarray,
) -> tuple[np.ndarray, np.ndarray] | None:
    """Euler number and number of borders of every component; None without faces."""
    n_faces = int(face.max(initial=-1)) + 1
    if n_faces == 0:
        return None
    names, at = np.unique(component[used], return_inverse=True)
    index = np.full(len(component), -1)
    index[used] = at
    count = len(names)
    rim = ends[uses == 1]
    whole = _roots(len(component), rim)
    on_rim = np.unique(rim)
    heads = on_rim[whole[on_rim] == on_rim]
    first = np.full(n_faces, -1)
    first[face[::-1]] = corners[::-1]
    euler = (
        np.bincount(at, minlength=count)
        - np.bincount(index[ends[:, 0]], minlength=count)
        + np.bincount(index[first[first >= 0]], minlength=count)
    )
    return euler, np.bincount(index[heads], minlength=count)


def _orientable(
    edge: np.ndarray, uses: np.ndarray, start: np.ndarray, face: np.ndarray, n_faces: int
) -> bool:
    """Whether every component has two sides: its faces' double cover falls apart into two."""
    order = np.argsort(edge, kind="stable")
    first = np.concatenate([[0], np.cumsum(uses)])[:-1][uses == 2]
    one, two = order[first], order[first + 1]
    turned = (start[one] == start[two]).astype(
        np.int64
    )  # the same direction twice: one of them is to be flipped
    f, g = face[one], face[two]
    links = np.concatenate(
        [np.stack([f, g + turned * n_faces], 1), np.stack([f + n_faces, g + (1 - turned) * n_faces], 1)]
    )
    root = _roots(2 * n_faces, links)
    return bool((root[:n_faces] != root[n_faces:]).all())
