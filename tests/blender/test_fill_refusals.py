"""Bad selections and bad meshes: nothing changes but the selection, which shows what is wrong."""

import sys
import types

import bmesh
import bpy
import numpy as np
import pytest
from drawings import activate, grease_pencil, linked, vertices
from holes import Before, ball_with_hole, cylinder, edit, faces_of, fill, grid, leave, rim, select, suzanne

from addon import api
from addon.fill import editmesh
from addon.ui import progress


def mesh(points, edges=(), faces=(), name="Mesh"):
    data = bpy.data.meshes.new(name)
    data.from_pydata(np.asarray(points, float).tolist(), list(edges), list(faces))
    return linked(name, data)


def circle(n, middle=(0, 0, 0)):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.stack([np.cos(t), np.sin(t), 0 * t], axis=1) + middle


def cycle(first, n):
    return [(first + k, first + (k + 1) % n) for k in range(n)]


def all_selected(ob, mode="EDGE"):
    bm = edit(ob, mode=mode)
    select(ob, bm.verts if mode == "VERT" else bm.edges)
    return ob


def nothing():
    ob = cylinder()
    edit(ob)
    return ob


def open_chain():
    return all_selected(mesh(circle(12), cycle(0, 12)[:-1]))


def branch():
    return all_selected(mesh([*circle(12), (3, 0, 0)], [*cycle(0, 12), (0, 12)]))


def figure_eight():
    points = [*circle(8), *circle(8, (2, 0, 0))[np.r_[5:8, 0:4]]]
    return all_selected(mesh(points, [*cycle(0, 8), (0, 8), *[(k, k + 1) for k in range(8, 14)], (14, 0)]))


def touches_itself():
    points = [(0, 0, 0), (1, 1, 0), (-1, 1, 0), (1, -1, 0), (-1, -1, 0), (2, 2, 0), (0, 2.5, 0)]
    edges = [(0, 1), (1, 2), (2, 0), (0, 3), (3, 4), (4, 0), (1, 5), (5, 6), (6, 1)]
    return all_selected(mesh(points, edges))


def faces_on_both_sides():
    ob = grid(6)
    bm = edit(ob)
    select(ob, [e for e in bm.edges if max(abs(c) for v in e.verts for c in v.co) < 1.1 and not on_axis(e)])
    return ob


def on_axis(edge):
    return any(max(abs(vertex.co.x), abs(vertex.co.y)) < 0.5 for vertex in edge.verts)


def vertex_inside():
    ob = grid(6)
    bm = edit(ob, mode="VERT")
    select(ob, [vertex for vertex in bm.verts if vertex.co.length < 0.1])
    return ob


def not_a_number():
    ob = cylinder()
    ob.data.vertices[4].co.x = float("nan")
    bm = edit(ob)
    select(ob, [edge for edge in rim(bm) if any(v.index == 4 for v in edge.verts)])
    return ob


def infinite():
    ob = cylinder()
    ob.data.vertices[4].co.x = float("inf")
    bm = edit(ob)
    select(ob, [edge for edge in rim(bm) if any(v.index == 4 for v in edge.verts)])
    return ob


def no_length():
    ob = cylinder()
    ob.data.vertices[4].co = ob.data.vertices[6].co
    bm = edit(ob, mode="VERT")
    select(ob, [bm.verts[4]])
    return ob


def all_in_one_point():
    ob = mesh([(1, 2, 3)] * 6, cycle(0, 6))
    return all_selected(ob)


def zero_scale():
    ob = cylinder()
    ob.scale = (1, 1, 0)
    bpy.context.view_layer.update()
    return all_selected(ob)


def hidden_in_part():
    ob = cylinder()
    bm = edit(ob)
    edges = rim(bm)
    edges[0].link_faces[0].hide_set(True)
    bmesh.update_edit_mesh(ob.data)
    same = [edge for edge in edges if not edge.hide and edge.verts[0].co.z * edges[0].verts[0].co.z > 0]
    select(ob, same[:1])
    return ob


def single_wire():
    return all_selected(mesh([(0, 0, 0), (1, 0, 0)], [(0, 1)]))


def lone_point():
    return all_selected(mesh([(0, 0, 0)]), "VERT")


def empty_mesh():
    ob = mesh([])
    activate(ob)
    bpy.ops.object.mode_set(mode="EDIT")
    return ob


def closed_mesh():
    bpy.ops.mesh.primitive_ico_sphere_add()
    return all_selected(bpy.context.object)


def closed_cube():
    bpy.ops.mesh.primitive_cube_add()
    return all_selected(bpy.context.object, "VERT")


CASES = {
    # name: (scene, options, message, vertices selected afterwards or None)
    "nothing selected": (nothing, {}, "nothing is selected; select the edges around a hole", None),
    "open chain": (open_chain, {}, "they end at vertices 0 and 11; select the missing edges", 12),
    "branch": (branch, {}, "the selected edges branch at vertex 0; deselect", 13),
    "figure eight": (figure_eight, {}, "figure eight that meets itself at vertex 0", 15),
    "touches itself": (touches_itself, {}, "touches itself at vertices 0, 1", 7),
    "faces on both sides": (faces_on_both_sides, {}, "has faces on both sides", 8),
    "vertex inside": (vertex_inside, {}, "vertex 24 lies on no hole; select a vertex or an edge of one", 1),
    "NaN": (not_a_number, {}, "vertex 4 has a coordinate that is not a finite number", 3),
    "infinite": (infinite, {}, "vertex 4 is 3.4e\\+38 away, up to 1e\\+09 is supported", 3),
    "edge without length": (no_length, {}, "the edge between vertices 4 and 6 has no length; merge", 2),
    "all in one point": (all_in_one_point, {}, "has no length; merge the vertices", 2),
    "zero scale": (zero_scale, {}, "'Cylinder'.*no thickness, since a scale of it is zero", None),
    "hidden in part": (hidden_in_part, {}, "the hole of 16 edges is hidden in part; reveal it first", None),
    "single edge": (single_wire, {}, "end at vertices 0 and 1; .* select at least three edges", 2),
    "single edge closed": (single_wire, {"close_chains": True}, "select at least three edges", 2),
    "lone point": (lone_point, {}, "vertex 0 lies on no hole", 1),
    "empty mesh": (empty_mesh, {}, "nothing is selected", None),
    "closed mesh": (
        closed_mesh,
        {},
        "^Error: What is selected has no open edges; select an edge or a vertex",
        42,
    ),
    "closed cube": (closed_cube, {}, "^Error: What is selected has no open edges", 8),
}


def geometry(ob):
    leave()
    data = ob.data
    state = vertices(data).tobytes(), faces_of(data), sorted(tuple(edge.vertices) for edge in data.edges)
    chosen = sum(vertex.select for vertex in data.vertices)
    bpy.ops.object.mode_set(mode="EDIT")
    return state, chosen


@pytest.mark.parametrize("name", CASES)
def test_refused(name):
    make, options, message, chosen = CASES[name]
    ob = make()
    before, selected = geometry(ob)
    with pytest.raises(RuntimeError, match=f"(?is){message}"):
        bpy.ops.mesh.gridmesh_fill(**options)
    after, culprits = geometry(ob)
    assert after == before
    assert bpy.context.mode == "EDIT_MESH"
    if chosen is not None:
        assert culprits == chosen
    elif name == "nothing selected":
        assert culprits == selected


def test_not_in_edit_mode():
    cylinder()
    with pytest.raises(RuntimeError, match="Edit a mesh and select the edges of a hole"):
        bpy.ops.mesh.gridmesh_fill()
    grease_pencil([np.zeros((4, 3))])
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Edit a mesh"):
        bpy.ops.mesh.gridmesh_fill()


def test_no_holes_at_all(capfd):
    bpy.ops.mesh.primitive_cube_add()
    edit(bpy.context.object)
    assert bpy.ops.mesh.gridmesh_fill(holes="ALL") == {"CANCELLED"}
    assert "There are no holes" in capfd.readouterr().out


def test_only_larger_holes(capfd):
    edit(cylinder(32))
    assert bpy.ops.mesh.gridmesh_fill(holes="ALL", max_edges=20) == {"CANCELLED"}
    assert "2 holes with more than 20 edges left open; raise Max Edges" in capfd.readouterr().out


def test_good_holes_are_filled_and_bad_selections_named(capfd):
    ob = cylinder(16)
    ob.data.vertices.add(3)
    ob.data.edges.add(2)
    n = len(ob.data.vertices)
    for k, place in enumerate([(5, 0, 0), (6, 0, 0), (6, 1, 0)]):
        ob.data.vertices[n - 3 + k].co = place
    for k, edge in enumerate(list(ob.data.edges)[-2:]):
        edge.vertices = (n - 3 + k, n - 2 + k)
    bm = edit(ob)
    select(ob, [edge for edge in bm.edges if edge.is_boundary or edge.is_wire])
    fill()
    told = capfd.readouterr().out
    assert "Filled 2 holes" in told
    assert (
        f"1 selection left out:\nThe selected edges do not close: they end at vertices {n - 3} and {n - 1}"
        in told
    )


def test_culprits_of_several_meshes_have_names():
    first, second = mesh(circle(12), cycle(0, 12)[:-1], name="First"), cylinder()
    activate(first, second)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bm = bmesh.from_edit_mesh(first.data)
    select(first, bm.edges)
    with pytest.raises(RuntimeError, match="'First': the selected edges do not close"):
        bpy.ops.mesh.gridmesh_fill()


def test_refusal_is_no_undo_step():
    ob = cylinder(16)
    bm = edit(ob)
    select(ob, rim(bm))
    name, count = ob.name, len(ob.data.vertices)
    bpy.ops.ed.undo_push(message="base")
    bpy.ops.mesh.gridmesh_fill("EXEC_DEFAULT", True)
    bpy.ops.mesh.select_all(action="DESELECT")
    with pytest.raises(RuntimeError, match="Nothing is selected"):
        bpy.ops.mesh.gridmesh_fill("EXEC_DEFAULT", True)
    bpy.ops.ed.undo()
    leave()
    assert len(bpy.data.objects[name].data.vertices) == count


def test_failure_on_the_way_leaves_nothing(monkeypatch):
    """In the second of two meshes, after patches are in both."""
    meshes = suzanne(), ball_with_hole()
    befores = [Before(ob) for ob in meshes]
    activate(*meshes)
    bpy.ops.object.mode_set(mode="EDIT")
    write, calls = editmesh.attributes.Surroundings.write, []

    def failing(self, *args):
        calls.append(self)
        if len(calls) == 5:
            raise MemoryError
        write(self, *args)

    monkeypatch.setattr(editmesh.attributes.Surroundings, "write", failing)
    with pytest.raises(RuntimeError, match="MemoryError"):
        bpy.ops.mesh.gridmesh_fill(holes="ALL", max_edges=0)
    leave()
    assert len(calls) == 5
    for ob, before in zip(meshes, befores, strict=True):
        assert np.array_equal(vertices(ob.data), before.points)
        assert faces_of(ob.data) == before.faces
        assert {frozenset(edge.vertices) for edge in ob.data.edges} == before.edges


class TestStopping:
    def test_cancelled_work_changes_nothing(self, monkeypatch, capfd):
        ob = ball_with_hole()
        edit(ob)
        before = geometry(ob)
        monkeypatch.setattr(progress.Pointer, "__call__", lambda self, fraction: False)
        assert bpy.ops.mesh.gridmesh_fill(holes="ALL") == {"CANCELLED"}
        assert geometry(ob) == before
        assert "Cancelled; nothing was filled" in capfd.readouterr().out

    def test_ctrl_c_changes_nothing(self, monkeypatch):
        ob = ball_with_hole()
        edit(ob)
        before = geometry(ob)

        def interrupted(self, fraction):
            raise KeyboardInterrupt

        monkeypatch.setattr(progress.Pointer, "__call__", interrupted)
        assert bpy.ops.mesh.gridmesh_fill(holes="ALL") == {"CANCELLED"}
        assert geometry(ob) == before


def test_module_without_fills(monkeypatch):
    edit(cylinder())
    module = types.ModuleType("gridmesh")
    module.__version__ = api.NATIVE_VERSION
    monkeypatch.setitem(sys.modules, "gridmesh", module)
    with pytest.raises(RuntimeError, match="unfinished build without 'fill_holes'"):
        bpy.ops.mesh.gridmesh_fill(holes="ALL")
