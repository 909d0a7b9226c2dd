"""Files of GridMesh 0.1.0, whose outlines lay beside their bodies, are brought into shape when they are opened."""

import bpy
import numpy as np
import pytest
from drawings import at, bean, check_body, circle, grease_pencil, run, vertices, world_vertices
from mathutils import Matrix

from addon.data import frames
from addon.live import engine, migration
from addon.live.reading import sketch_of

pytestmark = pytest.mark.usefixtures("awake")


def as_it_was(body, source):
    """Set on a body what 0.1.0 stored: its plane in the world, and no frame."""
    world = body.matrix_world.copy()
    plane = Matrix(np.linalg.inv(frames.frame(body)).tolist())  # the plane, seen from the drawing
    live = body.gridmesh_live
    layer, stroke = live.layer, live.stroke
    body.parent = None
    body.matrix_world = world
    live.frame = [0] * 16
    live.plane = [0] * 12
    live.property_unset("uid")
    body.data.property_unset("gridmesh_made")
    matrix = source.matrix_world @ plane
    body["gridmesh_stroke"] = {
        "source": source.name,
        "layer": layer,
        "stroke": stroke,
        "matrix": [value for row in matrix for value in row],
    }
    # The fingerprint was of the stroke in the world.
    frames.remember(body, np.array(source.matrix_world))
    sketch = sketch_of(body, bpy.context.evaluated_depsgraph_get())
    live.digest = engine.fingerprint(live, sketch)
    live.frame = [0] * 16


def by_tool(where=None):
    """A body and its outline, side by side."""
    source = grease_pencil([2 * bean()], name="Outline", layer="Outline")
    source.matrix_world = where or Matrix.Identity(4)
    bpy.context.view_layer.update()
    (body,) = run(follow=True)
    engine.settle()
    as_it_was(body, source)
    return body, source


def opened(path, *names):
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return [bpy.data.objects.get(name) for name in names]


@pytest.mark.smoke
@pytest.mark.parametrize(
    "where", [Matrix.Identity(4), Matrix.Translation((3, 1, 2)) @ Matrix.Rotation(0.6, 4, "X")]
)
def test_an_outline_becomes_a_part_of_its_body(tmp_path, where, capsys):
    body, source = by_tool(where)
    before, place, name = vertices(body.data), body.matrix_world.copy(), body.name
    lines = source.matrix_world.copy()
    (body,) = opened(tmp_path / "old.blend", name)
    source = body.gridmesh_live.source
    assert vertices(body.data).tobytes() == before.tobytes()
    assert body.matrix_world == place
    assert frames.owned(body) == source
    assert source.hide_render
    assert source.name == f"{name} Outline"
    assert np.allclose(source.matrix_world, lines, atol=1e-5)
    assert "0.1.0: 1" in migration.message
    assert "0.1.0" in capsys.readouterr().out
    assert "gridmesh_stroke" not in body
    bpy.context.view_layer.update()
    assert vertices(body.data).tobytes() == before.tobytes()
    engine.settle()
    assert np.abs(vertices(body.data) - before).max() < 1e-5
    assert body.gridmesh_live.problem == ""
    world = world_vertices(body)
    body.location.x += 2
    bpy.context.view_layer.update()
    engine.settle()
    assert np.abs(world_vertices(body) - world - [2, 0, 0]).max() < 1e-5
    engine.remake(body)
    check_body(body)
    assert np.abs(vertices(body.data) - before).max() < 1e-5


def test_an_outline_that_was_left_behind_comes_back(tmp_path):
    body, _ = by_tool()
    body.location.x += 5
    bpy.context.view_layer.update()
    before, name = world_vertices(body), body.name
    (body,) = opened(tmp_path / "old.blend", name)
    engine.remake(body)
    assert np.abs(world_vertices(body) - before).max() < 1e-5
    assert np.allclose(body.gridmesh_live.source.matrix_world.translation.x, 5, atol=1e-5)


def test_bodies_of_a_drawing_become_its_children(tmp_path):
    source = grease_pencil([bean(), at(circle(), 4, 0, 0)])
    bodies = run(follow=True)
    engine.settle()
    for body in bodies:
        as_it_was(body, source)
    names, before = [body.name for body in bodies], [vertices(body.data) for body in bodies]
    *bodies, source = opened(tmp_path / "old.blend", *names, "Drawing")
    for body, points in zip(bodies, before, strict=True):
        assert body.parent == source
        assert vertices(body.data).tobytes() == points.tobytes()
    there = [world_vertices(body) for body in bodies]
    source.location.z += 1
    bpy.context.view_layer.update()
    engine.settle()
    for body, points in zip(bodies, there, strict=True):
        assert np.abs(world_vertices(body) - points - [0, 0, 1]).max() < 1e-5
        assert body.gridmesh_live.problem == ""


def test_it_is_done_once(tmp_path):
    by_tool()
    opened(tmp_path / "old.blend")
    opened(tmp_path / "new.blend")
    assert migration.message == ""


def test_one_whose_drawing_is_gone(tmp_path):
    body, source = by_tool()
    before, name = world_vertices(body), body.name
    bpy.data.objects.remove(source)
    (body,) = opened(tmp_path / "old.blend", name)
    engine.settle()
    assert np.array_equal(world_vertices(body), before)
    assert "gone" in body.gridmesh_live.problem


def test_a_body_that_was_not_up_to_date_is_made_anew_when_it_is_touched(tmp_path):
    body, _ = by_tool()
    body.gridmesh_live.digest = ""
    before, name = vertices(body.data), body.name
    (body,) = opened(tmp_path / "old.blend", name)
    assert vertices(body.data).tobytes() == before.tobytes()
    assert engine.settle() == 1
    assert np.abs(vertices(body.data) - before).max() < 1e-5
