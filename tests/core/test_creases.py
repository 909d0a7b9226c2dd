"""addon/fill/creases.py: which edges are shaded sharp."""

import gridmesh
import numpy as np
import pytest
from sketches import DRAWINGS, circle

from addon.fill.creases import face_angles, rim_creases


def edges_of(triangles):
    """Edges (m, 2), and for each triangle the edges of its sides (t, 3)."""
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges, inverse = np.unique(sides, axis=0, return_inverse=True)
    return edges, inverse.reshape(-1, 3)


def sharp_edges(surface, degrees=40.0):
    edges, sides = edges_of(surface.triangles)
    angle = np.radians(degrees)
    sharp = rim_creases(surface.vertices, surface.triangles, list(surface.silhouette), edges, sides, angle)
    return {tuple(edge) for edge in edges[sharp].tolist()}


def rim_edges(surface):
    for loop in surface.silhouette:
        for pair in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True):
            yield tuple(sorted(pair))


def body(points, triangles, profile):
    return gridmesh.inflate(gridmesh.mesh_sketch(points, triangles=triangles), profile=profile)


def test_angle_of_a_fold():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0.5, 1, 0], [0.5, -np.cos(0.7), np.sin(0.7)]])
    triangles = np.array([[0, 1, 2], [1, 0, 3]])
    edges, sides = edges_of(triangles)
    angles = face_angles(vertices, triangles, len(edges), sides)
    assert np.isclose(angles.max(), 0.7)
    assert np.count_nonzero(angles) == 1
    alone = rim_creases(vertices, triangles, [np.array([0, 1])], edges, sides, 0.5)
    assert not alone.any(), "one edge alone changes no shading"


@pytest.mark.parametrize(
    ("profile", "triangles"), [("round", 60), ("round", 500), ("round", 5000), ("flat", 300), ("flat", 5000)]
)
def test_smooth_bodies_have_none(profile, triangles):
    assert not sharp_edges(body(circle(), triangles, profile))


@pytest.mark.parametrize("name", ["frog", "octopus", "whale"])
def test_drawn_bodies_with_a_round_profile_have_almost_none(name):
    surface = body(DRAWINGS[name]["points"], 4000, "round")
    assert len(sharp_edges(surface)) < 0.05 * len(list(rim_edges(surface)))


@pytest.mark.parametrize("name", ["frog", "octopus", "whale"])
def test_peaked_bodies_are_sharp_along_the_silhouette_and_nowhere_else(name):
    surface = body(DRAWINGS[name]["points"], 4000, "peak")
    sharp, rim = sharp_edges(surface), set(rim_edges(surface))
    assert sharp <= rim
    assert len(sharp) > 0.95 * len(rim)
