"""harmonic: values carried on over a mesh."""

import gridmesh
import numpy as np
import pytest


def sheet(n, bend=0.0):
    """A square of n by n cells, its inner vertices and its height."""
    x, y = (axis.ravel().astype(float) for axis in np.mgrid[0 : n + 1, 0 : n + 1])
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.column_stack([part.ravel() for part in (k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:])])
    triangles = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return np.column_stack([x, y, bend * np.sin(x) * y]), triangles, k[1:-1, 1:-1].ravel()


def test_what_is_linear_around_is_linear_inside():
    vertices, triangles, inner = sheet(12)
    exact = vertices @ np.array([[1.0, -2.0], [0.5, 3.0], [0, 0]])
    values = exact.copy()
    values[inner] = 1e6
    assert np.abs(gridmesh.harmonic(vertices, triangles, inner, values) - exact).max() < 1e-9


@pytest.mark.parametrize("bend", [0.3, 5.0])
def test_values_are_the_weighted_means_of_their_neighbours_and_within_the_rest(bend):
    vertices, triangles, inner = sheet(12, bend)
    values = np.random.default_rng(1).random((len(vertices), 3))
    found = gridmesh.harmonic(vertices, triangles, inner, values)
    fixed = np.setdiff1d(np.arange(len(vertices)), inner)
    assert np.array_equal(found[fixed], values[fixed])
    assert (found[inner] >= values[fixed].min(axis=0)).all()
    assert (found[inner] <= values[fixed].max(axis=0)).all()
    if bend < 1:  # without obtuse triangles nothing is cut off
        flux = np.zeros_like(found)
        for a, b, c in (triangles[:, [k, (k + 1) % 3, (k + 2) % 3]].T for k in range(3)):
            u, v = vertices[a] - vertices[c], vertices[b] - vertices[c]
            cotangent = (u * v).sum(axis=1) / np.linalg.norm(np.cross(u, v), axis=1)
            step = cotangent[:, None] * (found[b] - found[a])
            np.add.at(flux, a, step)
            np.add.at(flux, b, -step)
        assert np.abs(flux[inner]).max() < 1e-9


def test_what_cannot_be_is_refused():
    vertices, triangles, inner = sheet(3)
    values = np.zeros((len(vertices), 1))
    for change, kind in (
        ({"free": [99]}, "index_out_of_range"),
        ({"values": np.full_like(values, np.nan)}, "not_finite"),
        ({"vertices": np.full_like(vertices, np.inf)}, "not_finite"),
        ({"values": values[:3]}, "invalid_shape"),
    ):
        arguments = {"vertices": vertices, "triangles": triangles, "free": inner, "values": values} | change
        with pytest.raises(gridmesh.GridMeshError) as error:
            gridmesh.harmonic(**arguments)
        assert error.value.kind == kind


def test_what_is_out_of_range_is_named():
    corners, triangle = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]
    with pytest.raises(gridmesh.GridMeshError, match="free"):
        gridmesh.harmonic(corners, triangle, [7], [[0], [1], [2]])
