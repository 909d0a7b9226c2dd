"""A lattice that stays while an outline is being changed, and outlines that are joined or cut."""

import gridmesh
import numpy as np
import pytest


def blob(n, seed):
    random = np.random.default_rng(seed)
    t = np.arange(n) / n * 2 * np.pi
    r = 1 + sum(0.3 / k * np.cos(k * t + random.uniform(0, 6.28)) for k in (2, 3, 5, 7))
    return np.stack([r * np.cos(t), r * np.sin(t)], axis=1)


def cells(patch):
    """The boundary's lattice points, in quarters of an edge: its path is laid from the turns, which valences tell."""
    sides = np.concatenate(
        [patch.triangles[:, [0, 1]], patch.triangles[:, [1, 2]], patch.triangles[:, [2, 0]]]
    )
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    loop = patch.loops[0]
    turns = 4 - np.bincount(edges.ravel(), minlength=len(patch.vertices))[loop]
    steps = np.exp(1j * np.pi / 3 * np.cumsum(np.append(0, turns[1:])))
    path = np.append(0, np.cumsum(steps)[:-1])
    seen = (patch.vertices[loop] - patch.origin) @ [1, 1j] * np.exp(-1j * patch.angle) / patch.edge_length
    path = min((path * np.exp(1j * np.pi / 3 * k) for k in range(6)), key=lambda path: np.std(seen - path))
    path += np.mean(seen - path)
    row = np.round(path.imag / np.sqrt(0.75))
    column = path.real - row / 2
    column = np.round(column - np.median(column - np.round(column)))
    world = (column + row / 2 + 1j * np.sqrt(0.75) * row) * np.exp(1j * patch.angle)
    at = patch.origin @ [1, 1j] / patch.edge_length + world
    return set(np.round(4 * at).tolist())


def test_the_origin_given_is_a_point_of_the_lattice():
    points = blob(300, 1)
    patch = gridmesh.mesh_sketch(points, edge_length=0.1, angle=0.3, origin=(5.0, -3.0))
    apart = (patch.origin - [5.0, -3.0]) @ [1, 1j] * np.exp(-0.3j) / 0.1
    row = apart.imag / np.sqrt(0.75)
    assert row == pytest.approx(round(row), abs=1e-9)
    assert apart.real - row / 2 == pytest.approx(round(apart.real - row / 2), abs=1e-9)
    assert np.linalg.norm(patch.origin) < 0.5


@pytest.mark.parametrize("sigma", [1, 10])
def test_the_boundary_stays_while_a_point_moves_by_an_edge(sigma):
    changed = []
    for seed in range(8):
        points = blob(500, seed)
        patch = gridmesh.mesh_sketch(points, triangles=2500)
        h, kept = patch.edge_length, {"angle": patch.angle, "origin": patch.origin}
        for at in (37, 237, 400):
            away = np.abs(np.arange(500) - at)
            weight = np.exp(-0.5 * (np.minimum(away, 500 - away) / sigma) ** 2)[:, None]
            outward = points[at] / np.linalg.norm(points[at])
            first, last = (
                cells(gridmesh.mesh_sketch(points + weight * outward * h * move, edge_length=h, **kept))
                for move in (0.0, 1.0)
            )
            changed.append(1 - len(first & last) / len(last))
    assert np.median(changed) <= 0.1


@pytest.mark.parametrize(
    "options", [{"origin": (1e9, 0)}, {"origin": (np.nan, 0)}, {"origin": (0, 0), "mirror": "auto"}]
)
def test_origins_that_are_refused(options):
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.mesh_sketch(blob(100, 2), edge_length=0.2, **options)
    assert caught.value.kind == "invalid_option"


def area(points):
    x, y = np.asarray(points, float).T
    return (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def test_areas_of_what_is_joined_and_cut_add_up():
    one, other = blob(200, 3), blob(150, 4) * 0.6 + [0.9, 0.2]
    (union,), rest = gridmesh.combine(one, other), gridmesh.combine(one, other, how="difference")
    total = area(union[0]) + sum(area(hole) for hole in union[1])
    left = sum(area(outline) + sum(map(area, holes)) for outline, holes in rest)
    assert total == pytest.approx(left + area(other), rel=1e-9)
    assert area(rest[0][0]) == max(area(outline) for outline, _ in rest)
    drawn = {tuple(point) for point in np.round(np.concatenate([one, other]), 9).tolist()}
    assert len([p for p in np.round(union[0], 9).tolist() if tuple(p) not in drawn]) <= 8


def test_nothing_left_is_an_empty_list():
    assert gridmesh.combine(blob(50, 1) * 0.1, blob(50, 1), how="difference") == []
    with pytest.raises(gridmesh.GridMeshError):
        gridmesh.combine(blob(50, 1), [[0, 0], [1, 0], [2, 0]])
