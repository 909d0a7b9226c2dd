"""Meshes and drawings from files through the command line: filled, cut, made into bodies."""

import json

import bmesh
import bpy
import numpy as np
import pytest
from batches import SHAPES, batch, results, run, write_jobs
from mathutils import Matrix

ACROSS = [[-2, 0.1], [2, 0.2]]
SUFFIXES = ("ply", "obj", "stl", "glb", "gltf", "blend")


def ball(name="Ball", *, z=0.0, opened=True):
    """A sphere with UVs, without its upper end."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16, location=(0, 0, z))
    ob = bpy.context.object
    ob.name = name
    if opened:
        bm = bmesh.new()
        bm.from_mesh(ob.data)
        top = [face for face in bm.faces if face.calc_center_median().z > 0.8]
        bmesh.ops.delete(bm, geom=top, context="FACES")
        bm.to_mesh(ob.data)
        bm.free()
    return ob


def save(path):
    """Write what is in the scene."""
    path.parent.mkdir(parents=True, exist_ok=True)
    name = str(path)
    axes = {"forward_axis": "Y", "up_axis": "Z"}
    done = {
        ".ply": lambda: bpy.ops.wm.ply_export(filepath=name, **axes),
        ".obj": lambda: bpy.ops.wm.obj_export(filepath=name, **axes),
        ".stl": lambda: bpy.ops.wm.stl_export(filepath=name, **axes),
        ".glb": lambda: bpy.ops.export_scene.gltf(filepath=name, export_format="GLB"),
        ".gltf": lambda: bpy.ops.export_scene.gltf(filepath=name, export_format="GLTF_SEPARATE"),
        ".blend": lambda: bpy.ops.wm.save_as_mainfile(filepath=name, copy=True),
    }[path.suffix]()
    assert done == {"FINISHED"}
    return path


def load(path):
    """Mesh objects of a .ply or .blend file."""
    if path.suffix == ".blend":
        bpy.ops.wm.open_mainfile(filepath=str(path))
    else:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        bpy.ops.wm.ply_import(filepath=str(path), forward_axis="Y", up_axis="Z")
    return {ob.name: ob for ob in bpy.context.scene.objects if ob.type == "MESH"}


def corners_of(path):
    """Positions (f, k, 3) of the corners of the faces of a file, which all have k of them."""
    axes = {"forward_axis": "Y", "up_axis": "Z"}
    if path.suffix in {".ply", ".blend"}:
        (ob,) = load(path).values()
    else:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        read = {
            ".obj": lambda name: bpy.ops.wm.obj_import(filepath=name, **axes),
            ".stl": lambda name: bpy.ops.wm.stl_import(filepath=name, **axes),
            ".glb": lambda name: bpy.ops.import_scene.gltf(filepath=name),
        }[path.suffix]
        assert read(str(path)) == {"FINISHED"}
        (ob,) = (ob for ob in bpy.context.scene.objects if ob.type == "MESH")
    points = np.array([vertex.co[:] for vertex in ob.data.vertices])
    return points[np.array([polygon.vertices[:] for polygon in ob.data.polygons])]


def open_edges(ob):
    """Edges without two faces, where vertices at the same place are one."""
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=1e-6)
    return sum(not edge.is_manifold for edge in bm.edges)


def volume(ob):
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=1e-6)
    return bm.calc_volume()


@pytest.fixture
def balls(tmp_path):
    """The same open sphere in every format."""
    ball()
    return [save(tmp_path / "in" / f"ball {suffix}.{suffix}") for suffix in SUFFIXES]


def test_fill_reads_every_format_alike(tmp_path, balls):
    ran = run("fill", tmp_path / "in", "-o", tmp_path / "out" / "{name}.ply", "--smooth", "curvature")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    found = results(tmp_path / "out")
    assert len(found) == len(balls)
    numbers = [(one["holes"], one["triangles"], one["irregular"]) for one in found.values()]
    assert len(set(numbers)) == 1
    assert numbers[0][0] == 1
    assert numbers[0][1] > 24
    for path in balls:
        (ob,) = load(tmp_path / "out" / f"{path.stem}.ply").values()
        assert open_edges(ob) == 0
        assert volume(ob) == pytest.approx(4.05, abs=0.1)


def test_the_buffer_of_a_gltf_is_part_of_the_input(tmp_path):
    from addon.cli import files

    ball()
    path = save(tmp_path / "a ball.gltf")
    before, found = files.key_of([], [str(path)], 1e9, outside=False)
    assert [file.name for file in found] == ["a ball.gltf", "a ball.bin"]
    found[1].write_bytes(b"other")
    assert files.key_of([], [str(path)], 1e9, outside=False)[0] != before


def test_fill_in_quads(tmp_path):
    ball()
    path = save(tmp_path / "ball.ply")
    ran = run("fill", path, "-o", tmp_path / "whole.ply", "--cells", "quads")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert (result["holes"], result["triangles"]) == (1, 0)
    (ob,) = load(tmp_path / "whole.ply").values()
    assert open_edges(ob) == 0
    assert sum(len(polygon.vertices) == 4 for polygon in ob.data.polygons) >= result["quads"] > 0


def half(ob):
    """A material, a vertex group and a face attribute for what is right of x = 0.3."""
    mesh = ob.data
    chosen = [polygon.index for polygon in mesh.polygons if polygon.center.x > 0.3]
    for name in ("Left", "Right"):
        mesh.materials.append(bpy.data.materials.new(name))
    for index in chosen:
        mesh.polygons[index].material_index = 1
    group = ob.vertex_groups.new(name="Bone")
    group.add([v for index in chosen for v in mesh.polygons[index].vertices], 1.0, "REPLACE")
    mesh.attributes.new("area", "BOOLEAN", "FACE").data.foreach_set(
        "value", [polygon.index in set(chosen) for polygon in mesh.polygons]
    )
    return len(chosen)


@pytest.mark.parametrize("name", ["Right", "Bone", "area"])
def test_regrid_of_named_areas(tmp_path, name):
    ob = ball(opened=False)
    other = ball("Other", z=3, opened=False)
    chosen, rest = half(ob), len(ob.data.polygons)
    path = save(tmp_path / "ball.blend")
    others = len(other.data.polygons)
    ran = run("regrid", path, "-o", tmp_path / "out.blend", "--select", name, "--cells", "quads")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert (result["areas"], result["triangles"]) == (1, 0)
    found = load(tmp_path / "out.blend")
    assert len(found["Other"].data.polygons) == others, "it has nothing of that name"
    assert open_edges(found["Ball"]) == 0
    assert len(found["Ball"].data.polygons) == rest - chosen + result["quads"]
    points = np.array([vertex.co for vertex in found["Ball"].data.vertices])
    assert np.linalg.norm(points, axis=1).min() > 0.97


def test_regrid_of_whole_areas(tmp_path):
    """Without a name each connected area of one material; one that is no disk stays, and is named."""
    half(ball(opened=False))
    ball("Closed", z=3, opened=False)
    path = save(tmp_path / "ball.blend")
    ran = run("regrid", path, "-o", tmp_path / "out.blend")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert (result["status"], result["areas"]) == ("warning", 2)
    assert "Closed" in result["message"]
    found = load(tmp_path / "out.blend")
    assert open_edges(found["Ball"]) == 0
    assert {len(polygon.vertices) for polygon in found["Ball"].data.polygons} == {3}
    for polygon in found["Ball"].data.polygons:  # those at the border reach over it
        assert (polygon.center.x > 0.3) == polygon.material_index or abs(polygon.center.x - 0.3) < 0.15


def test_regrid_of_what_is_not_there(tmp_path):
    ball()
    path = save(tmp_path / "ball.ply")
    ran = run("regrid", path, "-o", tmp_path / "out.ply", "--select", "Nothing")
    assert ran.returncode == 1
    (result,) = results(tmp_path).values()
    assert (result["status"], result["kind"]) == ("error", "areas")
    assert "no face belongs to 'Nothing'" in result["message"]


def test_a_blend_file_keeps_everything_else(tmp_path):
    ball("Leaf 1")
    ball("Leaf 2", z=3)
    ball("Stone", z=6)
    twin = bpy.data.objects.new("Twin", bpy.data.objects["Leaf 1"].data)
    bpy.context.collection.objects.link(twin)
    ball("Leaf hidden", z=9).hide_set(True)
    bpy.ops.object.light_add()
    path = save(tmp_path / "wood.blend")
    ran = run("fill", path, "-o", tmp_path / "filled.blend", "--object", "Leaf*")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert result["status"] == "warning"
    assert "Leaf hidden" in result["message"]
    assert result["holes"] == 2
    found = load(tmp_path / "filled.blend")
    assert {name for name, ob in found.items() if not open_edges(ob)} == {"Leaf 1", "Leaf 2", "Twin"}
    assert "Light" in {ob.name for ob in bpy.data.objects} or "Point" in {ob.name for ob in bpy.data.objects}


def test_cut_closes_both_sides(tmp_path):
    ball(opened=False)
    save(tmp_path / "ball.blend")
    sides = {"both": 2, "left": 1, "right": 1}
    params = {"stroke": ACROSS, "edge_length": 0.2}
    items = [
        {
            "id": keep,
            "op": "cut",
            "in": "ball.blend",
            "params": {**params, "keep": keep},
            "out": f"{keep}.blend",
        }
        for keep in sides
    ]
    ran = batch(write_jobs(tmp_path, items))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    volumes = []
    for keep, result in results(tmp_path).items():
        assert result["pieces"] == sides[keep]
        assert result["triangles"] > 20
        assert 0 < result["min_angle"] < np.pi / 3 + 1e-9
        found = load(tmp_path / f"{keep}.blend")
        assert len(found) == sides[keep]
        assert not any(map(open_edges, found.values()))
        volumes.append(sum(map(volume, found.values())))
    assert volumes[1] + volumes[2] == pytest.approx(volumes[0])
    assert volumes[1] < volumes[2]


def test_caps_of_cuts_are_quads_where_asked(tmp_path):
    ball(opened=False)
    path = save(tmp_path / "ball.blend")
    words = ["--stroke", json.dumps(ACROSS), "--edge-length", "0.2", "--keep", "left", "--cells", "quads"]
    ran = run("cut", path, "-o", tmp_path / "cut.blend", *words)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert result["quads"] > 10
    assert result["triangles"] <= 1
    (left,) = load(tmp_path / "cut.blend").values()
    assert not open_edges(left)


def test_all_meshes_of_a_file_become_one(tmp_path):
    ball("Body", opened=False)
    ball("Head", z=1.3, opened=False)
    ball("Apart", z=9.0, opened=False)
    save(tmp_path / "bear.blend")
    items = [
        {"id": "some", "op": "join", "in": "bear.blend", "object": "[BH]*", "out": "some.ply"},
        {"id": "all", "op": "join", "in": "bear.blend", "params": {"blend": 0}, "out": "all.ply"},
        {"id": "one", "op": "join", "in": "bear.blend", "object": "Head", "out": "one.ply"},
        {"id": "pieces", "op": "join", "in": "all.ply", "out": "pieces.ply"},
    ]
    ran = batch(write_jobs(tmp_path, items))
    assert ran.returncode == 1, ran.stdout + ran.stderr
    found = results(tmp_path)
    assert (found["some"]["parts"], found["some"]["collars"]) == (2, 1)
    assert found["some"]["quads"] > 200
    assert (found["all"]["status"], found["all"]["parts"]) == ("warning", 3)
    assert "without contact" in found["all"]["message"]
    assert found["one"]["kind"] == "one_part"
    assert found["pieces"]["parts"] == 2
    for key, volumes in (("some", (6.0, 8.4)), ("all", (10.0, 12.6)), ("pieces", (10.0, 12.6))):
        (whole,) = load(tmp_path / f"{key}.ply").values()
        assert not open_edges(whole)
        assert volumes[0] < volume(whole) < volumes[1]


def joined_of_two(path, tmp_path):
    """The closed mesh that the command makes of a file with two parts."""
    ran = run("join", path, "-o", tmp_path / "one.ply")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert result["parts"] == 2
    (whole,) = load(tmp_path / "one.ply").values()
    assert not open_edges(whole)
    return whole


def test_a_cavity_of_the_only_mesh_stays_one(tmp_path):
    hollow = ball("Hollow", opened=False)
    inner = ball("Inner", opened=False)
    inner.data.transform(Matrix.Scale(0.5, 4))
    inner.data.flip_normals()
    head = ball("Head", z=1.5, opened=False)
    outside = volume(head)
    with bpy.context.temp_override(
        active_object=hollow, object=hollow, selected_editable_objects=[hollow, inner, head]
    ):
        bpy.ops.object.join()
    path = save(tmp_path / "hollow.blend")
    whole = joined_of_two(path, tmp_path)
    # What two balls have in common is a sixth of one here, or less.
    assert (2 - 1 / 6 - 1 / 8) * outside - 0.05 * outside < volume(whole) < (2 - 1 / 8) * outside


def test_vertices_without_faces_are_no_pieces(tmp_path):
    body = ball("Body", opened=False)
    head = ball("Head", z=1.5, opened=False)
    with bpy.context.temp_override(active_object=body, object=body, selected_editable_objects=[body, head]):
        bpy.ops.object.join()
    body.data.vertices.add(2)
    body.data.edges.add(1)
    body.data.edges[-1].vertices = [len(body.data.vertices) - 2, len(body.data.vertices) - 1]
    joined_of_two(save(tmp_path / "loose.blend"), tmp_path)


def test_open_meshes_are_not_joined(tmp_path):
    ball("Body", opened=False)
    ball("Head", z=1.3)
    path = save(tmp_path / "bear.blend")
    ran = run("join", path, "-o", tmp_path / "no.ply")
    assert ran.returncode == 1
    (result,) = results(tmp_path).values()
    assert result["kind"] == "not_closed"
    assert "'Head' is not closed" in result["message"]
    assert not (tmp_path / "no.ply").exists()


def test_ends_of_a_cut_are_continued_unless_told_otherwise(tmp_path):
    for x in (-3, 0, 3):
        bpy.ops.mesh.primitive_cube_add(size=2, location=(x, 0, 0))
    bpy.context.view_layer.objects.active = bpy.context.object
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.join()
    save(tmp_path / "three.blend")
    short = {"stroke": [[-0.5, 0.1], [0.5, 0.1]], "keep": "left"}
    items = [
        {"id": key, "op": "cut", "in": "three.blend", "params": {**short, **more}, "out": f"{key}.blend"}
        for key, more in (("all", {}), ("one", {"extend_ends": False}))
    ]
    ran = batch(write_jobs(tmp_path, items))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    volumes = {}
    for key in ("all", "one"):
        (found,) = load(tmp_path / f"{key}.blend").values()
        volumes[key] = volume(found)
    assert volumes == pytest.approx({"all": 3 * 3.6, "one": 16 + 3.6}, rel=1e-5)


def test_strokes_to_cut_along_come_from_files_and_objects(tmp_path):
    ball(opened=False)
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.5, location=(0, 0, 3))
    bpy.context.object.name = "Ring"
    save(tmp_path / "ball.blend")
    angles = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    circle = (0.5 * np.column_stack([np.cos(angles), np.sin(angles)])).tolist()
    (tmp_path / "ring.json").write_text(json.dumps({"points": circle}))
    (tmp_path / "line.csv").write_text("-2,0.1\n2,0.2\n")
    strokes = {
        "object": {"stroke": "Ring"},
        "json": {"stroke": "ring.json", "closed": True},
        "points": {"stroke": circle, "closed": True},
        "csv": {"stroke": "line.csv"},
    }
    items = [
        {"id": key, "op": "cut", "in": "ball.blend", "params": params, "out": f"out/{key}.blend"}
        for key, params in strokes.items()
    ]
    jobs = write_jobs(tmp_path, items)
    ran = batch(jobs)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    for key in strokes:
        found = [ob for ob in load(tmp_path / "out" / f"{key}.blend").values() if ob.type == "MESH"]
        assert len(found) == 2
        assert not any(map(open_edges, found))
        if key != "csv":
            core = min(map(volume, found))
            assert core == pytest.approx(1.4, abs=0.15), key
    # The file of the stroke is part of the input.
    (tmp_path / "line.csv").write_text("-2,0.2\n2,0.3\n")
    assert "1 done, 0 failed, 3 skipped" in batch(jobs, "--resume").stdout


def test_a_stroke_beside_a_mesh_leaves_a_name_in_the_report(tmp_path):
    ball(opened=False)
    ball("Far", z=9, opened=False).location.y = 9
    path = save(tmp_path / "balls.blend")
    ran = run("cut", path, "-o", tmp_path / "cut.blend", "--stroke", json.dumps(ACROSS))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert result["status"] == "warning"
    assert "'Far'" in result["message"]
    assert len(load(tmp_path / "cut.blend")) == 3
    nothing = run("cut", path, "-o", tmp_path / "no.blend", "--stroke", "[[0, 50], [9, 50]]")
    assert nothing.returncode == 1
    assert not (tmp_path / "no.blend").exists()


SVG = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 300 100">
<path d="M 0 0 H 100 V 100 H 0 z M 30 30 V 70 H 70 V 30 z"/><circle cx="200" cy="50" r="40"/></svg>"""


def test_an_svg_has_outlines_and_holes(tmp_path):
    (tmp_path / "Möbel 1.svg").write_text(SVG)
    ran = run("strokes", tmp_path / "*.svg", "-o", tmp_path / "{name}.blend", "--triangles", "300")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert result["bodies"] == 2
    assert result["status"] == "ok"
    genus = []
    for ob in load(tmp_path / "Möbel 1.blend").values():
        mesh = ob.data
        assert open_edges(ob) == 0
        genus.append(1 - (len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons)) // 2)
    assert sorted(genus) == [0, 1]


def test_drawings_of_a_blend_file_by_name(tmp_path):
    for name in ("Leaf 1", "Leaf 2", "Other"):
        bpy.ops.curve.primitive_bezier_circle_add(radius=1)
        bpy.context.object.name = name
    drawing = (
        bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils
    )
    data = drawing.new("Leaf drawn")
    frame = data.layers.new("Layer").frames.new(bpy.context.scene.frame_current)
    angles = np.linspace(0, 2 * np.pi, 50, endpoint=False)
    frame.drawing.add_strokes([len(angles)])
    stroke = frame.drawing.strokes[0]
    stroke.cyclic = True
    for point, angle in zip(stroke.points, angles, strict=True):
        point.position = (np.cos(angle), 0, 2 * np.sin(angle))
    bpy.context.collection.objects.link(bpy.data.objects.new("Leaf drawn", data))
    path = save(tmp_path / "drawn.blend")
    ran = run("strokes", path, "-o", tmp_path / "bodies.ply", "--object", "Leaf*", "--triangles", "200")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (result,) = results(tmp_path).values()
    assert result["bodies"] == 3
    none = run("strokes", path, "-o", tmp_path / "none.ply", "--object", "Twig*")
    assert none.returncode == 1
    assert "Twig*" in none.stdout


def test_bodies_written_as_blend_can_be_read_again(tmp_path):
    made = run("strokes", SHAPES / "bean.json", "-o", tmp_path / "bean.blend", "--triangles", "200")
    assert made.returncode == 0, made.stdout + made.stderr
    cut = run(
        "cut", tmp_path / "bean.blend", "-o", tmp_path / "cut.ply", "--stroke", "[[-9, 0.01], [9, 0.02]]"
    )
    assert cut.returncode == 0, cut.stdout + cut.stderr


def test_the_command_lines_of_one_operation_are_those_of_a_batch(tmp_path):
    shapes = [SHAPES / f"{name}.json" for name in ("bean", "star")]
    words = ["--triangles", "200", "--profile", "even", "--curve", "0,0.6,0.9,1"]
    ran = run("strokes", *shapes, "-o", tmp_path / "a" / "{name}.ply", *words)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    items = [
        {
            "id": path.stem,
            "op": "strokes",
            "in": str(path),
            "params": {"triangles": 200, "profile": "even", "curve": [0, 0.6, 0.9, 1]},
            "out": f"b/{path.stem}.ply",
        }
        for path in shapes
    ]
    assert batch(write_jobs(tmp_path, items)).returncode == 0
    plain = run("strokes", *shapes, "-o", tmp_path / "c" / "{name}.ply", *words[:4])
    assert plain.returncode == 0, plain.stdout + plain.stderr
    for path in shapes:
        name = f"{path.stem}.ply"
        assert (tmp_path / "a" / name).read_bytes() != (tmp_path / "c" / name).read_bytes()
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_quads_are_written_to_every_format(tmp_path):
    items = [
        {
            "id": suffix,
            "op": "strokes",
            "in": str(SHAPES / "bean.json"),
            "params": {"quads": 300} if suffix != "obj" else {"cells": "quads", "edge_length": 0.15},
            "out": f"bean.{suffix}",
        }
        for suffix in ("ply", "obj", "glb", "stl", "blend")
    ]
    ran = batch(write_jobs(tmp_path, items))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    found = results(tmp_path)
    quads = found["ply"]["quads"]
    assert quads == pytest.approx(600, rel=0.1)
    assert found["ply"]["triangles"] == 0
    assert found["ply"]["min_angle"] > 0.3
    made = {one["id"]: corners_of(tmp_path / one["out"]).shape for one in items}
    assert made["ply"] == made["blend"] == (quads, 4, 3)
    assert made["obj"][1] == 4
    assert made["glb"] == made["stl"] == (2 * quads, 3, 3)


def test_formats_without_quads_get_them_cut_along_the_shorter_diagonal(tmp_path):
    for suffix in ("ply", "stl"):
        ran = run("strokes", SHAPES / "star.json", "-o", tmp_path / f"star.{suffix}", "--cells", "quads")
        assert ran.returncode == 0, ran.stdout + ran.stderr
    quads, cut = (corners_of(tmp_path / f"star.{suffix}") for suffix in ("ply", "stl"))
    shorter = np.minimum(*(np.linalg.norm(quads[:, k] - quads[:, k + 2], axis=1) for k in range(2)))
    sides, in_all = (np.linalg.norm(at - np.roll(at, 1, axis=1), axis=2).sum() for at in (quads, cut))
    longer = np.maximum(*(np.linalg.norm(quads[:, k] - quads[:, k + 2], axis=1) for k in range(2)))
    apart = (
        2 * (longer - shorter).sum()
    )  # folded along the shorter one, a few at tips are cut along the other
    assert in_all - sides - 2 * shorter.sum() < 0.05 * apart


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--quads", "300", "--triangles", "300"], "not both"),
        (["--quads", "300", "--edge-length", "1"], "not both"),
        (["--cells", "triangles", "--quads", "300"], "leave one out"),
        (["--cells", "hexagons"], "quads"),
    ],
)
def test_quads_and_other_numbers_do_not_go_together(words, said):
    ran = run("strokes", "a.json", "-o", "a.ply", *words)
    assert ran.returncode == 2
    assert said in ran.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["fill", "none/*.ply", "-o", "a.ply"], "matches no files"),
        (["strokes", "a.json", "b.json", "-o", "a.ply"], "{name}"),
        (["cut", "a.ply", "-o", "b.ply", "--stroke", "Ring"], "only a .blend"),
        (["cut", "a.ply", "-o", "b.ply", "--stroke", "[[0, 0], [1]]"], "list of points"),
        (["fill", "a.txt", "-o", "b.ply"], "a.txt"),
        (["fill", "a.ply"], "--out"),
        (["strokes", "a.json", "-o", "a.ply", "--close-gaps", "2"], "from 0 to 1"),
        (["strokes", "a.json", "-o", "a.ply", "--curve", "0,x"], "no numbers"),
        (["strokes", "a.json", "-o", "a.ply", "--curve", "0"], "two finite numbers"),
        (["strokes", "a.json", "-o", "a.ply", "--curve", "0,nan"], "two finite numbers"),
    ],
)
def test_bad_command_lines_say_what_is_wrong(words, said):
    ran = run(*words)
    assert ran.returncode == 2
    assert said in ran.stderr


def test_pictures_show_what_was_made(tmp_path):
    ran = run("strokes", SHAPES / "star.json", "-o", tmp_path / "star.ply", "--triangles", "200", "--render")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    image = bpy.data.images.load(str(tmp_path / "star.png"))
    pixels = np.array(image.pixels[:]).reshape(*image.size, 4)
    shown = np.abs(pixels[..., :3] - pixels[0, 0, :3]).max(axis=2) > 0.05
    shown |= pixels[..., 3] != pixels[0, 0, 3]
    assert 0.1 < shown.mean() < 0.8
    (tmp_path / "star.png").unlink()
    again = run(
        "strokes",
        SHAPES / "star.json",
        "-o",
        tmp_path / "star.ply",
        "--triangles",
        "200",
        "--resume",
        "--render",
    )
    assert "1 done" in again.stdout
    assert (tmp_path / "star.png").exists()
