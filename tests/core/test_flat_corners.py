"""Sharp corners of flat quads have one quad; bodies of the same patch have two there on each side."""

import pickle

import gridmesh
import numpy as np
import pytest
from checks import orientations
from quad_checks import check_quad_body, check_quad_patch, corner_triangles, edges_of, single_quads
from sketches import DRAWINGS, circle
from test_quads import check_mirrored, random_blob

_T = np.linspace(0, 2 * np.pi, 10, endpoint=False)
SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
STAR = np.column_stack([-np.sin(_T), np.cos(_T)]) * np.where(np.arange(10) % 2, 0.45, 1)[:, None]
LETTER = np.array(
    [[0.0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [2.5, 2], [2.5, 3], [1, 3], [1, 4], [3, 4], [3, 5], [0, 5]]
)
HOUSE = np.array([[-2.0, 0], [2, 0], [2, 2], [0, 4], [-2, 2]])
SHAPES = {"square": SQUARE, "star": STAR, "letter E": LETTER, "house": HOUSE}


def angles(patch):
    """Corners of the quads, in degrees from 0 to 360."""
    at = patch.vertices[patch.quads]
    ahead, back = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
    cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    return np.degrees(np.arctan2(cross, (ahead * back).sum(2))) % 360


def area(outline):
    """The area that a counter-clockwise outline encloses."""
    after = np.roll(outline, -1, axis=0)
    return 0.5 * (outline[:, 0] * after[:, 1] - outline[:, 1] * after[:, 0]).sum()


def interior(outline):
    """The angle of a counter-clockwise outline at each of its points, in degrees."""
    ahead, back = np.roll(outline, -1, axis=0) - outline, np.roll(outline, 1, axis=0) - outline
    cross = ahead[:, 0] * back[:, 1] - ahead[:, 1] * back[:, 0]
    return np.degrees(np.arctan2(cross, (ahead * back).sum(1))) % 360


def cornered(seed):
    """A blob cut off along lines: round parts, and corners of 60 to 160 degrees."""
    random = np.random.default_rng(seed)
    points = random_blob(seed)
    radius, angle = np.linalg.norm(points, axis=1), np.arctan2(points[:, 1], points[:, 0])
    for turn in random.uniform(0, 2 * np.pi) + np.array([0.0, 2.0, 3.5]):
        toward = np.cos(angle - turn)
        line = random.uniform(0.4, 0.7) / np.maximum(toward, 1e-9)
        radius = np.minimum(radius, line)
    return radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("quads", [300, 1000])
def test_shapes_have_one_quad_at_each_sharp_corner_and_their_bodies_do_not(name, quads):
    patch = gridmesh.mesh_sketch(SHAPES[name], quads=quads)
    outline, angle = SHAPES[name], interior(SHAPES[name])
    check_quad_patch(patch, [outline])
    assert abs(len(patch.quads) - quads) < 0.1 * quads
    single = {tuple(at) for at in patch.vertices[single_quads(patch)]}
    assert {tuple(at) for at in outline[angle < 100]} <= single <= {tuple(at) for at in outline[angle < 120]}
    assert angles(patch).min() > 0.88 * min(60, angle.min())
    assert patch.report["max_deviation"] < 0.1, "a corner is cut off"
    body = gridmesh.inflate(patch)
    check_quad_body(body, patch, 0)
    check_quad_body(gridmesh.stitch(patch), patch, 0)
    assert len(body.quads) == 2 * (len(patch.quads) - len(single))


def test_a_square_is_a_grid():
    # Its corners were 45 to 135 degrees.
    patch = gridmesh.mesh_sketch(SQUARE, quads=1000)
    assert set(np.bincount(patch.quads.ravel()).tolist()) == {1, 2, 4}
    assert np.abs(angles(patch) - 90).max() < 5
    ends, _ = edges_of(patch.quads)
    lengths = np.linalg.norm(patch.vertices[ends[:, 0]] - patch.vertices[ends[:, 1]], axis=1)
    assert lengths.max() < 1.3 * lengths.min()


def test_corners_that_a_hole_makes_sharp_are_opened_too():
    # A hole with a notch: there the patch has a corner of 90 degrees.
    hole = np.array([[-1.0, -1], [1, -1], [1, 1], [0.5, 1], [0.5, 0], [-0.5, 0], [-0.5, 1], [-1, 1]])
    outline = 2.5 * circle(200)
    patch = gridmesh.mesh_sketch(outline, [hole], quads=2500)
    check_quad_patch(patch, [outline, hole])
    check_quad_body(gridmesh.inflate(patch), patch, 1)
    single = {tuple(at) for at in patch.vertices[single_quads(patch)]}
    assert single == {(0.5, 0.0), (-0.5, 0.0)}


@pytest.mark.parametrize("name", sorted(DRAWINGS))
def test_drawings_keep_their_line_and_no_corner_gets_worse(name):
    patch = gridmesh.mesh_sketch(DRAWINGS[name]["points"], quads=1000)
    assert angles(patch).min() > 0.95 * angles(patch.belt).min() - 0.01
    belt = gridmesh.mesh_sketch(DRAWINGS[name]["points"], quads=1000, open_corners=False)
    assert patch.report["max_deviation"] <= max(belt.report["max_deviation"], 0.7) + 0.051
    assert patch.report["bridged_inlets"] == 0


def test_cornered_drawings_have_wide_corners():
    # Half of a drawn corner was the least: 36 degrees in the median, the greatest 133.
    least, most = [], []
    for seed in range(24):
        outline = cornered(seed)
        patch = gridmesh.mesh_sketch(outline, quads=600)
        check_quad_patch(patch, [outline])
        check_quad_body(gridmesh.inflate(patch), patch, 0)
        least.append(angles(patch).min())
        most.append(angles(patch).max())
    assert np.median(least) > 55
    assert np.median(most) < 130


@pytest.mark.parametrize("turn", [0.0, 0.9])
@pytest.mark.parametrize("name", ["star", "house", "square", "letter E"])
def test_mirrored_corners_are_opened_alike_also_on_the_axis(name, turn):
    if name == "letter E":
        outline, axis = LETTER - [0, 2.5], np.array([1.0, 0])
    else:
        outline, axis = SHAPES[name] - SHAPES[name].mean(axis=0), np.array([0.0, 1])
    turned = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    outline, axis = outline @ turned, axis @ turned
    patch = gridmesh.mesh_sketch(outline, quads=500, mirror=((0, 0), tuple(axis)))
    check_quad_patch(patch, [outline])
    check_mirrored(patch, axis)
    check_mirrored(patch.belt, axis)
    assert len(single_quads(patch)) >= (interior(outline) < 100).sum()
    on_axis = np.abs(outline @ [-axis[1], axis[0]]) < 1e-9
    opened = {tuple(np.round(at, 9) + 0.0) for at in patch.vertices[single_quads(patch)]}
    assert all(tuple(np.round(at, 9) + 0.0) in opened for at in outline[on_axis & (interior(outline) < 100)])


def test_bodies_are_made_of_the_belt():
    patch = gridmesh.mesh_sketch(STAR, quads=500)
    belt = gridmesh.mesh_sketch(STAR, quads=500, open_corners=False)
    assert belt.belt is belt
    assert patch.belt.vertices.tobytes() == belt.vertices.tobytes()
    assert patch.belt.quads.tobytes() == belt.quads.tobytes()
    bodies = [gridmesh.inflate(patch), gridmesh.inflate(belt), gridmesh.map_sketches([STAR], quads=500)[0]]
    assert len({body.vertices.tobytes() + body.quads.tobytes() + body.uv.tobytes() for body in bodies}) == 1
    assert bodies[0].corner[0].tobytes() == belt.corner[0].tobytes()


def test_patches_with_single_quads_can_be_pickled():
    patch = gridmesh.mesh_sketch(STAR, quads=300)
    copy = pickle.loads(pickle.dumps(patch))
    assert copy.quads.tobytes() == patch.quads.tobytes()
    assert copy.belt.vertices.tobytes() == patch.belt.vertices.tobytes()
    assert gridmesh.inflate(copy).vertices.tobytes() == gridmesh.inflate(patch).vertices.tobytes()
    assert gridmesh.flat(copy).vertices.tobytes() == gridmesh.flat(patch).vertices.tobytes()


def test_triangles_have_no_corners_to_open():
    with_option = gridmesh.mesh_sketch(STAR, triangles=400, open_corners=True)
    without = gridmesh.mesh_sketch(STAR, triangles=400, open_corners=False)
    assert with_option.vertices.tobytes() == without.vertices.tobytes()
    assert with_option.belt is with_option


def test_a_lattice_that_is_kept_opens_corners_too():
    patch = gridmesh.mesh_sketch(STAR, quads=500)
    moved = STAR + [[0.02, 0.0]] * (np.arange(10) == 3)[:, None]
    again = gridmesh.mesh_sketch(moved, cells="quads", keep=patch)
    check_quad_patch(again, [moved])
    assert len(single_quads(again)) == len(single_quads(patch)) == 5


def test_start_and_direction_do_not_matter():
    patch = gridmesh.mesh_sketch(STAR, quads=500)
    for other in (np.roll(STAR, 3, axis=0), STAR[::-1]):
        again = gridmesh.mesh_sketch(other, quads=500)
        assert again.vertices.tobytes() == patch.vertices.tobytes()
        assert again.quads.tobytes() == patch.quads.tobytes()


def test_crossing_outlines_have_sources_on_their_points():
    bow = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4], [0, 1], [1, 1], [1, 2], [-1, 2], [-1, 0]])
    patch = gridmesh.mesh_sketch(bow, quads=400, self_crossing="union")
    for one in (patch, patch.belt):
        segment, part = one.source[0].T
        at = segment.astype(int)
        along = bow[at] + part[:, None] * (np.roll(bow, -1, axis=0)[at] - bow[at])
        assert np.abs(along - one.vertices[one.loops[0]]).max() < 1e-6


@pytest.mark.parametrize("across", [False, True])
def test_covering_patches_and_their_bodies_both_cover(across):
    patch = gridmesh.cover_sketch(STAR, quads=400, across=across)
    assert len(single_quads(patch)) == 5
    for one in (patch, patch.belt):
        assert area(one.vertices[one.loops[0]]) > 0.97 * area(STAR)
        assert (orientations(one.vertices, corner_triangles(one.quads)) == 1).all()
    body = gridmesh.inflate(patch)
    assert body.report["embedded"]
    assert body.report["watertight"]


def test_sheets_have_the_patch_s_quads():
    patch = gridmesh.mesh_sketch(STAR, quads=300)
    sheet = gridmesh.flat(patch)
    assert np.array_equal(sheet.quads, patch.quads)
    assert np.array_equal(sheet.vertices[:, :2], patch.vertices)
    assert [corner.tolist() for corner in sheet.corner] == [corner.tolist() for corner in patch.corner]
