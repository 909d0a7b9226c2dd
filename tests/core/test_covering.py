"""Meshes of pictures cover what is opaque."""

import numpy as np
import pytest
from checks import distance_to_curve
from rasters import coverage, placed, sampled
from sketches import DRAWINGS

from addon.pictures import covering
from addon.pictures.cutouts import Options, cut_out

NAMES = sorted(DRAWINGS)[::3]


def alpha_of(name, size=96):
    return coverage(placed([np.asarray(DRAWINGS[name]["points"], float)], size), size, size)


def sprite(alpha, **options):
    pixels = np.dstack([np.zeros((*alpha.shape, 3)), alpha])
    return cut_out(pixels, Options(threshold=0.5, triangles=400, **options))


def covered_by(cutout, size):
    loops = [cutout.vertices[loop, :2] for loop in cutout.silhouette]
    return sampled(loops, size, size, 8)[::-1].reshape(size, 8, size, 8).mean(axis=(1, 3))


def areas(cutout):
    a, b, c = (cutout.vertices[cutout.faces[:, k], :2] for k in range(3))
    (x, y), (u, v) = (b - a).T, (c - a).T
    return (x * v - y * u) / 2


@pytest.mark.parametrize("name", NAMES)
def test_sprites_cover_opaque_pixels_and_little_else(name):
    alpha = alpha_of(name)
    cutout = sprite(alpha, margin=1.0)
    inside = covered_by(cutout, 96)
    opaque = alpha >= 0.5
    outside = np.maximum(opaque - inside, 0).sum() / opaque.sum()
    assert outside < 0.002
    assert outside < 0.2 * max(
        0.01, np.maximum(opaque - covered_by(sprite(alpha), 96), 0).sum() / opaque.sum()
    )
    assert inside[alpha < 0.02].sum() < 0.09 * inside.sum()
    assert (areas(cutout) > 0).all()


def test_bodies_cover_too_and_stay_closed():
    alpha = alpha_of(NAMES[0])
    cutout = sprite(alpha, margin=1.0, body={})
    edges = np.sort(np.concatenate([cutout.faces[:, [k, k - 1]] for k in range(3)]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    opaque = alpha >= 0.5
    assert np.maximum(opaque - covered_by(cutout, 96), 0).sum() < 0.002 * opaque.sum()


def test_without_a_margin_the_mesh_lies_on_the_outline():
    y, x = np.mgrid[:64, :64] + 0.5 - 32
    cutout = sprite(np.clip(20.5 - np.hypot(x, y), 0, 1), margin=0.0)
    assert np.hypot(*(cutout.vertices[cutout.silhouette[0], :2] - 32).T) == pytest.approx(20, abs=0.1)


def test_what_is_spread_is_nowhere_below_the_need():
    rng = np.random.default_rng(4)
    turns = np.sort(rng.uniform(0, 2 * np.pi, 300))
    contour = covering.dense(np.column_stack([np.cos(turns), np.sin(turns)]), 0.02)
    need = rng.random(len(contour)) * (rng.random(len(contour)) > 0.97)
    assert (covering.spread(contour, need, 0.2) >= need - 1e-12).all()
    out = covering.normals(contour)
    assert np.linalg.norm(out, axis=1) == pytest.approx(np.ones(len(out)))
    assert (np.einsum("ij,ij->i", out, contour) > 0.9).all()


def test_dense_points_lie_on_the_contour():
    square = np.array([[0, 0], [4, 0], [4, 3], [0, 3.0]])
    found = covering.dense(square, 0.7)
    assert distance_to_curve(found, square).max() < 1e-12
    assert np.linalg.norm(np.roll(found, -1, axis=0) - found, axis=1).max() <= 0.7
    assert all((found == corner).all(axis=1).any() for corner in square)
