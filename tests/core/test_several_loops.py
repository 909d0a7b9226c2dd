"""Patches that have several loops as their boundary."""

import itertools
import json
import pickle
import sys
from collections import Counter
from pathlib import Path

import gridmesh
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaign"))

import several
from several import ball, boundary_loops

pytestmark = pytest.mark.native


def opened(vertices, faces, poles, angle):
    """Faces without those near the poles, and the loops around what is missing."""
    middles = vertices[faces].mean(axis=1)
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    kept = faces[(middles @ np.asarray(poles).T < np.cos(angle)).all(axis=1)]
    return kept, boundary_loops(kept)


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
    vertices, faces = ball(24, 40)
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
    vertices, faces = ball(24, 40)
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
    vertices, faces = ball(24, 40)
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


@pytest.mark.parametrize(("number", "films"), [(5, 0), (12, 1)])
def test_where_a_smooth_patch_would_meet_itself_a_film_is_taken(number, films):
    """Both had met themselves some dozen times; the smooth patch of the first one no longer does."""
    vertices, faces, loops = several.case(1, number, 36, 66)
    fill = gridmesh.fill_hole(vertices, faces, loops, strict=True)
    assert not several.faults(vertices, faces, loops, fill)
    assert (fill.report["self_intersections"], fill.report["repaired"]) == (0, films)


@pytest.mark.parametrize("cells", ["triangles", "quads"])
def test_a_patch_of_linked_loops_that_meets_itself_is_told_and_refused_if_strict(cells):
    t = 2 * np.pi * np.arange(24) / 24
    ring = np.c_[np.cos(t), np.sin(t), 0 * t]
    vertices = np.vstack([ring, ring[:, [0, 2, 1]] + [1, 0, 0], 0.5 * ring + [5, 0, 0]])
    loops = [list(range(24 * k, 24 * k + 24)) for k in range(3)]
    none = np.zeros((0, 3), int)
    fill = gridmesh.fill_hole(vertices, none, loops, cells=cells)
    assert not several.faults(vertices, none, loops, fill)
    # Linked loops bound tubes that meet nothing; of quads one is found.
    if cells == "quads":
        assert fill.report["self_intersections"] == 0
        assert gridmesh.fill_hole(vertices, none, loops, cells=cells, strict=True).quads.size
        return
    assert fill.report["self_intersections"] > 0
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.fill_hole(vertices, none, loops, cells=cells, strict=True)
    assert caught.value.kind == "fill_intersects"


def pipes_along_z(n, *places, tilt=0.0, turned=False):
    """Open pipes of radius 1 and length 2, each about its place and tilted more than the one before: vertices, triangles, loops."""
    t = 2 * np.pi * np.arange(n) / n
    vertices, triangles, loops = [], [], []
    for k, place in enumerate(places):
        first = 3 * n * k
        rings = np.vstack([np.c_[np.cos(t), np.sin(t), np.full(n, z)] for z in (-1.0, 0.0, 1.0)])
        c, s = np.cos(k * tilt), np.sin(k * tilt)
        vertices.append(rings @ [[c, 0, -s], [0, 1, 0], [s, 0, c]] + place)
        i, j = np.arange(n), (np.arange(n) + 1) % n
        for row in (first, first + n):
            triangles += [np.c_[i, j, i + n] + row, np.c_[j, j + n, i + n] + row]
        loops += [first + i, first + 2 * n + i]
    faces = np.concatenate(triangles)
    return np.concatenate(vertices), faces[:, ::-1] if turned else faces, loops


@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("smooth", ["flat", "tangent"])
@pytest.mark.parametrize(
    ("places", "options"),
    [
        (([0, 0, 0], [3, 0, 0]), {}),
        (([0, 0, 0], [8, 0, 0]), {}),
        (([0, 0, 0], [0, 0, 4]), {}),
        (([0, 0, 0], [5, 0, 1]), {"tilt": 1.2}),
        (([0, 0, 0], [3, 0, 0]), {"turned": True}),
    ],
)
def test_one_patch_between_both_ends_of_pipes_is_refused_and_pairs_are_named(places, options, smooth, cells):
    """It folded and met itself some hundred times, after seconds."""
    vertices, triangles, loops = pipes_along_z(24, *places, **options)
    assert gridmesh.look_apart(vertices, triangles, loops)
    with pytest.raises(
        gridmesh.GridMeshError, match=r"look away from each other.* join them in pairs"
    ) as caught:
        gridmesh.fill_hole(vertices, triangles, loops, smooth=smooth, cells=cells)
    assert caught.value.kind == "fill_intersects"


def test_a_surface_that_would_grow_without_end_is_no_larger_than_a_film():
    """Triangles beside these loops of 8, 16 and 177 vertices cross each other: every smoother surface was larger (46,403 triangles)."""
    given = json.loads((Path(__file__).parent / "loops_that_cross.json").read_text())
    vertices, faces, loops = (given[name] for name in ("vertices", "triangles", "loops"))
    # The second and the third look away from each other, which alone would be refused.
    faces = [face for face in faces if not set(face) & set(loops[1])]
    fill, film = (gridmesh.fill_hole(vertices, faces, loops, smooth=smooth) for smooth in ("tangent", "flat"))
    check(np.array(vertices), np.array(faces), loops, fill)
    assert len(fill.triangles) < 1.5 * len(film.triangles)


def test_hard_edges_are_for_one_loop():
    vertices, caps, loops = case()
    with pytest.raises(gridmesh.GridMeshError, match="sharp"):
        gridmesh.fill_hole(vertices, caps, loops, sharp=0.5)


# ----------------------------------------------------------------------------------------------------- quads


def pipes(*counts):
    """Ends of pipes of quads, each two rows of two triangles a quad, that look at each other around a ring: vertices, triangles,
    the quad of each, and the loops.
    """
    vertices, triangles, loops = [], [], []
    for k, n in enumerate(counts):
        turn = 2 * np.pi * k / len(counts)
        way = np.array([np.cos(turn), np.sin(turn), 0.3 * np.cos(2 * turn)])
        way /= np.linalg.norm(way)
        u = np.cross([0, 0, 1.0], way)
        u /= np.linalg.norm(u)
        t = 2 * np.pi * np.arange(n)[:, None] / n
        ring = (0.7 + 0.1 * k) * (np.cos(t) * u + np.sin(t) * np.cross(way, u))
        first = sum(map(len, vertices))
        vertices.append(np.vstack([ring + (2.5 + step * 0.25) * way for step in range(3)]))
        i, j = np.arange(n) + first, (np.arange(n) + 1) % n + first
        for row in (0, n):
            quads = np.c_[i + row, j + row, j + row + n, i + row + n]
            triangles.append(np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], 1).reshape(-1, 3))
        loops.append(list(range(first, first + n)))
    triangles = np.concatenate(triangles)
    return np.concatenate(vertices), triangles, np.arange(len(triangles)) // 2, loops


def quads_between(*counts, **options):
    """The patch of quads between pipes, checked, with its corners in degrees."""
    vertices, triangles, polygons, loops = pipes(*counts)
    fill = gridmesh.fill_hole(vertices, triangles, loops, polygons=polygons, cells="quads", **options)
    assert not several.faults(vertices, triangles, loops, fill)
    assert len(fill.triangles) == sum(counts) % 2
    assert fill.report["quads"] == len(fill.quads)
    at = np.bincount(np.r_[fill.quads.ravel(), fill.triangles.ravel()], minlength=len(vertices))
    assert fill.report["irregular"] == (at[len(vertices) :] != 4).sum()
    return fill, several.corners(vertices, fill), at[len(vertices) :]


@pytest.mark.parametrize(
    "counts", [(20, 20, 20), (16, 22, 18, 26, 12), (9, 40, 17, 24), (21, 21, 20), (13, 30, 24)]
)
def test_pipes_are_joined_by_quads(counts):
    fill, corners, at = quads_between(*counts)
    assert fill.report["self_intersections"] == 0
    assert fill.report["folds"] == 0
    assert corners.min() > 25
    assert corners.max() < 150
    assert (at != 4).mean() < 0.08
    assert set(at) <= {3, 4, 5, 6}


@pytest.mark.parametrize("smooth", ["flat", "tangent", "curvature"])
@pytest.mark.parametrize("counts", [(3, 4, 5), (3, 3, 3), (5, 5, 4, 4), (6, 7, 8), (40, 3, 5), (30, 31, 33)])
def test_loops_of_any_counts_get_quads_and_one_triangle_if_odd(counts, smooth):
    fill, _, _ = quads_between(*counts, smooth=smooth)
    again, _, _ = quads_between(*counts, smooth=smooth)
    assert fill.vertices.tobytes() == again.vertices.tobytes()
    assert fill.quads.tobytes() == again.quads.tobytes()


def test_a_plate_with_holes_is_quads_in_its_plane():
    t = lambda n: 2 * np.pi * np.arange(n) / n  # noqa: E731
    rings = [(72, 5, 0, 0, 1), (24, 1, 2, 1, -1), (30, 1.2, -2, 0.5, -1)]
    points = [
        np.c_[x + r * np.cos(t(n)), way * (way * y + r * np.sin(t(n))), 0 * t(n)] for n, r, x, y, way in rings
    ]
    starts = np.cumsum([0, *map(len, points)])
    loops = [list(range(a, b)) for a, b in itertools.pairwise(starts)]
    vertices = np.concatenate(points)
    fill = gridmesh.fill_hole(vertices, np.zeros((0, 3), int), loops, cells="quads")
    assert not several.faults(vertices, np.zeros((0, 3), int), loops, fill)
    assert np.abs(fill.vertices[:, 2]).max() < 1e-9
    assert (fill.report["self_intersections"], fill.report["folds"]) == (0, 0)
    assert fill.report["irregular"] < 0.08 * len(fill.vertices)


def test_quads_between_several_loops_are_stored_extended_and_refitted():
    vertices, triangles, polygons, loops = pipes(16, 22, 18)
    fill = gridmesh.fill_hole(vertices, triangles, loops, polygons=polygons, cells="quads")
    again = pickle.loads(pickle.dumps(fill))
    assert again.quads.tobytes() == fill.quads.tobytes()
    values = vertices[fill.loop][:, :1]
    carried = again.extend(values)
    assert values.min() <= carried.min() <= carried.max() <= values.max()
    moved = 2 * vertices[:, [1, 2, 0]] + 0.5
    assert again.refit(moved) == pytest.approx(2 * fill.vertices[:, [1, 2, 0]] + 0.5, abs=1e-6)


def test_random_caps_of_a_ball_are_joined_by_quads():
    """A short run of the campaign: `python tests/campaign/several.py --cells quads`."""
    for number in range(4):
        vertices, faces, loops = several.case(1, number, 24, 44)
        fill = gridmesh.fill_hole(vertices, faces, loops, cells="quads")
        assert not several.faults(vertices, faces, loops, fill), number


def test_it_can_be_cancelled():
    vertices, caps, loops = case()
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.fill_hole(vertices, caps, loops, progress=lambda fraction: fraction < 0.3)
    assert caught.value.kind == "cancelled"
