"""`bridge` out of holes in sheets: handles, tunnels, and tubes between surfaces that face each other."""

import pickle
import sys
from pathlib import Path

import gridmesh
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaign"))

from bridges import Case, faults
from holed import ball, followed, rims, sheet, wall, with_holes

pytestmark = pytest.mark.native


def around_z(latitude):
    return np.array([np.cos(np.radians(latitude)), 0, np.sin(np.radians(latitude))])


HANDLES = {
    "wall": (*wall(), [[1, 0, 0.7], [1, 0, -0.7]], 0.3),
    "near each other": (*wall(), [[1, 0, 0.4], [1, 0, -0.4]], 0.3),
    "ball": (*ball(), [around_z(30), around_z(-30)], 0.28),
    "far around a ball": (*ball(), [around_z(37), around_z(-37)], 0.28),
    "plane": (*sheet(lambda x, y: 0 * x), [[-0.8, 0, 0], [0.8, 0, 0]], 0.4),
    "step": (*sheet(lambda x, y: 0.5 + 0.5 * np.tanh(4 * x)), [[-0.8, 0, 0], [0.8, 0, 1]], 0.4),
    "bumps": (*sheet(lambda x, y: 0.15 * np.sin(3 * x) * np.cos(2 * y)), [[-1, -0.3, 0], [1, 0.6, 0]], 0.4),
}
TUNNELS = {
    "corner of a ball": (*ball(), [around_z(45), around_z(-45)], 0.28),
    "bend in a ball": (*ball(), [around_z(60), around_z(-60)], 0.28),
    "through a ball": (ball()[0][:, [2, 0, 1]], ball()[1], [[0, 1, 0], [0, -1, 0]], 0.3),
    "through a lens": (ball()[0][:, [2, 0, 1]] * [1, 0.4, 1], ball()[1], [[0, 0.4, 0], [0, -0.4, 0]], 0.3),
}


def two_balls(gap, tilt):
    """Two balls beside each other, the hole of one turned away from the other by some degrees."""
    vertices, quads = ball()
    vertices = vertices[:, [2, 0, 1]]
    t, centre = np.radians(tilt), np.array([0, 2 + gap, 0])
    hole = centre + [0, -np.cos(t), -np.sin(t)]
    return np.r_[vertices, vertices + centre], np.r_[quads, quads + len(vertices)], [[0, 1, 0], hole], 0.3


FACING = {f"{gap} {tilt}": two_balls(gap, tilt) for gap in (0.6, 1.5, 4) for tilt in (0, 30, 50)}


@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("smooth", ["tangent", "curvature"])
@pytest.mark.parametrize("name", [*HANDLES, *TUNNELS, *FACING])
def test_tubes_leave_holes_in_sheets_smoothly_and_meet_nothing(name, smooth, cells):
    vertices, quads, centres, radius = (HANDLES | TUNNELS | FACING)[name]
    triangles, polygons, loops = with_holes(vertices, quads, centres, radius)
    fill = gridmesh.bridge(vertices, triangles, *loops, polygons=polygons, smooth=smooth, cells=cells)
    case = Case(vertices, triangles, (np.array(loops[0]), np.array(loops[1])), smooth)
    assert not faults(case, fill)
    report = fill.report
    assert (report["self_intersections"], report["folds"], report["winding_conflicts"]) == (0, 0, 0)
    assert report["min_angle"] > np.radians(25 if cells == "quads" else 7)
    # The loops zigzag; where they do not lie in tight arcs the surface goes on nearly flat.
    assert report["rim_angle"] < np.radians(50 if name in TUNNELS else 31)
    again = gridmesh.bridge(vertices, triangles, *loops[::-1], polygons=polygons, smooth=smooth, cells=cells)
    assert (again.report["self_intersections"], again.report["folds"]) == (0, 0)


@pytest.mark.parametrize("smooth", ["flat", "tangent"])
@pytest.mark.parametrize("name", HANDLES)
def test_handles_stand_on_the_outside_of_their_surface(name, smooth):
    vertices, quads, centres, radius = HANDLES[name]
    triangles, polygons, loops = with_holes(vertices, quads, centres, radius)
    fill = gridmesh.bridge(vertices, triangles, *loops, polygons=polygons, smooth=smooth, cells="quads")
    assert fill.report["winding_conflicts"] == 0
    # With a crease around it a handle with hardly any room is too narrow for its corners.
    assert smooth == "flat" or fill.report["self_intersections"] == 0
    middle = np.mean(centres, axis=0)
    out = np.array([0, 0, 1] if name in {"plane", "step", "bumps"} else [1, 0, 0])
    apart = np.linalg.norm(np.subtract(*centres))
    assert ((fill.vertices - middle) @ out).max() > 0.4 * apart
    # There is room under it: no vertex of it comes near the middle between the holes.
    assert np.linalg.norm(fill.vertices - middle, axis=1).min() > 0.25 * (apart - 2 * radius)


def test_a_handle_is_refitted_and_stored():
    vertices, quads, centres, radius = HANDLES["plane"]
    triangles, polygons, loops = with_holes(vertices, quads, centres, radius)
    fill = gridmesh.bridge(vertices, triangles, *loops, polygons=polygons)
    again = pickle.loads(pickle.dumps(fill))
    assert np.abs(again.refit(vertices) - fill.vertices).max() < 1e-9
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    assert np.abs(again.refit(2 * vertices @ turn + 5) - (2 * fill.vertices @ turn + 5)).max() < 1e-6


@pytest.mark.parametrize("island", ["as its surroundings", "turned over"])
def test_a_loop_around_another_one_in_a_sheet_is_no_handle(island):
    vertices, quads = sheet(lambda x, y: 0 * x)
    off = np.linalg.norm(vertices[quads].mean(axis=1), axis=1)
    around, within = quads[off > 1.2], quads[off < 0.5]
    if island == "turned over":
        within = within[:, ::-1]
    triangles = np.concatenate(
        [part[:, pick] for part in (around, within) for pick in ([0, 1, 2], [0, 2, 3])]
    )
    after, off = rims(triangles), np.linalg.norm(vertices, axis=1)
    loops = [followed(after, min(after, key=lambda v: abs(off[v] - radius))) for radius in (0.5, 1.2)]
    fill = gridmesh.bridge(vertices, triangles, *loops)
    assert np.abs(fill.vertices[:, 2]).max() < 1e-9
    assert (fill.report["self_intersections"], fill.report["folds"]) == (0, 0)
    assert (fill.report["winding_conflicts"] > 0) == (island == "turned over")
