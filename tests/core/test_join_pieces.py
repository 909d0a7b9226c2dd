"""`join`: parts of several closed pieces, which may be cavities, lie flat or overlap each other."""

import gridmesh
import numpy as np
import pytest
from test_join import ball, bar, faults, joins


def one(*pieces):
    """Several meshes as one."""
    offsets = np.cumsum([0, *(len(points) for points, _ in pieces)])
    faces = [faces + first for (_, faces), first in zip(pieces, offsets, strict=False)]
    return np.concatenate([points for points, _ in pieces]), np.concatenate(faces)


def inward(mesh):
    """The same mesh wound the other way."""
    return mesh[0], mesh[1][:, ::-1]


def box(low, size):
    """A cube, and its faces."""
    corners = np.array([[k >> 2, k >> 1 & 1, k & 1] for k in range(8)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return low + corners * size, np.array(quads)


@pytest.mark.parametrize("whole", [False, True], ids=["outward", "turned"])
@pytest.mark.parametrize(
    ("low", "inward", "fine"),
    [(3.0, False, True), (3.0, True, False), (0.2, True, True)],
    ids=["beside", "beside_inside_out", "cavity"],
)
def test_a_piece_that_is_inside_out_is_refused_and_a_cavity_stays(low, inward, fine, whole):
    (points, faces), (more, others) = box(0, 1), box(low, 0.5)
    pieces = np.concatenate([faces, (others[:, ::-1] if inward else others) + 8])
    part = np.concatenate([points, more]), pieces[:, ::-1] if whole else pieces
    apart = box(9, 1)
    if fine:
        expected = 2 + (-1 if inward else 1) / 8
        assert gridmesh.join([part, apart]).report["volume"] == pytest.approx(expected)
        return
    with pytest.raises(gridmesh.GridMeshError, match="a piece of it is inside out") as caught:
        gridmesh.join([apart, part])
    assert caught.value.kind == "not_closed"


@pytest.mark.parametrize("low", [0.2, 9.0])
def test_a_part_that_encloses_nothing_is_refused_and_a_thin_one_is_not(low):
    flat, thin = box(low, [0.5, 0.5, 0]), box(low, [0.5, 0.5, 1e-6])
    with pytest.raises(gridmesh.GridMeshError, match="enclose nothing") as caught:
        gridmesh.join([box(0, 1), flat])
    assert caught.value.kind == "not_closed"
    assert gridmesh.join([box(0, 1), thin]).report["watertight"]


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_a_flat_piece_beside_a_solid_one_is_refused_with_its_place(turn):
    rotation = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    flat, thin = (box([0, 3, 0], [0.5, 0.5, height]) for height in (0, 1e-6))
    flat, thin, solid = ((points @ rotation.T, faces) for points, faces in (flat, thin, box(0, 1)))
    with pytest.raises(gridmesh.GridMeshError, match="a piece of it lie on each other") as caught:
        gridmesh.join([box(9, 1), one(solid, flat)])
    assert caught.value.kind == "not_closed"
    message = str(caught.value)
    assert message.startswith("part 1 ")
    place = np.array([float(x) for x in message.split("(")[1].split(")")[0].split(",")])
    assert np.linalg.norm(flat[0] - place, axis=1).min() < 1e-5
    assert gridmesh.join([box(9, 1), one(solid, thin)]).report["components"] == 3


def test_pieces_of_one_part_that_overlap_are_joined_as_parts():
    first, second, across = ball(), ball((1, 0, 0)), ball((0.5, 1, 0))
    whole = one(first, second)
    made = gridmesh.join([whole, across])
    apart = gridmesh.join([first, second, across])
    assert faults([whole, across], made) == []
    assert (made.report["components"], made.report["genus"], made.report["overlapping"]) == (1, 0, 2)
    assert (made.report["alone"], made.report["swallowed"]) == (0, 0)
    assert apart.report["overlapping"] == 0
    assert made.vertices.tobytes() == apart.vertices.tobytes()
    assert made.corners.tobytes() == apart.corners.tobytes()
    # Numbers are those of the part, not of the piece.
    moved = {-1: (-1, 0), 0: (0, 0), 1: (0, len(first[0])), 2: (1, 0)}
    for part, vertex, own, number in zip(
        apart.vertex_part, apart.source_vertex, made.vertex_part, made.source_vertex, strict=True
    ):
        assert (own, number) == (moved[part][0], vertex + moved[part][1])


@pytest.mark.parametrize("whole", [False, True], ids=["outward", "turned"])
def test_a_single_part_of_pieces_that_overlap_becomes_one_surface(whole):
    pieces = bar([2, 0.6, 0.6]), bar([0.6, 2.0, 0.5], (0.1, 0.05, 0.02)), bar([0.5, 0.5, 2], (0.6, 0, 0.3))
    part = one(*pieces)
    if whole:
        part = inward(part)
    made = gridmesh.join([part])
    assert faults([inward(part) if whole else part], made) == []
    assert (made.report["components"], made.report["self_intersections"]) == (1, 0)
    assert (made.report["overlapping"], made.report["turned"]) == (3, int(whole))
    assert made.report["exact_volume"] == pytest.approx(gridmesh.join(list(pieces)).report["exact_volume"])
    assert gridmesh.join([(made.vertices, (made.corners, made.offsets))]).report["overlapping"] == 0


def test_faces_of_pieces_that_are_mixed_keep_their_numbers():
    rng = np.random.default_rng(4)
    points, faces = one(ball(), ball((1, 0, 0)), ball((0, 0, 5), 0.5))
    order, places = rng.permutation(len(faces)), rng.permutation(len(points))
    part = points[places], np.argsort(places)[faces][order]
    made = gridmesh.join([ball((0.5, 5, 0)), part])
    assert faults([ball((0.5, 5, 0)), part], made) == []
    assert (made.report["components"], made.report["overlapping"], made.report["alone"]) == (3, 3, 2)
    old = made.vertex_part == 1
    assert (np.diff(made.source_vertex[old]) > 0).all()
    assert (np.diff(made.source_face[made.source_part == 1]) > 0).all()


def test_a_piece_within_another_one_vanishes_and_cavities_stay():
    outer, hole, inner = ball(radius=1.0), inward(ball(radius=0.6)), ball(radius=0.3)
    made = gridmesh.join([one(outer, inner)])
    assert (made.report["components"], made.report["swallowed"], made.report["overlapping"]) == (1, 1, 2)
    assert made.report["volume"] == pytest.approx(joins.volume(*outer))
    # In a cavity it is a piece of its own, and nothing overlaps.
    part = one(outer, hole, inner)
    made = gridmesh.join([part])
    assert (made.report["components"], made.report["swallowed"], made.report["overlapping"]) == (3, 0, 0)
    assert made.report["volume"] == pytest.approx(joins.volume(*part))


def test_a_cavity_stays_with_the_piece_around_it_where_another_one_crosses():
    outer, hole, other = ball(), inward(ball(radius=0.5)), ball((1.4, 0, 0), 0.8)
    made = gridmesh.join([one(hole, other, outer)])
    assert faults([one(hole, other, outer)], made) == []
    assert (made.report["components"], made.report["overlapping"]) == (2, 2)
    apart = gridmesh.join([one(hole, outer), other])
    assert made.report["exact_volume"] == pytest.approx(apart.report["exact_volume"], rel=1e-12)
    # One that reaches into the cavity fills it there.
    made = gridmesh.join([one(outer, hole, ball((0.7, 0, 0), 0.8))], blend=0)
    assert made.report["exact_volume"] > apart.report["exact_volume"] - joins.volume(*other)
    assert made.report["components"] == 2


def test_cavities_that_cross_are_refused_with_their_place():
    outer, hole = box(0, 4), inward(box(1, 1))
    others = box(1.5, 1), box([1.4, 1.3, 1.55], 1), box([3.5, 2.2, 2.1], 1), box([3.5, 2, 2], 1)
    for other in map(inward, others):
        with pytest.raises(gridmesh.GridMeshError, match="a cavity of it crosses") as caught:
            gridmesh.join([one(outer, hole, other), box(9, 1)])
        assert caught.value.kind == "not_closed"
    with pytest.raises(gridmesh.GridMeshError, match="inside out"):
        gridmesh.join([one(outer, inward(box(1, 2)), inward(box(1.5, 1)))])


def test_pieces_that_only_touch_stay_and_those_that_lie_on_each_other_are_united():
    beside = [box(0, 1), box([1, 0, 0], 1), box([1, 1, 0.25], [1, 1, 0.5]), box([-1, 0.3, 0], 1)]
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    made = gridmesh.join([one(*beside)])
    assert (made.report["components"], made.report["overlapping"]) == (4, 0)
    overlapping = {
        1.0: [box(0, 1), box(0, 1)],
        2.0: [box(0, [2, 1, 1]), box(0, [0.5, 1, 1])],
        5.0: [box(0, [3, 1, 1]), box([1, -1, 0], [1, 3, 1])],
    }
    for expected, pieces in overlapping.items():
        points, faces = one(*pieces)
        for turned in (points, points @ turn.T):
            made = gridmesh.join([(turned, faces)], blend=0)
            assert (made.report["components"], made.report["overlapping"]) == (1, 2)
            assert made.report["exact_volume"] == pytest.approx(expected)


def test_borders_of_colours_run_between_parts_and_not_within_them():
    part = one(ball(), ball((1, 0, 0)))
    limb = bar([0.5, 0.5, 1.5], (0.5, 0.8, 0.7))
    made = gridmesh.join([part, limb], border=True)
    assert set(made.near_part) == {0, 1}
    assert made.report["overlapping"] == 2


def test_a_piece_in_a_cavity_that_goes_through_its_wall_is_united_with_what_is_around():
    outer, hole, inner = box(0, 4), inward(box(1, 2)), box([1.5, 1.5, 0.5], [1, 1, 2])
    made = gridmesh.join([one(hole, inner, outer)], blend=0)
    assert (made.report["components"], made.report["overlapping"]) == (2, 2)
    assert made.report["exact_volume"] == pytest.approx(64 - 8 + 1.5)
