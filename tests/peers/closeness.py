"""How smooth a patch is where it meets a mesh, and how far two meshes are apart. numpy only."""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np


def unit(x):
    """Vectors of length one."""
    return x / np.maximum(np.linalg.norm(x, axis=-1, keepdims=True), 1e-300)


def normals(points, faces):
    """Unit normals of triangles."""
    corners = points[faces]
    return unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


def angles_across(points, one, two=None):
    """Root mean square angle, in degrees, across edges of triangles: all inner ones of `one`, or those that it
    shares with `two`. Winding does not matter where it disagrees."""
    faces = one if two is None else np.r_[one, two]
    normal = normals(points, faces)
    at = defaultdict(list)
    for k, face in enumerate(faces.tolist()):
        for i in range(3):
            a, b = face[i], face[(i + 1) % 3]
            at[min(a, b), max(a, b)].append((k, a < b))
    angles = []
    for sides in at.values():
        if len(sides) == 2 and (two is None or (sides[0][0] < len(one)) != (sides[1][0] < len(one))):
            (i, up), (j, down) = sides
            cosine = normal[i] @ normal[j] * (1 if up != down else -1)
            angles.append(math.degrees(math.acos(max(-1.0, min(1.0, cosine)))))
    return float(np.sqrt(np.mean(np.square(angles))))


def distances(points, corners):
    """From each point to the nearest of some triangles."""
    a, b, c = (corners[None, :, k] for k in range(3))
    normal = unit(np.cross(b - a, c - a))
    found = []
    for part in np.array_split(points[:, None], max(1, len(points) * len(corners) // 400_000)):
        height = ((part - a) * normal).sum(-1)
        within = np.ones(height.shape, bool)
        least = np.full(height.shape, np.inf)
        for u, w in ((a, b), (b, c), (c, a)):
            within &= (np.cross(w - u, part - u) * normal).sum(-1) >= 0
            along = ((part - u) * (w - u)).sum(-1) / np.maximum(((w - u) ** 2).sum(-1), 1e-300)
            foot = u + np.clip(along, 0, 1)[..., None] * (w - u)
            least = np.minimum(least, np.linalg.norm(part - foot, axis=-1))
        found.append(np.where(within, np.abs(height), least).min(1))
    return np.concatenate(found)


def samples(corners, count=500):
    """Points spread evenly over triangles, the same every time."""
    rng = np.random.default_rng(0)
    size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = corners[rng.choice(len(corners), count, p=size / size.sum())]
    r, s = np.sqrt(rng.random(count)), rng.random(count)
    return (np.stack([1 - r, r * (1 - s), r * s], axis=1)[..., None] * chosen).sum(1)
