"""Pictures become sprites and bodies: `object.gridmesh_from_image`, `object.gridmesh_update_image`."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix, Vector

from addon.pictures import cutouts, images, placing

SIZE = 96, 64


def disk(radius, at, size=SIZE):
    width, height = size
    y, x = np.mgrid[:height, :width] + 0.5
    return np.clip(radius + 0.5 - np.hypot(x - at[0], y - at[1]), 0, 1)


def drawing(coverage, color=(0.9, 0.3, 0.1)):
    """Colours and alpha (h, w, 4), rows from below as Blender has them."""
    return np.concatenate([np.broadcast_to(color, (*coverage.shape, 3)), coverage[..., None]], axis=2)


def picture(tmp_path, values, name="figure.png"):
    """Save a picture and load it."""
    height, width = values.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=True)
    write(image, values, tmp_path / name)
    bpy.data.images.remove(image)
    return bpy.data.images.load(str(tmp_path / name))


def write(image, values, path):
    image.pixels.foreach_set(np.ascontiguousarray(values, np.float32).ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()


def empty(image, size=2.0):
    ob = bpy.data.objects.new("Reference", None)
    ob.empty_display_type, ob.empty_display_size = "IMAGE", size
    ob.data = image
    bpy.context.scene.collection.objects.link(ob)
    return select(ob)


def plane(image):
    """Put an image on a plane, 3 by 2 units, as *Import Images as Planes* does."""
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata([(-1.5, -1, 0), (1.5, -1, 0), (1.5, 1, 0), (-1.5, 1, 0)], [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new(name="UVMap")
    for at, uv in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)]):
        layer.uv[at].vector = uv
    material = bpy.data.materials.new("Picture")
    if material.node_tree is None:
        material.use_nodes = True  # before Blender 5.0
    material.node_tree.nodes.new("ShaderNodeTexImage").image = image
    mesh.materials.append(material)
    ob = bpy.data.objects.new("Plane", mesh)
    bpy.context.scene.collection.objects.link(ob)
    return select(ob)


def select(*objects):
    bpy.context.view_layer.update()
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob in objects)
    bpy.context.view_layer.objects.active = objects[0]
    return objects[0]


def run(**options):
    assert bpy.ops.object.gridmesh_from_image(**options) == {"FINISHED"}
    return bpy.context.view_layer.objects.active


def arrays(mesh):
    co, uv = np.empty(3 * len(mesh.vertices), np.float32), np.empty(2 * len(mesh.loops), np.float32)
    at = np.empty(len(mesh.loops), np.int32)
    mesh.vertices.foreach_get("co", co)
    mesh.uv_layers.active.uv.foreach_get("vector", uv)
    mesh.loops.foreach_get("vertex_index", at)
    return co.reshape(-1, 3).astype(float), uv.reshape(-1, 2).astype(float), at


def refused(match, operator=None, **options):
    before = len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.materials), len(bpy.data.images)
    with pytest.raises(RuntimeError, match=match):
        (operator or bpy.ops.object.gridmesh_from_image)(**options)
    after = len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.materials), len(bpy.data.images)
    assert after == before


@pytest.mark.smoke
def test_a_sprite_lies_exactly_over_the_picture_of_an_empty(tmp_path):
    source = empty(picture(tmp_path, drawing(disk(20, (40, 30)))))
    source.matrix_world = Matrix.LocRotScale(Vector((1, 2, 3)), Euler((0.3, 0.2, 0.1)), Vector((2, 2, 2)))
    source.empty_image_offset = (-0.25, 0.1)
    bpy.context.view_layer.update()
    ob = run(shape="SHEET", triangles=300)
    assert ob != source
    assert np.allclose(ob.matrix_world, source.matrix_world)
    assert source.hide_get()
    co, uv, at = arrays(ob.data)
    assert abs(co[:, 2]).max() < 1e-6
    across = 2.0 * np.array(SIZE) / max(SIZE)
    assert co[at, :2] == pytest.approx((uv + [-0.25, 0.1]) * across, abs=1e-6)
    middle = uv * SIZE - [40, 30]
    assert np.hypot(*middle.T).max() == pytest.approx(21, abs=0.7)
    assert 250 < len(ob.data.polygons) < 350
    assert all(polygon.normal.z > 0.99 for polygon in ob.data.polygons)
    assert placing.picture_of(ob).name == "figure.png"


def test_a_body_is_closed_and_front_and_back_have_the_picture(tmp_path):
    empty(picture(tmp_path, drawing(disk(20, (40, 30)))))
    ob = run(shape="BODY", triangles=300)
    co, uv, at = arrays(ob.data)
    edges = np.sort(np.stack([at.reshape(-1, 3), np.roll(at.reshape(-1, 3), -1, axis=1)], axis=2), axis=2)
    _, counts = np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)
    assert (counts == 2).all()
    pixel = 2.0 / 96
    assert np.ptp(co[:, 2]) == pytest.approx(40 * pixel, rel=0.05)
    assert co[at, :2] / pixel == pytest.approx(uv * SIZE - np.array(SIZE) / 2, abs=1e-3)
    volume = np.einsum("ij,ij->i", co[at[0::3]], np.cross(co[at[1::3]], co[at[2::3]])).sum() / 6
    assert volume > 0


def test_the_margin_of_a_body_is_its_own(tmp_path):
    """It is opaque: by default there is none, and the silhouette is that of the picture."""
    source = empty(picture(tmp_path, drawing(disk(20, (40, 30)))))
    for options, radius in (({}, 20), ({"margin": 5.0}, 20), ({"body_margin": 3.0}, 23)):
        source.hide_set(False)
        select(source)
        _, uv, _ = arrays(run(shape="BODY", triangles=300, **options).data)
        away = np.hypot(*(uv * SIZE - [40, 30]).T)
        assert radius - 0.05 < away.max() < radius + 0.5, options


def test_all_are_selected_scaled_updated_and_the_update_is_undone(tmp_path):
    for at, name in ((40, "one.png"), (50, "two.png")):
        picture(tmp_path, drawing(disk(14, (at, 30))), name)
    files = [{"name": "one.png"}, {"name": "two.png"}]
    run(directory=str(tmp_path), files=files, shape="SHEET", triangles=200)
    bpy.ops.object.select_all(action="SELECT")
    made = [ob.name for ob in bpy.context.selected_objects]
    assert len(made) == 2
    bpy.ops.ed.undo_push(message="made")
    for name in made:
        bpy.data.objects[name].scale *= 2.5
    places = [tuple(bpy.data.objects[name].location) for name in made]
    other = bpy.data.images.new("other", *SIZE, alpha=True)
    for name in ("one.png", "two.png"):
        write(other, drawing(disk(9, (45, 35))), tmp_path / name)
    bpy.ops.ed.undo_push(message="scaled")
    counts = [len(bpy.data.objects[name].data.polygons) for name in made]
    assert bpy.ops.object.gridmesh_update_image() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="updated")
    for name, place in zip(made, places, strict=True):
        ob = bpy.data.objects[name]
        _, uv, _ = arrays(ob.data)
        assert np.hypot(*(uv * SIZE - [45, 35]).T).max() == pytest.approx(10, abs=0.7)
        assert tuple(ob.scale) == (2.5, 2.5, 2.5)
        assert tuple(ob.location) == place
    bpy.ops.ed.undo()
    assert [len(bpy.data.objects[name].data.polygons) for name in made] == counts
    for name in made:
        ob = bpy.data.objects[name]
        _, uv, _ = arrays(ob.data)
        assert np.hypot(*(uv * SIZE - [45, 35]).T).max() > 12
        assert tuple(ob.scale) == (2.5, 2.5, 2.5)


def test_an_image_plane_keeps_its_place(tmp_path):
    source = plane(picture(tmp_path, drawing(disk(20, (40, 30)))))
    source.location, source.scale = (4, 5, 6), (1, -1, 2)
    bpy.context.view_layer.update()
    ob = run(shape="SHEET")
    assert np.allclose(ob.matrix_world, source.matrix_world)
    co, uv, at = arrays(ob.data)
    assert co[at, :2] == pytest.approx(uv * [3, 2] - [1.5, 1], abs=1e-6)


def test_a_picture_that_does_not_lie_flat_is_refused(tmp_path):
    source = plane(picture(tmp_path, drawing(disk(20, (40, 30)))))
    source.data.vertices[2].co = (3, 3, 1)
    refused("does not lay the picture flat")


def test_a_file_stands_at_the_cursor(tmp_path):
    picture(tmp_path, drawing(disk(20, (40, 30))))
    bpy.context.scene.cursor.location = (5, 0, 1)
    ob = run(filepath=str(tmp_path / "figure.png"), shape="SHEET")
    co, uv, at = arrays(ob.data)
    assert co[at][:, [0, 2]] == pytest.approx(uv * [1.5, 1] + [5 - 0.75, 1], abs=1e-6)
    assert all(polygon.normal.y < -0.99 for polygon in ob.data.polygons)


def test_islands_and_holes(tmp_path):
    ring = (
        disk(28, (34, 32))
        - disk(18, (34, 32))
        + disk(8, (34, 32))
        + disk(10, (78, 20))
        + disk(0.6, (90.5, 60.5))
    )
    source = empty(picture(tmp_path, drawing(ring)))
    ob = run(shape="SHEET")
    co, _, _ = arrays(ob.data)
    across = co[:, :2] * 48 + [48, 32]
    away = np.hypot(*(across - [34, 32]).T)
    assert not ((away > 10) & (away < 16)).any()
    assert not (np.hypot(*(across - [90, 60]).T) < 3).any()
    source.hide_set(False)
    select(source)
    filled = run(shape="SHEET", use_holes=False, hide_source=False)
    assert not source.hide_get()
    away = np.hypot(*(arrays(filled.data)[0][:, :2] * 48 + [48, 32] - [34, 32]).T)
    assert ((away > 10) & (away < 16)).any()


def test_a_drawing_on_paper(tmp_path):
    light = np.linspace(0.95, 0.55, SIZE[0])[None, :, None]
    ink = disk(20, (40, 30))[..., None]
    values = np.concatenate([light * (1 - 0.8 * ink) * np.ones(3), np.ones_like(ink)], axis=2)
    empty(picture(tmp_path, values))
    ob = run(shape="SHEET", margin=0.0)
    _, uv, _ = arrays(ob.data)
    assert np.hypot(*(uv * SIZE - [40, 30]).T).max() == pytest.approx(20, abs=0.8)
    tree = ob.active_material.node_tree
    assert not any(link.to_socket.name == "Alpha" for link in tree.links)


def test_materials_are_made_once_for_each_way(tmp_path):
    source = empty(picture(tmp_path, drawing(disk(20, (40, 30)))))
    first = run(shape="SHEET").active_material
    for options, same in (({}, True), ({"lit": True}, False), ({"shape": "BODY"}, False)):
        source.hide_set(False)
        select(source)
        found = run(**{"shape": "SHEET", **options}).active_material
        assert (found == first) == same
    assert any(link.to_socket.name == "Alpha" for link in first.node_tree.links)


def test_an_update_follows_the_picture_and_keeps_the_rest(tmp_path):
    image = picture(tmp_path, drawing(disk(20, (40, 30))))
    empty(image)
    ob = run(shape="SHEET", triangles=200)
    ob.name = "Kept"
    ob.location.x = 7
    ob.vertex_groups.new(name="Bone")
    other = bpy.data.images.new("other", *SIZE, alpha=True)
    write(other, drawing(disk(12, (60, 30))), tmp_path / "figure.png")
    select(ob)
    assert bpy.ops.object.gridmesh_update_image() == {"FINISHED"}
    _, uv, _ = arrays(ob.data)
    assert np.hypot(*(uv * SIZE - [60, 30]).T).max() == pytest.approx(13, abs=0.7)
    assert (ob.name, ob.location.x, [group.name for group in ob.vertex_groups]) == ("Kept", 7, ["Bone"])
    assert 160 < len(ob.data.polygons) < 260

    write(other, drawing(np.zeros(SIZE[::-1])), tmp_path / "figure.png")
    refused("nothing in it is covered", bpy.ops.object.gridmesh_update_image)
    assert len(ob.data.polygons) > 100
    ob.data.vertices[0].co.x += 1
    refused("changed by hand", bpy.ops.object.gridmesh_update_image)


def test_what_cannot_be_done_is_said_and_changes_nothing(tmp_path):
    refused("no picture is selected")
    empty(picture(tmp_path, drawing(np.zeros(SIZE[::-1]))))
    refused("nothing in it is covered")
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(40))
    refused("missing or damaged|cannot be read", filepath=str(tmp_path / "broken.png"))
    refused("cannot be read", filepath=str(tmp_path / "absent.png"))
    empty(picture(tmp_path, drawing(disk(5, (40, 30))), "small.png"))
    refused("smaller than the least area", min_area=1000)
    refused("allowed: 1 or more", triangles=0)
    image = bpy.data.images.new("moving", 8, 8)
    image.source = "SEQUENCE"
    empty(image)
    refused("more than one frame")


def test_sizes_are_looked_at_before_pixels_are_read():
    with pytest.raises(cutouts.PictureError, match="40000 by 40000"):
        cutouts.check_size(40000, 40000)
    with pytest.raises(cutouts.PictureError, match="0 by 3"):
        cutouts.check_size(0, 3)


def test_one_step_to_undo_and_options_to_redo(tmp_path):
    empty(picture(tmp_path, drawing(disk(20, (40, 30)))))
    assert "UNDO" in bpy.types.OBJECT_OT_gridmesh_from_image.bl_options
    assert bpy.ops.object.gridmesh_from_image.poll()
    ob = run(shape="SHEET", triangles=200)
    matrix, options = placing.recall(ob)
    assert options.triangles == 200
    assert options.body is None
    assert matrix.shape == (4, 4)
    assert not images.shows_picture(bpy.data.objects.new("Nothing", None))
