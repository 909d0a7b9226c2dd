"""mesh_sketch with a mirror axis: the mesh is its own image."""

import gridmesh
import numpy as np
import pytest
from checks import check_body, check_patch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sketches import DRAWINGS, SHAPES, circle

SLOW = settings(max_examples=30, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


def unfolded(right):
    """A closed line that is its own image in the y axis, from its part right of the axis."""
    right = np.asarray(right, float)
    left = right[::-1][right[::-1, 0] != 0] * [-1, 1]
    return np.vstack([right, left])


def rounded(amplitudes, n=40):
    angle = np.pi * (np.arange(n) + 0.5) / n
    radius = np.maximum(1 + sum(a * np.cos((k + 1) * angle) for k, a in enumerate(amplitudes)), 0.25)
    return unfolded(np.column_stack([radius * np.sin(angle), -radius * np.cos(angle)]))


def rotation(angle):
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def partners(patch, point, direction):
    """Checks that vertices and triangles have images, and returns the greatest error of position."""
    normal = np.array([-direction[1], direction[0]]) / np.hypot(*direction)
    image = patch.vertices - 2 * ((patch.vertices - point) @ normal)[:, None] * normal
    distance = np.hypot(*(patch.vertices[:, None] - image[None]).transpose(2, 0, 1))
    partner = distance.argmin(axis=0)
    assert np.array_equal(partner[partner], np.arange(len(partner))), "not an involution"
    triangles = {tuple(t) for t in np.sort(patch.triangles, axis=1).tolist()}
    assert triangles == {tuple(t) for t in np.sort(partner[patch.triangles], axis=1).tolist()}
    return distance.min(axis=0).max()


@SLOW
@given(
    amplitudes=st.lists(st.floats(-0.25, 0.25), min_size=4, max_size=4),
    triangles=st.integers(150, 2000),
    turn=st.floats(-3, 3),
    auto=st.booleans(),
)
def test_symmetric_outlines_get_symmetric_meshes(amplitudes, triangles, turn, auto):
    points = rounded(amplitudes) @ rotation(turn) + [3, -8]
    axis = ((3, -8), np.array([0, 1]) @ rotation(turn))
    try:
        patch = gridmesh.mesh_sketch(points, triangles=triangles, mirror="auto" if auto else axis)
    except gridmesh.GridMeshError as refused:
        assert refused.kind == "too_coarse", refused
        return
    check_patch(patch, [points])
    size = np.ptp(points, axis=0).max()
    assert patch.report["mirror_error"] * patch.edge_length <= 1e-11 * size
    if not auto:
        assert partners(patch, *axis) <= 1e-11 * size


@pytest.mark.parametrize("amplitude", [1e-2, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 0])
def test_of_a_near_circle_auto_finds_the_exact_axis(amplitude):
    """Such a polygon has many axes that nearly fit, some of them more upright."""
    random = np.random.default_rng(3)
    for n in [6, 17, 40, 63]:
        points = rounded(amplitude * random.uniform(-1, 1, 4), n) @ rotation(random.uniform(-3, 3)) + [3, -8]
        patch = gridmesh.mesh_sketch(points, triangles=400, mirror="auto")
        assert patch.report["mirror_error"] * patch.edge_length <= 2e-11
        # Coordinates as Blender has them, to 5e-7 here.
        coarse = gridmesh.mesh_sketch(points.astype(np.float32), triangles=400, mirror="auto")
        assert coarse.report["mirror_error"] * coarse.edge_length <= 3e-5


@pytest.mark.parametrize("name", ["arrow", "square", "star", "trefoil", "comb", "dumbbell", "circle"])
def test_shapes_with_an_axis_are_found_symmetric(name):
    points = SHAPES[name]["points"]
    patch = gridmesh.mesh_sketch(points, triangles=2500, mirror="auto")
    check_patch(patch, [points])
    # The coordinates in the files have six digits.
    assert patch.report["mirror_error"] <= 1e-3
    assert gridmesh.mesh_sketch(points, triangles=2500).report["mirror_error"] is None


def test_a_face_with_three_holes_is_symmetric():
    outline = circle(120, 3)
    eye = circle(40, 0.6) + [1.2, 0.7]
    mouth = unfolded([[0, -1.8], [1, -1.4], [0.9, -1.2], [0, -1.5]])
    contours = [outline, eye, mouth, eye * [-1, 1]]
    patch = gridmesh.mesh_sketch(outline, contours[1:], triangles=1500, mirror=((0, 0), (0, 1)))
    check_patch(patch, contours)
    assert partners(patch, (0, 0), (0, 1)) < 1e-11
    check_body(gridmesh.inflate(patch), patch)


def test_the_direction_of_the_axis_and_its_point_do_not_matter():
    points = rounded([0.2, -0.1, 0.2])
    first = gridmesh.mesh_sketch(points, triangles=900, mirror=((0, 0), (0, 1)))
    for axis in [((0, 7), (0, 3)), ((0, -2), (0, -1))]:
        other = gridmesh.mesh_sketch(points, triangles=900, mirror=axis)
        assert other.report["cost"] == pytest.approx(first.report["cost"], rel=0.2)
        assert partners(other, (0, 0), (0, 1)) < 1e-11


@pytest.mark.parametrize("name", ["frog", "whale", "camel", "brazil"])
def test_drawings_without_an_axis_are_refused(name):
    with pytest.raises(gridmesh.GridMeshError, match="mirror image") as refused:
        gridmesh.mesh_sketch(DRAWINGS[name]["points"], mirror="auto")
    assert refused.value.kind == "not_symmetric"


def test_one_eye_is_not_symmetric():
    with pytest.raises(gridmesh.GridMeshError, match="hole 0") as refused:
        gridmesh.mesh_sketch(circle(90, 3), [circle(30, 0.5) + [1, 0]], mirror=((0, 0), (0, 1)))
    assert refused.value.kind == "not_symmetric"


def test_growth_and_other_angles_do_not_go_with_an_axis():
    for options in ({"boundary": "grown"}, {"angle": 0.2}):
        with pytest.raises(gridmesh.GridMeshError) as refused:
            gridmesh.mesh_sketch(circle(), mirror=((0, 0), (0, 1)), **options)
        assert refused.value.kind == "invalid_option"
