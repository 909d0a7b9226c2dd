"""Bones of sprites: what files of them say, and that Spine and Godot find the same sprite, at rest and bent."""

import json
import math
import re
from dataclasses import replace

import gridmesh
import numpy as np
import pytest

from addon.pictures.cutouts import Options, cut_out
from addon.pictures.formats import godot, rig, spine
from addon.pictures.formats.sheet import Sheet

WIDTH, HEIGHT = 120, 80
BONES = [
    {"name": "hand", "parent": "arm", "head": [70, 40], "tail": [100, 30]},  # before its parent
    {"name": "arm", "head": [15, 40], "tail": [70, 40]},
    {"name": "root", "parent": None, "head": [60, 70], "tail": [60, 78]},
]


def as_file(bones):
    return json.dumps({"bones": bones}).encode()


def sheet_with(bones):
    """A bar with a button below it."""
    y, x = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    bar = (abs(x - 60) < 50) & (abs(y - 40) < 10)
    button = np.hypot(x - 60, y - 68) < 8
    pixels = np.dstack([np.zeros((HEIGHT, WIDTH, 3)), bar | button])
    cutout = cut_out(pixels, Options(threshold=0.5, margin=1.0, triangles=300))
    sheet = Sheet("bar", cutout, WIDTH, HEIGHT, b"", ".png", True, True)
    return replace(sheet, rig=rig.weighed(cutout, sheet.points, rig.read(as_file(bones), WIDTH, HEIGHT)))


@pytest.fixture(scope="module")
def sheet():
    return sheet_with(BONES)


def turned(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def bent(sheet, turns):
    """Places of the vertices, the bones of these names turned around their heads, children with them."""
    at = {}
    moved = np.zeros((len(sheet.points), 2))
    for k, bone in enumerate(sheet.rig.bones):
        matrix, shift = at.get(bone.parent, (np.eye(2), np.zeros(2)))
        own = turned(turns.get(bone.name, 0.0))
        head = np.array(bone.head)
        at[k] = matrix @ own, matrix @ (head - own @ head) + shift
        moved += sheet.rig.weights[:, k : k + 1] * (sheet.points[:, :2] @ at[k][0].T + at[k][1])
    return moved


def spine_places(text, turns):
    """Vertices of each slot, as Spine's runtimes compute them."""
    world = []
    for bone in text["bones"]:
        angle = math.radians(bone.get("rotation", 0.0)) + turns.get(bone["name"], 0.0)
        local, place = turned(angle), np.array([bone.get("x", 0.0), bone.get("y", 0.0)])
        if "parent" in bone:
            names = [other["name"] for other in text["bones"][: len(world)]]
            matrix, shift = world[names.index(bone["parent"])]
            local, place = matrix @ local, matrix @ place + shift
        world.append((local, place))
    (skin,) = text["skins"]
    for slot in text["slots"]:
        mesh = skin["attachments"][slot["name"]][slot["attachment"]]
        values = iter(mesh["vertices"])
        points, sums = [], []
        for _ in range(len(mesh["uvs"]) // 2):
            point, total = np.zeros(2), 0.0
            for _ in range(next(values)):
                matrix, shift = world[next(values)]
                local, weight = np.array([next(values), next(values)]), next(values)
                point += weight * (matrix @ local + shift)
                total += weight
            points.append(point)
            sums.append(total)
        assert next(values, None) is None
        yield np.array(points), np.array(sums)


def godot_nodes(text):
    """(name, type, parent, properties) of each node."""
    for block in re.split(r"^\[node ", text, flags=re.M)[1:]:
        head, _, body = block.partition("]\n")
        named = {key: json.loads(value) for key, value in re.findall(r'(\w+)=("(?:[^"\\]|\\.)*")', head)}
        lines = [line.split(" = ", 1) for line in body.splitlines() if " = " in line]
        yield named["name"], named["type"], named.get("parent"), dict(lines)


def inside(value):
    return [float(number) for number in re.search(r"\(([^)]*)\)", value)[1].split(",")]


def godot_places(text, turns):
    """Vertices of each polygon, as Godot computes them: transforms of the bones times the inverse ones at rest."""
    moved, rest = {"": np.eye(3)}, {"": np.eye(3)}
    polygons = []
    for name, kind, parent, values in godot_nodes(text):
        if kind == "Skeleton2D":
            skeleton = name
            assert parent == "."
        elif kind == "Bone2D":
            above = parent.removeprefix(skeleton).removeprefix("/")
            path = f"{above}/{name}".removeprefix("/")
            assert path not in moved
            a, b, c, d, x, y = inside(values["rest"])
            own = np.array([[a, c, x], [b, d, y], [0, 0, 1]])
            angle = float(values["rotation"])
            assert own[:2, :2] == pytest.approx(turned(angle), abs=1e-6)
            assert inside(values["position"]) == pytest.approx([x, y])
            posed = own.copy()
            posed[:2, :2] = turned(angle - turns.get(name, 0.0))
            rest[path], moved[path] = rest[above] @ own, moved[above] @ posed
        elif kind == "Polygon2D":
            assert values["skeleton"] == f'NodePath("../{skeleton}")'
            points = np.reshape(inside(values["polygon"]), (-1, 2))
            found = re.findall(r'"((?:[^"\\]|\\.)*)", PackedFloat32Array\(([^)]*)\)', values["bones"])
            sums, places = 0.0, 0.0
            for path, weights in found:
                weights = np.array([float(weight) for weight in weights.split(",")])
                assert len(weights) == len(points)
                matrix = moved[path] @ np.linalg.inv(rest[path])
                places = places + weights[:, None] * (points @ matrix[:2, :2].T + matrix[:2, 2])
                sums = sums + weights
            polygons.append((places * [1, -1], sums))
    return polygons


@pytest.mark.parametrize("turns", [{}, {"arm": 0.5}, {"hand": 1.0}, {"arm": -0.4, "hand": 1.0}])
def test_spine_and_godot_bend_the_sprite_alike(sheet, turns, tmp_path):
    spine.write(tmp_path / "bar.json", sheet, "bar")
    godot.write(tmp_path / "bar.tscn", sheet, "bar.png")
    wanted = bent(sheet, turns)
    text = json.loads((tmp_path / "bar.json").read_text(encoding="utf-8"))
    scene = (tmp_path / "bar.tscn").read_text(encoding="utf-8")
    for found in (list(spine_places(text, turns)), godot_places(scene, turns)):
        assert len(found) == 2
        points, sums = (np.concatenate(column) for column in zip(*found, strict=True))
        assert points == pytest.approx(wanted, abs=2e-3)
        assert sums == pytest.approx(1.0, abs=1e-6)
    if turns:
        assert np.abs(wanted - sheet.points[:, :2]).max() > 5


def test_weights_are_those_of_the_module(sheet):
    ends = np.array([[bone.head, bone.tail] for bone in sheet.rig.bones])
    wanted = gridmesh.bone_weights(sheet.points[:, :2], sheet.cutout.faces, ends)
    assert sheet.rig.weights == pytest.approx(wanted, abs=2e-6)
    assert sheet.rig.weights.sum(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert ((sheet.rig.weights > 0).sum(axis=1) <= 4).all()
    assert [bone.name for bone in sheet.rig.bones] == ["arm", "hand", "root"]
    assert sheet.rig.bones[0].head == (15 - WIDTH / 2, HEIGHT - 40)


def test_names_that_would_collide_are_told_apart(tmp_path):
    bones = [
        {"name": "a.b", "head": [15, 40], "tail": [60, 40]},
        {"name": "a:b", "head": [60, 40], "tail": [100, 40]},
    ]
    sheet = replace(sheet_with(bones), name="Skeleton2D")
    godot.write(tmp_path / "bar.tscn", sheet, "bar.png")
    nodes = list(godot_nodes((tmp_path / "bar.tscn").read_text(encoding="utf-8")))
    places = [(parent, name) for name, _, parent, _ in nodes]
    assert len(set(places)) == len(places)
    assert len(list(godot_places((tmp_path / "bar.tscn").read_text(encoding="utf-8"), {}))) == 2
    spine.write(tmp_path / "bar.json", sheet_with(BONES), "bar")
    names = [bone["name"] for bone in json.loads((tmp_path / "bar.json").read_text())["bones"]]
    assert names == ["root_", "arm", "hand", "root"]


GOOD = {"name": "a", "head": [0, 0], "tail": [5, 5]}


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"\xff", "no JSON"),
        (b"[" * 100_000, "no JSON"),
        (b"[]", "1 to 256 bones"),
        (as_file([]), "1 to 256 bones"),
        (as_file([GOOD] * 257), "1 to 256 bones"),
        (as_file([GOOD, GOOD]), "two bones are named 'a'"),
        (as_file([5]), "bone 0 has no name"),
        (as_file([{**GOOD, "name": " "}]), "bone 0 has no name"),
        (as_file([{**GOOD, "weight": 1}]), "has 'weight'"),
        (as_file([{**GOOD, "parent": 3}]), "the parent of bone 'a'"),
        (as_file([{**GOOD, "parent": "b"}]), "the parent 'b' of bone 'a'"),
        (as_file([{**GOOD, "parent": "a"}]), "its own ancestor"),
        (as_file([{**GOOD, "head": [0, float("nan")]}]), "the head of bone 'a'"),
        (as_file([{**GOOD, "tail": [0, 1e300]}]), "the tail of bone 'a'"),
        (as_file([{**GOOD, "tail": [0, 0]}]), "in the same place"),
    ],
)
def test_what_is_no_file_of_bones_is_named(data, said):
    with pytest.raises(rig.RigError, match=re.escape(said)):
        rig.read(data, WIDTH, HEIGHT)
