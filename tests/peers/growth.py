# /// script
# requires-python = ">=3.11"
# dependencies = [
#   "gmsh==4.15.2", "gridmesh", "matplotlib==3.10.8", "netgen-mesher==6.2.2608", "numpy==1.26.4",
#   "pyinstantmeshes==1.0.0", "triangle==20250106", "wildmeshing==0.4.1"
# ]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""Plot the number of irregular vertices against that of triangles, ours and of other meshers. From the folder of the project:

    uv run tests/peers/growth.py

prints a table in Markdown and writes `docs/pictures/growth.svg`. Drawings, peers and the search of their sizes are
those of `compare.py`; every fourth drawing is taken, and a mesher's line is the median over the drawings that it
could do. Irregular vertices are those of the body: two copies glued along the boundary.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import median

import matplotlib
import numpy as np
from compare import ROOT, edge_length, search
from drawing import is_simple, load, resampled
from measure import connectivity
from meshers import Failed, Gmsh, Mesher, Netgen, Ours, Problem, Triangle
from remeshers import InstantMeshes

matplotlib.use("svg")
from matplotlib import pyplot

COUNTS = [500, 1000, 2000, 5000, 10_000, 20_000, 50_000, 100_000]
COLORS = ["#d1495b", "#ef9a3c", "#30638e", "#5b8e7d", "#8a6fa8", "#7a7a7a"]


def main() -> None:
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=raw)
    parser.add_argument("--counts", type=int, nargs="+", default=COUNTS, help="numbers of triangles")
    parser.add_argument("--every", type=int, default=4, help="take only every n-th drawing")
    arguments = parser.parse_args()
    ours = [Ours("GridMesh"), Ours("GridMesh, straight lattice", bend=0.0)]
    others = [
        Triangle("Triangle"),
        Gmsh("gmsh"),
        Netgen("netgen"),
        InstantMeshes("Instant Meshes", aligned=True),
    ]
    meshers: list[Mesher] = [*ours, *others]
    drawings = load()[:: arguments.every]
    lines: dict[str, list[tuple[int, int, float]]] = {mesher.name: [] for mesher in meshers}
    for count in arguments.counts:
        numbers: dict[str, list[float]] = {mesher.name: [] for mesher in meshers}
        for k, drawing in enumerate(drawings):
            print(
                f"{count} triangles, drawing {k + 1} of {len(drawings)}",
                end="\r",
                file=sys.stderr,
                flush=True,
            )
            problem = Problem(drawing.contours, drawing.contours, count)
            try:
                first = ours[0].mesh(problem, count, keep=True)
            except Failed as failed:
                print(f"{count}: {ours[0].name}: {failed}: {drawing.name}", file=sys.stderr)
                continue
            numbers[ours[0].name].append(irregular(first.triangles))
            even = [resampled(contour, n) for contour, n in zip(drawing.contours, first.loops, strict=True)]
            problem = Problem(drawing.contours, even, first.n_triangles)
            if not is_simple(even):
                print(f"{count}: resampled, it crosses itself: {drawing.name}", file=sys.stderr)
                continue
            for mesher in meshers[1:]:
                try:
                    _, mesh = search(mesher, problem, edge_length(drawing, problem.target), keep=True)
                except Failed as failed:
                    print(f"{count}: {mesher.name}: {failed}: {drawing.name}", file=sys.stderr)
                    continue
                numbers[mesher.name].append(irregular(mesh.triangles))
        for name, found in numbers.items():
            if found:
                lines[name].append((count, len(found), median(found)))
    print(table(arguments.counts, lines))
    plot(lines, ROOT / "docs" / "pictures" / "growth.svg")


def irregular(triangles: np.ndarray) -> float:
    """Irregular vertices of the glued body."""
    flat = np.unique(triangles, return_inverse=True)[1].reshape(-1, 3)
    return connectivity(flat)[0]["number"]


def table(counts: list[int], lines: dict[str, list[tuple[int, int, float]]]) -> str:
    """Medians, and over how many drawings."""
    rows = ["| triangles | " + " | ".join(map(str, counts)) + " |", "|---|" + "---:|" * len(counts)]
    for name, line in lines.items():
        found = {count: f"{value:.0f} ({drawings})" for count, drawings, value in line}
        rows.append(f"| {name} | " + " | ".join(found.get(count, "") for count in counts) + " |")
    return "\n".join(rows)


def plot(lines: dict[str, list[tuple[int, int, float]]], path: Path) -> None:
    """Both axes logarithmic, each line named at its end."""
    # Neither a date nor random names in the file: the same numbers give the same bytes.
    pyplot.rcParams.update({"svg.hashsalt": "gridmesh", "svg.fonttype": "none", "font.family": "sans-serif"})
    figure, axes = pyplot.subplots(figsize=(7.2, 4.2))
    for (name, line), color in zip(lines.items(), COLORS, strict=True):
        x, _, y = np.array(line).T
        bold = 2.6 if name.startswith("GridMesh") else 1.4
        axes.plot(x, y, color=color, linewidth=bold, marker="o", markersize=3.5)
    axes.set(xscale="log", yscale="log", xlabel="triangles a side", ylabel="irregular vertices of the body")
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:,.0f}")
    axes.yaxis.set_major_formatter(lambda y, _: f"{y:,.0f}")
    axes.grid(which="major", color="#dddddd", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    figure.subplots_adjust(left=0.11, right=0.76, top=0.97, bottom=0.12)
    figure.canvas.draw()
    lowest = -np.inf
    for (name, line), color in sorted(
        zip(lines.items(), COLORS, strict=True), key=lambda row: row[0][1][-1][2]
    ):
        x, _, y = line[-1]
        # In points above the axes' origin, at least a line of text above the name below it.
        height = axes.transData.transform((x, y))[1] * 72 / figure.dpi
        lowest = max(height, lowest + 12)
        axes.annotate(
            name,
            (x, y),
            (7, lowest - height),
            textcoords="offset points",
            color=color,
            va="center",
            fontsize=9,
        )
    figure.savefig(path, metadata={"Date": None, "Creator": None}, facecolor="white")


if __name__ == "__main__":
    main()
