"""`join`: what is guaranteed of bodies made one."""

import pickle
import sys
from pathlib import Path

import gridmesh
import numpy as np
import pytest
import sketches
from hypothesis import given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaign"))

import joins
from joins import Case, fanned, faults, least_angle, measure

TAU = 2 * np.pi


def ball(at=(0, 0, 0), radius=1.0, edge=0.12):
    """A round body of triangles."""
    vertices, triangles = joins.body(radius * sketches.circle(120), edge, 1.0)
    return vertices + np.asarray(at, float), triangles


def bar(size, at=(0, 0, 0), cells=None):
    """A box of quads, `cells` along each axis."""
    cells = np.asarray(cells if cells is not None else np.maximum(2, np.round(np.array(size) / 0.15)), int)
    number, vertices, quads = {}, [], []

    def vertex(point):
        if point not in number:
            number[point] = len(vertices)
            vertices.append(np.array(point) / cells * size - np.array(size) / 2 + at)
        return number[point]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, cells[axis]):
            for i in range(cells[u]):
                for j in range(cells[v]):
                    face = []
                    for a, b in [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]:
                        point = [0, 0, 0]
                        point[axis], point[u], point[v] = int(side), a, b
                        face.append(vertex(tuple(point)))
                    quads.append(face if side else face[::-1])
    return np.array(vertices), np.array(quads)


def torus(at=(0, 0, 0), radius=1.0, tube=0.3, n=48, m=16):
    """A ring of triangles around the z axis."""
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    s, t = TAU * i / n, TAU * (j + 0.5 * (i % 2)) / m
    ring = radius + tube * np.cos(t)
    vertices = np.stack([ring * np.cos(s), ring * np.sin(s), tube * np.sin(t)], axis=-1).reshape(-1, 3)
    number = lambda i, j: (i % n) * m + j % m  # noqa: E731
    a, b, c, d = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
    even = (i % 2 == 0)[..., None]
    one = np.where(even, np.stack([a, b, d], -1), np.stack([a, b, c], -1)).reshape(-1, 3)
    two = np.where(even, np.stack([b, c, d], -1), np.stack([a, c, d], -1)).reshape(-1, 3)
    return vertices + np.asarray(at, float), np.vstack([one, two])


def joined(*parts, **options):
    """The joined mesh, checked."""
    made = gridmesh.join(parts, **options)
    assert not faults(parts, made)
    return made


def kind_of(*parts, **options):
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.join(parts, **options)
    return caught.value.kind, str(caught.value)


def border_of(made):
    """Of the line between faces of different parts: the edges, how much it turns at each vertex in degrees."""
    triangles, face = fanned(made)
    sides = np.sort(np.vstack([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    part = np.tile(made.near_part[face], 3)
    order = np.lexsort(sides.T)
    pairs, parts = sides[order].reshape(-1, 2, 2)[:, 0], part[order].reshape(-1, 2)
    line = pairs[parts[:, 0] != parts[:, 1]]
    ends = np.unique(line)
    beside = [line[(line == v).any(axis=1)] for v in ends]
    assert all(len(edges) == 2 for edges in beside)
    turns = []
    for v, edges in zip(ends, beside, strict=True):
        ahead = made.vertices[edges[edges != v]] - made.vertices[v]
        ahead /= np.linalg.norm(ahead, axis=1)[:, None]
        turns.append(180 - np.degrees(np.arccos(np.clip(ahead[0] @ ahead[1], -1, 1))))
    return line, np.array(turns)


# --------------------------------------------------------------------------------------------------- topology


def test_two_balls_become_one_body_by_a_tube():
    made = joined(ball(), ball((1.3, 0.1, 0.2), 0.8))
    report = made.report
    assert (report["components"], report["genus"], report["collars"], report["tubes"]) == (1, 0, 1, 1)
    assert report["self_intersections"] == 0
    assert abs(report["volume"] / report["exact_volume"] - 1) < 0.03
    assert measure(made, 0).angle > 15
    assert (made.source_part < 0).sum() == report["collar_triangles"]


def test_parts_that_do_not_meet_stay_apart():
    parts = ball(), ball((5, 0, 0)), ball((0, 5, 0))
    made = joined(*parts)
    assert (made.report["components"], made.report["alone"], made.report["collars"]) == (3, 3, 0)
    assert np.array_equal(made.vertices, np.vstack([vertices for vertices, _ in parts]))
    assert len(made.triangles) == sum(len(triangles) for _, triangles in parts)


def test_a_part_within_another_vanishes():
    made = joined(ball(), ball(radius=0.4))
    assert (made.report["components"], made.report["swallowed"]) == (1, 1)
    assert set(made.vertex_part) == {0}


def test_a_handle_raises_the_genus():
    made = joined(ball(radius=1.0), torus((1.0, 0, 0), 0.8, 0.2))
    assert (made.report["components"], made.report["genus"], made.report["collars"]) == (1, 1, 2)
    assert made.report["tubes"] >= 1


def test_a_bar_through_a_ball():
    made = joined(ball(), bar((4.0, 0.6, 0.6)))
    assert (made.report["components"], made.report["genus"], made.report["collars"]) == (1, 0, 2)


def test_three_parts_in_one_place():
    made = joined(ball(), ball((1.0, 0, 0)), ball((0.5, 0.9, 0)))
    assert (made.report["components"], made.report["genus"]) == (1, 0)
    assert made.report["self_intersections"] == 0


def test_one_part_comes_back_as_it_was():
    vertices, triangles = ball()
    made = joined((vertices, triangles))
    assert np.array_equal(made.vertices, vertices)
    assert np.array_equal(made.triangles, triangles)


@pytest.mark.parametrize("at", [(1.3, 0.1, 0.2), (0.3, 0.2, 0.9), (0, 1.1, 0.4)])
@pytest.mark.parametrize("blend", [0.0, 3.0])
def test_the_border_between_parts_runs_along_the_line_without_teeth(at, blend):
    parts = ball(), ball(at, 0.5, edge=0.1)
    made = joined(*parts, blend=blend, border=True)
    plain = joined(*parts, blend=blend)
    old, before = made.source_part >= 0, plain.source_part >= 0
    assert np.array_equal(made.source_part[old], plain.source_part[before])
    assert np.array_equal(made.source_face[old], plain.source_face[before])
    assert np.array_equal(made.near_part[old], made.source_part[old])
    assert set(made.near_part) == {0, 1}
    assert set(plain.near_part) == {-1, 0, 1}
    old, before = made.vertex_part >= 0, plain.vertex_part >= 0
    assert np.array_equal(made.vertices[old], plain.vertices[before])
    # Edges are 0.1 long, and the line may get vertices of its own.
    off = made.vertices[~old][:, None] - plain.vertices[None]
    assert np.linalg.norm(off, axis=2).min(axis=1).max() < 0.15
    assert least_angle(made.vertices[made.triangles[made.source_part[: len(made.triangles)] < 0]]) > 15
    line, turns = border_of(made)
    assert turns.max() < 40
    # It lies on a circle about the line between the middles, where both balls are equally near.
    place = made.vertices[np.unique(line)]
    off = np.linalg.norm(place, axis=1) - 1 - (np.linalg.norm(place - at, axis=1) - 0.5)
    assert np.percentile(np.abs(off), 90) < 0.03


def test_the_border_in_narrow_patches_has_no_teeth():
    """Edges run from rim to rim there, and the line gets vertices of its own; it had teeth in one of three such patches."""
    random = np.random.default_rng(3)
    corners, angles = [], []
    for _ in range(30):
        way = random.normal(size=3)
        at = way / np.linalg.norm(way) * random.uniform(0.8, 1.35)
        made = joined(ball(), ball(tuple(at), random.uniform(0.4, 0.7), edge=0.1), blend=1.5, border=True)
        corners.append((border_of(made)[1] > 40).sum())
        angles.append(np.degrees(made.report["min_angle"]))
    assert np.mean(np.array(corners) == 0) >= 0.9
    assert max(corners) <= 2
    assert min(angles) > 12


@pytest.mark.parametrize(("number", "blend"), [(17, 2.0), (21, 2.0), (25, 0.5), (34, 0.5)])
def test_a_border_makes_no_patch_worse(number, blend):
    """In these patches a smooth line made triangles meet, or left angles of 3 degrees."""
    parts = joins.case(5, number).parts
    plain, made = (gridmesh.join(parts, blend=blend, border=border) for border in (False, True))
    assert made.report["self_intersections"] <= plain.report["self_intersections"]
    assert np.degrees(made.report["min_angle"]) >= 8
    assert not faults(parts, made)


def test_lines_run_only_between_parts_of_different_colors():
    parts = ball(), ball((1.1, 0, 0), 0.5, edge=0.1), ball((0, 1.1, 0), 0.5, edge=0.1)
    plain, made, every = (joined(*parts, blend=1.0, border=it) for it in (False, [4, 4, 7], True))
    assert set(made.near_part) == {0, 1, 2}
    # Of the two joints the one between parts of one colour is as it is without lines, the other one as with all of them.
    places = [{tuple(p) for p in it.vertices[it.vertex_part < 0]} for it in (plain, made, every)]
    assert places[1] <= places[0] | places[2]
    assert places[1] & (places[0] - places[2])
    assert places[1] & (places[2] - places[0])
    same = joined(*parts, blend=1.0, border=[1, 1, 1])
    assert np.array_equal(same.vertices, plain.vertices)
    assert np.array_equal(same.triangles, plain.triangles)


def test_colors_of_a_border_that_are_not_one_for_each_part():
    kind, message = kind_of(ball(), ball((1.1, 0, 0), 0.5), border=[1, 2, 3])
    assert kind == "invalid_option"
    assert "as many numbers as parts" in message
    with pytest.raises(TypeError, match="border"):
        gridmesh.join([ball()], border="red")
    for colors in ([-1, 2], [0, 2**32]):
        kind, message = kind_of(ball(), ball((1.1, 0, 0), 0.5), border=colors)
        assert kind == "invalid_option"
        assert "a whole number from 0 to 4294967295 for each part" in message


def test_the_border_of_one_material_over_three_parts():
    parts = ball(), ball((1.1, 0, 0), 0.5, edge=0.1), ball((1.3, 0.3, 0.2), 0.35, edge=0.08)
    made = joined(*parts, border=True)
    assert made.report["self_intersections"] == 0
    assert set(made.near_part) == {0, 1, 2}
    # Each part's faces hang together.
    triangles, face = fanned(made)
    for part in range(3):
        own = triangles[made.near_part[face] == part]
        assert joins.pieces(own) == 1


def test_a_small_part_on_others_is_blended():
    """The groove between two large parts may change more volume than a small third one has."""
    parts = ball(), ball((0.9, 0, 0), 0.6, edge=0.1), ball((0.95, 0.45, 0.35), 0.14, edge=0.06)
    report = joined(*parts, blend=1.5).report
    assert (report["creased"], report["exact"], report["self_intersections"]) == (0, 0, 0)
    assert np.degrees(report["min_angle"]) > 15


def test_a_part_inside_out_is_turned():
    vertices, triangles = ball((1.3, 0, 0))
    made = gridmesh.join([ball(), (vertices, triangles[:, ::-1])])
    assert (made.report["turned"], made.report["components"], made.report["genus"]) == (1, 1, 0)
    assert joins.volume(made.vertices, fanned(made)[0]) > 0


# ------------------------------------------------------------------------------------------------- what stays


def test_quads_stay_quads_outside_the_collar():
    parts = bar((3.0, 1.0, 1.0)), bar((0.6, 0.6, 2.4), (0.1, 0.02, 0.9))
    made = joined(*parts)
    assert made.report["components"] == 1
    assert len(made.quads) > 0.5 * sum(len(quads) for _, quads in parts)
    assert np.all(made.source_part[len(made.triangles) :] >= 0)
    assert np.all(made.source_part[: len(made.triangles)] == -1)


def test_polygons_are_taken_and_stay():
    vertices, quads = bar((3.0, 1.0, 1.0))
    corners, offsets = quads.ravel(), np.arange(0, quads.size + 1, 4)
    # Two quads on the far end as one face of six corners.
    left = [k for k, quad in enumerate(quads) if (vertices[quad][:, 0] < -1.49).all()]
    one = quads[left[0]]
    other = next(quads[k] for k in left[1:] if len(set(quads[k]) & set(one)) == 2)
    a = next(i for i in range(4) if one[i] in other and one[(i + 1) % 4] in other)
    b = next(i for i in range(4) if other[i] == one[a])
    both = np.r_[[one[(a + k) % 4] for k in range(1, 5)], [other[(b + k) % 4] for k in range(1, 3)]]
    rest = np.array(
        [quad for quad in quads if not (np.array_equal(quad, one) or np.array_equal(quad, other))]
    )
    corners = np.r_[rest.ravel(), both]
    offsets = np.r_[np.arange(0, rest.size + 1, 4), rest.size + 6]
    made = gridmesh.join([(vertices, (corners, offsets)), ball((1.5, 0, 0), 0.4)])
    assert made.offsets[-1] - made.offsets[-2] == 6
    assert made.source_face[-1] == len(rest)
    assert made.report["components"] == 1


def test_collars_lie_near_the_line_where_surfaces_meet():
    parts = ball(edge=0.08), ball((1.2, 0, 0), edge=0.08)
    wide, narrow = joined(*parts, blend=3.0), joined(*parts, blend=1.0)
    fresh = lambda made: made.vertices[made.vertex_part < 0]  # noqa: E731
    # Two equal balls meet in the plane between them.
    assert np.abs(fresh(wide)[:, 0] - 0.6).max() < 4.2 * 0.08
    assert np.abs(fresh(narrow)[:, 0] - 0.6).max() < 2.2 * 0.08
    kept = wide.vertices[wide.vertex_part >= 0]
    assert np.abs(kept[:, 0] - 0.6).min() > 1.2 * 0.08
    assert len(fresh(wide)) > len(fresh(narrow))


def test_a_given_edge_length_is_what_the_blend_counts_in():
    parts = ball(edge=0.08), ball((1.2, 0, 0), edge=0.08)
    one, two = joined(*parts, blend=2.0, edge_length=0.1), joined(*parts, blend=1.0, edge_length=0.2)
    assert np.array_equal(one.vertices, two.vertices)
    assert len(one.vertices) != len(joined(*parts, blend=2.0, edge_length=0.2).vertices)


# ---------------------------------------------------------------------------------------------------- creases


def test_without_blend_the_line_stays_sharp_and_even():
    made = joined(ball(edge=0.1), ball((1.2, 0, 0), edge=0.1), blend=0.0)
    assert made.report["components"] == 1
    on_line = np.abs(made.vertices[:, 0] - 0.6) < 0.02
    line = made.vertices[on_line & (made.vertex_part < 0)]
    # The balls meet in a circle, which is there.
    radius = np.hypot(line[:, 1], line[:, 2])
    assert len(line) > 20
    assert radius.min() > 0.72
    found = measure(made, 0)
    assert found.ratio < 4
    assert found.volume < 0.005
    assert found.angle > 10


def test_boxes_without_blend_keep_their_edges():
    parts = bar((2.0, 1.0, 1.0), cells=(16, 8, 8)), bar((0.5, 0.5, 2.0), (0.03, 0.02, 0.3), cells=(4, 4, 16))
    made = joined(*parts, blend=0.0)
    assert abs(made.report["volume"] / made.report["exact_volume"] - 1) < 1e-3


# ------------------------------------------------------------------------------------------------------ traps


def test_bodies_in_one_plane_share_the_plane_of_their_silhouettes():
    circle = sketches.circle(120)
    parts = [joins.body(circle, 0.1, 0.8), joins.body(0.6 * circle + [1.1, 0.2], 0.1, 0.8)]
    assert all((vertices[:, 2] == 0).any() for vertices, _ in parts)
    made = joined(*parts)
    assert (made.report["components"], made.report["genus"], made.report["self_intersections"]) == (1, 0, 0)


def test_an_arm_thinner_than_its_collar():
    arm = joins.body(np.array([[-0.5, -0.06], [0.5, -0.06], [0.5, 0.06], [-0.5, 0.06]]) + [1.3, 0], 0.05, 1.0)
    made = joined(ball(), arm, blend=4.0)
    assert (made.report["components"], made.report["genus"]) == (1, 0)


def test_arms_side_by_side_whose_collars_would_touch():
    arm = lambda y: bar((2.0, 0.4, 0.4), (1.3, y, 0), cells=(20, 4, 4))  # noqa: E731
    made = joined(ball(edge=0.08), arm(0.32), arm(-0.32))
    assert (made.report["components"], made.report["genus"], made.report["curves"]) == (1, 0, 2)
    assert made.report["self_intersections"] == 0


@pytest.mark.parametrize("blend", [1.0, 2.0, 5.0])
def test_a_blend_wider_than_a_part_leaves_the_part(blend):
    """It becomes narrower, and where even that is too wide, the line stays as a crease, with even triangles.

    One end of a bar in a ball of few faces is left with a crease or without, as its blend may change the volume by more than 3 % or not.
    """
    turn = joins.rotation(np.array([1.0, 2, 3]), 0.7).T
    vertices, triangles = torus(n=6, m=4)
    bar_vertices, quads = bar((0.6, 0.6, 3), cells=(1, 1, 1))
    for parts, creased in (
        (((vertices, triangles), (vertices @ turn + [0.9, 0.3, 0.1], triangles)), {1}),
        ((bar((1, 1, 4), cells=(1, 1, 4)), (bar_vertices @ turn, quads)), {1}),
        ((ball(edge=0.3), (bar_vertices @ turn + [0.3, 0, 0.4], quads)), {0, 1}),
    ):
        report = joined(*parts, blend=blend).report
        assert abs(report["volume"] / report["exact_volume"] - 1) <= (0.1 if blend > 2 else 0.03)
        assert report["creased"] in creased
        assert (report["exact"], report["self_intersections"]) == (0, 0)


@pytest.mark.parametrize("at", [(4.5, 0, 0), (0, 0, 0.3)])
def test_a_bar_of_few_faces_in_a_fine_ball_is_not_cut_off(at):
    vertices, quads = bar((8, 0.6, 0.6), cells=(1, 1, 1))
    report = joined(ball(edge=0.02), (vertices + at, quads)).report
    assert abs(report["volume"] / report["exact_volume"] - 1) < 0.05


@pytest.mark.parametrize("edge", [0.25, 0.18])
def test_blends_of_coarse_parts_hardly_change_the_volume(edge):
    """Two edges wide they would fill the groove between two balls of few triangles; asked for, they may."""
    wide, plain = (joined(ball(edge=edge), ball((1.3, 0, 0), edge=edge), blend=blend) for blend in (4.0, 2.0))
    of = lambda made: abs(made.report["volume"] / made.report["exact_volume"] - 1)  # noqa: E731
    assert of(plain) <= 0.03
    assert plain.report["genus"] == 0
    assert wide.report["collar_triangles"] > plain.report["collar_triangles"]


@pytest.mark.parametrize("moved", [0.0, 0.001, 0.03, 0.1, 0.3])
def test_blends_of_parts_that_nearly_coincide_hardly_change_the_volume(moved):
    """Surfaces that meet everywhere leave no room for a blend: it would take a corner of the bodies, or half of them, away."""
    box, round_ = bar((2.2, 1.4, 1.8), cells=(4, 4, 4)), ball(edge=0.25)
    for vertices, faces in (box, round_):
        made = joined((vertices, faces), (vertices + (moved, 0, 0), faces))
        assert abs(made.report["volume"] / made.report["exact_volume"] - 1) <= 0.03
        assert made.report["components"] == 1


def test_edge_lengths_of_one_to_four_are_graded():
    made = joined(ball(edge=0.16), ball((1.2, 0, 0), 0.7, edge=0.04))
    assert made.report["components"] == 1
    found = measure(made, 0)
    assert found.ratio < 2
    assert found.angle > 12


@pytest.mark.parametrize("gap", [-1e-6, 0.0, 1e-6, 1e-3])
def test_touching_in_a_point_is_closed_or_refused(gap):
    parts = ball(), ball((2 + gap, 0, 0))
    try:
        made = joined(*parts)
    except gridmesh.GridMeshError as error:
        assert error.kind == "join_failed"
        return
    assert made.report["genus"] == 0


def test_coplanar_faces_and_equal_parts():
    box = bar((2.0, 1.0, 1.0))
    beside = bar((1.0, 1.0, 1.0), (1.5, 0, 0), cells=(7, 7, 7))
    for parts in [(box, box), (box, beside), (ball(), ball())]:
        try:
            made = joined(*parts)
        except gridmesh.GridMeshError as error:
            assert error.kind == "join_failed"
            continue
        assert made.report["components"] == 1
        assert made.report["genus"] == 0


@settings(deadline=None, max_examples=25)
@given(
    st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.floats(-1, 1)),
    st.floats(0.3, 1.2),
    st.sampled_from([0.0, 0.5, 1.0, 2.0, 5.0]),
)
def test_balls_anywhere(at, radius, blend):
    try:
        made = joined(ball(edge=0.2), ball(at, radius, edge=0.2), blend=blend)
    except gridmesh.GridMeshError as error:
        assert error.kind == "join_failed"
        return
    assert made.report["genus"] == 0
    assert made.report["components"] in (1, 2)


@pytest.mark.native
def test_a_campaign_of_random_bodies():
    """A short run of the campaign; `python tests/campaign/joins.py` makes longer ones."""
    wrong, refused, found = joins.campaign(12, seed=1)
    assert not wrong
    assert len(refused) <= 1
    measures = [it for it, made in found.values() if made.report["collars"]]
    of = lambda name: np.array([getattr(it, name) for it in measures])  # noqa: E731
    assert np.median(of("irregular")) <= 0.06
    assert np.median(of("angle")) >= 18
    assert of("angle").min() >= 10
    assert of("ratio").max() <= 4
    assert of("collar").max() <= 0.18
    assert of("meetings").max() == 0
    assert of("volume").max() <= 0.03


# -------------------------------------------------------------------------------------------------- the result


def test_the_same_bytes_each_time():
    parts = ball(), ball((1.2, 0.3, 0)), torus((0, 0, 0.8))
    one, two = gridmesh.join(parts), gridmesh.join(parts)
    assert one.vertices.tobytes() == two.vertices.tobytes()
    assert one.corners.tobytes() == two.corners.tobytes()


def test_bodies_and_joined_meshes_are_parts():
    circle = sketches.circle(100)
    body = gridmesh.inflate(gridmesh.mesh_sketch(circle, quads=300))
    head = gridmesh.inflate(gridmesh.mesh_sketch(0.6 * circle + [0, 1.2], edge_length=0.1))
    both = gridmesh.join([body, head])
    assert both.report["components"] == 1
    assert len(both.quads)
    hat = ball((0, 2.0, 0), 0.4)
    three = gridmesh.join([both, hat])
    assert three.report["components"] == 1
    assert set(three.vertex_part) == {-1, 0, 1}


def test_pickle_and_copies():
    made = gridmesh.join([ball(), ball((1.2, 0, 0))])
    again = pickle.loads(pickle.dumps(made))
    for name in ("vertices", "triangles", "quads", "corners", "offsets", "source_part", "source_vertex"):
        assert np.array_equal(getattr(again, name), getattr(made, name))
        assert not getattr(made, name).flags.writeable
    assert [[len(r) for r in rims] for rims in again.collars] == [
        [len(r) for r in rims] for rims in made.collars
    ]
    assert again.report == made.report


# --------------------------------------------------------------------------------------------------- refusals


def test_parts_that_are_not_closed_are_refused_with_the_place():
    vertices, triangles = ball()
    kind, message = kind_of(ball((1, 0, 0)), (vertices, triangles[1:]))
    assert kind == "not_closed"
    assert "part 1" in message
    assert "one side only" in message
    assert kind_of((vertices, np.vstack([triangles, triangles[:1]])))[0] == "not_closed"
    turned = triangles.copy()
    turned[5] = turned[5, ::-1]
    assert kind_of((vertices, turned))[0] == "not_closed"


def test_faces_that_meet_in_one_vertex_alone_are_taken_apart_there():
    vertices, triangles = ball()
    n = len(vertices)
    pinched = np.vstack([triangles, triangles[:, ::-1] + n])
    pinched[pinched == n] = 0
    both = np.vstack([vertices, 2 * vertices[0] - vertices])
    other = ball((0, 0, 0.9))
    made = gridmesh.join([(both, pinched), other])
    assert (made.report["separated"], made.report["exact"]) == (1, 0)
    assert joins.close(joins.polygon_sides(made))
    kept = made.vertex_part == 0
    assert np.array_equal(made.vertices[kept], both[made.source_vertex[kept]])
    assert np.count_nonzero(made.source_vertex[kept] == 0) == 2
    assert made.report["volume"] == pytest.approx(made.report["exact_volume"], rel=0.03)


def test_an_edge_of_four_faces_around_which_nothing_goes_is_taken_apart():
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    # The edge from 6 to 7 of the first is that from 0 to 1 of the second.
    names = np.array([6, 7, *range(8, 14)])
    part = (np.vstack([cube, cube[2:] + [1, 1, 0]]), np.vstack([quads, names[quads]]))
    made = gridmesh.join([part, ball((0, 0, 0), 0.3)], blend=0)
    assert (made.report["separated"], made.report["components"]) == (2, 2)
    assert joins.close(joins.polygon_sides(made))
    # Two rooms that meet along one edge, with a wall around both.
    hollow = quads[:, ::-1]
    walls = np.vstack([quads + 14, hollow, names[hollow]])
    around = np.vstack([part[0], cube * 4 - 1])
    made = gridmesh.join([(around, walls), ball((3, 3, 3), 0.3)], blend=0)
    assert (made.report["separated"], made.report["components"], made.report["genus"]) == (2, 3, 0)
    assert made.report["exact_volume"] > 61


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        (lambda v, t: (np.where(v == v.max(), np.nan, v), t), "not_finite"),
        (lambda v, t: (v, np.where(t == 0, len(v), t)), "index_out_of_range"),
        (lambda v, t: (v, np.where(t == t[0, 0], t[0, 1], t)), "invalid_face"),
        (lambda v, t: (v * 1e90, t), "extreme_size"),
        (lambda v, _: (v, np.zeros((0, 3), int)), "too_few_points"),
    ],
)
def test_what_is_no_mesh_is_refused(change, kind):
    assert kind_of(ball((1, 0, 0)), change(*ball()))[0] == kind


def test_options_that_are_not_allowed():
    assert kind_of()[0] == "invalid_option"
    for options in ({"blend": -1}, {"blend": np.inf}, {"edge_length": 0}, {"edge_length": -1.0}):
        assert kind_of(ball(), **options)[0] in ("invalid_option", "not_finite")
    with pytest.raises(TypeError):
        gridmesh.join([3])
    with pytest.raises(TypeError):
        gridmesh.join([ball()], blend="wide")


def test_cancelling_and_progress():
    parts = ball(), ball((1.2, 0, 0))
    seen = []
    gridmesh.join(parts, progress=lambda f: seen.append(f) or True)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert kind_of(*parts, progress=lambda f: f < 0.3)[0] == "cancelled"


def test_the_campaign_measures_what_it_says():
    vertices, triangles = ball()
    made = gridmesh.join([(vertices, triangles)])
    assert measure(made, 0).meetings == 0
    assert abs(joins.volume(vertices, triangles) - made.report["volume"]) < 1e-9
    assert least_angle(np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], float)) == pytest.approx(45)
    assert faults([(vertices + 1, triangles)], made) == ["vertices of part 0 have moved"]
    assert Case([(vertices, triangles)]).join().report["components"] == 1
