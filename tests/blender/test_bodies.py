"""What the operator makes of good strokes."""

import bpy
import gridmesh
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
    mesh_objects,
    on_plane,
    run,
    run_one,
    triangles,
    uv_of,
    vertices,
    world_vertices,
)
from mathutils import Euler, Matrix


def bounds_middle(points):
    return (points.min(axis=0) + points.max(axis=0)) / 2


@pytest.mark.smoke
def test_body_is_the_one_of_the_module():
    points = bean().astype(np.float32).astype(float)
    grease_pencil([points])
    ob = run_one(triangles=700, depth=0.8)
    check_body(ob)
    flat = points[:, :2] - bounds_middle(points[:, :2])
    surface = gridmesh.inflate(gridmesh.mesh_sketch(flat, triangles=700), depth=0.8)
    assert np.array_equal(triangles(ob.data), surface.triangles)
    assert np.allclose(vertices(ob.data), surface.vertices, rtol=0, atol=1e-6)
    assert np.allclose(uv_of(ob), surface.uv, rtol=0, atol=1e-6)


@pytest.mark.smoke
def test_several_strokes_give_several_bodies(capfd):
    grease_pencil([circle(), at(bean(), 4, 0, 0)])
    bodies = run()
    assert [ob.name for ob in bodies] == ["Drawing.mesh", "Drawing.mesh.001"]
    for ob in bodies:
        check_body(ob)
    total = sum(len(ob.data.polygons) for ob in bodies)
    assert f"2 bodies: {total} triangles, " in capfd.readouterr().out


@pytest.mark.smoke
def test_conventions_of_a_new_object():
    ob = grease_pencil([at(bean() * [2, 1, 1], 5, -3, 0)])
    home = bpy.data.collections.new("Home")
    bpy.context.scene.collection.children.link(home)
    home.objects.link(ob)
    bpy.context.scene.collection.objects.unlink(ob)
    body = run_one()
    assert body.name == "Drawing.mesh"
    assert list(body.users_collection) == [home]
    assert bpy.context.view_layer.objects.active == body
    assert list(bpy.context.view_layer.objects.selected) == [body]
    assert body.parent is None
    assert body.scale[:] == (1, 1, 1)
    assert not body.data.materials
    assert np.allclose(bounds_middle(vertices(body.data))[:2], 0, atol=0.01)
    drawn = at(bean() * [2, 1, 1], 5, -3, 0)
    assert np.allclose(body.location, bounds_middle(drawn), atol=1e-6)


def test_source_is_untouched():
    grease_pencil([bean()])
    blocks, _ = fingerprint()
    run_one()
    after, _ = fingerprint()
    collection = "grease_pencils_v3" if "grease_pencils_v3" in blocks else "grease_pencils"
    assert after[collection] == blocks[collection]
    assert [block for block in after["objects"] if block[0] == "Drawing"] == blocks["objects"]


@pytest.mark.smoke
def test_one_undo_step():
    grease_pencil([circle()])
    bpy.ops.ed.undo_push(message="base")
    before = len(bpy.data.objects), len(bpy.data.meshes)
    bpy.ops.object.gridmesh_from_strokes("EXEC_DEFAULT", True, triangles=300)
    assert (len(bpy.data.objects), len(bpy.data.meshes)) == (before[0] + 1, before[1] + 1)
    bpy.ops.ed.undo()
    assert (len(bpy.data.objects), len(bpy.data.meshes)) == before
    bpy.ops.ed.redo()
    check_body(mesh_objects()[0])


PLANES = {
    "top": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "bottom": ((1, 0, 0), (0, -1, 0), (0, 0, 1)),
    "front": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "back": ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "right": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    "left": ((0, -1, 0), (0, 0, 1), (1, 0, 0)),
    "roof": ((1, 0, 0), (0, 0.6, 0.8), (0, -0.8, 0.6)),
}


@pytest.mark.parametrize("name", PLANES)
def test_drawing_plane(name):
    x, y, normal = PLANES[name]
    drawn = on_plane(bean(), x, y, (1, 2, 3))
    grease_pencil([drawn])
    body = run_one()
    check_body(body)
    assert np.allclose(body.matrix_world.col[2][:3], normal, atol=1e-5)
    rim = world_vertices(body)
    distance = (rim - drawn[0]) @ normal
    assert distance.max() > 0.2
    assert np.isclose(distance.max(), -distance.min(), rtol=1e-3)
    assert np.allclose(bounds_middle(vertices(body.data)), 0, atol=0.01)
    assert np.allclose(body.location, np.add((1, 2, 3), bounds_middle(bean() @ [x, y, (0, 0, 0)])), atol=1e-5)


def test_vertical_plane_keeps_x_level_and_y_up():
    grease_pencil([on_plane(bean(), (1, 0, 0), (0, 0, 1))])
    matrix = run_one().matrix_world
    assert np.allclose(matrix.to_3x3(), [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-6)


TRANSFORMS = {
    "moved": Matrix.Translation((3, 4, 5)),
    "turned": Euler((0.5, 0.8, -0.3)).to_matrix().to_4x4(),
    "stretched": Matrix.Diagonal((3, 0.5, 2, 1)),
    "mirrored": Matrix.Diagonal((-1, 1, 1, 1)),
    "turned inside out": Euler((0.5, 0.8, -0.3)).to_matrix().to_4x4() @ Matrix.Diagonal((-2, -3, -1, 1)),
}


@pytest.mark.parametrize("name", TRANSFORMS)
def test_object_transform(name):
    ob = grease_pencil([bean()])
    ob.matrix_world = TRANSFORMS[name]
    bpy.context.view_layer.update()
    matrix = np.array(ob.matrix_world)
    drawn = bean() @ matrix[:3, :3].T + matrix[:3, 3]
    body = run_one()
    check_body(body)
    assert rim_distance(body, drawn) < 1e-5


def rim_distance(body, drawn):
    """Largest distance of the silhouette's vertices from the closed polyline drawn."""
    local = vertices(body.data)
    rim = world_vertices(body)[np.abs(local[:, 2]) < 1e-7]
    a, b = drawn, np.roll(drawn, -1, axis=0)
    step = b - a
    t = np.einsum("ijk,jk->ij", rim[:, None] - a[None], step) / np.einsum("jk,jk->j", step, step)
    nearest = a[None] + np.clip(t, 0, 1)[..., None] * step[None]
    assert len(rim) > 10
    return np.linalg.norm(rim[:, None] - nearest, axis=2).min(axis=1).max()


def test_layer_transform_and_parent():
    ob = grease_pencil([bean()])
    ob.location = (10, 0, 0)
    layer = ob.data.layers[0]
    layer.translation, layer.scale = (0, 2, 0), (2, 1, 1)
    empty = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    own = run_one()
    assert rim_distance(own, at(bean() * [2, 1, 1], 10, 2, 0)) < 1e-5
    layer.parent = empty
    empty.location = (0, 0, 7)
    activate(ob)
    parented = run_one(update_existing=False)
    assert rim_distance(parented, at(bean() * [2, 1, 1], 0, 2, 7)) < 1e-5


def test_layer_on_a_bone():
    armature = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", armature)
    bpy.context.scene.collection.objects.link(rig)
    activate(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    ob = grease_pencil([bean()])
    layer = ob.data.layers[0]
    layer.parent, layer.parent_bone = rig, "Bone"
    rig.pose.bones["Bone"].location = (0, 3, 0)
    bpy.context.view_layer.update()
    matrix = np.array(rig.matrix_world @ rig.pose.bones["Bone"].matrix @ layer.matrix_parent_inverse)
    body = run_one()
    assert rim_distance(body, bean() @ matrix[:3, :3].T + matrix[:3, 3]) < 1e-5


def test_hidden_layers_and_groups_are_skipped():
    ob = grease_pencil([circle()], layer="Shown")
    grease_pencil([circle()], layer="Hidden", ob=ob)
    grease_pencil([circle()], layer="Grouped", ob=ob)
    outer = ob.data.layer_groups.new("Outer")
    inner = ob.data.layer_groups.new("Inner", parent_group=outer)
    ob.data.layers.move_to_layer_group(ob.data.layers["Grouped"], inner)
    ob.data.layers["Hidden"].hide = True
    outer.hide = True
    assert [body["gridmesh_stroke"]["layer"] for body in run()] == ["Shown"]
    outer.hide = False
    activate(ob)
    assert sorted(body["gridmesh_stroke"]["layer"] for body in run()) == ["Grouped"]


def test_locked_layer_is_used():
    ob = grease_pencil([circle()])
    ob.data.layers[0].lock = True
    check_body(run_one())


def select(ob, flags, domain):
    drawing = ob.data.layers[0].current_frame().drawing
    old = drawing.attributes.get(".selection")
    if old is not None:
        drawing.attributes.remove(old)
    attribute = drawing.attributes.new(".selection", "BOOLEAN", domain)
    attribute.data.foreach_set("value", np.asarray(flags, bool))


@pytest.mark.parametrize("domain", ["CURVE", "POINT"])
def test_selected_strokes(domain):
    ob = grease_pencil([circle(20), at(circle(30), 4, 0, 0), at(circle(40), 8, 0, 0)])
    points = np.zeros(90, bool)
    points[25] = True
    select(ob, [False, True, False] if domain == "CURVE" else points, domain)
    assert run_one(use="SELECTED")["gridmesh_stroke"]["stroke"] == 1


def test_absent_selection_means_all():
    grease_pencil([circle(), at(circle(), 4, 0, 0)])
    assert len(run(use="SELECTED")) == 2


def test_current_frame_is_used():
    ob = grease_pencil([circle()])
    frame = ob.data.layers[0].frames.new(10)
    frame.drawing.add_strokes([50])
    frame.drawing.attributes["position"].data.foreach_set("vector", circle(50, 3).astype(np.float32).ravel())
    frame.drawing.strokes[0].cyclic = True
    bpy.context.scene.frame_set(12)
    assert np.isclose(max(run_one().dimensions), 6, rtol=0.01)


def test_modified_strokes_are_used():
    ob = grease_pencil([at(circle(), 3, 0, 0)])
    ob.modifiers.new("Mirror", "GREASE_PENCIL_MIRROR")
    assert sorted(round(body.location.x) for body in run()) == [-3, 3]


def test_nearly_closed_stroke(capfd):
    drawn = circle(60, turn=6.0, closed=False)
    grease_pencil([drawn], cyclic=False)
    body = run_one()
    check_body(body)
    assert rim_distance(body, drawn) < 1e-5
    assert "1 gap closed" in capfd.readouterr().out


def test_overshoot_is_cut_off_at_the_crossing():
    t = np.linspace(0, 6.9, 100)
    spiral = np.stack([(1.1 - 0.03 * t) * np.cos(t), (1.1 - 0.03 * t) * np.sin(t), 0 * t], axis=1)
    spiral[-10:, :2] *= np.linspace(1.0, 1.4, 10)[:, None]
    grease_pencil([spiral], cyclic=False)
    check_body(run_one())


def test_ends_that_pass_each_other_are_cut_off():
    t = np.linspace(0, 6.8, 100)
    spiral = np.stack([(1 + 0.005 * t) * np.cos(t), (1 + 0.005 * t) * np.sin(t), 0 * t], axis=1)
    grease_pencil([spiral], cyclic=False)
    body = run_one()
    check_body(body)
    rim = np.abs(vertices(body.data)[:, 2]) < 1e-7
    assert np.linalg.norm(world_vertices(body)[rim, :2], axis=1).min() > 0.97


def test_closed_only_leaves_open_strokes_out(capfd):
    grease_pencil([circle(), at(circle(30, turn=3.0, closed=False), 5, 0, 0)], cyclic=[True, False])
    run_one(use="CLOSED")
    assert "left out" not in capfd.readouterr().out


@pytest.mark.parametrize("kind", ["BEZIER", "CATMULL_ROM", "NURBS"])
@pytest.mark.parametrize("points", [8, 13])
def test_smooth_strokes_are_sampled(kind, points):
    ob = grease_pencil([circle(points)])
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.grease_pencil.set_curve_type(type=kind)
    if kind == "BEZIER":
        bpy.ops.grease_pencil.set_handle_type(type="AUTO")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(ob.data.layers[0].current_frame().drawing.attributes["position"].data) == points
    body = run_one(triangles=2000)
    check_body(body)
    rim = np.abs(vertices(body.data)[:, 2]) < 1e-7
    radius = np.linalg.norm(world_vertices(body)[rim, :2], axis=1)
    assert np.ptp(radius) < 0.01
    assert radius.max() > 0.85


def test_not_flat_stroke_is_projected_with_a_warning(capfd):
    drawn = circle(80)
    drawn[:, 2] = 0.1 * np.sin(2 * np.linspace(0, 2 * np.pi, 80, endpoint=False))
    grease_pencil([drawn])
    body = run_one()
    check_body(body)
    assert "not flat, up to 0.1 from its plane" in capfd.readouterr().out
    flat = drawn * [1, 1, 0]
    assert rim_distance(body, flat) < 1e-3


def test_flat_stroke_gives_no_warning(capfd):
    grease_pencil([bean()])
    run_one()
    assert "Warning" not in capfd.readouterr().out


def test_flat_sheet(capfd):
    grease_pencil([bean()])
    sheet = run_one(shape="SHEET")
    assert np.abs(vertices(sheet.data)[:, 2]).max() == 0
    normals = [polygon.normal.z for polygon in sheet.data.polygons]
    assert min(normals) > 0.999
    assert uv_of(sheet).min() >= 0
    assert uv_of(sheet).max() <= 1
    assert "1 sheet: " in capfd.readouterr().out


def test_front_and_back_depth():
    grease_pencil([circle()])
    z = vertices(run_one(use_sides=True, depth_front=1.0, depth_back=0.5).data)[:, 2]
    assert np.isclose(z.max(), -2 * z.min(), rtol=0.05)


@pytest.mark.parametrize("profile", ["ROUND", "FLAT", "PEAK"])
@pytest.mark.parametrize("boundary", ["OPTIMAL", "GROWN"])
def test_profiles_and_boundaries(profile, boundary):
    grease_pencil([bean()])
    check_body(run_one(profile=profile, boundary=boundary))


def test_resolution():
    grease_pencil([circle(200)])
    assert abs(len(run_one(triangles=1000).data.polygons) / 2000 - 1) < 0.1
    activate(bpy.data.objects["Drawing"])
    fine = run_one(update_existing=False, resolution="EDGE_LENGTH", edge_length=0.05)
    points, tri = vertices(fine.data), triangles(fine.data)
    flat = points * [1, 1, 0]
    lengths = np.linalg.norm(flat[tri[:, 0]] - flat[tri[:, 1]], axis=1)
    assert 0.02 < np.median(lengths) < 0.08


def test_fixed_angle():
    grease_pencil([bean()])
    check_body(run_one(angle_mode="FIXED", angle=0.3))


def test_good_strokes_are_used_and_bad_ones_named(capfd):
    eight = np.array([[9, 0, 0], [10, 1, 0], [10, 0, 0], [9, 1, 0]], float)
    grease_pencil([circle(), eight, circle(2), at(bean(), 4, 0, 0)])
    assert len(run()) == 2
    out = capfd.readouterr().out
    assert "2 strokes left out" in out
    assert "'Drawing', layer 'Lines', stroke 2 of 4: " in out
    assert "'Drawing', layer 'Lines', stroke 3 of 4: it has 2 distinct points" in out


class TestMaterials:
    def material(self, ob, name="Ink", color=(0.9, 0.1, 0.2, 1)):
        material = bpy.data.materials.new(name)
        bpy.data.materials.create_gpencil_data(material)
        material.grease_pencil.color = color
        ob.data.materials.append(material)
        return material

    def test_surface_twin_has_the_colour_of_the_ink(self):
        ob = grease_pencil([circle()])
        ink = self.material(ob)
        body = run_one()
        (surface,) = body.data.materials
        assert surface.name == "Ink Surface"
        assert not surface.is_grease_pencil
        assert np.allclose(surface.diffuse_color, ink.grease_pencil.color)
        shader = next(node for node in surface.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
        assert np.allclose(shader.inputs["Base Color"].default_value, ink.grease_pencil.color)

    def test_black_ink_gives_no_black_body(self):
        ob = grease_pencil([circle()])
        self.material(ob, "Black", (0, 0, 0, 1))
        assert not run_one().data.materials

    def test_fill_goes_before_stroke(self):
        ob = grease_pencil([circle()])
        ink = self.material(ob)
        ink.grease_pencil.fill_color = (0.1, 0.6, 0.3, 0.5)
        stroke = ob.data.layers[0].current_frame().drawing.strokes[0]
        if bpy.app.version >= (5, 2, 0):
            stroke.fill_id = 1
        else:
            ink.grease_pencil.show_fill = True
        assert np.allclose(run_one().data.materials[0].diffuse_color, (0.1, 0.6, 0.3, 1.0))

    def test_own_material_of_that_name_is_not_touched(self):
        ob = grease_pencil([circle()])
        self.material(ob)
        mine = bpy.data.materials.new("Ink Surface")
        mine.diffuse_color = (0, 0, 1, 1)
        assert run_one().data.materials[0] == mine
        assert mine.diffuse_color[:] == (0, 0, 1, 1)

    def test_twin_is_reused(self):
        ob = grease_pencil([circle(), at(circle(), 4, 0, 0)])
        self.material(ob)
        first, second = run()
        assert first.data.materials[0] == second.data.materials[0]
        activate(ob)
        assert run(update_existing=False)[0].data.materials[0] == first.data.materials[0]
        assert len(bpy.data.materials) == 2

    def test_material_of_each_stroke(self):
        ob = grease_pencil([circle(), at(circle(), 4, 0, 0)])
        self.material(ob, "Ink")
        self.material(ob, "Paint")
        ob.data.layers[0].current_frame().drawing.strokes[1].material_index = 1
        assert [body.data.materials[0].name for body in run()] == ["Ink Surface", "Paint Surface"]


class TestCollections:
    def test_active(self):
        grease_pencil([circle()])
        other = bpy.data.collections.new("Other")
        bpy.context.scene.collection.children.link(other)
        bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection.children[0]
        assert list(run_one(collection="ACTIVE").users_collection) == [other]

    def test_new(self):
        grease_pencil([circle(), at(circle(), 4, 0, 0)])
        first, second = run(collection="NEW")
        (collection,) = first.users_collection
        assert collection.name == "Drawing Bodies"
        assert list(second.users_collection) == [collection]

    def test_source_in_an_excluded_and_a_shown_collection(self):
        ob = grease_pencil([circle()])
        hidden, shown = (bpy.data.collections.new(name) for name in ("A", "B"))
        for collection in (hidden, shown):
            bpy.context.scene.collection.children.link(collection)
            collection.objects.link(ob)
        bpy.context.scene.collection.objects.unlink(ob)
        bpy.context.view_layer.layer_collection.children["A"].exclude = True
        activate(ob)
        assert list(run_one().users_collection) == [shown]


class TestModes:
    @pytest.mark.parametrize("mode", ["EDIT", "PAINT_GREASE_PENCIL", "SCULPT_GREASE_PENCIL"])
    def test_grease_pencil_stays_in_its_mode(self, mode):
        ob = grease_pencil([circle()])
        bpy.ops.object.mode_set(mode=mode)
        before = bpy.context.mode
        check_body(run_one())
        assert bpy.context.mode == before
        assert bpy.context.view_layer.objects.active == ob
        assert ob.select_get()

    def test_undo_in_edit_mode(self):
        grease_pencil([circle()])
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.ed.undo_push(message="base")
        bpy.ops.object.gridmesh_from_strokes("EXEC_DEFAULT", True, triangles=300)
        assert len(mesh_objects()) == 1
        bpy.ops.ed.undo()
        assert not mesh_objects()
