"""Fewer points for the outlines of live bodies."""

import bpy
import numpy as np
import pytest
from drawings import check_body, circle, world_vertices

from addon.draw.trace import pack
from addon.live import engine

pytestmark = pytest.mark.usefixtures("awake")


def draw(points, **options):
    flat = np.asarray(points, float)[:, :2]
    matrix = np.eye(4).ravel().tolist()
    bpy.ops.object.gridmesh_draw(
        stroke=pack(flat, np.ones(len(flat))), matrix=matrix, triangles=600, **options
    )


def count():
    (body,) = engine.bodies()
    return sum(
        len(stroke.points)
        for stroke in body.gridmesh_live.source.data.layers[0].current_frame().drawing.strokes
    )


@pytest.mark.parametrize("select", ["body", "outline"])
def test_an_outline_has_fewer_points_and_its_body_the_same_form(select, capfd):
    draw(circle(400, 2))
    draw(circle(200, 0.5), subtract=True)
    (body,) = engine.bodies()
    engine.settle()
    before, size = count(), np.ptp(world_vertices(body), axis=0)
    if select == "outline":
        body.select_set(False)
        body.gridmesh_live.source.select_set(True)
    assert bpy.ops.object.gridmesh_simplify(tolerance=0.001) == {"FINISHED"}
    engine.settle()
    assert before == 600
    assert 20 < count() < 120
    assert f"600 points before, {count()} now" in capfd.readouterr().out
    check_body(body, genus=1)
    assert np.allclose(np.ptp(world_vertices(body), axis=0), size, atol=0.03)
    assert body.gridmesh_live.problem == ""


def test_what_would_have_no_body_is_left_as_it_is(capfd):
    draw(circle(100, 2))
    (body,) = engine.bodies()
    body.data.vertices[0].co.z += 1
    body.data.update()
    assert bpy.ops.object.gridmesh_simplify() == {"CANCELLED"}
    assert "changed by hand" in capfd.readouterr().out
    assert count() == 100


def test_it_asks_for_a_body():
    assert not bpy.ops.object.gridmesh_simplify.poll()
    draw(circle(100, 2))
    assert bpy.ops.object.gridmesh_simplify.poll()
    bpy.ops.object.select_all(action="DESELECT")
    assert not bpy.ops.object.gridmesh_simplify.poll()
