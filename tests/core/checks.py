"""What every patch and every body must satisfy, checked without the library's own code."""

from __future__ import annotations

import itertools
from fractions import Fraction

import gridmesh
import numpy as np


def half_edges(triangles: np.ndarray) -> np.ndarray:
    """Directed edges, (3 t, 2): for every triangle a-b, b-c, c-a."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def edges_of(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Undirected edges, (e, 2), and the number of triangles at each."""
    n = int(triangles.max()) + 1
    ends = np.sort(half_edges(triangles), axis=1).astype(np.int64)
    keys, counts = np.unique(ends[:, 0] * n + ends[:, 1], return_counts=True)
    return np.stack([keys // n, keys % n], axis=1), counts


def valences(triangles: np.ndarray, n_vertices: int) -> np.ndarray:
    """Number of edges at each vertex."""
    return np.bincount(edges_of(triangles)[0].ravel(), minlength=n_vertices)


def orientations(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Sign of every triangle's area, exact."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    u, v = b - a, c - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    signs = np.sign(area).astype(int)
    # Rounding errors of the differences and products are far below this.
    doubt = np.abs(area) <= 1e-12 * np.abs(points).max() * (np.abs(u).max(axis=1) + np.abs(v).max(axis=1))
    for k in np.flatnonzero(doubt):
        (ax, ay), (bx, by), (cx, cy) = ([Fraction(x) for x in points[i]] for i in triangles[k].tolist())
        exact = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        signs[k] = (exact > 0) - (exact < 0)
    return signs


def distance_to_curve(points: np.ndarray, curve: np.ndarray) -> np.ndarray:
    """Distance of each point to the closed polyline."""
    start, step = curve, np.roll(curve, -1, axis=0) - curve
    length = np.maximum((step**2).sum(axis=1), 1e-300)
    nearest = np.full(len(points), np.inf)
    for a, d, squared in zip(start, step, length, strict=True):
        t = np.clip(((points - a) @ d) / squared, 0, 1)
        nearest = np.minimum(nearest, np.hypot(*(points - a - t[:, None] * d).T))
    return nearest


def check_array(array: np.ndarray, dtype: type, columns: int | None) -> None:
    """C-contiguous, read-only, of the right type and shape."""
    assert array.dtype == dtype
    assert array.flags.c_contiguous
    assert not array.flags.writeable
    assert array.ndim == (1 if columns is None else 2)
    if columns is not None:
        assert array.shape[1] == columns


def check_fans(triangles: np.ndarray, n_vertices: int, n_boundary: int) -> None:
    """Around every vertex the triangles form one fan: open at boundary vertices, closed elsewhere."""
    # A triangle leads at each of its vertices from the one after it to the one before it.
    vertex, first = half_edges(triangles).T.astype(np.int64)
    second = np.concatenate([triangles[:, 2], triangles[:, 0], triangles[:, 1]])
    order = np.argsort(vertex * n_vertices + first)
    keys, vertex = (vertex * n_vertices + first)[order], vertex[order]
    assert (np.diff(keys) > 0).all(), "two triangles with the same directed edge"
    wanted = vertex * n_vertices + second[order]
    n = len(keys)
    place = np.minimum(np.searchsorted(keys, wanted), n - 1)
    # The number of the next triangle around the vertex, `n` behind the last one.
    following = np.append(np.where(keys[place] == wanted, place, n), n)
    starts = np.ones(n + 1, bool)
    starts[following] = False
    open_fans = np.bincount(vertex[starts[:n]], minlength=n_vertices)
    # Fans that close: the least number in each, found by steps that double.
    least = np.arange(n + 1)
    for _ in range(int(np.bincount(vertex).max()).bit_length()):
        least = np.minimum(least, least[following])
        following = following[following]
    closed = (following[:n] < n) & (least[:n] == np.arange(n))
    closed_fans = np.bincount(vertex[closed], minlength=n_vertices)
    at_boundary = np.arange(n_vertices) < n_boundary
    wrong = np.flatnonzero((open_fans != at_boundary) | (closed_fans != ~at_boundary))
    assert not len(wrong), f"vertices {wrong[:5]} are not in one fan"


def check_patch(patch, contours: list[np.ndarray]) -> None:
    """Everything that is promised for a patch of these contours (outline first, then holes)."""
    vertices, triangles = patch.vertices, patch.triangles
    check_array(vertices, np.float64, 2)
    check_array(triangles, np.int32, 3)
    check_array(patch.origin, np.float64, None)
    assert np.isfinite(vertices).all()
    assert np.array_equal(np.unique(triangles), np.arange(len(vertices))), "unused vertices"

    # Boundary vertices first, loop by loop, in order.
    n_boundary = sum(map(len, patch.loops))
    assert len(patch.loops) == len(contours)
    assert np.array_equal(np.concatenate(patch.loops), np.arange(n_boundary))

    # An oriented manifold whose boundary is exactly the loops, with the patch on their left.
    from_to = half_edges(triangles).astype(np.int64)
    keys, opposite = (ends[:, 0] * len(vertices) + ends[:, 1] for ends in (from_to, from_to[:, ::-1]))
    assert len(np.unique(keys)) == 3 * len(triangles), "an edge is used twice in one direction"
    edges, counts = edges_of(triangles)
    rim = np.setdiff1d(keys, opposite)
    drawn = np.concatenate(
        [loop.astype(np.int64) * len(vertices) + np.roll(loop, -1) for loop in patch.loops]
    )
    assert np.array_equal(rim, np.sort(drawn))
    check_fans(triangles, len(vertices), n_boundary)
    assert len(vertices) - len(edges) + len(triangles) == 2 - len(contours), "wrong topology"
    label = np.arange(len(vertices))
    while True:
        least = label.copy()
        np.minimum.at(least, edges[:, 0], label[edges[:, 1]])
        np.minimum.at(least, edges[:, 1], label[edges[:, 0]])
        least = least[least]
        if np.array_equal(least, label):
            break
        label = least
    assert not label.any(), "more than one piece"

    # No chord, six triangles at every interior vertex, turns that close.
    assert not ((counts == 2) & (edges < n_boundary).all(axis=1)).any(), "chord"
    valence = valences(triangles, len(vertices))
    assert (valence[n_boundary:] == 6).all()
    assert (4 - valence[:n_boundary]).sum() == 6 * (2 - len(contours))
    irregular = int((valence[:n_boundary] != 4).sum())
    assert patch.report["irregular"] == irregular
    assert irregular >= patch.report["minimum_irregular"] >= 6
    assert patch.report["triangles"] == len(triangles)

    # No inverted triangle, also in the precision that Blender stores.
    assert (orientations(vertices, triangles) == 1).all(), "inverted triangle"
    rounded = (vertices - patch.origin).astype(np.float32).astype(np.float64)
    assert (orientations(rounded, triangles) == 1).all(), "inverted triangle in float32"
    assert patch.report["min_angle"] > 0
    assert gridmesh.stitch(patch).report["embedded"], "the boundary crosses itself"

    check_loops(patch)
    for k, contour in enumerate(contours):
        check_contour(patch, k, contour)


def check_loops(patch) -> None:
    """The outline encloses the patch, holes none of it: their vertices run around them the other way."""
    for k, loop in enumerate(patch.loops):
        vertices = patch.vertices[loop].tolist()
        (ox, oy), *rest = [(Fraction(x), Fraction(y)) for x, y in vertices]
        area = sum(
            (ax - ox) * (by - oy) - (bx - ox) * (ay - oy) for (ax, ay), (bx, by) in itertools.pairwise(rest)
        )
        assert (area > 0) == (k == 0), "a loop is turned over"
        assert area != 0, "a loop encloses nothing"


def check_contour(patch, k: int, contour: np.ndarray) -> None:
    """Loop k lies on its contour, once around it, with the arc lengths and sources that it claims."""
    loop, arc, source, corner = patch.loops[k], patch.arc[k], patch.source[k], patch.corner[k]
    check_array(loop, np.int32, None)
    check_array(arc, np.float64, None)
    check_array(source, np.float64, 2)
    check_array(corner, np.float64, None)
    assert len(loop) == len(arc) == len(source) == len(corner)
    at = patch.vertices[loop]
    size = np.hypot(*np.ptp(contour, axis=0))
    # Coordinates far from the origin cannot be closer than their own rounding.
    tolerance = 1e-9 * size + 4 * np.spacing(np.abs(contour).max())
    assert distance_to_curve(at, contour).max() <= tolerance

    following = np.roll(contour, -1, axis=0)
    segment, parameter = source[:, 0].astype(int), source[:, 1]
    assert np.array_equal(segment, source[:, 0])
    assert segment.min() >= 0
    assert segment.max() < len(contour)
    assert parameter.min() >= 0
    assert parameter.max() <= 1
    claimed = contour[segment] + parameter[:, None] * (following - contour)[segment]
    assert np.hypot(*(claimed - at).T).max() <= tolerance

    lengths = np.hypot(*(following - contour).T)
    total = lengths.sum()
    along = np.concatenate([[0], np.cumsum(lengths)])[segment] + parameter * lengths[segment]
    doubled_area = (contour[:, 0] * following[:, 1] - contour[:, 1] * following[:, 0]).sum()
    runs_as_drawn = (doubled_area > 0) == (k == 0)
    expected = along if runs_as_drawn else total - along
    apart = np.abs(arc - expected)
    assert np.minimum(apart, np.abs(total - apart)).max() <= 1e-7 * total
    assert (np.diff(arc) <= 0).sum() + (arc[0] <= arc[-1]) <= 1, "arc lengths are not cyclically increasing"
    assert arc.min() >= 0
    assert arc.max() <= total * (1 + 1e-12)


def check_body(surface, patch) -> None:
    """Everything that is promised for a stitched or inflated body of this patch."""
    vertices, triangles = surface.vertices, surface.triangles
    check_array(vertices, np.float64, 3)
    check_array(triangles, np.int32, 3)
    check_array(surface.uv, np.float64, 2)
    assert np.isfinite(vertices).all()
    assert np.array_equal(np.unique(triangles), np.arange(len(vertices)))
    assert len(triangles) == 2 * len(patch.triangles)
    check_fans(triangles, len(vertices), 0)
    edges, counts = edges_of(triangles)
    assert (counts == 2).all()
    n_holes = len(patch.loops) - 1
    assert len(vertices) - len(edges) + len(triangles) == 2 - 2 * n_holes
    valence = valences(triangles, len(vertices))
    assert (valence != 6).sum() == patch.report["irregular"] == surface.report["irregular"]

    assert surface.report["watertight"] is True
    assert surface.report["genus"] == n_holes
    assert surface.report["triangles"] == len(triangles)
    assert len(surface.silhouette) == len(patch.loops)
    for on_body, on_patch in zip(surface.silhouette, patch.loops, strict=True):
        check_array(on_body, np.int32, None)
        at = vertices[on_body]
        assert at[:, :2].tobytes() == patch.vertices[on_patch].tobytes(), "the silhouette moved"
        assert not at[:, 2].any()

    assert surface.uv.shape == (3 * len(triangles), 2)
    assert surface.uv.min() >= 0
    assert surface.uv.max() <= 1
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    volume = (a * np.cross(b, c)).sum() / 6
    assert np.isclose(surface.report["volume"], volume, rtol=1e-6, atol=1e-9 * np.abs(vertices).max() ** 3)


def check_mirrored(surface, patch) -> None:
    """The back is the exact mirror image of the front, and the front nowhere below the plane."""
    n, n_boundary = len(patch.vertices), sum(map(len, patch.loops))
    front, back = surface.vertices[n_boundary:n], surface.vertices[n:]
    assert np.array_equal(front * [1, 1, -1], back)
    assert (front[:, 2] >= 0).all()


def sticking_out(body) -> float:
    """How far a vertex of a body of depth 1 or less is higher than the squared heights around allow, at most, in edges."""
    faces = body.quads if len(body.quads) else body.triangles
    ends = np.concatenate([np.column_stack([faces[:, k - 1], faces[:, k]]) for k in range(faces.shape[1])])
    ends = np.concatenate([ends, ends[:, ::-1]])
    here, there = body.vertices[ends[:, 0]], body.vertices[ends[:, 1]]
    allowed = np.zeros(len(body.vertices))
    apart = ((here - there)[:, :2] ** 2).sum(axis=1)
    np.maximum.at(allowed, ends[:, 0], there[:, 2] ** 2 + 2 * apart)
    beyond = np.abs(body.vertices[:, 2]) - np.sqrt(allowed)
    return float(beyond.max() / np.median(np.linalg.norm(here - there, axis=1)))
