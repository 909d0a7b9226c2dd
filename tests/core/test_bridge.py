"""`bridge`: what is guaranteed of a tube between two loops."""

import pickle
import re
import sys
from pathlib import Path

import gridmesh
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaign"))

import bridges
from bridges import NO_FACES, Case, faults, measure

pytestmark = pytest.mark.native

TAU = 2 * np.pi


def circle(n, radius=1.0, z=0.0, start=0.0):
    t = TAU * np.arange(n) / n + start
    return np.c_[radius * np.cos(t), radius * np.sin(t), np.full(n, z)]


def bridged(one, two, **options):
    """The tube between two rings of points without a mesh, checked; and its measure."""
    loops = np.arange(len(one)), len(one) + np.arange(len(two))
    case = Case(np.vstack([one, two]), NO_FACES, loops, options.get("smooth", "tangent"))
    fill = gridmesh.bridge(case.vertices, NO_FACES, *loops, **options)
    assert not faults(case, fill)
    assert fill.report["irregular"] == sum(inner_valences(case, fill) != 6)
    return fill, measure(case, fill, 0.0)


def inner_valences(case, fill):
    edges = np.unique(np.sort(bridges.all_sides(fill.triangles), axis=1), axis=0)
    return np.bincount(edges.ravel(), minlength=len(case.vertices))[len(case.vertices) :]


def pipe(n=16, gap=2.0):
    """A tube of quads, cut in two, each a triangle pair: vertices, triangles, and the two rims."""
    rings = np.vstack([circle(n, z=z) for z in (-1.0, -0.5, 0.0, gap, gap + 0.5, gap + 1)])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    rows = [np.r_[np.c_[i, j, i + n], np.c_[j, j + n, i + n]] + n * k for k in (0, 1, 3, 4)]
    return rings, np.concatenate(rows), 2 * n + i, 3 * n + i


# ------------------------------------------------------------------------------------------------ regularity


@pytest.mark.parametrize("n", [3, 5, 12, 60, 200])
@pytest.mark.parametrize("height", [0.05, 1.0, 4.0])
def test_equal_coaxial_loops_have_no_irregular_vertex_at_all(n, height):
    fill, found = bridged(circle(n), circle(n, z=height))
    assert fill.report["irregular"] == 0
    assert found.excess == 0


@pytest.mark.parametrize("n", [12, 30, 60])
def test_six_more_at_one_row_are_a_cone(n):
    fill, _ = bridged(circle(n), circle(n + 6, 1 + 6 / n), rows=1)
    assert len(fill.vertices) == 0
    assert len(fill.triangles) == 2 * n + 6
    outer = np.bincount(np.unique(np.sort(bridges.all_sides(fill.triangles), axis=1), axis=0).ravel())
    assert sorted(outer[n:])[:6] == [3] * 6


@pytest.mark.parametrize(
    ("n", "m", "rows"), [(24, 36, 2), (24, 36, 3), (24, 48, 4), (10, 40, 5), (30, 30, 7)]
)
def test_cones_and_cylinders_of_given_rows_are_regular_inside(n, m, rows):
    fill, _ = bridged(circle(n), circle(m, m / n, z=0.3), rows=rows)
    assert fill.report["irregular"] == 0
    assert fill.report["rows"] == rows
    assert fill.report["grid"] == "lattice"


def test_a_campaign_of_random_loops():
    """A short run of the campaign; `python tests/campaign/bridges.py` makes longer ones."""
    wrong, measures = bridges.campaign(40, seed=1)
    assert not wrong
    of = lambda name: np.array([getattr(it, name) for it in measures])  # noqa: E731
    assert np.median(of("irregular")) == 0
    assert np.percentile(of("irregular"), 90) <= 0.02
    assert of("excess").mean() <= 0.5
    # Of 500 it is 22; so few scatter.
    assert np.median(of("angle")) >= 21
    assert np.median(of("ratio")) >= 0.88


# ----------------------------------------------------------------------------------------------------- quads


def quads_at(n_loops, fill):
    """How many new faces each vertex of the loops has, and each new one."""
    faces = np.bincount(np.r_[fill.quads.ravel(), fill.triangles.ravel()], minlength=n_loops)
    return faces[:n_loops], faces[n_loops:]


def quad_tube(one, two, **options):
    """A tube of quads between two rings of points without a mesh, checked."""
    loops = np.arange(len(one)), len(one) + np.arange(len(two))
    case = Case(np.vstack([one, two]), NO_FACES, loops, options.get("smooth", "tangent"))
    fill = gridmesh.bridge(case.vertices, NO_FACES, *loops, cells="quads", **options)
    assert not faults(case, fill)
    assert len(fill.triangles) == (len(one) + len(two)) % 2
    at_loops, inner = quads_at(len(case.vertices), fill)
    assert fill.report["irregular"] == (inner != 4).sum()
    assert fill.report["irregular_loop"] == (at_loops != 2).sum()
    return fill


@pytest.mark.parametrize("n", [3, 5, 12, 60, 200])
@pytest.mark.parametrize("height", [0.05, 1.0, 4.0])
def test_equal_coaxial_loops_are_joined_by_quads_without_a_pole(n, height):
    fill = quad_tube(circle(n), circle(n, z=height))
    assert (fill.report["irregular"], fill.report["irregular_loop"]) == (0, 0)
    assert len(fill.quads) == n * fill.report["rows"]
    assert np.degrees(fill.report["min_angle"]) > 85
    assert np.linalg.norm(fill.vertices[:, :2], axis=1) == pytest.approx(1, abs=0.2)


@pytest.mark.parametrize(
    ("n", "m", "rows", "poles"),
    [(24, 30, 5, 2), (24, 36, 8, 2), (24, 31, 5, 1), (24, 25, 5, 1), (40, 10, 7, 6), (30, 30, 7, 0)],
)
def test_poles_of_quads_come_in_pairs_for_twice_the_rows_and_lie_off_the_loops(n, m, rows, poles):
    fill = quad_tube(circle(n), circle(m, m / n, z=0.7), rows=rows)
    assert fill.report["rows"] == rows
    assert (fill.report["irregular"], fill.report["irregular_loop"]) == (poles, 0)
    _, inner = quads_at(n + m, fill)
    assert set(inner) <= {3, 4, 5}


def test_a_campaign_of_random_loops_in_quads():
    """A short run of the campaign; `python tests/campaign/bridges.py --cells quads` makes longer ones."""
    wrong, measures = bridges.campaign(40, seed=1, cells="quads")
    assert not wrong
    of = lambda name: np.array([getattr(it, name) for it in measures])  # noqa: E731
    assert np.median(of("irregular")) <= 0.01
    assert of("excess").mean() <= 0.05
    assert of("meetings").max() == 0
    assert np.median(of("angle")) >= 40


ANY_TWO_LOOPS = {
    "n": st.integers(3, 70),
    "m": st.integers(3, 70),
    "radius": st.floats(0.05, 20),
    "height": st.floats(0.01, 8),
    "start": st.floats(0, TAU),
    "twist": st.floats(-8, 8),
    "rows": st.none() | st.integers(1, 12),
    "smooth": st.sampled_from(["flat", "tangent", "curvature"]),
}


@settings(deadline=None, max_examples=60)
@given(**ANY_TWO_LOOPS)
def test_any_two_loops_in_quads(n, m, radius, height, start, twist, rows, smooth):
    quad_tube(circle(n), circle(m, radius, height, start), twist=twist, rows=rows, smooth=smooth)


def test_quads_of_a_pipe_go_on_through_the_tube():
    vertices, triangles, one, two = pipe(gap=2.0)
    polygons = np.concatenate([np.r_[np.arange(16), np.arange(16)] + 16 * k for k in range(4)])
    order = np.argsort(polygons, kind="stable")
    options = {"polygons": polygons[order], "cells": "quads"}
    fill = gridmesh.bridge(vertices, triangles[order], one, two, **options)
    assert (fill.report["irregular"], fill.report["irregular_loop"]) == (0, 0)
    assert np.linalg.norm(fill.vertices[:, :2], axis=1) == pytest.approx(1, abs=0.02)
    # Rows of quads that are level, as those of the pipe are.
    heights = fill.vertices[:, 2].reshape(-1, 16)
    assert np.ptp(heights, axis=1).max() < 0.05


def test_quads_are_stored_refitted_and_extended():
    vertices, triangles, one, two = pipe(n=16)
    fill = gridmesh.bridge(vertices, triangles, one, two, cells="quads", smooth="curvature")
    again = pickle.loads(pickle.dumps(fill))
    assert again.quads.tobytes() == fill.quads.tobytes()
    moved = 2 * vertices[:, [1, 2, 0]] + 0.5
    assert again.refit(moved) == pytest.approx(2 * fill.vertices[:, [1, 2, 0]] + 0.5, abs=1e-6)
    values = np.r_[np.zeros(16), np.ones(16)][:, None]
    carried = again.extend(values)
    assert 0 <= carried.min() < 0.4 < 0.6 < carried.max() <= 1


# --------------------------------------------------------------------------------------------------- validity


@settings(deadline=None, max_examples=60)
@given(**ANY_TWO_LOOPS)
def test_any_two_loops(n, m, radius, height, start, twist, rows, smooth):
    fill, _ = bridged(circle(n), circle(m, radius, height, start), twist=twist, rows=rows, smooth=smooth)
    assert fill.report["rows"] >= 1


@settings(deadline=None, max_examples=40)
@given(
    st.lists(st.tuples(st.floats(0.2, 1), st.floats(-0.3, 0.3)), min_size=3, max_size=40), st.integers(3, 60)
)
def test_uneven_and_waved_loops(wave, m):
    t = TAU * np.cumsum([w for w, _ in wave]) / sum(w for w, _ in wave)
    radius = np.array([w for w, _ in wave])
    one = np.c_[radius * np.cos(t), radius * np.sin(t), [h for _, h in wave]]
    bridged(one, circle(m, 2.0, 3.0))


def test_loops_nested_in_a_plane_stay_in_it_and_do_not_meet():
    fill, found = bridged(circle(20), circle(44, 2.5))
    assert np.all(fill.vertices[:, 2] == 0)
    assert fill.report["self_intersections"] == 0
    assert found.angle > 20


@pytest.mark.parametrize("number", [462, 495])
def test_a_tube_that_would_fold_where_its_loops_turn_is_pulled_tight(number):
    case = bridges.case(1, number)
    fill = gridmesh.bridge(case.vertices, case.triangles, *case.loops)
    assert not faults(case, fill)
    assert fill.report["folds"] == fill.report["self_intersections"] == 0
    assert np.degrees(fill.report["min_angle"]) > 15
    told = []
    gridmesh.bridge(case.vertices, case.triangles, *case.loops, progress=told.append)
    assert told == sorted(told)
    for kept in (fill, pickle.loads(pickle.dumps(fill))):
        assert np.array_equal(kept.refit(case.vertices), fill.vertices)


def test_directions_of_the_loops_do_not_matter():
    one, two = circle(24), circle(30, z=2.0)
    fill, _ = bridged(one, two)
    for a, b in [(one[::-1], two), (one, two[::-1]), (one[::-1], two[::-1])]:
        other, _ = bridged(a, b)
        assert len(other.triangles) == len(fill.triangles)
        assert other.report["self_intersections"] == 0


def test_rows_that_the_mesh_joins_already_are_kept_apart():
    vertices = np.vstack([circle(12), circle(12, z=0.5)])
    triangles = np.array([[0, 1, 12]])
    # The edge from 0 to 12 is there already; a single row may not repeat it.
    loops = np.arange(2, 12), np.arange(13, 24)
    fill = gridmesh.bridge(vertices, triangles, *loops)
    assert not faults(Case(vertices, triangles, loops, "tangent"), fill)
    n = 12
    joined = np.array([[k, n + k, n + (k + 1) % n] for k in range(0, n, 3)])
    vertices = np.vstack([circle(n), circle(n, z=0.3), circle(n, 2.0, z=0.3)])
    bars = np.c_[joined[:, :2], 2 * n + joined[:, 1] - n]
    loops = np.arange(n), n + np.arange(n)
    case = Case(vertices, bars, loops, "tangent")
    fill = gridmesh.bridge(vertices, bars, *loops, rows=1)
    assert "an edge is repeated" not in faults(case, fill)
    assert fill.report["rows"] == 2


def test_the_same_bytes_each_time():
    case = bridges.case(7, 3)
    fills = [gridmesh.bridge(case.vertices, case.triangles, *case.loops) for _ in range(2)]
    assert fills[0].vertices.tobytes() == fills[1].vertices.tobytes()
    assert fills[0].triangles.tobytes() == fills[1].triangles.tobytes()


# ------------------------------------------------------------------------------------------------------ shape


def test_a_gap_in_a_pipe_becomes_a_pipe():
    vertices, triangles, one, two = pipe()
    for smooth in ("tangent", "curvature"):
        fill = gridmesh.bridge(vertices, triangles, one, two, smooth=smooth)
        assert not faults(Case(vertices, triangles, (one, two), smooth), fill)
        assert np.abs(np.hypot(*fill.vertices[:, :2].T) - 1).max() < 0.02
        assert fill.report["winding_conflicts"] == 0


def test_one_end_wound_the_other_way_is_counted():
    vertices, triangles, one, two = pipe()
    half = len(triangles) // 2
    triangles = np.r_[triangles[:half], triangles[half:, ::-1]]
    fill = gridmesh.bridge(vertices, triangles, one, two)
    assert fill.report["winding_conflicts"] == len(one)
    assert fill.report["self_intersections"] == 0


def test_twist_turns_the_tube():
    straight, _ = bridged(circle(24), circle(24, z=2.0))
    turned, _ = bridged(circle(24), circle(24, z=2.0), twist=0.5)
    assert len(straight.triangles) == len(turned.triangles)
    assert not np.allclose(straight.vertices, turned.vertices)


def test_refit_extend_and_pickle():
    vertices, triangles, one, two = pipe()
    fill = gridmesh.bridge(vertices, triangles, one[::-1], two)
    assert np.array_equal(fill.refit(vertices), fill.vertices)
    moved = vertices + [0, 0, 3.0]
    assert np.allclose(fill.refit(moved), fill.vertices + [0, 0, 3.0])
    heights = fill.extend(vertices[fill.loop])
    assert np.all(np.diff(heights[np.argsort(fill.vertices[:, 2]), 2]) > -0.3)
    assert heights[:, 2].min() >= 0
    again = pickle.loads(pickle.dumps(fill))
    assert np.array_equal(again.loop, fill.loop)
    assert np.array_equal(again.refit(moved), fill.refit(moved))


# --------------------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        ({"other": np.arange(2)}, "too_few_points"),
        ({"other": np.r_[0, 13:20]}, "figure_eight"),
        ({"other": np.r_[12:24, 99]}, "index_out_of_range"),
        ({"other": np.r_[12:24, 23]}, "repeated_vertex"),
        ({"rows": 0}, "invalid_option"),
        ({"twist": np.nan}, "not_finite"),
        ({"twist": np.inf}, "not_finite"),
        ({"rows": 10**9}, "too_large"),
    ],
)
def test_what_is_not_fit_is_refused(change, kind):
    arguments = {"loop": np.arange(12), "other": 12 + np.arange(12)} | change
    loops = arguments.pop("loop"), arguments.pop("other")
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.bridge(np.vstack([circle(12), circle(12, z=1.0)]), NO_FACES, *loops, **arguments)
    assert caught.value.kind in (kind, "invalid_option")


def touching_rings(kind, scale):
    """Two rings that lie on each other, all along or in places, far from the origin too."""
    one = circle(24)
    other = {
        "the same": one,
        "rounded": one.astype(np.float32).astype(float),
        "every second vertex": circle(12),
        "one vertex": one + [2.0, 0, 0],
        "edges that cross": one + [0.3, 0, 0],
        "a stretch": np.where(one[:, :1] > 0.1, one, one + [0, 0, 1.0]),
    }[kind]
    return scale * np.vstack([one, other]), np.arange(24), 24 + np.arange(len(other))


@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize(
    "kind", ["the same", "rounded", "every second vertex", "one vertex", "edges that cross", "a stretch"]
)
def test_loops_that_touch_are_refused(kind, scale, cells):
    """Between them were faces without area."""
    vertices, one, two = touching_rings(kind, scale)
    far = len(vertices) + np.arange(12)
    vertices = np.vstack([vertices, scale * circle(12, z=3.0)])
    calls = (
        lambda: gridmesh.bridge(vertices, NO_FACES, one, two, cells=cells),
        lambda: gridmesh.bridge(vertices, NO_FACES, two[::-1], one, cells=cells),
        lambda: gridmesh.fill_hole(vertices, NO_FACES, [far, one, two], cells=cells),
    )
    for call in calls:
        with pytest.raises(
            gridmesh.GridMeshError, match=r"touch at vertices .* merge the vertices by dist"
        ) as caught:
            call()
        assert caught.value.kind == "loops_touch"
    named = [
        int(number) for number in re.search("vertices ([0-9]+) and ([0-9]+)", str(caught.value)).groups()
    ]
    assert np.isin(named, one).any()
    assert np.isin(named, two).any()


def test_of_pairs_those_that_touch_are_refused():
    vertices, one, two = touching_rings("the same", 1.0)
    far = [len(vertices) + np.arange(12), len(vertices) + 12 + np.arange(12)]
    vertices = np.vstack([vertices, circle(12, z=3.0), circle(12, z=4.0)])
    pairs = gridmesh.bridge_pairs(vertices, NO_FACES, [one, two, *far])
    assert [(a, b) for a, b, _ in pairs] == [(0, 1), (2, 3)]
    assert pairs[0][2].kind == "loops_touch"
    assert len(pairs[1][2].triangles) > 0


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("gap", [0.3, 0.03, 0.001])
def test_loops_near_each_other_are_joined(gap, scale):
    vertices = scale * np.vstack([circle(24), circle(24, z=gap)])
    fill = gridmesh.bridge(vertices, NO_FACES, np.arange(24), 24 + np.arange(24))
    corners = np.vstack([vertices, fill.vertices])[fill.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert areas.sum() == pytest.approx(2 * np.pi * gap * scale**2, rel=0.02)
    assert areas.min() > 0.1 * areas.max()
    assert fill.report["self_intersections"] == 0


def test_cancelling():
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.bridge(
            np.vstack([circle(12), circle(19, z=1.0)]),
            NO_FACES,
            np.arange(12),
            12 + np.arange(19),
            progress=lambda fraction: fraction < 0.3,
        )
    assert caught.value.kind == "cancelled"


def test_progress_never_falls():
    seen = []
    case = bridges.case(3, 5)
    gridmesh.bridge(case.vertices, case.triangles, *case.loops, progress=lambda f: seen.append(f) or True)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


# ----------------------------------------------------------------------------------------------------- pairs


def pipes_apart(*moved):
    """Pipes as `pipe` makes them but whole, moved apart: vertices, triangles, and both rims of each."""
    points, faces, loops = [], [], []
    for by in moved:
        first = sum(map(len, points))
        rings = np.vstack([circle(16, z=z) for z in (-1.0, 0.0, 1.0)])
        i, j = np.arange(16), (np.arange(16) + 1) % 16
        faces += [np.r_[np.c_[i, j, i + 16], np.c_[j, j + 16, i + 16]] + 16 * k + first for k in (0, 1)]
        points.append(rings + by)
        loops += [first + i, first + 32 + i]
    return np.concatenate(points), np.concatenate(faces), loops


@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("apart", [2.2, 3.0, 8.0, 30.0])
def test_both_ends_of_pipes_beside_each_other_are_joined_by_bends(apart, cells):
    vertices, triangles, loops = pipes_apart([0, 0, 0], [apart, 0, 0])
    assert gridmesh.look_apart(vertices, triangles, loops)
    assert not gridmesh.look_apart(vertices, triangles, loops[1::2])
    pairs = gridmesh.bridge_pairs(vertices, triangles, loops, cells=cells)
    assert sorted((a, b) for a, b, _ in pairs) == [(0, 2), (1, 3)]
    for a, b, fill in pairs:
        case = Case(vertices, triangles, (loops[a], loops[b]), "tangent")
        assert not faults(case, fill)
        assert fill.report["self_intersections"] == fill.report["folds"] == 0
        # Out of the plane of the rims by as much as half a circle asks for.
        height = np.abs(fill.vertices[:, 2]).max() - 1
        assert 0.3 * apart < height < 0.6 * apart + 1


def test_a_pair_that_would_run_through_the_pipes_is_refused_if_strict():
    vertices, triangles, loops = pipes_apart([0, 0, 0], [0, 0, 4])
    pairs = gridmesh.bridge_pairs(vertices, triangles, loops, strict=True)
    assert [(a, b) for a, b, _ in pairs] == [(1, 2), (0, 3)]
    assert isinstance(pairs[0][2], gridmesh.Fill)
    assert pairs[1][2].kind == "fill_intersects"


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        ({"loops": [[0, 1, 2], [2, 3, 4]]}, "figure_eight"),
        ({"loops": [[0, 1, 2], [3, 4, 99]]}, "index_out_of_range"),
        ({"loops": [[0, 1, 2], [3, 4]]}, "too_few_points"),
        ({"rows": 0}, "invalid_option"),
        ({"progress": lambda fraction: fraction < 0.3}, "cancelled"),
    ],
)
def test_pairs_of_loops_that_are_not_fit_are_refused(change, kind):
    arguments = {"loops": [np.arange(12), 12 + np.arange(12)]} | change
    vertices, loops = np.vstack([circle(12), circle(12, z=1.0)]), arguments.pop("loops")
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.bridge_pairs(vertices, NO_FACES, loops, **arguments)
    assert caught.value.kind == kind
    if "loops" in change:
        with pytest.raises(gridmesh.GridMeshError) as caught:
            gridmesh.look_apart(vertices, NO_FACES, loops)
        assert caught.value.kind == kind
