"""Outer borders of flat sheets are told from holes."""

import numpy as np
import pytest
from gridmesh import GridMeshError
from gridmesh import is_outer_border as is_outer


def ring(n=24, slope=0.0, *, hole=False, wide=1.0):
    """A loop, as a patch would run, and where its faces lie: inside, or outside of a hole; `slope` is their angle."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    points = np.c_[np.cos(t), wide * np.sin(t), 0 * t]
    out = np.c_[np.cos(t) * wide, np.sin(t), 0 * t] * (1 if hole else -1)
    return points, 0.1 * (np.cos(slope) * out - np.sin(slope) * np.array([0, 0, 1.0]))


def turned(vectors, seed):
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return vectors @ q.T


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("wide", [1.0, 0.2])
@pytest.mark.parametrize("seed", range(4))
def test_sheets_holes_and_pipes(scale, wide, seed):
    def found(points, faces):
        both = {
            is_outer(scale * turned(points, seed), scale * turned(faces, seed)),
            is_outer(points[::-1] + 3, np.roll(faces[::-1], -1, axis=0)),
        }
        assert len(both) == 1
        return both.pop()

    assert found(*ring(wide=wide))
    assert found(*ring(wide=wide, slope=0.2))
    assert not found(*ring(wide=wide, hole=True))
    assert not found(*ring(wide=wide, slope=np.pi / 2))
    assert not found(*ring(wide=wide, slope=0.8))


def test_the_border_of_a_sheet_with_an_inlet():
    points = np.array(
        [[0, 0, 0], [4, 0, 0], [4, 4, 0], [3, 4, 0], [3, 1, 0], [1, 1, 0], [1, 4, 0], [0, 4, 0]], float
    )
    along = np.roll(points, -1, axis=0) - points
    into = 0.5 * along + 0.1 * np.cross([0, 0, 1], along)
    assert is_outer(points, into)
    assert not is_outer(points, 0.5 * along - 0.1 * np.cross([0, 0, 1], along))


@pytest.mark.parametrize("points", [np.zeros((4, 3)), np.full((4, 3), np.nan), np.full((4, 3), np.inf)])
def test_what_has_no_plane_is_left_to_the_fill(points):
    assert not is_outer(points, np.ones((4, 3)))


def test_wires_have_no_sheet():
    points, faces = ring()
    assert not is_outer(points, 0 * faces)


def test_other_shapes_are_refused():
    points, faces = ring()
    for wrong in (faces[1:], faces[:, :2], faces.ravel()):
        with pytest.raises(GridMeshError, match=r"into .* allowed: ") as refused:
            is_outer(points, wrong)
        assert refused.value.kind == "invalid_shape"
    with pytest.raises(TypeError):
        is_outer(points, "none")
