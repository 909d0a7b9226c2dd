"""Cuts keep what they promise, through the Python face."""

from __future__ import annotations

import doctest
import inspect
import pickle
import sys
from pathlib import Path

import gridmesh
import numpy as np
import pytest
from checks import check_array

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaign"))

import joins
import models

DOWN = [0, 0, -1]

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
ACROSS = np.array([[-1, 0.3, 0], [2, 0.6, 0]])


def torus(n: int = 36, m: int = 18) -> tuple[np.ndarray, np.ndarray]:
    """A closed torus of quads around z."""
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    radius = 2 + 0.8 * np.cos(v)
    vertices = np.stack([radius * np.cos(u), radius * np.sin(u), 0.8 * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")

    def at(i, j):
        return (i % n) * m + j % m

    return vertices, np.stack([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], axis=-1).reshape(
        -1, 4
    )


def circle(x: float, y: float, r: float, n: int = 30) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    ring = np.c_[x + r * np.cos(t), y + r * np.sin(t), 0 * t]
    return np.vstack([ring, ring[:1]])


def open_edges(piece: gridmesh.Piece) -> np.ndarray:
    """Edges without a neighbour; all others have exactly one, wound against them."""
    edges = joins.polygon_sides(piece)
    keys = edges[:, 0] * len(piece.vertices) + edges[:, 1]
    assert len(np.unique(keys)) == len(keys)
    return edges[~np.isin(edges[:, 1] * len(piece.vertices) + edges[:, 0], keys)]


def cap_triangles(piece: gridmesh.Piece) -> np.ndarray:
    caps = np.flatnonzero(piece.source_face < 0)
    return piece.vertices[np.array([piece.corners[piece.offsets[f] : piece.offsets[f + 1]] for f in caps])]


def test_types_and_shapes():
    done = gridmesh.cut(CUBE, QUADS, ACROSS, direction=DOWN)
    assert [piece.side for piece in done.pieces] == ["left", "right"]
    for piece in done.pieces:
        check_array(piece.vertices, np.float64, 3)
        check_array(piece.corners, np.int32, None)
        check_array(piece.offsets, np.int32, None)
        check_array(piece.source_face, np.int32, None)
        check_array(piece.source_vertices, np.int32, 3)
        check_array(piece.source_weights, np.float64, 3)
        assert len(piece.source_face) == len(piece.offsets) - 1
        assert len(piece.source_vertices) == len(piece.source_weights) == len(piece.vertices)
        assert piece.source_vertices.max() < len(CUBE)
        assert np.allclose(piece.source_weights.sum(axis=1), 1)
        for ring in piece.cap_loops:
            check_array(ring, np.int32, None)
    assert all(isinstance(x, int | float | list | dict) for x in done.report.values())


@pytest.mark.parametrize("edge_length", [None, 0.3])
@pytest.mark.parametrize(
    "stroke", [[[-4, 0.3, 0], [0, -0.4, 0], [4, 0.5, 0]], circle(2, 0.1, 0.5), circle(0.1, 0, 2.05)]
)
def test_closed_pieces_with_mirrored_caps(stroke, edge_length):
    vertices, faces = torus()
    done = gridmesh.cut(vertices, faces, stroke, direction=DOWN, edge_length=edge_length)
    for piece in done.pieces:
        assert len(open_edges(piece)) == 0
    left, right = (cap_triangles(piece) for piece in done.pieces)
    assert len(left) == done.report["cap_triangles"] > 0
    reversed_rows = {tuple(sorted(map(tuple, t))) for t in right.tolist()}
    assert {tuple(sorted(map(tuple, t))) for t in left.tolist()} == reversed_rows
    total = done.report["volume"]
    assert abs(sum(done.report["volumes"]) - total) <= (1e-9 if edge_length is None else 1e-2) * total
    if edge_length:
        assert done.report["defect"] <= 0.05 * edge_length


@pytest.mark.parametrize(("x", "y", "radius", "n"), [(2.58, -0.34, 0.05, 3), (2.1, -0.49, 0.12, 4)])
def test_edges_longer_than_a_hole_still_close_it(x, y, radius, n):
    """A line of a few long edges did not run around the sheet, and got no cap."""
    done = gridmesh.cut(*torus(), circle(x, y, radius, n), direction=DOWN, edge_length=2.0)
    assert done.report["uncapped"] == 0
    assert done.report["repeated"] > 0
    for piece in done.pieces:
        assert len(open_edges(piece)) == 0


@pytest.mark.parametrize("radius", [0.1, 0.3])
@pytest.mark.parametrize("edge_length", [None, 0.1])
def test_a_face_with_a_corner_next_to_an_axis_is_divided(radius, edge_length):
    """The triangulation of its parts refuses coordinates below 1e-43."""
    vertices, faces = torus()
    done = gridmesh.cut(
        vertices, faces, circle(2.0, 0.0, radius), direction=DOWN, keep="right", edge_length=edge_length
    )
    (piece,) = done.pieces
    assert len(piece.cap_loops) == 2
    assert not len(open_edges(piece))


def test_faces_on_which_rebuilt_triangles_come_to_lie_are_rebuilt_too():
    """Otherwise the triangles that lie there are dropped, and the piece has a hole."""
    rng = np.random.default_rng(532)
    whale = dict(joins.outlines(None))["whale"]
    body = gridmesh.inflate(gridmesh.mesh_sketch(whale, triangles=3000), depth=0.54)
    vertices = body.vertices + rng.normal(0, 0.01, body.vertices.shape)
    line, direction = models.stroke(rng)
    cut = gridmesh.cut(vertices, body.triangles, line, direction=direction, edge_length=0.1)
    assert not any(len(open_edges(piece)) for piece in cut.pieces)


@pytest.mark.parametrize("smooth", ["flat", "tangent"])
@pytest.mark.parametrize("edge_length", [0.2, 0.23, 0.27, 0.3])
@pytest.mark.parametrize("stroke", [[[-4, 0.3, 0], [0, -0.4, 0], [4, 0.5, 0]], circle(2, 0.1, 0.5)])
def test_caps_of_quads(stroke, edge_length, smooth):
    vertices, faces = torus()
    done = gridmesh.cut(
        vertices, faces, stroke, direction=DOWN, edge_length=edge_length, smooth=smooth, cells="quads"
    )
    report = done.report
    for piece in done.pieces:
        assert len(open_edges(piece)) == 0
        sizes = np.diff(piece.offsets)[piece.source_face < 0]
        assert (sizes == 4).sum() == report["cap_quads"] > 0
        assert (sizes == 3).sum() == report["cap_triangles"]
    assert report["cap_triangles"] % 2 == sum(map(len, done.pieces[0].cap_loops)) % 2
    assert report["cap_triangles"] <= report["caps"]
    assert np.degrees(report["cap_min_angle"]) > 20
    assert sum(report["volumes"]) == pytest.approx(report["volume"], rel=0.01)


def test_the_three_forms_of_faces_agree():
    stroke = ACROSS
    offsets = np.arange(7) * 4
    one = gridmesh.cut(CUBE, QUADS, stroke, direction=DOWN)
    two = gridmesh.cut(CUBE.tolist(), (QUADS.ravel(), offsets), stroke.tolist(), direction=DOWN)
    for a, b in zip(one.pieces, two.pieces, strict=True):
        assert a.vertices.tobytes() == b.vertices.tobytes()
        assert a.corners.tobytes() == b.corners.tobytes()
    triangles = np.vstack([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]]).astype(np.uint16)
    three = gridmesh.cut(CUBE, triangles, stroke, direction=DOWN)
    assert np.allclose(three.report["volumes"], one.report["volumes"])


def test_untouched_faces_keep_their_corners_and_vertices_their_bits():
    vertices, faces = torus()
    done = gridmesh.cut(vertices, faces, [[-4, 0.3, 0], [4, 0.5, 0]], direction=DOWN)
    whole = 0
    for piece in done.pieces:
        sizes = np.diff(piece.offsets)
        own = np.flatnonzero((sizes == 4) & (piece.source_face >= 0))
        corners = piece.corners[piece.offsets[own][:, None] + np.arange(4)]
        assert (piece.source_vertices[corners, 0] == faces[piece.source_face[own]]).all()
        assert (piece.vertices[corners] == vertices[faces[piece.source_face[own]]]).all()
        whole += len(own)
    assert whole + done.report["cut_faces"] == len(faces)


def test_data_can_be_carried_over():
    vertices, faces = torus()
    colour = vertices @ [0.3, -0.2, 0.9]
    done = gridmesh.cut(vertices, faces, [[-4, 0.3, 0], [4, 0.5, 0]], direction=DOWN, cap=False)
    for piece in done.pieces:
        carried = (colour[piece.source_vertices] * piece.source_weights).sum(axis=1)
        assert np.allclose(carried, piece.vertices @ [0.3, -0.2, 0.9])


def test_keep_cap_and_gap():
    both = gridmesh.cut(CUBE, QUADS, ACROSS, direction=DOWN)
    for side, piece in zip(("left", "right"), both.pieces, strict=True):
        one = gridmesh.cut(CUBE, QUADS, ACROSS, direction=DOWN, keep=side)
        assert [p.side for p in one.pieces] == [side]
        assert one.pieces[0].vertices.tobytes() == piece.vertices.tobytes()
    uncapped = gridmesh.cut(CUBE, QUADS, ACROSS, direction=DOWN, cap=False).pieces[0]
    assert len(open_edges(uncapped)) == len(uncapped.cap_loops[0])
    assert (uncapped.source_face >= 0).all()
    apart = gridmesh.cut(CUBE, QUADS, ACROSS, direction=DOWN, gap=0.1).report["volumes"]
    width = 0.1 * np.hypot(3, 0.3) / 3
    assert np.allclose(np.subtract(both.report["volumes"], apart), width / 2)


def test_through_an_eye():
    stroke = [[-1, 0.5, 0.0], [2, 0.5, 0.0]]
    seen = gridmesh.cut(CUBE, QUADS, stroke, eye=[0.5, 0.5, 5])
    assert np.allclose(seen.report["volumes"], [0.5, 0.5])
    # The left of a stroke to the right is up: greater y, seen from above.
    assert seen.pieces[0].vertices[:, 1].min() > 0.49


def smallest_angle(piece: gridmesh.Piece) -> float:
    """In radians, over the triangles."""
    ends = zip(piece.offsets[:-1], piece.offsets[1:], strict=True)
    corners = piece.vertices[[piece.corners[a:b] for a, b in ends if b - a == 3]]
    least = np.inf
    for k in range(3):
        to, other = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        double = np.linalg.norm(np.cross(to, other), axis=1)
        least = min(least, np.arctan2(double, (to * other).sum(axis=1)).min())
    return least


@pytest.mark.parametrize("edge_length", [None, 0.15])
def test_an_edge_on_both_ends_of_which_the_stroke_passes_leaves_no_slivers(edge_length):
    # Seen from the eye the stroke's points and the diagonals of two faces are on one line, but for rounding.
    done = gridmesh.cut(
        2 * CUBE - 1, QUADS, [[1, -1, -1], [1, -1, 1]], eye=[0, 0, -6], edge_length=edge_length
    )
    for piece in done.pieces:
        assert len(open_edges(piece)) == 0
        assert smallest_angle(piece) > 1e-3
    assert done.report["repeated"] == 0


def test_points_on_a_straight_stroke_change_nothing():
    few = np.array([[-4, 0.3, 0], [4, 0.5, 0]])
    many = few[:1] + np.linspace(0, 1, 200)[:, None] * (few[1:] - few[:1])
    vertices, faces = torus()
    one, other = (gridmesh.cut(vertices, faces, stroke, direction=DOWN).report for stroke in (few, many))
    assert one["cap_triangles"] == other["cap_triangles"]
    assert one["cut_faces"] == other["cut_faces"]


def test_the_seam_of_a_small_cap_stays_on_the_swept_surface():
    # Two slices near the top, far smaller than the edges beside them would allow a cut to be moved.
    vertices, faces = torus()
    for height in (2.45, 2.6, 2.75):
        done = gridmesh.cut(
            vertices, faces, [[-4, height, 0], [4, height, 0]], direction=DOWN, edge_length=0.35
        )
        for ring in done.pieces[0].cap_loops:
            seam = done.pieces[0].vertices[ring]
            across = np.linalg.norm(np.ptp(seam, axis=0))
            assert np.abs(seam[:, 1] - height).max() <= 0.02 * across


@pytest.mark.parametrize("slope", [0.1, 0.35, 0.8])
def test_the_rebuilt_rim_stays_near_the_surface(slope):
    cube = gridmesh.cut(
        2 * CUBE - 1, QUADS, [[-4, -4 * slope, 0], [4, 4 * slope, 0]], direction=DOWN, edge_length=0.15
    )
    assert 0 <= cube.report["defect"] <= 0.05 * 0.15
    vertices, faces = torus()
    for edge_length in (0.15, 0.3):
        ends = [[-4, -4 * slope, 0.1], [4, 4 * slope, 0.3]]
        done = gridmesh.cut(vertices, faces, ends, direction=[0.2, 0.1, -1], edge_length=edge_length)
        assert 0 < done.report["defect"] <= 0.05 * edge_length


@pytest.mark.parametrize("smooth", ["tangent", "curvature"])
def test_bulging_caps_close_too(smooth):
    vertices, faces = torus()
    stroke = [[-4, 0.3, 0], [4, 0.5, 0]]
    done = gridmesh.cut(vertices, faces, stroke, direction=DOWN, edge_length=0.3, smooth=smooth)
    assert all(len(open_edges(piece)) == 0 for piece in done.pieces)
    flat = gridmesh.cut(vertices, faces, stroke, direction=DOWN, edge_length=0.3)
    assert done.report["volumes"][0] > flat.report["volumes"][0]


@pytest.mark.parametrize(
    ("kind", "change"),
    [
        ("stroke_misses", {"stroke": [[-1, 3, 0], [2, 3, 0]]}),
        ("stroke_too_short", {"stroke": [[0, 0, 0], [0, 0, 5]]}),
        ("self_intersecting", {"stroke": [[-1, 0, 0], [2, 1, 0], [2, 0, 0], [-1, 1, 0]]}),
        ("behind_eye", {"direction": None, "eye": [0.5, 0.5, 0.5]}),
        ("not_finite", {"stroke": [[-1, np.nan, 0], [2, 0, 0]]}),
        ("invalid_option", {"direction": None}),
        ("invalid_option", {"eye": [0, 0, 9]}),
        ("invalid_option", {"direction": [0, 0, 0]}),
        ("invalid_option", {"keep": "top"}),
        ("invalid_option", {"smooth": "round"}),
        ("invalid_option", {"cells": "hexagons"}),
        ("invalid_option", {"edge_length": -1}),
        ("invalid_option", {"gap": np.inf}),
        ("invalid_option", {"mirrors": [[[0, 0, 0], [0, 0, 0]]]}),
        ("invalid_option", {"mirrors": [[[0, 0, 0], [np.inf, 0, 0]]]}),
        ("invalid_shape", {"direction": [0, 1]}),
        ("invalid_shape", {"faces": [[0, 1]]}),
        ("invalid_shape", {"stroke": [[0, 1], [1, 2]]}),
        ("invalid_face", {"faces": [[0, 1, 1]]}),
        ("index_out_of_range", {"faces": [[0, 1, 8]]}),
        ("index_out_of_range", {"faces": [[0, 1, -1]]}),
    ],
)
def test_what_is_not_allowed_is_named(kind, change):
    arguments = {"vertices": CUBE, "faces": QUADS, "stroke": ACROSS, "direction": DOWN} | change
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.cut(**arguments)
    assert caught.value.kind == kind, caught.value


@pytest.mark.parametrize(
    "change", [{"cap": 1}, {"progress": 3}, {"edge_length": "fine"}, {"faces": QUADS * 1.0}]
)
def test_wrong_types(change):
    arguments = {"vertices": CUBE, "faces": QUADS, "stroke": ACROSS, "direction": DOWN} | change
    with pytest.raises(TypeError):
        gridmesh.cut(**arguments)


def test_progress_rises_and_cancels():
    vertices, faces = torus()
    seen = []
    gridmesh.cut(vertices, faces, [[-4, 0.3, 0], [4, 0.5, 0]], direction=DOWN, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1
    with pytest.raises(gridmesh.GridMeshError, match="cancelled"):
        gridmesh.cut(vertices, faces, ACROSS, direction=DOWN, progress=lambda f: f < 0.3)


def test_several_large_caps_go_on_asking():
    """While caps are planned side by side there is somebody to ask as well."""
    n, columns = 240, 6
    t = np.arange(n) * 2 * np.pi / n
    ring = (1 + 0.1 * np.cos(31 * t))[:, None] * np.column_stack([np.cos(t), np.sin(t)])
    column = np.vstack([np.column_stack([ring, np.full(n, z)]) for z in (0.0, 1.0)])
    sides = [[k, (k + 1) % n, (k + 1) % n + n, k + n] for k in range(n)]
    own = [list(range(n - 1, -1, -1)), list(range(n, 2 * n)), *sides]
    vertices = np.vstack([column + [3 * k, 0, 0] for k in range(columns)])
    faces = [[v + 2 * n * k for v in face] for k in range(columns) for face in own]
    mesh = (np.concatenate(faces), np.concatenate([[0], np.cumsum([len(face) for face in faces])]))
    stroke = [[-2, 0, 0.5], [3 * columns - 1, 0, 0.5]]
    seen = []
    whole = gridmesh.cut(vertices, mesh, stroke, direction=(0, 1, 0), progress=seen.append)
    assert whole.report["caps"] == columns
    assert sum(0.37 < fraction < 0.8 for fraction in seen) > 100
    left = iter(range(50))
    with pytest.raises(gridmesh.GridMeshError) as stopped:
        gridmesh.cut(
            vertices,
            mesh,
            stroke,
            direction=(0, 1, 0),
            progress=lambda fraction: fraction < 0.37 or next(left, None) is not None,
        )
    assert stopped.value.kind == "cancelled"


def test_documentation():
    example = doctest.DocTestParser().get_doctest(gridmesh.cut.__doc__, {}, "cut", None, 0)
    failures: list[str] = []
    doctest.DocTestRunner(verbose=False).run(example, out=failures.append)
    assert not failures, "".join(failures)
    text = inspect.getdoc(gridmesh.cut)
    for parameter in inspect.signature(gridmesh.cut).parameters:
        assert f"\n{parameter} : " in text, parameter
    for cls in (gridmesh.Cut, gridmesh.Piece):
        for name in vars(cls):
            assert name.startswith("_") or f"\n{name} : " in inspect.getdoc(cls), name


def test_cuts_and_pieces_are_pickled():
    done = gridmesh.cut(*torus(), [[-4, 0.3, 0], [4, 0.5, 0]], direction=DOWN, edge_length=0.3)
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        again = pickle.loads(pickle.dumps(done, protocol))
        assert again.report == done.report
        for one, other in zip(done.pieces, again.pieces, strict=True):
            assert one.side == other.side
            for name in (
                "vertices",
                "corners",
                "offsets",
                "source_face",
                "source_vertices",
                "source_weights",
            ):
                before, after = getattr(one, name), getattr(other, name)
                check_array(after, before.dtype, before.shape[1] if before.ndim == 2 else None)
                assert np.array_equal(before, after)
            for before, after in zip(one.cap_loops, other.cap_loops, strict=True):
                assert np.array_equal(before, after)
                assert not after.flags.writeable


def test_ends_go_as_far_as_what_the_stroke_crosses():
    """Two cubes side by side, the stroke across the first one."""
    vertices = np.vstack([CUBE, CUBE + [3, 0, 0]])
    faces = np.vstack([QUADS, QUADS + 8])
    short = [[0.2, 0.5, 0], [0.7, 0.5, 0]]
    all_of_it = gridmesh.cut(vertices, faces, short, direction=DOWN)
    one = gridmesh.cut(vertices, faces, short, direction=DOWN, extend_ends=False)
    assert (all_of_it.report["caps"], one.report["caps"]) == (2, 1)
    np.testing.assert_allclose(sorted(one.report["volumes"]), [0.5, 1.5])
    ends = gridmesh.cut_reach(vertices, faces, short, direction=DOWN)
    check_array(ends, np.float64, 3)
    np.testing.assert_allclose(ends, [[0, 0.5, 0], [1, 0.5, 0]], atol=1e-12)
    with pytest.raises(gridmesh.GridMeshError, match="does not divide") as refused:
        gridmesh.cut_reach(vertices, faces, [[1.5, 0.5, 0], [2, 0.5, 0]], direction=DOWN)
    assert refused.value.kind == "stroke_misses"


def test_what_ends_along_the_stroke_is_not_cut_again():
    options = {"direction": DOWN, "edge_length": 0.1}
    stroke = np.array([[-1, 0.3, 0], [2, 0.6, 0]])
    half = gridmesh.cut(CUBE, QUADS, stroke, keep="left", **options).pieces[0]
    faces = (half.corners, half.offsets)
    with pytest.raises(gridmesh.GridMeshError, match="the mesh ends along the stroke already") as refused:
        gridmesh.cut(half.vertices, faces, stroke + [0, 1e-3, 0], **options)
    assert refused.value.kind == "slice_too_thin"
    assert len(gridmesh.cut(half.vertices, faces, stroke + [0, 0.02, 0], **options).pieces) == 2


def test_a_half_is_capped_up_to_its_plane_of_symmetry():
    half = np.delete(QUADS, 0, axis=0)  # without its side at x = 0
    options = {"direction": DOWN, "edge_length": 0.2}
    assert gridmesh.cut(CUBE, half, ACROSS, **options).report["open_lines"] == 1
    plane = [[[0, 0, 0], [1, 0, 0]]]
    done = gridmesh.cut(CUBE, half, ACROSS, mirrors=plane, **options)
    assert (done.report["open_lines"], done.report["caps"]) == (0, 1)
    for piece in done.pieces:
        ends = piece.vertices[open_edges(piece)]
        assert len(ends) > 4
        np.testing.assert_allclose(ends[..., 0], 0, atol=1e-12)
    with pytest.raises(TypeError, match="mirrors"):
        gridmesh.cut(CUBE, half, ACROSS, mirrors="x", **options)
    with pytest.raises(gridmesh.GridMeshError, match="mirrors"):
        gridmesh.cut(CUBE, half, ACROSS, mirrors=[[[0, 0, 0], [0, 0, 0]]], **options)


def test_a_mirror_without_a_direction_is_told():
    with pytest.raises(gridmesh.GridMeshError, match=r"normal \[0, 0, 0\].*normals that are not zero"):
        gridmesh.cut(CUBE, QUADS, ACROSS, direction=DOWN, mirrors=[[[0, 0, 0], [0, 0, 0]]])


def ball(n: int = 30, m: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """A closed sphere of triangles around z."""
    u, v = np.meshgrid(np.arange(1, m) * np.pi / m, np.arange(n) * 2 * np.pi / n, indexing="ij")
    rows = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1).reshape(-1, 3)
    k, top, low = np.arange(n), 0, 1 + (m - 1) * n
    after = (k + 1) % n
    caps = [np.c_[0 * k + top, 1 + k, 1 + after], np.c_[0 * k + low, low - n + after, low - n + k]]
    rings = [1 + n * i for i in range(m - 2)]
    sides = [np.c_[a + k, a + n + k, a + after] for a in rings]
    sides += [np.c_[a + after, a + n + k, a + n + after] for a in rings]
    return np.vstack([[[0, 0, 1]], rows, [[0, 0, -1]]]), np.vstack(caps + sides)


def crossings(triangles: np.ndarray) -> int:
    """How often an edge of one of the triangles passes through another one that has no corner in common with it."""
    count = 0
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    for corners in triangles:
        near = ((low <= corners.max(axis=0)) & (high >= corners.min(axis=0))).all(axis=1)
        others, normal = triangles[near], normals[near]
        apart = ~(others[:, :, None] == corners).all(axis=-1).any(axis=(1, 2))
        others, normal = others[apart], normal[apart]
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            height = [((end - others[:, 0]) * normal).sum(axis=1) for end in (a, b)]
            through = height[0] * height[1] < 0
            at = height[0][through] / (height[0] - height[1])[through]
            point, face, up = a + at[:, None] * (b - a), others[through], normal[through]
            inside = np.ones(len(point), bool)
            for k in range(3):
                turn = np.cross(face[:, (k + 1) % 3] - face[:, k], point - face[:, k])
                inside &= (turn * up).sum(axis=1) > 1e-9 * (up**2).sum(axis=1)
            count += int(inside.sum())
    return count


@pytest.mark.parametrize("smooth", ["tangent", "curvature"])
def test_bulging_caps_of_a_thin_wedge_do_not_meet(smooth):
    """One cap bulged through the place where the other one had to lie flat."""
    stroke = [[-2, 0.3, 0], [2, 0.1, 0], [-2, -0.3, 0]]
    done = gridmesh.cut(*ball(), stroke, direction=DOWN, smooth=smooth)
    assert done.report["caps"] == 2
    assert done.report["reduced_caps"] > 0
    for piece in done.pieces:
        assert len(open_edges(piece)) == 0
        assert crossings(cap_triangles(piece)) == 0
