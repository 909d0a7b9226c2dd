"""Every action of the draw tool, its options afterwards, other actions from the redo panel, and the undo history."""

import bpy
import numpy as np
import pytest
from drawings import check_body, circle, fingerprint, world_vertices
from mathutils import Matrix

from addon.draw import memory
from addon.draw.operator import OPERATORS
from addon.draw.trace import pack
from addon.join import following
from addon.live import engine

pytestmark = pytest.mark.usefixtures("awake", "history")

ACTIONS = {
    "NEW": circle(60, 0.6, (5, 0)),
    "EXTEND": circle(60, 0.8, (2, 0), start=np.pi),
    "TRIM": circle(60, 0.8, (2, 0), start=np.pi),
    "HOLE": circle(40, 0.5, (0.4, 0)),
    "PART": circle(60, 0.8, (2, 0), start=np.pi),
}
"""A stroke over or beside a disk of radius 2, for each action."""

DONE = {"NEW": (2, 2), "EXTEND": (1, 2), "TRIM": (1, 2), "HOLE": (1, 0), "PART": (2, 2)}
"""Number of bodies after it, and Euler characteristic of the first."""


@pytest.fixture
def history():
    """Undo, which the background begins with the first step."""
    bpy.ops.ed.undo_push(message="base")


def draw(points, matrix=None, **options):
    """Draw a stroke in the plane z = 0, or in that of a matrix."""
    flat = np.asarray(points, float)[:, :2]
    matrix = np.eye(4) if matrix is None else matrix
    options = {"triangles": 600, **options}
    return bpy.ops.object.gridmesh_draw(
        "EXEC_DEFAULT", True, stroke=pack(flat, np.ones(len(flat))), matrix=matrix.ravel().tolist(), **options
    )


def disk():
    """A live body."""
    assert draw(circle(100, 2)) == {"FINISHED"}
    (body,) = engine.bodies()
    engine.settle()
    return body


def test_a_small_body_is_extended_far_in_one_go(monkeypatch):
    assert draw(circle(60, 0.1)) == {"FINISHED"}
    engine.settle()
    solved = []
    solve = engine.solve

    def listened(*sketch, **options):
        body, lattice = solve(*sketch, **options)
        solved.append(len(body.faces))
        return body, lattice

    monkeypatch.setattr(engine, "solve", listened)
    assert draw(circle(60, 2, (1.95, 0), start=np.pi)) == {"FINISHED"}
    (body,) = engine.bodies()
    check_body(body)
    assert solved == [len(body.data.polygons)], "meshed more than once"


def repeat(**changed):
    """Change options in the redo panel: what is there is undone, and the operator runs again with the rest as it was."""
    last = bpy.context.window_manager.operators[-1]
    names = [option.identifier for option in last.properties.bl_rna.properties]
    values = {name: getattr(last.properties, name) for name in names if name not in {"rna_type", "matrix"}}
    name = last.bl_idname.removeprefix("OBJECT_OT_")
    bpy.ops.ed.undo()
    return getattr(bpy.ops.object, name)("EXEC_DEFAULT", True, **{**values, **changed})


def euler(ob):
    mesh = ob.data
    return len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons)


def last():
    """The operator that was run last, as the redo panel shows it."""
    return bpy.context.window_manager.operators[-1]


def state():
    """All bodies, with their meshes to the last digit."""
    return {ob.name: (euler(ob), world_vertices(ob).round(5).tobytes()) for ob in engine.bodies()}


@pytest.mark.parametrize("action", ACTIONS)
def test_each_action(action):
    body = disk()
    assert draw(ACTIONS[action], action=action) == {"FINISHED"}
    engine.settle()
    assert (len(engine.bodies()), euler(body)) == DONE[action]
    for ob in engine.bodies():
        assert ob.gridmesh_live.problem == ""
        check_body(ob, genus=1 if action == "HOLE" and ob == body else 0)
    outlines = [ob for ob in bpy.data.objects if ob.type == "GREASEPENCIL"]
    assert len(outlines) == len(engine.bodies())
    if action == "PART":
        (part,) = (ob for ob in engine.bodies() if ob != body)
        whole = following.whole_of(part)
        assert part.parent == body.parent == whole
        assert following.parts_of(whole) == [body, part]


@pytest.mark.parametrize("action", ACTIONS)
def test_each_action_is_one_undo_step_of_its_own_name(action, capfd):
    disk()
    before = state()
    draw(ACTIONS[action], action=action)
    after = state()
    assert (
        last().name
        == {
            "NEW": "Draw Body",
            "EXTEND": "Extend Body",
            "TRIM": "Trim Body",
            "HOLE": "Make Hole",
            "PART": "Add Part",
        }[action]
    )
    assert last().action == action
    bpy.ops.ed.undo()
    assert state() == before
    bpy.ops.ed.redo()
    assert state() == after
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    assert state() == {}


@pytest.mark.parametrize("action", ["EXTEND", "TRIM", "HOLE"])
def test_the_options_after_it_are_those_of_the_body_and_act_on_it(action):
    body = disk()
    body.gridmesh_live.depth = 0.5
    body.gridmesh_live.profile = "FLAT"
    body.gridmesh_live.triangles = 800
    engine.settle()
    bpy.ops.ed.undo_push(message="Options")
    draw(ACTIONS[action], action=action, depth=2.0, triangles=300)
    assert (last().depth, last().profile, last().triangles) == (0.5, "FLAT", 800)
    (body,) = engine.bodies()
    thick, many = np.ptp(world_vertices(body)[:, 2]), len(body.data.polygons)
    assert repeat(depth=0.25, triangles=1600, profile="ROUND", curve="PLATEAU") == {"FINISHED"}
    (body,) = engine.bodies()
    assert (body.gridmesh_live.depth, body.gridmesh_live.profile) == (0.25, "ROUND")
    assert np.ptp(world_vertices(body)[:, 2]) != pytest.approx(thick, rel=0.1)
    assert len(body.data.polygons) > 1.6 * many
    assert any(modifier.type == "VERTEX_WEIGHT_EDIT" for modifier in body.modifiers)
    assert DONE[action] == (1, euler(body))
    engine.settle()
    fresh = state()
    engine.remake(body)
    assert state() == fresh, "not a function of the outline and the options"


def test_another_action_from_the_redo_panel_to_and_fro():
    disk()
    before = state()
    draw(ACTIONS["EXTEND"])
    assert last().action == "EXTEND"
    extended = state()
    repeat(action="TRIM")
    trimmed = state()
    assert len(trimmed) == 1
    assert trimmed != extended
    repeat(action="NEW")
    assert len(state()) == 2
    assert last().triangles == 600
    repeat(action="PART")
    assert len(state()) == 2
    repeat(action="EXTEND")
    assert state() == extended
    repeat(action="TRIM")
    assert state() == trimmed
    repeat(action="EXTEND")
    bpy.ops.ed.undo()
    assert state() == before


def test_a_changed_action_shows_the_options_of_what_is_changed():
    body = disk()
    body.gridmesh_live.depth = 0.5
    bpy.ops.ed.undo_push(message="Depth")
    draw(ACTIONS["EXTEND"], depth=1.5)
    assert last().depth == 0.5
    repeat(action="NEW")
    assert last().depth == 1.5
    repeat(action="EXTEND")
    assert last().depth == 0.5


def test_a_refused_change_leaves_what_was_there():
    disk()
    draw(ACTIONS["NEW"])
    assert repeat(action="TRIM") == {"CANCELLED"}


def turned(degrees):
    a = np.radians(degrees)
    matrix = np.eye(4)
    matrix[1:3, 1:3] = [[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]
    return matrix


@pytest.mark.parametrize("degrees", [-10, 5])
def test_a_stroke_in_a_turned_plane_extends_in_that_of_the_body(degrees):
    body = disk()
    thick = np.ptp(world_vertices(body)[:, 2])
    assert draw(ACTIONS["EXTEND"], turned(degrees)) == {"FINISHED"}
    (body,) = engine.bodies()
    check_body(body)
    points = world_vertices(body)
    assert points[:, 0].max() > 2.6
    assert np.ptp(points[:, 2]) < 1.2 * thick
    assert draw(circle(40, 0.5, (5, 0)), turned(degrees)) == {"FINISHED"}
    assert len(engine.bodies()) == 2


def test_a_chosen_plane_is_kept():
    disk()
    draw(ACTIONS["EXTEND"], turned(15), plane="X")
    assert len(engine.bodies()) == 2


def apart():
    """Two disks of outlines of their own, with a child each; the left one is moved there."""
    left, right = None, None
    draw(circle(80, 1))
    (left,) = engine.bodies()
    left.location.x -= 2
    bpy.context.view_layer.update()
    draw(circle(80, 1, (2, 0)))
    right = next(ob for ob in engine.bodies() if ob != left)
    for body in (left, right):
        child = bpy.data.objects.new(f"child of {body.name}", None)
        bpy.context.collection.objects.link(child)
        child.parent, child.location = body, (0, 0, 1)
    bpy.context.view_layer.update()
    engine.settle()
    return left, right


BAR = np.array([(x, 0.3) for x in np.linspace(-2, 2, 30)] + [(x, -0.3) for x in np.linspace(2, -2, 30)])


@pytest.mark.parametrize("way", [1, -1])
def test_a_bridge_joins_bodies_with_outlines_of_their_own(way):
    left, right = apart()
    first = left if way == 1 else right
    places = {ob.name: np.array(ob.matrix_world) for ob in bpy.data.objects if ob.type == "EMPTY"}
    assert draw(BAR * [way, 1]) == {"FINISHED"}
    engine.settle()
    (body,) = engine.bodies()
    assert body == first
    check_body(body)
    assert np.ptp(world_vertices(body)[:, 0]) == pytest.approx(6, abs=0.1)
    assert [ob for ob in bpy.data.objects if ob.type == "GREASEPENCIL"] == [body.gridmesh_live.source]
    assert all(mesh.users for mesh in bpy.data.meshes)
    for name, place in places.items():
        child = bpy.data.objects[name]
        assert child.parent == body
        assert np.allclose(np.array(child.matrix_world), place, atol=1e-5)


def test_bodies_at_different_depth_are_not_joined():
    _, right = apart()
    right.location.z += 2
    bpy.context.view_layer.update()
    draw(BAR)
    assert len(engine.bodies()) == 2


def test_a_moved_turned_and_scaled_body_is_extended_where_it_is():
    body = disk()
    matrix = turned(30)
    matrix[:3, 3] = (3, 4, 5)
    body.matrix_world = Matrix((matrix @ np.diag([1.5, 1.0, 1.0, 1.0])).tolist())
    bpy.context.view_layer.update()
    place = np.array(body.matrix_world)
    assert draw(circle(60, 0.8, (3, 0), start=np.pi), matrix) == {"FINISHED"}
    (body,) = engine.bodies()
    assert np.allclose(np.array(body.matrix_world), place)
    local = (world_vertices(body) - place[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T
    assert local[:, 0].max() == pytest.approx(3.8, abs=0.05)
    assert local[:, 0].min() == pytest.approx(-3.0, abs=0.05)


def test_a_part_follows_its_body_and_stays_when_that_is_extended():
    body = disk()
    draw(circle(40, 0.6, (0, 1.9)), action="PART", use_join=False)
    part = next(ob for ob in engine.bodies() if ob != body)
    before = world_vertices(part)
    draw(ACTIONS["EXTEND"])
    engine.settle()
    assert len(engine.bodies()) == 2
    assert np.allclose(world_vertices(part), before, atol=1e-5)
    body.location.x += 1
    bpy.context.view_layer.update()
    assert np.allclose(world_vertices(part), before + [1, 0, 0], atol=1e-5)


def test_a_mirrored_stroke_makes_a_symmetric_body():
    pear = circle(60, 1, (0.6, 0))
    pear[:, 0] *= 1 + 0.4 * pear[:, 1]
    assert draw(pear, use_mirror=True, shape="SHEET") == {"FINISHED"}
    (body,) = engine.bodies()
    assert body.gridmesh_live.mirror == "AUTO"
    assert last().mirror == "OFF"
    points = world_vertices(body)
    apart = np.linalg.norm(points[:, None] - (points * [-1, 1, 1])[None], axis=2).min(axis=1)
    assert apart.max() < 1e-4
    repeat(use_mirror=False)
    (body,) = engine.bodies()
    assert world_vertices(body)[:, 0].min() == pytest.approx(pear[:, 0].min(), abs=0.05)


def test_a_mirrored_stroke_beside_the_axis_makes_two_bodies_or_extends_on_both_sides():
    draw(circle(40, 0.5, (2, 0)), use_mirror=True)
    assert len(engine.bodies()) == 2
    bpy.ops.ed.undo()
    body = disk()
    draw(circle(60, 0.8, (2, 0.5), start=np.pi), use_mirror=True)
    points = world_vertices(body)
    assert points[:, 0].max() == pytest.approx(2.8, abs=0.05)
    assert points[:, 0].min() == pytest.approx(-2.8, abs=0.05)
    draw(circle(40, 0.2, (1, 0)), use_mirror=True, subtract=True)
    check_body(body, genus=2)


def test_a_mirrored_stroke_that_reaches_two_bodies_extends_both():
    apart()
    draw(circle(60, 0.6, (3, 0), start=np.pi), use_mirror=True)
    assert len(engine.bodies()) == 2
    across = np.concatenate([world_vertices(ob)[:, 0] for ob in engine.bodies()])
    assert across.max() == pytest.approx(3.6, abs=0.05)
    # The mirror stands on the active body or the cursor; the active one is the right.
    assert across.min() < -2.5


@pytest.mark.parametrize(
    ("points", "said"),
    [
        ([(x, 0) for x in range(20)], "The stroke encloses nothing"),
        (
            [(np.sin(t), np.sin(2 * t)) for t in np.linspace(0, 2 * np.pi, 40, endpoint=False)],
            "The stroke encloses 2 parts",
        ),
        (circle(4), "The stroke is too short"),
    ],
)
@pytest.mark.parametrize("over", [False, True])
def test_what_is_no_outline_is_said_of_the_stroke(points, said, over, capfd):
    if over:
        disk()
    before = fingerprint()
    assert draw(points) == {"CANCELLED"}
    assert fingerprint() == before
    out = capfd.readouterr().out
    assert said in out
    assert "the outline" not in out
    assert "other outline" not in out


def test_the_history_has_a_short_name_for_the_stroke():
    disk()
    assert last().stroke.startswith(memory.MARK)
    assert len(last().stroke) < 8


def test_a_forgotten_stroke_is_said(capfd):
    disk()
    name = last().stroke
    memory._kept.clear()
    before = state()
    assert bpy.ops.object.gridmesh_draw_body("EXEC_DEFAULT", stroke=name) == {"CANCELLED"}
    assert "draw it again" in capfd.readouterr().out
    assert state() == before


@pytest.mark.parametrize("operator", OPERATORS.values())
def test_operators_without_a_stroke_say_so(operator, capfd):
    name = operator.bl_idname.removeprefix("object.")
    assert getattr(bpy.ops.object, name)("EXEC_DEFAULT") == {"CANCELLED"}
    assert "Nothing is drawn" in capfd.readouterr().out


def test_a_body_changed_by_hand_is_left_alone(capfd):
    body = disk()
    body.data.vertices[0].co.z += 1.0
    body.data.update()
    before = state()
    assert draw(ACTIONS["EXTEND"]) == {"CANCELLED"}
    assert "changed by hand" in capfd.readouterr().out
    assert state() == before


def test_a_mirrored_stroke_of_quads_has_mirrored_quads():
    pear = circle(60, 1, (0.6, 0))
    pear[:, 0] *= 1 + 0.4 * pear[:, 1]
    assert draw(pear, use_mirror=True, shape="SHEET", cells="QUADS", quads=300) == {"FINISHED"}
    (body,) = engine.bodies()
    assert {len(polygon.vertices) for polygon in body.data.polygons} == {4}
    assert body.gridmesh_live.mirror == "AUTO"
    points = world_vertices(body)
    apart = np.linalg.norm(points[:, None] - (points * [-1, 1, 1])[None], axis=2).min(axis=1)
    assert apart.max() < 1e-4
