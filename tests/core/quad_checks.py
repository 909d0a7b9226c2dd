"""What every patch and every body of quads must satisfy, checked without the library's own code."""

from __future__ import annotations

import gridmesh
import numpy as np
from checks import check_array, check_contour, check_loops, orientations


def half_edges(quads: np.ndarray) -> np.ndarray:
    """Directed edges, (4 q, 2)."""
    return np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)


def edges_of(quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Undirected edges, (e, 2), and the number of quads at each."""
    return np.unique(np.sort(half_edges(quads), axis=1), axis=0, return_counts=True)


def corner_triangles(quads: np.ndarray) -> np.ndarray:
    """The triangles at the four corners of each quad: those of both its triangulations."""
    return np.concatenate(
        [np.stack([np.roll(quads, k, axis=1)[:, i] for i in (3, 0, 1)], 1) for k in range(4)]
    )


def check_one_fan_each(quads: np.ndarray, n_vertices: int, n_boundary: int) -> None:
    """Around every vertex the quads form one fan: open at boundary vertices, closed elsewhere."""
    following: list[dict[int, int]] = [{} for _ in range(n_vertices)]
    for quad in quads.tolist():
        for k, vertex in enumerate(quad):
            first, second = quad[(k + 1) % 4], quad[k - 1]
            assert first not in following[vertex], "two quads with the same directed edge"
            following[vertex][first] = second
    for vertex, fan in enumerate(following):
        starts = fan.keys() - set(fan.values())
        assert len(starts) == (vertex < n_boundary), f"vertex {vertex} is not manifold"
        at = first = starts.pop() if starts else next(iter(fan))
        steps = 0
        while at in fan:
            at, steps = fan[at], steps + 1
            if at == first:
                break
        assert steps == len(fan), f"vertex {vertex} has more than one fan"


def single_quads(patch) -> np.ndarray:
    """The boundary vertices of a patch that have one quad."""
    n_boundary = sum(map(len, patch.loops))
    return np.flatnonzero(np.bincount(patch.quads.ravel())[:n_boundary] == 1)


def check_quad_patch(patch, contours: list[np.ndarray]) -> None:
    """Everything that is promised for a patch of quads of these contours (outline first, then holes), and for its belt."""
    check_flat(patch, contours)
    belt = patch.belt
    assert belt.belt is belt
    if belt is not patch:
        check_flat(belt, contours)
    assert len(single_quads(belt)) == 0
    single = single_quads(patch)
    assert len(patch.quads) == len(belt.quads) + len(single)
    assert len(patch.vertices) == len(belt.vertices) + 2 * len(single)
    assert (np.concatenate(patch.corner)[single] > 0).all(), "one quad where nothing is sharp"
    assert patch.report["quads"] == len(patch.quads)
    n_boundary = sum(map(len, belt.loops))
    poles = (np.bincount(belt.quads.ravel())[n_boundary:] != 4).sum()
    assert patch.report["poles"] == 2 * poles >= patch.report["minimum_poles"] == 8 * len(contours)


def check_flat(patch, contours: list[np.ndarray]) -> None:
    """What is promised for a patch with or without corners of a single quad."""
    vertices, quads = patch.vertices, patch.quads
    check_array(vertices, np.float64, 2)
    check_array(quads, np.int32, 4)
    check_array(patch.triangles, np.int32, 3)
    assert len(patch.triangles) == 0
    assert np.array_equal(np.unique(quads), np.arange(len(vertices))), "unused vertices"
    n_boundary = sum(map(len, patch.loops))
    assert np.array_equal(np.concatenate(patch.loops), np.arange(n_boundary))

    # An oriented manifold of the right topology whose boundary is exactly the loops.
    directed = {tuple(edge) for edge in half_edges(quads).tolist()}
    assert len(directed) == 4 * len(quads), "an edge is used twice in one direction"
    rim = {(a, b) for a, b in directed if (b, a) not in directed}
    assert rim == {
        (int(a), int(b)) for loop in patch.loops for a, b in zip(loop, np.roll(loop, -1), strict=True)
    }
    edges, counts = edges_of(quads)
    check_one_fan_each(quads, len(vertices), n_boundary)
    assert len(vertices) - len(edges) + len(quads) == 2 - len(contours), "wrong topology"

    # The belt: two quads at each boundary vertex, or one on a sharp corner, no edge inside between two of them; poles of
    # three or five.
    assert not ((counts == 2) & (edges < n_boundary).all(axis=1)).any(), "chord"
    faces = np.bincount(quads.ravel(), minlength=len(vertices))
    rim, inner = faces[:n_boundary], faces[n_boundary:]
    assert set(rim.tolist()) <= {1, 2}
    assert set(inner.tolist()) <= {3, 4, 5}
    assert (4 - inner).sum() + (2 - rim).sum() == 4 * (2 - len(contours))

    # Convex and counter-clockwise, also in the precision that Blender stores.
    corners = corner_triangles(quads)
    assert (orientations(vertices, corners) == 1).all(), "a concave or folded quad"
    rounded = (vertices - patch.origin).astype(np.float32).astype(np.float64)
    assert (orientations(rounded, corners) == 1).all(), "a concave or folded quad in float32"
    assert patch.report["min_angle"] > 0
    assert patch.report["max_deviation"] <= 2
    check_loops(patch)
    for k, contour in enumerate(contours):
        check_contour(patch, k, contour)


def check_quad_body(surface, patch, n_holes: int) -> None:
    """Everything that is promised for a closed body of a patch of quads."""
    patch, quads = patch.belt, surface.quads
    check_array(quads, np.int32, 4)
    assert len(surface.triangles) == 0
    assert len(quads) == 2 * len(patch.quads) == surface.report["quads"]
    edges, counts = edges_of(quads)
    assert (counts == 2).all()
    assert len({tuple(edge) for edge in half_edges(quads).tolist()}) == 4 * len(quads)
    assert len(surface.vertices) - len(edges) + len(quads) == 2 - 2 * n_holes
    valence = np.bincount(edges.ravel())
    assert set(valence.tolist()) <= {3, 4, 5}
    assert (valence != 4).sum() == patch.report["poles"] == surface.report["irregular"]
    assert surface.report["watertight"]
    assert surface.report["embedded"]
    for loop, drawn in zip(surface.silhouette, patch.loops, strict=True):
        assert np.array_equal(surface.vertices[loop, :2], patch.vertices[drawn])
        assert not surface.vertices[loop, 2].any()
        assert (valence[loop] == 4).all()
    # Unfolded and convex as seen from the front, and from behind.
    half = len(quads) // 2
    for part, sign in ((quads[:half], 1), (quads[half:], -1)):
        assert (orientations(surface.vertices[:, :2], corner_triangles(part)) == sign).all()
    assert surface.uv.shape == (4 * len(quads), 2)
    assert surface.uv.min() >= 0
    assert surface.uv.max() <= 1
    texture = surface.uv.reshape(-1, 4, 2)
    assert (
        orientations(texture.reshape(-1, 2), corner_triangles(np.arange(4 * len(quads)).reshape(-1, 4))) == 1
    ).all()


def check_refused_with_a_count_that_works(outline: np.ndarray, quads: int) -> None:
    """A drawing too thin for its quads is told how many work; they do."""
    try:
        gridmesh.mesh_sketch(outline, quads=quads)
    except gridmesh.GridMeshError as refusal:
        assert refusal.kind == "too_coarse"
        assert f"{quads} quads" in str(refusal)
        works = int(str(refusal).split("; ")[1].split()[0])
        check_quad_patch(gridmesh.mesh_sketch(outline, quads=works), [outline])
    else:
        raise AssertionError("not refused")
