"""thickness, and triangles="auto": how thick limbs are, and as many triangles as make them round."""

import gridmesh
import numpy as np
import pytest
from sketches import DRAWINGS, SHAPES, circle

from addon.bodies import density

SIZES = [1.0, 1e-9, 1e9]


def bar(length, width, turn=0.0, n=0, jitter=0.0):
    """A bar with round ends; `n` points along it that tremble."""
    t = np.linspace(-np.pi / 2, np.pi / 2, 30)
    cap = width / 2 * np.c_[np.cos(t), np.sin(t)]
    points = np.r_[cap + [length / 2 - width / 2, 0], -cap - [length / 2 - width / 2, 0]]
    if n:
        closed = np.r_[points, points[:1]]
        arc = np.r_[0, np.cumsum(np.hypot(*np.diff(closed, axis=0).T))]
        at = np.linspace(0, arc[-1], n, endpoint=False)
        points = np.c_[np.interp(at, arc, closed[:, 0]), np.interp(at, arc, closed[:, 1])]
        points += jitter * np.random.default_rng(1).normal(size=points.shape)
    c, s = np.cos(turn), np.sin(turn)
    return points @ [[c, s], [-s, c]]


def hand(width):
    """A palm with five fingers of a width."""
    out = 0.5 * circle(80)
    for at, length in ((-60, 0.5), (-25, 0.8), (0, 0.9), (25, 0.8), (70, 0.6)):
        finger = bar(2 * length, width) + [length, 0]
        turn = np.radians(90 - at)
        c, s = np.cos(turn), np.sin(turn)
        out = gridmesh.combine(out, finger @ [[c, s], [-s, c]] + 0.1 * np.array([c, s]))[0][0]
    return out


@pytest.mark.parametrize("scale", SIZES)
@pytest.mark.parametrize("turn", [0.0, 0.4, 1.3])
@pytest.mark.parametrize("width", [0.1, 1.0, 3.0])
def test_a_bar_is_as_thick_as_it_is(width, turn, scale):
    limbs = gridmesh.thickness(scale * bar(10, width, turn))
    assert limbs[0, 2] == pytest.approx(scale * width, rel=0.05)


@pytest.mark.parametrize("jitter", [0.003, 0.01])
def test_a_trembling_pen_makes_no_limbs(jitter):
    limbs = gridmesh.thickness(bar(10, 1, n=600, jitter=jitter))
    assert len(limbs) <= 2
    assert limbs[0, 2] == pytest.approx(1.0, rel=0.06)


@pytest.mark.parametrize("name", ["circle", "messy"])
def test_a_compact_shape_has_no_limb(name):
    assert len(gridmesh.thickness(SHAPES[name]["points"])) == 0


def test_fingers_are_found():
    limbs = gridmesh.thickness(hand(0.12))
    assert (limbs[:, 2] < 0.16).sum() == 5
    assert limbs[0, 2] == pytest.approx(0.12, rel=0.05)
    assert (np.diff(limbs[:, 2]) >= 0).all()
    assert not limbs.flags.writeable


def test_a_neck_is_found_and_a_tip_is_not():
    two = gridmesh.combine(bar(6, 0.4), circle(60) - [3, 0])[0][0]
    two = gridmesh.combine(two, circle(60) + [3, 0])[0][0]
    assert gridmesh.thickness(two)[0, 2] == pytest.approx(0.4, rel=0.05)
    spike = [[0, -1], [6, 0], [0, 1]]
    assert not (gridmesh.thickness(spike)[:, 2] < 0.5).any()


def test_the_wall_of_a_ring_is_found():
    limbs = gridmesh.thickness(circle(200), [0.8 * circle(200)])
    assert limbs[0, 2] == pytest.approx(0.2, rel=0.05)


def test_same_wherever_the_drawing_begins_and_whichever_way_it_runs():
    points = DRAWINGS["camel"]["points"]
    wanted = gridmesh.thickness(points)
    for other in (np.roll(points, 50, axis=0), points[::-1]):
        np.testing.assert_allclose(gridmesh.thickness(other)[:, 2], wanted[:, 2], rtol=0.05)
    np.testing.assert_array_equal(gridmesh.thickness(points), wanted)


@pytest.mark.parametrize("width", [0.08, 0.12, 0.2])
def test_automatic_puts_five_triangles_across_a_finger(width):
    patch = gridmesh.mesh_sketch(hand(width), triangles="auto")
    assert 4.5 <= patch.report["across"] <= 5.5
    assert 1000 * 0.9 <= len(patch.triangles) <= 20000


@pytest.mark.parametrize("name", DRAWINGS)
def test_automatic_keeps_its_limits(name):
    points = DRAWINGS[name]["points"]
    report = gridmesh.mesh_sketch(points, triangles="auto").report
    assert 900 <= report["triangles"] <= 22000
    less = gridmesh.mesh_sketch(points, triangles="auto", max_triangles=4000).report
    assert less["triangles"] <= 4400


@pytest.mark.parametrize("points", [hand(0.12), bar(10, 1), circle(), DRAWINGS["camel"]["points"]])
def test_the_extension_knows_what_automatic_chooses(points):
    """It needs the number before there is a mesh, and tells how many would put five across."""
    most = 8000
    made = gridmesh.mesh_sketch(points, triangles="auto", max_triangles=most)
    assert density.automatic(points, [], most) == pytest.approx(made.report["triangles"], rel=0.1)


def test_only_automatic_measures_limbs():
    points = DRAWINGS["camel"]["points"]
    assert gridmesh.mesh_sketch(points, triangles=2000).report["across"] is None
    patch = gridmesh.mesh_sketch(points, triangles="auto", max_triangles=4000)
    wanted = gridmesh.thickness(points)[0, 2] / (np.sqrt(3) / 2 * patch.edge_length)
    assert patch.report["across"] == pytest.approx(wanted, rel=1e-9)


def test_automatic_gives_way_where_it_cannot_follow():
    """A slip 60 times as long as it is wide: its number is chosen like any other, and it is meshed."""
    report = gridmesh.mesh_sketch(bar(60, 1), triangles="auto").report
    assert report["across"] >= 4.5


def test_what_is_refused():
    points = circle()
    with pytest.raises(gridmesh.GridMeshError, match="'auto'"):
        gridmesh.mesh_sketch(points, triangles="many")
    with pytest.raises(gridmesh.GridMeshError, match="max_triangles is 5; allowed: at least 6"):
        gridmesh.mesh_sketch(points, triangles="auto", max_triangles=5)
    with pytest.raises(gridmesh.GridMeshError, match="one of automatic"):
        gridmesh.mesh_sketch(points, triangles="auto", edge_length=0.1)
    with pytest.raises(gridmesh.GridMeshError, match="NaN"):
        gridmesh.thickness([[0, 0], [np.nan, 1], [1, 1]])


def overlapping(patch, surface):
    half = 3 * len(patch.triangles)
    front, back = surface.uv[:half].reshape(-1, 3, 2), surface.uv[half:].reshape(-1, 3, 2)
    return front, back[:, [0, 2, 1]]


@pytest.mark.parametrize("name", ["camel", "letter"])
def test_uv_layouts(name):
    patch = gridmesh.mesh_sketch(DRAWINGS[name]["points"], triangles=2000)
    shared, apart = gridmesh.inflate(patch, uv="shared"), gridmesh.inflate(patch)
    front, back = overlapping(patch, shared)
    np.testing.assert_array_equal(front, back)
    for surface in (shared, apart):
        assert surface.uv.min() >= 0
        assert surface.uv.max() <= 1
    # No seam through a triangle: each is as it lies in the patch, at one scale.
    for surface in (shared, apart):
        corners = surface.uv[: 3 * len(patch.triangles)].reshape(-1, 3, 2)
        flat = patch.vertices[patch.triangles]
        ratio = np.linalg.norm(np.diff(corners, axis=1), axis=2) / np.linalg.norm(
            np.diff(flat, axis=1), axis=2
        )
        assert ratio.max() / ratio.min() < 1 + 1e-6
    front, back = overlapping(patch, apart)
    low, high = front.reshape(-1, 2), back.reshape(-1, 2)
    boxes_apart = (low.max(0) < high.min(0)) | (high.max(0) < low.min(0))
    assert boxes_apart.any()
    with pytest.raises(gridmesh.GridMeshError, match="'apart' or 'shared'"):
        gridmesh.inflate(patch, uv="beside")


def turned(points, turn):
    c, s = np.cos(turn), np.sin(turn)
    return np.asarray(points, float) @ [[c, s], [-s, c]]


@pytest.mark.parametrize("turn", [0.0, 0.1, 0.3, 0.7, 1.2])
@pytest.mark.parametrize("aspect", [5, 30, 150, 1000])
def test_a_bar_of_four_points_is_as_thick_as_it_is(aspect, turn):
    """The last side was not sampled, and samples a hundredth of a long bar apart made chords that lay askew."""
    limbs = gridmesh.thickness(turned([[0, 0], [aspect, 0], [aspect, 1], [0, 1]], turn))
    assert len(limbs) >= 1
    assert limbs[:, 2] == pytest.approx(np.ones(len(limbs)), rel=0.07)


@pytest.mark.parametrize("turn", [0.0, 0.1, 0.7])
@pytest.mark.parametrize("n", [3, 4, 5, 6, 7, 8, 40])
def test_a_regular_polygon_has_no_limb(n, turn):
    angle = turn + np.arange(n) * 2 * np.pi / n
    assert len(gridmesh.thickness(np.c_[np.cos(angle), np.sin(angle)])) == 0


def test_a_spike_on_a_square_is_a_limb():
    limbs = gridmesh.thickness(
        [[0, 0], [10, 0], [10, 4.8], [14, 4.8], [14, 5.2], [10, 5.2], [10, 10], [0, 10]]
    )
    assert limbs[0, 2] == pytest.approx(0.4, rel=0.05)


def shaken(points, step, tremble, seed):
    """The outline with points a step apart that tremble, as of an unsteady pen."""
    points = np.r_[points, points[:1]]
    arc = np.r_[0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    at = np.linspace(0, arc[-1], max(8, round(arc[-1] / step)), endpoint=False)
    even = np.c_[np.interp(at, arc, points[:, 0]), np.interp(at, arc, points[:, 1])]
    return even + tremble * np.random.default_rng(seed).uniform(-1, 1, even.shape)


def chosen(points, holes=()):
    return density.automatic(np.asarray(points), list(holes))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("tremble", [0.01, 0.04, 0.08])
@pytest.mark.parametrize("px", [60, 120, 200])
def test_a_shaky_compact_stroke_gets_the_least_number(px, tremble, seed):
    """A stroke of so many pixels with a point every three, and a part of its radius off to either side."""
    points = shaken(circle() * [px / 2, 0.3 * px], 3.0, 0.0, seed)
    points = points * (1 + tremble * np.random.default_rng(seed).uniform(-1, 1, (len(points), 1)))
    assert chosen(points) == 1000


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", ["guitar", "frog", "puzzle", "whale"])
def test_a_shaky_drawing_gets_a_number_like_the_smooth_one(name, seed):
    points = DRAWINGS[name]["points"]
    size = np.ptp(points, axis=0).max()
    shaky = shaken(points, 0.015 * size, 0.004 * size, seed)
    assert chosen(shaky) == pytest.approx(chosen(points), rel=0.5)


@pytest.mark.parametrize("seed", range(4))
def test_a_short_limb_may_be_lost_in_a_shaky_drawing_but_makes_no_more(seed):
    """The thinnest arm of the octopus is 13% of it long."""
    points = DRAWINGS["octopus"]["points"]
    size = np.ptp(points, axis=0).max()
    assert chosen(shaken(points, 0.015 * size, 0.004 * size, seed)) <= 1.5 * chosen(points)


@pytest.mark.parametrize("seed", range(3))
def test_shaky_fingers_still_get_five_across(seed):
    width = 0.12
    points = shaken(hand(width), 0.03, 0.008, seed)
    limbs = gridmesh.thickness(points)
    assert (limbs[:, 2] < 1.3 * width).sum() == 5
    assert limbs[0, 2] == pytest.approx(width, rel=0.15)
    report = gridmesh.mesh_sketch(points, triangles="auto").report
    assert 4.2 <= report["across"] * width / limbs[0, 2] <= 6


def test_the_number_of_a_shaky_stroke_turns_and_scales_with_it_and_has_no_beginning():
    points = shaken(hand(0.12), 0.03, 0.008, 0)
    wanted = chosen(points)
    for scale in SIZES:
        for turn in (0.0, 0.5, 2.0):
            assert chosen(scale * turned(points, turn)) == pytest.approx(wanted, rel=0.1)
    assert chosen(np.roll(points, 77, axis=0)) == pytest.approx(wanted, rel=0.1)
    assert chosen(points[::-1]) == pytest.approx(wanted, rel=0.1)
    halves = np.stack([points, (points + np.roll(points, -1, axis=0)) / 2], axis=1).reshape(-1, 2)
    assert chosen(halves) == pytest.approx(wanted, rel=0.1)


@pytest.mark.parametrize("length", [0.3, 0.5])
def test_spikes_that_are_slips_of_the_pen_do_not_count(length):
    points = np.array(bar(10, 3, n=60))
    for k in (10, 25, 40):
        points[k] *= 1 + length / np.linalg.norm(points[k])
    assert gridmesh.thickness(points)[0, 2] == pytest.approx(3.0, rel=0.1)


def test_walls_that_touch_after_rounding_are_measured():
    """Two places became one, and the triangulation has one vertex less than there were."""
    points = np.array([[-0.5, -0.5], [0.5, -0.5], [1e-17, 0.0], [0.5, 0.5], [-0.5, 0.5], [-1e-17, 0.0]])
    assert np.isfinite(gridmesh.thickness(points)).all()
