"""`mesh.gridmesh_bridge` on real loops: geometry, data, undo, refusals."""

from collections import Counter

import bmesh
import bpy
import numpy as np
import pytest
from drawings import activate, fingerprint, vertices
from holes import cylinder, edit, faces_of, leave, rim, select, without_faces


def bridge(**options):
    assert bpy.ops.mesh.gridmesh_bridge(**options) == {"FINISHED"}


def two_pipes(n=16, m=24, height=3.0):
    """Two open cylinders in one mesh, one above the other."""
    lower = cylinder(n, depth=1.0)
    upper = cylinder(m, depth=1.0, location=(0, 0, height))
    upper.select_set(True)
    lower.select_set(True)
    bpy.context.view_layer.objects.active = lower
    bpy.ops.object.join()
    return lower


def facing(bm):
    """Edges of the two rims that face each other."""
    heights = sorted({round(edge.verts[0].co.z, 4) for edge in rim(bm)})
    return [edge for edge in rim(bm) if round(edge.verts[0].co.z, 4) in heights[1:3]]


def is_closed_but_for(ob, rims):
    edges = Counter(
        frozenset(e) for face in faces_of(ob.data) for e in zip(face, face[1:] + face[:1], strict=True)
    )
    assert max(edges.values()) == 2
    return sum(n == 1 for n in edges.values()) == rims


@pytest.mark.smoke
@pytest.mark.parametrize("smooth", ["FLAT", "TANGENT", "CURVATURE"])
@pytest.mark.parametrize(("n", "m"), [(16, 16), (16, 24), (9, 40)])
def test_two_rims_are_joined(n, m, smooth, capfd):
    ob = two_pipes(n, m)
    before, n_faces = vertices(ob.data), len(ob.data.polygons)
    bm = edit(ob)
    select(ob, facing(bm))
    bridge(smooth=smooth)
    bm = bmesh.from_edit_mesh(ob.data)
    bm.faces.index_update()
    assert all(face.select == (face.index >= n_faces) for face in bm.faces)
    leave()
    assert is_closed_but_for(ob, n + m)
    assert np.array_equal(vertices(ob.data)[: len(before)], before)
    told = capfd.readouterr().out
    assert "Joined by " in told
    assert " rows: " in told
    sides = Counter(e for face in faces_of(ob.data) for e in zip(face, face[1:] + face[:1], strict=True))
    assert max(sides.values()) == 1, "wound against a neighbour"


def test_a_single_edge_of_each_rim_is_enough_and_rows_are_kept():
    ob = two_pipes()
    bm = edit(ob)
    edges = facing(bm)
    select(ob, [min(edges, key=lambda e: e.verts[0].co.z), max(edges, key=lambda e: e.verts[0].co.z)])
    bridge(rows=3)
    leave()
    assert is_closed_but_for(ob, 40)


def test_quads():
    ob = two_pipes(16, 16)
    bm = edit(ob)
    select(ob, facing(bm))
    n_faces = len(bm.faces)
    bridge(use_quads=True)
    leave()
    assert any(len(face) == 4 for face in faces_of(ob.data)[n_faces:])


def test_twist_is_of_use():
    places = []
    for twist in (0.0, 0.4):
        ob = two_pipes()
        bm = edit(ob)
        select(ob, facing(bm))
        bridge(twist=twist)
        leave()
        places.append(vertices(ob.data))
    assert not np.allclose(*places)


def test_data_of_both_sides_goes_on():
    ob = two_pipes()
    group = ob.vertex_groups.new(name="up")
    top = [v.index for v in ob.data.vertices if v.co.z > 1.5]
    group.add(top, 1.0, "REPLACE")
    colour = ob.data.color_attributes.new("Colour", "FLOAT_COLOR", "POINT")
    for index, vertex in enumerate(ob.data.vertices):
        colour.data[index].color = (1, 0, 0, 1) if vertex.co.z > 1.5 else (0, 0, 1, 1)
    key = ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Longer")
    for index in top:
        key.data[index].co.z += 2.0
    n = len(ob.data.vertices)
    bm = edit(ob)
    select(ob, facing(bm))
    bridge()
    leave()
    new = ob.data.vertices[n:]
    assert len(new) > 20
    heights = np.array([v.co.z for v in new])
    share = (heights - heights.min()) / np.ptp(heights)
    weights = np.array([next((g.weight for g in v.groups), 0.0) for v in new])
    red = np.array([ob.data.color_attributes["Colour"].data[v.index].color[0] for v in new])
    moved = np.array([ob.data.shape_keys.key_blocks["Longer"].data[v.index].co.z for v in new]) - heights
    for values, most in [(weights, 1), (red, 1), (moved, 2)]:
        assert values.min() >= -1e-6
        assert values.max() <= most + 1e-6
        assert np.corrcoef(share, values)[0, 1] > 0.95


def test_uvs_go_on_on_both_sides():
    ob = two_pipes()
    layer = ob.data.uv_layers.active or ob.data.uv_layers.new()
    for loop in ob.data.loops:
        co = ob.data.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (0.5, co.z)
    n_faces = len(ob.data.polygons)
    bm = edit(ob)
    select(ob, facing(bm))
    bridge()
    leave()
    layer = ob.data.uv_layers.active
    low, high = 0.5, 2.5
    for face in list(ob.data.polygons)[n_faces:]:
        for at in face.loop_indices:
            u, v = layer.data[at].uv
            assert abs(u - 0.5) < 1e-5
            assert low - 1e-4 <= v <= high + 1e-4
            z = ob.data.vertices[ob.data.loops[at].vertex_index].co.z
            assert abs(v - z) < 0.25


def test_two_wires():
    mesh = bpy.data.meshes.new("wires")
    ring = lambda n, z: [(np.cos(6.2832 * k / n), np.sin(6.2832 * k / n), z) for k in range(n)]  # noqa: E731
    edges = [(k, (k + 1) % 8) for k in range(8)] + [(8 + k, 8 + (k + 1) % 11) for k in range(11)]
    mesh.from_pydata(ring(8, 0) + ring(11, 1), edges, [])
    ob = bpy.data.objects.new("wires", mesh)
    bpy.context.scene.collection.objects.link(ob)
    activate(ob)
    edit(ob)
    bpy.ops.mesh.select_all(action="SELECT")
    bridge()
    leave()
    assert is_closed_but_for(ob, 19)


# --------------------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("choose", "words"),
    [
        (lambda bm: [], "select the edges"),
        (lambda bm: rim(bm), "4 loops of open edges selected; select two"),
        (lambda bm: facing(bm)[:1], "1 loop of open edges selected; select two"),
    ],
)
def test_other_selections_are_refused_and_change_nothing(choose, words, capfd):
    ob = two_pipes()
    bm = edit(ob)
    select(ob, choose(bm))
    leave()
    before = fingerprint()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.mesh.gridmesh_bridge()
    leave()
    assert fingerprint() == before


def test_loops_with_a_common_vertex_are_refused():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=6)
    ob = without_faces(bpy.context.object, lambda c: not (abs(c.x - c.y) < 0.1 and abs(c.x + 0.5) < 0.6))
    edit(ob)
    bm = bmesh.from_edit_mesh(ob.data)
    inner = [e for e in rim(bm) if all(abs(v.co.x) < 2.9 and abs(v.co.y) < 2.9 for v in e.verts)]
    select(ob, inner)
    with pytest.raises(RuntimeError):
        bpy.ops.mesh.gridmesh_bridge()
    leave()
