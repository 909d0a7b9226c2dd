"""Parts that a line does not cross, caps that cannot bulge, and too many edges: what is done, and what is told."""

import bpy
import numpy as np
import pytest
from cuts import cut, drawn, line
from drawings import activate, circle, mesh_objects


def test_parts_on_the_side_that_goes_are_removed():
    balls = []
    for place in ((0, 0, 0), (4, 0, 3), (4, 0, -3)):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8, location=place)
        balls.append(bpy.context.object)
    activate(*balls)
    bpy.ops.object.join()
    ob = bpy.context.object
    activate(ob)
    options = {"stroke": drawn(line((-1, 0, 0.1), (1, 0, 0.1))), "source": "DRAWN", "direction": "Y"}
    assert bpy.ops.object.gridmesh_cut(keep="LEFT", **options) == {"FINISHED"}
    heights = np.array([(ob.matrix_world @ vertex.co).z for vertex in ob.data.vertices])
    assert heights.min() > 0.0
    assert heights.max() > 3.0
    assert len(mesh_objects()) == 1


def test_caps_around_a_closed_line_tell_that_they_are_flat(capfd):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12)
    ob = bpy.context.object
    ring = np.array([(0.4 * x, -3.0, 0.4 * y) for x, y, *_ in circle(30, 1.0)])
    cut(ob, ring, cyclic=True, keep="RIGHT", smooth="TANGENT", edge_length=0.1)
    assert "lies flat, since it has holes, goes around a closed stroke" in capfd.readouterr().out


def test_edges_of_the_cut_are_what_is_too_many():
    bpy.ops.mesh.primitive_cube_add()
    activate(bpy.context.object)
    options = {"stroke": drawn(line((-3, 0, 0.1), (3, 0, 0.3))), "source": "DRAWN", "direction": "Y"}
    with pytest.raises(RuntimeError, match=r"about \d+ edges along its lines; at most 20000"):
        bpy.ops.object.gridmesh_cut(edge_length=1e-5, **options)
