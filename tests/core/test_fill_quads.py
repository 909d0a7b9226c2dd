"""Fills of quads keep what they promise, on loops of all kinds."""

from __future__ import annotations

import pickle

import gridmesh
import numpy as np
import pytest
from checks import check_array
from hypothesis import given, settings
from test_fill import NO_FACES, RANDOM_LOOPS, pierced, random_loop, ring, sheet_of_quads, tube
from test_fill_hostile import HOLES, box, volume

pytestmark = pytest.mark.native


def sides_of(fill: gridmesh.Fill) -> np.ndarray:
    """Directed edges of the new faces."""
    faces = [*fill.quads.tolist(), *fill.triangles.tolist()]
    return np.array([(f[k], f[(k + 1) % len(f)]) for f in faces for k in range(len(f))]).reshape(-1, 2)


def check_quad_fill(vertices: np.ndarray, faces: np.ndarray, fill: gridmesh.Fill) -> None:
    """The guarantees that hold for every fill of quads."""
    n, loop = len(vertices), np.asarray(fill.loop)
    check_array(fill.vertices, np.float64, 3)
    check_array(fill.triangles, np.int32, 3)
    check_array(fill.quads, np.int32, 4)
    assert np.isfinite(fill.vertices).all()
    assert len(fill.triangles) == len(loop) % 2, "one triangle for an odd loop, none for an even one"
    assert fill.report["quads"] == len(fill.quads)
    assert fill.report["triangles"] == len(fill.triangles)
    for face in (*fill.quads.tolist(), *fill.triangles.tolist()):
        assert len(set(face)) == len(face)
    used = np.unique(np.r_[fill.quads.ravel(), fill.triangles.ravel()])
    assert set(used[used < n]) == set(loop.tolist()), "the boundary is the loop"
    assert set(used[used >= n]) == set(range(n, n + len(fill.vertices)))

    sides = sides_of(fill)
    directed = {tuple(side) for side in sides.tolist()}
    assert len(directed) == len(sides), "an edge twice in one direction"
    rim = {frozenset(pair) for pair in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)}
    assert {frozenset(side) for side in directed if side[::-1] not in directed} == rim, (
        "each edge of the loop gets one face"
    )
    edges = {frozenset(side) for side in directed}
    assert len(used) - len(edges) + len(fill.quads) + len(fill.triangles) == 1, "a disk"
    after: dict[int, dict[int, int]] = {}
    for face in (*fill.quads.tolist(), *fill.triangles.tolist()):
        for k, v in enumerate(face):
            after.setdefault(v, {})[face[(k + 1) % len(face)]] = face[k - 1]
    for v, fan in after.items():
        starts = fan.keys() - set(fan.values())
        assert len(starts) == (v < n), f"vertex {v} is not manifold"
        at, steps = (starts.pop() if starts else next(iter(fan))), 0
        while at in fan and steps < len(fan):
            at, steps = fan[at], steps + 1
        assert steps == len(fan), f"vertex {v} has more than one fan"

    inner = edges - rim
    old = {frozenset((int(a), int(b))) for f in faces for a, b in zip(f, np.roll(f, -1), strict=True)}
    assert not (inner & old), "a new edge repeats an old one"
    assert not {frozenset(f) for f in fill.triangles.tolist()} & {frozenset(f.tolist()) for f in faces}
    if len(faces) and not fill.report["winding_conflicts"]:
        there = {(int(a), int(b)) for f in faces for a, b in zip(f, np.roll(f, -1), strict=True)}
        assert not (directed & there), "wound against the neighbours"


def corners(vertices: np.ndarray, fill: gridmesh.Fill) -> np.ndarray:
    """Corners (q, 4) of the quads, in degrees."""
    points = np.r_[vertices, fill.vertices][fill.quads]
    back, ahead = np.roll(points, 1, axis=1) - points, np.roll(points, -1, axis=1) - points
    cross = np.linalg.norm(np.cross(ahead, back), axis=2)
    return np.degrees(np.arctan2(cross, (ahead * back).sum(axis=2)))


@pytest.mark.parametrize("n", [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 17, 32, 61])
@pytest.mark.parametrize("smooth", ["flat", "tangent", "curvature"])
def test_every_number_of_edges_is_filled(n: int, smooth: str) -> None:
    vertices, faces = tube(n)
    fill = gridmesh.fill_hole(vertices, faces, np.arange(n), smooth=smooth, cells="quads")
    check_quad_fill(vertices, faces, fill)
    assert fill.report["self_intersections"] == 0
    assert not fill.report["folded"]
    if smooth == "flat":
        assert np.abs(fill.vertices[:, 2]).max(initial=0) < 1e-12
    elif len(fill.vertices):
        assert (fill.vertices[:, 2] > -1e-3).all(), "it bulges outwards"


def test_the_grid_goes_on_through_the_loop() -> None:
    """A square hole of a sheet of quads gets the quads that were there."""
    for cut in (np.zeros(144, bool), np.ones(144, bool)):
        vertices, faces, loop, polygons = sheet_of_quads(cut)
        fill = gridmesh.fill_hole(vertices, faces, loop, polygons=polygons, cells="quads")
        check_quad_fill(vertices, faces, fill)
        assert len(fill.quads) == 16
        assert fill.report["irregular"] == fill.report["irregular_loop"] == 0
        assert np.abs(corners(vertices, fill) - 90).max() < 1
        assert np.abs(fill.vertices - np.round(fill.vertices)).max() < 1e-2


@pytest.mark.parametrize("n", [10, 16, 24, 48, 11, 25])
def test_round_loops_have_good_corners(n: int) -> None:
    fill = gridmesh.fill_hole(ring(n), NO_FACES, np.arange(n), cells="quads")
    check_quad_fill(ring(n), NO_FACES, fill)
    found = corners(ring(n), fill)
    assert found.min() > 35
    assert found.max() < 150
    assert fill.report["min_angle"] == pytest.approx(np.radians(found.min()), abs=0.6)


def wavy_sheet(seed: int, n: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """An uneven sheet of triangles in waves, with an oval hole."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    start, rate = rng.uniform(0, np.pi, 2), rng.uniform(0.3, 0.6, 2)
    z = 1.2 * np.sin(rate[0] * x + start[0]) * np.cos(rate[1] * y + start[1])
    vertices = np.c_[x.ravel(), y.ravel(), z.ravel()]
    vertices[:, :2] += rng.uniform(-0.25, 0.25, (len(vertices), 2))
    low = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    a, b, c, d = low, low + n + 1, low + n + 2, low + 1
    one = rng.random(n * n)[:, None] < 0.5
    faces = np.r_[
        np.where(one, np.c_[a, b, c], np.c_[a, b, d]), np.where(one, np.c_[a, c, d], np.c_[b, c, d])
    ]
    from_centre = vertices[faces].mean(axis=1)[:, :2] - n / 2
    return vertices, faces[(from_centre / [4.2, 3.0]) ** 2 @ [1, 1] >= 1]


def seam(vertices: np.ndarray, faces: np.ndarray, fill: gridmesh.Fill) -> float:
    """Mean squared angle across the loop, in degrees; quads are cut from the corner that is named first."""
    new = np.r_[fill.quads[:, :3], fill.quads[:, [0, 2, 3]], fill.triangles]
    points = np.r_[vertices, fill.vertices]
    normal: dict[tuple[int, int], np.ndarray] = {}
    for face in (*faces.tolist(), *new.tolist()):
        a, b, c = points[face]
        across = np.cross(b - a, c - a)
        for k in range(3):
            normal[face[k], face[k - 2]] = across / np.linalg.norm(across)
    loop = fill.loop.tolist()
    cosines = [normal[pair] @ normal[pair[::-1]] for pair in zip(loop, loop[1:] + loop[:1], strict=True)]
    return float(np.mean(np.degrees(np.arccos(np.clip(cosines, -1, 1))) ** 2))


def test_quads_go_on_as_smoothly_as_triangles() -> None:
    """They are cut along the diagonals that bend the surface least."""
    found = []
    for seed in range(24):
        vertices, faces = wavy_sheet(seed)
        own = []
        for cells in ("quads", "triangles"):
            fill = min(gridmesh.fill_holes(vertices, faces, cells=cells), key=lambda fill: len(fill.loop))
            assert len(fill.loop) < 40, "not the border of the sheet"
            own.append(seam(vertices, faces, fill))
        found.append(own)
    quads, triangles = np.sqrt(np.mean(found, axis=0))
    assert quads < 1.05 * triangles, (quads, triangles)


def narrowing(n: int, square: float, bend: float, long: float) -> tuple[np.ndarray, np.ndarray]:
    """A tube that widens towards its open end; `square` is 2 for an oval one and more for a rounded rectangle."""
    t = 2 * np.pi * np.arange(n) / n
    cos, sin = np.cos(t), np.sin(t)
    radius = (np.abs(cos) ** square + np.abs(sin) ** square) ** (-1 / square)
    step = 7 / n
    rim = np.c_[long * radius * cos, radius * sin, bend * np.cos(2 * t)]
    end = rim * [1 - 0.8 * step, 1 - 0.8 * step, 1] - [0, 0, step]
    a = np.arange(n)
    b = np.roll(a, -1)
    return np.r_[rim, end], np.r_[np.c_[a, a + n, b], np.c_[b, a + n, b + n]]


@pytest.mark.parametrize(
    "shape", [(8, 2, 0.6, 1), (16, 3, 0, 1), (20, 3, 0.3, 1.8), (24, 3, 0, 1.8), (12, 3, 0, 1)]
)
def test_quads_that_are_good_in_the_plane_alone_give_way_to_others(shape: tuple) -> None:
    """Where a patch bulges, a corner at the loop that is wide in the plane may be concave in space."""
    vertices, faces = narrowing(*shape)
    fill = gridmesh.fill_hole(vertices, faces, np.arange(shape[0]), cells="quads")
    check_quad_fill(vertices, faces, fill)
    assert fill.report["folds"] == fill.report["self_intersections"] == 0
    assert fill.report["min_angle"] > np.radians(40)
    assert fill.report["max_angle"] < np.radians(150)


def test_a_sphere_is_restored() -> None:
    vertices, faces = pierced([5 * 24 + 3], rings=4)
    for smooth, limit in [("flat", 1.0), ("tangent", 0.07), ("curvature", 0.07)]:
        (fill,) = gridmesh.fill_holes(vertices, faces, smooth=smooth, cells="quads")
        check_quad_fill(vertices, faces, fill)
        assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < limit, smooth


def test_direction_and_start_of_the_loop_only_turn_the_faces() -> None:
    vertices, faces = tube(14)
    loop = np.arange(14)
    fill = gridmesh.fill_hole(vertices, faces, loop, cells="quads")
    back = gridmesh.fill_hole(vertices, faces, loop[::-1], cells="quads")
    assert np.array_equal(np.sort(fill.vertices, axis=0), np.sort(back.vertices, axis=0))
    again = gridmesh.fill_hole(vertices, faces, loop, cells="quads")
    assert fill.vertices.tobytes() == again.vertices.tobytes()
    assert fill.quads.tobytes() == again.quads.tobytes()


def test_edges_of_the_mesh_are_not_repeated() -> None:
    """Around a tetrahedron's face, and a cube's, all edges between the loop's vertices are there."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    fill = gridmesh.fill_hole(vertices, faces[1:], [0, 1, 2], cells="quads")
    check_quad_fill(vertices, faces[1:], fill)
    flat = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    sides = np.array([[0, 1, 2], [0, 2, 3]])
    fill = gridmesh.fill_hole(flat, sides, [0, 1, 2, 3], cells="quads")
    check_quad_fill(flat, sides, fill)
    assert len(fill.quads) == 5
    for n in range(5, 12):
        loop = ring(n)
        fan = np.array([[0, k, k + 1] for k in range(1, n - 1)])
        fill = gridmesh.fill_hole(loop, fan, np.arange(n), cells="quads")
        check_quad_fill(loop, fan, fill)


@pytest.mark.parametrize("name", HOLES)
def test_hard_edges_go_on_in_quads(name: str) -> None:
    """The cut-off corner, edge or side of a cube is whole again."""
    vertices, faces = box()
    gone, count = HOLES[name]
    faces = faces[~gone(vertices[faces].mean(axis=1))]
    (fill,) = gridmesh.fill_holes(
        vertices, faces, sharp=np.radians(30), cells="quads", polygons=np.arange(len(faces)) // 2
    )
    check_quad_fill(vertices, faces, fill)
    assert (fill.report["creases"], fill.report["creases_kept"]) == (count, count)
    edges = {frozenset(side) for side in sides_of(fill).tolist()}
    assert all(frozenset(edge) in edges for edge in fill.creases.tolist())
    quads = np.r_[fill.quads[:, :3], fill.quads[:, [0, 2, 3]]]
    whole = volume(np.r_[vertices, fill.vertices], np.r_[faces, quads, fill.triangles])
    assert np.isclose(whole, 512, rtol=1e-9)


def test_a_fill_of_quads_survives_pickling_and_follows_the_mesh() -> None:
    vertices, faces, loop, _ = sheet_of_quads(np.zeros(144, bool))
    vertices[:, 2] = np.sin(vertices[:, 0])
    for way in (loop, loop[::-1], np.delete(loop, 3)):
        fill = gridmesh.fill_hole(vertices, faces if len(way) == len(loop) else NO_FACES, way, cells="quads")
        again = pickle.loads(pickle.dumps(fill))
        for name in ("loop", "vertices", "triangles", "quads"):
            assert getattr(again, name).tobytes() == getattr(fill, name).tobytes()
        assert again.report == fill.report
        moved = vertices * [1.0, 1.1, 0.7]
        assert again.refit(moved).tobytes() == fill.refit(moved).tobytes()
        assert np.abs(fill.refit(vertices) - fill.vertices).max() < 1e-12
        values = np.c_[vertices[way][:, :1], np.ones(len(way))]
        inside = fill.extend(values)
        assert inside[:, 0].min() >= values[:, 0].min()
        assert inside[:, 0].max() <= values[:, 0].max()
        assert np.abs(inside[:, 1] - 1).max() < 1e-12


def test_a_region_is_replaced_by_quads_on_its_own_surface() -> None:
    vertices, faces, _, polygons = sheet_of_quads(np.zeros(144, bool))
    vertices[:, 2] = np.sin(vertices[:, 0]) * np.cos(vertices[:, 1])
    chosen = np.flatnonzero((vertices[faces].mean(axis=1)[:, :2] < 3.9).all(axis=1))
    done = gridmesh.regrid(vertices, faces, chosen, cells="quads", polygons=polygons)
    check_quad_fill(vertices, np.delete(faces, chosen, axis=0), done.fill)
    assert done.off < 1e-9
    assert len(done.fill.quads) == 16
    at = (vertices[faces[done.source_faces]] * done.source_weights[..., None]).sum(axis=1)
    assert np.abs(at - done.fill.vertices).max() < 1e-9


def test_unknown_cells_are_refused() -> None:
    with pytest.raises(gridmesh.GridMeshError, match="'triangles' or 'quads'"):
        gridmesh.fill_hole(ring(8), NO_FACES, np.arange(8), cells="hexagons")
    with pytest.raises(TypeError, match="cells"):
        gridmesh.fill_hole(ring(8), NO_FACES, np.arange(8), cells=4)


@settings(max_examples=80, deadline=None)
@given(**RANDOM_LOOPS)
def test_random_loops(n: int, seed: int, rough: float, wild: bool, smooth: str) -> None:
    vertices, faces = random_loop(n, seed, rough, wild)
    loop = vertices[:n]
    fill = gridmesh.fill_hole(vertices, faces, np.arange(n), smooth=smooth, cells="quads")
    check_quad_fill(vertices, faces, fill)
    size = np.ptp(loop, axis=0).max()
    if len(fill.vertices):
        assert np.abs(fill.vertices - loop.mean(axis=0)).max() < 20 * size


def test_holes_that_touch_are_closed_together() -> None:
    """Fills of one call that share two vertices do not repeat each other's edges."""
    vertices, faces = pierced([3 * 24 + 2, 3 * 24 + 6, 8 * 24 + 11], rings=3)
    fills = gridmesh.fill_holes(vertices, faces, cells="quads")
    seen: set[frozenset[int]] = set()
    for fill in fills:
        check_quad_fill(vertices, faces, fill)
        rim = zip(fill.loop.tolist(), np.roll(fill.loop, -1).tolist(), strict=True)
        own = {frozenset(side) for side in sides_of(fill).tolist()} - {frozenset(pair) for pair in rim}
        own = {edge for edge in own if max(edge) < len(vertices)}
        assert not own & seen
        seen |= own


def test_a_quad_around_the_hole_with_a_diagonal_across_the_loop_is_no_part_of_the_patch() -> None:
    """Both the patch and what lies around it have an edge between the same vertices of the loop: few quads, bent as finer ones, ended in a panic."""
    at = [(4, 8), (4, 9), (5, 7), (5, 8), (6, 7), (6, 8), (6, 9), (7, 6), (7, 7), (7, 8), (8, 4)]
    at += [(8, 5), (8, 6), (8, 7), (9, 3), (9, 4), (9, 5), (9, 6), (9, 7), (9, 8), (10, 5), (10, 7)]
    plane = np.array(at, dtype=float)
    heights = 0.5 * np.sin(0.55 * plane[:, 0] - 3.5) * np.cos(0.35 * plane[:, 1] - 2.5)
    vertices = np.column_stack([plane, heights])
    faces = [[11, 16, 12], [12, 17, 13], [16, 20, 17], [18, 21, 19], [11, 12, 7], [12, 13, 8], [14, 15, 10]]
    faces = np.array([*faces, [17, 18, 13]])
    loop = [0, 1, 3, 5, 6, 9, 8, 13, 18, 17, 12, 16, 11, 7, 4, 2]
    for polygons in ([0, 0, 1, 1, 2, 2, 3, 3], [0, 1, 2, 3, 4, 5, 6, 1]):
        fill = gridmesh.fill_hole(
            vertices, faces, loop, smooth="curvature", cells="quads", polygons=np.array(polygons)
        )
        check_quad_fill(vertices, faces, fill)
