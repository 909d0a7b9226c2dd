"""The scripted batch: files of jobs from strokes to bodies."""

import os
import re
import signal
import subprocess

import pytest
from batches import BAD, ROOT, SHAPES, batch, command, item, outputs, results, write_jobs

SAME = ("ply", "obj", "stl")
"""Formats of which the same meshes are the same bytes."""


def good(count=6):
    shapes = [SHAPES / f"{name}.json" for name in ("square", "circle", "bean", "star", "arrow", "dumbbell")]
    return [item(at, shapes[at % 6], f"out/{at}.{SAME[at % 3]}", depth=0.5 + 0.1 * at) for at in range(count)]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed")
    ran = batch(write_jobs(folder, good()))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return outputs(folder)


def test_every_format_is_written_and_resume_skips(tmp_path):
    suffixes = ("ply", "obj", "stl", "glb", "blend")
    path = write_jobs(tmp_path, [item(s, SHAPES / "bean.json", f"größe ü/a b.{s}") for s in suffixes])
    ran = batch(path)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    found = results(tmp_path)
    assert len(found) == 5
    assert all(result["status"] == "ok" and result["triangles"] > 300 for result in found.values())
    assert sorted(file.suffix[1:] for file in (tmp_path / "größe ü").iterdir()) == sorted(suffixes)
    assert "0 done, 0 failed, 5 skipped" in batch(path, "--resume").stdout
    (tmp_path / "größe ü" / "a b.stl").write_bytes(b"torn")
    assert "1 done, 0 failed, 4 skipped" in batch(path, "--resume").stdout


def test_bad_items_are_named_and_stop_nothing(tmp_path):
    big = tmp_path / "big.csv"
    with big.open("wb") as file:
        file.truncate(3_000_000)
    (tmp_path / "readonly").write_text("a file where a folder should be")
    (tmp_path / "noise.json").write_bytes(b"\xff\x00")
    sources = [
        tmp_path / "none.json",
        big,
        BAD / "not_a_number.json",
        BAD / "two_points.json",
        tmp_path / "noise.json",
    ]
    items = [item(at, source, f"out/{at}.ply") for at, source in enumerate(sources)]
    items.append(item("file", SHAPES / "square.json", "readonly/a.ply"))
    items.append(item("option", SHAPES / "square.json", "out/c.ply", depth=-1))
    items.append(item("last", SHAPES / "square.json", "out/last.ply"))
    ran = batch(write_jobs(tmp_path, items), "--max-megabytes", "1")
    assert ran.returncode == 1, ran.stdout + ran.stderr
    found = results(tmp_path)
    assert [result["status"] for result in found.values()] == ["error"] * 7 + ["ok"]
    assert all(found[one]["message"] for one in found if one != "ilast")
    assert list(outputs(tmp_path)) == ["last.ply"]


@pytest.mark.parametrize(
    "change",
    [
        {"op": "melt"},
        {"out": "a.txt"},
        {"params": {"x": 1}},
        {"params": {"depth": "deep"}},
        {"op": "fill"},
        {"object": 3},
    ],
)
def test_bad_jobs_are_refused_before_the_first_runs(tmp_path, change):
    ran = batch(write_jobs(tmp_path, [good()[0], good()[1] | change]))
    assert ran.returncode == 2
    assert "line 2" in ran.stderr
    assert not (tmp_path / "out").exists()


def test_all_bad_lines_are_named(tmp_path):
    path = write_jobs(tmp_path, [good()[0] | {"op": "melt"}, good()[1], good()[2] | {"in": 5}])
    path.write_text(path.read_text() + "{\n")
    ran = batch(path)
    assert ran.returncode == 2
    assert re.findall(r"line (\d):", ran.stderr) == ["1", "3", "4"]


@pytest.mark.process
def test_shards_and_ranges_are_the_whole(tmp_path, undisturbed):
    path = write_jobs(tmp_path, good())
    assert batch(path, "--range", "0-1").returncode == 0
    assert len(outputs(tmp_path)) == 2
    for shard in ("1/2", "2/2"):
        assert batch(path, "--shard", shard).returncode == 0
    assert outputs(tmp_path) == undisturbed


def test_killed_and_resumed_is_the_same(tmp_path, undisturbed):
    path = write_jobs(tmp_path, good())
    for lines in (1, 2):
        with subprocess.Popen(command(path, "--resume"), cwd=ROOT, stdout=subprocess.PIPE) as process:
            for _ in range(lines):
                process.stdout.readline()
            process.kill()
    ran = batch(path, "--resume")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert outputs(tmp_path) == undisturbed


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_signal_finishes_the_item_and_tells_how_to_resume(tmp_path, undisturbed):
    path = write_jobs(tmp_path, good())
    with subprocess.Popen(command(path), cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGTERM)
        rest = process.stdout.read()
    assert process.returncode == 130
    assert "--resume" in rest
    assert batch(path, "--resume").returncode == 0
    assert outputs(tmp_path) == undisturbed


def test_a_handler_of_blender_itself_is_not_put_back(tmp_path, monkeypatch):
    """A real Blender handles signals in C: Python is told None, and refuses to set that."""
    from addon.cli import runner

    asked = []
    monkeypatch.setattr(runner.signal, "signal", lambda number, handler: asked.append(handler))
    stop = runner._Stop(None)
    stop.forget()
    assert asked[2:] == [signal.SIG_DFL] * 2
