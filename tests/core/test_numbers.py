"""Meshes of pictures have about as many faces as were asked for, and fewer asked for never give more."""

from itertools import pairwise

import numpy as np
import pytest
from rasters import coverage

from addon.pictures.cutouts import Options, cut_out
from addon.pictures.sizes import Made, best, number_of, step_of

SIZE = 128
ASKED = (100, 200, 300, 500, 800)


def ring(radius, waves=0, height=0.0):
    turns = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    radii = radius * (1 + height * np.cos(waves * turns))
    return np.column_stack([np.cos(turns), np.sin(turns)]) * radii[:, None] + SIZE / 2


def star():
    turns = np.arange(10) * np.pi / 5 + 0.2
    return (
        np.column_stack([np.cos(turns), np.sin(turns)]) * np.where(np.arange(10) % 2, 56, 24)[:, None]
        + SIZE / 2
    )


def limbs(width):
    """A disk with five thin limbs."""
    alpha = coverage([ring(18)], SIZE, SIZE)
    for way in np.arange(5) * 2 * np.pi / 5 + 0.4:
        along = np.array([np.cos(way), np.sin(way)])
        across = width / 2 * np.array([-along[1], along[0]])
        bar = np.array([across, -across, 54 * along - across, 54 * along + across]) + SIZE / 2
        alpha = np.maximum(alpha, coverage([bar], SIZE, SIZE))
    return alpha


SIMPLE = {
    "disk": lambda: coverage([ring(50)], SIZE, SIZE),
    "flower": lambda: coverage([ring(45, 5, 0.15)], SIZE, SIZE),
    "block": lambda: coverage([np.array([[20, 24], [108, 30], [100, 96], [28, 104]], float)], SIZE, SIZE),
}
HARD = {
    "star": lambda: coverage([star()], SIZE, SIZE),
    "limbs": lambda: limbs(3.5),
    "thin": lambda: limbs(2.0),
}


def faces(alpha, cells, number, body):
    pixels = np.dstack([np.zeros((SIZE, SIZE, 3)), alpha])
    margin = 0.0 if body else 1.0
    cutout = cut_out(
        pixels,
        Options(threshold=0.5, margin=margin, cover=True, body={} if body else None, **{cells: number}),
    )
    assert not cutout.refused
    given = len(cutout.faces) / (2 if body else 1)
    assert cutout.asked == number
    # Whoever gets many more is told why.
    assert bool(cutout.finer) == (given > 1.2 * number)
    return given


@pytest.mark.parametrize("body", [False, True])
@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("name", SIMPLE)
def test_simple_shapes_get_the_number_asked_for(name, cells, body):
    alpha = SIMPLE[name]()
    for number in ASKED[1:]:
        assert faces(alpha, cells, number, body) == pytest.approx(number, rel=0.2)


@pytest.mark.parametrize("body", [False, True])
@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("name", HARD)
def test_fewer_asked_for_never_give_more(name, cells, body):
    alpha = HARD[name]()
    given = [faces(alpha, cells, number, body) for number in ASKED]
    for fewer, more in pairwise(given):
        # One size of a mesh varies by some faces with the place of the lattice.
        assert fewer <= 1.05 * more


def test_the_best_step_only_rises_with_the_number_asked_for():
    class Surface:
        vertices = ()

    random = np.random.default_rng(0)
    for _ in range(50):
        worth = {step: float(random.choice([0.0, 0.3, 1.0, 3.0])) for step in range(40, 140)}

        def make(step, score, worth=worth):
            made = Made(Surface(), step, {"area": worth[step]})
            return made if made.score < score else None

        found = [best(step_of(number), number, make).step for number in range(100, 1500, 25)]
        assert found == sorted(found)
        for number, step in zip(range(100, 1500, 25), found, strict=True):
            assert step >= step_of(number)
            if worth[step_of(number)] == 0.0:
                assert step == step_of(number)


def test_steps_are_near_every_number():
    for number in range(6, 20_000, 7):
        assert number_of(step_of(number)) == pytest.approx(number, rel=0.065)
    for number in (10, 100, 300, 500, 1000, 2500):
        assert number_of(step_of(number)) == number
