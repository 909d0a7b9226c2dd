"""Pictures to sprites on the command line: what is written is read back by others, and no file breaks a run."""

import json
import re
import struct
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from batches import ROOT, batch, command, results, run, write_jobs

sys.path.append(str(ROOT / "tests" / "core"))

from picture_files import disk, hostile, jpeg, png

TEXTS = ("glb", "gltf", "json", "tscn")
"""Formats of which the same meshes are the same bytes."""
SIZE = 96, 64


def two_parts():
    """A ring and a disk, (h, w, 4), rows from the top."""
    width, height = SIZE
    y, x = np.mgrid[:height, :width] + 0.5
    ring = np.abs(np.hypot(x - 34, y - 30) - 19)
    alpha = np.maximum(np.clip(8.5 - ring, 0, 1), np.clip(10.5 - np.hypot(x - 80, y - 40), 0, 1))
    return np.rint(255 * np.dstack([x / width, y / height, 0 * x + 0.2, alpha])).astype(np.uint8)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Sprites of one picture in every format."""
    folder = tmp_path_factory.mktemp("sprites")
    (folder / "ring.png").write_bytes(png(two_parts()))
    out = [(ending, {}) for ending in (*TEXTS, "blend")] + [("glb", {"shape": "body", "depth": 0.5})]
    items = [
        {
            "id": f"{at}",
            "op": "sprites",
            "in": "ring.png",
            "out": f"{'body' if options else 'ring'}.{ending}",
            "params": {"triangles": 300, **options},
        }
        for at, (ending, options) in enumerate(out)
    ]
    ran = batch(write_jobs(folder, items))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    found = results(folder)
    assert all(result["parts"] == 2 and 250 < result["triangles"] < 1300 for result in found.values())
    return folder


def is_over_the_picture(points, uv, unit=1.0):
    """Whether places, y up from the lower middle, and UVs from the upper left corner are those of one picture."""
    width, height = SIZE
    assert points[:, 0] * unit == pytest.approx(uv[:, 0] * width - width / 2, abs=2e-3)
    assert points[:, 1] * unit == pytest.approx((1 - uv[:, 1]) * height, abs=2e-3)
    middle = (uv - [34 / width, 30 / height]) * [width, height]
    other = (uv - [80 / width, 40 / height]) * [width, height]
    away = np.minimum(np.abs(np.hypot(*middle.T) - 19), np.hypot(*other.T))
    assert away.max() < 13


def area(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    (x, y), (u, v) = (b - a).T, (c - a).T
    return (x * v - y * u) / 2


def empty_session():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


@pytest.mark.parametrize("name", ["ring.glb", "ring.gltf", "body.glb"])
def test_blender_reads_the_gltf(folder, name):
    import addon_utils

    empty_session()
    addon_utils.enable("io_scene_gltf2", default_set=False)
    assert bpy.ops.import_scene.gltf(filepath=str(folder / name)) == {"FINISHED"}
    (ob,) = [ob for ob in bpy.data.objects if ob.type == "MESH"]
    mesh = ob.data
    co = np.empty(3 * len(mesh.vertices), np.float32)
    uv = np.empty(2 * len(mesh.loops), np.float32)
    at = np.empty(len(mesh.loops), np.int32)
    mesh.vertices.foreach_get("co", co)
    mesh.uv_layers.active.uv.foreach_get("vector", uv)
    mesh.loops.foreach_get("vertex_index", at)
    places, uv = co.reshape(-1, 3)[at], uv.reshape(-1, 2)
    is_over_the_picture(places[:, [0, 2]], np.column_stack([uv[:, 0], 1 - uv[:, 1]]), 100)
    if name == "body.glb":
        assert np.ptp(places[:, 1]) * 100 > 5
        assert all(count == 2 for count in np.unique(np.sort(
            np.concatenate([at.reshape(-1, 3)[:, [k, k - 1]] for k in range(3)]), axis=1), axis=0, return_counts=True)[1])  # fmt: skip
    else:
        assert np.abs(places[:, 1]).max() < 1e-6
        assert all(polygon.normal.y < -0.99 for polygon in mesh.polygons)
    (image,) = [image for image in bpy.data.images if image.size[0]]
    assert tuple(image.size) == SIZE
    assert image.pixels[0:4][3] == 0


def test_the_gltf_keeps_the_rules_of_the_format(folder):
    data = (folder / "ring.glb").read_bytes()
    magic, version, size = struct.unpack_from("<4sII", data)
    assert (magic, version, size) == (b"glTF", 2, len(data))
    length, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    assert length % 4 == 0
    text = json.loads(data[20 : 20 + length])
    rest = data[28 + length :]
    for view in text["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= text["buffers"][0]["byteLength"] == len(rest)
    primitive = text["meshes"][0]["primitives"][0]
    accessors = text["accessors"]
    n = accessors[primitive["attributes"]["POSITION"]]["count"]
    assert all(accessors[at]["count"] == n for at in primitive["attributes"].values())
    view = text["bufferViews"][accessors[primitive["indices"]]["bufferView"]]
    numbers = np.frombuffer(rest, "<u4", view["byteLength"] // 4, view["byteOffset"])
    assert numbers.max() == n - 1
    picture = text["bufferViews"][text["images"][0]["bufferView"]]
    start = picture["byteOffset"]
    assert rest[start : start + picture["byteLength"]] == (folder / "ring.png").read_bytes()
    assert text["materials"][0]["alphaMode"] == "BLEND"
    assert text["extensionsUsed"] == ["KHR_materials_unlit"]


def test_spine_reads_the_skeleton(folder):
    text = json.loads((folder / "ring.json").read_text(encoding="utf-8"))
    assert text["skeleton"]["images"] == "./images/"
    assert [bone["name"] for bone in text["bones"]] == ["root"]
    assert len(text["slots"]) == 2
    (skin,) = text["skins"]
    for slot in text["slots"]:
        assert slot["bone"] == "root"
        mesh = skin["attachments"][slot["name"]][slot["attachment"]]
        assert mesh["type"] == "mesh"
        assert (folder / "images" / f"{mesh['path']}.png").read_bytes() == (folder / "ring.png").read_bytes()
        points, uv = np.reshape(mesh["vertices"], (-1, 2)), np.reshape(mesh["uvs"], (-1, 2))
        triangles = np.reshape(mesh["triangles"], (-1, 3))
        assert len(points) == len(uv)
        is_over_the_picture(points, uv)
        assert (area(points, triangles) > 0).all()
        assert sorted(set(triangles.ravel())) == list(range(len(points)))
        hull = points[: mesh["hull"]]
        around = np.roll(hull, -1, axis=0)
        within = (hull[:, 0] * around[:, 1] - hull[:, 1] * around[:, 0]).sum() / 2
        assert within >= area(points, triangles).sum() - 1e-6
        edges = np.reshape(mesh["edges"], (-1, 2))
        assert (edges % 2 == 0).all()
        assert len(points) - len(edges) + len(triangles) == (0 if slot["name"] == "ring-1" else 1)


def scene_of(text):
    """Sections of a scene of Godot: (heading, {name: value})."""
    found = []
    for line in text.splitlines():
        if line.startswith("["):
            kind, rest = re.fullmatch(r"\[(\w+)(.*)\]", line).groups()
            pairs = re.findall(r'(\w+)=("(?:[^"\\]|\\.)*"|[^\s"]+)', rest)
            found.append((kind, {name: json.loads(value) for name, value in pairs}, {}))
        elif line:
            name, value = line.split(" = ", 1)
            found[-1][2][name] = value
    return found


def numbers(text, kind):
    return [
        [float(number) for number in group.split(",")] for group in re.findall(rf"{kind}\(([^)]*)\)", text)
    ]


def test_godot_reads_the_scene(folder):
    scene = scene_of((folder / "ring.tscn").read_text(encoding="utf-8"))
    assert scene[0][:2] == ("gd_scene", {"load_steps": 2, "format": 3})
    assert scene[1][:2] == ("ext_resource", {"type": "Texture2D", "path": "images/ring.png", "id": "1"})
    assert (folder / scene[1][1]["path"]).exists()
    nodes = [(head, body) for kind, head, body in scene if kind == "node"]
    assert nodes[0][0] == {"name": "ring", "type": "Node2D"}
    assert len({head["name"] for head, _ in nodes}) == 3
    for head, body in nodes[1:]:
        assert (head["type"], head["parent"]) == ("Polygon2D", ".")
        assert body["texture"] == 'ExtResource("1")'
        (points,), (uv,) = (
            numbers(body["polygon"], "PackedVector2Array"),
            numbers(body["uv"], "PackedVector2Array"),
        )
        points, uv = np.reshape(points, (-1, 2)), np.reshape(uv, (-1, 2))
        triangles = np.array(numbers(body["polygons"], "PackedInt32Array"), int)
        is_over_the_picture(points * [1, -1], uv / SIZE)
        assert (area(points * [1, -1], triangles) > 0).all()
        assert triangles.max() == len(points) - 1
        assert 0 < int(body["internal_vertex_count"]) < len(points)


def test_the_blend_file_stands_alone_and_its_sprite_can_be_updated(folder, tmp_path):
    import addon

    (tmp_path / "away").mkdir()
    moved = tmp_path / "away" / "ring.blend"
    moved.write_bytes((folder / "ring.blend").read_bytes())
    bpy.ops.wm.open_mainfile(filepath=str(moved))
    try:
        (ob,) = [ob for ob in bpy.data.objects if ob.type == "MESH"]
        (image,) = [image for image in bpy.data.images if image.size[0]]
        assert image.packed_file is not None
        assert tuple(image.size) == SIZE
        assert ob.dimensions.x == pytest.approx(0.85, abs=0.02)
        bpy.context.view_layer.objects.active = ob
        ob.select_set(True)
        faces = len(ob.data.polygons)
        if not hasattr(bpy.types, "OBJECT_OT_gridmesh_update_image"):
            addon.register()
        assert bpy.ops.object.gridmesh_update_image() == {"FINISHED"}
        # Of grids that are equally good on a ring, the last bits of Blender's own decoding choose.
        assert abs(len(ob.data.polygons) / faces - 1) < 0.05
    finally:
        empty_session()


def test_hostile_pictures_are_named_and_stop_nothing(tmp_path):
    noise = np.random.default_rng(5).integers(0, 256, (40, 40, 4), np.uint8)
    more = {
        "clear": (png(np.zeros((20, 20, 4), np.uint8)), "picture"),
        "one pixel": (png(np.full((1, 1, 4), 255, np.uint8)), None),
        "noise": (png(noise), None),
        "deep": (png(disk(deep=True)), "fine"),
        "cmyk": (jpeg([55, 255, 255, 255], 32), None),
        "good": (png(disk()), "fine"),
    }
    kinds = {}
    (tmp_path / "in").mkdir()
    for name, (data, kind) in {**hostile(), **more}.items():
        path = tmp_path / "in" / f"{name}.png"
        path.write_bytes(data)
        kinds[name] = kind
    ran = run("sprites", tmp_path / "in", "-o", f"{tmp_path}/out/{{name}}.glb", "--triangles", "200")
    assert ran.returncode == 1, ran.stdout + ran.stderr
    found = {Path(name).stem: result for name, result in results(tmp_path / "out").items()}
    assert found.keys() == kinds.keys()
    for name, kind in kinds.items():
        result = found[name]
        assert result.get("kind") != "crashed", result
        assert result["status"] != "error" or result["message"]
        if kind == "fine":
            assert result["status"] == "ok", result
        elif kind is not None:
            assert result["status"] == "error", result
            assert result["kind"] == kind, result
        assert (tmp_path / "out" / f"{name}.glb").exists() == (result["status"] != "error")


def many(folder, count=12):
    (folder / "in").mkdir(parents=True)
    for at in range(count):
        (folder / "in" / f"{at:02}.png").write_bytes(png(disk(48 + 2 * at, 15 + at)))
    return [
        {
            "id": f"{at}",
            "op": "sprites",
            "in": f"in/{at:02}.png",
            "out": f"out/{at:02}.{TEXTS[at % 4]}",
            "params": {"triangles": 200},
        }
        for at in range(count)
    ]


def all_files(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.process
def test_a_killed_run_is_resumed_to_the_same_bytes(tmp_path):
    path = write_jobs(tmp_path / "a", many(tmp_path / "a"))
    assert batch(path).returncode == 0
    whole = all_files(tmp_path / "a" / "out")
    path = write_jobs(tmp_path / "b", many(tmp_path / "b"))
    running = subprocess.Popen(command(path), cwd=ROOT, stdout=subprocess.PIPE, text=True)
    for line in running.stdout:
        if line.startswith("[5/"):
            running.kill()
            break
    running.wait()
    running.stdout.close()
    ran = batch(path, "--resume")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    skipped = int(re.search(r"(\d+) skipped", ran.stdout)[1])
    assert 4 <= skipped < 12
    assert all_files(tmp_path / "b" / "out") == whole
    (tmp_path / "b" / "out" / "images" / "03.png").unlink()
    assert "1 done, 0 failed, 11 skipped" in batch(path, "--resume").stdout
    assert all_files(tmp_path / "b" / "out") == whole


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"triangles": 0}, "triangles is 0; allowed: 1 or more"),
        ({"min_area": 1e9}, "all of its 2 islands are smaller than the least area; lower it"),
    ],
)
def test_refusals_name_no_labels_of_blender(tmp_path, params, words):
    (tmp_path / "a.png").write_bytes(png(two_parts()))
    words_of = [
        word for name, value in params.items() for word in (f"--{name.replace('_', '-')}", f"{value:g}")
    ]
    ran = run("sprites", tmp_path / "a.png", "-o", tmp_path / "a.glb", *words_of)
    assert ran.returncode == 1
    (result,) = results(tmp_path).values()
    assert result["message"] == words


def test_what_does_not_fit_is_refused_before_the_first_runs(tmp_path):
    (tmp_path / "a.png").write_bytes(png(disk()))
    for change in (
        {"out": "a.ply"},
        {"in": "a.gif"},
        {"object": "A"},
        {"params": {"margin": -1}},
        {"params": {"background": "sky"}},
    ):
        item = {"id": "a", "op": "sprites", "in": "a.png", "out": "a.glb"} | change
        assert batch(write_jobs(tmp_path, [item])).returncode == 2, change
    for change, said in (
        ({"params": {"depth": 2}}, "shape body"),
        ({"out": "a.tscn", "params": {"shape": "body"}}, "for flat sheets"),
    ):
        item = {"id": "a", "op": "sprites", "in": "a.png", "out": "a.glb"} | change
        ran = batch(write_jobs(tmp_path, [item]))
        assert ran.returncode == 1
        assert said in ran.stdout
