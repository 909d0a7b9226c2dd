"""Patches that have several loops as their boundary."""

import itertools
import pickle
from collections import Counter

import gridmesh
import numpy as np
import pytest


def ball(rings=24, around=40):
    """Vertices and triangles of a closed ball of radius 1."""
    heights = np.linspace(0, np.pi, rings + 1)[1:-1]
    angles = np.linspace(0, 2 * np.pi, around, endpoint=False)
    points = [(np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t)) for t in heights for a in angles]
    vertices = np.array([*points, (0, 0, 1), (0, 0, -1)])
    faces = []
    for k in range(around):
        after = (k + 1) % around
        for row in range(len(heights) - 1):
            a, b = row * around + k, row * around + after
            faces += [(a, a + around, b), (b, a + around, b + around)]
        last = (len(heights) - 1) * around
        faces += [(len(points), k, after), (len(points) + 1, last + after, last + k)]
    return vertices, np.array(faces, np.int32)


def opened(vertices, faces, poles, angle):
    """Faces without those near the poles, and the loops around what is missing."""
    middles = vertices[faces].mean(axis=1)
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    kept = faces[(middles @ np.asarray(poles).T < np.cos(angle)).all(axis=1)]
    return kept, boundary_loops(kept)


def boundary_loops(faces):
    sides = {(a, b) for f in faces.tolist() for a, b in zip(f, [*f[1:], f[0]], strict=True)}
    following = {b: a for a, b in sides if (b, a) not in sides}
    loops = []
    while following:
        start, after = following.popitem()
        loop = [start]
        while after != start:
            loop.append(after)
            after = following.pop(after)
        loops.append(loop)
    return sorted(loops, key=min)


def check(vertices, faces, loops, fill):
    """All that is promised of a patch with several loops."""
    n = len(vertices)
    assert fill.loop.tolist() == [v for loop in loops for v in loop]
    new = fill.triangles.tolist()
    sides = Counter((a, b) for f in new for a, b in zip(f, [*f[1:], f[0]], strict=True))
    assert max(sides.values()) == 1
    rims = {frozenset(e) for loop in loops for e in zip(loop, [*loop[1:], loop[0]], strict=True)}
    open_sides = {e for e in sides if e[::-1] not in sides}
    assert {frozenset(e) for e in open_sides} == rims
    assert len(open_sides) == len(rims)
    whole = Counter((a, b) for f in [*faces.tolist(), *new] for a, b in zip(f, [*f[1:], f[0]], strict=True))
    assert max(whole.values()) == 1  # no edge is repeated, and all are wound against their neighbours
    used = {v for f in new for v in f}
    assert used == {v for loop in loops for v in loop} | set(range(n, n + len(fill.vertices)))
    edges = {frozenset(e) for e in sides}
    assert len(used) - len(edges) + len(new) == 2 - len(loops)
    assert np.isfinite(fill.vertices).all()


@pytest.mark.parametrize("smooth", ["flat", "tangent", "curvature"])
@pytest.mark.parametrize("count", [3, 4, 6])
def test_what_is_left_of_a_ball_is_put_back(count, smooth):
    vertices, faces = ball()
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False) + 0.1
    poles = np.c_[np.cos(turns), np.sin(turns), 0.3 * np.cos(3 * turns)]
    poles /= np.linalg.norm(poles, axis=1, keepdims=True)
    # The mesh is the caps; the patch lies between them.
    middles = vertices[faces].mean(axis=1)
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    caps = faces[(middles @ poles.T > np.cos(0.42)).any(axis=1)]
    loops = boundary_loops(caps)
    assert len(loops) == count
    fill = gridmesh.fill_hole(vertices, caps, loops, smooth=smooth)
    check(vertices, caps, loops, fill)
    assert fill.report["grid"] == "even"
    if smooth != "flat":  # a film between these caps has two sides that touch
        assert fill.report["self_intersections"] == 0
        assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < 0.3
    assert np.degrees(fill.report["min_angle"]) > 12
    assert fill.report["irregular"] < 0.16 * len(fill.vertices)


def test_a_plate_with_holes_stays_a_plate():
    def ring(n, radius, x, y, way):
        turns = way * np.linspace(0, 2 * np.pi, n, endpoint=False)
        return np.c_[x + radius * np.cos(turns), y + radius * np.sin(turns), 0 * turns]

    rings = [
        ring(90, 5, 0, 0, 1),
        ring(24, 1, 2, 1, -1),
        ring(31, 1.2, -2, 0.5, -1),
        ring(7, 0.4, 0, -2.5, -1),
    ]
    starts = np.cumsum([0, *map(len, rings)])
    loops = [list(range(a, b)) for a, b in itertools.pairwise(starts)]
    vertices = np.concatenate(rings)
    fill = gridmesh.fill_hole(vertices, np.zeros((0, 3), int), loops)
    check(vertices, np.zeros((0, 3), np.int32), loops, fill)
    assert np.abs(fill.vertices[:, 2]).max() < 1e-9
    points = np.vstack([vertices, fill.vertices])[fill.triangles]
    areas = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])[:, 2] / 2
    assert (areas > 0).all()
    inside = [
        abs(np.dot(r[:, 0], np.roll(r[:, 1], -1)) - np.dot(r[:, 1], np.roll(r[:, 0], -1))) / 2 for r in rings
    ]
    assert areas.sum() == pytest.approx(inside[0] - sum(inside[1:]))
    assert np.degrees(fill.report["min_angle"]) > 5


def test_loops_without_faces_are_turned_to_fit():
    def ring(n, middle, axis, way):
        u = np.linalg.svd(np.atleast_2d(axis))[2][1:]
        turns = way * np.linspace(0, 2 * np.pi, n, endpoint=False)
        return middle + np.outer(np.cos(turns), u[0]) + np.outer(np.sin(turns), u[1])

    places = 4 * np.array([[0, 0, 1.0], [0.9, 0, -0.6], [-0.9, 0, -0.6]])
    for ways in ((1, 1, 1), (1, -1, 1), (1, 1, -1), (-1, -1, 1)):
        rings = [
            ring(20 + 3 * k, place, place, way)
            for k, (place, way) in enumerate(zip(places, ways, strict=True))
        ]
        starts = np.cumsum([0, *map(len, rings)])
        loops = [list(range(a, b)) for a, b in itertools.pairwise(starts)]
        fill = gridmesh.fill_hole(np.concatenate(rings), np.zeros((0, 3), int), loops)
        assert fill.report["self_intersections"] == 0, ways
        assert fill.report["winding_conflicts"] == 0


def case():
    vertices, faces = ball()
    caps = faces[(np.abs(vertices[faces].mean(axis=1)) > 0.85).any(axis=1)]
    return vertices, caps, boundary_loops(caps)


def test_data_is_carried_on_and_poses_follow():
    vertices, caps, loops = case()
    assert len(loops) == 6
    fill = gridmesh.fill_hole(vertices, caps, loops)
    check(vertices, caps, loops, fill)
    values = vertices[fill.loop][:, :1] + 0.2
    carried = fill.extend(values)
    assert carried.min() >= values.min()
    assert carried.max() <= values.max()
    moved = 2 * vertices[:, [1, 2, 0]] + 0.5
    assert fill.refit(moved) == pytest.approx(2 * fill.vertices[:, [1, 2, 0]] + 0.5, abs=1e-6)
    again = pickle.loads(pickle.dumps(fill))
    assert again.triangles.tobytes() == fill.triangles.tobytes()
    assert again.extend(values).tobytes() == carried.tobytes()
    assert again.refit(moved).tobytes() == fill.refit(moved).tobytes()


def test_either_direction_of_loops_gives_the_same_patch():
    vertices, caps, loops = case()
    one = gridmesh.fill_hole(vertices, caps, loops)
    other = gridmesh.fill_hole(vertices, caps, [loops[0], loops[1][::-1], *loops[2:]])
    assert one.vertices.tobytes() == gridmesh.fill_hole(vertices, caps, loops).vertices.tobytes()
    assert one.triangles.shape == other.triangles.shape
    values = vertices[other.loop][:, :1]
    assert other.extend(values) == pytest.approx(one.extend(vertices[one.loop][:, :1]))


def test_two_loops_are_joined_by_a_tube():
    vertices, faces = ball()
    caps = faces[np.abs(vertices[faces].mean(axis=1))[:, 2] > 0.6]
    loops = boundary_loops(caps)
    fill = gridmesh.fill_hole(vertices, caps, loops)
    tube = gridmesh.bridge(vertices, caps, *loops)
    assert fill.triangles.tobytes() == tube.triangles.tobytes()
    check(vertices, caps, loops, fill)


def test_loops_of_hundreds_of_vertices():
    vertices, faces = ball(80, 150)
    caps = faces[(np.abs(vertices[faces].mean(axis=1)) > 0.9).any(axis=1)]
    loops = boundary_loops(caps)
    fill = gridmesh.fill_hole(vertices, caps, loops)
    check(vertices, caps, loops, fill)
    assert fill.report["self_intersections"] == 0
    assert np.degrees(fill.report["min_angle"]) > 15
    assert fill.report["irregular"] < 0.15 * len(fill.vertices)


def test_a_patch_between_caps_of_different_sizes_has_no_folds():
    """Fairing alone left 22 folds, and an angle of 1.5 degrees."""
    vertices, faces = ball(24, 70)
    poles = np.array([(1, 0.2, 0), (-0.5, 0.9, 0.2), (-0.4, -0.8, 0.3), (0, 0.1, 1), (0.1, -0.2, -1)])
    poles /= np.linalg.norm(poles, axis=1, keepdims=True)
    middles = vertices[faces].mean(axis=1)
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    caps = faces[(middles @ poles.T > np.cos([0.33, 0.16, 0.2, 0.3, 0.25])).any(axis=1)]
    loops = boundary_loops(caps)
    fill = gridmesh.fill_hole(vertices, caps, loops)
    check(vertices, caps, loops, fill)
    assert (fill.report["self_intersections"], fill.report["folds"]) == (0, 0)
    assert np.degrees(fill.report["min_angle"]) > 6


@pytest.mark.parametrize(
    ("changed", "kind"),
    [
        (lambda loops: [*loops, loops[0]], "figure_eight"),
        (lambda loops: [loops[0], loops[1][:2], loops[2]], "too_few_points"),
        (lambda loops: [loops[0], [*loops[1], 10**6], loops[2]], "index_out_of_range"),
    ],
)
def test_loops_that_are_unfit_are_named(changed, kind):
    vertices, caps, loops = case()
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.fill_hole(vertices, caps, changed(loops))
    assert caught.value.kind == kind


@pytest.mark.parametrize("option", [{"cells": "quads"}, {"sharp": 0.5}])
def test_options_of_one_loop_are_refused(option):
    vertices, caps, loops = case()
    with pytest.raises(gridmesh.GridMeshError, match=next(iter(option))):
        gridmesh.fill_hole(vertices, caps, loops, **option)


def test_it_can_be_cancelled():
    vertices, caps, loops = case()
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.fill_hole(vertices, caps, loops, progress=lambda fraction: fraction < 0.3)
    assert caught.value.kind == "cancelled"
