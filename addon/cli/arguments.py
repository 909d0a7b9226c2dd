# SPDX-License-Identifier: GPL-3.0-or-later
"""What may stand on the command line."""

from __future__ import annotations

import argparse
import contextlib
import json
import sys
from pathlib import Path
from typing import Any

from . import jobs, listing, params, places, runner
from .process import Limits

_HELP = {
    "strokes": "make smooth bodies of closed strokes",
    "fill": "fill the holes of meshes",
    "regrid": "mesh areas of meshes anew with a regular grid",
    "cut": "cut meshes along a stroke",
    "join": "join all meshes of a file to one closed body",
    "sprites": "make meshes of pictures, with the picture on them",
}


def main(argv: list[str]) -> int:
    """Run the command; 0 if all is done, 1 if some items failed, 2 if the input is bad, 130 if interrupted."""
    if argv[:1] == ["worker"]:
        from . import worker

        return worker.serve(float(argv[1]))
    try:
        chosen = _parser().parse_args(argv)
    except SystemExit as stop:  # Blender would leave at once
        return stop.code if isinstance(stop.code, int) else 2
    try:
        of_jobs = chosen.jobs if chosen.op == "batch" else None
        items = jobs.read(of_jobs) if of_jobs is not None else _listed(chosen)
        items = jobs.select(items, chosen.range, chosen.shard)
        return runner.run(items, chosen.report or _report(chosen), _settings(chosen), of_jobs)
    except (jobs.JobError, OSError) as error:
        for line in str(error).splitlines():
            print(f"gridmesh: {places.shown(line)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:  # nothing runs yet
        return runner.INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "gridmesh",
        description="Bodies from drawings, filled holes, cut and joined meshes, and sprites, for any number of files.",
    )
    verbs = parser.add_subparsers(required=True, metavar="COMMAND", dest="op")
    for op, known in params.OPS.items():
        verb = verbs.add_parser(op, help=_HELP[op], description=f"{_HELP[op].capitalize()}.")
        endings = ", ".join(jobs.INPUTS[op])
        verb.add_argument("inputs", nargs="+", metavar="IN", help=f"files, folders or patterns: {endings}")
        verb.add_argument(
            "-o",
            "--out",
            required=True,
            help=f"file to write: {', '.join(jobs.OUTPUTS[op])}; with several inputs {listing.STEM} stands for each one's name",
        )
        verb.add_argument("--object", metavar="PATTERN", help="only objects whose name fits, as 'Leaf*'")
        for name, param in known.items():
            _add(verb, name, param)
        _add_common(verb)
    batch = verbs.add_parser("batch", help="run a file of jobs, one JSON object a line")
    batch.add_argument(
        "jobs", type=Path, help="file with one JSON object a line: id, op, in, object, params, out"
    )
    _add_common(batch)
    return parser


def _add(verb: argparse.ArgumentParser, name: str, param: params.Param) -> None:
    option = "--" + name.replace("_", "-")
    text = param.help.replace("%", "%%")
    if param.kind == "switch":
        verb.add_argument(option, action=argparse.BooleanOptionalAction, default=None, help=text)
    elif param.kind == "choice":
        verb.add_argument(option, choices=param.choices, help=text)
    elif param.kind == "text":
        verb.add_argument(option, metavar="NAME", help=text)
    elif param.kind == "file":
        verb.add_argument(option, metavar="FILE", help=f"{text}; {listing.STEM} stands for each input's name")
    elif param.kind == "stroke":
        verb.add_argument(option, type=_stroke, required=True, metavar="FILE|OBJECT|POINTS", help=text)
    elif param.kind == "numbers":
        verb.add_argument(option, type=_numbers, metavar="N,N,...", help=text)
    else:
        verb.add_argument(option, type=int if param.kind == "count" else float, metavar="N", help=text)


def _numbers(text: str) -> list[float]:
    try:
        return [float(number) for number in text.split(",")]
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"no numbers between commas: {text!r}") from error


def _stroke(text: str) -> Any:
    """Points if this is a JSON list, else a name."""
    if not text.lstrip().startswith("["):
        return text
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise argparse.ArgumentTypeError(f"no list of points: {error}") from error


def _add_common(verb: argparse.ArgumentParser) -> None:
    add = verb.add_argument_group("which items, and how").add_argument
    add("--range", metavar="A-B", help="only items A to B, counted from 0, both included")
    add("--shard", metavar="K/N", help="only every Nth item, beginning with the Kth, from 1")
    add("--resume", action="store_true", help="skip what the report says is done and unchanged")
    add("--report", type=Path, help="file with a line for each item (default: beside jobs or output)")
    add("--render", action="store_true", help="a picture of each output, beside it")
    add(
        "--engine",
        choices=("workbench", "cycles"),
        default="workbench",
        help="what renders (default: workbench)",
    )
    scripts = verb.add_mutually_exclusive_group()
    scripts.add_argument(
        "--disable-autoexec",
        action="store_false",
        dest="scripts",
        help=".blend files do not run scripts (default)",
    )
    scripts.add_argument("--enable-autoexec", action="store_true", dest="scripts", help=".blend files may")
    verb.set_defaults(scripts=False)
    add(
        "--allow-outside",
        action="store_true",
        help="glTF and OBJ files may refer to files outside their folder",
    )
    allowed = Limits()
    for option, default, least, text in (
        ("--max-megabytes", allowed.input_megabytes, 1e-6, "refuse larger input files"),
        ("--max-memory", allowed.memory_megabytes, 0.0, "megabytes of memory for an item, on Linux; 0: any"),
        ("--max-seconds", allowed.seconds, 0.0, "stop items that take longer; 0: none"),
    ):
        text = f"{text} (default: {default:g})"
        add(option, type=_Limit(least), default=default, metavar="N", help=text)


class _Limit:
    """A number within bounds, as type of an option."""

    most = 1e9

    def __init__(self, least: float) -> None:
        self.least = least

    def __call__(self, text: str) -> float:
        with contextlib.suppress(ValueError):
            if self.least <= (number := float(text)) <= self.most:  # false for nan
                return number
        raise argparse.ArgumentTypeError(f"{text!r} is no number from {self.least:g} to {self.most:g}")


def _listed(chosen: argparse.Namespace) -> list[jobs.Job]:
    given = {name: getattr(chosen, name) for name in params.OPS[chosen.op]}
    given = {name: value for name, value in given.items() if value is not None}
    return listing.listed(chosen.op, chosen.inputs, chosen.object, given, chosen.out)


def _settings(chosen: argparse.Namespace) -> runner.Settings:
    allowed = Limits(chosen.max_megabytes, chosen.max_memory, chosen.max_seconds)
    return runner.Settings(
        chosen.resume, allowed, chosen.scripts, chosen.render, chosen.engine, chosen.allow_outside
    )


def _report(chosen: argparse.Namespace) -> Path:
    """Where the report goes if it is not said."""
    suffix = f".shard-{chosen.shard.replace('/', '-of-')}" if chosen.shard else ""
    suffix += f".range-{chosen.range}" if chosen.range else ""
    if chosen.op == "batch":
        return chosen.jobs.with_name(f"{chosen.jobs.stem}{suffix}.report.jsonl")
    out = Path.cwd() / chosen.out
    stem = out.stem.replace(listing.STEM, chosen.op)
    folder = next(parent for parent in out.parents if listing.STEM not in str(parent))
    return folder / f"{stem}{suffix}.report.jsonl"
