"""The body of a patch that is its own mirror image is one too."""

import gridmesh
import numpy as np
import pytest


def wave(n: int) -> np.ndarray:
    """A closed curve, symmetric to the x axis, with the image of point k at n - k."""
    t = np.arange(n // 2 + 1) * 2 * np.pi / n
    r = 1 + 0.3 * np.cos(3 * t) + 0.1 * np.cos(5 * t)
    half = np.column_stack([r * np.cos(t), r * np.sin(t)])
    half[[0, -1], 1] = 0
    return np.vstack([half, half[-2:0:-1] * [1, -1]])


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    """Points turned around the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def off(positions: np.ndarray) -> float:
    """Greatest distance from the mirror image of a vertex, in the x axis, to the vertex nearest to it."""
    order = np.lexsort(np.round(positions, 6).T)
    image = positions * [1, -1, 1]
    there = np.lexsort(np.round(image, 6).T)
    return float(np.linalg.norm(positions[order] - image[there], axis=1).max())


@pytest.mark.parametrize("profile", ["round", "even", "flat", "peak"])
@pytest.mark.parametrize(("triangles", "angle"), [(1500, 0.0), (700, 0.4)])
def test_the_body_of_a_symmetric_patch_is_symmetric(profile, triangles, angle):
    patch = gridmesh.mesh_sketch(turned(wave(240), angle), mirror="auto", triangles=triangles)
    flat = turned(patch.vertices, -angle)
    assert off(np.column_stack([flat, 0 * flat[:, 0]])) < 1e-9
    body = gridmesh.inflate(patch, depth=0.8, profile=profile)
    assert off(np.column_stack([turned(body.vertices[:, :2], -angle), body.vertices[:, 2]])) < 1e-9
    assert body.report["embedded"]
