"""Lines drawn with the mouse, and strokes made ready: numbers only."""

import numpy as np
import pytest
from drawings import circle

from addon.cut import cutsweep, cutting, drawnline

RIGHTWARD = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]])


def test_left_is_above_a_line_to_the_right():
    assert drawnline.on_left(RIGHTWARD, [10, 5])
    assert not drawnline.on_left(RIGHTWARD, [10, -5])


def test_sides_hold_beyond_the_ends():
    bent = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 10.0]])
    assert drawnline.on_left(bent, [-100, 1])
    assert not drawnline.on_left(bent, [-100, -1])
    assert drawnline.on_left(bent, [100, 95])
    assert not drawnline.on_left(bent, [100, 85])


@pytest.mark.parametrize("turn", [1, -1])
def test_inside_a_closed_line_is_left(turn):
    ring = circle(30, 50.0)[::turn, :2]
    ring = np.vstack([ring, ring[:1]])
    assert drawnline.on_left(ring, [3, 4])
    assert not drawnline.on_left(ring, [60, 0])
    near, far = drawnline.band(ring, 10.0, left=True)
    assert (np.linalg.norm(far, axis=1) < np.linalg.norm(near, axis=1)).all()


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("radius", [8.0, 30.0, 200.0])
def test_the_band_within_a_small_closed_line_stays_within(radius, turn):
    ring = circle(40, radius)[::turn, :2]
    ring = np.vstack([ring, ring[:1]])
    _, far = drawnline.band(ring, 56.0, left=True)
    assert np.allclose(far[0], far[-1])
    assert (np.abs(np.linalg.norm(far, axis=1) - max(radius - 56, 0.5 * radius)) < 0.03 * radius).all()
    _, far = drawnline.band(ring, 56.0, left=False)
    assert (np.abs(np.linalg.norm(far, axis=1) - radius - 56) < 1).all()


@pytest.mark.parametrize("left", [True, False])
def test_the_band_of_a_shaky_line_is_not_frayed(left):
    x = np.arange(0.0, 400.0, 2.0)
    y = 60 * np.sin(x / 60) + 3 * np.sin(x / 3)
    near, far = drawnline.band(np.column_stack([x, y]), 80.0, left=left)
    assert np.linalg.norm(far - near, axis=1).min() > 40
    steps = np.diff(far, axis=0)
    ahead = (steps * np.diff(near, axis=0)).sum(axis=1)
    assert ahead.min() > -25, "it runs back"
    lengths = np.linalg.norm(steps, axis=1)
    assert lengths.max() < 12 * np.median(np.linalg.norm(np.diff(near, axis=0), axis=1))


def test_smoothed_line_keeps_its_ends_and_closes():
    rng = np.random.default_rng(3)
    points = np.column_stack([np.arange(200.0), rng.integers(0, 2, 200)])
    line = drawnline.smoothed(points)
    assert np.array_equal(line[[0, -1]], points[[0, -1]])
    assert np.abs(np.diff(line[:, 1])).max() < 0.5
    ring = drawnline.smoothed(circle(100, 80.0)[:, :2])
    assert np.array_equal(ring[0], ring[-1])
    assert np.abs(np.linalg.norm(ring, axis=1) - 80).max() < 1


def test_short_way_back_is_not_closed():
    assert not drawnline.is_closed(np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [0.0, 1.0]]))


@pytest.mark.parametrize("eye", [None, (0.0, -7.0, 1.0)])
def test_seen_and_placed_are_inverse(eye):
    rng = np.random.default_rng(4)
    points = rng.normal(size=(50, 3))
    sweep = cutsweep.Sweep(np.array([0.0, 0.6, 0.8]), None)
    if eye is not None:
        sweep = cutsweep.Sweep(np.array([0.0, 1.0, 0.0]), np.array(eye))
    flat, depth = sweep.seen(points)
    back = np.vstack([sweep.placed(one[None], away) for one, away in zip(flat, depth, strict=True)])
    assert np.allclose(back, points)


def test_right_and_up_are_as_the_front_view_shows_them():
    right, up, away = cutsweep.Sweep.along((0, 1, 0)).frame()
    assert np.allclose(away, (0, 1, 0))
    assert np.allclose(np.cross(right, up), -away)


def test_overshoot_is_cut_off():
    points = circle(60, 1.0, turn=2 * np.pi * 1.02, closed=False)
    points *= np.linspace(1, 1.03, 60)[:, None]
    points = points[:, [0, 2, 1]]
    stroke = cutsweep.checked(points, cyclic=False, sweep=cutsweep.Sweep.along((0, 1, 0)), close_gaps=0.1)
    assert np.array_equal(stroke[0], stroke[-1])


def test_open_stroke_stays_open():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 1], [3, 0, 0]])
    stroke = cutsweep.checked(points, cyclic=False, sweep=cutsweep.Sweep.along((0, 1, 0)), close_gaps=0.1)
    assert np.array_equal(stroke, points)


def test_unrolled_keeps_lengths():
    """A half cylinder, swept along Z: what is a square on it is a square laid out."""
    t = np.linspace(0, np.pi, 400)
    stroke = np.column_stack([np.cos(t), np.sin(t), 0 * t])
    corners = np.array([[np.cos(a), np.sin(a), z] for a, z in ((1.0, 0), (1.5, 0), (1.5, 0.5), (1.0, 0.5))])
    flat = cutsweep.unrolled(corners, stroke, cutsweep.Sweep.along((0, 0, 1)))
    sides = np.linalg.norm(flat - np.roll(flat, 1, axis=0), axis=1)
    assert np.allclose(sides, 0.5, atol=1e-3)


def test_nearest_point_of_triangles():
    triangles = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 5], [1, 0, 5], [0, 1, 5]]], float)
    for point, at, weights in (
        ((0.25, 0.25, 1), 0, (0.5, 0.25, 0.25)),
        ((0.25, -1, 4), 1, (0.75, 0.25, 0)),
        ((2, 2, 0), 0, (0, 0.5, 0.5)),
        ((-1, -1, 0), 0, (1, 0, 0)),
    ):
        found, share = cutting.nearest_point(triangles, np.array(point, float))
        assert found == at
        assert np.allclose(share, weights)
