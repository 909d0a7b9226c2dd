"""Planes, closing, nesting and sampling: plain numpy."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from drawings import at, bean, circle, on_plane

from addon import api
from addon.bodies import nesting, outlines, sampling


def stroke(points, *, cyclic=True, index=0, layer="Lines", source="Drawing"):
    return outlines.Stroke(np.asarray(points, float), cyclic, source, layer, index, 9)


def test_no_bpy_is_needed():
    """A plain Python can import what is promised to work without Blender."""
    code = "import sys; sys.modules['bpy'] = None; import addon.api, addon.data.attributes, addon.fill.creases, addon.fill.holes, addon.bodies.outlines, addon.bodies.sampling"
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parents[2])


def rotations(n):
    rng = np.random.default_rng(7)
    for _ in range(n):
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        yield q * np.sign(np.linalg.det(q))


def test_plane_is_a_right_handed_frame_through_the_points():
    for rotation in rotations(200):
        points = bean() @ rotation.T + [3, -4, 5]
        plane = outlines.fit_plane(points)
        assert np.allclose(plane.axes @ plane.axes.T, np.eye(3), atol=1e-12)
        assert np.isclose(np.linalg.det(plane.axes), 1)
        assert np.allclose(plane.local(points)[:, 2], 0, atol=1e-9)
        assert np.allclose(plane.world(plane.local(points)), points, atol=1e-12)
        middle = plane.local(points).min(axis=0) + plane.local(points).max(axis=0)
        assert np.allclose(middle, 0, atol=1e-9)


def test_plane_does_not_depend_on_the_direction_or_start_of_the_stroke():
    for rotation in rotations(50):
        points = bean() @ rotation.T
        plane = outlines.fit_plane(points)
        for other in (points[::-1], np.roll(points, 17, axis=0)):
            assert np.allclose(outlines.fit_plane(other).matrix, plane.matrix, atol=1e-9)


def test_normal_points_up_or_to_the_front():
    for rotation in rotations(300):
        normal = outlines.fit_plane(bean() @ rotation.T).axes[2]
        assert normal[2] > 0.1 or (abs(normal[2]) <= 0.1 and (normal[1] < -0.1 or normal[0] > 0))


@pytest.mark.parametrize("tilt", [1e-8, -1e-8, 1e-3, -1e-3, 0.05, -0.05])
def test_normal_of_a_nearly_vertical_plane_stays_in_front(tilt):
    points = on_plane(bean(), (1, 0, 0), (0, np.sin(tilt), np.cos(tilt)))
    assert outlines.fit_plane(points).axes[2][1] < -0.99


def test_close_joins_ends_that_come_together():
    points = circle(60, turn=6.0, closed=False)[:, :2]
    closed, gap = outlines.close(points, 0.2)
    assert np.array_equal(closed, points)
    assert np.isclose(gap, 2 * np.sin(np.pi - 3.0))


def test_close_cuts_overshoot_at_the_crossing():
    loop = np.array([[0, 0], [4, 0], [4, 4], [0, 4], [0, 0.5], [0.5, -0.5]], float)
    closed, gap = outlines.close(loop, 0.3)
    assert gap == 0
    assert np.allclose(closed, [[0.25, 0], [4, 0], [4, 4], [0, 4], [0, 0.5]])


def test_close_keeps_a_long_tail_that_is_longer_than_the_tolerance():
    loop = np.array([[0, 0], [4, 0], [4, 4], [0, 4], [0, 0.5], [0.5, -3.5]], float)
    with pytest.raises(outlines.OpenError):
        outlines.close(loop, 0.1)


def test_close_of_a_dense_stroke_stays_small_and_exact():
    t = np.linspace(0, 6.6, 20_000)
    spiral = np.stack([(1 + 0.002 * t) * np.cos(t), (1 + 0.002 * t) * np.sin(t)], axis=1)
    closed, gap = outlines.close(spiral, 0.3)
    assert gap < 0.02
    assert len(closed) > 18_000


def test_nest_by_even_odd_rule():
    radii = [1, 5, 3, 2]
    sketches = [outlines.prepare(stroke(circle(radius=r), index=i), 0.2) for i, r in enumerate(radii)]
    apart = outlines.prepare(stroke(at(circle(), 20, 0, 0), index=4), 0.2)
    other_layer = outlines.prepare(stroke(circle(radius=0.5), index=0, layer="Other"), 0.2)
    above = outlines.prepare(stroke(at(circle(radius=0.7), 0, 0, 3), index=5), 0.2)
    outer, notes = nesting.nest([*sketches, apart, other_layer, above])
    assert [(s.stroke.index, [h.stroke.index for h in s.holes]) for s in outer] == [
        (1, [2]),
        (3, [0]),
        (4, []),
        (0, []),
        (5, []),
    ]
    assert not notes


def test_outlines_that_cross_are_bodies_of_their_own():
    large = outlines.prepare(stroke(circle(radius=3)), 0.2)
    over_the_rim = outlines.prepare(stroke(at(circle(), 2.5, 0, 0), index=1), 0.2)
    inside = outlines.prepare(stroke(at(circle(), -1, 0, 0), index=2), 0.2)
    beside = outlines.prepare(stroke(at(circle(), 4.5, 0, 0), index=3), 0.2)
    outer, notes = nesting.nest([large, over_the_rim, inside, beside])
    assert [sketch.stroke.index for sketch in outer] == [0, 1, 3]
    assert [hole.stroke.index for hole in large.holes] == [2]
    assert notes == ["'Drawing', layer 'Lines', stroke 2 of 9: it crosses stroke 1 and is no hole in it"]


def test_a_concave_outline_around_another_is_no_nesting():
    """The first point of a C lies outside the ring in its mouth, and the other way round."""
    angle = np.linspace(0.4, 2 * np.pi - 0.4, 60)
    arcs = [np.column_stack([r * np.cos(a), r * np.sin(a), 0 * a]) for r, a in ((3, angle), (2, angle[::-1]))]
    mouth = outlines.prepare(stroke(np.concatenate(arcs)), 0.2)
    ring = outlines.prepare(stroke(circle(radius=1.5), index=1), 0.2)
    outer, notes = nesting.nest([mouth, ring])
    assert len(outer) == 2
    assert not notes


def test_holes_reach_the_module_in_the_plane_of_their_outline(monkeypatch):
    tilted = [
        on_plane(points, (1, 0, 0), (0, 0.6, 0.8)) for points in (circle(radius=3), at(circle(), 1, 0, 0))
    ]
    strokes = [stroke(points, index=i) for i, points in enumerate(tilted)]
    sketches, failures, notes = api.sketches_of(strokes, close_gaps=0.2, holes=True)
    assert not failures
    assert not notes
    seen = []

    class Module:
        __version__ = api.NATIVE_VERSION

        class GridMeshError(ValueError):
            kind = "hole_misplaced"

        map_sketches = inflate = flat = None

        @classmethod
        def mesh_sketch(cls, outline, holes, **options):
            seen.append((outline, holes))
            raise cls.GridMeshError("holes are not supported")

    monkeypatch.setitem(sys.modules, "gridmesh", Module)
    bodies, failures = api.build(sketches, {}, {})
    assert not bodies
    assert str(failures[0]) == "'Drawing', layer 'Lines', stroke 1 of 9: holes are not supported"
    ((outline, (hole,)),) = seen
    assert np.allclose(np.linalg.norm(outline, axis=1), 3)
    assert np.allclose(np.linalg.norm(hole - [1, 0], axis=1), 1)


def test_contains():
    outline = bean()[:, :2]
    assert nesting.contains(outline, np.zeros(2))
    assert not nesting.contains(outline, np.array([3.0, 0.0]))


def test_suggested_edge_length():
    sketch = outlines.prepare(stroke(circle(400)), 0.2)
    length = api.suggested_edge_length([sketch], 2000)
    assert np.isclose(2000 * length**2 * np.sqrt(3) / 4, np.pi, rtol=1e-3)
    assert api.suggested_edge_length([], 2000) is None


def test_bezier_passes_through_its_points_and_along_its_handles():
    k = 4 / 3 * np.tan(np.pi / 8)
    points = circle(4)
    tangent = np.column_stack([-points[:, 1], points[:, 0], points[:, 2]]) * k
    sampled = sampling.bezier(points, points - tangent, points + tangent, True, 16)
    assert len(sampled) == 64
    assert np.abs(np.linalg.norm(sampled, axis=1) - 1).max() < 3e-4
    opened = sampling.bezier(points, points - tangent, points + tangent, False, 16)
    assert len(opened) == 49
    assert np.array_equal(opened[-1], points[-1])


def test_catmull_rom_passes_through_its_points():
    points = bean(9)
    for cyclic in (True, False):
        sampled = sampling.catmull_rom(points, cyclic, 8)
        assert np.allclose(sampled[::8][: len(points)], points)


def test_nurbs_of_degree_one_is_the_polygon_and_clamped_ends_are_met():
    points, weights = bean(9), np.ones(9)
    assert np.allclose(sampling.nurbs(points, weights, True, 2, 0, 1), points)
    clamped = sampling.nurbs(points, weights, False, 4, 1, 10)
    assert np.allclose(clamped[[0, -1]], points[[0, -1]])


def test_nurbs_with_weights_is_an_exact_arc():
    """A quarter of it: three control points, the middle one with weight 1 / sqrt(2)."""
    square = np.array([[1, 0], [1, 1], [0, 1]], float)
    points = np.column_stack([square, np.zeros(3)])
    sampled = sampling.nurbs(points, np.array([1, np.sqrt(0.5), 1]), False, 3, 1, 20)
    assert np.allclose(np.linalg.norm(sampled, axis=1), 1)


def test_nurbs_with_other_knots_is_refused():
    with pytest.raises(sampling.SamplingError, match="set the curve type to Poly or Bezier"):
        sampling.nurbs(bean(9), np.ones(9), True, 4, 2)


def test_polylines():
    edges = np.array([[5, 6], [0, 1], [1, 2], [2, 0], [6, 7], [3, 4]])
    lines = sampling.polylines(edges)
    assert [(line.tolist(), closed) for line, closed in lines] == [
        ([0, 1, 2], True),
        ([3, 4], False),
        ([5, 6, 7], False),
    ]
    with pytest.raises(sampling.SamplingError, match="branch"):
        sampling.polylines(np.array([[0, 1], [1, 2], [1, 3]]))
    assert sampling.polylines(np.zeros((0, 2), int)) == []
