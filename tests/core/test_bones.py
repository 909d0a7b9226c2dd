"""Weights of flat meshes for bones: a partition, smooth, within the drawing, and bends fold little."""

import gridmesh
import numpy as np
import pytest

TWO = [[[0, 1], [8, 1]], [[8, 1], [16, 1]]]


def bar(length=16.0, width=2.0, triangles=500):
    return gridmesh.mesh_sketch([[0, 0], [length, 0], [length, width], [0, width]], triangles=triangles)


def comb():
    """Two fingers, 1 wide and .3 apart, on a palm."""
    outline = [[0, 0], [2.3, 0], [2.3, 9], [1.3, 9], [1.3, 2], [1, 2], [1, 9], [0, 9]]
    bones = [[[1.15, 0.2], [1.15, 1.6]], [[0.5, 2], [0.5, 5]], [[0.5, 5], [0.5, 8.8]], [[1.8, 2], [1.8, 8.8]]]
    return gridmesh.mesh_sketch(outline, triangles=1500), bones


def bent(points, weights, turns, pivots):
    """Points where bones that turn around pivots take them, linearly blended."""
    moved = np.zeros_like(points)
    for column, (turn, pivot) in enumerate(zip(turns, pivots, strict=True)):
        c, s = np.cos(turn), np.sin(turn)
        moved += weights[:, column, None] * ((points - pivot) @ [[c, s], [-s, c]] + pivot)
    return moved


def folded(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    (x, y), (u, v) = (b - a).T, (c - a).T
    return int((x * v <= y * u).sum())


def is_partition(weights, most=4):
    assert np.abs(weights.sum(axis=1) - 1).max() < 1e-12
    assert weights.min() >= 0
    assert ((weights > 0).sum(axis=1) <= most).all()


def test_weights_pass_from_bone_to_bone_over_the_width_of_the_limb():
    patch = bar()
    weights = gridmesh.bone_weights(patch.vertices, patch.triangles, TWO)
    is_partition(weights)
    x = patch.vertices[:, 0]
    assert weights[x < 4, 0].min() > 0.97
    assert weights[x > 12, 1].min() > 0.97
    middle = weights[np.abs(x - 8) < 0.2, 0]
    assert 0.3 < middle.min() < middle.max() < 0.7
    edges = np.concatenate([patch.triangles[:, [k, k - 1]] for k in range(3)])
    assert np.abs(weights[edges[:, 0]] - weights[edges[:, 1]]).max() < 0.3


@pytest.mark.parametrize("degrees", [30, 60, -60])
def test_a_limb_bends_without_folds(degrees):
    patch = bar()
    weights = gridmesh.bone_weights(patch.vertices, patch.triangles, TWO)
    moved = bent(patch.vertices, weights, [0, np.radians(degrees)], [[0, 0], [8, 1]])
    assert folded(moved, patch.triangles) == 0


def test_no_bone_has_a_hold_on_the_finger_beside_its_own():
    patch, bones = comb()
    weights = gridmesh.bone_weights(patch.vertices, patch.triangles, bones)
    is_partition(weights)
    x, y = patch.vertices.T
    left, right = (x < 1.01) & (y > 5), (x > 1.29) & (y > 5)
    assert left.sum() > 50 < right.sum()
    assert weights[left, 3].max() < 1e-3
    assert weights[right, 1:3].max() < 1e-3


def test_a_part_without_a_bone_follows_the_nearest_as_a_whole():
    patch = bar(triangles=200)
    away = patch.vertices * 0.1 + [15, 3]
    points = np.concatenate([patch.vertices, away])
    triangles = np.concatenate([patch.triangles, patch.triangles + len(away)])
    weights = gridmesh.bone_weights(points, triangles, TWO)
    assert (weights[len(away) :] == [0, 1]).all()
    assert weights[: len(away)] == pytest.approx(
        gridmesh.bone_weights(patch.vertices, patch.triangles, TWO), abs=1e-12
    )


def test_no_more_bones_than_asked_for():
    patch = bar(6, 6)
    ends = np.column_stack([np.cos(np.arange(8)), np.sin(np.arange(8))]) * 2 + 3
    bones = [[[3, 3], end] for end in ends]
    for most in (1, 2, 4):
        is_partition(gridmesh.bone_weights(patch.vertices, patch.triangles, bones, most=most), most)


def test_turned_around_and_enlarged_the_weights_are_the_same():
    patch = bar()
    weights = gridmesh.bone_weights(patch.vertices, patch.triangles, TWO)
    turn = 1000 * np.array([[np.cos(1), np.sin(1)], [-np.sin(1), np.cos(1)]])
    other = gridmesh.bone_weights(patch.vertices @ turn, patch.triangles[:, ::-1], np.array(TWO) @ turn)
    assert other == pytest.approx(weights, abs=1e-6)
    again = gridmesh.bone_weights(patch.vertices, patch.triangles, TWO)
    assert again.tobytes() == weights.tobytes()


def test_hostile_meshes_and_bones():
    points, triangles = [[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]
    one = [[[0, 0], [1, 0]]]
    for given, kind in (
        ((points, triangles, []), "invalid_option"),
        (([[0, 0], [1, np.nan], [0, 1]], triangles, one), "not_finite"),
        ((points, triangles, [[[0, 0], [np.inf, 0]]]), "not_finite"),
        ((points, [[0, 1, 3]], one), "index_out_of_range"),
        ((points, [[0, 1, -1]], one), "index_out_of_range"),
        ((points, triangles, [[0, 1], [1, 2]]), "invalid_shape"),
        (([[0, 0, 0]], triangles, one), "invalid_shape"),
    ):
        with pytest.raises(gridmesh.GridMeshError) as caught:
            gridmesh.bone_weights(*given)
        assert caught.value.kind == kind, given
    for option in ({"most": 0}, {"reach": 0.0}, {"reach": np.nan}):
        with pytest.raises(gridmesh.GridMeshError, match="allowed"):
            gridmesh.bone_weights(points, triangles, one, **option)
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.bone_weights(points, triangles, one, progress=lambda _: False)
    assert caught.value.kind == "cancelled"
    # Bones without length, on a corner, flat triangles, vertices without triangles.
    flat = [[0, 0], [1, 0], [2, 0], [5, 5]]
    for bones in ([[[0, 0], [0, 0]]], [[[0, 0], [0, 0]], [[9, 9], [9, 8]]]):
        is_partition(gridmesh.bone_weights(flat, triangles, bones))
        is_partition(gridmesh.bone_weights(points, triangles, bones))
    for bones in (one, TWO):
        assert gridmesh.bone_weights(np.zeros((0, 2)), np.zeros((0, 3), int), bones).shape == (0, len(bones))


def test_where_the_ends_of_a_chain_pull_the_bone_between_does_too():
    """A ring closed by what lies between the first and the last bone: the mean of turns by 0 and 120 degrees shrank that to half, and folded it."""
    turns = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    patch = gridmesh.mesh_sketch(10 * circle, [6 * circle[::-1]], triangles=500)
    chain = np.array([[-8, 0], [-4, 6.9], [4, 6.9], [8, 0]])
    bones = np.stack([chain[:-1], chain[1:]], axis=1)
    weights = gridmesh.bone_weights(patch.vertices, patch.triangles, bones)
    is_partition(weights)
    low = patch.vertices[:, 1] < -6
    even = low & (np.abs(patch.vertices[:, 0]) < 1)
    assert weights[even, 1].min() > 0.35
    assert np.abs(weights[even, 0] - weights[even, 2]).max() < 0.35
    for turn in (-0.5, 0.5, 1.0):
        knee = bent(chain[2:3], np.ones((1, 1)), [turn], [chain[1]])[0]
        points = patch.vertices
        last = bent(points, np.ones((len(points), 1)), [2 * turn], [chain[2]]) + knee - chain[2]
        moved = bent(points, weights[:, :2], [0, turn], [chain[0], chain[1]]) + weights[:, 2:] * last
        assert folded(moved, patch.triangles) == 0, turn
    # Bones that do not touch have none between them.
    apart = np.array([[[-8, 0], [-5, 5]], [[-2, 8], [2, 8]], [[5, 5], [8, 0]]])
    weights = gridmesh.bone_weights(patch.vertices, patch.triangles, apart)
    assert weights[even, 1].max() < 0.1


@pytest.mark.parametrize("degrees", [60, -60])
@pytest.mark.parametrize("aside", [1.5, 2.0])
def test_a_ring_is_bent_without_folds_where_it_is_thin(degrees, aside):
    """A ring that is thinnest across from the joint: heat flows least there, so that weights changed most, and some sixty triangles folded."""
    turns = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    hole = 7 * circle[::-1] - [0, aside]
    patch = gridmesh.mesh_sketch(10 * circle, [hole], triangles=800)
    top = (10 + 7 - aside) / 2
    bones = np.array([[[-8, 0], [0, top]], [[0, top], [8, 0]]])
    weights = gridmesh.bone_weights(patch.vertices, patch.triangles, bones)
    is_partition(weights)
    moved = bent(patch.vertices, weights, [0, np.radians(degrees)], [[0, 0], [0, top]])
    assert folded(moved, patch.triangles) == 0


@pytest.mark.parametrize("scale", [1e-12, 1e12, 1e25])
def test_any_size_has_the_same_weights(scale):
    patch = bar()
    weights = gridmesh.bone_weights(patch.vertices, patch.triangles, TWO)
    scaled = gridmesh.bone_weights(patch.vertices * scale, patch.triangles, np.array(TWO) * scale)
    assert np.abs(scaled - weights).max() < 1e-6


def test_what_is_too_large_says_what_is_allowed():
    patch = bar()
    with pytest.raises(
        gridmesh.GridMeshError, match=r"set of bones is 1\.000e300 across; allowed: "
    ) as caught:
        gridmesh.bone_weights(patch.vertices, patch.triangles, [[[1e300, 0], [0, 0]]])
    assert caught.value.kind == "extreme_size"
    with pytest.raises(gridmesh.GridMeshError, match=r"the mesh is 1.6.*e101 across; allowed: "):
        gridmesh.bone_weights(patch.vertices * 1e100, patch.triangles, TWO)
    with pytest.raises(gridmesh.GridMeshError, match=r"reach is 1e300; allowed: a number from 0.01 to 100"):
        gridmesh.bone_weights(patch.vertices, patch.triangles, TWO, reach=1e300)
