"""Outlines traced from pictures: rasterised drawings come back, and nothing that is handed over crashes."""

import itertools
import pickle

import gridmesh
import numpy as np
import pytest
from checks import check_patch, distance_to_curve
from hypothesis import given, settings
from hypothesis import strategies as st
from rasters import corners, coverage, dense, likeness, placed, sampled
from sketches import DRAWINGS, SHAPES

SHEETS = {**DRAWINGS, **SHAPES}


def contours_of(traced):
    return [contour for outline, holes in traced for contour in [outline, *holes]]


def area(contour):
    following = np.roll(contour, -1, axis=0)
    return (contour[:, 0] * following[:, 1] - contour[:, 1] * following[:, 0]).sum() / 2


def disk(radius, size, at=(0.0, 0.0)):
    y, x = np.mgrid[:size, :size] + 0.5 - size / 2
    return np.clip(radius + 0.5 - np.hypot(x - at[0], -y - at[1]), 0, 1)


def turned_square(size, turn):
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.3 * size
    c, s = np.cos(turn), np.sin(turn)
    return square @ [[c, s], [-s, c]] + size / 2 + [0.31, 0.17]


@pytest.fixture(scope="module")
def round_trips():
    """For each size and drawing: what was drawn, and what was traced of its picture."""
    trips = {}
    for size, (name, sheet) in itertools.product((256, 1024), SHEETS.items()):
        drawn = placed([np.asarray(sheet["points"], float)], size)
        picture = np.rint(255 * coverage(drawn, size, size)).astype(np.uint8)
        trips[size, name] = drawn, gridmesh.trace_image(picture)
    return trips


@pytest.mark.native
def test_drawings_come_back_through_a_picture(round_trips):
    alike = {}
    for (size, name), (drawn, traced) in round_trips.items():
        found = contours_of(traced)
        alike[size, name] = likeness(found, drawn, size, 8 if size == 256 else 4)
        away = np.concatenate([distance_to_curve(dense(contour, 2.0), drawn[0]) for contour in found])
        assert np.quantile(away, 0.95) < 0.35, (size, name)
    assert min(alike.values()) > 0.99, min(alike, key=alike.get)
    assert np.median(list(alike.values())) > 0.998


def test_corners_come_back(round_trips):
    away = []
    for key, (drawn, traced) in round_trips.items():
        if key[1] in {"star", "comb"}:  # sides of less than three pixels between corners
            continue
        points = np.concatenate(contours_of(traced))
        away += [np.hypot(*(points - corner).T).min() for corner in corners(drawn[0], side=12)]
    away = np.array(away)
    assert len(away) > 60
    assert (away < 0.7).mean() > 0.95
    assert np.median(away) < 0.15


@pytest.mark.parametrize("size", [64, 256])
def test_middles_of_pixels_lie_where_their_coverage_puts_them(size):
    """Thin figures of few pixels lost one in a hundred of them to an outline a few hundredths of a pixel off."""
    wrong, beside = 0, 0
    for sheet in SHEETS.values():
        alpha = coverage(placed([np.asarray(sheet["points"], float)], size), size, size)
        covered, traced = alpha >= 0.5, gridmesh.trace_image(alpha, min_area=0)
        wrong += (sampled(contours_of(traced), size, size, 1)[::-1] != covered).sum()
        beside += (covered[1:] != covered[:-1]).sum() + (covered[:, 1:] != covered[:, :-1]).sum()
    assert wrong < 0.01 * beside


@pytest.mark.parametrize("turn", [0.08, 0.24, 0.52])
def test_sharp_tips_come_back(turn):
    c, s = np.cos(turn), np.sin(turn)
    star = placed([np.asarray(SHEETS["star"]["points"], float) @ [[c, s], [-s, c]]], 256)
    traced = gridmesh.trace_image(np.rint(255 * coverage(star, 256, 256)).astype(np.uint8))
    points = np.concatenate(contours_of(traced))
    assert max(np.hypot(*(points - corner).T).min() for corner in star[0]) < 0.7


@pytest.mark.parametrize("turn", np.linspace(0, np.pi / 2, 9)[:-1])
def test_a_square_has_four_corners_and_straight_sides(turn):
    drawn = turned_square(200, turn)
    [(outline, holes)] = gridmesh.trace_image(coverage([drawn], 200, 200))
    assert holes == []
    assert distance_to_curve(outline, drawn).max() < 0.3
    for corner in drawn:
        assert np.hypot(*(outline - corner).T).min() < 0.5
    # No stairs: the turns away from corners are slight.
    steps = np.diff(np.r_[outline, outline[:1]], axis=0)
    angles = np.arctan2(*steps.T[::-1])
    turns = np.abs((np.roll(angles, -1) - angles + np.pi) % (2 * np.pi) - np.pi)
    assert (turns > 0.3).sum() == 4


@pytest.mark.parametrize("radius", [3.0, 7.3, 20.0, 44.4])
def test_disks_stay_round(radius):
    [(outline, _)] = gridmesh.trace_image(disk(radius, 100, (0.3, -0.2)))
    off = np.hypot(*(outline - [50.3, 49.8]).T) - radius
    assert np.abs(off).max() < 0.15
    assert area(outline) == pytest.approx(np.pi * radius**2, abs=0.06 * 2 * np.pi * radius)


def test_binary_masks_lose_their_stairs():
    mask = disk(60, 160) >= 0.5
    [(outline, _)] = gridmesh.trace_image(mask)
    off = np.hypot(*(outline - 80).T) - 60
    assert np.sqrt((off**2).mean()) < 0.3
    raw = gridmesh.trace_image(mask, smooth=0)[0][0]
    assert np.abs(np.hypot(*(outline - 80).T) - 60).max() < np.abs(np.hypot(*(raw - 80).T) - 60).max() + 0.1
    steps = np.diff(np.r_[outline, outline[:2]], axis=0)
    turns = np.arctan2(*np.roll(steps, -1, axis=0).T[::-1]) - np.arctan2(*steps.T[::-1])
    turns = np.abs((turns + np.pi) % (2 * np.pi) - np.pi)
    assert np.quantile(turns, 0.9) < 0.4


def test_thresholds_move_the_line():
    soft = np.clip(1 - np.hypot(*(np.mgrid[:101, :101] - 50)) / 50, 0, 1)
    for threshold in (0.1, 0.25, 0.5, 0.75):
        [(outline, _)] = gridmesh.trace_image(soft, threshold=threshold)
        assert np.hypot(*(outline - 50.5).T) == pytest.approx(50 * (1 - threshold), abs=0.3)
    faint = 0.1 + 0.2 * disk(30, 100)
    assert gridmesh.trace_image(faint) == []
    traced = gridmesh.trace_image(faint, threshold="auto")
    assert 0.1 < traced.threshold < 0.3
    assert area(traced[0][0]) == pytest.approx(np.pi * 900, rel=0.01)


def test_holes_and_islands_in_them():
    picture = (
        disk(60, 140) - disk(40, 140) + disk(20, 140) + disk(5, 140, (50, 60)) + disk(1.2, 140, (-60, 60))
    )
    traced = gridmesh.trace_image(picture)
    assert [len(holes) for _, holes in traced] == [1, 0, 0]
    assert [area(outline) > 0 for outline, _ in traced] == [True] * 3
    assert area(traced[0][1][0]) == pytest.approx(-np.pi * 1600, rel=0.01)
    assert (traced.dropped, traced.filled, traced.threshold) == (1, 0, 0.5)
    assert len(gridmesh.trace_image(picture, min_area=0)) == 4
    filled = gridmesh.trace_image(picture, min_area=6000)
    assert (len(filled), filled.dropped, filled.filled) == (1, 3, 1)


@pytest.mark.parametrize("margin", [1.0, 1.5, 6.0])
@pytest.mark.parametrize("name", ["frog", "star", "snowflake"])
def test_a_margin_takes_in_every_pixel(name, margin):
    size = 128
    picture = coverage(placed([np.asarray(SHEETS[name]["points"], float)], size, 9), size, size)
    traced = gridmesh.trace_image(picture, margin=margin, min_area=0)
    inside = sampled(contours_of(traced), size, size, 8)[::-1].reshape(size, 8, size, 8).all(axis=(1, 3))
    assert inside[picture >= 0.5].all()
    without = sum(area(contour) for contour in contours_of(gridmesh.trace_image(picture, min_area=0)))
    assert sum(area(contour) for contour in contours_of(traced)) > without
    for outline, holes in traced:
        gridmesh.thickness(outline, holes)  # reads both, and refuses what meets itself


def test_parts_merge_within_the_margin():
    picture = disk(20, 120, (-24, 0)) + disk(20, 120, (24, 0))
    assert len(gridmesh.trace_image(picture, margin=3)) == 2
    assert len(gridmesh.trace_image(picture, margin=5)) == 1


@pytest.mark.parametrize("name", ["frog", "octopus", "snowflake", "guitar"])
def test_what_is_traced_can_be_meshed(round_trips, name):
    _, traced = round_trips[256, name]
    [(outline, holes)] = traced
    patch = gridmesh.mesh_sketch(outline, holes, triangles=800)
    check_patch(patch, [outline, *holes])


def test_a_ring_can_be_meshed():
    [(outline, holes)] = gridmesh.trace_image(disk(60, 140) - disk(40, 140))
    check_patch(gridmesh.mesh_sketch(outline, holes, triangles=800), [outline, *holes])


@pytest.mark.parametrize("seed", range(4))
def test_noise_gives_contours_that_never_meet(seed):
    random = np.random.default_rng(seed)
    for picture in (random.random((90, 110)), random.integers(0, 2, (90, 110)).astype(bool)):
        for smooth in (0.0, 1.0, 10.0):
            traced = gridmesh.trace_image(picture, min_area=0, smooth=smooth)
            assert len(traced) > 20
            for outline, holes in traced:
                gridmesh.thickness(outline, holes)
            total = sum(area(contour) for contour in contours_of(traced))
            assert 0.2 < total / picture.size < 0.8


def test_all_kinds_of_numbers_say_the_same():
    exact = np.rint(255 * disk(30, 80))
    wanted = gridmesh.trace_image(exact.astype(np.uint8))[0][0]
    alpha = np.zeros((80, 80, 4), np.uint8)
    alpha[..., 3] = exact
    assert gridmesh.trace_image(alpha)[0][0].tobytes() == wanted.tobytes()
    assert gridmesh.trace_image(alpha[::-1, ::-1][::-1, ::-1])[0][0].tobytes() == wanted.tobytes()
    for same in (exact / 255, (exact / 255).astype(np.float32), (exact * 257).astype(np.uint16)):
        assert gridmesh.trace_image(same)[0][0] == pytest.approx(wanted, abs=1e-4)
    assert gridmesh.trace_image(5.0 * (exact > 127) - 1)[0][0] == pytest.approx(
        gridmesh.trace_image(exact > 127)[0][0]
    )


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_views_are_read_as_what_they_show(channels):
    picture = np.zeros((70, 90, channels))
    picture[8:40, 10:70] = 1
    picture[30:60, 20:35, -1] = 0.8
    background = "transparent" if channels == 4 else "paper"
    picture = picture[..., 0] if channels == 1 else picture
    wanted = [c.tobytes() for c in contours_of(gridmesh.trace_image(picture, background=background))]
    for turned in (
        np.ascontiguousarray(picture[::-1])[::-1],
        np.ascontiguousarray(picture[:, ::-1])[:, ::-1],
        np.asfortranarray(picture),
        np.repeat(np.repeat(picture, 2, axis=0), 3, axis=1)[::2, ::3],
    ):
        assert not turned.flags.c_contiguous
        found = contours_of(gridmesh.trace_image(turned, background=background))
        assert [c.tobytes() for c in found] == wanted


def test_rows_come_from_the_top_and_the_picture_has_a_border():
    picture = np.zeros((10, 30))
    picture[:5, :10] = 1
    [(outline, _)] = gridmesh.trace_image(picture)
    assert outline.min(axis=0) == pytest.approx([0, 5], abs=0.02)
    assert outline.max(axis=0) == pytest.approx([10, 10], abs=0.02)
    [(outline, _)] = gridmesh.trace_image(np.ones((20, 30)))
    assert area(outline) == pytest.approx(600, rel=1e-3)


def test_paper_under_uneven_light():
    y, x = np.mgrid[:240, :320]
    light = 0.95 - 0.4 * (x / 320) * (y / 240)
    paper = light[..., None] * [1, 0.96, 0.88]
    ink = disk(70, 320)[40:280, :, None]
    paper = paper * (1 - ink * [0.1, 0.4, 0.8]) + np.random.default_rng(0).normal(0, 0.01, (240, 320, 1))
    colours = np.rint(255 * np.clip(paper, 0, 1)).astype(np.uint8)
    traced = gridmesh.trace_image(colours, background="paper", min_area=50)
    assert len(traced) == 1
    off = np.hypot(*(traced[0][0] - [160, 120]).T) - 70
    assert np.abs(off).max() < 0.6
    assert gridmesh.trace_image(np.full((50, 60, 3), 230, np.uint8), background="paper") == []
    grey = gridmesh.trace_image(colours.mean(axis=2) / 255, background="paper", min_area=50)
    assert area(grey[0][0]) == pytest.approx(np.pi * 4900, rel=0.02)


@pytest.mark.parametrize(
    ("image", "kind"),
    [
        (np.zeros((0, 5)), "picture_size"),
        (np.zeros((5, 0, 4)), "picture_size"),
        (np.broadcast_to(np.uint8(255), (40000, 40000)), "picture_size"),
        (np.zeros(5), "invalid_shape"),
        (np.zeros((5, 5, 3)), "invalid_shape"),
        (np.zeros((5, 5, 4, 1)), "invalid_shape"),
        (3.0, "invalid_shape"),
        (None, "invalid_shape"),
        ([[1.0, 2.0], [3.0]], "invalid_shape"),
        (np.array([[1.0, np.nan], [0.0, 0.0]]), "not_finite"),
        (np.array([[1.0, 0.0], [np.inf, 0.0]]), "not_finite"),
    ],
)
def test_hostile_pictures(image, kind):
    with pytest.raises(gridmesh.GridMeshError) as refused:
        gridmesh.trace_image(image)
    assert refused.value.kind == kind


@pytest.mark.parametrize(
    "image", [np.zeros((5, 5), int), np.zeros((5, 5), complex), [["a", "b"]], [[None, None]]]
)
def test_other_types_are_refused(image):
    with pytest.raises(TypeError, match="image is of type"):
        gridmesh.trace_image(image)


@pytest.mark.parametrize(
    "options",
    [
        {"threshold": 0.0},
        {"threshold": 1.0},
        {"threshold": float("nan")},
        {"threshold": "best"},
        {"smooth": -1},
        {"smooth": float("inf")},
        {"min_area": -1},
        {"min_area": float("nan")},
        {"margin": -0.1},
        {"margin": 1e9},
        {"background": "glass"},
    ],
)
def test_options_that_are_not_allowed(options):
    with pytest.raises(gridmesh.GridMeshError) as refused:
        gridmesh.trace_image(disk(5, 20), **options)
    assert refused.value.kind == "invalid_option"
    assert next(iter(options)) in str(refused.value)


def test_small_pictures():
    assert gridmesh.trace_image(np.zeros((3, 4))) == []
    assert gridmesh.trace_image(np.ones((1, 1))) == []
    [(outline, _)] = gridmesh.trace_image(np.ones((1, 1)), min_area=0)
    assert 0.4 < area(outline) < 1.1
    [(outline, _)] = gridmesh.trace_image(np.ones((1, 1)), min_area=0, margin=1)
    assert outline.min() < 0
    for shape in itertools.product((1, 2, 3), repeat=2):
        [(outline, _)] = gridmesh.trace_image(np.ones(shape), min_area=0)
        assert area(outline) <= shape[0] * shape[1] + 0.01


def test_work_can_be_cancelled_and_progress_rises():
    picture = np.random.default_rng(0).random((300, 300))
    seen = []
    gridmesh.trace_image(picture, progress=seen.append)
    assert seen == sorted(seen)
    assert 0 <= seen[0] < seen[-1] <= 1
    for stop in seen[:: max(len(seen) // 5, 1)]:
        with pytest.raises(gridmesh.GridMeshError) as refused:
            gridmesh.trace_image(picture, progress=lambda fraction, stop=stop: fraction < stop)
        assert refused.value.kind == "cancelled"


def test_results_are_plain_and_the_same_each_time():
    picture = coverage(placed([np.asarray(SHEETS["frog"]["points"], float)], 128), 128, 128)
    traced = gridmesh.trace_image(picture)
    assert isinstance(traced, list)
    outline = traced[0][0]
    assert outline.dtype == np.float64
    assert not outline.flags.writeable
    again = pickle.loads(pickle.dumps(traced))
    assert (again.dropped, again.threshold) == (traced.dropped, traced.threshold)
    assert again[0][0].tobytes() == gridmesh.trace_image(picture)[0][0].tobytes() == outline.tobytes()


def test_a_margin_leaves_no_slits():
    """Twemoji's figures came back with slits of a tenth of a pixel, which no mesh follows."""
    picture = np.ones((60, 60))
    picture[:40, 29:31] = 0.1
    [(outline, holes)] = gridmesh.trace_image(picture, margin=1)
    assert holes == []
    assert len(gridmesh.mesh_sketch(outline, triangles=200).triangles) < 230
    assert area(outline) > 60 * 60


@pytest.mark.parametrize("margin", [0.5, 1.0, 3.0, 40.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_a_margin_of_noise_meets_nothing(seed, margin):
    """Moved outlines of noise touch in single points, which no polygon may."""
    picture = (np.random.RandomState(seed).rand(250, 250) * 255).astype(np.uint8)
    traced = gridmesh.trace_image(picture, margin=margin, min_area=0)
    inside = sampled(contours_of(traced), 250, 250, 4)[::-1].reshape(250, 4, 250, 4)
    if margin >= 1:
        assert inside.all(axis=(1, 3))[picture >= 127.5].all()
    for outline, holes in traced:
        gridmesh.thickness(outline, holes)  # reads both, and refuses what meets itself
    before = np.concatenate([outline for outline, _ in gridmesh.trace_image(picture, min_area=0)])
    points = np.concatenate([outline for outline, _ in traced])
    moved = np.concatenate([before.min(axis=0) - points.min(axis=0), points.max(axis=0) - before.max(axis=0)])
    assert (moved > 0.98 * margin - 0.05).all()
    assert (moved < 3 * margin + 2).all()  # corners of polygons keep their angles


def test_a_margin_of_noise_can_be_cancelled():
    picture = (np.random.RandomState(120).rand(150, 200) > 0.5).astype(float)
    seen = []
    gridmesh.trace_image(picture, min_area=1, margin=100, progress=seen.append)
    assert seen == sorted(seen)
    late = [fraction for fraction in seen if fraction > 0.95]
    for stop in late[:: max(len(late) // 5, 1)]:
        with pytest.raises(gridmesh.GridMeshError) as refused:
            gridmesh.trace_image(picture, min_area=1, margin=100, progress=lambda f, stop=stop: f < stop)
        assert refused.value.kind == "cancelled"


def test_the_largest_outline_comes_first():
    """Smoothed, islands of nearly the same number of pixels may change their order."""
    picture = np.random.RandomState(3).rand(120, 120) > 0.5
    areas = [area(outline) for outline, _ in gridmesh.trace_image(picture, min_area=0)]
    assert len(areas) > 20
    assert all(first > second - 1e-6 for first, second in itertools.pairwise(areas))


def around(shape, turn, at):
    c, s = np.cos(turn), np.sin(turn)
    return shape @ [[c, s], [-s, c]] + at


def triangle(degrees, length=40.0):
    """An isosceles triangle with its tip first."""
    half = length * np.tan(np.radians(degrees / 2))
    return np.array([[length / 2, 0], [-length / 2, half], [-length / 2, -half]])


def limb(degrees, radius, length=40.0):
    """Straight sides that meet at an angle, and the round end that they touch."""
    half = np.radians(degrees / 2)
    turns = np.linspace(half - np.pi / 2, np.pi / 2 - half, 41)
    end = radius * np.column_stack([np.cos(turns), np.sin(turns)])
    back = length * np.array([-np.cos(half), np.sin(half)])
    return np.vstack([end[0] + back * [1, -1], end, end[-1] + back]) + [length / 2, 0]


def traced_tip(degrees, turn, x, y):
    """A drawn tip, and its outline traced back."""
    drawn = around(triangle(degrees), turn, [60 + x, 60 + y])
    picture = np.rint(255 * coverage([drawn], 120, 120)).astype(np.uint8)
    # Without a least area too: what the level leaves of a tip beyond a place where it is narrow is no island.
    [(outline, holes)] = gridmesh.trace_image(picture, min_area=0)
    assert holes == []
    return drawn, outline


@settings(max_examples=60, deadline=None)
@given(st.floats(14, 90), st.floats(0, 2 * np.pi), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_tips_come_back_at_any_angle_and_place(degrees, turn, x, y):
    drawn, outline = traced_tip(degrees, turn, x, y)
    assert np.hypot(*(outline - drawn[0]).T).min() < 1.5
    away = distance_to_curve(dense(outline, 1.0), drawn)
    assert np.quantile(away, 0.95) < 0.35
    assert away.max() < 1.5


def test_nearly_all_tips_come_back_within_seven_tenths_of_a_pixel():
    """Three of two thousand do not, by half a pixel at most."""
    rng = np.random.default_rng(1)
    tips = [(rng.uniform(14, 90), rng.uniform(0, 2 * np.pi), *rng.uniform(-0.5, 0.5, 2)) for _ in range(200)]
    off = [np.hypot(*(outline - drawn[0]).T).min() for drawn, outline in (traced_tip(*tip) for tip in tips)]
    assert np.quantile(off, 0.99) < 0.7


@pytest.mark.parametrize("turn", [0.2, 1.1, 2.6])
def test_tips_of_what_is_not_covered_come_back_too(turn):
    wedge = around(triangle(14), turn, [60.3, 59.8])
    picture = np.rint(255 * (1 - coverage([wedge], 120, 120))).astype(np.uint8)
    traced = gridmesh.trace_image(picture, min_area=0)
    [(_, [hole])] = traced
    assert np.hypot(*(hole - wedge[0]).T).min() < 0.7


@settings(max_examples=60, deadline=None)
@given(st.floats(0.1, 40), st.floats(1, 4), st.floats(0, 2 * np.pi), st.floats(-0.5, 0.5))
def test_round_ends_stay_round(degrees, radius, turn, x):
    drawn = around(limb(degrees, radius), turn, [60 + x, 60.2])
    picture = np.rint(255 * coverage([drawn], 120, 120)).astype(np.uint8)
    [(outline, _)] = gridmesh.trace_image(picture, min_area=0)
    end = around(np.array([[20 + radius, 0.0]]), turn, [60 + x, 60.2])[0]
    axis = np.array([np.cos(turn), np.sin(turn)])
    # The ends of limbs of two or three pixels are hard to tell from tips.
    assert ((outline - end) @ axis).max() < (0.7 if radius >= 1.5 else 1.5)


def test_thin_blurred_tips_are_not_longer_than_they_are():
    drawn = around(limb(20, 0.6), 0.4, [60.2, 60.1])
    alpha = coverage([drawn], 120, 120)
    for _ in range(2):
        alpha = (alpha + np.roll(alpha, 1, 0) + np.roll(alpha, 1, 1) + np.roll(alpha, (1, 1), (0, 1))) / 4
    traced = gridmesh.trace_image(np.rint(255 * alpha).astype(np.uint8))
    end = around(np.array([[20.6, 0.0]]), 0.4, [61.2, 59.1])[0]
    assert max(((outline - end) @ [np.cos(0.4), np.sin(0.4)]).max() for outline, _ in traced) < 1.0


def test_a_ring_of_pixels_that_touch_at_corners_stays_around_its_hole():
    rows = [
        "......#...",
        ".....#.#..",
        "......#...",
        "....##....",
        "..##..##..",
    ]
    image = np.pad(np.array([[c == "#" for c in row] for row in rows]), 2)
    for smooth in (0.0, 1.0, 2.0):
        for outline, holes in gridmesh.trace_image(image, min_area=0, smooth=smooth):
            gridmesh.thickness(outline, holes)  # reads both, and refuses what meets itself
    noise = np.random.default_rng(2)
    for _ in range(10):
        for outline, holes in gridmesh.trace_image(noise.random((100, 100)) < 0.4, min_area=0):
            gridmesh.thickness(outline, holes)
