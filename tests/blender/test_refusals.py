"""Bad input: the scene stays as it was, and the message says why."""

import sys
import types

import bpy
import numpy as np
import pytest
from drawings import (
    activate,
    at,
    bean,
    check_body,
    circle,
    curve,
    fingerprint,
    grease_pencil,
    linked,
    run_one,
)

import addon
from addon import api
from addon.data import frames
from addon.data.placing import Transaction

NAN, INF = float("nan"), float("inf")
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)


def stroke(points, **options):
    return lambda: grease_pencil([np.asarray(points, float)], **options)


def with_point(value):
    points = circle()
    points[5, 1] = value
    return points


def empty_object():
    ob = grease_pencil([])
    ob.data.layers.remove(ob.data.layers[0])


def hidden_layers():
    ob = grease_pencil([circle()])
    grease_pencil([circle()], ob=ob, layer="Other")
    for layer in ob.data.layers:
        layer.hide = True


def zero_scale():
    grease_pencil([circle()]).scale = (0, 0, 0)
    bpy.context.view_layer.update()


def zero_scale_on_one_axis():
    grease_pencil([circle()]).scale = (1, 0, 1)
    bpy.context.view_layer.update()


def nothing_selected():
    ob = grease_pencil([circle()])
    drawing = ob.data.layers[0].current_frame().drawing
    drawing.attributes.new(".selection", "BOOLEAN", "CURVE").data.foreach_set("value", np.zeros(1, bool))


def mesh_active():
    linked("Mesh", bpy.data.meshes.new("Mesh"))


def nothing_in_the_scene():
    activate()


def nothing_picked():
    grease_pencil([circle()])
    activate()


def closed_tube():
    ob = curve([circle()])
    ob.modifiers.new("Solid", "REMESH")
    ob.data.bevel_depth = 0.2


def empty_text():
    data = bpy.data.curves.new("Text", "FONT")
    data.body = ""
    linked("Text", data)


def empty_annotations():
    scene = bpy.context.scene
    if hasattr(scene, "annotation"):
        scene.annotation = bpy.data.annotations.new("Notes")
    else:
        scene.grease_pencil = bpy.data.grease_pencils.new("Notes")


def strip():
    """A strip a thousand times as long as it is wide."""
    return np.array([[0, 0, 0], [10, 0, 0], [10, 0.01, 0], [0, 0.01, 0]])


CASES = {
    # name: (scene, options, part of the message)
    "object without layers": (empty_object, {}, "'Drawing' has no layers"),
    "no strokes": (lambda: grease_pencil([]), {}, "have no strokes; draw a closed shape"),
    "no drawing at this frame": (stroke(circle(), frame=50), {}, "no drawing at the current frame"),
    "all layers hidden": (hidden_layers, {}, "all layers of 'Drawing' are hidden"),
    "one point": (stroke([[0, 0, 0]]), {}, "stroke 1 of 1: it has 1 distinct point,"),
    "two points": (stroke([[0, 0, 0], [1, 0, 0]]), {}, "it has 2 distinct points, at least 3"),
    "duplicates only": (stroke([[1, 2, 0]] * 40), {}, "it has 1 distinct point,"),
    "two points many times": (stroke([[0, 0, 0], [1, 0, 0]] * 20), {}, "it has 2 distinct points"),
    "straight line": (stroke(np.linspace([0, 0, 0], [1, 2, 3], 30)), {}, "straight line"),
    "there and back again": (stroke([[0, 0, 0], [1, 0, 0], [3, 0, 0], [2, 0, 0]]), {}, "straight line"),
    "figure eight": (stroke(SQUARE[[0, 2, 1, 3]]), {}, "layer 'Lines', stroke 1 of 1: .*(cross|no area)"),
    "crossing, told in the world": (
        stroke([[10, 5, 1], [12, 5, 3], [12, 5, 1], [10, 5, 2]]),
        {},
        "touch at \\(10.6666.., (4.99999.|5.00000.), 1.6666..\\)",
    ),
    "NaN": (stroke(with_point(NAN)), {}, "point 6 of 64 is not a finite number"),
    "infinite": (stroke(with_point(INF)), {}, "point 6 of 64 is not a finite number"),
    "minus infinite": (stroke(with_point(-INF)), {}, "point 6 of 64 is not a finite number"),
    "huge": (stroke(circle(radius=1e30)), {}, "reaches to 1e\\+30, coordinates up to"),
    "huge far point": (stroke(with_point(1e20)), {}, "reaches to 1e\\+20"),
    "tiny": (stroke(circle(radius=1e-30)), {}, "across, at least 1e-06 is needed; scale it up"),
    "denormal": (stroke(circle(radius=1e-42)), {}, "distinct point|across"),
    "zero scale": (zero_scale, {}, "it has 1 distinct point,"),
    "zero scale on one axis": (zero_scale_on_one_axis, {}, "straight line"),
    "narrower than the grid": (stroke(strip()), {"triangles": 60}, "60 triangles are too few to follow"),
    "open with far ends": (
        stroke(circle(turn=3.5, closed=False), cyclic=False),
        {},
        "it is open: its ends are .* apart; make the stroke cyclic or raise Close Gaps from 0.20 to 0.8",
    ),
    "open and gaps not closed": (
        stroke(circle(turn=6.0, closed=False), cyclic=False),
        {"close_gaps": 0.0},
        "it is open",
    ),
    "only closed strokes and there is none": (
        stroke(circle(turn=3.5, closed=False), cyclic=False),
        {"use": "CLOSED"},
        "none of the strokes is selected or closed",
    ),
    "nothing selected": (nothing_selected, {"use": "SELECTED"}, "none of the strokes is selected"),
    "mesh active": (mesh_active, {}, "Select a grease pencil, curve or text object"),
    "nothing in the scene": (nothing_in_the_scene, {}, "Select a grease pencil, curve or text object"),
    "nothing picked": (nothing_picked, {}, "Select a grease pencil, curve or text object"),
    "zero triangles": (stroke(circle()), {"triangles": 0}, "triangles is 0"),
    "negative triangles": (stroke(circle()), {"triangles": -5}, "triangles is -5"),
    "absurdly many triangles": (stroke(circle()), {"triangles": 2_000_000_000}, "triangles|million|e\\+"),
    "zero edge length": (stroke(circle()), {"resolution": "EDGE_LENGTH", "edge_length": 0.0}, "edge"),
    "negative edge length": (stroke(circle()), {"resolution": "EDGE_LENGTH", "edge_length": -1.0}, "edge"),
    "absurdly short edges": (
        stroke(circle()),
        {"resolution": "EDGE_LENGTH", "edge_length": 1e-7},
        "triangles|edge",
    ),
    "NaN edge length": (stroke(circle()), {"resolution": "EDGE_LENGTH", "edge_length": NAN}, "edge"),
    "negative depth": (stroke(circle()), {"depth": -1.0}, "depth is -1"),
    "NaN depth": (stroke(circle()), {"depth": NAN}, "depth is NaN"),
    "negative front depth": (stroke(circle()), {"use_sides": True, "depth_front": -1.0}, "front"),
    "NaN angle": (stroke(circle()), {"angle_mode": "FIXED", "angle": NAN}, "angle is NaN"),
    "negative distance": (stroke(circle()), {"max_distance": -1.0}, "max_distance is -1"),
    "curve without splines": (lambda: curve([]), {}, "'Curve' has no splines"),
    "curve with one point": (lambda: curve([np.zeros((1, 3))]), {}, "'Curve' has no splines of two or more"),
    "straight curve": (lambda: curve([np.linspace([0, 0, 0], [1, 1, 1], 9)]), {}, "straight line"),
    "empty text": (empty_text, {}, "'Text' has no text"),
    "curve made solid by a modifier": (closed_tube, {}, "'Curve'"),
    "no annotations": (stroke(circle()), {"source": "ANNOTATIONS"}, "the scene has no annotations"),
    "empty annotations": (empty_annotations, {"source": "ANNOTATIONS"}, "annotations have no strokes"),
    "objects wanted but only annotations there": (
        empty_annotations,
        {},
        "no object with strokes is selected",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_refused(name):
    make, options, message = CASES[name]
    make()
    bpy.context.view_layer.update()
    before = fingerprint()
    with pytest.raises(RuntimeError, match=f"(?is){message}"):
        bpy.ops.object.gridmesh_from_strokes(**{"triangles": 300, **options})
    assert fingerprint() == before


def test_refusal_is_no_undo_step():
    grease_pencil([circle()])
    bpy.ops.ed.undo_push(message="base")
    bpy.ops.object.gridmesh_from_strokes("EXEC_DEFAULT", True, triangles=300)
    activate(bpy.data.objects["Drawing"])
    with pytest.raises(RuntimeError, match="triangles is -1"):
        bpy.ops.object.gridmesh_from_strokes("EXEC_DEFAULT", True, triangles=-1)
    assert sum(ob.type == "MESH" for ob in bpy.data.objects) == 1
    bpy.ops.ed.undo()
    assert not any(ob.type == "MESH" for ob in bpy.data.objects)


def test_many_bad_strokes_are_counted():
    grease_pencil([circle(2)] * 9)
    with pytest.raises(RuntimeError, match=r"stroke 3 of 9(?s:.*)and 6 more"):
        bpy.ops.object.gridmesh_from_strokes()


def test_selection_unknown_after_modifiers():
    ob = curve([circle()])
    ob.modifiers.new("Array", "ARRAY").count = 3
    bpy.context.view_layer.update()
    before = fingerprint()
    with pytest.raises(RuntimeError, match="Modifiers hide which strokes are selected"):
        bpy.ops.object.gridmesh_from_strokes(use="SELECTED")
    assert fingerprint() == before


def test_failure_while_objects_are_made_leaves_nothing(monkeypatch):
    from addon.data import meshes

    grease_pencil([circle(), at(bean(), 4, 0, 0)])
    before = fingerprint()
    fill, calls = meshes.fill, []

    def failing(mesh, body, angle):
        calls.append(body)
        if len(calls) == 2:
            raise MemoryError
        fill(mesh, body, angle)

    monkeypatch.setattr(meshes, "fill", failing)
    with pytest.raises(RuntimeError, match="MemoryError"):
        bpy.ops.object.gridmesh_from_strokes(triangles=300, collection="NEW")
    assert fingerprint() == before


@pytest.mark.smoke
def test_missing_module(monkeypatch):
    grease_pencil([circle()])
    monkeypatch.setitem(sys.modules, "gridmesh", None)
    before = fingerprint()
    with pytest.raises(RuntimeError, match=r"native module 'gridmesh' is missing; install the GridMesh zip"):
        bpy.ops.object.gridmesh_from_strokes()
    assert fingerprint() == before


@pytest.mark.parametrize("version", ["0.0.9", "0.2.0", "1.0.0", "strange", None])
def test_module_of_another_version(monkeypatch, version):
    grease_pencil([circle()])
    module = types.ModuleType("gridmesh")
    if version is not None:
        module.__version__ = version
    monkeypatch.setitem(sys.modules, "gridmesh", module)
    with pytest.raises(RuntimeError, match=f"needs {api.NATIVE_VERSION}"):
        bpy.ops.object.gridmesh_from_strokes()


@pytest.mark.smoke
def test_register_and_unregister_again():
    addon.unregister()
    assert not hasattr(bpy.types, "VIEW3D_PT_gridmesh")
    addon.unregister()
    addon.register()
    grease_pencil([circle()])
    assert bpy.ops.object.gridmesh_from_strokes(triangles=300) == {"FINISHED"}


def test_register_that_fails_leaves_nothing(monkeypatch):
    addon.unregister()
    monkeypatch.setattr("addon.ui.panels.register", lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        addon.register()
    assert not hasattr(bpy.types, "VIEW3D_PT_gridmesh")
    monkeypatch.undo()
    addon.register()


@pytest.mark.parametrize("follow", [False, True])
def test_a_stroke_that_crosses_itself_becomes_a_body_where_crossings_are_resolved(follow):
    """A loop at the end of a stroke, as hands draw them: nothing measures the thickness of what crosses itself."""
    turn = np.linspace(0, 2 * np.pi, 90)
    points = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    points[-6:, :2] *= 0.9 - 0.04 * np.arange(6)[:, None]
    small = np.linspace(0, 2 * np.pi, 24)
    loop = points[30] + 0.15 * np.stack([np.cos(small) - 1, np.sin(small), 0 * small], axis=1)
    grease_pencil([np.concatenate([points[:30], loop, points[31:]])])
    ob = run_one(use_union=True, follow=follow)
    check_body(ob)
    assert frames.is_linked(ob) == follow


def test_what_was_made_is_removed_where_one_goes_with_another():
    before = fingerprint()

    def fail():
        with Transaction() as transaction:
            first = transaction.new(bpy.data.meshes, "First")
            ob = transaction.new(bpy.data.objects, "Body", first)
            ob.data = transaction.new(bpy.data.meshes, "Second")  # its removal takes the object along
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert fingerprint() == before
    assert not {"First", "Second"} & {mesh.name for mesh in bpy.data.meshes}


@pytest.mark.parametrize("name", ["gridmesh_bridge", "gridmesh_fill", "gridmesh_regrid"])
def test_a_mesh_that_is_edited_and_hidden_is_named_as_the_reason(name):
    """It was told that there are no holes, that nothing is selected, or nothing at all."""
    bpy.ops.mesh.primitive_cylinder_add(end_fill_type="NOTHING")
    ob = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    ob.hide_set(True)
    operator = getattr(bpy.ops.mesh, name)
    assert not operator.poll()
    with pytest.raises(RuntimeError, match="is hidden"):
        operator()
    ob.hide_set(False)
    assert operator.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
