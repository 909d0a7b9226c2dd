"""stitch, inflate and flat."""

import gridmesh
import numpy as np
import pytest
from checks import check_array, check_body, check_mirrored, sticking_out
from hypothesis import given, settings
from hypothesis import strategies as st
from sketches import DRAWINGS, SHAPES, circle

BEAN = gridmesh.mesh_sketch(SHAPES["bean"]["points"], triangles=400)


@pytest.fixture(scope="module", params=[*DRAWINGS, "bean", "trefoil", "arrow", "circle"])
def patch(request):
    points = {**SHAPES, **DRAWINGS}[request.param]["points"]
    return gridmesh.mesh_sketch(points, triangles=3000)


def test_a_stitched_patch_is_a_closed_body(patch):
    pillow = gridmesh.stitch(patch)
    check_body(pillow, patch)
    check_mirrored(pillow, patch)
    assert not pillow.vertices[:, 2].any()


@pytest.mark.parametrize("profile", ["round", "even", "flat", "peak"])
def test_an_inflated_patch_is_a_closed_body(patch, profile):
    body = gridmesh.inflate(patch, profile=profile)
    check_body(body, patch)
    check_mirrored(body, patch)
    assert body.report["volume"] > 0
    assert body.report["self_intersections"] == 0
    assert body.report["min_angle"] > 0


def test_a_flat_patch_is_the_patch(patch):
    sheet = gridmesh.flat(patch)
    check_array(sheet.vertices, np.float64, 3)
    assert np.array_equal(sheet.vertices[:, :2], patch.vertices)
    assert not sheet.vertices[:, 2].any()
    assert np.array_equal(sheet.triangles, patch.triangles)
    assert sheet.report["watertight"] is False


@pytest.mark.parametrize("triangles", [150, 600, 5000])
@pytest.mark.parametrize("n", [40, 300])
def test_a_circle_becomes_a_sphere(triangles, n):
    patch = gridmesh.mesh_sketch(circle(n, radius=7), triangles=triangles)
    radii = np.linalg.norm(gridmesh.inflate(patch).vertices, axis=1)
    assert np.abs(radii / 7 - 1).max() <= 0.01


@pytest.mark.parametrize("depth", [0.5, 3.0])
def test_depth_scales_the_height(depth):
    patch = gridmesh.mesh_sketch(SHAPES["bean"]["points"], triangles=1000)
    height, scaled = (gridmesh.inflate(patch, depth=d).vertices[:, 2].max() for d in (1.0, depth))
    assert scaled == pytest.approx(depth * height, rel=0.1)


def test_sides_may_differ():
    patch = gridmesh.mesh_sketch(circle(), triangles=1000)
    body = gridmesh.inflate(patch, front=1.0, back=0.25)
    check_body(body, patch)
    assert body.vertices[:, 2].max() == pytest.approx(1.0, rel=0.05)
    assert body.vertices[:, 2].min() == pytest.approx(-0.25, rel=0.05)


def test_depth_follows_the_points_of_the_outline():
    points = circle(64)
    patch = gridmesh.mesh_sketch(points, triangles=1000)
    even = gridmesh.inflate(patch, front=np.full(64, 0.5), back=np.full(64, 0.5))
    plain = gridmesh.inflate(patch, front=0.5, back=0.5)
    assert np.allclose(even.vertices, plain.vertices, atol=1e-9)
    deeper_right = gridmesh.inflate(patch, front=1 + 0.5 * points[:, 0])
    check_body(deeper_right, patch)
    x, z = deeper_right.vertices[:, 0], deeper_right.vertices[:, 2]
    front = z > 0
    assert z[front & (x > 0.3)].mean() > 1.2 * z[front & (x < -0.3)].mean()


def test_the_same_patch_gives_the_same_bytes():
    patch = gridmesh.mesh_sketch(DRAWINGS["frog"]["points"], triangles=2000)
    bodies = [gridmesh.inflate(patch) for _ in range(3)]
    assert len({body.vertices.tobytes() + body.uv.tobytes() for body in bodies}) == 1


RING = [0, 0.3, 0.6, 0.85, 1, 0.8, 0.5]


@pytest.mark.parametrize("curve", [[0, 1], [0.0, 0.25, 0.5, 0.75, 1.0], np.linspace(0, 1, 50)])
def test_a_straight_curve_changes_nothing(curve):
    patch = gridmesh.mesh_sketch(DRAWINGS["frog"]["points"], triangles=1000)
    assert (
        gridmesh.inflate(patch, curve=curve).vertices.tobytes() == gridmesh.inflate(patch).vertices.tobytes()
    )


def test_a_curve_reshapes_the_section(patch):
    body = gridmesh.inflate(patch, curve=RING)
    check_body(body, patch)
    check_mirrored(body, patch)
    assert body.report["embedded"]
    top = gridmesh.inflate(patch).vertices[:, 2].max()
    assert body.vertices[:, 2].max() == pytest.approx(top, rel=0.02)
    middle = body.vertices[np.hypot(*(body.vertices[:, :2] - highest_point(patch)).T).argmin()]
    # The ring falls there so steeply that a fiftieth of the depth is a fifteenth of the height.
    assert abs(middle[2]) == pytest.approx(0.5 * top, rel=0.08)


def highest_point(patch):
    vertices = gridmesh.inflate(patch).vertices
    return vertices[vertices[:, 2].argmax(), :2]


def test_curves_go_through_map_sketches():
    outline = SHAPES["bean"]["points"]
    (mapped,) = gridmesh.map_sketches([outline], triangles=500, curve=RING)
    single = gridmesh.inflate(gridmesh.mesh_sketch(outline, triangles=500), curve=np.array(RING))
    assert mapped.vertices.tobytes() == single.vertices.tobytes()


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(1e-6, 10), min_size=1, max_size=20),
    st.sampled_from(["round", "even", "flat", "peak"]),
    st.floats(0.05, 5),
)
def test_any_curve_gives_an_embedded_body(values, profile, depth):
    body = gridmesh.inflate(BEAN, curve=[0.0, *values], profile=profile, depth=depth)
    check_body(body, BEAN)
    assert body.report["embedded"] or body.report["self_intersections"] == 0
    again = gridmesh.inflate(BEAN, curve=np.array([0.0, *values]), profile=profile, depth=depth)
    assert again.vertices.tobytes() == body.vertices.tobytes()


def test_arrays_are_shared_and_read_only():
    patch = gridmesh.mesh_sketch(circle(), triangles=200)
    body = gridmesh.inflate(patch)
    for thing in (patch, body):
        assert thing.vertices is thing.vertices
        with pytest.raises(ValueError, match="read-only"):
            thing.vertices[0] = 0
        with pytest.raises(AttributeError):
            thing.vertices = None
    kept = body.vertices
    del body, patch
    assert np.isfinite(kept).all()


@pytest.mark.parametrize("drawing", DRAWINGS.values(), ids=DRAWINGS.keys())
@pytest.mark.parametrize("asked", [{"triangles": 2000}, {"quads": 1000}, {"quads": 2000}], ids=str)
def test_no_vertex_of_a_body_sticks_out(drawing, asked):
    """A height's square is nowhere far above its neighbours', even beside thin and obtuse triangles of the patch."""
    body = gridmesh.inflate(gridmesh.mesh_sketch(drawing["points"], **asked))
    assert sticking_out(body) < 0.1


def with_inner_corners():
    """Outlines with inner corners of 200 to 310 degrees: stars, a cross, gears."""
    for n, inner in ((4, 0.45), (5, 0.5), (8, 0.7)):
        angles = 0.1 + np.arange(2 * n) * np.pi / n
        radii = np.where(np.arange(2 * n) % 2, inner, 1.0)
        yield radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    quarter = np.array([(0.25, 0.25), (0.25, 1.0), (-0.25, 1.0)])
    yield np.vstack([quarter @ np.linalg.matrix_power([[0, 1], [-1, 0]], k) for k in range(4)])
    for n, depth in ((6, 0.3), (8, 0.25)):
        steps = np.add.outer(np.arange(n), [0, 0.45, 0.5, 0.95]).ravel() * 2 * np.pi / n
        radii = np.tile([1.0, 1.0, 1 - depth, 1 - depth], n)
        yield radii[:, None] * np.column_stack([np.cos(steps), np.sin(steps)])


def test_triangles_above_inner_corners_are_not_sharp():
    """Upright walls held vertices that could only move together: half of these bodies had less than 27.5 degrees."""
    angles = [
        np.degrees(gridmesh.inflate(gridmesh.mesh_sketch(points, triangles=n)).report["min_angle"])
        for points in with_inner_corners()
        for n in (1000, 2000, 4000)
    ]
    assert np.median(angles) >= 28.0
    assert min(angles) >= 24.0
