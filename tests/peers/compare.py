# /// script
# requires-python = ">=3.11"
# dependencies = [
#   "gmsh==4.15.2", "gridmesh", "netgen-mesher==6.2.2608", "numpy==1.26.4", "pyinstantmeshes==1.0.0", "triangle==20250106",
#   "wildmeshing==0.4.1"
# ]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""Compare our meshes of drawn outlines with those of other meshers. From the folder of the project:

    uv run tests/peers/compare.py

installs the peers, builds our module and the peers in Rust, and prints tables in Markdown.
Triangle may not go into commercial products without its author's permission: it is fetched by this command
alone, and nothing of the project depends on it.

Every drawing is meshed at every number of triangles. Ours come first and say how many triangles and boundary
vertices there are. The others get the drawing resampled evenly to that number of boundary vertices, and a
size that is searched until their number of triangles is within 3 % of ours. Then all run in turn, on one
thread, several rounds; a drawing's time is the median of its rounds, in processor time. The tables show
medians over the drawings that we and all peers could do; variants of ours, Instant Meshes and TriWild say if there are fewer (`grown`
has no holes). Beside the median of the least angle stand its tenth percentile and the worst. Deviations are in edge lengths of an equilateral mesh of the same number of triangles.
"""

from __future__ import annotations

import argparse
import gc
import platform
import re
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from statistics import median, quantiles

from drawing import Drawing, edge_length, is_simple, load, resampled
from measure import measure
from meshers import Failed, InRust, Mesh, Mesher, Ours, Problem, RustProcess, Triangle
from remeshers import peers

ROOT = Path(__file__).parent.parent.parent
COUNTS = [500, 2000, 10_000, 100_000]
TOLERANCE = 0.03
TRIALS = 16
# Meshes larger than this are timed on every fifth drawing and not measured.
LARGE = 20_000
COLUMNS = {
    "irregular": ("irregular vertices, %", "{:.2f}"),
    "excess": ("sum of valence - 6, of 1000", "{:.1f}"),
    "chords": ("chords", "{:.0f}"),
    "angle": ("smallest angle, °", "{:.1f}"),
    "tenth": ("its tenth percentile", "{:.1f}"),
    "worst": ("its worst", "{:.1f}"),
    "ratio": ("radius ratio", "{:.3f}"),
    "curve_to_mesh": ("curve to mesh", "{:.2f}"),
    "mesh_to_curve": ("mesh to curve", "{:.2f}"),
    "on_curve": ("on the curve, %", "{:.0f}"),
    "milliseconds": ("time, ms", "{:.2f}"),
    "of_triangle": ("time / Triangle", "{:.2f}"),
}


@dataclass
class Results:
    """By number of triangles: for each drawing that we and all peers could do, the numbers of each mesher."""

    rows: dict[int, list[dict[str, dict[str, float]]]] = field(default_factory=dict)
    notes: dict[int, Counter[str]] = field(default_factory=dict)
    refused: dict[int, Counter[str]] = field(default_factory=dict)
    """How many drawings each mesher could not do."""


def main() -> None:
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=raw)
    parser.add_argument("--counts", type=int, nargs="+", default=COUNTS, help="numbers of triangles")
    parser.add_argument("--rounds", type=int, default=5, help="timed runs of each mesher on each drawing")
    parser.add_argument("--every", type=int, default=1, help="take only every n-th drawing")
    parser.add_argument("--output", type=Path, help="write the tables to this file too")
    arguments = parser.parse_args()

    rust = RustProcess(ROOT)
    reference = Ours("gridmesh")
    others: list[Mesher] = [
        Ours("gridmesh, straight", bend=0.0),
        Ours("gridmesh, angle fixed", angle=0.0),
        InRust("gridmesh, angle fixed, from Rust", rust, "optimal", ours=True),
        Ours("gridmesh `grown`, angle fixed", boundary="grown", angle=0.0),
        *peers(),
        InRust("spade, refinement (Rust)", rust, "spade"),
        InRust("lattice points + spade (Rust)", rust, "lattice"),
    ]
    drawings = load()[:: arguments.every]
    results = Results()
    for count in arguments.counts:
        results.rows[count], results.notes[count], results.refused[count] = [], Counter(), Counter()
        some = drawings[::5] if count > LARGE else drawings
        for k, drawing in enumerate(some):
            print(f"{count} triangles, drawing {k + 1} of {len(some)}", end="\r", file=sys.stderr, flush=True)
            row = compare(drawing, count, reference, others, arguments.rounds, results)
            if row is not None:
                results.rows[count].append(row)
    names = [mesher.name for mesher in [reference, *others]]
    tables = [table(count, names, results) for count in arguments.counts]
    text = "\n\n".join([*tables, times(names, results), about()])
    print(text)
    if arguments.output:
        arguments.output.write_text(text + "\n", encoding="utf-8")


def compare(
    drawing: Drawing, count: int, reference: Mesher, others: list[Mesher], rounds: int, results: Results
) -> dict[str, dict[str, float]] | None:
    """The numbers of every mesher, or None if we or a peer could not do the drawing."""
    problem = Problem(drawing.contours, drawing.contours, count)
    notes, refused = results.notes[count], results.refused[count]
    try:
        first = reference.mesh(problem, count, keep=True)
    except Failed as failed:
        notes[f"{reference.name}: {failed}: {drawing.name}"] += 1
        refused[reference.name] += 1
        return None
    even = [resampled(contour, n) for contour, n in zip(drawing.contours, first.loops, strict=True)]
    problem = Problem(drawing.contours, even, first.n_triangles)
    if not is_simple(problem.even):
        notes[f"resampled to our boundary vertices it crosses itself: {drawing.name}"] += 1
        return None
    edge = edge_length(drawing, problem.target)
    meshes, sizes = {reference: first}, {reference: float(count)}
    for mesher in others:
        if len(drawing.contours) > 1 and not mesher.has_holes:
            continue
        try:
            sizes[mesher], meshes[mesher] = search(mesher, problem, edge, keep=count <= LARGE)
        except Failed as failed:
            notes[f"{mesher.name}: {failed}: {drawing.name}"] += 1
            refused[mesher.name] += 1
    if any(mesher not in meshes for mesher in others if mesher.is_peer):
        return None

    seconds: dict[Mesher, list[float]] = {mesher: [] for mesher in meshes}
    gc.collect()
    gc.disable()
    for number in range(rounds):
        # Back and forth, so that nobody always runs after the same one.
        for mesher in list(meshes)[:: 1 if number % 2 == 0 else -1]:
            seconds[mesher].append(mesher.mesh(problem, sizes[mesher], keep=False).seconds)
    gc.enable()

    row = {}
    for mesher, mesh in meshes.items():
        numbers = measure(mesh.vertices, mesh.triangles, drawing, edge) if count <= LARGE else {}
        row[mesher.name] = {**numbers, "milliseconds": 1e3 * median(seconds[mesher])}
    peer = next(mesher.name for mesher in others if isinstance(mesher, Triangle))
    for numbers in row.values():
        numbers["of_triangle"] = numbers["milliseconds"] / row[peer]["milliseconds"]
    return row


def search(mesher: Mesher, problem: Problem, edge: float, keep: bool) -> tuple[float, Mesh]:
    """The size at which a mesher gives the number of triangles wanted, and its mesh there."""
    size = mesher.guess(problem, edge)
    fewer = more = None
    reached = []
    for _ in range(TRIALS):
        mesh = mesher.mesh(problem, size, keep)
        ratio = mesh.n_triangles / problem.target
        if abs(ratio - 1) <= TOLERANCE:
            return size, mesh
        reached.append(ratio)
        if ratio < 1:
            fewer = size
        else:
            more = size
        step = size * min(max(ratio, 0.25), 4.0) ** (-1 / mesher.power)
        between = fewer is not None and more is not None
        inside = between and min(fewer, more) < step < max(fewer, more)
        size = step if inside or not between else (fewer * more) ** 0.5
    nearest = min(reached, key=lambda ratio: abs(ratio - 1))
    raise Failed(f"its nearest number of triangles is {100 * nearest:.1f} % of ours")


def table(count: int, names: list[str], results: Results) -> str:
    """All numbers at one number of triangles, and what is missing."""
    rows = results.rows[count]
    columns = [key for key in COLUMNS if rows and value(key, [rows[0][names[0]]]) is not None]
    lines = [f"**{count} triangles**, medians over {len(rows)} drawings", ""]
    lines.append("| mesher | " + " | ".join(COLUMNS[key][0] for key in columns) + " | refused |")
    lines.append("|---|" + "---:|" * (len(columns) + 1))
    for name in names:
        able = [row[name] for row in rows if name in row]
        if not able:
            continue
        cells = [COLUMNS[key][1].format(value(key, able)) for key in columns]
        label = name if len(able) == len(rows) else f"{name} ({len(able)} drawings)"
        lines.append(f"| {label} | " + " | ".join([*cells, str(results.refused[count][name])]) + " |")
    if notes := results.notes[count]:
        lines += ["", "Left out:", *(f"* {note}" for note in notes)]
    return "\n".join(lines)


def value(key: str, able: list[dict[str, float]]) -> float | None:
    """What a column shows of some drawings."""
    if key in ("tenth", "worst"):
        angles = [numbers["angle"] for numbers in able if "angle" in numbers]
        if not angles:
            return None
        return (
            min(angles)
            if key == "worst" or len(angles) < 2
            else quantiles(angles, n=10, method="inclusive")[0]
        )
    return median(numbers[key] for numbers in able) if key in able[0] else None


def times(names: list[str], results: Results) -> str:
    """Our time by Triangle's: median and worst drawing."""
    lines = ["**Time by that of Triangle**, median (greatest) over the drawings", ""]
    lines.append("| mesher | " + " | ".join(map(str, results.rows)) + " |")
    lines.append("|---|" + "---:|" * len(results.rows))
    for name in names:
        cells = []
        for rows in results.rows.values():
            ratios = [row[name]["of_triangle"] for row in rows if name in row]
            cells.append(f"{median(ratios):.2f} ({max(ratios):.2f})" if ratios else "")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def about() -> str:
    """The machine and the versions."""
    lock = (ROOT / "Cargo.lock").read_text(encoding="utf-8")
    spade = re.search(r'name = "spade"\nversion = "(.*)"', lock)
    compiler = subprocess.run(["rustc", "--version"], check=True, capture_output=True, text=True).stdout
    packages = ("gridmesh", "triangle", "gmsh", "netgen-mesher", "pyinstantmeshes", "wildmeshing", "numpy")
    versions = [f"{name} {version(name)}" for name in packages]
    parts = [processor(), platform.platform(), f"Python {platform.python_version()}", *versions]
    return ", ".join([*parts, f"spade {spade[1] if spade else '?'}", f"rustc {compiler.split()[1]}"])


def processor() -> str:
    """The processor's name."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


if __name__ == "__main__":
    main()
