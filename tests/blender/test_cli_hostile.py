"""Items that mean harm: each gets its own line in the report, and none stops the run or takes what it likes."""

import json
import os
import signal
import subprocess
import sys

import bpy
import numpy as np
import pytest
from batches import BAD, ROOT, SHAPES, batch, command, item, outputs, results, run, write_jobs

SQUARE = SHAPES / "square.json"
MORE = """
import sys
print("@gridmesh {}", flush=True)
sys.stdin.readline()
sys.exit("memory allocation of 99 bytes failed")
"""

HEAD = '<svg xmlns="http://www.w3.org/2000/svg">'


def job(name, op, source, out=None, **params):
    return {"id": name, "op": op, "in": str(source), "params": params, "out": out or f"out/{name}.ply"}


def truncated(path, part):
    """A .blend file of which a part is left."""
    whole = path.with_name("whole.blend")
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.wm.save_as_mainfile(filepath=str(whole), copy=True)
    data = whole.read_bytes()
    path.write_bytes(data[: int(part * len(data))])
    return path


def lonely_triangles(path, n):
    """A PLY of n triangles that touch nothing: as many borders."""
    corners = np.array([[0, 0, 0], [0.4, 0, 0], [0, 0.4, 0]], "<f4")
    places = np.array(np.unravel_index(np.arange(n), (1000, 1000)), "<f4").T
    points = corners + np.pad(places, ((0, 0), (0, 1)))[:, None]
    faces = np.empty(n, [("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, np.arange(3 * n).reshape(-1, 3)
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {3 * n}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {n}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + points.astype("<f4").tobytes() + faces.tobytes())
    return path


def test_each_hostile_item_has_its_line(tmp_path):
    def write(name, text):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return name

    spaced = tmp_path / "mit Leerzeichen" / "Übung №1 日本.json"
    spaced.parent.mkdir()
    spaced.write_bytes(SQUARE.read_bytes())
    with (tmp_path / "long.svg").open("w") as file:
        file.write(f'{HEAD}<path d="M 0 0')
        file.truncate(3_000_000_000)  # sparse: nobody may read it
    items = [
        (job("truncated", "fill", truncated(tmp_path / "cut.blend", 0.5)), "load"),
        (job("truncated drawing", "strokes", tmp_path / "cut.blend"), "load"),
        (job("no blend", "fill", write("text.blend", "x" * 1000)), "load"),
        (job("empty file", "strokes", write("empty.svg", "")), "load"),
        (job("empty svg", "strokes", write("nothing.svg", f"{HEAD}</svg>")), "load"),
        (
            job("nan path", "strokes", write("nan.svg", f'{HEAD}<path d="M 0 0 L nan 9 L 9 9 z"/></svg>')),
            "load",
        ),
        (
            job(
                "nan points", "strokes", write("n.svg", f'{HEAD}<polygon points="0,0 nan,9 9,9 9,0"/></svg>')
            ),
            "load",
        ),
        (
            job("huge number", "strokes", write("1.svg", f'{HEAD}<path d="M 0 0 L 1e400 9 L 9 9 z"/></svg>')),
            "strokes",
        ),
        (job("no svg", "strokes", write("cut.svg", f'{HEAD}<path d="M 0')), "load"),
        (job("long path", "strokes", "long.svg"), "too_large"),
        (job("missing", "fill", "nowhere.ply"), "filenotfounderror"),
        (job("missing stroke", "cut", SHAPES / "none.ply", stroke="none.json"), "filenotfounderror"),
        (job("a folder", "strokes", "mit Leerzeichen.json"), "filenotfounderror"),
        (job("no mesh", "fill", write("text.ply", "ply\nformat ascii 1.0\nelement vertex 9")), "load"),
        (job("no gltf", "fill", write("text.gltf", "[]")), "load"),
        (job("a body", "strokes", SQUARE), None),
        (job("a body", "strokes", SQUARE, "out/other.ply"), "duplicate_id"),
        (job("same file", "strokes", SQUARE, "out/a body.ply"), "duplicate_out"),
        (job("crossing", "strokes", BAD / "not_a_number.json"), "strokes"),
        (job("spaces", "strokes", spaced, "auch hier/Übung №1 日本.ply"), None),
    ]
    ran = batch(write_jobs(tmp_path, [one for one, _ in items]))
    assert ran.returncode == 1, ran.stdout + ran.stderr
    lines = (tmp_path / "jobs.report.jsonl").read_text(encoding="utf-8").splitlines()
    found = list(map(json.loads, lines))
    assert [one["id"] for one in found] == [one["id"] for one, _ in items]
    for result, (one, kind) in zip(found, items, strict=True):
        assert result.get("kind") == kind, (one["id"], result)
        assert result["message"] or kind is None
        assert "\n" not in result["message"]
    assert list(outputs(tmp_path)) == ["a body.ply"]
    assert (tmp_path / "auch hier" / "Übung №1 日本.ply").exists()
    assert not list(tmp_path.rglob(".gridmesh*"))


@pytest.mark.process
@pytest.mark.skipif(sys.platform != "linux", reason="the limit is kept on Linux alone")
def test_very_many_holes_and_too_much_memory(tmp_path):
    lonely_triangles(tmp_path / "holes.ply", 300_000)
    items = [
        job("many", "fill", "holes.ply"),
        job("tried", "fill", "holes.ply", max_open_edges=9_999_999),
        item(3, SQUARE, "out/dense.ply", triangles=5_000_000),
        item(4, SQUARE, "out/last.ply"),
    ]
    path = write_jobs(tmp_path, items)
    megabytes = 800
    ran = batch(path, "--max-memory", str(megabytes), "--max-seconds", "300")
    assert ran.returncode == 1, ran.stdout + ran.stderr
    found = results(tmp_path)
    assert found["many"]["kind"] == "too_many_holes"
    assert found["tried"]["kind"] == "out_of_memory"
    assert found["i3"]["kind"] == "out_of_memory"
    assert found["i4"]["status"] == "ok"
    # Libraries and the file's own pages come on top of what is limited.
    assert max(one.get("peak_megabytes") or 0 for one in found.values()) < megabytes + 500


def test_two_signals_end_a_run_with_its_report_whole(tmp_path):
    items = [
        item(1, SQUARE, "out/a.ply"),
        item(2, SQUARE, "out/long.ply", triangles=5_000_000),
        item(3, SQUARE, "out/b.ply"),
    ]
    path = write_jobs(tmp_path, items)
    words = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command(path, "--max-seconds", "0"), cwd=ROOT, **words) as process:
        assert "ok i1" in process.stdout.readline()
        process.send_signal(signal.SIGINT)
        assert process.stderr.readline() == "\n"
        process.send_signal(signal.SIGTERM)
        process.stdout.read()
    assert process.returncode == 130
    found = {one: result["status"] for one, result in results(tmp_path).items()}
    assert found in ({"i1": "ok", "i2": "error"}, {"i1": "ok"}), (
        "the first signal may come before the second item"
    )
    assert list(outputs(tmp_path)) == ["a.ply"]


def test_names_that_are_no_unicode_are_inputs_and_outputs(tmp_path):
    """All items are done, whatever reads and writes them; the report names them in escapes."""
    name = os.fsdecode(b"caf\xe9")
    (tmp_path / f"{name}.json").write_bytes(SQUARE.read_bytes())
    (tmp_path / f"{name}.svg").write_text(f'{HEAD}<circle cx="50" cy="50" r="40"/></svg>')
    suffixes = ("ply", "obj", "stl", "glb", "blend")
    items = [
        job(f"{name} {s}", "strokes", f"{name}.json", f"out/{name}.{s}", triangles=100) for s in suffixes
    ]
    items += [job(f"{name} back {s}", "fill", f"out/{name}.{s}", f"back/{name}{s}.{s}") for s in suffixes]
    items += [job(f"{name} svg", "strokes", f"{name}.svg", f"{name}.ply", triangles=100)]
    ran = batch(write_jobs(tmp_path, items))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert list(results(tmp_path)) == [one["id"] for one in items]
    ran = run("strokes", tmp_path, "-o", tmp_path / "many" / "{name}.ply", "--triangles", "100")
    assert ran.returncode == 1, "two inputs have the same name"
    assert [one["status"] for one in results(tmp_path / "many").values()] == ["ok", "error"]


def test_damaged_meshes_and_such_without_faces_are_not_ok(tmp_path):
    def write(name, data):
        (tmp_path / name).write_bytes(data)
        return name

    head = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    points = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    cases = [
        ("error", write("cut.stl", bytes(80) + b"\xe8\3\0\0" + bytes(100))),
        ("error", write("noise.stl", bytes(range(256)) * 9)),
        ("warning", write("points.ply", head + b"end_header\n" + np.eye(3, dtype="<f4").tobytes())),
        ("warning", write("points.obj", points)),
        ("warning", write("none.stl", bytes(84))),
        ("warning", write("half.obj", points + b"f 1 2 3\nf 1 2")),
        ("error", write("missing.obj", points + b"f 1 2 3\nf 1 2 9\n")),
        ("error", write("nan.obj", points + b"v nan 0 0\nf 1 2 3\nf 3 4 5\n")),
        ("ok", write("back.obj", points + b"f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -2 -4 -1\n")),
        ("ok", write("whole.obj", points + b"f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")),
    ]
    ran = batch(write_jobs(tmp_path, [job(name, "fill", name) for _, name in cases]))
    assert ran.returncode == 1, ran.stdout + ran.stderr
    found = [(one["status"], name) for name, one in results(tmp_path).items()]
    assert found == cases, ran.stdout


def test_an_item_without_end_is_no_item_of_the_runner(tmp_path):
    """Devices and pipes, by links, as buffers, as strokes and as what was written before."""
    os.mkfifo(tmp_path / "pipe.ply")
    (tmp_path / "zero.ply").symlink_to("/dev/zero")
    (tmp_path / "uri.gltf").write_text('{"buffers": [{"byteLength": 9, "uri": "/dev/zero"}]}')
    (tmp_path / "nul.gltf").write_text('{"buffers": [{"byteLength": 9, "uri": "a%00.bin"}]}')
    (tmp_path / "out").mkdir()
    os.mkfifo(tmp_path / "out" / "last.ply")
    items = [job(name, "fill", name) for name in ("pipe.ply", "zero.ply", "uri.gltf", "nul.gltf")]
    items.append(job("stroke", "cut", SHAPES / "none.ply", stroke="pipe.csv"))
    items.append(item("last", SQUARE, "out/last.ply"))
    path = write_jobs(tmp_path, items)
    ran = batch(path)
    assert ran.returncode == 1, ran.stdout + ran.stderr
    kinds = [one.get("kind") for one in results(tmp_path).values()]
    assert kinds == ["not_a_file", "not_a_file", "outside", "bad_path", "filenotfounderror", None]
    (tmp_path / "out" / "last.ply").unlink()
    os.mkfifo(tmp_path / "out" / "last.ply")
    assert "1 done, 5 failed, 0 skipped" in batch(path, "--resume").stdout


@pytest.mark.process
def test_items_that_take_too_long_are_stopped(tmp_path):
    # On a slow machine Blender itself takes as long to start; that does not count.
    items = [item(1, SQUARE, "out/dense.ply", triangles=5_000_000), item(2, SQUARE, "out/last.ply")]
    ran = batch(write_jobs(tmp_path, items), "--max-seconds", "4")
    assert ran.returncode == 1, ran.stdout + ran.stderr
    found = results(tmp_path)
    assert found["i1"]["kind"] == "stopped"
    assert "--max-seconds" in found["i1"]["message"]
    assert found["i2"]["status"] == "ok"


@pytest.fixture
def mounted(tmp_path):
    """A small disk; skipped where none can be had."""
    folder = tmp_path / "disk"
    folder.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", folder], check=False)
    if made.returncode:
        pytest.skip("only root can mount a small disk")
    yield folder
    subprocess.run(["umount", folder], check=True)


def test_a_full_disk_leaves_no_half_file(tmp_path, mounted):
    # Blender's exporters of PLY, OBJ and STL say that all is well.
    suffixes = ("ply", "obj", "stl", "glb", "blend")
    items = [item(s, SHAPES / "bean.json", f"disk/{s}.{s}", triangles=3000) for s in suffixes]
    items.append(item("small", SHAPES / "bean.json", "disk/small.ply", triangles=100))
    items.append(item("elsewhere", SHAPES / "bean.json", "out/a.ply", triangles=100))
    path = write_jobs(tmp_path, items)
    ran = batch(path)
    assert ran.returncode == 1, ran.stdout + ran.stderr
    found = results(tmp_path)
    assert [one["status"] for one in found.values()] == ["error"] * 5 + ["ok"] * 2, found
    assert sorted(file.name for file in mounted.iterdir()) == ["small.ply"]
    subprocess.run(["mount", "-o", "remount,size=64m", mounted], check=True)
    assert "5 done, 0 failed, 2 skipped" in batch(path, "--resume").stdout


def test_a_report_on_a_full_disk_stops_nothing(tmp_path, mounted):
    items = [item(n, SQUARE, f"out/{n}.ply") for n in range(3)]
    (mounted / "filler").write_bytes(b"x" * 60_000)
    (mounted / "rest").write_bytes(b"x" * 4_000)
    ran = batch(write_jobs(tmp_path, items), "--report", str(mounted / "report.jsonl"))
    assert ran.returncode in (1, 2), ran.stdout + ran.stderr
    if ran.returncode == 1:
        assert "the report is not complete" in ran.stdout
        assert len(outputs(tmp_path)) == 3


def test_a_read_only_folder_is_named(tmp_path, mounted):
    subprocess.run(["mount", "-o", "remount,ro", mounted], check=True)
    items = [item(1, SQUARE, "disk/a.ply"), item(2, SQUARE, "disk/new/a.ply"), item(3, SQUARE, "out/a.ply")]
    ran = batch(write_jobs(tmp_path, items))
    assert ran.returncode == 1, ran.stdout + ran.stderr
    statuses = [(one["status"], "ead-only" in one["message"]) for one in results(tmp_path).values()]
    assert statuses == [("error", True), ("error", True), ("ok", False)]


@pytest.mark.parametrize("allowed", [False, True])
def test_blend_files_run_scripts_only_if_they_may(tmp_path, allowed):
    bpy.ops.mesh.primitive_cube_add()
    text = bpy.data.texts.new("run.py")
    text.use_module = True
    text.write(f"import pathlib\npathlib.Path({str(tmp_path / 'ran')!r}).touch()\n")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scripted.blend"), copy=True)
    option = "--enable-autoexec" if allowed else "--disable-autoexec"
    ran = run("fill", tmp_path / "scripted.blend", "-o", tmp_path / "out.ply", option)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert (tmp_path / "ran").exists() == allowed


def test_a_reader_that_goes_away_stops_nothing(tmp_path):
    path = write_jobs(tmp_path, [item(n, SQUARE, f"out/{n}.ply") for n in range(3)])
    with subprocess.Popen(command(path), cwd=ROOT, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        process.stdout.close()
    assert process.returncode == 0
    assert len(outputs(tmp_path)) == 3


@pytest.mark.skipif(os.name != "posix", reason="terminals")
def test_a_terminal_shows_a_bar_and_only_what_went_wrong(tmp_path):
    import pty

    items = [item(n, SQUARE, f"out/{n}.ply") for n in range(3)]
    items.insert(1, item("bad", "none\x1b[31m.json", "out/none.ply"))
    owner, terminal = pty.openpty()
    with subprocess.Popen(command(write_jobs(tmp_path, items)), cwd=ROOT, stdout=terminal) as process:
        os.close(terminal)
        shown = b""
        while True:
            try:
                part = os.read(owner, 4096)
            except OSError:  # how a terminal ends
                break
            if not part:
                break
            shown += part
    os.close(owner)
    assert process.returncode == 1
    text = shown.decode()
    assert "4/4, 1 failed" in text
    assert "error ibad" in text
    assert "ok i0" not in text
    assert "\x1b[31m" not in text


def test_a_worker_that_does_not_start_is_told(tmp_path, monkeypatch):
    from addon.cli import process

    monkeypatch.setattr(process, "_command", lambda **_: [sys.executable, "-c", "raise SystemExit('no bpy')"])
    worker = process.Worker(process.Limits(), scripts=False)
    for _ in range(2):
        answer = worker.do({})
        assert answer["kind"] == "crashed"
        assert "no bpy" in answer["message"]
    worker.close()


def test_an_item_that_kills_its_worker_stops_nothing(tmp_path, monkeypatch):
    from addon.cli import process

    kill = "import sys; print('@gridmesh {}', flush=True); sys.stdin.readline(); __import__('os').abort()"
    monkeypatch.setattr(process, "_command", lambda **_: [sys.executable, "-c", kill])
    worker = process.Worker(process.Limits(), scripts=False)
    answer = worker.do({})
    assert answer["kind"] == "crashed"
    monkeypatch.setattr(process, "_command", lambda **_: [sys.executable, "-c", MORE])
    answer = worker.do({})
    assert answer["kind"] == "out_of_memory"
    worker.close()
