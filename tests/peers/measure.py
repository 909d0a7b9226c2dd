"""What is measured of a mesh, without the code of any mesher."""

from __future__ import annotations

import numpy as np
from drawing import Drawing


def measure(vertices: np.ndarray, triangles: np.ndarray, drawing: Drawing, edge: float) -> dict[str, float]:
    """The numbers of one mesh; lengths in units of `edge`, angles in degrees."""
    used, flat = np.unique(triangles, return_inverse=True)
    vertices, triangles = vertices[used], flat.reshape(-1, 3)
    numbers, rim = connectivity(triangles)
    on_rim = np.zeros(len(vertices), bool)
    on_rim[rim] = True
    angle, ratio = shapes(vertices, triangles)
    spacing = edge / 16
    curve = segments(drawing.contours)
    boundary = vertices[rim]
    return {
        **numbers,
        "angle": angle,
        "ratio": ratio,
        "mesh_to_curve": distances(samples(boundary, spacing), curve).max() / edge,
        "curve_to_mesh": distances(samples(curve, spacing), boundary).max() / edge,
        "on_curve": 100 * (distances(vertices[on_rim], curve) < 1e-9 * drawing.size).mean(),
    }


def connectivity(triangles: np.ndarray) -> tuple[dict[str, float], np.ndarray]:
    """What depends on the triangles alone, every vertex used, and the edges of the boundary.

    The numbers are those of two copies glued along the boundary: an interior vertex is there twice, a
    boundary vertex of valence v becomes one of valence 2 v - 2.
    """
    edges, uses = edges_of(triangles)
    rim = edges[uses == 1]
    valence = np.bincount(edges.ravel())
    on_rim = np.zeros(len(valence), bool)
    on_rim[rim] = True
    count = on_rim.sum() + 2 * (~on_rim).sum()
    irregular = (valence[on_rim] != 4).sum() + 2 * (valence[~on_rim] != 6).sum()
    excess = np.abs(2 * valence[on_rim] - 8).sum() + 2 * np.abs(valence[~on_rim] - 6).sum()
    chords = (uses == 2) & on_rim[edges].all(axis=1)
    numbers = {
        "number": float(irregular),
        "irregular": 100 * irregular / count,
        "excess": 1000 * excess / count,
        "chords": float(chords.sum()),
    }
    return numbers, rim


def edges_of(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Undirected edges, (e, 2), and the number of triangles at each."""
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    return edges, uses


def shapes(vertices: np.ndarray, triangles: np.ndarray) -> tuple[float, float]:
    """The smallest angle, and the mean of twice the inner by the outer radius (1 where equilateral)."""
    corners = vertices[triangles]
    opposite = [np.hypot(*(corners[:, k - 1] - corners[:, k - 2]).T) for k in range(3)]
    a, b, c = np.sort(opposite, axis=0)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled_area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    angle = np.arctan2(2 * doubled_area, b * b + c * c - a * a)
    return float(np.degrees(angle.min())), float((4 * doubled_area**2 / ((a + b + c) * a * b * c)).mean())


def segments(contours: list[np.ndarray]) -> np.ndarray:
    """Sides of closed polygons, (n, 2, 2)."""
    return np.concatenate([np.stack([c, np.roll(c, -1, axis=0)], axis=1) for c in contours])


def samples(lines: np.ndarray, spacing: float) -> np.ndarray:
    """Points along segments, their starts among them, at most `spacing` apart."""
    length = np.hypot(*(lines[:, 1] - lines[:, 0]).T)
    pieces = np.maximum(np.ceil(length / spacing).astype(int), 1)
    line = np.repeat(np.arange(len(lines)), pieces)
    first = np.repeat(np.cumsum(pieces) - pieces, pieces)
    t = ((np.arange(len(line)) - first) / pieces[line])[:, None]
    return (1 - t) * lines[line, 0] + t * lines[line, 1]


def distances(points: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Distance of each point to the nearest segment."""
    start, step = lines[:, 0], lines[:, 1] - lines[:, 0]
    squared = np.maximum((step**2).sum(axis=1), 1e-300)
    nearest = np.empty(len(points))
    block = max(1, 2_000_000 // len(lines))
    for k in range(0, len(points), block):
        x = points[k : k + block, None, 0] - start[:, 0]
        y = points[k : k + block, None, 1] - start[:, 1]
        t = np.clip((x * step[:, 0] + y * step[:, 1]) / squared, 0, 1)
        x -= t * step[:, 0]
        y -= t * step[:, 1]
        nearest[k : k + block] = np.sqrt((x * x + y * y).min(axis=1))
    return nearest
