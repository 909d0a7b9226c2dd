"""A body and its outline are one thing, by mouse and keys: moved, copied, given a parent, hidden, deleted, undone."""

import bpy
import numpy as np
from mathutils import Matrix
from setting import (
    begin,
    bodies,
    modules,
    outlines,
    points_of,
    redo,
    reopened,
    ring,
    select,
    stage,
    stroke,
    tool,
    turn_view,
    typed,
    undo,
)


def drawn():
    """A body drawn with the tool; then the tool that selects."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 60, y), 110, 60, wobble=0.2))
    yield from tool("builtin.select_box")
    yield from stage.move(x, y)
    (body,) = bodies()
    yield 0.6
    return body


def shape(body):
    """Vertices of a body and points of its outline in the world."""
    bpy.context.view_layer.update()
    moved = modules("data.frames").moved
    found = [points_of(body)]
    source = body.gridmesh_live.source
    data = source.data.layers[0].current_frame().drawing.attributes["position"].data
    lines = np.empty(len(data) * 3, np.float32)
    data.foreach_get("vector", lines)
    return np.concatenate([*found, moved(lines.reshape(-1, 3).astype(float), np.array(source.matrix_world))])


def check(body, before, motion, what):
    expected = modules("data.frames").moved(before, np.array(motion))
    now = shape(body)
    assert now.shape == expected.shape, f"{what}: another mesh"
    error = np.abs(now - expected).max()
    assert error < 1e-5, f"{what}: {error:.3g} from where it should be"
    assert body.gridmesh_live.problem == "", f"{what}: {body.gridmesh_live.problem}"


def everything():
    yield from stage.key("A")
    yield 0.3
    assert {ob.type for ob in bpy.context.selected_objects} == {"MESH", "GREASEPENCIL"}


def together_transforms():
    """A G X 2 Enter, A S 2 Enter, A R Y 90 Enter, and a drag: body and outline once, not twice; undo of each."""
    body = yield from drawn()
    before, place = shape(body), np.array(body.matrix_world)
    about = Matrix.Translation(place[:3, 3])
    quarter = about @ Matrix.Rotation(np.pi / 2, 4, "Y") @ about.inverted()
    rows = [
        ("A G X 2", ("G", "X", "2", "RET"), Matrix.Translation((2, 0, 0))),
        ("A S 2", ("S", "2", "RET"), about @ Matrix.Scale(2, 4) @ about.inverted()),
        ("A R Y 90", ("R", "Y", "90", "RET"), quarter),
    ]
    for what, keys, motion in rows:
        yield from everything()
        yield from typed(*keys)
        yield from stage.picture("together_" + what.replace(" ", "_").lower())
        (body,) = bodies()
        check(body, before, motion, what)
        yield from undo()
        (body,) = bodies()
        check(body, before, Matrix.Identity(4), f"{what}, undone")
    yield from everything()
    x, y = stage.middle()
    for key in ("G", "S", "R"):
        yield from stage.move(x + 120, y)
        yield from stage.key(key)
        for k in range(8):
            yield from stage.move(x + 120 + 6 * k, y + 8 * k)
        yield from stage.press("LEFTMOUSE", "PRESS")
        yield from stage.press("LEFTMOUSE", "RELEASE")
        yield 1.0
        (body,) = bodies()
        motion = np.array(body.matrix_world) @ np.linalg.inv(place)
        assert np.abs(motion - np.eye(4)).max() > 0.05, f"{key} by dragging did nothing"
        check(body, before, motion, f"{key} by dragging")
        yield from undo()
        (body,) = bodies()
        check(body, before, Matrix.Identity(4), f"{key} by dragging, undone")


def together_copies():
    """Shift-D of both, and of the body alone; Ctrl-Z of each."""
    body = yield from drawn()
    before = shape(body)
    yield from everything()
    yield from stage.key("D", shift=True)
    yield from typed("X", "-3", "RET")
    yield from stage.picture("together_copied")
    first, second = sorted(bodies(), key=lambda ob: -ob.matrix_world.translation.x)
    check(first, before, Matrix.Identity(4), "the body that was copied")
    check(second, before, Matrix.Translation((-3, 0, 0)), "the copy")
    assert second.gridmesh_live.source.parent == second
    assert len(outlines()) == 2
    yield from undo()
    yield from undo()
    (body,) = bodies()
    assert len(outlines()) == 1
    select(body)
    bpy.ops.ed.undo_push(message="Select")
    yield 0.3
    yield from stage.key("D", shift=True)
    yield from typed("X", "-3", "RET")
    assert len(bodies()) == 2
    assert len(outlines()) == 2, "the copy has no outline of its own"
    first, second = sorted(bodies(), key=lambda ob: -ob.matrix_world.translation.x)
    check(first, before, Matrix.Identity(4), "the body that was copied alone")
    check(second, before, Matrix.Translation((-3, 0, 0)), "the copy of the body alone")
    assert second.gridmesh_live.source != first.gridmesh_live.source
    yield from stage.picture("together_copied_alone")
    yield from undo()
    yield from undo()
    assert len(bodies()) == 1
    assert len(outlines()) == 1, "undo leaves an outline"


def together_parent():
    """Ctrl-P of everything to an empty, which is then moved; undone."""
    body = yield from drawn()
    before = shape(body)
    empty = bpy.data.objects.new("Empty", None)
    empty.location = (1, 0, 1)
    bpy.context.scene.collection.objects.link(empty)
    select(empty)
    bpy.ops.ed.undo_push(message="Empty")
    yield 0.3
    yield from stage.key("A")
    yield 0.3
    yield from stage.key("P", ctrl=True)
    yield 0.5
    yield from stage.key("RET")
    yield 1.0
    (body,) = bodies()
    assert body.parent is not None, "Ctrl-P did nothing"
    assert body.gridmesh_live.source.parent == body, "the outline was not put back"
    check(body, before, Matrix.Identity(4), "Ctrl-P")
    select(bpy.data.objects["Empty"])
    bpy.ops.ed.undo_push(message="Select")
    yield 0.3
    yield from typed("G", "X", "2", "RET")
    (body,) = bodies()
    check(body, before, Matrix.Translation((2, 0, 0)), "the empty moved")
    yield from stage.picture("together_parent")
    for _ in range(4):
        yield from undo()
        (body,) = bodies()
    assert body.parent is None
    check(body, before, Matrix.Identity(4), "Ctrl-P, undone")
    assert body.gridmesh_live.source.parent == body


def together_hidden():
    """H hides the outline, too, Alt-H shows both; X deletes both; Ctrl-Z brings them back, Ctrl-Shift-Z not."""
    body = yield from drawn()
    before = shape(body)
    select(body)
    bpy.ops.ed.undo_push(message="Select")
    yield 0.3
    yield from stage.key("H")
    yield 0.8
    assert not any(ob.visible_get() for ob in bpy.context.scene.objects), "H leaves the outline"
    yield from stage.picture("together_hidden")
    yield from undo()
    assert all(ob.visible_get() for ob in bpy.context.scene.objects), "undo of H leaves the outline hidden"
    (body,) = bodies()
    select(body)
    bpy.ops.ed.undo_push(message="Select")
    yield 0.3
    yield from stage.key("X")
    yield 0.5
    yield from stage.key("RET")
    yield 1.0
    assert not bodies()
    assert not outlines(), "X leaves the outline"
    yield from stage.picture("together_deleted")
    yield from undo()
    (body,) = bodies()
    check(body, before, Matrix.Identity(4), "X, undone")
    yield from stage.key("Z", ctrl=True, shift=True)
    yield 1.0
    assert not bodies()
    assert not outlines(), "redo leaves the outline"


def together_hand():
    """A live body is changed in Edit Mode: it pauses, the panel says so, Rebuild from Outline takes it back."""
    body = yield from drawn()
    select(body)
    yield from stage.key("TAB")
    yield 0.6
    yield from stage.key("A", alt=True)
    with stage.override():
        bpy.ops.mesh.select_random(ratio=0.3, seed=3)
    yield 0.3
    yield from typed("S", "2", "RET")
    yield from stage.key("TAB")
    yield 1.0
    (body,) = bodies()
    assert "by hand" in body.gridmesh_live.problem, body.gridmesh_live.problem
    width = np.ptp(shape(body)[: len(body.data.vertices), 0])
    yield from stage.open_sidebar()
    yield from stage.picture("together_paused")
    yield from stage.press_button("UI", "gridmesh_rebuild")
    (body,) = bodies()
    assert body.gridmesh_live.problem == ""
    assert np.ptp(shape(body)[: len(body.data.vertices), 0]) < 0.6 * width
    yield from stage.picture("together_rebuilt")


def together_look():
    """What is seen of an outline: from near, on a slender body, in the outliner, in a render."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 110, y + 60), 120, 60, wobble=0.2))
    snake = [(x - 250 + 5 * k, y - 170 + 20 * np.sin(k / 9)) for k in range(100)]
    yield from stroke(snake + [(a, b - 6) for a, b in reversed(snake)])
    yield from tool("builtin.select_box")
    for ob in bpy.context.view_layer.objects:
        ob.select_set(False)
    yield from stage.picture("together_look_1")
    turn_view()
    yield from stage.picture("together_look_2")
    assert all(ob.hide_render for ob in outlines())


def together_applied():
    """Ctrl-A, Scale and All Transforms: nothing moves, the body stays live; Ctrl-Z of each."""
    body = yield from drawn()
    body.scale, body.rotation_euler = (1.5, 0.8, 1.2), (1.3, 0.2, 0.4)
    select(body)
    bpy.ops.ed.undo_push(message="Placed")
    yield 0.6
    before = shape(body)
    for entry in ("Scale", "All Transforms"):
        yield from stage.move(*stage.middle())
        yield from stage.key("A", ctrl=True)
        yield 0.5
        yield from stage.choose(entry)
        (body,) = bodies()
        assert np.allclose(body.scale, 1), f"{entry} was not applied"
        check(body, before, Matrix.Identity(4), entry)
        yield from stage.picture("together_applied_" + entry.split()[0].lower())
        live = body.gridmesh_live
        depth = live.depth
        live.depth = 0.5 * depth
        yield 1.0
        live.depth = depth
        yield 3.0
        # Rounding decides between lattices that fit alike: the vertices may be others, the body is where it was.
        assert live.problem == "", live.problem
        for end in (np.min, np.max):
            error = np.abs(end(shape(body), axis=0) - end(before, axis=0)).max()
            assert error < 0.02, f"{entry}, then made anew: {error:.3g} from where it should be"
        bpy.ops.ed.undo_push(message="Depth")
        yield from undo()
        yield from undo()
        (body,) = bodies()
        assert not np.allclose(body.scale, 1), f"{entry} was not undone"
        check(body, before, Matrix.Identity(4), f"{entry}, undone")


def together_saved():
    """All selected, moved, scaled; undone twice, redone twice; saved and opened: body and outline where they were put."""
    body = yield from drawn()
    before = shape(body)
    yield from everything()
    yield from typed("G", "X", "2", "RET")
    yield from typed("S", "2", "RET")
    (body,) = bodies()
    put = shape(body)
    yield from undo()
    yield from undo()
    (body,) = bodies()
    assert np.abs(shape(body) - before).max() < 1e-5, "undone twice"
    for _ in range(2):
        yield from redo()
    (body,) = bodies()
    assert np.abs(shape(body) - put).max() < 1e-5, "redone twice"
    n = len(bpy.data.objects)
    yield from reopened()
    (body,) = bodies()
    assert len(bpy.data.objects) == n
    assert np.abs(shape(body) - put).max() < 1e-5, "opened"


SCENES = (
    together_applied,
    together_transforms,
    together_saved,
    together_copies,
    together_parent,
    together_hidden,
    together_hand,
    together_look,
)
