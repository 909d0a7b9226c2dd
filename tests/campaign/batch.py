"""A batch of random items, good and hostile, that nothing may stop.

    python tests/campaign/batch.py --items 500 --hostile 250 --seed 1 --kills 20

from the root of the checkout, by a Python with the `bpy` module. Good items must be ok, with true numbers and closed bodies; hostile ones
must have one line each; inputs stay as they were; no draft is left. Then the good items again: killed at random moments and
resumed, by two runs at once with one report, and with no room for the report.
"""

from __future__ import annotations

import argparse
import collections
import hashlib
import json
import os
import resource
import signal
import struct
import subprocess
import sys
import tempfile
from pathlib import Path
from time import monotonic

from batch_items import SUFFIXES, Item, Maker

ROOT = Path(__file__).parents[2]
LIMITS = ("--max-seconds", "30", "--max-memory", "2500", "--max-megabytes", "20")
# ------------------------------------------------------------------------------------------------ running


def command(jobs: Path, *options: str) -> list[str]:
    """The batch as a command line."""
    return [sys.executable, "-m", "addon", "batch", str(jobs), *LIMITS, *options]


def run(jobs: Path, *options: str, **how: object) -> subprocess.CompletedProcess:
    """Run a batch to its end."""
    return subprocess.run(
        command(jobs, *options),
        cwd=ROOT,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
        **how,
    )


def written(folder: Path, items: list[Item]) -> Path:
    """A file of these jobs."""
    path = folder / "jobs.jsonl"
    path.write_text("".join(json.dumps(item.job) + "\n" for item in items))
    return path


def lines_of(report: Path) -> list[dict]:
    """Lines of a report, every one of which must be whole."""
    data = report.read_bytes()
    require(not data or data.endswith(b"\n"), "the report ends in the middle of a line")
    return [json.loads(line) for line in data.splitlines()]


def require(good: bool, message: object) -> None:
    """Stop if this does not hold."""
    if not good:
        raise AssertionError(message)


def require_closed_ply(path: Path, triangles: int | None) -> None:
    """Whether a binary PLY is closed, and has so many triangles."""
    data = path.read_bytes()
    at = data.index(b"end_header\n") + 11
    head = data[:at].decode().splitlines()
    counts = {line.split()[1]: int(line.split()[2]) for line in head if line.startswith("element")}
    size = sum(
        {"float": 4, "uchar": 1}[line.split()[1]]
        for line in head
        if line.startswith("property") and "list" not in line
    )
    points = [data[at + k * size : at + k * size + 12] for k in range(counts["vertex"])]
    at += size * counts["vertex"]
    edges: collections.Counter = collections.Counter()
    for _ in range(counts["face"]):
        n = data[at]
        face = struct.unpack_from(f"<{n}I", data, at + 1)
        at += 1 + 4 * n
        for one, other in zip(face, face[1:] + face[:1], strict=True):
            edges[points[one], points[other]] += 1
    require(at == len(data), f"{path}: it is not whole")
    require(
        triangles is None or counts["face"] == triangles, f"{path}: {counts['face']} faces, not {triangles}"
    )
    require(all(edges[b, a] == count for (a, b), count in edges.items()), f"{path}: it is open")


def require_right(folder: Path, item: Item, line: dict) -> None:
    """Whether what came of an item is what must."""
    about = f"{item.what}: {line}"
    require(line["id"] == item.job["id"], about)
    require(line["status"] in item.statuses, about)
    require(line["status"] == "ok" or line["message"], about)
    out = folder / item.job["out"] if "\ud800" not in item.job["out"] else None
    if line["status"] == "error":
        return
    require(hashlib.sha256(out.read_bytes()).hexdigest() == line["digest"], about)
    if item.what.startswith("good") and out.suffix == ".ply":
        require_closed_ply(out, line["triangles"] if item.job["op"] == "strokes" else None)


def inputs_of(folder: Path) -> dict[str, tuple]:
    """What is in the inputs, so that a change shows."""
    found = {}
    for path in (folder / "in").iterdir():
        status = path.lstat()
        plain = path.is_file() and not path.is_symlink() and status.st_size < 10**7
        found[path.name] = (status.st_mode, status.st_size, path.read_bytes() if plain else None)
    return found


def require_no_drafts(folder: Path) -> None:
    """Whether nothing is left of what was being written."""
    left = list(folder.rglob(".gridmesh*"))
    require(not left, f"drafts are left: {left}")


def mixed(folder: Path, items: int, hostile: int, seed: int) -> tuple[list[Item], list[dict], float]:
    """Run good and hostile items in one batch, and check everything."""
    maker = Maker(folder, seed)
    made = [maker.hostile() if at < hostile else maker.good() for at in range(items)]
    maker.random.shuffle(made)
    jobs, before, started = written(folder, made), inputs_of(folder), monotonic()
    ran = run(jobs)
    require("Traceback" not in ran.stderr and ran.returncode in (0, 1), ran.stderr)
    lines = lines_of(folder / "jobs.report.jsonl")
    require(len(lines) == len(made), f"{len(lines)} lines of {len(made)}: {ran.stderr}")
    wrong = []
    for item, line in zip(made, lines, strict=True):
        try:
            require_right(folder, item, line)
        except AssertionError as error:
            wrong.append(str(error))
    require(not wrong, "\n".join([f"{len(wrong)} wrong:", *wrong]))
    failed = any(line["status"] == "error" for line in lines)
    require(ran.returncode == int(failed), f"exit code {ran.returncode}")
    require(inputs_of(folder) == before, "an input was changed")
    require((folder / "file").read_text() == "no folder", "a file was changed")
    require_no_drafts(folder)
    return made, lines, monotonic() - started


def outputs_of(folder: Path) -> dict[str, bytes]:
    """Everything that was written."""
    return {path.name: path.read_bytes() for path in (folder / "out").iterdir()}


def disturbed(folder: Path, items: int, kills: int, seed: int, only: str | None = None) -> dict[str, int]:
    """Run good items undisturbed, killed and resumed, twice at once, and without room for the report."""
    sure = folder / "sure"
    maker = Maker(sure, seed, only)
    made = [maker.good() for _ in range(items)]
    jobs, started = written(sure, made), monotonic()
    ran = run(jobs)
    require(ran.returncode == 0, ran.stdout + ran.stderr)
    seconds, right = monotonic() - started, outputs_of(sure)
    counts = {"items": items, "kills": 0, "torn lines taken back": 0}

    killed = _copied(folder / "killed", seed, items, only)
    while counts["kills"] < kills:
        words = command(killed, "--resume")
        with subprocess.Popen(
            words, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as process:
            try:
                process.wait(maker.random.uniform(0, seconds))
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                counts["kills"] += 1
        report = killed.with_name("jobs.report.jsonl")
        if maker.random.random() < 0.3 and report.exists() and report.stat().st_size:
            os.truncate(report, maker.random.randrange(report.stat().st_size))
            counts["torn lines taken back"] += 1
        if maker.random.random() < 0.3:
            for path in list(killed.parent.glob("out/*"))[:2]:
                path.write_bytes(path.read_bytes()[:100])
    ran = run(killed, "--resume")
    require(ran.returncode == 0, ran.stdout + ran.stderr)
    require(outputs_of(killed.parent) == right, "killed and resumed: other bytes")
    require({line["id"] for line in lines_of(report)} == {item.job["id"] for item in made}, "killed: ids")
    require_no_drafts(killed.parent)

    twice = _copied(folder / "twice", seed, items, only)
    pair = [
        subprocess.Popen(command(twice), cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(2)
    ]
    require([process.wait() for process in pair] == [0, 0], "two runs at once: exit codes")
    require(outputs_of(twice.parent) == right, "two runs at once: other bytes")
    lines = lines_of(twice.with_name("jobs.report.jsonl"))
    require({line["id"] for line in lines} == {item.job["id"] for item in made}, "two runs at once: ids")
    counts["lines of two runs"] = len(lines)
    require_no_drafts(twice.parent)

    full = _copied(folder / "full", seed, items, only)
    room = 1000
    ran = run(full, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)))
    require(ran.returncode == 1, ran.stdout + ran.stderr)
    lines = lines_of(full.with_name("jobs.report.jsonl"))
    require(0 < len(lines) < items, f"{len(lines)} lines")
    require("the report is not complete" in ran.stdout, ran.stdout)
    require_no_drafts(full.parent)
    ran = run(full, "--resume")
    require(ran.returncode == 0, ran.stdout + ran.stderr)
    require(outputs_of(full.parent) == right, "resumed after a full disk: other bytes")
    return counts


def _copied(folder: Path, seed: int, items: int, only: str | None) -> Path:
    """The same jobs in a folder of their own."""
    maker = Maker(folder, seed, only)
    return written(folder, [maker.good() for _ in range(items)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    for option, default in (
        ("--items", 500),
        ("--hostile", 250),
        ("--seed", 1),
        ("--kills", 20),
        ("--good", 30),
    ):
        parser.add_argument(option, type=int, default=default)
    parser.add_argument(
        "--only", choices=SUFFIXES, help="operation of all good items that are killed and resumed"
    )
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        if chosen.items:
            made, lines, seconds = mixed(folder / "mixed", chosen.items, chosen.hostile, chosen.seed)
            kinds = collections.Counter(
                (item.what, line["status"], line.get("kind") or "")
                for item, line in zip(made, lines, strict=True)
            )
            for (what, status, kind), count in sorted(kinds.items()):
                print(f"{count:5} {what}: {status} {kind}")
            print(f"{len(lines)} items, {chosen.hostile} hostile, {seconds:.0f} s; the slowest:")
            pairs = sorted(zip(made, lines, strict=True), key=lambda pair: -pair[1].get("milliseconds", 0))
            for item, line in pairs[:10]:
                print(
                    f"{line.get('milliseconds', 0):8} ms  {item.what}: {line['status']} {line['message'][:80]!r}"
                )
        if chosen.kills:
            print(disturbed(folder / "disturbed", chosen.good, chosen.kills, chosen.seed, chosen.only))


if __name__ == "__main__":
    main()
