"""Running the operator again on the same stroke."""

import bpy
import numpy as np
import pytest
from drawings import (
    activate,
    at,
    bean,
    check_body,
    circle,
    fingerprint,
    grease_pencil,
    run,
    run_one,
    vertices,
    world_vertices,
)


def redraw(ob, points):
    drawing = ob.data.layers[0].current_frame().drawing
    drawing.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    drawing.tag_positions_changed()


@pytest.fixture
def drawn():
    ob = grease_pencil([bean()])
    body = run_one()
    activate(ob)
    return ob, body


@pytest.mark.smoke
def test_update_keeps_all_but_the_geometry(drawn):
    _, body = drawn
    body.name = "My Body"
    mesh = body.data
    material = bpy.data.materials.new("Mine")
    mesh.materials.append(material)
    body.modifiers.new("Subdivision", "SUBSURF")
    child = bpy.data.objects.new("Hat", None)
    bpy.context.scene.collection.objects.link(child)
    child.parent = body
    body["note"] = "keep"
    before = body.matrix_world.copy()
    assert run(triangles=1500, update_existing=True) == []
    assert abs(len(mesh.polygons) / 3000 - 1) < 0.1
    check_body(body)
    assert (body.name, body.data) == ("My Body", mesh)
    assert list(mesh.materials) == [material]
    assert [modifier.name for modifier in body.modifiers] == ["Subdivision"]
    assert child.parent == body
    assert body["note"] == "keep"
    assert body.matrix_world == before
    assert bpy.context.view_layer.objects.active == body


def test_pressed_twice_it_updates_and_says_so(drawn, capsys):
    ob, body = drawn
    _add(ob, at(circle(), 5, 0, 0))
    (other,) = run()
    assert "1 body was there already and was updated" in capsys.readouterr().out
    assert np.allclose(np.array(other.matrix_world)[:3, 3], [5, 0, 0], atol=1e-5)
    activate(ob, body, other)
    assert run() == []
    assert "2 bodies were there already and were updated" in capsys.readouterr().out


def test_live_bodies_and_their_outlines_pressed_with_everything_selected(awake):
    ob = grease_pencil([circle(), at(bean(), 4, 0, 0)])
    bodies = run(follow=True)
    before = [world_vertices(body) for body in bodies]
    activate(ob, *bodies)
    assert run() == []
    for body, points in zip(bodies, before, strict=True):
        assert np.allclose(world_vertices(body), points, atol=1e-5)


def test_handwork_is_not_lost_by_an_update(drawn):
    ob, body = drawn
    body.data.vertices[7].co.z += 0.3
    before = vertices(body.data)
    for again in ({}, {"update_existing": True}):
        activate(ob)
        with pytest.raises(RuntimeError, match="changed by hand"):
            bpy.ops.object.gridmesh_from_strokes(triangles=500, **again)
        assert np.array_equal(vertices(body.data), before)
    check_body(run_one(update_existing=False))


def _add(ob, points):
    drawing = ob.data.layers[0].current_frame().drawing
    drawing.add_strokes([len(points)])
    drawing.strokes[-1].cyclic = True
    for point, place in zip(drawing.strokes[-1].points, points, strict=True):
        point.position = place
    drawing.tag_positions_changed()


def test_without_update_a_second_object_is_made(drawn):
    assert run_one(update_existing=False).name == "Drawing.mesh.001"


def test_update_follows_the_stroke(drawn):
    ob, body = drawn
    redraw(ob, at(bean() * [1, 2, 1], 5, 0, 0))
    run(update_existing=True)
    points = at(bean() * [1, 2, 1], 5, 0, 0)
    bounds = [end(world_vertices(body), axis=0)[:2] for end in (np.min, np.max)]
    assert np.allclose(bounds, [end(points, axis=0)[:2] for end in (np.min, np.max)], atol=0.02)
    assert np.allclose(body.dimensions[:2], np.ptp(points, axis=0)[:2], rtol=0.02)


def test_update_keeps_where_the_body_was_put(drawn):
    ob, body = drawn
    body.location.z += 3
    body.rotation_euler.z += 1
    before = body.matrix_world.copy()
    bpy.context.view_layer.update()
    before = body.matrix_world.copy()
    run(triangles=900, update_existing=True)
    assert body.matrix_world == before
    run(triangles=500, update_existing=True)
    activate(ob)
    redraw(ob, at(bean(), 1, 0, 0))
    there = world_vertices(body)
    run(update_existing=True)
    assert body.matrix_world == before
    along = np.array(before)[:3, :3] @ [1, 0, 0]
    assert np.allclose(world_vertices(body).mean(axis=0), there.mean(axis=0) + along, atol=0.01)


def test_update_keeps_flat_shading(drawn):
    _, body = drawn
    body.data.shade_flat()
    run(update_existing=True)
    assert not any(polygon.use_smooth for polygon in body.data.polygons)


def test_update_replaces_edited_geometry_and_keeps_vertex_groups(drawn):
    _, body = drawn
    body.vertex_groups.new(name="Skin").add([0, 1, 2], 1.0, "REPLACE")
    body.data.uv_layers.new(name="Other")
    run(update_existing=True)
    check_body(body)
    assert [group.name for group in body.vertex_groups] == ["Skin"]


def test_update_makes_what_is_missing(drawn):
    ob, body = drawn
    bpy.data.objects.remove(body)
    check_body(run_one(update_existing=True))
    del ob


def test_objects_removed_by_a_script_are_no_trouble(drawn):
    ob, body = drawn
    other = grease_pencil([circle()], name="Other")
    activate(ob, other, body)
    bpy.data.objects.remove(other)
    bpy.data.objects.remove(body)
    check_body(run_one(update_existing=True))


def test_update_ignores_bodies_that_left_the_scene(drawn):
    _, body = drawn
    body.use_fake_user = True
    bpy.context.scene.collection.objects.unlink(body)
    count = len(body.data.polygons)
    check_body(run_one(triangles=900, update_existing=True))
    assert len(body.data.polygons) == count


def test_bodies_of_0_1_0_are_updated_in_place(drawn):
    ob, body = drawn
    place = [value for row in body.matrix_world for value in row]
    body["gridmesh_stroke"] = {"source": "Drawing", "layer": "Lines", "stroke": 0, "matrix": place}
    body.data.property_unset("gridmesh_made")
    body.location.z = 3
    before = vertices(body.data)
    activate(ob)
    assert run() == []
    assert np.allclose(vertices(body.data), before, atol=1e-5)
    assert body.location.z == 3
    assert body["gridmesh_stroke"].get("matrix") is None


def test_update_of_several_strokes_matches_each():
    ob = grease_pencil([circle(), at(bean(), 4, 0, 0)])
    grease_pencil([at(circle(radius=2), 9, 0, 0)], ob=ob, layer="More")
    bodies = run()
    before = [body.dimensions.copy() for body in bodies]
    activate(ob)
    assert run(update_existing=True, triangles=800) == []
    for body, size in zip(bodies, before, strict=True):
        check_body(body)
        assert np.allclose(body.dimensions[:2], size[:2], rtol=0.02)


def test_update_with_foreign_properties(drawn):
    _, body = drawn
    for value in (3, "text", [1.0, 2.0], {"source": "Drawing"}):
        other = bpy.data.objects.new("Other", bpy.data.meshes.new("Other"))
        bpy.context.scene.collection.objects.link(other)
        other["gridmesh_stroke"] = value
    assert run(update_existing=True) == []
    check_body(body)


@pytest.mark.parametrize("obstacle", ["shape keys", "being edited"])
def test_body_that_cannot_be_updated_is_left_alone(drawn, obstacle):
    ob, body = drawn
    if obstacle == "shape keys":
        body.shape_key_add(name="Basis")
    else:
        activate(body)
        bpy.ops.object.mode_set(mode="EDIT")
        activate(ob)
    before = fingerprint()
    with pytest.raises(RuntimeError, match=obstacle):
        bpy.ops.object.gridmesh_from_strokes(triangles=500, update_existing=True)
    assert fingerprint() == before


def test_undo_of_an_update(drawn):
    _, body = drawn
    name, count = body.name, len(body.data.polygons)
    bpy.ops.ed.undo_push(message="base")
    bpy.ops.object.gridmesh_from_strokes("EXEC_DEFAULT", True, triangles=1500, update_existing=True)
    assert len(bpy.data.objects[name].data.polygons) > 2 * count
    bpy.ops.ed.undo()
    assert len(bpy.data.objects[name].data.polygons) == count


def test_shape_of_an_updated_body_is_that_of_a_new_one(drawn):
    ob, body = drawn
    run(triangles=900, update_existing=True)
    activate(ob)
    fresh = run_one(triangles=900, update_existing=False)
    assert np.allclose(world_vertices(fresh), world_vertices(body), atol=1e-5)


class TestBodySelected:
    """The body is what is selected after the first run: an update must work from there."""

    def test_its_stroke_is_found(self):
        ob = grease_pencil([circle(), at(bean(), 4, 0, 0)])
        first, second = run()
        activate(second)
        count = len(first.data.polygons)
        assert run(triangles=1500, update_existing=True) == []
        assert len(first.data.polygons) == count
        assert len(second.data.polygons) > 2 * count
        assert bpy.context.view_layer.objects.active == second
        assert not ob.select_get()

    def test_its_stroke_is_gone(self, drawn):
        ob, body = drawn
        bpy.data.objects.remove(ob)
        activate(body)
        before = fingerprint()
        with pytest.raises(RuntimeError, match=r"'Drawing.mesh': its stroke \(.*\) is gone or hidden"):
            bpy.ops.object.gridmesh_from_strokes(update_existing=True)
        assert fingerprint() == before

    def test_without_update_it_is_no_source(self, drawn):
        _, body = drawn
        activate(body)
        before = fingerprint()
        with pytest.raises(RuntimeError, match="No object with strokes is selected"):
            bpy.ops.object.gridmesh_from_strokes(update_existing=False)
        assert fingerprint() == before
