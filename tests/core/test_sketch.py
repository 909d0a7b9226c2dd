"""mesh_sketch: what it promises for good drawings."""

import copy
import inspect
import pickle
import re

import gridmesh
import numpy as np
import pytest
from checks import check_patch
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from sketches import DRAWINGS, SHAPES, blob, circle

METHODS = ["optimal", "grown"]
SLOW = settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


def bytes_of(patch):
    parts = [patch.vertices, patch.triangles, *patch.arc, *patch.corner]
    return b"".join(part.tobytes() for part in parts)


def mesh_or_least(points, triangles, **options):
    """A patch of about so many triangles, or of the least number that the refusal names."""
    try:
        return gridmesh.mesh_sketch(points, triangles=triangles, **options)
    except gridmesh.GridMeshError as refused:
        assert refused.kind == "too_coarse", refused
        least = int(re.search(r"; (\d+) work", str(refused))[1])
        assert least > triangles
        return gridmesh.mesh_sketch(points, triangles=least, **options)


@pytest.mark.parametrize("boundary", METHODS)
@pytest.mark.parametrize("name", DRAWINGS)
def test_drawings_are_meshed(name, boundary):
    points = DRAWINGS[name]["points"]
    patch = gridmesh.mesh_sketch(points, triangles=3000, boundary=boundary)
    check_patch(patch, [points])
    assert abs(len(patch.triangles) / 3000 - 1) <= 0.1


@pytest.mark.parametrize("boundary", METHODS)
@pytest.mark.parametrize("triangles", [6, 60, 400, 2000])
@pytest.mark.parametrize("name", SHAPES)
def test_shapes_are_meshed_or_the_least_count_works(name, triangles, boundary):
    points = SHAPES[name]["points"]
    patch = mesh_or_least(points, triangles, boundary=boundary)
    check_patch(patch, [points])


def test_straightening_lowers_the_turns_by_a_third_in_the_median():
    kept = []
    for drawing in DRAWINGS.values():
        report = gridmesh.mesh_sketch(drawing["points"], triangles=3000, boundary="grown").report
        assert report["turns"] <= report["turns_before"]
        kept.append(report["turns"] / report["turns_before"])
    assert np.median(kept) <= 2 / 3


@SLOW
@given(
    amplitudes=st.lists(st.floats(-0.25, 0.25), min_size=5, max_size=5),
    phase=st.floats(0, 6.3),
    triangles=st.integers(100, 4000),
    angle=st.floats(0, 1.04),
    method=st.sampled_from(METHODS),
)
@example(amplitudes=[0.0] * 5, phase=0.0, triangles=100, angle=0.0, method="grown")
def test_random_blobs_are_meshed(amplitudes, phase, triangles, angle, method):
    points = blob(amplitudes, [k * phase for k in range(5)])
    patch = mesh_or_least(points, triangles, angle=angle, boundary=method)
    check_patch(patch, [points])


@SLOW
@given(
    corners=st.lists(st.tuples(st.floats(0.3, 1), st.floats(0.3, 1)), min_size=3, max_size=12),
    triangles=st.integers(200, 3000),
)
def test_random_polygons_with_sharp_corners_are_meshed(corners, triangles):
    angle = np.cumsum([gap for gap, _ in corners])
    angle *= 2 * np.pi / angle[-1]
    radius = np.array([r for _, r in corners])
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    try:
        patch = mesh_or_least(points, triangles)
    except gridmesh.GridMeshError as refused:
        # Three directions within a half turn can enclose the origin from outside only.
        assert refused.kind in {"zero_area", "self_intersecting"}, refused
    else:
        check_patch(patch, [points])


@pytest.mark.parametrize("name", [*SHAPES, "frog", "letter"])
def test_start_direction_and_repeats_change_nothing(name):
    points = {**SHAPES, **DRAWINGS}[name]["points"]
    expected = mesh_or_least(points, 1500)
    variants = {
        "reversed": points[::-1],
        "rotated": np.roll(points, 7, axis=0),
        "repeated": np.repeat(points, 2, axis=0),
        "closed": np.vstack([points, points[:1]]),
    }
    for what, variant in variants.items():
        patch = mesh_or_least(variant, 1500)
        assert patch.vertices.tobytes() == expected.vertices.tobytes(), what
        assert patch.triangles.tobytes() == expected.triangles.tobytes(), what
        check_patch(patch, [variant])


@pytest.mark.parametrize("name", ["bean", "arrow", "frog"])
def test_scaling_by_a_power_of_two_scales_the_mesh(name):
    points = {**SHAPES, **DRAWINGS}[name]["points"]
    small, large = (gridmesh.mesh_sketch(points * k, triangles=1500) for k in (1, 1024))
    assert (small.vertices * 1024).tobytes() == large.vertices.tobytes()
    assert small.triangles.tobytes() == large.triangles.tobytes()


def test_moving_turning_and_scaling_keeps_the_topology():
    kept = []
    for drawing in DRAWINGS.values():
        points = drawing["points"]
        expected = gridmesh.mesh_sketch(points, triangles=2500)
        for angle, scale, shift in [(0.7, 3.3, (2, -1)), (1.1, 1.7, (0, 0.3)), (2.9, 0.021, (-0.4, 7))]:
            turned = points @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            moved = scale * turned + np.array(shift) * np.ptp(points)
            patch = gridmesh.mesh_sketch(moved, triangles=2500)
            check_patch(patch, [moved])
            same_cost = patch.report["cost"] == pytest.approx(expected.report["cost"], rel=1e-6)
            # The lattice is laid as the drawing lies: not only the topology, also the numbering is the same.
            kept.append(same_cost and np.array_equal(patch.triangles, expected.triangles))
    # Rounding decides where two boundaries or two lattice angles are as good as each other.
    assert np.mean(kept) >= 0.95, kept


FJORDS = [
    [(0.08, -0.93), (0.32, -0.68), (0.35, -0.47), (0.43, -0.41), (0.46, -0.25), (0.64, -0.22), (0.65, -0.24)]
    + [(0.47, -0.26), (0.44, -0.42), (0.36, -0.48), (0.33, -0.69), (0.09, -0.94)],
    [(-0.004, -0.911), (0.115, -0.783), (0.182, -0.674), (0.147, -0.525), (0.126, -0.307), (-0.116, -0.245)]
    + [(-0.101, -0.19), (0.167, -0.269), (0.202, -0.516), (0.238, -0.681), (0.159, -0.818), (0.05, -0.929)],
    [(-0.207, -0.916), (-0.115, -0.798), (0.022, -0.588), (0.156, -0.477), (0.364, -0.271), (0.399, -0.075)]
    + [
        (0.411, -0.077),
        (0.374, -0.277),
        (0.164, -0.486),
        (0.031, -0.596),
        (-0.105, -0.805),
        (-0.195, -0.913),
    ],
]


@pytest.mark.parametrize("fjord", FJORDS, ids=["hook", "wide end", "long"])
def test_boundary_edges_do_not_cross_a_narrow_fjord(fjord):
    """Each is narrower than an edge, so that edges from one wall to the next met the wall opposite."""
    shore = np.linspace(-np.pi / 2 + 0.15, 1.5 * np.pi - 0.15, 60)
    points = np.vstack([np.column_stack([np.cos(shore), np.sin(shore)]), fjord])
    patch = gridmesh.mesh_sketch(points, triangles=500)
    check_patch(patch, [points])
    assert gridmesh.inflate(patch).report["self_intersections"] == 0


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_any_number_of_threads_gives_the_same_bytes(threads):
    outlines = [drawing["points"] for drawing in DRAWINGS.values()]
    bodies = gridmesh.map_sketches(outlines, triangles=2500, threads=threads)
    for points, body in zip(outlines, bodies, strict=True):
        alone = gridmesh.inflate(gridmesh.mesh_sketch(points, triangles=2500))
        assert body.vertices.tobytes() == alone.vertices.tobytes()
        assert body.triangles.tobytes() == alone.triangles.tobytes()


def test_the_same_input_gives_the_same_bytes():
    points = DRAWINGS["octopus"]["points"]
    assert len({bytes_of(gridmesh.mesh_sketch(points, triangles=2500)) for _ in range(3)}) == 1


@pytest.mark.parametrize(
    "convert",
    [
        np.ndarray.tolist,
        np.asfortranarray,
        lambda p: np.repeat(p, 2, axis=1)[:, ::2],
        lambda p: [tuple(q) for q in p],
        lambda p: [np.array(q) for q in p],
        lambda p: p.astype(np.longdouble),
    ],
    ids=["lists", "fortran", "strided", "tuples", "rows", "long double"],
)
def test_any_form_of_the_same_points_gives_the_same_bytes(convert):
    points = SHAPES["bean"]["points"]
    expected = gridmesh.mesh_sketch(points, triangles=500)
    assert bytes_of(gridmesh.mesh_sketch(convert(points), triangles=500)) == bytes_of(expected)


@pytest.mark.parametrize("dtype", [np.int8, np.uint16, np.int64, np.float16, np.float32])
def test_other_number_types_are_read(dtype):
    square = np.array([[0, 0], [4, 0], [4, 4], [0, 4]])
    expected = gridmesh.mesh_sketch(square, triangles=500)
    assert bytes_of(gridmesh.mesh_sketch(square.astype(dtype), triangles=500)) == bytes_of(expected)


def test_the_input_is_neither_changed_nor_kept():
    points = SHAPES["bean"]["points"].copy()
    before = points.copy()
    patch = gridmesh.mesh_sketch(points, triangles=500)
    assert np.array_equal(points, before)
    points[:] = np.nan
    assert np.isfinite(patch.vertices).all()


def test_edge_length_is_used_as_given():
    patch = gridmesh.mesh_sketch(circle(), edge_length=0.125)
    assert patch.edge_length == 0.125
    check_patch(patch, [circle()])
    edges = patch.vertices[patch.triangles] - patch.vertices[np.roll(patch.triangles, 1, axis=1)]
    assert np.median(np.hypot(*edges.reshape(-1, 2).T)) == pytest.approx(0.125, rel=0.1)


def test_angle_and_defaults_are_reported():
    patch = gridmesh.mesh_sketch(circle(), angle=0.3)
    assert patch.angle == pytest.approx(0.3)
    assert abs(len(patch.triangles) / 2000 - 1) <= 0.1


def test_the_signature_tells_the_true_defaults():
    parameters = inspect.signature(gridmesh.mesh_sketch).parameters.values()
    defaults = {p.name: p.default for p in parameters if p.kind is p.KEYWORD_ONLY}
    points = DRAWINGS["guitar"]["points"]
    explicit = gridmesh.mesh_sketch(points, **defaults)
    assert bytes_of(explicit) == bytes_of(gridmesh.mesh_sketch(points))
    patch = gridmesh.mesh_sketch(points, triangles=800)
    parameters = inspect.signature(gridmesh.inflate).parameters.values()
    defaults = {p.name: p.default for p in parameters if p.kind is p.KEYWORD_ONLY}
    assert (
        gridmesh.inflate(patch, **defaults).vertices.tobytes() == gridmesh.inflate(patch).vertices.tobytes()
    )


def test_a_report_holds_plain_numbers():
    patch = gridmesh.mesh_sketch(circle(), triangles=500)
    for report in (patch.report, gridmesh.inflate(patch).report):
        seconds = report["seconds"]
        assert type(seconds) is dict
        assert all(type(value) is float and value >= 0 for value in seconds.values())
        plain = {key: value for key, value in report.items() if key != "seconds"}
        assert all(type(value) in {int, float, bool, type(None)} for value in plain.values())


def test_states_of_searches_are_counted_and_tell_of_walls_in_each_others_way():
    def states(points, **options):
        return gridmesh.mesh_sketch(points, triangles=500, **options).report["search_states"]

    round_one = circle()
    teeth = np.column_stack([np.repeat(np.arange(12.0), 2), np.tile([0, 6, 6, 0], 6)])
    walls = np.vstack([teeth, [[11, -1], [0, -1]]])
    for options in ({}, {"bend": 0}):
        assert 0 < states(round_one, **options) == states(round_one, **options)
        assert states(walls, **options) > 10 * states(round_one, **options)


def test_a_patch_survives_pickling_and_copying():
    patch = gridmesh.mesh_sketch(SHAPES["trefoil"]["points"], triangles=700)
    again = pickle.loads(pickle.dumps(patch))
    assert bytes_of(again) == bytes_of(patch)
    assert [loop.tobytes() for loop in again.loops] == [loop.tobytes() for loop in patch.loops]
    assert [source.tobytes() for source in again.source] == [source.tobytes() for source in patch.source]
    assert again.report == patch.report
    assert gridmesh.inflate(again).vertices.tobytes() == gridmesh.inflate(patch).vertices.tobytes()
    assert copy.copy(patch) is patch
    assert copy.deepcopy(patch) is patch
    body = gridmesh.inflate(patch)
    assert pickle.loads(pickle.dumps(body)).vertices.tobytes() == body.vertices.tobytes()


@pytest.mark.parametrize("damage", ["index", "loop", "columns"])
def test_a_damaged_pickle_is_refused(damage):
    patch = gridmesh.mesh_sketch(circle(), triangles=200)
    make, (vertices, triangles, contours, *rest) = patch.__reduce__()
    if damage == "index":
        triangles = triangles + len(vertices)
    elif damage == "loop":
        contours = ([arc[:-1] for arc in contours[0]], *contours[1:])
    else:
        vertices = np.column_stack([vertices, vertices])
    with pytest.raises(gridmesh.GridMeshError, match="damaged"):
        make(vertices, triangles, contours, *rest)


def test_classes_are_made_by_the_library_only():
    for cls in (gridmesh.Patch, gridmesh.Surface):
        with pytest.raises(TypeError):
            cls()


@pytest.mark.parametrize("aspect", [3.0, 4.5, 5.0, 6.0, 7.0, 7.3, 9.0, 12.0])
def test_bars_have_every_number_of_triangles(aspect):
    """A bar's rows come in whole numbers: where no angle meets the count, a shifted lattice does."""
    bar = np.array([[0, 0], [1, 0], [1, aspect], [0, aspect]])
    for triangles in (200, 300, 364, 450, 500, 800):
        patch = gridmesh.mesh_sketch(bar, triangles=triangles)
        assert abs(len(patch.triangles) / triangles - 1) <= 0.1


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize("tip", [[[1.015, 0]], [[0.985, 0]], [[1.005, 0], [1.002, 0], [1.007, 0]]])
def test_a_short_way_there_and_back_changes_nothing(tip, turn):
    """As where the outline of a letter ends a little beyond its beginning, and goes back."""
    plain = circle(200)
    spiked = np.insert(plain, 1, [*tip, plain[0]], axis=0)
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[c, s], [-s, c]])
    wanted = gridmesh.mesh_sketch(plain @ rotation, triangles=400)
    for first in (0, 1, 2, 57):
        for way in (1, -1):
            made = gridmesh.mesh_sketch(np.roll(spiked @ rotation, first, axis=0)[::way], triangles=400)
            assert bytes_of(made)[: wanted.vertices.nbytes] == wanted.vertices.tobytes()
            assert made.report["repaired"] == len(spiked) - len(plain)
