# SPDX-License-Identifier: GPL-3.0-or-later
"""What may stand on the command line."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from . import jobs, runner


def main(argv: list[str]) -> int:
    """Run the command; 0 if all is done, 1 if some items failed, 2 if the input is bad, 130 if interrupted."""
    if argv[:1] == ["worker"]:
        from . import worker

        return worker.serve()
    try:
        chosen = _parser().parse_args(argv)
    except SystemExit as stop:  # Blender would leave at once
        return stop.code if isinstance(stop.code, int) else 2
    try:
        items = jobs.select(jobs.read(chosen.jobs), chosen.range, chosen.shard)
        report = chosen.report or _report_beside(chosen.jobs, chosen.shard, chosen.range)
        return runner.run(items, report, resume=chosen.resume, limit=chosen.max_megabytes * 1_000_000)
    except jobs.JobError as error:
        print(f"gridmesh: {error}", file=sys.stderr)
        return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("gridmesh", description="Smooth bodies from files of drawings.")
    verbs = parser.add_subparsers(required=True, metavar="COMMAND")
    batch = verbs.add_parser("batch", help="run a file of jobs, one JSON object a line")
    batch.add_argument("jobs", type=Path, help="file with one JSON object a line: id, op, in, params, out")
    batch.add_argument("--range", metavar="A-B", help="only items A to B, counted from 0, both included")
    batch.add_argument("--shard", metavar="K/N", help="only every Nth item, beginning with the Kth, from 1")
    batch.add_argument(
        "--resume", action="store_true", help="skip what the report says is done and unchanged"
    )
    batch.add_argument(
        "--report", type=Path, help="file with a line for each item (default: beside the jobs)"
    )
    batch.add_argument(
        "--max-megabytes", type=float, default=100.0, help="refuse larger input files (default: 100)"
    )
    return parser


def _report_beside(path: Path, shard: str | None, part: str | None) -> Path:
    suffix = f".shard-{shard.replace('/', '-of-')}" if shard else ""
    suffix += f".range-{part}" if part else ""
    return path.with_name(f"{path.stem}{suffix}.report.jsonl")
