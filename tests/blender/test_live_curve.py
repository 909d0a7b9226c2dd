"""The profile curve of a live body: stored with it, followed, copied, undone, and gone with it."""

import bpy
import numpy as np
import pytest
from drawings import activate, bean, check_body, circle, grease_pencil, run_one, vertices

from addon.bodies import profilecurve
from addon.live import engine

pytestmark = pytest.mark.usefixtures("awake")


@pytest.fixture
def body():
    grease_pencil([bean()])
    made = run_one(follow=True)
    engine.settle()
    activate(made)
    return made


def blocks():
    """How many data blocks of every kind there are."""
    kinds = (
        name for name in dir(bpy.data) if isinstance(getattr(bpy.data, name), bpy.types.bpy_prop_collection)
    )
    return {name: len(getattr(bpy.data, name)) for name in kinds}


def set_shape(shape):
    assert bpy.ops.object.gridmesh_curve(shape=shape) == {"FINISHED"}


def drag(ob, x, y, point=1):
    """Move a point as the widget does: the modifier's body is told."""
    mapping = profilecurve.holder(ob).map_curve
    mapping.curves[0].points[point].location = (x, y)
    mapping.update()
    ob.update_tag()
    bpy.context.view_layer.update()


def middle(ob):
    """Height of the body above the middle of a circle."""
    points = vertices(ob.data)
    return float(points[np.hypot(points[:, 0], points[:, 1]) < 0.1, 2].max())


@pytest.mark.smoke
def test_the_body_follows_its_curve(body):
    plain = vertices(body.data)
    set_shape("ROUND")
    assert np.array_equal(vertices(body.data), plain), "a straight line changes nothing"
    drag(body, 1.0, 0.5)
    assert vertices(body.data)[:, 2].max() == pytest.approx(0.5 * plain[:, 2].max(), rel=0.02)
    check_body(body)
    drag(body, 1.0, 1.0)
    assert np.array_equal(vertices(body.data), plain)
    assert body.gridmesh_live.problem == ""


@pytest.mark.smoke
def test_the_curve_does_nothing_else(body):
    before = blocks()
    set_shape("RING")
    assert blocks() == before
    holder = profilecurve.holder(body)
    assert (holder.show_viewport, holder.show_render) == (False, False)
    seen = body.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert np.array_equal(vertices(seen), vertices(body.data))
    assert not body.vertex_groups


def test_shapes_and_none(body):
    plain = vertices(body.data)
    heights = {}
    for shape in ("PLATEAU", "POINTED", "RING", "HAT"):
        set_shape(shape)
        check_body(body)
        heights[shape] = vertices(body.data)
        assert len(profilecurve.points(body)) == len(profilecurve.SHAPES[shape])
    assert len({points.tobytes() for points in heights.values()}) == 4
    assert (
        np.abs(heights["PLATEAU"][:, 2]).mean()
        > np.abs(plain[:, 2]).mean()
        > np.abs(heights["HAT"][:, 2]).mean()
    )
    set_shape("NONE")
    assert profilecurve.holder(body) is None
    assert np.array_equal(vertices(body.data), plain)


def test_a_ring_is_hollow():
    grease_pencil([circle(200)])
    body = run_one(follow=True)
    activate(body)
    radius = middle(body)
    set_shape("RING")
    assert middle(body) == pytest.approx(0.35 * radius, rel=0.03)
    assert vertices(body.data)[:, 2].max() == pytest.approx(radius, rel=0.02)


def test_a_copy_has_a_curve_of_its_own(body):
    set_shape("RING")
    before = blocks()
    bpy.ops.object.duplicate()
    copy = bpy.context.view_layer.objects.active
    assert copy != body
    assert profilecurve.points(copy) == profilecurve.points(body)
    mine, other = vertices(body.data), vertices(copy.data)
    drag(copy, 0.4, 0.9)
    assert np.array_equal(vertices(body.data), mine)
    assert not np.array_equal(vertices(copy.data), other)
    bpy.ops.object.delete()
    bpy.ops.outliner.orphans_purge()  # its mesh
    assert blocks() == before


def test_nothing_is_left_of_a_deleted_body(body):
    engine.freeze(body)
    empty = blocks()
    engine.settle()
    grease_pencil([bean()])
    other = run_one(follow=True)
    activate(other)
    set_shape("HAT")
    drag(other, 0.3, 0.4)
    source = other.gridmesh_live.source
    activate(other, source)
    bpy.ops.object.delete()
    bpy.ops.outliner.orphans_purge(do_recursive=True)
    assert blocks() == empty


def test_frozen_it_keeps_its_shape_and_no_curve(body):
    set_shape("PLATEAU")
    before = vertices(body.data)
    bpy.ops.object.gridmesh_freeze()
    assert not body.modifiers
    assert list(body.keys()) == []
    assert np.array_equal(vertices(body.data), before)


def test_other_modifiers_stay(body):
    body.modifiers.new("Subdivision", "SUBSURF")
    set_shape("PLATEAU")
    set_shape("NONE")
    set_shape("RING")
    bpy.ops.object.gridmesh_freeze()
    assert [modifier.name for modifier in body.modifiers] == ["Subdivision"]


def test_a_modifier_that_only_has_the_name_is_left_alone(body):
    body.modifiers.new(profilecurve.NAME, "SUBSURF")
    plain = vertices(body.data)
    set_shape("PLATEAU")
    assert profilecurve.points(body) is not None
    engine.freeze(body)
    assert [modifier.type for modifier in body.modifiers] == ["SUBSURF"]
    assert len(vertices(body.data)) == len(plain)


def test_switched_off_it_waits(body):
    body.gridmesh_live.enabled = False
    plain = vertices(body.data)
    set_shape("RING")
    drag(body, 0.4, 0.9)
    assert np.array_equal(vertices(body.data), plain)
    body.gridmesh_live.enabled = True
    assert not np.array_equal(vertices(body.data), plain)


def test_undo_and_redo():
    grease_pencil([bean()])
    bpy.ops.ed.undo_push(message="base")
    bpy.ops.object.gridmesh_from_strokes("EXEC_DEFAULT", True, triangles=500, follow=True)
    engine.settle()
    bpy.ops.ed.undo_push(message="made")
    name = "Drawing.mesh"
    plain = vertices(bpy.data.objects[name].data)
    bpy.ops.object.gridmesh_curve("EXEC_DEFAULT", True, shape="RING")
    ring = vertices(bpy.data.objects[name].data)
    drag(bpy.data.objects[name], 0.4, 0.9)
    engine.settle()
    dragged = vertices(bpy.data.objects[name].data)
    bpy.ops.ed.undo_push(message="dragged")
    bpy.ops.ed.undo()
    assert np.array_equal(vertices(bpy.data.objects[name].data), ring)
    bpy.ops.ed.undo()
    assert np.array_equal(vertices(bpy.data.objects[name].data), plain)
    assert profilecurve.holder(bpy.data.objects[name]) is None
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert np.array_equal(vertices(bpy.data.objects[name].data), dragged)


def test_saved_opened_and_appended(body, tmp_path):
    set_shape("RING")
    drag(body, 0.4, 0.7)
    before, points, path = vertices(body.data), profilecurve.points(body), str(tmp_path / "curve.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    body = bpy.data.objects["Drawing.mesh"]
    bpy.context.view_layer.update()
    engine.settle()
    assert profilecurve.points(body) == points
    assert np.array_equal(vertices(body.data), before)
    drag(body, 0.4, 0.9)
    assert not np.array_equal(vertices(body.data), before)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(path) as (_, here):
        here.objects = ["Drawing.mesh"]
    assert profilecurve.points(here.objects[0]) == points


def test_a_curve_that_is_drawn_below_the_rim_is_still_a_body(body):
    set_shape("RING")
    drag(body, 0.0, 0.6, point=0)
    check_body(body)
    for point in range(5):
        drag(body, profilecurve.points(body)[point][0], 0.0, point=point)
    check_body(body)
    assert body.gridmesh_live.problem == ""


def test_the_drawing_is_meshed_once_for_all_its_curves(body, monkeypatch):
    import gridmesh

    calls = []
    own = gridmesh.mesh_sketch
    monkeypatch.setattr(gridmesh, "mesh_sketch", lambda *a, **k: calls.append(1) or own(*a, **k))
    set_shape("RING")
    calls.clear()
    for step in range(5):
        drag(body, 0.4, 0.5 + 0.05 * step)
    body.gridmesh_live.depth = 2.0
    assert not calls
    body.gridmesh_live.triangles += 500
    assert len(calls) == 1


@pytest.mark.parametrize("follow", [False, True])
def test_the_operator_makes_bodies_with_a_curve(follow):
    grease_pencil([bean()])
    plain = vertices(run_one().data)
    before = blocks()
    grease_pencil([bean()])
    added = blocks()
    body = run_one(follow=follow, curve="PLATEAU")
    made = vertices(body.data)
    assert not np.array_equal(made, plain)
    assert (profilecurve.holder(body) is not None) == follow
    assert blocks()["objects"] == added["objects"] + 1 == before["objects"] + 2
    engine.settle()
    assert np.array_equal(vertices(body.data), made), "the live body is another one than that which was made"


def test_an_update_keeps_the_curve_of_a_live_body(body):
    set_shape("RING")
    ring, points = vertices(body.data), profilecurve.points(body)
    bpy.ops.object.gridmesh_from_strokes(update_existing=True, triangles=500)
    assert profilecurve.points(body) == points
    assert vertices(body.data)[:, 2].max() == pytest.approx(ring[:, 2].max(), rel=0.05)
    activate(body)
    bpy.ops.object.gridmesh_from_strokes(update_existing=True, triangles=500, curve="HAT")
    assert len(profilecurve.points(body)) == len(profilecurve.SHAPES["HAT"])


def test_a_stroke_drawn_as_the_active_body(body):
    from addon.draw.gesture import pack

    set_shape("RING")
    drag(body, 0.4, 0.8)
    points = circle(60, 0.5, (5, 0))[:, :2]
    bpy.ops.object.gridmesh_draw(
        "EXEC_DEFAULT",
        stroke=pack(points, np.ones(len(points))),
        matrix=np.eye(4).ravel().tolist(),
        triangles=500,
        curve="ACTIVE",
    )
    drawn = bpy.context.view_layer.objects.active
    assert drawn != body
    assert profilecurve.points(drawn) == profilecurve.points(body)
    before = vertices(drawn.data)
    engine.settle()
    assert np.array_equal(vertices(drawn.data), before)


def test_parts_of_a_trimmed_body_have_its_curve():
    from addon.draw.gesture import pack

    def draw(points, **options):
        bpy.ops.object.gridmesh_draw(
            "EXEC_DEFAULT",
            stroke=pack(points[:, :2], np.ones(len(points))),
            matrix=np.eye(4).ravel().tolist(),
            triangles=500,
            **options,
        )

    draw(circle(80) * 2, curve="PLATEAU")
    band = np.array([[-0.2, -4], [0.2, -4], [0.2, 4], [-0.2, 4]], float)
    sides = [
        np.linspace(a, b, 30, endpoint=False) for a, b in zip(band, np.roll(band, -1, axis=0), strict=True)
    ]
    draw(np.concatenate(sides), subtract=True)
    bodies = engine.bodies()
    assert len(bodies) == 2
    assert profilecurve.points(bodies[0]) == profilecurve.points(bodies[1]) is not None
    assert {len(profilecurve.points(one)) for one in bodies} == {len(profilecurve.SHAPES["PLATEAU"])}
