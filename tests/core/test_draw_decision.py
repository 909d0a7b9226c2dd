"""What a stroke does: decided without Blender, from the stroke, the keys and the bodies."""

from dataclasses import replace

import numpy as np
import pytest

from addon.bodies.outlines import Plane
from addon.draw import memory
from addon.draw.decision import DecisionError, Shape, Wanted, decide, inside, relation
from addon.draw.fewer import simplified
from addon.draw.trace import Mirror, Trace, closed, flat, pack, unpack

FLOOR = Plane(np.zeros(3), np.eye(3))


def ring(radius=1.0, centre=(0.0, 0.0), start=0.0, n=60, turn=2 * np.pi):
    """(n, 2) points on a circle."""
    t = start + np.linspace(0, turn, n, endpoint=False)
    return np.stack([centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t)], axis=1)


def body(name="Body", radius=2.0, centre=(0.0, 0.0), z=0.0, holes=(), thickness=None):
    """A disk as a body in a plane z = constant."""
    plane = Plane(np.array([*centre, z], float), np.eye(3))
    thickness = radius if thickness is None else thickness
    return Shape(name, plane, ring(radius), [np.asarray(hole) for hole in holes], thickness)


def seen(points, *, free=True, turned=0.0, z=0.0, height=10.0):
    """A stroke in a plane through (0, 0, z), drawn by somebody who looks along its normal, turned about x by degrees."""
    a = np.radians(turned)
    axes = np.array([[1, 0, 0], [0, np.cos(a), np.sin(a)], [0, -np.sin(a), np.cos(a)]])
    plane = Plane(np.array([0.0, 0.0, z]), axes)
    stroke = flat(plane, points, np.ones(len(points)), free=free)
    return replace(stroke, seen=True, origins=stroke.origins + height * axes[2])


def one(trace, shapes, mirror=None, **wanted):
    """The decision of a stroke that has one."""
    (decision,) = decide(trace, shapes, Wanted(**wanted), mirror)
    return decision


FROM_INSIDE, FROM_OUTSIDE = ring(0.8, (2, 0), start=np.pi), ring(0.8, (2, 0))
WITHIN, BESIDE = ring(0.5, (0.4, 0)), ring(0.5, (5, 0))


@pytest.mark.parametrize(
    ("stroke", "wanted", "action"),
    [
        (FROM_INSIDE, {}, "EXTEND"),
        (FROM_OUTSIDE, {}, "EXTEND"),
        (BESIDE, {}, "NEW"),
        (WITHIN, {}, "NEW"),
        (ring(5.0), {}, "NEW"),
        (FROM_INSIDE, {"subtract": True}, "TRIM"),
        (FROM_OUTSIDE, {"subtract": True}, "TRIM"),
        (WITHIN, {"subtract": True}, "HOLE"),
        (FROM_OUTSIDE, {"part": True}, "PART"),
        (WITHIN, {"part": True}, "PART"),
        (BESIDE, {"part": True}, "NEW"),
        (FROM_OUTSIDE, {"action": "NEW"}, "NEW"),
        (FROM_OUTSIDE, {"action": "EXTEND", "subtract": True}, "EXTEND"),
        (ring(5.0), {"action": "EXTEND"}, "EXTEND"),
        (FROM_OUTSIDE, {"action": "HOLE"}, "TRIM"),
        (WITHIN, {"action": "TRIM"}, "HOLE"),
        (FROM_INSIDE, {"action": "PART"}, "PART"),
    ],
)
@pytest.mark.parametrize("look", [seen, lambda points: flat(FLOOR, points, np.ones(len(points)))])
def test_adding_is_the_default_and_taking_away_is_asked_for(stroke, wanted, action, look):
    decision = one(look(stroke), [body()], **wanted)
    assert decision.action == action
    assert decision.body == ("" if action == "NEW" else "Body")


@pytest.mark.parametrize(
    ("stroke", "wanted", "said"),
    [
        (BESIDE, {"subtract": True}, "no body under the stroke to take away"),
        (BESIDE, {"action": "EXTEND"}, "no body under the stroke to extend"),
        (WITHIN, {"action": "EXTEND"}, "lies inside 'Body'"),
    ],
)
def test_what_does_nothing_is_said(stroke, wanted, said):
    with pytest.raises(DecisionError, match=said):
        one(seen(stroke), [body()], **wanted)


@pytest.mark.parametrize("wanted", [{}, {"subtract": True}, {"part": True}, {"action": "NEW"}])
@pytest.mark.parametrize("centre", [(0.2, 0), (2, 0), (6, 0)])
def test_a_stroke_that_falls_apart_where_it_crosses_itself_is_said_to_do_nothing(wanted, centre):
    t = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    eight = np.stack([np.sin(t), np.sin(2 * t)], axis=1) + centre
    with pytest.raises(
        DecisionError, match="the stroke encloses 2 parts that meet only where it crosses itself"
    ):
        one(seen(eight), [body()], **wanted)
    line = np.stack([t, 0 * t], axis=1) + (6, 0)
    assert one(seen(line), [body()]).action == "NEW"


@pytest.mark.parametrize(
    ("stroke", "wanted"),
    [(FROM_INSIDE, {}), (FROM_INSIDE, {"subtract": True}), (WITHIN, {"subtract": True})],
)
def test_a_body_whose_outline_cannot_be_changed_is_not_promised_to_be(stroke, wanted):
    fixed = replace(body(), fixed="its mesh was changed by hand")
    with pytest.raises(DecisionError, match="'Body': its mesh was changed by hand"):
        one(seen(stroke), [fixed], **wanted)
    assert one(seen(WITHIN), [fixed], part=True).action == "PART"
    assert one(seen(BESIDE), [fixed]).action == "NEW"


def test_a_part_that_will_not_be_joined_is_said_to_stay_apart():
    alone = replace(body(), apart="its mesh was changed by hand")
    decision = one(seen(FROM_INSIDE), [alone], part=True)
    assert decision.action == "PART"
    assert decision.hint == "the part stays apart from 'Body': its mesh was changed by hand"
    assert one(seen(FROM_INSIDE), [alone], part=True, joins=False).hint == ""
    assert one(seen(FROM_INSIDE), [alone]).hint == ""


def test_it_is_decided_from_the_first_point_on():
    points = ring(1.5, (2, 0), start=np.pi)
    actions = [one(seen(points[:n]), [body()]).action for n in range(1, len(points) + 1)]
    assert actions[0] == "NEW"
    assert actions[-1] == "EXTEND"
    assert "".join(action[0] for action in actions).count("NE") == 1, "the action goes back and forth"
    assert {one(seen(points[:n]), [body()], subtract=True).action for n in range(1, 60)} == {"HOLE", "TRIM"}


def test_what_would_not_be_seen_is_said():
    assert one(seen(WITHIN), [body()]).hint == "inside 'Body': not visible; use Plane: Surface"
    ball = replace(body(), surface=np.array([(x, y, z) for x, y in ring(0.5) for z in (-0.6, 0.6)]))
    assert one(seen(ring(0.3)), [ball]).hint.startswith("inside")
    assert one(seen(ring(0.3), z=0.6), [ball]).hint == "", "on its surface"
    assert one(seen(WITHIN, z=2.5), [body(thickness=2.0)]).hint == "", "in front of it"
    assert one(seen(WITHIN, free=False, turned=90.0), [body()]).hint == "", "across it"
    assert "'Body' will be inside it" in one(seen(ring(5.0)), [body()]).hint
    assert one(seen(BESIDE), [body()]).hint == ""


@pytest.mark.parametrize("turned", [-20, -5, 5, 20, 60])
def test_a_turned_view_extends_in_the_plane_of_the_body(turned):
    decision = one(seen(FROM_INSIDE, turned=turned), [body()])
    assert decision.action == "EXTEND"
    assert np.array_equal(decision.plane.axes, np.eye(3))
    # Seen along the sight lines: what was drawn round is longer in the body's plane.
    tall = np.ptp(decision.strokes[0][:, 1])
    assert tall == pytest.approx(1.6 / np.cos(np.radians(turned)), rel=0.01)


def test_edge_on_it_is_another_body():
    assert one(seen(FROM_INSIDE, turned=80), [body()]).action == "NEW"


@pytest.mark.parametrize(("turned", "action"), [(5, "EXTEND"), (40, "NEW")])
def test_from_outside_the_view_must_be_near_the_plane(turned, action):
    assert one(seen(FROM_OUTSIDE, turned=turned), [body()]).action == action


def test_it_begins_on_a_body_at_any_depth_and_takes_the_nearest():
    near, far = body("near", 1.0, z=3.0), body("far", 3.0, z=-4.0)
    assert one(seen(ring(1.0, (1.5, 0), start=np.pi)), [far, near]).body == "near"
    assert one(seen(ring(1.0, (3, 0), start=np.pi)), [far, near]).body == "far"
    chosen = seen(ring(1.0, (3, 0), start=np.pi), free=False)
    assert one(chosen, [far, near]).action == "NEW", "in a plane that was chosen"
    assert one(chosen, [far, near], subtract=True).body == "far"


def test_a_script_draws_where_it_says():
    stroke = flat(Plane(np.array([0, 0, 8.0]), np.eye(3)), FROM_INSIDE, np.ones(60))
    assert one(stroke, [body()]).action == "NEW"


def test_a_bridge_joins_all_that_it_reaches_in_the_plane():
    others = [body("b", 1.0, (4, 0)), body("c", 1.0, (0, 4)), body("d", 1.0, (4, 0), z=3.0)]
    bar = np.array([(x, 0.3) for x in np.linspace(0, 4, 30)] + [(x, -0.3) for x in np.linspace(4, 0, 30)])
    decision = one(seen(bar), [body("a"), *others])
    assert (decision.body, decision.joined) == ("a", ("b",))


def test_a_part_stays_one_when_its_body_is_extended():
    part = body("part", 0.5, (1.5, 0))
    decision = one(seen(ring(1.0, (0, 2), start=-np.pi / 2)), [body(), part])
    assert (decision.body, decision.joined) == ("Body", ())
    over = ring(0.8, (2.1, 0), start=np.pi)  # begins in both: the part is meant, and the body is not joined
    decision = one(seen(over), [body(), part])
    assert (decision.body, decision.joined) == ("part", ())


def test_a_hole_is_outside():
    disk = body(holes=[ring(1.0)])
    assert one(seen(ring(0.5)), [disk]).action == "NEW"
    assert one(seen(ring(0.5, (1, 0), start=np.pi)), [disk]).action == "EXTEND"
    assert list(inside(disk.part, np.array([[0, 0], [1.5, 0], [3, 0]]))) == [False, True, False]


MIRROR = Mirror(np.zeros(3), np.array([1.0, 0, 0]))


def test_mirrored_across_the_axis_it_is_one_symmetric_body():
    decision = one(seen(ring(1.0, (0.6, 0))), [], MIRROR)
    assert decision.symmetric
    ((outline, holes),) = decision.parts()
    assert holes == []
    apart = np.linalg.norm(outline[:, None] - (outline * [-1, 1])[None], axis=2).min(axis=1)
    assert apart.max() < 1e-9


def test_half_a_ring_mirrored_has_a_hole():
    half = np.concatenate(
        [
            ring(2.0, start=-np.pi / 2 - 0.1, turn=np.pi + 0.2),
            ring(1.0, start=-np.pi / 2 - 0.1, turn=np.pi + 0.2)[::-1],
        ]
    )
    ((_, holes),) = one(seen(half), [], MIRROR).parts()
    assert len(holes) == 1


def test_mirrored_beside_the_axis_there_are_two_of_everything():
    stroke = seen(ring(0.7, (2, 0), start=np.pi))
    first, second = decide(stroke, [], Wanted(), MIRROR)
    assert np.allclose(first.strokes[0] * [-1, 1], second.strokes[0])
    both = one(stroke, [body()], MIRROR)
    assert (both.action, both.body, len(both.strokes)) == ("EXTEND", "Body", 2)
    one_sided = decide(stroke, [body(radius=1.0, centre=(2.5, 0))], Wanted(), MIRROR)
    assert [decision.action for decision in one_sided] == ["EXTEND", "NEW"]
    pair = [body("left", 1.0, (-2.5, 0)), body("right", 1.0, (2.5, 0))]
    assert [decision.body for decision in decide(stroke, pair, Wanted(), MIRROR)] == ["right", "left"]


def test_the_mirror_is_the_same_through_an_eye():
    eye = np.array([0.0, 0.0, 10.0])
    world = np.column_stack([ring(0.5, (1, 0)), np.zeros(60)])
    rays = world - eye
    trace = Trace(
        FLOOR,
        np.tile(eye, (60, 1)),
        rays / np.linalg.norm(rays, axis=1)[:, None],
        np.ones(60),
        True,
        True,
        True,
    )
    first, second = decide(trace, [], Wanted(), MIRROR)
    assert np.allclose(first.strokes[0] * [-1, 1], second.strokes[0])
    assert trace.on(Plane(np.array([0, 0, 20.0]), np.eye(3))) is None, "behind the eye"
    assert np.allclose(trace.through(world).on(FLOOR), world[:, :2])


def test_relations():
    outline, hole = ring(2.0), ring(0.5)
    assert relation(outline, [], ring(0.5, (5, 0))) == "apart"
    assert relation(outline, [], ring(0.5, (1, 0))) == "inside"
    assert relation(outline, [], ring(5.0)) == "around"
    assert relation(outline, [], ring(1.0, (2, 0))) == "across"
    assert relation(outline, [hole], ring(0.3)) == "apart"


def test_ends_that_pass_each_other_are_cut_off():
    long = np.vstack([ring(), ring()[:4] * 1.02])
    assert len(closed(long)) < len(long)
    assert np.array_equal(closed(ring()[:30]), ring()[:30]), "ends that are far apart"


def test_strokes_are_remembered_by_a_short_name():
    kept = memory.given(
        pack(ring(), np.ones(60)), np.eye(4).ravel().tolist(), Wanted(), free=True, place=np.zeros(3)
    )
    name = memory.keep(kept)
    assert len(name) < 8
    assert memory.recall(name) is kept
    assert memory.recall(pack(ring(), np.ones(60))) is None, "the points themselves"
    with pytest.raises(memory.ForgottenError, match="draw it again"):
        memory.recall("#99999")
    for _ in range(memory.MOST):
        memory.keep(kept)
    with pytest.raises(memory.ForgottenError):
        memory.recall(name)


def test_a_stroke_as_text():
    points, pressure = ring(), np.linspace(0, 1, 60)
    again = unpack(pack(points, pressure))
    assert np.array_equal(again[0], points)
    assert np.array_equal(again[1], pressure)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x", "base64|padding"),
        ("AAAA", "three columns"),
        (pack(np.full((3, 2), np.nan), np.ones(3)), "not finite"),
    ],
)
def test_a_text_that_is_no_stroke_is_refused(text, said):
    with pytest.raises(ValueError, match=said):
        unpack(text)


@pytest.mark.parametrize("tolerance", [0.0, 1e-3, 0.02, 10.0])
def test_an_outline_with_fewer_points_stays_within_the_tolerance(tolerance):
    random = np.random.default_rng(5)
    t = np.sort(random.uniform(0, 2 * np.pi, 300))
    line = (1 + 0.3 * np.cos(3 * t))[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)
    kept = simplified(line, tolerance)
    assert len(kept) == len(set(kept)) >= 3
    assert list(kept) == sorted(kept)
    assert len(kept) == 300 if tolerance == 0.0 else len(kept) < 150
    a, b = line[kept], np.roll(line[kept], -1, axis=0)
    along = b - a
    part = np.clip(((line[:, None] - a) * along).sum(axis=2) / (along**2).sum(axis=1), 0, 1)
    off = np.linalg.norm(line[:, None] - a - part[..., None] * along, axis=2).min(axis=1)
    assert off.max() <= tolerance + 1e-12


def ball(**options):
    """A body that is a ball: with points of its surface, and a mirror."""
    t, u = np.meshgrid(np.linspace(0, 2 * np.pi, 60), np.linspace(-1, 1, 41))
    r = np.sqrt(1 - u * u)
    surface = 2 * np.stack([r * np.cos(t), r * np.sin(t), u], axis=-1).reshape(-1, 3)
    return replace(body(**options), surface=surface, across=MIRROR)


@pytest.mark.parametrize(
    ("stroke", "lies", "depth"),
    [
        (WITHIN, "AUTO", 1.0),
        (FROM_INSIDE, "AUTO", 0.0),
        (FROM_OUTSIDE, "AUTO", 0.0),
        (WITHIN, "MIDDLE", 0.0),
        (WITHIN, "BEHIND", -1.0),
        (FROM_INSIDE, "FRONT", 1.0),
    ],
)
def test_where_a_part_lies(stroke, lies, depth):
    decision = one(seen(stroke), [ball()], part=True, lies=lies)
    assert decision.depth == depth
    assert np.allclose(decision.plane.origin, depth * np.array(decision.reach))
    assert decision.reach[2] > 0, "in front is towards the viewer"
    assert np.allclose(decision.strokes[0] + decision.plane.origin[:2], stroke, atol=1e-9)
    if stroke is WITHIN:
        assert decision.reach[2] == pytest.approx(1.9, abs=0.1), "to the surface"


def test_a_part_seen_from_behind_lies_on_that_side():
    decision = one(seen(WITHIN, turned=180), [ball()], part=True, lies="FRONT")
    assert decision.plane.origin[2] < -1.5


def test_a_part_seen_from_aside_faces_the_view():
    trace = seen(WITHIN, turned=60)
    decision = one(trace, [ball()], part=True, lies="FRONT")
    assert np.allclose(decision.plane.axes, trace.plane.axes)
    assert decision.plane.origin @ trace.plane.axes[2] == pytest.approx(1.9, abs=0.15)
    near = one(seen(WITHIN, turned=10), [ball()], part=True, lies="FRONT")
    assert np.allclose(near.plane.axes[2], FLOOR.axes[2]), "hardly turned, it is laid into the body's plane"


def test_a_twin_takes_the_place_of_a_mirrored_stroke():
    decisions = decide(seen(FROM_INSIDE), [ball()], Wanted(part=True, twin=True), MIRROR)
    assert len(decisions) == 1
    assert decisions[0].twin is MIRROR
    assert len(decide(seen(FROM_INSIDE), [ball()], Wanted(part=True), MIRROR)) == 2


def test_a_stroke_over_the_twin_of_a_body_is_one_over_the_body():
    arm = replace(ball(), plane=Plane(np.array([5.0, 0, 0]), np.eye(3)))
    image = arm.mirrored()
    assert image.twin
    assert image.name == arm.name
    over = FROM_INSIDE + [5, 0]
    own = one(seen(over), [arm, image])
    other = one(seen(over * [-1, 1]), [arm, image])
    assert own.action == other.action == "EXTEND"
    assert np.allclose(own.strokes[0], other.strokes[0], atol=1e-9)
    hand = one(seen(over * [-1, 1]), [arm, image], part=True)
    assert np.linalg.det(hand.plane.axes) > 0, "a part is a body of its own, not mirrored"
