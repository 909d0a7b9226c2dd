"""Flat meshes follow bones: `object.gridmesh_bone_weights`, and weights that an update keeps."""

import itertools

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector
from test_pictures import SIZE, arrays, disk, drawing, empty, picture, run, select, write

from addon.pictures import weights


def hand():
    """Two fingers, a gap between them narrower than they are."""
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    kept = (
        (y > 8)
        & (y < 56)
        & (((x > 10) & (x < 30)) | ((x > 34) & (x < 54)) | ((x > 10) & (x < 54) & (y < 20)))
    )
    return drawing(kept.astype(float))


def sprite(tmp_path, values=None):
    source = empty(picture(tmp_path, hand() if values is None else values))
    return run(shape="SHEET", triangles=500, margin=0.0), source


def at(ob, x, y):
    """Place of a pixel in the world, on an image empty two units wide."""
    return ob.matrix_world @ Vector(((x - 48) / 48, (y - 32) / 48, 0))


def armature(ob, bones):
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    rig.location = (0.3, 0.1, 0)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, head, tail in bones:
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = (rig.matrix_world.inverted() @ at(ob, *place) for place in (head, tail))
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


BONES = [("palm", (32, 9), (32, 19)), ("left", (20, 20), (20, 55)), ("right", (44, 20), (44, 55))]


def choose(*objects):
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob in objects)
    bpy.context.view_layer.objects.active = objects[-1]


@pytest.mark.smoke
def test_fingers_follow_their_own_bones(tmp_path):
    ob, _ = sprite(tmp_path)
    rig = armature(ob, BONES)
    before = [v.co.copy() for v in ob.data.vertices]
    where = ob.matrix_world.copy()
    choose(ob, rig)
    assert bpy.ops.object.gridmesh_bone_weights() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert np.allclose(ob.matrix_world, where, atol=1e-6)
    assert [v.co for v in ob.data.vertices] == before
    names, found = weights.read(ob)
    assert names == ["palm", "left", "right"]
    assert np.abs(found.sum(axis=1) - 1).max() < 1e-6
    assert ((found > 0).sum(axis=1) <= 4).all()
    co, uv, corner = arrays(ob.data)
    place = np.zeros((len(co), 2))
    place[corner] = uv * SIZE
    left, right = (place[:, 0] < 30) & (place[:, 1] > 40), (place[:, 0] > 34) & (place[:, 1] > 40)
    assert found[left, 1].min() > 0.9
    assert found[right, 2].min() > 0.9
    assert found[left, 2].max() < 0.02

    rig.pose.bones["left"].matrix = (
        Matrix.Translation((0, 0, 0)) @ rig.pose.bones["left"].matrix @ Matrix.Rotation(0.5, 4, "Z")
    )
    bpy.context.view_layer.update()
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    moved = np.array([v.co for v in evaluated.data.vertices])
    assert np.linalg.norm((moved - co)[left], axis=1).max() > 0.1
    assert np.linalg.norm((moved - co)[right], axis=1).max() < 0.02

    # Again, with another reach: the groups are replaced, nothing is added.
    choose(ob, rig)
    assert bpy.ops.object.gridmesh_bone_weights(reach=2.0, most=1) == {"FINISHED"}
    names, found = weights.read(ob)
    assert names == ["palm", "left", "right"]
    assert ((found > 0).sum(axis=1) == 1).all()
    assert len(ob.modifiers) == 1


def test_other_groups_and_the_parent_stay(tmp_path):
    ob, _ = sprite(tmp_path)
    ob.vertex_groups.new(name="Pinned").add([0, 1], 0.5, "REPLACE")
    holder = bpy.data.objects.new("Holder", None)
    bpy.context.scene.collection.objects.link(holder)
    ob.parent = holder
    rig = armature(ob, BONES)
    choose(ob, rig)
    assert bpy.ops.object.gridmesh_bone_weights() == {"FINISHED"}
    names, found = weights.read(ob)
    assert names[0] == "Pinned"
    assert found[:2, 0].tolist() == [0.5, 0.5]
    assert ob.parent == holder
    # The armature need not be selected once the mesh follows it.
    choose(ob)
    assert bpy.ops.object.gridmesh_bone_weights() == {"FINISHED"}


def test_what_is_not_flat_is_refused(tmp_path):
    empty(picture(tmp_path, hand()))
    body = run(shape="BODY", triangles=300)
    rig = armature(body, BONES)
    choose(body, rig)
    with pytest.raises(RuntimeError, match="not flat"):
        bpy.ops.object.gridmesh_bone_weights()
    assert not body.vertex_groups
    for bone in rig.data.bones:
        bone.use_deform = False
    with pytest.raises(RuntimeError, match="no bones that deform"):
        bpy.ops.object.gridmesh_bone_weights()
    select(body)
    assert not bpy.ops.object.gridmesh_bone_weights.poll()


@pytest.mark.parametrize("shape", ["SHEET", "BODY"])
def test_an_update_keeps_weights_at_their_places(tmp_path, shape):
    empty(picture(tmp_path, drawing(disk(20, (40, 30)))))
    ob = run(shape=shape, triangles=300)
    co, _, _ = arrays(ob.data)
    low, wide = co[:, 0].min(), np.ptp(co[:, 0])
    share = (co[:, 0] - low) / wide
    behind = co[:, 2] < -1e-4
    weights.put(ob, ["left", "right"], np.column_stack([1 - share, share]))
    weights.put(ob, ["behind"], behind[:, None].astype(float))
    other = bpy.data.images.new("other", *SIZE, alpha=True)
    write(other, drawing(disk(18, (40, 31))), tmp_path / "figure.png")
    select(ob)
    assert bpy.ops.object.gridmesh_update_image() == {"FINISHED"}
    names, found = weights.read(ob)
    assert names == ["left", "right", "behind"]
    co, _, _ = arrays(ob.data)
    assert found[:, :2].sum(axis=1) == pytest.approx(np.ones(len(co)), abs=1e-6)
    assert found[:, 1] == pytest.approx((co[:, 0] - low) / wide, abs=0.02)
    if shape == "BODY":
        assert found[co[:, 2] > 0.05, 2].max() == 0
        assert found[co[:, 2] < -0.05, 2].min() == 1


def test_files_that_are_dropped_lie_side_by_side(tmp_path):
    for name, at_x in (("a.png", 40), ("b.png", 50), ("c.png", 30)):
        picture(tmp_path, drawing(disk(20, (at_x, 30))), name)
    (tmp_path / "d.png").write_bytes(b"no picture")
    names = [{"name": f"{name}.png"} for name in "abcd"]
    run(directory=str(tmp_path), files=names, shape="SHEET")
    made = bpy.context.selected_objects
    assert sorted(ob.name for ob in made) == ["a", "b", "c"]
    spans = sorted((min(p[0] for p in ob.bound_box), max(p[0] for p in ob.bound_box)) for ob in made)
    assert all(one[1] < other[0] for one, other in itertools.pairwise(spans))


def test_pictures_can_be_dropped_where_objects_are():
    handler = bpy.types.OBJECT_FH_gridmesh_picture
    assert handler.bl_import_operator == "object.gridmesh_from_image"
    assert {".png", ".webp", ".jpg"} <= set(handler.bl_file_extensions.split(";"))

    class Area:
        type = "VIEW_3D"

    class Context:
        mode, area = "OBJECT", Area()

    assert handler.poll_drop(Context)
    Context.mode = "EDIT_MESH"
    assert not handler.poll_drop(Context)
    Context.mode, Area.type = "OBJECT", "IMAGE_EDITOR"
    assert not handler.poll_drop(Context)
