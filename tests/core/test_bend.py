"""Lattices that bend with the drawing: what they promise beside what every patch does."""

import pickle

import gridmesh
import numpy as np
import pytest
from checks import check_patch
from sketches import DRAWINGS, SHAPES, blob, circle


def mesh_sketch(*drawing, bend=1.0, **options):
    return gridmesh.mesh_sketch(*drawing, bend=bend, **options)


def blobs(count):
    random = np.random.default_rng(5)
    return [
        blob(list(random.uniform(-0.2, 0.2, 5)), list(random.uniform(0, 6, 5)), 200) for _ in range(count)
    ]


def limb(angle):
    """A bar askew, twelve times as long as wide."""
    box = np.array([[-6.0, -0.5], [6.0, -0.5], [6.0, 0.5], [-6.0, 0.5]])
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return box @ turn


def with_a_foot(angle):
    """A disc with a bar that runs askew to another."""
    t = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    x, y = np.cos(t), np.sin(t)
    radius = 1 + 2.2 * np.exp(-0.5 * (np.angle(np.exp(1j * t)) / 0.16) ** 2)
    radius += 2.2 * np.exp(-0.5 * (np.angle(np.exp(1j * (t - angle))) / 0.16) ** 2)
    return np.column_stack([radius * x, radius * y])


@pytest.mark.parametrize("triangles", [300, 2000, 9000])
def test_drawings_have_fewer_irregular_vertices_than_on_straight_lattices(triangles):
    irregular = []
    for drawing in DRAWINGS.values():
        points = drawing["points"]
        straight, bent = (mesh_sketch(points, triangles=triangles, bend=b) for b in (0, 1))
        check_patch(bent, [points])
        assert straight.report["bend"] == 0
        assert straight.report["scale_range"] == 1
        irregular.append((straight.report["irregular"], bent.report["irregular"]))
    straight, bent = np.array(irregular).sum(axis=0)
    # Coarse meshes are straight where a bend would cut off a corner of the drawing.
    assert bent <= {300: 0.97, 2000: 0.8, 9000: 0.65}[triangles] * straight


def test_the_number_of_irregular_vertices_hardly_grows_with_the_triangles():
    few, many = (
        sum(mesh_sketch(points, triangles=n).report["irregular"] for points in blobs(20))
        for n in (2000, 16000)
    )
    assert many <= few * 4 / 3


def test_limbs_askew_are_followed_without_steps():
    straight, bent = (mesh_sketch(with_a_foot(0.9), triangles=3000, bend=b) for b in (0, 1))
    assert bent.report["irregular"] <= 0.75 * straight.report["irregular"]
    assert bent.report["bend"] > 0
    assert bent.report["scale_range"] > 1


def test_a_straight_bar_needs_no_bend():
    for angle in (0.0, 0.4, 1.0):
        report = mesh_sketch(limb(angle), triangles=1500).report
        assert report["irregular"] <= 6 + 2


def test_outlines_with_holes_bend_too():
    outline, hole = 4 * blobs(3)[2], circle(60, 0.6)[::-1] + [0.3, 0.2]
    straight, bent = (mesh_sketch(outline, [hole], triangles=4000, bend=b) for b in (0, 1))
    check_patch(bent, [outline, hole])
    assert bent.report["bend"] > 0
    assert bent.report["irregular"] < straight.report["irregular"]


def test_a_drawing_whose_bent_image_overlaps_itself_is_meshed():
    # A spiral of one and a half turns.
    t = np.linspace(0.4, 3.4 * np.pi, 160)
    wall = [np.column_stack([r * np.cos(t), r * np.sin(t)]) for r in (0.4 * t, 0.4 * t + 0.9)]
    spiral = np.vstack([wall[0], wall[1][::-1]])
    check_patch(mesh_sketch(spiral, triangles=3000), [spiral])


def test_straight_is_what_is_asked_for_by_an_angle_an_origin_or_growth():
    points = blobs(1)[0]
    for options in ({"angle": 0.2}, {"origin": (0.0, 0.0), "angle": 0.1}, {"boundary": "grown"}, {"bend": 0}):
        assert mesh_sketch(points, triangles=1000, **options).report["bend"] == 0


def test_half_a_bend_is_less_of_one():
    points = with_a_foot(0.9)
    ranges = [mesh_sketch(points, triangles=3000, bend=b).report["scale_range"] for b in (0.02, 1)]
    assert 1 <= ranges[0] < ranges[1]


@pytest.mark.parametrize("name", [*SHAPES, *DRAWINGS])
def test_the_same_drawing_bends_the_same_way_however_it_lies(name):
    points = {**SHAPES, **DRAWINGS}[name]["points"]
    try:
        expected = mesh_sketch(points, triangles=1500)
    except gridmesh.GridMeshError:
        return
    small = mesh_sketch(points[::-1] * 0.125, triangles=1500)
    assert (small.vertices * 8).tobytes() == expected.vertices.tobytes()
    assert small.report["scale_range"] == expected.report["scale_range"]


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_symmetric_drawings_bend_symmetrically(turn):
    half = np.linspace(0, np.pi, 80)
    radius = 2 + 0.7 * np.cos(3 * half) + 0.3 * np.cos(2 * half)
    right = np.column_stack([radius * np.sin(half), -radius * np.cos(half)])[1:-1]
    points = np.vstack([[[0, -radius[0]]], right, [[0, radius[-1]]], right[::-1] * [-1, 1]])
    points = points @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    straight, bent = (mesh_sketch(points, triangles=4000, mirror="auto", bend=b) for b in (0, 1))
    check_patch(bent, [points])
    assert bent.report["bend"] > 0
    assert bent.report["irregular"] < straight.report["irregular"]
    assert bent.report["mirror_error"] < 1e-9


def lengths_near(patch, at, radius):
    edges = np.concatenate([patch.triangles[:, [0, 1]], patch.triangles[:, [1, 2]]])
    ends = patch.vertices[edges]
    near = np.linalg.norm(ends.mean(axis=1) - at, axis=1) < radius
    return np.median(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)[near])


def test_density_makes_triangles_smaller_where_it_is_asked_for():
    points = circle(120)
    density = np.where(points[:, 0] > 0.3, 4.0, 1.0)
    patch = mesh_sketch(points, triangles=2000, density=density)
    check_patch(patch, [points])
    assert lengths_near(patch, [0.8, 0], 0.3) < 0.8 * lengths_near(patch, [-0.8, 0], 0.3)
    again = mesh_sketch(points[::-1], triangles=2000, density=density[::-1])
    assert again.vertices.tobytes() == patch.vertices.tobytes()


def test_density_reaches_holes():
    points, hole = circle(120), circle(40, 0.2)[::-1] + [0.4, 0]
    # Not all around: the lattice has as many turns there as anywhere.
    density = [np.ones(120), np.where(hole[:, 0] > 0.45, 8.0, 1.0)]
    plain = mesh_sketch(points, [hole], triangles=3000, bend=0)
    dense = mesh_sketch(points, [hole], triangles=3000, density=density)
    check_patch(dense, [points, hole])
    assert lengths_near(dense, [0.65, 0], 0.15) < 0.9 * lengths_near(plain, [0.65, 0], 0.15)


def test_narrow_parts_get_more_triangles_by_width():
    points = with_a_foot(1.4)
    plain, even, wide, most = (
        mesh_sketch(points, triangles=1500, density=d) for d in (None, 0, "width", 1.0)
    )
    tip = points[np.argmax(points[:, 0])] - [0.4, 0]
    assert lengths_near(wide, tip, 0.5) <= lengths_near(plain, tip, 0.5)
    assert lengths_near(wide, tip, 0.5) < lengths_near(even, tip, 0.5)
    assert wide.vertices.tobytes() == most.vertices.tobytes()


def star(random):
    """A disc with round limbs of even width at random angles, and the middles of their ends."""
    n, width = random.integers(2, 6), random.uniform(0.2, 0.5)
    angles = 2 * np.pi / n * (np.arange(n) + random.uniform(0, 0.6, n))
    half = np.arcsin(width / 2)
    outline, ends = [], []
    for k, angle in enumerate(angles):
        ahead = np.array([np.cos(angle), np.sin(angle)])
        aside = np.array([-ahead[1], ahead[0]]) * width / 2
        along = np.linspace(np.cos(half), 2.2 - width / 2, 12)[:, None] * ahead
        ends.append(along[-1])
        round_end = np.linspace(-np.pi / 2, np.pi / 2, 12)[1:-1, None]
        cap = ends[-1] + width / 2 * np.cos(round_end) * ahead + np.sin(round_end) * aside
        after = angles[(k + 1) % n] + 2 * np.pi * (k + 1 == n)
        rest = np.linspace(angle + half, after - half, 10)[1:-1]
        body = np.column_stack([np.cos(rest), np.sin(rest)])
        outline += [along - aside, cap, along[::-1] + aside, body]
    return np.vstack(outline), np.array(ends), width


def test_limbs_are_no_coarser_than_on_a_straight_lattice_where_sizes_matter():
    random = np.random.default_rng(1)
    coarser, irregular = [], []
    for _ in range(24):
        points, ends, width = star(random)
        plain = mesh_sketch(points, triangles=1500, bend=0)
        minded, free = (mesh_sketch(points, triangles=1500, density=d) for d in (0, None))
        check_patch(minded, [points])
        sizes = [[lengths_near(p, end, width) for end in ends] for p in (minded, plain)]
        coarser.append(max(np.divide(*sizes)))
        irregular.append([p.report["irregular"] for p in (minded, free, plain)])
    assert np.mean(coarser) <= 1
    assert max(coarser) <= 1.3
    minded, free, plain = np.sum(irregular, axis=0)
    assert free <= minded <= 0.95 * plain


def test_on_a_straight_lattice_thin_parts_are_as_fine_as_on_one():
    points = with_a_foot(1.4)
    plain, minded = (mesh_sketch(points, triangles=1500, bend=0, density=d) for d in (None, 0))
    assert plain.vertices.tobytes() == minded.vertices.tobytes()


def test_lattices_bend_unless_told_otherwise():
    points = with_a_foot(0.9)
    given, plain = mesh_sketch(points, triangles=2000), gridmesh.mesh_sketch(points, triangles=2000)
    assert plain.report["bend"] > 0
    assert plain.vertices.tobytes() == given.vertices.tobytes()


@pytest.mark.parametrize("angle", [12, 20, 30])
def test_sharp_tips_are_blunted_by_two_edges_at_most(angle):
    # A disc with a spike; two triangles share the angle of a tip.
    t = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    disc = np.column_stack([np.cos(t), np.sin(t)])
    half = np.radians(angle / 2)
    points = np.vstack([disc[np.abs(t - np.pi) < np.pi - half * 1.5], [[np.cos(half) + 1.2, 0.0]]])
    for triangles in (1000, 4000):
        patch = mesh_sketch(points, triangles=triangles)
        check_patch(patch, [points])
        assert np.degrees(patch.report["min_angle"]) > 12
        assert patch.report["max_deviation"] <= 2


@pytest.mark.parametrize("angle", [22, 26, 30])
def test_tips_with_no_drawn_points_beside_them_are_blunted(angle):
    # A kite: vertices that are held beside its tip lie between drawn points.
    half = np.radians(angle / 2)
    points = np.array([[0.0, -1.0], [1 / np.tan(half), 0.0], [0.0, 1.0], [-1.0, 0.0]])
    for triangles in (800, 2000, 8000):
        patch = mesh_sketch(points, triangles=triangles)
        check_patch(patch, [points])
        # More than two triangles that shared the tip could have.
        assert np.degrees(patch.report["min_angle"]) > 0.5 * angle + 2
        assert patch.report["max_deviation"] <= 2


def test_no_edges_are_much_longer_than_most():
    for drawing in DRAWINGS.values():
        patch = mesh_sketch(drawing["points"], triangles=3000)
        edges = np.concatenate([patch.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        lengths = np.linalg.norm(np.diff(patch.vertices[edges], axis=1)[:, 0], axis=1)
        assert np.percentile(lengths, 99) <= 2.5 * np.median(lengths)


def stay(patch, other):
    """The share of a patch's vertices that lie where one of another lies."""
    apart = np.linalg.norm(patch.vertices[:, None] - other.vertices[None], axis=2).min(axis=1)
    return np.mean(apart < 0.02 * other.edge_length)


def test_the_first_step_of_a_drag_leaves_the_triangles_where_they_are():
    for drawing in [*blobs(6), *(np.array(d["points"], float) for d in list(DRAWINGS.values())[:4])]:
        patch = mesh_sketch(drawing, triangles=1500)
        assert patch.report["bend"] > 0
        moved = drawing * (1 + 1e-6 * np.sin(np.arange(len(drawing)))[:, None])
        kept = gridmesh.mesh_sketch(moved, keep=patch)
        assert np.array_equal(kept.triangles, patch.triangles)
        away = np.abs(kept.vertices - patch.vertices).max(axis=1) / patch.edge_length
        # At a drawn corner or two that no vertex has, vertices may slide along the outline.
        assert (away > 0.2).mean() < 0.01
        assert away.max() < 1


def test_a_kept_lattice_stays_with_its_bend_while_a_part_is_moved():
    shares = []
    for points in blobs(5):
        patch = last = mesh_sketch(points, triangles=1500)
        assert patch.report["bend"] > 0
        again = gridmesh.mesh_sketch(points, keep=patch)
        assert again.report["bend"] == patch.report["bend"]
        assert stay(again, patch) > 0.9
        away = np.minimum(np.arange(200), 200 - np.arange(200))
        weight = np.exp(-0.5 * (away / 6) ** 2)[:, None]
        for step in range(1, 4):
            moved = points + weight * points[0] / np.linalg.norm(points[0]) * patch.edge_length * step / 2
            last = gridmesh.mesh_sketch(moved, keep=last)
            check_patch(last, [moved])
            shares.append(stay(last, patch))
    assert np.median(shares) > 0.8


def test_a_kept_lattice_may_be_straight():
    points = blobs(1)[0]
    straight = mesh_sketch(points, triangles=800, bend=0)
    kept = gridmesh.mesh_sketch(points, keep=straight)
    assert kept.report["bend"] == 0
    assert stay(kept, straight) > 0.9
    # A pickled patch has lost its bend, not its lattice.
    bent = mesh_sketch(points, triangles=800)
    assert gridmesh.mesh_sketch(points, keep=pickle.loads(pickle.dumps(bent))).report["bend"] == 0


def test_an_outline_that_has_left_the_bent_lattice_is_meshed_all_the_same():
    patch = mesh_sketch(blobs(1)[0], triangles=800)
    check_patch(
        gridmesh.mesh_sketch(with_a_foot(0.9) + [3.0, 1.0], keep=patch), [with_a_foot(0.9) + [3.0, 1.0]]
    )


@pytest.mark.parametrize("option", ["triangles", "edge_length", "angle", "origin", "mirror"])
def test_what_a_kept_lattice_decides_is_not_asked_for_beside_it(option):
    patch = mesh_sketch(circle(), triangles=300)
    given = {"triangles": 300, "edge_length": 0.1, "angle": 0.1, "origin": (0, 0), "mirror": "auto"}[option]
    with pytest.raises(gridmesh.GridMeshError) as refused:
        gridmesh.mesh_sketch(circle(), keep=patch, **{option: given})
    assert refused.value.kind == "invalid_option"
    with pytest.raises(TypeError):
        gridmesh.mesh_sketch(circle(), keep=3)


@pytest.mark.parametrize(
    ("options", "kind"),
    [
        ({"bend": 1.5}, "invalid_option"),
        ({"bend": np.nan}, "invalid_option"),
        ({"density": np.ones(99)}, "invalid_option"),
        ({"density": -np.ones(100)}, "invalid_option"),
        ({"density": "height"}, "invalid_option"),
        ({"density": 1.5}, "invalid_option"),
        ({"density": "width", "bend": 0}, "invalid_option"),
        ({"density": np.ones(100), "self_crossing": "union"}, "invalid_option"),
    ],
)
def test_what_is_not_allowed_is_refused(options, kind):
    with pytest.raises(gridmesh.GridMeshError) as refused:
        mesh_sketch(circle(), triangles=500, **options)
    assert refused.value.kind == kind
