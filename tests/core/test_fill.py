"""Fills keep what they promise, on loops of all kinds."""

from __future__ import annotations

import doctest
import pickle

import gridmesh
import numpy as np
import pytest
from checks import check_array, check_fans, edges_of, half_edges
from hypothesis import given, settings
from hypothesis import strategies as st

NO_FACES = np.zeros((0, 3), np.int32)


def ring(n: int, height: float = 0.0, uneven: float = 0.0) -> np.ndarray:
    """A closed loop around z, wavy in z, with uneven spacing."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    t = t + uneven * np.sin(3 * t)
    return np.c_[np.cos(t), np.sin(t), height * np.cos(2 * t)]


def tube(n: int, rows: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """An open tube; the loop at its upper end is 0..n."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    vertices = np.vstack([np.c_[np.cos(t), np.sin(t), np.full(n, -2 * np.pi * k / n)] for k in range(rows)])
    i = np.arange(n)
    j = (i + 1) % n
    faces = [np.r_[np.c_[i, i + n, j], np.c_[j, i + n, j + n]] + k * n for k in range(rows - 1)]
    return vertices, np.concatenate(faces)


def ball(n: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """A closed sphere of latitude rows."""
    rows = n // 2
    u, v = np.meshgrid(np.arange(n), np.arange(1, rows), indexing="ij")
    theta, phi = np.pi * v / rows, 2 * np.pi * (u + 0.5 * v) / n
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    vertices = np.vstack([points.transpose(1, 0, 2).reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    i = np.arange(n)
    j = (i + 1) % n
    faces = [np.r_[np.c_[i, i + n, j], np.c_[j, i + n, j + n]] + k * n for k in range(rows - 2)]
    top, bottom, last = len(vertices) - 2, len(vertices) - 1, (rows - 2) * n
    faces.append(np.c_[np.full(n, top), i, j])
    faces.append(np.c_[np.full(n, bottom), j + last, i + last])
    return vertices, np.concatenate(faces)


def pierced(centres: list[int], rings: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """The ball without the triangles around some vertices."""
    vertices, faces = ball()
    for centre in centres:
        gone = {centre}
        for _ in range(rings - 1):
            gone |= set(faces[np.isin(faces, list(gone)).any(axis=1)].ravel().tolist())
        faces = faces[~np.isin(faces, list(gone)).any(axis=1)]
    return vertices, faces


def check_fill(vertices: np.ndarray, faces: np.ndarray, fill: gridmesh.Fill) -> None:
    """The guarantees that hold for every fill."""
    n, loop = len(vertices), np.asarray(fill.loop)
    check_array(fill.vertices, np.float64, 3)
    check_array(fill.triangles, np.int32, 3)
    assert np.isfinite(fill.vertices).all()
    used = np.unique(fill.triangles)
    assert set(used[used < n]) == set(loop.tolist()), "the boundary is the loop"
    assert set(used[used >= n]) == set(range(n, n + len(fill.vertices)))
    compact = np.searchsorted(np.r_[np.sort(loop), np.arange(n, n + len(fill.vertices))], fill.triangles)
    check_fans(compact, len(loop) + len(fill.vertices), len(loop))
    edges, counts = edges_of(fill.triangles)
    assert len(used) - len(edges) + len(fill.triangles) == 1, "a disk"
    sides = {tuple(sorted(pair)) for pair in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)}
    assert {tuple(edge) for edge in edges[counts == 1].tolist()} == sides
    assert counts.max() <= 2
    old = {tuple(edge) for edge in edges_of(faces)[0].tolist()} if len(faces) else set()
    assert not ({tuple(edge) for edge in edges[counts == 2].tolist()} & old), "a new edge repeats an old one"
    old_faces = {tuple(face) for face in np.sort(faces, axis=1).tolist()}
    assert not ({tuple(face) for face in np.sort(fill.triangles, axis=1).tolist()} & old_faces)
    if len(faces) and not fill.report["winding_conflicts"]:
        directed = {tuple(edge) for edge in half_edges(faces).tolist()}
        new = {tuple(edge) for edge in half_edges(fill.triangles).tolist()}
        assert not (directed & new), "wound against the neighbours"


@pytest.mark.parametrize("n", [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 17, 32, 61])
@pytest.mark.parametrize("smooth", ["flat", "tangent", "curvature"])
def test_every_number_of_edges_is_filled(n: int, smooth: str) -> None:
    vertices, faces = tube(n)
    fill = gridmesh.fill_hole(vertices, faces, np.arange(n), smooth=smooth)
    check_fill(vertices, faces, fill)
    assert fill.report["self_intersections"] == 0
    if smooth == "flat":
        assert np.abs(fill.vertices[:, 2]).max(initial=0) < 1e-12
        assert fill.report["rim_angle"] == pytest.approx(np.pi / 2, abs=1e-9)
    elif len(fill.vertices):
        assert (fill.vertices[:, 2] > -1e-3).all(), "it bulges outwards"


@pytest.mark.parametrize("n", [6, 8, 16, 24, 48])
def test_even_loops_have_no_irregular_vertex_inside(n: int) -> None:
    assert gridmesh.fill_hole(ring(n), NO_FACES, np.arange(n)).report["irregular"] == 0


def test_a_sphere_is_restored() -> None:
    # The hole spans more than 90 degrees, of rather coarse triangles.
    vertices, faces = pierced([5 * 24 + 3], rings=4)
    for smooth, limit in [("flat", 1.0), ("tangent", 0.05), ("curvature", 0.03)]:
        (fill,) = gridmesh.fill_holes(vertices, faces, smooth=smooth)
        check_fill(vertices, faces, fill)
        off = np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max()
        assert off < limit, smooth
        if smooth != "flat":
            closed = np.concatenate([faces, fill.triangles])
            assert (edges_of(closed)[1] == 2).all()


@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("smooth", ["tangent", "curvature"])
@pytest.mark.parametrize("n", [6, 7, 10, 12, 14, 16])
def test_few_faces_end_a_tube_as_many_do(n: int, smooth: str, cells: str) -> None:
    """The lid of a coarse tube is about as high as that of a fine one; with a curvature read at one vertex it was twice as high."""

    def top(n: int) -> float:
        vertices, faces = tube(n)
        # Walls of quads.
        polygons = np.tile(np.arange(n), 4) + np.repeat([0, 0, n, n], n)
        fill = gridmesh.fill_hole(
            vertices, faces, np.arange(n), smooth=smooth, cells=cells, polygons=polygons
        )
        return fill.vertices[:, 2].max()

    assert 0.6 < top(n) / top(64) < 1.15


def test_direction_and_start_of_the_loop_are_forgotten_but_for_the_winding() -> None:
    vertices, faces = tube(17)
    fill = gridmesh.fill_hole(vertices, faces, np.arange(17))
    other = gridmesh.fill_hole(vertices, faces, np.arange(17)[::-1])
    for it in (fill, other):
        check_fill(vertices, faces, it)
    assert (other.loop == np.arange(17)[::-1]).all()


def test_the_same_input_gives_the_same_bytes() -> None:
    vertices, faces = pierced([2 * 24 + 3, 5 * 24 + 12, 8 * 24 + 20], rings=2)
    first = gridmesh.fill_holes(vertices, faces)
    second = gridmesh.fill_holes(vertices.astype(np.float64), faces.astype(np.int64)[:, :])
    alone = [gridmesh.fill_hole(vertices, faces, fill.loop) for fill in first]
    assert len(first) == 3
    for a, b, c in zip(first, second, alone, strict=True):
        assert a.vertices.tobytes() == b.vertices.tobytes() == c.vertices.tobytes()
        assert a.triangles.tobytes() == b.triangles.tobytes() == c.triangles.tobytes()


def test_holes_that_touch_are_closed_together() -> None:
    vertices, faces = ball()
    gone = [7 * 24 + 5, 7 * 24 + 6]
    faces = faces[~np.isin(faces, gone).any(axis=1)]
    fills = gridmesh.fill_holes(vertices, faces)
    closed = np.concatenate([faces, *shifted(vertices, fills)])
    assert (edges_of(closed)[1] == 2).all()


def shifted(vertices: np.ndarray, fills: list[gridmesh.Fill]) -> list[np.ndarray]:
    """The triangles of the fills with new vertices numbered one after the other."""
    parts, first = [], 0
    for fill in fills:
        parts.append(np.where(fill.triangles < len(vertices), fill.triangles, fill.triangles + first))
        first += len(fill.vertices)
    return parts


def test_no_edge_comes_twice_from_two_fills() -> None:
    # Two quadrilaterals of wire on the same four corners but one: both would like the same diagonal.
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1], [0.5, 0.5, -1]], float)
    fills = gridmesh.fill_holes(vertices, NO_FACES, [[0, 1, 4], [0, 4, 2, 5]])
    assert isinstance(fills[1], gridmesh.GridMeshError)
    assert fills[1].kind == "shared_edge"
    fills = gridmesh.fill_holes(vertices, NO_FACES, [[0, 1, 2, 3], [0, 4, 2, 5]])
    edges = np.concatenate([edges_of(part)[0] for part in shifted(vertices, fills)])
    assert len(np.unique(edges, axis=0)) == len(edges)


def test_a_triangle_with_a_face_already_gets_three_others() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2]])
    fill = gridmesh.fill_hole(vertices, faces, [0, 1, 2])
    check_fill(vertices, faces, fill)
    assert len(fill.triangles) >= 3


def test_chords_of_the_mesh_are_not_repeated() -> None:
    # A square hole whose diagonals both exist outside.
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    vertices = np.vstack([square, [[0.5, 0.5, 2], [0.5, 0.5, -2]]])
    faces = np.array([[0, 2, 4], [1, 3, 5]])
    check_fill(vertices, faces, gridmesh.fill_hole(vertices, faces, [0, 1, 2, 3]))


def test_bent_loops_are_developed() -> None:
    t = np.linspace(0, 5, 30)
    band = np.r_[np.c_[np.cos(t), np.sin(t), 0 * t], np.c_[np.cos(t), np.sin(t), 0 * t + 0.5][::-1]]
    fill = gridmesh.fill_hole(band, NO_FACES, np.arange(60))
    check_fill(band, NO_FACES, fill)
    assert fill.report["unrolling"] == "developed"
    assert fill.report["distortion"] < 1e-6
    assert fill.report["self_intersections"] == 0
    assert np.abs(np.hypot(*fill.vertices[:, :2].T) - 1).max() < 0.1


def test_a_knot_is_filled_counted_and_refused_if_strict() -> None:
    t = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    trefoil = np.c_[np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)]
    fill = gridmesh.fill_hole(trefoil, NO_FACES, np.arange(90))
    check_fill(trefoil, NO_FACES, fill)
    assert fill.report["self_intersections"] > 0
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.fill_hole(trefoil, NO_FACES, np.arange(90), strict=True)
    assert caught.value.kind == "fill_intersects"


@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("smooth", ["tangent", "curvature"])
def test_a_patch_that_would_go_through_something_else_is_a_film(smooth: str, cells: str) -> None:
    vertices, faces = tube(24)
    free = gridmesh.fill_hole(vertices, faces, np.arange(24), smooth=smooth, cells=cells)
    height = free.vertices[:, 2].max()
    assert height > 0.2
    assert free.report["repaired"] == 0

    def below(plate: float) -> gridmesh.Fill:
        far = [[-9, -9, plate], [9, -9, plate], [0, 9, plate]]
        n = len(vertices)
        return gridmesh.fill_hole(
            np.r_[vertices, far], np.r_[faces, [[n, n + 1, n + 2]]], np.arange(24), smooth=smooth, cells=cells
        )

    film = below(height / 2)
    assert film.report["self_intersections"] == 0
    assert film.report["repaired"] == 1
    assert np.abs(film.vertices[:, 2]).max() < 1e-12
    assert np.array_equal(below(height * 2).vertices, free.vertices)
    # The film meets the plate too: the patch stays as it was wished for.
    through = below(0.0)
    assert through.report["self_intersections"] > 0
    assert np.array_equal(through.vertices, free.vertices)


def test_far_from_the_origin_and_at_any_size() -> None:
    vertices, faces = tube(19)
    plain = gridmesh.fill_hole(vertices, faces, np.arange(19))
    for scale, shift in [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e6)]:
        moved = vertices * scale + shift
        fill = gridmesh.fill_hole(moved, faces, np.arange(19))
        check_fill(moved, faces, fill)
        # Another lattice may do as well; the shape stays.
        top = (fill.vertices[:, 2].max() - shift) / scale
        assert top == pytest.approx(plain.vertices[:, 2].max(), rel=0.05)


def test_extended_data_stays_in_range_and_repeats_the_linear() -> None:
    loop = ring(32)
    fill = gridmesh.fill_hole(loop, NO_FACES, np.arange(32)[::-1])
    data = np.random.default_rng(3).random((32, 11))
    data[:, :3] = loop[fill.loop]
    data[:, 3] = 0.25
    new = fill.extend(data)
    assert new.shape == (len(fill.vertices), 11)
    assert (new >= data.min(axis=0)).all()
    assert (new <= data.max(axis=0)).all()
    assert np.abs(new[:, :3] - fill.vertices).max() < 0.05
    assert np.abs(new[:, 3] - 0.25).max() < 1e-12
    assert (fill.extend(data[:, 5]) == fill.extend(data[:, 5:6])[:, 0]).all()
    assert fill.extend(np.zeros((32, 0))).shape == (len(fill.vertices), 0)
    with pytest.raises(gridmesh.GridMeshError) as caught:
        fill.extend(data[1:])
    assert caught.value.kind == "invalid_shape"


def test_refit_follows_the_mesh() -> None:
    vertices, faces = pierced([5 * 24 + 3], rings=3)
    (fill,) = gridmesh.fill_holes(vertices, faces)
    assert fill.refit(vertices).tobytes() == fill.vertices.tobytes()
    moved = vertices * [1.0, 1.0, 1.5]
    assert np.abs(fill.refit(moved) - fill.vertices * [1.0, 1.0, 1.5]).max() < 0.1
    with pytest.raises(gridmesh.GridMeshError):
        fill.refit(vertices[1:])


@pytest.mark.parametrize("number", [2**31, 2**63 - 1, 2**63, 2**64 - 1, -(2**31) - 1, -(2**63)])
def test_numbers_that_no_vertex_can_have_are_told_as_given(number) -> None:
    vertices, faces = ball()
    wrong = faces.astype(np.uint64 if number > 0 else np.int64)
    wrong[5, 1] = number
    loop = np.array([0, 1, number], wrong.dtype)
    for call in [
        lambda: gridmesh.fill_holes(vertices, wrong),
        lambda: gridmesh.fill_hole(vertices, faces, loop),
        lambda: gridmesh.cut(vertices, wrong, [[-2, 0.1, 0], [2, 0.2, 0]], direction=(0, 0, 1)),
        lambda: gridmesh.regrid(vertices, faces, [number]),
    ]:
        with pytest.raises(gridmesh.GridMeshError, match=f" {number};") as caught:
            call()
        assert caught.value.kind == "index_out_of_range"
    holes = [fill.loop for fill in gridmesh.fill_holes(vertices, faces[1:])]
    wrong_loop, hole = gridmesh.fill_holes(vertices, faces[1:], [loop, *holes])
    assert str(wrong_loop).startswith(f"loop 0 holds {number};")
    assert isinstance(hole, gridmesh.Fill)


@pytest.mark.parametrize(
    ("loop", "kind"),
    [
        ([0, 1], "too_few_points"),
        ([0, 1, 99], "index_out_of_range"),
        ([0, 1, -1], "index_out_of_range"),
        ([0, 1, 2**40], "index_out_of_range"),
        ([0, 1, 1, 2], "repeated_vertex"),
        ([0, 1, 2, 1, 3], "figure_eight"),
        ([0, 2, 1, 3], "self_touching"),
        ([5, 6, 7, 4], "faces_on_both_sides"),
        ([0, 1, 2, 8], "not_finite"),
        ([0, 1, 2, 9], "zero_length_edge"),
        ([0, 9, 1, 2], "zero_length_edge"),
    ],
)
def test_unfit_loops_have_their_own_kind(loop: list[int], kind: str) -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    vertices = np.vstack([square, square + [0, 0, 5], [[np.nan, 0, 0], [0, 0, 0]]])
    faces = np.array([[5, 6, 7], [6, 5, 4]])
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.fill_hole(vertices, faces, loop)
    assert caught.value.kind == kind
    (item,) = gridmesh.fill_holes(vertices, faces, [loop])
    assert isinstance(item, gridmesh.GridMeshError)
    assert item.kind == kind


def test_unfit_arguments_are_refused() -> None:
    vertices, faces = tube(8)
    loop = np.arange(8)
    for args, options, error in [
        ((vertices[:, :2], faces, loop), {}, gridmesh.GridMeshError),
        ((vertices, faces[:, :2], loop), {}, gridmesh.GridMeshError),
        ((vertices, faces.astype(float), loop), {}, TypeError),
        ((vertices, faces, loop.astype(float)), {}, TypeError),
        ((vertices, faces, loop[None]), {}, gridmesh.GridMeshError),
        ((vertices, faces + 20, loop), {}, gridmesh.GridMeshError),
        ((vertices, -faces, loop), {}, gridmesh.GridMeshError),
        ((vertices, faces, loop), {"smooth": "round"}, gridmesh.GridMeshError),
        ((vertices, faces, loop), {"strict": "yes"}, TypeError),
    ]:
        with pytest.raises(error):
            gridmesh.fill_hole(*args, **options)
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.fill_hole(vertices, faces, loop, progress=lambda fraction: False)
    assert caught.value.kind == "cancelled"


def test_arrays_of_any_layout_are_read() -> None:
    vertices, faces = tube(12)
    plain = gridmesh.fill_hole(vertices, faces, np.arange(12))
    for v, f in [
        (np.asfortranarray(vertices), np.asfortranarray(faces.astype(np.int32))),
        (vertices.tolist(), faces.tolist()),
        (vertices, faces.astype(np.uint16)),
        (np.repeat(vertices, 2, axis=0)[::2], np.repeat(faces, 2, axis=1)[:, ::2]),
    ]:
        assert gridmesh.fill_hole(v, f, range(12)).vertices.tobytes() == plain.vertices.tobytes()


def test_open_borders_can_be_left_open() -> None:
    vertices, faces = tube(30)
    vertices = np.vstack([vertices, [[0, 0, -9.0]]])
    assert gridmesh.fill_holes(vertices, faces, max_edges=29) == []
    assert len(gridmesh.fill_holes(vertices, faces, max_edges=30)) == 2
    assert gridmesh.fill_holes(*ball()) == []


def test_surplus_faces_are_named() -> None:
    vertices, faces = tube(10)
    faces = np.vstack([faces, [[0, 1, 25]]])
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.fill_hole(vertices, faces, np.arange(10))
    assert caught.value.kind == "faces_on_both_sides"


def test_a_region_is_replaced_on_its_own_surface() -> None:
    vertices, faces = ball(32)
    region = np.flatnonzero(vertices[faces].mean(axis=1) @ [1.0, 0.2, 0.1] > 0.6)
    done = gridmesh.regrid(vertices, faces, region)
    rest = np.delete(faces, region, axis=0)
    check_fill(vertices, rest, done.fill)
    assert done.off < 1e-9
    corners = vertices[faces[done.source_faces]]
    assert np.abs((corners * done.source_weights[:, :, None]).sum(axis=1) - done.fill.vertices).max() < 1e-9
    assert np.isin(done.source_faces, region).all()
    assert (edges_of(np.concatenate([rest, done.fill.triangles]))[1] == 2).all()
    assert not np.isin(done.unused, np.unique(rest)).any()
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.regrid(vertices, faces, np.arange(len(faces)))
    assert caught.value.kind == "not_a_disk"


@pytest.mark.parametrize(
    "function", [gridmesh.fill_hole, gridmesh.fill_holes, gridmesh.regrid], ids=lambda f: f.__name__
)
def test_examples_run(function) -> None:
    example = doctest.DocTestParser().get_doctest(function.__doc__, {}, function.__name__, None, 0)
    assert example.examples
    failures: list[str] = []
    doctest.DocTestRunner(verbose=False).run(example, out=failures.append)
    assert not failures, "".join(failures)


RANDOM_LOOPS = {
    "n": st.integers(3, 40),
    "seed": st.integers(0, 2**32 - 1),
    "rough": st.floats(0, 1.5),
    "wild": st.booleans(),
    "smooth": st.sampled_from(["flat", "tangent", "curvature"]),
}


def random_loop(n: int, seed: int, rough: float, wild: bool) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, of which the first n are a loop, and faces beside half of its edges, or none."""
    rng = np.random.default_rng(seed)
    if wild:
        loop = rng.normal(size=(n, 3))
    else:
        t = np.sort(rng.random(n)) * 2 * np.pi
        loop = np.c_[np.cos(t), np.sin(t), 0 * t] + 0.2 * rough * rng.normal(size=(n, 3))
    apex = 1.5 * loop + rng.normal(size=(n, 3)) * 0.2
    i = np.arange(0, n, 2)
    return np.vstack([loop, apex]), np.c_[(i + 1) % n, i, i + n] if seed % 3 else NO_FACES


@settings(max_examples=60, deadline=None)
@given(**RANDOM_LOOPS)
def test_random_loops(n: int, seed: int, rough: float, wild: bool, smooth: str) -> None:
    vertices, faces = random_loop(n, seed, rough, wild)
    loop = vertices[:n]
    fill = gridmesh.fill_hole(vertices, faces, np.arange(n), smooth=smooth)
    check_fill(vertices, faces, fill)
    size = np.ptp(loop, axis=0).max()
    centre = loop.mean(axis=0)
    if len(fill.vertices):
        assert np.abs(fill.vertices - centre).max() < 20 * size


@settings(deadline=None, max_examples=300)
@given(st.data())
def test_any_loop_is_filled_or_refused(data: st.DataObject) -> None:
    """Repeated and touching vertices, flat triangles, edges of many faces: no crash, no edge made worse."""
    count = data.draw(st.integers(3, 14))
    seed = data.draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    # Points of a coarse grid coincide, lie on lines and on each other's edges.
    flat = data.draw(st.booleans())
    vertices = rng.integers(0, data.draw(st.integers(2, 5)), (count, 3)).astype(float)
    if flat:
        vertices[:, 2] = 0.0
    faces = rng.integers(0, count, (data.draw(st.integers(0, 12)), 3)).astype(np.int32)
    if data.draw(st.booleans()):
        loop = rng.permutation(count)[: data.draw(st.integers(3, count))]
    else:
        loop = rng.integers(0, count, data.draw(st.integers(0, count + 2)))
    try:
        fill = gridmesh.fill_hole(vertices, faces, loop)
    except gridmesh.GridMeshError:
        return
    assert np.isfinite(fill.vertices).all()
    size = max(np.ptp(vertices[loop], axis=0).max(), 1e-9)
    if len(fill.vertices):
        assert np.abs(fill.vertices - vertices[loop].mean(axis=0)).max() < 20 * size
    patch: dict[tuple[int, int], int] = {}
    for a, b in half_edges(fill.triangles).tolist():
        patch[min(a, b), max(a, b)] = patch.get((min(a, b), max(a, b)), 0) + 1
    around = {(min(a, b), max(a, b)) for a, b in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)}
    assert {edge for edge, times in patch.items() if times == 1} == around
    assert max(patch.values()) <= 2
    sound = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    old = {(min(a, b), max(a, b)) for a, b in half_edges(sound).tolist()}
    assert not (patch.keys() - around) & old


def sheet_of_quads(cut: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Quads with a square hole, each cut along one of its diagonals; also which quad each triangle is of."""
    a, b = np.meshgrid(np.arange(13), np.arange(13), indexing="ij")
    vertices = np.c_[a.ravel(), b.ravel(), 0 * a.ravel()].astype(float)
    quads = [13 * i + j for i in range(12) for j in range(12) if not (4 <= i < 8 and 4 <= j < 8)]
    triangles = []
    for quad, one in zip(quads, cut[: len(quads)], strict=True):
        p, q, r, s = quad, quad + 13, quad + 14, quad + 1
        triangles += [(p, q, r), (p, r, s)] if one else [(p, q, s), (q, r, s)]
    faces = np.array(triangles, np.int32)
    side = [13 * 4 + j for j in range(4, 8)]
    loop = side + [13 * i + 8 for i in range(4, 8)]
    loop += [13 * 8 + j for j in range(8, 4, -1)] + [13 * i + 4 for i in range(8, 4, -1)]
    return vertices, faces, np.array(loop), np.repeat(np.arange(len(quads)), 2)


def test_diagonals_of_quads_do_not_matter() -> None:
    rng = np.random.default_rng(2)
    fills = []
    for cut in (np.zeros(144, bool), np.ones(144, bool), rng.random(144) < 0.5):
        vertices, faces, loop, polygons = sheet_of_quads(cut)
        fills.append(gridmesh.fill_hole(vertices, faces, loop, polygons=polygons))
    for fill in fills[1:]:
        assert fill.triangles.tobytes() == fills[0].triangles.tobytes()
    with pytest.raises(gridmesh.GridMeshError, match="polygons"):
        gridmesh.fill_hole(vertices, faces, loop, polygons=polygons[1:])
    with pytest.raises(TypeError, match="polygons"):
        gridmesh.fill_hole(vertices, faces, loop, polygons=polygons + 0.5)


def test_a_fill_survives_pickling() -> None:
    vertices, faces, loop, _ = sheet_of_quads(np.zeros(144, bool))
    vertices[:, 2] = np.sin(vertices[:, 0])
    for smooth in ("flat", "tangent", "curvature"):
        for way in (loop, loop[::-1]):
            fill = gridmesh.fill_hole(vertices, faces, way, smooth=smooth)
            again = pickle.loads(pickle.dumps(fill))
            for name in ("loop", "vertices", "triangles"):
                assert getattr(again, name).tobytes() == getattr(fill, name).tobytes()
            assert again.report == fill.report
            moved = vertices * [1.0, 1.1, 0.7]
            assert again.refit(moved).tobytes() == fill.refit(moved).tobytes()
            values = np.arange(len(loop), dtype=float)
            assert again.extend(values).tobytes() == fill.extend(values).tobytes()
    done = gridmesh.regrid(vertices, faces, np.arange(40))
    again = pickle.loads(pickle.dumps(done))
    assert (again.off, again.lost) == (done.off, done.lost)
    assert again.fill.vertices.tobytes() == done.fill.vertices.tobytes()
    assert again.source_weights.tobytes() == done.source_weights.tobytes()


@pytest.mark.parametrize("damage", ["index", "loop", "columns", "smooth"])
def test_a_damaged_pickle_of_a_fill_is_refused(damage: str) -> None:
    vertices, faces, loop, _ = sheet_of_quads(np.zeros(144, bool))
    make, fields = gridmesh.fill_hole(vertices, faces, loop).__reduce__()
    fields = list(fields)
    if damage == "index":
        fields[8] = fields[8] + 1000
    elif damage == "loop":
        fields[0] = fields[0][:-1]
    elif damage == "columns":
        fields[6] = fields[6][:, :2].copy()
    else:
        fields[3] = "rough"
    with pytest.raises(gridmesh.GridMeshError, match="damaged"):
        make(*fields)


def test_one_face_is_told_as_one():
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    fill = gridmesh.fill_hole(corners, [[0, 1, 3], [1, 2, 3], [2, 0, 3]], [0, 1, 2])
    assert "1 triangle in" in repr(fill)
