"""Strokes that follow the mouse at a distance."""

import numpy as np
import pytest

from addon.draw.gesture import Gesture
from addon.draw.steady import Steady


def followed(mouse, radius=35.0, factor=0.75):
    """The line that follows the mouse, as a gesture, closed where the mouse is back at its start."""
    steady, gesture = Steady(radius, factor), Gesture(500)
    for pixel in mouse:
        behind = steady.follow(tuple(pixel))
        if behind is not None and gesture.add(behind, np.array(behind), 1.0):
            steady.add(behind)
    left_out, pixels = steady.lap()
    gesture.close(left_out, [(np.array(pixel), None) for pixel in pixels])
    return gesture


def around(turns=1.0, radius=130.0, step=6.0, shake=0.0, start=0.0):
    angles = start + np.arange(0, turns * 2 * np.pi, step / radius)
    radii = radius + shake * np.random.default_rng(1).standard_normal(len(angles))
    return np.column_stack([np.cos(angles), np.sin(angles)]) * radii[:, None]


def turns_of(points):
    """The turning angle at each point of a closed line."""
    along = np.diff(np.vstack([points, points[:2]]), axis=0)
    angles = np.arctan2(along[:, 1], along[:, 0])
    return (np.diff(angles) + np.pi) % (2 * np.pi) - np.pi


def test_a_line_stays_behind_and_is_smoother():
    random = np.random.default_rng(1)
    mouse = np.stack([np.arange(0, 900, 3.0), 40 * random.standard_normal(300)], axis=1)
    line = followed(mouse, 40.0).points
    assert np.abs(line[:, 1]).mean() < 0.7 * np.abs(mouse[:, 1]).mean()
    assert line[-1, 0] < mouse[-1, 0]


@pytest.mark.parametrize("start", [0.0, 1.0, 4.0])
@pytest.mark.parametrize("shake", [0.0, 3.0])
@pytest.mark.parametrize("turns", [0.97, 1.0, 1.03])
@pytest.mark.parametrize("radius", [80.0, 130.0, 250.0])
def test_a_closed_line_has_no_corner_where_it_began(radius, turns, shake, start):
    gesture = followed(around(turns, radius, shake=shake, start=start))
    points = gesture.points
    assert len(gesture.pressures) == len(points)
    radii = np.linalg.norm(points, axis=1)
    assert np.ptp(radii) < 2 + 4 * shake
    assert np.abs(turns_of(points)).max() < 0.4 + 0.2 * shake
    # Around once: no part is drawn twice.
    assert abs(turns_of(points).sum() - 2 * np.pi) < 1e-6
    gaps = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)
    assert gaps.max() < 3 * np.median(gaps)


def test_only_a_line_whose_mouse_is_back_at_its_start_is_closed():
    for mouse in (around(0.8), around(0.5), around(1.0)[:8], around(1.0, radius=20.0)):
        gesture = followed(mouse)
        assert len(gesture.points) == len(gesture)
    line = around(1.0)
    steady = Steady(35.0, 0.75)
    assert steady.lap() == (0, [])
    steady.follow(tuple(line[0]))
    assert steady.lap() == (0, [])


def test_what_closes_a_line_goes_where_the_mouse_goes_on():
    mouse = around(1.0)
    there = followed(mouse)
    assert len(there.points) != len(there)
    on = followed(np.vstack([mouse, mouse[-1] + np.outer(np.arange(1, 40), [0.0, 6.0])]))
    assert len(on.points) == len(on)
