"""Fills of broken meshes, cancelled ones, and hard edges."""

from __future__ import annotations

import pickle
import sys
import threading
import time
from pathlib import Path

import gridmesh
import numpy as np
import pytest
from checks import edges_of
from test_fill import NO_FACES, check_fill, pierced

sys.path.insert(0, str(Path(__file__).parents[1] / "campaign"))
import arguments
import fills

pytestmark = pytest.mark.native

LOOP = [30, 31, 32, 41, 50, 49, 48, 39]


def two_holes():
    """A sheet with a hole at the left and one at the right, and the loops."""
    n, m = 9, 24
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    gone = lambda a, b: 2 < a < 5 and (2 < b < 5 or 17 < b < 20)  # noqa: E731
    quad = np.array([m * a + b for a in range(n - 1) for b in range(m - 1) if not gone(a, b)])
    faces = np.r_[np.c_[quad, quad + m, quad + 1], np.c_[quad + m, quad + m + 1, quad + 1]]
    vertices = np.c_[i.ravel(), j.ravel(), 0.1 * np.sin(i * j).ravel()].astype(float)
    loops = [fill.loop for fill in gridmesh.fill_holes(vertices, faces, max_edges=20)]
    assert [len(loop) for loop in loops] == [8, 8]
    return vertices, faces, loops


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
class TestNotFinite:
    """Vertices that are not finite spoil the holes near by and nothing else."""

    # The first hole reaches from (3, 3) to (5, 5): on its rim, one ring and two rings away.
    @pytest.mark.parametrize("near", [(3, 3), (2, 3), (1, 4)])
    @pytest.mark.parametrize("smooth", ["flat", "tangent", "curvature"])
    def test_the_loop_near_by_is_refused_alone(self, near, smooth, value):
        vertices, faces, loops = two_holes()
        expected = gridmesh.fill_hole(vertices, faces, loops[1], smooth=smooth)
        bad = 24 * near[0] + near[1]
        vertices[bad, 0] = value
        with pytest.raises(gridmesh.GridMeshError, match=f"point {bad} of the mesh") as caught:
            gridmesh.fill_hole(vertices, faces, loops[0], smooth=smooth)
        assert caught.value.kind == "not_finite"
        for given in (loops, None):
            refused, fill = gridmesh.fill_holes(vertices, faces, given, max_edges=20, smooth=smooth)
            assert refused.kind == "not_finite"
            assert fill.vertices.tobytes() == expected.vertices.tobytes()
            check_fill(vertices, faces, fill)

    @pytest.mark.parametrize("axis", range(3))
    def test_elsewhere_it_does_no_harm(self, axis, value):
        vertices, faces, loops = two_holes()
        expected = gridmesh.fill_holes(vertices, faces, loops)
        for far in [(0, 4), (4, 11), (8, 0)]:
            vertices[24 * far[0] + far[1], axis] = value
        for fill, clean in zip(gridmesh.fill_holes(vertices, faces, loops), expected, strict=True):
            assert fill.vertices.tobytes() == clean.vertices.tobytes()
            assert fill.triangles.tobytes() == clean.triangles.tobytes()
            assert fill.report["self_intersections"] == 0

    def test_regions(self, value):
        vertices, faces, _ = two_holes()
        region = np.flatnonzero(np.isin(faces, 24 * 4 + 11).any(axis=1))
        for inside in (24 * 4 + 11, 24 * 3 + 11, 24 * 4 + 9):
            broken = vertices.copy()
            broken[inside, 1] = value
            for keep in (True, False):
                if inside == 24 * 4 + 11 and not keep:
                    continue
                with pytest.raises(gridmesh.GridMeshError) as caught:
                    gridmesh.regrid(broken, faces, region, keep_shape=keep)
                assert caught.value.kind == "not_finite"
        vertices[0] = value
        assert gridmesh.regrid(vertices, faces, region).off < 1e-9


def test_the_sheet_of_the_report():
    """Once a panic: a NaN two rings from the rim."""
    vertices, faces = arguments.grid()
    vertices[13, 0] = np.nan
    with pytest.raises(gridmesh.GridMeshError, match="point 13 of the mesh is NaN or infinite") as caught:
        gridmesh.fill_hole(vertices, faces, LOOP)
    assert caught.value.kind == "not_finite"


def new_edges(fill):
    """Inner edges of a patch."""
    edges, counts = edges_of(fill.triangles)
    return {tuple(edge) for edge in edges[counts == 2].tolist()}


@pytest.mark.parametrize("kind", [[0, 0, 1], [0, 1, 0], [1, 0, 0]])
def test_edges_of_degenerate_faces_are_not_repeated(kind):
    """Faces (i, i, k) across the hole, between all its vertices but neighbours."""
    vertices, faces = arguments.grid()
    pairs = [[a, b] for k, a in enumerate(LOOP) for b in LOOP[k + 2 : k + 7]]
    more = np.array([[pair[k] for k in kind] for pair in pairs])
    plain = gridmesh.fill_hole(vertices, faces, LOOP)
    fill = gridmesh.fill_hole(vertices, np.r_[faces, more], LOOP)
    check_fill(vertices, faces, fill)
    assert not new_edges(fill) & {tuple(sorted(pair)) for pair in pairs}
    assert len(fill.triangles) > len(LOOP) - 2
    assert (
        gridmesh.fill_hole(vertices, np.r_[faces, [[0, 0, 80]]], LOOP).triangles.tobytes()
        == plain.triangles.tobytes()
    )
    region = np.flatnonzero(np.isin(faces, 11).any(axis=1))
    rim = np.setdiff1d(faces[region], [11])
    more = np.array([[a, a, b] for a in rim for b in rim if a < b])
    done = gridmesh.regrid(vertices, np.r_[faces, more], region)
    check_fill(vertices, np.delete(faces, region, axis=0), done.fill)
    assert not new_edges(done.fill) & {(a, b) for a, _, b in more.tolist()}


class TestProgress:
    """Fractions never fall, cancelling is heard, by the calling thread alone."""

    def runs(self):
        vertices, faces = pierced([100, 160, 220])
        rng = np.random.default_rng(3)
        noise = rng.uniform(-1, 1, (180, 3))
        yield lambda **o: gridmesh.fill_holes(vertices, faces, **o)
        yield lambda **o: gridmesh.fill_holes(noise, NO_FACES, [np.arange(90), np.arange(90, 180)], **o)
        yield lambda **o: gridmesh.fill_hole(noise, NO_FACES, np.arange(180), smooth="flat", **o)
        yield lambda **o: gridmesh.regrid(
            vertices, faces, np.flatnonzero(np.isin(faces, 60).any(axis=1)), **o
        )
        for smooth in ("tangent", "curvature"):
            for fill in gridmesh.fill_holes(vertices, faces, smooth=smooth)[1:3]:
                yield lambda fill=fill, **o: fill.refit(1.5 * vertices, **o)
                yield lambda fill=fill, **o: fill.extend(vertices[fill.loop], **o)

    def test_it_never_falls(self):
        for run in self.runs():
            seen, threads = [], set()

            def listen(fraction, seen=seen, threads=threads):
                seen.append(fraction)
                threads.add(threading.get_ident())

            run(progress=listen)
            assert seen == sorted(seen)
            assert seen[0] >= 0
            assert seen[-1] == 1
            assert threads == {threading.get_ident()}

    @pytest.mark.parametrize("share", [0.0, 0.3, 0.7])
    def test_it_can_be_cancelled(self, share):
        for run in self.runs():
            after = []

            def listen(fraction, after=after):
                if fraction >= share:
                    after.append(fraction)
                    return False
                return True

            with pytest.raises(gridmesh.GridMeshError) as caught:
                run(progress=listen)
            assert caught.value.kind == "cancelled"
            assert len(after) == 1, "asked again"


def test_arrays_may_change_meanwhile():
    """Another thread writes into the arrays: no panic, and the fills are those of the arrays as they were given."""
    vertices, faces, loops = two_holes()
    faces = faces.astype(np.int32)
    expected = [fill.vertices.tobytes() for fill in gridmesh.fill_holes(vertices, faces, loops)]
    stop = threading.Event()
    kept_vertices, kept_faces = vertices.copy(), faces.copy()

    def scribble():
        while not stop.is_set():
            vertices[:], faces[:] = np.nan, 10**6
            vertices[:], faces[:] = kept_vertices, kept_faces
            time.sleep(0)

    writer = threading.Thread(target=scribble)
    writer.start()
    kinds = set()
    try:
        for _ in range(200):
            try:
                items = gridmesh.fill_holes(vertices, faces, loops)
            except gridmesh.GridMeshError as error:
                kinds.add(error.kind)
                continue
            kinds |= {getattr(item, "kind", "filled") for item in items}
    finally:
        stop.set()
        writer.join()
    assert kinds <= {"filled", "not_finite", "index_out_of_range"}
    vertices[:], faces[:] = kept_vertices, kept_faces
    assert [fill.vertices.tobytes() for fill in gridmesh.fill_holes(vertices, faces, loops)] == expected


# ---------------------------------------------------------------- hard edges


def box(n=8, corner=0.0):
    """A closed cube of n by n squares a side, as vertices, faces and the sum that the corner to cut off has."""
    vertices, faces = {}, []
    for axis in range(3):
        for side in (0, n):
            for a in range(n):
                for b in range(n):
                    quad = []
                    for u, v in ((a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1)):
                        point = [u, v]
                        point.insert(axis, side)
                        quad.append(vertices.setdefault(tuple(point), len(vertices)))
                    if (side == n) == (axis == 1):
                        quad.reverse()
                    faces += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
    return np.array(list(vertices), float) + corner, np.array(faces)


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return (a * np.cross(b, c)).sum() / 6


def closed(vertices, faces, fill):
    return np.r_[vertices, fill.vertices], np.r_[faces, fill.triangles]


HOLES = {
    # name: (which faces of a cube of 8 are gone by their middle, hard edges)
    "corner": (lambda m: (m > 5).all(axis=1), 3),
    "edge": (lambda m: (m[:, 0] > 5) & (m[:, 1] > 6) & (abs(m[:, 2] - 4) < 2), 2),
    "whole side": (lambda m: m[:, 2] == 8, 4),
    "side along an edge": (lambda m: (m[:, 2] == 8) & (m[:, 0] > 5) & (abs(m[:, 1] - 4) < 2), 2),
    "side at a corner": (lambda m: (m[:, 2] == 8) & (m[:, 0] > 5) & (m[:, 1] > 5), 3),
}


@pytest.mark.parametrize("name", HOLES)
@pytest.mark.parametrize("turned", [False, True])
def test_hard_edges_go_on(name, turned):
    vertices, faces = box()
    gone, count = HOLES[name]
    assert np.isclose(volume(vertices, faces), 512)
    faces = faces[~gone(vertices[faces].mean(axis=1))]
    if turned:
        rng = np.random.default_rng(2)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        vertices = vertices @ (turn * np.linalg.det(turn)) * 0.01 + 3
    whole = 512 * (1e-6 if turned else 1)
    (fill,) = gridmesh.fill_holes(vertices, faces, sharp=np.radians(30))
    check_fill(vertices, faces, fill)
    report = fill.report
    assert (report["creases"], report["creases_kept"]) == (count, count)
    assert (report["self_intersections"], report["folds"]) == (0, 0)
    assert np.isclose(volume(*closed(vertices, faces, fill)), whole, rtol=1e-9), "the box is whole again"
    inner = {tuple(edge) for edge in edges_of(fill.triangles)[0].tolist()}
    assert len(fill.creases)
    assert all(tuple(sorted(edge)) in inner for edge in fill.creases.tolist())
    assert report["min_angle"] > np.radians(15)
    again = pickle.loads(pickle.dumps(fill))
    assert again.creases.tobytes() == fill.creases.tobytes()
    for one in (fill, again):
        assert one.refit(vertices).tobytes() == fill.vertices.tobytes()
        turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
        assert np.allclose(one.refit(vertices @ turn * 3 + 1), fill.vertices @ turn * 3 + 1, atol=1e-6)
    # Data goes on over the creases.
    assert np.allclose(fill.extend(np.ones(len(fill.loop))), 1)


def test_edges_marked_hard_count_whatever_their_angle():
    vertices, faces = box()
    faces = faces[~(vertices[faces].mean(axis=1) > 5).all(axis=1)]
    (plain,) = gridmesh.fill_holes(vertices, faces)
    (none,) = gridmesh.fill_holes(vertices, faces, sharp=np.pi)
    assert none.report["creases"] == 0
    assert none.vertices.tobytes() == plain.vertices.tobytes()
    on_two_sides = (vertices[faces[:, [0, 1, 2, 0]]] % 8 == 0).sum(axis=2) >= 2
    edges = np.r_[faces[:, :2], faces[:, 1:], faces[:, [2, 0]]]
    marked = edges[((vertices[edges] % 8 == 0).sum(axis=2) >= 2).all(axis=1)]
    assert on_two_sides.any()
    (hard,) = gridmesh.fill_holes(vertices, faces, sharp=np.pi, creases=marked)
    assert hard.report["creases_kept"] == 3


def test_hard_edges_that_do_not_meet_leave_the_patch_smooth():
    vertices, faces = pierced([100])
    (plain,) = gridmesh.fill_holes(vertices, faces)
    loop = set(plain.loop.tolist())
    edges = edges_of(faces)[0]
    into = np.array([edge for edge in edges.tolist() if len(loop & set(edge)) == 1])
    (fill,) = gridmesh.fill_holes(vertices, faces, sharp=3.0, creases=into)
    assert fill.report["creases"] > 0
    assert fill.report["creases_kept"] == 0
    assert not len(fill.creases)
    assert fill.vertices.tobytes() == plain.vertices.tobytes()


def test_the_angle_is_checked():
    vertices, faces = arguments.grid()
    for angle in (-0.1, 4.0, np.nan, np.inf):
        with pytest.raises(gridmesh.GridMeshError, match="sharp") as caught:
            gridmesh.fill_hole(vertices, faces, LOOP, sharp=angle)
        assert caught.value.kind in {"invalid_option", "not_finite"}


# ---------------------------------------------------------------- campaigns, a short run of each


def test_a_loop_as_thin_as_a_needle_leaves_no_vertex_without_a_face():
    """A point of the lattice lay inside by its distance from the walls, outside by the triangulation."""
    case = fills.run(3832, 12_001, "triangles")
    assert case.outcomes == ["filled"]
    assert not case.wrong


@pytest.mark.parametrize("cells", ["triangles", "quads"])
def test_random_holes(cells):
    cases = fills.campaign(150, seed=11, cells=cells)
    assert not [(case.number, case.name, case.wrong) for case in cases if case.wrong]
    assert sum("filled" in case.outcomes for case in cases) > 40


def test_random_arguments():
    for name, (function, given) in arguments.calls().items():
        arguments.call(name, function, dict(given))  # right as they are
    outcomes, wrong, _ = arguments.campaign(300, seed=11)
    assert not wrong
    assert outcomes["result"] > 10
    assert outcomes["TypeError"] > 50
    assert outcomes["invalid_shape"] > 20
