"""Curve, text and hair objects and annotations as sources."""

import bpy
import numpy as np
import pytest
from drawings import (
    activate,
    at,
    bean,
    bezier_circle,
    check_body,
    circle,
    curve,
    fingerprint,
    linked,
    run,
    run_one,
    vertices,
    world_vertices,
)

from addon.bodies import sampling


@pytest.mark.smoke
def test_bezier_curve():
    ob = bezier_circle()
    ob.location = (1, 2, 3)
    bpy.context.view_layer.update()
    body = run_one()
    check_body(body)
    assert body.name == "Curve.mesh"
    assert np.allclose(body.location, (1, 2, 3), atol=1e-5)


@pytest.mark.parametrize("dimensions", ["2D", "3D"])
@pytest.mark.parametrize("thick", ["bevel", "extrude", "both", "offset"])
def test_bevel_extrusion_and_fill_are_left_out(dimensions, thick):
    plain = vertices(check(run_one_of(bezier_circle())).data)
    ob = bezier_circle(dimensions=dimensions)
    ob.data.bevel_depth = 0.1 if thick in {"bevel", "both"} else 0.0
    ob.data.extrude = 0.2 if thick in {"extrude", "both"} else 0.0
    ob.data.offset = 0.3 if thick == "offset" else 0.0
    assert np.array_equal(vertices(run_one_of(ob).data), plain)


def check(body):
    check_body(body)
    return body


def run_one_of(ob):
    activate(ob)
    return run_one()


def test_bevel_object():
    ob = curve([bean()])
    profile = bezier_circle(name="Profile", radius=0.1)
    ob.data.bevel_mode, ob.data.bevel_object = "OBJECT", profile
    check(run_one_of(ob))


def test_each_spline_is_a_stroke_with_its_material():
    ob = curve([circle(), at(circle(), 4, 0, 0)])
    for name in ("Red", "Blue"):
        ob.data.materials.append(bpy.data.materials.new(name))
    ob.data.splines[1].material_index = 1
    assert [body.data.materials[0].name for body in run()] == ["Red", "Blue"]


def test_selected_spline():
    ob = curve([circle(), at(circle(), 4, 0, 0)])
    for point in (*ob.data.splines[0].points, *ob.data.splines[1].points):
        point.select = False
    ob.data.splines[1].points[3].select = True
    assert run_one(use="SELECTED")["gridmesh_stroke"]["stroke"] == 1


def test_curve_in_edit_mode_is_read_as_edited():
    ob = curve([circle()])
    bpy.ops.object.mode_set(mode="EDIT")
    for point in ob.data.splines[0].points:
        point.co.x += 10
    body = run_one()
    assert np.isclose(body.location.x, 10, atol=1e-4)
    assert bpy.context.mode == "EDIT_CURVE"


def test_several_curves_in_edit_mode():
    first, second = curve([circle()], name="First"), curve([at(circle(), 4, 0, 0)], name="Second")
    activate(first, second)
    bpy.ops.object.mode_set(mode="EDIT")
    assert sorted(body.name for body in run()) == ["First.mesh", "Second.mesh"]


def test_modifier_on_a_curve():
    ob = bezier_circle()
    ob.data.extrude = 0.1
    modifier = ob.modifiers.new("Cast", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis, modifier.factor = "STRETCH", "X", 1.0
    body = run_one()
    check_body(body)
    assert body.dimensions.x > 2.9


def test_shape_key_on_a_curve():
    ob = curve([circle()])
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Wide")
    for point in key.data:
        point.co.x *= 3
    key.value = 1.0
    bpy.context.view_layer.update()
    assert np.isclose(run_one().dimensions.x, 6, rtol=0.02)


@pytest.mark.parametrize("modified", [False, True])
def test_nothing_is_left_behind(modified):
    ob = bezier_circle()
    ob.data.bevel_depth = 0.1
    if modified:
        ob.shape_key_add(name="Basis")
        ob.modifiers.new("Smooth", "SMOOTH")
    bpy.context.view_layer.update()
    before = fingerprint()
    body = run_one()
    mesh = body.data
    bpy.data.objects.remove(body)
    bpy.data.meshes.remove(mesh)
    activate(ob)
    assert fingerprint() == before


def test_nearly_closed_curve():
    curve([circle(60, turn=6.0, closed=False)], cyclic=False)
    check_body(run_one())


@pytest.mark.parametrize("thickness", [0.0, 0.1])
def test_text(thickness):
    data = bpy.data.curves.new("Text", "FONT")
    data.body = "LI"
    data.extrude = thickness
    linked("Text", data)
    bodies = run(triangles=300)
    assert len(bodies) == 2
    for body in bodies:
        check_body(body)


@pytest.mark.parametrize("order", [3, 4, 5])
def test_nurbs_are_sampled_as_blender_does(order):
    points = bean(11)
    ob = curve([points])
    (spline,) = ob.data.splines
    spline.type, spline.order_u, spline.resolution_u = "NURBS", order, 64
    mesh = ob.to_mesh()
    drawn = vertices(mesh)
    ours = sampling.nurbs(points, np.ones(11), True, order, 0, 64)
    apart = np.linalg.norm(ours[:, None] - drawn[None], axis=2)
    step = np.linalg.norm(np.diff(drawn, axis=0), axis=1).max()
    assert apart.min(axis=0).max() < step
    assert apart.min(axis=1).max() < step


def test_hair_curves():
    data = bpy.data.hair_curves.new("Hair")
    data.add_curves([60, 80])
    points = np.concatenate([circle(60), at(bean(80), 4, 0, 0)]).astype(np.float32)
    data.attributes["position"].data.foreach_set("vector", points.ravel())
    attribute = data.attributes.new("cyclic", "BOOLEAN", "CURVE")
    attribute.data.foreach_set("value", np.ones(2, bool))
    data.set_types(type="POLY")
    linked("Hair", data)
    for body in run():
        check_body(body)


def annotate(strokes):
    if hasattr(bpy.context.scene, "annotation"):
        data = bpy.context.scene.annotation = bpy.data.annotations.new("Notes")
    else:
        data = bpy.context.scene.grease_pencil = bpy.data.grease_pencils.new("Notes")
    frame = data.layers.new("Note").frames.new(1)
    if not hasattr(frame.strokes, "new"):
        pytest.skip("this version cannot make annotation strokes from Python")
    for points in strokes:
        stroke = frame.strokes.new()
        stroke.points.add(len(points))
        stroke.points.foreach_set("co", points.astype(np.float32).ravel())


def test_annotations():
    annotate([at(circle(60, turn=6.1, closed=False), 0, 0, 2)])
    body = run_one(source="ANNOTATIONS")
    check_body(body)
    assert body.name == "Notes.mesh"
    assert np.isclose(world_vertices(body)[:, 2].mean(), 2, atol=1e-3)
