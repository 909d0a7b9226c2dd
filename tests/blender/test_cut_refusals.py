"""What cannot be cut: the scene stays as it is, and the message says what to do."""

import bmesh
import bpy
import numpy as np
import pytest
from cuts import cut, drawn, line, stroke_object
from drawings import activate, circle, fingerprint
from holes import edit, leave

ACROSS = line((-3, 0, 0.1), (3, 0, 0.3))


def cube():
    bpy.ops.mesh.primitive_cube_add()
    return bpy.context.object


def refused(match, **options):
    """The operator refuses, and nothing changes."""
    bpy.context.view_layer.update()
    before = fingerprint()
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.object.gridmesh_cut(**{"direction": "Y", **options})
    assert fingerprint() == before


def test_needs_an_active_mesh():
    activate(stroke_object(ACROSS))
    with pytest.raises(RuntimeError, match="Make a mesh the active object"):
        bpy.ops.object.gridmesh_cut()


def test_no_stroke():
    activate(cube())
    refused("select a grease pencil or curve object, then the mesh, or draw the cut")


def test_nothing_drawn():
    activate(cube())
    refused("call this operator from a 3D view", source="DRAWN")


@pytest.mark.smoke
def test_stroke_that_misses():
    activate(cube(), stroke_object(line((-3, 0, 2), (3, 0, 2))))
    refused("(?i)stroke")


def test_stroke_along_the_direction():
    activate(cube(), stroke_object(line((0, -3, 0), (0, 3, 0))))
    refused("the stroke is a point; set Direction to another axis")


def test_straight_stroke_has_no_plane():
    activate(cube(), stroke_object(ACROSS))
    refused("set Direction to View or to the axis", direction="PLANE")


def test_stroke_that_crosses_itself():
    t = np.linspace(0, 2 * np.pi, 60)
    eight = np.column_stack([2 * np.sin(t), 0 * t, np.sin(2 * t)])
    activate(cube(), stroke_object(eight))
    refused("cross")


def test_behind_the_eye():
    activate(cube())
    refused(
        "behind the view",
        source="DRAWN",
        direction="VIEW",
        stroke=drawn(ACROSS),
        view_kind="PERSPECTIVE",
        view_eye=(0, 5, 0),
        view_direction=(0, 1, 0),
    )


def test_model_around_the_eye():
    activate(cube())
    refused(
        "(?i)eye|view",
        source="DRAWN",
        direction="VIEW",
        stroke=drawn(line((-3, 2, 0), (3, 2, 0))),
        view_kind="PERSPECTIVE",
        view_eye=(0, 0, 0),
        view_direction=(0, 1, 0),
    )


def test_no_thickness():
    ob = cube()
    ob.scale.z = 0
    activate(ob, stroke_object(ACROSS))
    refused("has no thickness")


def test_no_faces():
    ob = bpy.data.objects.new("Empty", bpy.data.meshes.new("Empty"))
    bpy.context.scene.collection.objects.link(ob)
    activate(ob, stroke_object(ACROSS))
    refused("has no faces to cut")


def test_coordinate_that_is_no_number():
    ob = cube()
    ob.data.vertices[3].co.x = float("nan")
    activate(ob, stroke_object(ACROSS))
    with pytest.raises(RuntimeError, match="Vertex 3 of 'Cube' has a coordinate that is not a finite number"):
        bpy.ops.object.gridmesh_cut(direction="Y")
    assert len(ob.data.vertices) == 8


def test_unknown_material():
    activate(cube(), stroke_object(ACROSS))
    refused("There is no material 'Nix'", use_cap_slot=True, cap_material="Nix")


def test_number_of_no_stroke():
    activate(cube(), stroke_object(ACROSS))
    refused("have 1; lower Stroke", number=2)


def test_mesh_edited_elsewhere():
    ob = cube()
    twin = bpy.data.objects.new("Twin", ob.data)
    bpy.context.scene.collection.objects.link(twin)
    edit(ob)
    activate(twin)
    # Blender keeps the other object's mode; the active one is in Object Mode.
    if bpy.context.mode == "OBJECT":
        stroke = stroke_object(ACROSS)
        activate(twin, stroke)
        with pytest.raises(RuntimeError, match="is being edited in another object"):
            bpy.ops.object.gridmesh_cut(direction="Y")
    activate(ob)
    leave()


def test_refused_in_edit_mode():
    ob = cube()
    stroke = stroke_object(line((-3, 0, 2), (3, 0, 2)))
    activate(ob, stroke)
    edit(ob)
    stroke.select_set(True)
    with pytest.raises(RuntimeError, match=r"(?i)stroke"):
        bpy.ops.object.gridmesh_cut(direction="Y")
    leave()
    assert len(ob.data.vertices) == 8
    assert len(ob.data.polygons) == 6


@pytest.mark.parametrize("editing", [False, True])
def test_failure_half_way_leaves_nothing(editing, monkeypatch):
    """Should writing fail in the middle, the mesh is as before."""
    from addon.cut import cutmesh

    def fails(*_args, **_options):
        raise RuntimeError("on purpose")

    ob = cube()
    stroke = stroke_object(circle(30, 0.5)[:, [0, 2, 1]], cyclic=True)
    activate(ob, stroke)
    if editing:
        edit(ob)
        stroke.select_set(True)
    monkeypatch.setattr(cutmesh.Surgery, "_write_corners", fails)
    n_blocks = len(bpy.data.objects), len(bpy.data.meshes)
    with pytest.raises(RuntimeError, match="on purpose"):
        bpy.ops.object.gridmesh_cut(direction="Y", keep="LEFT")
    assert (len(bpy.data.objects), len(bpy.data.meshes)) == n_blocks
    if editing:
        leave()
    assert (len(ob.data.vertices), len(ob.data.edges), len(ob.data.polygons)) == (8, 12, 6)


def test_open_mesh_is_cut_without_a_cap(capfd):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=4)
    cut(bpy.context.object, line((-3, 0.1, 0), (3, 0.2, 0)), direction="Z")
    assert "ends at the border of the mesh, or at a wall inside it, and has no cap" in capfd.readouterr().out


def test_a_wall_inside_a_mesh_is_told(capfd):
    bpy.ops.mesh.primitive_cube_add()
    ob = bpy.context.object
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    ring = bmesh.ops.bisect_plane(
        bm, geom=[*bm.verts, *bm.edges, *bm.faces], plane_co=(0, 0, 0), plane_no=(1, 0, 0)
    )
    edges = [one for one in ring["geom_cut"] if isinstance(one, bmesh.types.BMEdge)]
    bmesh.ops.contextual_create(bm, geom=edges)
    bm.to_mesh(ob.data)
    bm.free()
    cut(ob, line((-3, 0.1, 0), (3, 0.2, 0)), direction="Z")
    said = capfd.readouterr().out
    assert "1 cut line ends at the border of the mesh, or at a wall inside it, and has no cap" in said
