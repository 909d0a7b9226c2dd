"""Keep Hard Edges: the cut-off corner of a cube becomes a corner again, with its edges marked sharp."""

import bmesh
import bpy
import numpy as np
import pytest
from drawings import activate, vertices
from holes import ball_with_hole, edit, fill, leave, rim, select, without_faces


def cube(gone):
    """A cube from -1 to 1 of 8 by 8 squares a side, without some faces, in Edit Mode with the rim selected."""
    bpy.ops.mesh.primitive_cube_add(size=2)
    ob = bpy.context.object
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bmesh.ops.subdivide_edges(bm, edges=bm.edges[:], cuts=7, use_grid_fill=True)
    bm.to_mesh(ob.data)
    bm.free()
    without_faces(ob, lambda centre: not gone(centre))
    bm = edit(ob)
    select(ob, rim(bm))
    return ob


def corner(centre):
    return min(centre) > 0.3


def sharp(ob):
    """Ends of the edges that are marked sharp."""
    points = vertices(ob.data)
    return [points[list(edge.vertices)] for edge in ob.data.edges if edge.use_edge_sharp]


def volume(ob):
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    found = bm.calc_volume(signed=True)
    bm.free()
    return found


@pytest.mark.parametrize("quads", [False, True])
def test_a_corner_becomes_a_corner(quads):
    ob = cube(corner)
    fill(keep_hard=True, cells="QUADS" if quads else "TRIANGLES")
    leave()
    sizes = [len(polygon.vertices) for polygon in ob.data.polygons if polygon.select]
    assert not quads or sizes.count(3) == sum(sizes) % 2
    assert np.isclose(volume(ob), 8, rtol=1e-6)
    hard = sharp(ob)
    assert len(hard) >= 6
    assert all(((ends > 0.9999).sum(axis=1) >= 2).all() for ends in hard), "they lie on the cube's edges"
    assert (np.abs(vertices(ob.data) - 1).max(axis=1) < 1e-6).any(), "there is a vertex in the corner"


def test_without_it_nothing_is_marked():
    ob = cube(corner)
    fill()
    leave()
    assert not sharp(ob)
    assert volume(ob) < 7.99


def test_an_open_side_is_closed_flat_and_its_rim_marked():
    ob = cube(lambda centre: centre.z > 0.99)
    fill(keep_hard=True)
    leave()
    assert np.isclose(volume(ob), 8, rtol=1e-6)
    assert len(sharp(ob)) == 32
    assert all((ends[:, 2] > 0.9999).all() for ends in sharp(ob))


def test_hard_edges_that_do_not_meet_are_told(capfd):
    """A ball has no hard edge: its marked ones meet in no corner, the patch is the smooth one and the user told."""
    found = []
    for options in ({}, {"keep_hard": True}):
        ob = ball_with_hole()
        bm = edit(ob)
        for edge in bm.edges:
            edge.smooth = False
        select(ob, rim(bm))
        marked = len(bm.edges)
        capfd.readouterr()
        fill(**options)
        told = capfd.readouterr().out
        assert ("1 patch made without hard edges" in told) == bool(options)
        leave()
        found.append(vertices(ob.data).tobytes())
        assert len(sharp(ob)) == marked
    assert found[0] == found[1]


def test_undo_takes_the_marks_back():
    ob = cube(lambda centre: centre.z > 0.99)
    activate(ob)
    bpy.ops.object.mode_set(mode="EDIT")
    name = ob.name
    bpy.ops.ed.undo_push(message="base")
    bpy.ops.mesh.gridmesh_fill("EXEC_DEFAULT", True, keep_hard=True)
    bpy.ops.ed.undo()
    leave()
    assert not sharp(bpy.data.objects[name])
