"""Every outline of a corpus at several sizes, flat and as a body, in triangles and quads; every promise is checked.

    python tests/campaign/outlines.py CORPUS.jsonl JOURNAL.jsonl [--every 1] [--triangles 500 2000 10000] [--quads 1000]
        [--processes 1] [--worst 50] [--summary]

`corpus.py` makes the corpus. One line of the journal for each outline and size; outlines that are in it are not done
again, so it can be stopped at any time. `--summary` only sums up. Refusals count, and a number that a refusal gives
is tried. With --worst that many outlines with the least angles are drawn to JOURNAL.svg.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gridmesh
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "core"))

from checks import check_body, check_patch, sticking_out
from json_lines import outlines, resumed, rows_of
from quad_checks import check_quad_body, check_quad_patch

Task = tuple[str, list[list[float]], list[list[list[float]]], str, int]
SLOW = 20
"""So many times the median of its size is a long time."""
REASONS = ("too_coarse", "too_large")
"""Refusals that are allowed: the number of cells does not suit the outline."""


def meshed(outer: np.ndarray, holes: list[np.ndarray], cells: str, count: int) -> Any:
    """The patch of an outline."""
    return gridmesh.mesh_sketch(outer, holes, **{cells: count})


def checked(patch: Any, contours: list[np.ndarray], cells: str) -> Any:
    """The body of a patch, after both are checked."""
    if cells == "quads":
        check_quad_patch(patch, contours)
        body = gridmesh.inflate(patch)
        check_quad_body(body, patch, len(contours) - 1)
    else:
        check_patch(patch, contours)
        body = gridmesh.inflate(patch)
        check_body(body, patch)
    return body


def done(task: Task) -> dict[str, Any]:
    """A line of the journal."""
    name, outer, holes, cells, count = task
    contours = [np.array(outer), *map(np.array, holes)]
    row: dict[str, Any] = {"name": name, "cells": cells, "count": count}
    since = time.process_time()
    try:
        patch = meshed(contours[0], contours[1:], cells, count)
        row["cpu"] = time.process_time() - since
        body = checked(patch, contours, cells)
        report = patch.report
        row |= {
            "irregular": report.get("irregular", report.get("poles")) / len(patch.vertices),
            "angle": float(np.degrees(report["min_angle"])),
            "body_angle": float(np.degrees(body.report["min_angle"])),
            "sticks_out": max(sticking_out(body), 0.0),
            "deviation": report["max_deviation"],
            "meets_itself": not body.report["embedded"],
            "states": report["search_states"],
        }
    except gridmesh.GridMeshError as refusal:
        row["cpu"] = time.process_time() - since
        row["refused"], row["words"] = refusal.kind, str(refusal)
        works = str(refusal).partition("; ")[2].split(" work")[0]
        if refusal.kind == "too_coarse" and works.isdecimal():
            try:
                row["suggested"] = int(works)
                checked(meshed(contours[0], contours[1:], cells, int(works)), contours, cells)
            except (gridmesh.GridMeshError, AssertionError) as wrong:
                row["wrong"] = f"{works} {cells} were said to work: {wrong}"
        elif refusal.kind not in REASONS:
            row["wrong"] = str(refusal)
    except AssertionError as wrong:
        row["wrong"] = f"{wrong}" or "a check failed"
    return row


def tasks(corpus: Path, every: int, kinds: list[tuple[str, int]], known: set) -> Iterator[Task]:
    """What is not in the journal yet."""
    for name, outline in outlines(corpus, every):
        for cells, count in kinds:
            if (name, cells, count) not in known:
                yield name, outline["outer"], outline["holes"], cells, count


def summed_up(rows: list[dict[str, Any]]) -> None:
    """Print tails, refusals, and everything that is wrong."""
    kinds = defaultdict(list)
    for row in rows:
        kinds[row["cells"], row["count"]].append(row)
    for (cells, count), own in sorted(kinds.items()):
        fine = [row for row in own if "angle" in row]
        refused = Counter(row["refused"] for row in own if "refused" in row)
        advised = sum("suggested" in row for row in own)
        print(
            f"\n{count} {cells}: {len(own)} outlines, {len(fine)} meshed, refused {dict(refused)}, advised {advised}"
        )
        for key, unit in (
            ("angle", 1),
            ("body_angle", 1),
            ("irregular", 100),
            ("deviation", 1),
            ("sticks_out", 1),
            ("cpu", 1000),
        ):
            values = np.sort([unit * row[key] for row in fine if key in row])
            if not len(values):
                continue
            low = key.endswith("angle")
            at = [50, 5, 1] if low else [50, 95, 99]
            worst = values[0] if low else values[-1]
            tails = " ".join(f"p{p} {np.percentile(values, p):8.3f}" for p in at)
            print(f"    {key:10s} {tails} worst {worst:8.3f}")
        if timed := [row for row in fine if "states" in row]:
            cpu, states = (np.array([row[key] for row in timed]) for key in ("cpu", "states"))
            slow = cpu > SLOW * np.median(cpu)
            told = slow & (states > SLOW * np.median(states))
            print(f"    above {SLOW} medians of CPU: {slow.sum()}, {told.sum()} of them of search states too")
        said = [row["cpu"] for row in own if "refused" in row]
        if said:
            print(f"    refusals take {1000 * np.median(said):.0f} ms, at most {1000 * max(said):.0f}")
        meets = sum(row["meets_itself"] for row in fine)
        print(f"    bodies that are checked in space: {meets}")
    wrong = [row for row in rows if "wrong" in row]
    print(f"\n{len(wrong)} wrong")
    for row in wrong[:50]:
        print(f"    {row['name']} {row['count']} {row['cells']}: {row['wrong']}")
    for row in sorted(rows, key=lambda row: -row["cpu"])[:10]:
        print(
            f"{row['cpu']:8.2f} s CPU: {row['name']} {row['count']} {row['cells']} {row.get('refused', '')}"
        )


def drawn(corpus: Path, worst: list[dict[str, Any]], file: Path) -> None:
    """The patches of these rows, as a sheet of pictures."""
    wanted = {row["name"]: row for row in worst}
    size, columns, pictures = 240, 8, []
    for name, outline in outlines(corpus):
        row = wanted.get(name)
        if row is None:
            continue
        outer, holes = np.array(outline["outer"]), [np.array(hole) for hole in outline["holes"]]
        patch = meshed(outer, holes, row["cells"], row["count"])
        low, extent = outer.min(axis=0), np.ptp(outer, axis=0).max()
        at = (patch.vertices - low) / extent * (size - 20)
        k = len(pictures)
        at = at * [1, -1] + [(k % columns) * size, (k // columns + 1) * size - 20]
        faces = patch.quads if row["cells"] == "quads" else patch.triangles
        paths = "".join("M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in at[face]) + "Z" for face in faces)
        title = f"{row['angle']:.1f} {outline['name']}"
        pictures.append(
            f'<path d="{paths}"/><text x="{k % columns * size}" y="{(k // columns + 1) * size - 4}">{title}</text>'
        )
    rows = -(-len(pictures) // columns)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{columns * size}" height="{rows * size}">'
    style = (
        "<style>path{fill:#eef;stroke:#226;stroke-width:.5}text{font:11px sans-serif}rect{fill:#fff}</style>"
    )
    file.write_text(f'{head}{style}<rect width="100%" height="100%"/>{"".join(pictures)}</svg>')


def main() -> int:
    """Do what is missing, and sum up; 1 if something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("corpus", type=Path)
    parser.add_argument("journal", type=Path)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--triangles", type=int, nargs="*", default=[500, 2000, 10_000])
    parser.add_argument("--quads", type=int, nargs="*", default=[1000])
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--worst", type=int, default=0)
    parser.add_argument("--summary", action="store_true")
    chosen = parser.parse_args()
    kinds = [("triangles", count) for count in chosen.triangles] + [
        ("quads", count) for count in chosen.quads
    ]
    rows = rows_of(chosen.journal) if chosen.summary else resumed(chosen.journal)
    if not chosen.summary:
        known = {(row["name"], row["cells"], row["count"]) for row in rows}
        workers = multiprocessing.get_context("spawn").Pool(chosen.processes)
        with workers as pool, chosen.journal.open("a") as journal:
            for row in pool.imap_unordered(done, tasks(chosen.corpus, chosen.every, kinds, known), 4):
                rows.append(row)
                journal.write(json.dumps(row) + "\n")
                journal.flush()
    summed_up(rows)
    if chosen.worst:
        fine = sorted((row for row in rows if "angle" in row), key=lambda row: row["angle"])
        drawn(chosen.corpus, fine[: chosen.worst], chosen.journal.with_suffix(".svg"))
    return int(any("wrong" in row for row in rows))


if __name__ == "__main__":
    sys.exit(main())
