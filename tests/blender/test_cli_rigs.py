"""Sprites with bones on the command line."""

import json
import sys

import pytest
from batches import ROOT, batch, results, run, write_jobs

sys.path.append(str(ROOT / "tests" / "core"))

from picture_files import disk, png

BONES = [
    {"name": "low", "head": [16, 28], "tail": [16, 16]},
    {"name": "high", "parent": "low", "head": [16, 16], "tail": [16, 4]},
]


def written(folder, names=("a", "b")):
    for name in names:
        (folder / f"{name}.png").write_bytes(png(disk()))
        (folder / f"{name}-bones.json").write_text(json.dumps({"bones": BONES}))


def bones_of(path):
    return [bone["name"] for bone in json.loads(path.read_text(encoding="utf-8"))["bones"]]


def test_each_picture_has_its_own_bones(tmp_path):
    written(tmp_path)
    (tmp_path / "b-bones.json").write_text(json.dumps({"bones": BONES[:1]}))
    words = ("-o", f"{tmp_path}/out/{{name}}.json", "--bones", f"{tmp_path}/{{name}}-bones.json")
    ran = run("sprites", tmp_path / "a.png", tmp_path / "b.png", *words, "--triangles", "200")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert bones_of(tmp_path / "out" / "a.json") == ["root", "low", "high"]
    assert bones_of(tmp_path / "out" / "b.json") == ["root", "low"]


def test_other_bones_are_other_work(tmp_path):
    written(tmp_path, "a")
    item = {"id": "a", "op": "sprites", "in": "a.png", "out": "a.tscn", "params": {"bones": "a-bones.json"}}
    path = write_jobs(tmp_path, [item])
    assert batch(path).returncode == 0
    assert (tmp_path / "a.tscn").read_text(encoding="utf-8").count('type="Bone2D"') == 2
    assert "1 skipped" in batch(path, "--resume").stdout
    (tmp_path / "a-bones.json").write_text(json.dumps({"bones": BONES[:1]}))
    assert "1 done" in batch(path, "--resume").stdout
    assert (tmp_path / "a.tscn").read_text(encoding="utf-8").count('type="Bone2D"') == 1


@pytest.mark.parametrize(
    ("bones", "out", "said", "code"),
    [
        ("a-bones.json", "a.glb", "bones are for .json and .tscn", 2),
        ("none.json", "a.json", "none.json", 1),
        ("wrong.json", "a.json", "bones of 'wrong.json'", 1),
    ],
)
def test_bones_that_are_none_are_named(tmp_path, bones, out, said, code):
    written(tmp_path, "a")
    (tmp_path / "wrong.json").write_text('{"bones": [{"name": "a", "head": [1, 2]}]}')
    item = {"id": "a", "op": "sprites", "in": "a.png", "out": out, "params": {"bones": bones}}
    ran = batch(write_jobs(tmp_path, [item]))
    assert ran.returncode == code
    assert said in ran.stdout + ran.stderr
    if code == 1:
        assert results(tmp_path)["a"]["status"] == "error"
        assert not (tmp_path / out).exists()
