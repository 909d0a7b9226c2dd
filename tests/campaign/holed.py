"""Surfaces of quads with holes that zigzag along them."""

from __future__ import annotations

import math

import numpy as np
from bridges import all_sides

TAU = 2 * np.pi


def ball(n=48, m=64):
    """A ball of quads without its poles: vertices, quads."""
    down, around = np.linspace(0.15, np.pi - 0.15, n), TAU * np.arange(m) / m
    t, p = np.repeat(down, m), np.tile(around, n)
    k = np.arange(m * (n - 1))
    right = k - k % m + (k + 1) % m
    return np.c_[np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], np.c_[k, k + m, right + m, right]


def wall(n=60, m=64):
    """A pipe of quads around the z axis, open at both ends."""
    vertices, quads = ball(n, m)
    around = vertices[:, :2] / np.linalg.norm(vertices[:, :2], axis=1)[:, None]
    return np.c_[around, 1.5 - 3 * np.repeat(np.arange(n), m) / (n - 1)], quads


def sheet(height, n=61):
    """Quads over a plane, `height(x, y)` above it."""
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-2, 2, n)] * 2, indexing="ij"))
    k = np.arange(n * n).reshape(n, n)[:-1, :-1].ravel()
    return np.c_[x, y, height(x, y)], np.c_[k, k + n, k + n + 1, k + 1]


def rims(triangles):
    """For each vertex at a border of triangles the next one along it."""
    there = {tuple(side) for side in all_sides(triangles).tolist()}
    return dict(side for side in there if side[::-1] not in there)


def followed(after, start):
    """The border that begins at a vertex."""
    loop = [start]
    while (v := after[loop[-1]]) != start:
        loop.append(v)
    return loop


def with_holes(vertices, quads, centres, radius):
    """Triangles around holes at the centres, the quad of each, and the loops of the holes; `radius` is one or one for each."""
    middles = vertices[quads].mean(axis=1)
    kept = quads[(np.linalg.norm(middles[:, None] - np.array(centres), axis=2) > radius).all(axis=1)]
    triangles = np.r_[kept[:, :3], kept[:, [0, 2, 3]]]
    after = rims(triangles)
    loops = [followed(after, min(after, key=lambda v: math.dist(vertices[v], centre))) for centre in centres]
    return triangles, np.tile(np.arange(len(kept)), 2), loops
