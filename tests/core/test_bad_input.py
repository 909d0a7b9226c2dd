"""Everything that is not allowed raises GridMeshError with its kind, or TypeError, and says what is allowed."""

import gridmesh
import numpy as np
import pytest
from sketches import BAD, circle

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


def refused(kind, call, *arguments, **options):
    with pytest.raises(gridmesh.GridMeshError) as caught:
        call(*arguments, **options)
    assert caught.value.kind == kind, caught.value
    assert isinstance(caught.value, ValueError)
    message = str(caught.value)
    assert len(message) > 15
    assert not message.endswith(".")
    return message


@pytest.mark.parametrize("name", BAD)
def test_bad_sketches_are_refused_with_their_kind(name):
    refused(BAD[name]["kind"], gridmesh.mesh_sketch, BAD[name]["points"])


def test_values_are_shown_in_few_digits():
    patch = gridmesh.mesh_sketch(circle(), triangles=100)
    assert "curve is 1e300; " in refused("invalid_option", gridmesh.inflate, patch, curve=[0, 1e300])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: gridmesh.join(5), "parts is of type int; allowed: a sequence of pairs"),
        (lambda: gridmesh.join([([[0, 0, 0]], [[0, 0, 0]]), 5]), "part 1 is of type int; allowed: a pair"),
        (lambda: gridmesh.map_sketches(5), "outlines is of type int; allowed: a sequence of outlines"),
    ],
)
def test_what_is_no_sequence_is_named(call, words):
    with pytest.raises(TypeError, match=words):
        call()


def test_a_crossing_names_its_two_segments():
    message = refused("self_intersecting", gridmesh.mesh_sketch, [[0, 0], [2, 2], [2, 0], [0, 2.5]])
    assert "segments 0 and 2" in message


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_point_that_is_not_finite_is_named(value):
    points = circle()
    points[17, 1] = value
    assert "point 17" in refused("not_finite", gridmesh.mesh_sketch, points)


@pytest.mark.parametrize(
    "outline",
    [[1, 2, 3], [[1, 2, 3]] * 4, [[[0, 0]]], 5, [[0, 0], [1], [2, 2]], np.zeros((4, 1)), np.zeros((2, 4, 2))],
    ids=repr,
)
def test_wrong_shapes_are_refused(outline):
    message = refused("invalid_shape", gridmesh.mesh_sketch, outline)
    assert "allowed: an (n, 2) array" in message


@pytest.mark.parametrize(
    "outline",
    [
        None,
        "abc",
        b"abc",
        {1: 2},
        [["a", "b"]] * 3,
        np.ones((4, 2), complex),
        np.ones((4, 2), bool),
        object(),
    ],
    ids=repr,
)
def test_wrong_types_are_refused(outline):
    with pytest.raises(TypeError, match="allowed: an \\(n, 2\\) array"):
        gridmesh.mesh_sketch(outline)


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("edge_length", 0),
        ("edge_length", -1.0),
        ("edge_length", np.nan),
        ("edge_length", np.inf),
        ("edge_length", 10**400),
        ("triangles", 0),
        ("triangles", -5),
        ("triangles", 10**30),
        ("boundary", "Grown"),
        ("max_distance", 0),
        ("max_distance", -1),
        ("max_distance", np.nan),
        ("closeness", -0.1),
        ("closeness", np.nan),
        ("angle", np.nan),
        ("corner_angle", -1),
        ("corner_angle", np.nan),
        ("mirror", "left"),
        ("mirror", ((0, 0), (0, 0))),
        ("mirror", ((0, np.nan), (1, 0))),
        ("self_crossing", "ignore"),
        ("proof_nodes", -1),
    ],
)
def test_values_that_are_not_allowed_are_refused(option, value):
    message = refused("invalid_option", gridmesh.mesh_sketch, SQUARE, **{option: value})
    assert option in message
    assert "allowed: " in message


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("edge_length", "1"),
        ("edge_length", [1]),
        ("edge_length", True),
        ("triangles", 100.0),
        ("triangles", [100]),
        ("triangles", True),
        ("boundary", None),
        ("boundary", 1),
        ("max_distance", None),
        ("closeness", "0.3"),
        ("angle", 1j),
        ("corner_angle", None),
        ("mirror", 3),
        ("mirror", ((0, 0), (1, 0), (1, 1))),
        ("self_crossing", None),
        ("proof_nodes", 1.5),
        ("relax", 1),
        ("relax", None),
        ("progress", 3),
    ],
)
def test_types_that_are_not_allowed_are_refused(option, value):
    with pytest.raises(TypeError, match=f"{option} is of type .*; allowed: "):
        gridmesh.mesh_sketch(SQUARE, **{option: value})


def test_options_are_keyword_only_and_known():
    with pytest.raises(TypeError):
        gridmesh.mesh_sketch(SQUARE, (), 0.1)
    with pytest.raises(TypeError, match="no option edgelength"):
        gridmesh.mesh_sketch(SQUARE, edgelength=0.1)
    with pytest.raises(TypeError, match="no option triangles"):
        gridmesh.inflate(gridmesh.mesh_sketch(SQUARE, triangles=100), triangles=3)


@pytest.mark.parametrize(
    "options", [{"closeness": 1e308}, {"origin": (1e300, -1e300)}, {"edge_length": -1e-300}]
)
def test_numbers_are_told_without_a_hundred_zeros(options):
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.mesh_sketch(SQUARE, **options)
    assert caught.value.kind == "invalid_option"
    assert "e" in str(caught.value).partition(" is ")[2]
    assert len(str(caught.value)) < 120


def test_edge_length_and_triangles_exclude_each_other():
    refused("invalid_option", gridmesh.mesh_sketch, SQUARE, edge_length=0.1, triangles=100)


@pytest.mark.parametrize(
    "options", [{"triangles": 20_000_001}, {"edge_length": 1e-5}, {"edge_length": 5e-324}]
)
def test_absurd_sizes_are_refused(options):
    refused("too_large", gridmesh.mesh_sketch, SQUARE, **options)


def test_an_edge_longer_than_the_drawing_is_too_coarse():
    assert " work" in refused("too_coarse", gridmesh.mesh_sketch, SQUARE, edge_length=50.0)


@pytest.mark.parametrize("scale", [1e-300, 1e-12, 1e12, 1e150])
def test_extreme_scales_are_meshed_or_refused(scale):
    try:
        patch = gridmesh.mesh_sketch(circle() * scale, triangles=300)
    except gridmesh.GridMeshError as error:
        assert error.kind != "no_patch", error
        assert "nan" not in str(error).lower()
    else:
        assert np.isfinite(patch.vertices).all()
        assert abs(len(patch.triangles) / 300 - 1) <= 0.1


@pytest.mark.parametrize("holes", [5, None, "ab"])
def test_holes_must_be_a_sequence_of_contours(holes):
    if holes is None:
        assert len(gridmesh.mesh_sketch(SQUARE, holes, triangles=100).loops) == 1
        return
    with pytest.raises(TypeError, match="allowed: "):
        gridmesh.mesh_sketch(SQUARE, holes)


@pytest.mark.parametrize(
    ("hole", "kind"),
    [
        (circle(20, 0.1) + 5, "hole_misplaced"),
        (circle(20, 0.8) + 0.5, "hole_misplaced"),
        ([[0.4, 0.4], [0.6, 0.6]], "too_few_points"),
        ([[0.4, 0.4], [0.6, np.nan], [0.6, 0.4]], "not_finite"),
        ([0.4, 0.5], "invalid_shape"),
    ],
    ids=["outside", "crossing", "two points", "nan", "shape"],
)
def test_bad_holes_are_named(hole, kind):
    assert "hole 0" in refused(kind, gridmesh.mesh_sketch, SQUARE, [hole], triangles=500)


@pytest.mark.parametrize("call", [gridmesh.inflate, gridmesh.stitch, gridmesh.flat])
@pytest.mark.parametrize("value", [None, SQUARE, 1])
def test_only_patches_make_surfaces(call, value):
    with pytest.raises(TypeError, match="allowed: a Patch"):
        call(value)


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("depth", 0),
        ("depth", -1),
        ("depth", np.nan),
        ("profile", "square"),
        ("front", -1.0),
        ("front", np.inf),
        ("back", [1.0, 2.0]),
        ("back", [1.0, 1.0, 1.0, np.nan]),
        ("corner_angle", np.nan),
        ("curve", []),
        ("curve", [0.0]),
        ("curve", [0.5, 1.0]),
        ("curve", [0.0, -1.0]),
        ("curve", [0.0, 0.0]),
        ("curve", [0.0, np.nan, 1.0]),
        ("curve", [0.0, np.inf]),
        ("curve", [0.0, 1e300]),
    ],
)
def test_values_that_inflate_does_not_allow(option, value):
    patch = gridmesh.mesh_sketch(SQUARE, triangles=100)
    message = refused("invalid_option", gridmesh.inflate, patch, **{option: value})
    assert option in message


def test_a_curve_is_a_sequence_of_numbers():
    patch = gridmesh.mesh_sketch(SQUARE, triangles=100)
    refused("invalid_shape", gridmesh.inflate, patch, curve=[[0.0, 1.0]])
    refused("invalid_shape", gridmesh.inflate, patch, curve=0.5)
    for curve in ("round", ["a", "b"], [0j, 1j]):
        with pytest.raises(TypeError, match="curve"):
            gridmesh.inflate(patch, curve=curve)


def test_an_error_knows_its_kind_even_if_made_by_others():
    assert gridmesh.GridMeshError("x").kind == "error"
