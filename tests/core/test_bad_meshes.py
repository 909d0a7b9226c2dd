"""Fills, bridges and regrid say of each argument that is not fit what is wrong, what is allowed and what to do."""

import re

import gridmesh
import numpy as np
import pytest

NONE = np.zeros((0, 3), int)


def ring(n, z):
    t = 2 * np.pi * np.arange(n) / n
    return np.c_[np.cos(t), np.sin(t), np.full(n, z)]


VERTICES = np.vstack([ring(12, 0.0), ring(12, 1.0), ring(12, 2.0)])
ONE, TWO, THREE = np.split(np.arange(36), 3)


def sheet():
    a, b = np.meshgrid(np.arange(5), np.arange(5), indexing="ij")
    quad = np.array([[5 * i + j for j in range(4)] for i in range(4)]).ravel()
    faces = np.r_[np.c_[quad, quad + 5, quad + 1], np.c_[quad + 5, quad + 6, quad + 1]]
    return np.c_[a.ravel(), b.ravel(), 0 * a.ravel()].astype(float), faces


SHEET, FACES = sheet()


def masked(array):
    found = np.ma.array(array, mask=False)
    found[1] = np.ma.masked
    return found


PATCH = gridmesh.fill_hole(VERTICES, NONE, ONE)

CALLS = {
    "vertices of bridge": lambda it: gridmesh.bridge(it(VERTICES), NONE, ONE, TWO),
    "triangles of fill_hole": lambda it: gridmesh.fill_hole(SHEET, it(FACES), [0, 1, 6]),
    "loop of bridge": lambda it: gridmesh.bridge(VERTICES, NONE, it(ONE), TWO),
    "other of bridge": lambda it: gridmesh.bridge(VERTICES, NONE, ONE, it(TWO)),
    "loop of fill_hole": lambda it: gridmesh.fill_hole(VERTICES, NONE, it(ONE)),
    "loops of fill_hole": lambda it: gridmesh.fill_hole(VERTICES, NONE, [ONE, TWO, it(THREE)]),
    "loops of fill_holes": lambda it: gridmesh.fill_holes(VERTICES, NONE, [ONE, it(TWO)]),
    "loops of bridge_pairs": lambda it: gridmesh.bridge_pairs(VERTICES, NONE, [ONE, it(TWO)]),
    "loops of look_apart": lambda it: gridmesh.look_apart(VERTICES, NONE, [ONE, it(TWO)]),
    "faces of regrid": lambda it: gridmesh.regrid(SHEET, FACES, it(np.arange(32))),
    "vertices of regrid": lambda it: gridmesh.regrid(it(SHEET), FACES, np.arange(32)),
    "polygons of fill_hole": lambda it: gridmesh.fill_hole(
        SHEET, FACES, [0, 1, 6], polygons=it(np.arange(32))
    ),
    "points of is_outer_border": lambda it: gridmesh.is_outer_border(it(VERTICES), VERTICES),
    "values of extend": lambda it: PATCH.extend(it(np.ones((12, 1)))),
    "vertices of refit": lambda it: PATCH.refit(it(VERTICES)),
    "outline of mesh_sketch": lambda it: gridmesh.mesh_sketch(it(VERTICES[:12, :2]), triangles=100),
    "image of trace_image": lambda it: gridmesh.trace_image(it(np.eye(8))),
    "outline of thickness": lambda it: gridmesh.thickness(it(VERTICES[:12, :2])),
}


@pytest.mark.parametrize("name", CALLS)
def test_masked_values_are_refused(name):
    with pytest.raises(
        TypeError, match=r"has \d+ masked values?; allowed: .*; leave out what is masked, or fill"
    ):
        CALLS[name](masked)


@pytest.mark.parametrize("name", [name for name in CALLS if "fill_hole" not in name or "loop" in name])
def test_arrays_that_could_be_masked_and_are_not_are_read(name):
    CALLS[name](lambda array: np.ma.array(array, mask=False))


def test_a_list_of_masked_rows_and_a_masked_number_are_refused():
    rows = list(VERTICES)
    rows[3] = np.ma.masked_all(3)
    with pytest.raises(TypeError, match=r"vertices, row 3, has 3 masked values; allowed: an \(n, 3\) array"):
        gridmesh.bridge(rows, NONE, ONE, TWO)
    with pytest.raises(TypeError, match=r"twist has 1 masked value; allowed: a finite angle"):
        gridmesh.bridge(VERTICES, NONE, ONE, TWO, twist=np.ma.masked)


@pytest.mark.parametrize("call", [gridmesh.bridge_pairs, gridmesh.look_apart, gridmesh.fill_holes])
def test_loops_that_are_no_sequence_of_loops(call):
    for value in (5, object(), np.float64(3)):
        with pytest.raises(TypeError, match=r"loops is of type .*; allowed: a sequence of"):
            call(VERTICES, NONE, value)
    for value in ([0, 1, 2], ONE, {0: 1}, range(3), [ONE, 5]):
        with pytest.raises(
            gridmesh.GridMeshError, match=r"loops has a single number at place \d; allowed: a seq"
        ) as caught:
            call(VERTICES, NONE, value)
        assert caught.value.kind == "invalid_shape"


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (ONE.astype(float), "loop is of type ndarray, of dtype float64; allowed: a .*; convert it with"),
        (ONE > 3, "loop is of type ndarray, of dtype bool; allowed: a "),
        (ONE.astype(object), "loop is of type ndarray, of dtype object; allowed: a "),
        ([0, 1.5, 2], "loop is of type list, which numpy reads as float64; allowed: a "),
        ([0, None, 2], "loop is of type list, which numpy reads as object; allowed: a "),
        ([2**70, 1, 2], "loop is of type list, which numpy reads as object; allowed: a "),
        ((k for k in range(5)), "loop is of type generator; allowed: a "),
        (None, "loop is of type NoneType; allowed: a "),
    ],
)
def test_what_numpy_makes_of_a_value_is_told(value, words):
    for call in (
        lambda it: gridmesh.fill_hole(VERTICES, NONE, it),
        lambda it: gridmesh.bridge(VERTICES, NONE, it, TWO),
    ):
        with pytest.raises(TypeError, match=words):
            call(value)


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda: gridmesh.fill_hole([[0, 0, 0], [1, 2]], NONE, ONE), "invalid_shape", "vertices has rows of different lengths; allowed"),
        (lambda: gridmesh.fill_hole(VERTICES, NONE, np.arange(12).reshape(3, 4)), "invalid_shape", "array of whole numbers, or a list of several"),
        (lambda: gridmesh.fill_hole(VERTICES, NONE, [0, 1]), "too_few_points", "the loop has 2 vertices; at least 3 are needed, name"),
        (lambda: gridmesh.fill_hole(VERTICES, NONE, [ONE, TWO, [24, 25]]), "too_few_points", "loop 2 has 2 vertices; at least 3"),
        (lambda: gridmesh.bridge(VERTICES, NONE, ONE, []), "too_few_points", "loop 1 has 0 vertices; at least 3"),
        (lambda: gridmesh.bridge(VERTICES, NONE, ONE, np.r_[0, TWO]), "figure_eight", "loops 0 and 1 both pass through vertex 0; split"),
        (lambda: gridmesh.look_apart(VERTICES, NONE, [TWO, THREE, ONE, THREE]), "figure_eight", "loops 1 and 3 both pass through vertex 24; split"),
        (lambda: gridmesh.bridge(np.zeros((0, 3)), NONE, ONE, TWO), "index_out_of_range", "vertex 0, but no vertices were given; give"),
        (lambda: gridmesh.regrid(SHEET, FACES, [0, 32]), "index_out_of_range", "face 32 was chosen; allowed: 0 to 31, one of the 32 triangles"),
        (lambda: gridmesh.regrid(SHEET, FACES, [-1]), "index_out_of_range", "face -1 was chosen; allowed: 0 to 31"),
        (lambda: gridmesh.regrid(SHEET, NONE, [0]), "index_out_of_range", "face 0 was chosen, but no triangles were given; give"),
        (lambda: gridmesh.regrid(SHEET, FACES, []), "not_a_disk", "no faces were chosen; choose one"),
        (lambda: gridmesh.fill_hole(SHEET, FACES, [0, 1, 6], creases=[[0, 25]]), "index_out_of_range", "the list of creases names vertex 25; allowed: 0 to 24"),
        (lambda: gridmesh.fill_holes(SHEET, FACES, creases=[[-1, 2]]), "index_out_of_range", "the list of creases names vertex -1; allowed: 0 to 24"),
    ],
)  # fmt: skip
def test_messages_say_what_is_wrong_and_what_to_do(call, kind, words):
    with pytest.raises(gridmesh.GridMeshError, match=re.escape(words)) as caught:
        call()
    assert caught.value.kind == kind
