"""A body and its outline are one thing: moved, scaled, copied, hidden, deleted in any way, they stay together."""

from math import pi

import bpy
import numpy as np
import pytest
from drawings import (
    activate,
    bean,
    check_body,
    circle,
    grease_pencil,
    run,
    triangles,
    vertices,
    world_vertices,
)
from mathutils import Matrix

from addon.data import frames
from addon.draw.gesture import pack
from addon.live import engine, family
from addon.live.reading import sketch_of

pytestmark = pytest.mark.usefixtures("awake")


def draw(points=None, matrix=None, **options):
    flat = (2 * bean() if points is None else np.asarray(points, float))[:, :2]
    before = set(engine.bodies())
    bpy.ops.object.gridmesh_draw(
        "EXEC_DEFAULT",
        True,
        stroke=pack(flat, np.ones(len(flat))),
        matrix=(np.eye(4) if matrix is None else np.asarray(matrix)).ravel().tolist(),
        triangles=600,
        **options,
    )
    engine.settle()
    (body,) = set(engine.bodies()) - before
    return body


def by_tool():
    body = draw()
    return body, body.gridmesh_live.source


def by_strokes():
    drawing = grease_pencil([2 * bean()])
    (body,) = run(triangles=600, follow=True)
    engine.settle()
    return body, drawing


KINDS = {"drawn with the tool": by_tool, "made from strokes": by_strokes}


@pytest.fixture(params=KINDS)
def pair(request):
    body, source = KINDS[request.param]()
    bpy.context.view_layer.update()
    return body, source


def outline_points(source):
    """World coordinates of the points of a drawing."""
    data = source.data.layers[0].current_frame().drawing.attributes["position"].data
    points = np.empty(len(data) * 3, np.float32)
    data.foreach_get("vector", points)
    return frames.moved(points.reshape(-1, 3).astype(float), np.array(source.matrix_world))


def shape(body, source):
    """All that is to be moved: vertices and outline in the world."""
    settle()
    return np.concatenate([world_vertices(body), outline_points(source)])


def settle():
    for _ in range(2):
        bpy.context.view_layer.update()
        engine.settle()
    bpy.context.view_layer.update()


def check_fresh(body):
    """Its mesh is what is made of its outline where that lies now."""
    assert body.gridmesh_live.problem == ""
    check_body(body)
    now, corners = vertices(body.data), triangles(body.data)
    assert body.gridmesh_live.digest == engine.fingerprint(
        body.gridmesh_live, sketch_of(body, bpy.context.evaluated_depsgraph_get())
    )
    engine.remake(body)
    assert np.array_equal(triangles(body.data), corners)
    assert np.array_equal(vertices(body.data), now)


def check_moved(body, source, before, motion):
    expected = frames.moved(before, np.array(motion))
    assert np.abs(shape(body, source) - expected).max() < 1e-5 * max(1, np.abs(expected).max())
    check_fresh(body)


def in_view(call, **options):
    """Call a transform as a user does in a 3D view, with a number."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        assert call("EXEC_DEFAULT", **options) == {"FINISHED"}


def translate():
    in_view(bpy.ops.transform.translate, value=(2, 0, 0))
    return Matrix.Translation((2, 0, 0))


def scale():
    in_view(bpy.ops.transform.resize, value=(2, 2, 2), center_override=(0, 0, 0))
    return Matrix.Scale(2, 4)


def rotate():
    in_view(
        bpy.ops.transform.rotate,
        value=-pi / 2,
        orient_axis="Z",
        orient_type="GLOBAL",
        center_override=(0, 0, 0),
    )
    return Matrix.Rotation(pi / 2, 4, "Z")


def stretch():
    in_view(bpy.ops.transform.resize, value=(1, 2, 1), center_override=(0, 0, 0))
    return Matrix.Diagonal((1, 2, 1, 1))


MOTIONS = [translate, rotate, scale, stretch]


@pytest.mark.smoke
@pytest.mark.parametrize("motion", MOTIONS)
def test_both_moved_by_the_tools_of_blender(pair, motion):
    body, source = pair
    before = shape(body, source)
    activate(body, source)
    wanted = motion()
    if motion is rotate:  # the sign of an angle is that of the view
        wanted = min(
            (wanted, wanted.inverted()),
            key=lambda one: np.abs(shape(body, source) - frames.moved(before, np.array(one))).max(),
        )
    check_moved(body, source, before, wanted)


def carrier(body, source):
    """The one of the two that is above the other."""
    return body if source.parent == body else source


@pytest.mark.parametrize("motion", MOTIONS)
def test_undo_and_redo_of_a_move(pair, motion):
    body, source = pair
    names = body.name, source.name
    before = shape(body, source)
    activate(body, source)
    bpy.ops.ed.undo_push(message="made")
    motion()
    after = shape(body, source)
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.ed.undo()
    body, source = (bpy.data.objects[name] for name in names)
    assert np.abs(shape(body, source) - before).max() < 1e-5
    bpy.ops.ed.redo()
    body, source = (bpy.data.objects[name] for name in names)
    assert np.abs(shape(body, source) - after).max() < 1e-5
    check_fresh(body)


@pytest.mark.parametrize("how", ["location", "matrix_world", "matrix_basis", "delta"])
def test_the_one_above_moved_by_a_script(pair, how):
    body, source = pair
    before = shape(body, source)
    ob = carrier(body, source)
    motion = Matrix.Translation((2, 0.5, -1)) @ Matrix.Rotation(0.5, 4, "X")
    if how == "location":
        motion = Matrix.Translation((2, 0, 0))
        ob.location.x += 2
    elif how == "delta":
        motion = Matrix.Translation((2, 0, 0))
        ob.delta_location.x += 2
    else:
        setattr(ob, how, motion @ getattr(ob, how))
    check_moved(body, source, before, motion)


def test_the_body_alone_of_a_drawing_stays_where_it_is_put():
    body, source = by_strokes()
    settle()
    mesh, lines = vertices(body.data), outline_points(source)
    body.location.x += 2
    settle()
    assert np.array_equal(vertices(body.data), mesh)
    assert np.array_equal(outline_points(source), lines)
    source.location.y += 1
    settle()
    assert np.array_equal(vertices(body.data), mesh)
    assert np.allclose(
        body.matrix_world.translation.y, lines[:, 1].min() / 2 + lines[:, 1].max() / 2 + 1, atol=1e-5
    )


@pytest.mark.parametrize(
    "motion",
    [
        Matrix.Translation((1, 0.5, 0)),
        Matrix.Rotation(0.7, 4, "Z"),
        Matrix.Scale(1.5, 4),
        Matrix.Rotation(0.4, 4, "X"),
    ],
)
def test_the_outline_alone_reshapes_the_mesh_and_leaves_the_object(motion):
    body, source = by_tool()
    place = body.matrix_world.copy()
    height = np.ptp(vertices(body.data)[:, 2])
    source.matrix_basis = motion @ source.matrix_basis
    settle()
    assert body.matrix_world == place
    check_fresh(body)
    sketch = sketch_of(body, bpy.context.evaluated_depsgraph_get())
    middle = sketch.plane.local(world_vertices(body) - np.array(place.translation))
    assert np.allclose(middle.min(axis=0) + middle.max(axis=0), 0, atol=0.05)
    assert np.ptp(middle[:, 2]) == pytest.approx(height * motion.median_scale, rel=0.02)


def empty(name="Empty", location=(0, 0, 0)):
    ob = bpy.data.objects.new(name, None)
    ob.location = location
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.update()
    return ob


@pytest.mark.parametrize("which", ["above", "both"])
@pytest.mark.parametrize("keep", [True, False])
def test_under_an_empty(pair, which, keep):
    """Parented by Ctrl-P, the one or both, with the place kept or not, and then the empty is moved."""
    body, source = pair
    above = empty(location=(1, 2, 3))
    chosen = [carrier(body, source)] if which == "above" else [body, source]
    before = shape(body, source)
    activate(above, *chosen)
    in_view(bpy.ops.object.parent_set, type="OBJECT", keep_transform=keep)
    settle()
    assert np.abs(shape(body, source) - before).max() < 1e-5
    assert frames.nested(source, body) == (body == carrier(body, source))
    above.matrix_world = Matrix.Translation((2, 0, 0)) @ Matrix.Rotation(0.3, 4, "Z") @ above.matrix_world
    motion = Matrix.Translation((2, 0, 0)) @ Matrix.Rotation(0.3, 4, "Z")
    check_moved(body, source, before, motion)
    activate(body, source)
    in_view(bpy.ops.object.parent_clear, type="CLEAR_KEEP_TRANSFORM")
    check_moved(body, source, before, motion)


def test_an_outline_made_a_child_by_hand():
    """The worst of 0.1.0: the outline of a drawing becomes the child of its body, which then follows itself."""
    body, source = by_strokes()
    world = body.matrix_world.copy()
    body.parent = None
    body.matrix_world = world
    settle()
    before = shape(body, source)
    activate(body, source)
    in_view(bpy.ops.object.parent_set, type="OBJECT", keep_transform=True)
    assert frames.nested(source, body)
    assert np.abs(shape(body, source) - before).max() < 1e-5
    body.location.x += 2
    check_moved(body, source, before, Matrix.Translation((2, 0, 0)))


def test_a_body_made_a_child_of_something_that_the_outline_is_not_in():
    body, source = by_tool()
    before = shape(body, source)
    source.parent = empty()
    body.location.x += 1
    settle()
    check_fresh(body)
    source.parent.location.x += 5
    settle()
    check_fresh(body)
    assert np.abs(world_vertices(body) - before[: len(body.data.vertices)] - [1, 0, 0]).max() < 1e-5


def duplicate(*chosen, linked=False):
    activate(*chosen)
    bpy.ops.object.duplicate(linked=linked)
    settle()
    return [ob for ob in bpy.context.selected_objects if ob not in chosen]


def edit(source, amount=1.3):
    """Stretch the strokes of a drawing."""
    drawing = source.data.layers[0].current_frame().drawing
    data = drawing.attributes["position"].data
    points = np.empty(len(data) * 3, np.float32)
    data.foreach_get("vector", points)
    data.foreach_set("vector", (points.reshape(-1, 3) * [amount, 1, 1]).astype(np.float32).ravel())
    drawing.tag_positions_changed()
    settle()


def test_both_duplicated_belong_together(pair):
    body, source = pair
    before = shape(body, source)
    copies = duplicate(body, source)
    copy = next(ob for ob in copies if ob.type == "MESH")
    lines = next(ob for ob in copies if ob.type != "MESH")
    assert copy.gridmesh_live.source == lines
    in_view(bpy.ops.transform.translate, value=(-3, 0, 0))
    check_moved(copy, lines, before, Matrix.Translation((-3, 0, 0)))
    check_moved(body, source, before, Matrix.Identity(4))
    edit(lines)
    check_moved(body, source, before, Matrix.Identity(4))
    assert np.ptp(vertices(copy.data)[:, 0]) > 1.2 * np.ptp(vertices(body.data)[:, 0])


def test_a_body_duplicated_alone_gets_an_outline_of_its_own(pair):
    body, source = pair
    before = shape(body, source)
    (copy,) = duplicate(body)
    own = copy.gridmesh_live.source
    assert own not in (None, source)
    assert own.data != source.data
    assert frames.owned(copy) == own
    check_fresh(copy)
    assert np.abs(world_vertices(copy) - world_vertices(body)).max() < 1e-4
    copy.location.x -= 3
    settle()
    edit(own)
    check_moved(body, source, before, Matrix.Identity(4))
    check_fresh(copy)
    assert np.ptp(vertices(copy.data)[:, 0]) > 1.2 * np.ptp(vertices(body.data)[:, 0])
    there = world_vertices(copy)
    edit(source, 0.8)
    assert np.array_equal(world_vertices(copy), there)


def test_a_linked_duplicate_shares_mesh_and_outline(pair):
    body, source = pair
    (copy,) = duplicate(body, linked=True)
    assert (copy.data, copy.gridmesh_live.source) == (body.data, source)
    copy.location.x -= 3
    count = len(engine.timing)
    edit(source)
    assert len(engine.timing) <= count + 2, "two bodies have written one mesh"
    check_fresh(body)
    assert copy.gridmesh_live.problem == ""
    assert np.allclose(world_vertices(copy) - world_vertices(body), [-3, 0, 0], atol=1e-5)
    bpy.data.objects.remove(body)
    settle()
    assert copy.gridmesh_live.source == source
    edit(source, 0.7)
    check_fresh(copy)


@pytest.mark.parametrize("which", ["the body", "the copy"])
def test_options_of_either_of_two_that_share_a_mesh_act(pair, which):
    body, source = pair
    (copy,) = duplicate(body, linked=True)
    one, other = (body, copy) if which == "the body" else (copy, body)
    high = np.ptp(vertices(body.data)[:, 2])
    one.gridmesh_live.depth = 0.5
    settle()
    assert np.ptp(vertices(body.data)[:, 2]) == pytest.approx(0.5 * high, rel=0.05)
    assert other.gridmesh_live.depth == 0.5
    before = vertices(body.data)
    activate(one)
    assert bpy.ops.object.gridmesh_curve(shape="RING") == {"FINISHED"}
    settle()
    assert np.abs(vertices(body.data) - before).max() > 0.05
    edit(source)
    check_fresh(body)


def test_two_that_share_a_mesh_part_when_an_outline_is_moved_in_one_of_them():
    body, source = by_tool()
    copy, line = sorted(duplicate(body, source, linked=True), key=lambda ob: ob.type, reverse=True)
    assert copy.data == body.data
    before = world_vertices(body)
    line.location.x += 0.5
    bpy.context.view_layer.update()
    settle()
    assert copy.data != body.data
    assert np.abs(world_vertices(body) - before).max() < 1e-6
    check_fresh(body)
    check_fresh(copy)
    body.data.vertices[3].co.z += 0.1
    body.data.update()
    settle()
    assert body.gridmesh_live.problem == engine.BY_HAND
    activate(body)
    assert bpy.ops.object.gridmesh_rebuild() == {"FINISHED"}
    check_fresh(body)


def test_rebuild_of_a_copy_that_shares_the_mesh_is_that_of_the_body(pair):
    body, _source = pair
    (copy,) = duplicate(body, linked=True)
    body.data.vertices[3].co.z += 0.1
    body.data.update()
    settle()
    assert copy.gridmesh_live.problem == body.gridmesh_live.problem == engine.BY_HAND
    activate(copy)
    assert bpy.ops.object.gridmesh_rebuild() == {"FINISHED"}
    settle()
    assert copy.gridmesh_live.problem == body.gridmesh_live.problem == ""
    check_fresh(body)


def test_an_outline_duplicated_alone_is_a_drawing():
    body, source = by_tool()
    before = shape(body, source)
    (copy,) = duplicate(source)
    assert engine.bodies() == [body]
    assert not copy.gridmesh_outline
    edit(copy, 2)
    check_moved(body, source, before, Matrix.Identity(4))
    activate(body)
    bpy.ops.object.delete()
    settle()
    assert copy.name in bpy.context.scene.objects


def drawings():
    return [ob for ob in bpy.data.objects if ob.type == "GREASEPENCIL" and ob.users_scene]


def test_a_deleted_body_takes_its_outline_along_and_undo_brings_both_back():
    body, source = by_tool()
    name, before = body.name, shape(body, source)
    activate(body)
    bpy.ops.ed.undo_push(message="made")
    bpy.ops.object.delete()
    bpy.ops.ed.undo_push(message="deleted")
    settle()
    assert engine.bodies() == []
    assert drawings() == []
    for _ in range(2):
        bpy.ops.ed.undo()
        body = bpy.data.objects[name]
        check_moved(body, body.gridmesh_live.source, before, Matrix.Identity(4))
        assert drawings() == [body.gridmesh_live.source]
        bpy.ops.ed.redo()
        settle()
        assert engine.bodies() == []
        assert drawings() == []


@pytest.mark.parametrize("moved", [False, True])
@pytest.mark.parametrize("script", [False, True])
def test_a_deleted_outline_leaves_the_body_where_it_is(pair, moved, script):
    body, source = pair
    if moved:
        carrier(body, source).matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.5, 4, "Y")
    settle()
    place, mesh = body.matrix_world.copy(), vertices(body.data)
    name = body.name
    bpy.ops.ed.undo_push(message="made")
    if script:
        bpy.data.objects.remove(source)
    else:
        activate(source)
        bpy.ops.object.delete()
    settle()
    assert np.allclose(body.matrix_world, place, atol=1e-5)
    assert np.array_equal(vertices(body.data), mesh)
    assert "gone" in body.gridmesh_live.problem
    assert drawings() == []
    bpy.ops.ed.undo_push(message="deleted")
    bpy.ops.ed.undo()
    settle()
    body = bpy.data.objects[name]
    assert np.allclose(body.matrix_world, place, atol=1e-5)
    check_fresh(body)
    bpy.ops.ed.redo()
    settle()
    assert np.allclose(bpy.data.objects[name].matrix_world, place, atol=1e-5)


def test_undo_of_a_deleted_outline_brings_the_link_back(pair):
    """As often as one likes, also where the step was noted before the body forgot its drawing."""
    body, source = pair
    names = body.name, source.name
    before = shape(body, source)
    bpy.ops.ed.undo_push(message="made")
    activate(source)
    bpy.ops.object.delete()
    bpy.ops.ed.undo_push(message="deleted")
    settle()
    for _ in range(2):
        bpy.ops.ed.undo()
        settle()
        body, source = (bpy.data.objects[name] for name in names)
        assert body.gridmesh_live.source == source
        assert body.gridmesh_live.problem == ""
        check_moved(body, source, before, Matrix.Identity(4))
        bpy.ops.ed.redo()
        settle()
        assert "gone" in bpy.data.objects[names[0]].gridmesh_live.problem


def test_both_deleted_leave_nothing(pair):
    activate(*pair)
    bpy.ops.object.delete()
    settle()
    assert engine.bodies() == []
    assert drawings() == []


@pytest.mark.parametrize("how", ["H", "viewport", "collection"])
def test_the_outline_is_hidden_and_shown_with_its_body(how):
    body, source = by_tool()
    settle()
    assert source.visible_get()
    assert source.hide_render
    other = bpy.data.collections.new("Aside")
    bpy.context.scene.collection.children.link(other)

    def hide(hidden):
        if how == "H":
            body.hide_set(hidden)
        elif how == "viewport":
            body.hide_viewport = hidden
        elif hidden:
            bpy.context.scene.collection.objects.unlink(body)
            other.objects.link(body)
            settle()
            bpy.context.view_layer.layer_collection.children["Aside"].hide_viewport = True
        else:
            bpy.context.view_layer.layer_collection.children["Aside"].hide_viewport = False
        settle()

    hide(True)
    assert not source.visible_get()
    hide(False)
    assert source.visible_get()
    source.hide_set(True)  # hidden alone, to see the body without it
    settle()
    assert not source.visible_get()
    check_fresh(body)


def test_frozen_it_takes_the_outline_of_the_tool_along():
    body, _ = by_tool()
    activate(body)
    assert bpy.ops.object.gridmesh_freeze() == {"FINISHED"}
    settle()
    assert drawings() == []
    assert not frames.is_linked(body)
    assert list(body.keys()) == []
    check_body(body)


def test_frozen_it_leaves_the_drawing_of_the_user():
    body, source = by_strokes()
    activate(body)
    bpy.ops.object.gridmesh_freeze()
    settle()
    assert drawings() == [source]


def test_one_outline_object_for_each_body():
    body, source = by_tool()
    assert source.parent == body
    assert source.name == f"{body.name} Outline"
    assert source.hide_render
    strokes = source.data.layers[0].current_frame().drawing.strokes
    assert [stroke.cyclic for stroke in strokes] == [True]
    assert len(bpy.context.scene.objects) == 2


def test_the_loose_ends_of_the_stroke_are_not_kept():
    points = circle(80, 2, turn=2 * pi + 0.4, closed=False)
    points[-1] *= 1.2
    body = draw(points)
    lines = outline_points(body.gridmesh_live.source)
    assert np.linalg.norm(lines, axis=1).max() < 2.1


def test_bodies_that_are_appended_are_looked_at(tmp_path):
    """Where there is none, changes are not looked at; one that comes from a file is seen without more."""
    body, _ = by_tool()
    name = body.name
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.context.view_layer.update()
    assert family.nobody()
    bpy.ops.wm.append(directory=f"{path}/Object/", filename=name)
    bpy.context.view_layer.update()
    assert not family.nobody()


@pytest.mark.parametrize("way", ["append", "load", "link"])
def test_a_body_alone_from_another_file(tmp_path, pair, way):
    body, source = pair
    body.location = (1, 2, 3) if carrier(body, source) == body else body.location
    name, before = body.name, shape(body, source)
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    if way == "append":
        bpy.ops.wm.append(directory=f"{path}/Object/", filename=name)
        body = bpy.data.objects[name]
    else:
        with bpy.data.libraries.load(path, link=way == "link") as (_, here):
            here.objects = [name]
        body = here.objects[0]
        bpy.context.scene.collection.objects.link(body)
    settle()
    source = body.gridmesh_live.source
    if way == "link":
        assert np.abs(world_vertices(body) - before[: len(body.data.vertices)]).max() < 1e-5
        assert "another file" in body.gridmesh_live.problem or body.gridmesh_live.problem == ""
        return
    check_moved(body, source, before, Matrix.Identity(4))
    assert source.users_scene
    edit(source)
    check_fresh(body)
    assert np.ptp(world_vertices(body)[:, 0]) > 1.2 * np.ptp(before[: len(body.data.vertices), 0])


def test_a_moved_body_is_extended_where_it_is():
    body, _ = by_tool()
    body.matrix_world = Matrix.Translation((7, 0, 0)) @ Matrix.Rotation(0.3, 4, "Z")
    settle()
    place, before = body.matrix_world.copy(), np.ptp(world_vertices(body)[:, 0])
    right = world_vertices(body)[:, 0].max()
    y = world_vertices(body)[world_vertices(body)[:, 0].argmax(), 1]
    limb = circle(60, 0.7, (right, y), start=pi)[:, :2]
    bpy.ops.object.gridmesh_draw(
        "EXEC_DEFAULT", True, stroke=pack(limb, np.ones(60)), matrix=np.eye(4).ravel().tolist(), triangles=600
    )
    settle()
    assert engine.bodies() == [body]
    assert body.matrix_world == place
    assert np.ptp(world_vertices(body)[:, 0]) == pytest.approx(before + 0.7, abs=0.1)
    check_fresh(body)


def test_moving_costs_nothing(pair, monkeypatch):
    body, source = pair
    settle()

    def refuse(*_arguments, **_options):
        raise AssertionError("a body that was only moved is looked at")

    monkeypatch.setattr(engine, "follow", refuse)
    carrier(body, source).location.x += 1
    bpy.context.view_layer.update()


def test_nothing_is_walked_where_nothing_is_live(monkeypatch):
    ob = grease_pencil([bean()])
    bpy.context.view_layer.update()
    assert family.known() == []

    def refuse(*_arguments):
        raise AssertionError("all objects are walked")

    monkeypatch.setattr(family, "bodies", refuse)
    ob.location.x += 1
    bpy.context.view_layer.update()
