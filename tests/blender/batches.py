"""Runs of the whole command line, in processes of their own."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
SHAPES = ROOT / "tests" / "sketches" / "shapes"
BAD = ROOT / "tests" / "sketches" / "bad"


def command(jobs, *options):
    return [sys.executable, "-m", "addon", "batch", str(jobs), *options]


def batch(jobs, *options):
    return run("batch", jobs, *options)


def run(*words):
    command = [sys.executable, "-m", "addon", *map(str, words)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def write_jobs(folder, items):
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "jobs.jsonl"
    path.write_text("".join(json.dumps(item) + "\n" for item in items), encoding="utf-8")
    return path


def item(at, source, out, **params):
    return {
        "id": f"i{at}",
        "op": "strokes",
        "in": str(source),
        "out": out,
        "params": {"triangles": 200, **params},
    }


def results(folder):
    lines = [
        line
        for path in folder.glob("*.report.jsonl")
        for line in path.read_text(encoding="utf-8").splitlines()
    ]
    return {result["id"]: result for result in map(json.loads, filter(None, lines))}


def outputs(folder):
    return {path.name: path.read_bytes() for path in (folder / "out").iterdir()}
