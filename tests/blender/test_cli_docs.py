"""What docs/batch.md shows is run."""

import json
import os
import re
import shlex
import subprocess
import sys

import pytest
from batches import ROOT, SHAPES, item, outputs, results, write_jobs

PAGE = (ROOT / "docs" / "batch.md").read_text(encoding="utf-8")
SVG = '<svg xmlns="http://www.w3.org/2000/svg"><circle cx="50" cy="50" r="40"/></svg>'


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.M | re.S)


def shim(folder):
    """A folder with a `blender` that is this Python with its `bpy` module."""
    folder.mkdir()
    program = folder / "blender"
    words = shlex.join([sys.executable, "-m", "addon"])
    program.write_text(
        "#!/bin/sh\n"
        'test "$1 $2 $3" = "--background --command gridmesh" || exit 99\n'
        "shift 3\n"
        f'PYTHONPATH={shlex.quote(str(ROOT))} exec {words} "$@"\n'
    )
    program.chmod(0o755)
    return {**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}


def test_the_script_of_ten_lines(tmp_path):
    (script,) = [block for block in blocks("python") if "bpy.ops" in block]
    assert len(list(filter(None, script.splitlines()))) == 10
    for name in ("a", "b"):
        (tmp_path / f"{name}.svg").write_text(SVG)
    look = (
        "import bpy, sys; sys.path.insert(0, sys.argv[2]); import addon; addon.register(); "
        "exec(compile(open(sys.argv[1]).read(), sys.argv[1], 'exec')); "
        "print('MADE', len([ob for ob in bpy.data.objects if ob.type == 'MESH']))"
    )
    (tmp_path / "bodies.py").write_text(script)
    words = [sys.executable, "-c", look, str(tmp_path / "bodies.py"), str(ROOT), str(tmp_path)]
    ran = subprocess.run(words, capture_output=True, text=True, check=False)
    assert "MADE 1" in ran.stdout, ran.stdout + ran.stderr
    assert (tmp_path / "a.blend").exists()
    assert (tmp_path / "b.blend").exists()


def test_the_jobs_are_jobs(tmp_path):
    from addon.cli import jobs

    (block,) = blocks("json")
    path = write_jobs(tmp_path, [json.loads(line) for line in block.splitlines()])
    assert [job.op for job in jobs.read(path)] == ["strokes", "fill", "regrid", "cut", "join"]


def test_every_option_of_the_page_is_one():
    from addon.cli import arguments, jobs, params

    parser = arguments._parser()
    batch = parser.parse_args(["batch", "jobs.jsonl"])
    table = re.findall(r"^\| `(--[a-z-]+)(?: ([^`]+))?` \|", PAGE, re.M)
    assert {option for option, _ in table} >= {"--resume", "--range", "--max-memory", "--disable-autoexec"}
    for option, value in table:
        parser.parse_args(["batch", "jobs.jsonl", option, *([value] if value else [])])
    for option in ("max_megabytes", "max_memory", "max_seconds"):
        assert f"`--{option.replace('_', '-')} {getattr(batch, option):g}`" in PAGE
    for op in params.OPS:
        for suffix in jobs.INPUTS[op]:
            assert f"`{suffix}`" in PAGE
    (commands, *_) = blocks("")
    for line in commands.splitlines():
        words = shlex.split(line)
        assert words[:4] == ["blender", "--background", "--command", "gridmesh"]
        parser.parse_args(words[4:])


@pytest.mark.skipif(os.name != "posix", reason="a shell")
def test_the_line_for_xargs_does_everything_once(tmp_path):
    (line,) = [block for block in blocks("sh") if "xargs" in block]
    line = line.replace("seq 0 100 999", "seq 0 2 5").replace("% + 99", "% + 1").replace("-P 8", "-P 2")
    write_jobs(tmp_path, [item(n, SHAPES / "bean.json", f"out/{n}.ply") for n in range(5)])
    ran = subprocess.run(
        line,
        shell=True,
        cwd=tmp_path,
        env=shim(tmp_path / "bin"),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert len(results(tmp_path)) == len(outputs(tmp_path)) == 5
    assert len(list(tmp_path.glob("*.report.jsonl"))) == 3


@pytest.mark.parametrize("scheduler", ["deadline", "flamenco"])
def test_the_lines_for_farms_run_their_ranges(tmp_path, scheduler):
    """The schedulers put a range in; what they then run is run here."""
    write_jobs(tmp_path, [item(n, SHAPES / "bean.json", f"out/{n}.ply") for n in range(4)])
    if scheduler == "deadline":
        (line,) = [block for block in blocks("sh") if "deadlinecommand" in block]
        words = shlex.split(line)
        arguments = (
            words[words.index("-arguments") + 1].replace("<STARTFRAME>", "1").replace("<ENDFRAME>", "2")
        )
        command = ["blender", *shlex.split(arguments.replace("/farm/jobs.jsonl", "jobs.jsonl"))]
    else:
        (script,) = blocks("js")
        fixed = json.loads(re.search(r"args: (\[.*?\])\.concat\(batch\)", script)[1])
        rest = re.search(r"const batch = \[(.*?)\];", script)[1].split(", ")
        values = {"job.settings.jobs": "jobs.jsonl", "range": "1-2"}
        command = ["blender", *fixed, *(values.get(word, word.strip('"')) for word in rest)]
    ran = subprocess.run(
        command, cwd=tmp_path, env=shim(tmp_path / "bin"), capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert sorted(outputs(tmp_path)) == ["1.ply", "2.ply"]


def test_a_range_may_be_one_item(tmp_path):
    from addon.cli import jobs

    path = write_jobs(tmp_path, [item(n, SHAPES / "bean.json", f"out/{n}.ply") for n in range(4)])
    assert [job.id for job in jobs.select(jobs.read(path), "3", None)] == ["i3"]
    for wrong in ("3-", "2-1", "a", "-1"):
        with pytest.raises(jobs.JobError):
            jobs.select(jobs.read(path), wrong, None)
