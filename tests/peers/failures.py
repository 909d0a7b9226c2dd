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
"""How often we and other meshers fail over outlines of a corpus. From the folder of the project:

    uv run tests/campaign/corpus.py CORPUS.jsonl
    uv run tests/peers/failures.py CORPUS.jsonl JOURNAL.jsonl --every 200

Every outline is meshed once by each, with about as many triangles as are asked for: the size is corrected once, and the
nearer of two meshes is taken. Others get the drawing resampled to edges of that size, or as it is drawn where that would
cross itself. Each mesher runs in a process of its own that may crash and has a minute. All meshes are held against the
same: triangles of positive area, manifold, one piece with the drawing's holes, within three edges of the drawing, no
corner of a boundary that touches itself. Chords, which glue the two sides of a body together, are no failure here but counted.
One line of the journal for each outline and mesher; what is in it is not done again.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from drawing import Drawing, edge_length, is_simple, resampled, turned
from measure import edges_of, measure
from meshers import Failed, Mesh, Mesher, Ours, Problem
from remeshers import peers

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "campaign"))

from json_lines import outlines, resumed

PATIENCE = 60.0
FARTHEST = 3.0
"""Edges that a mesh may be from the drawing, or the drawing from it."""


def drawings(corpus: Path, every: int) -> Iterator[Drawing]:
    """Every so many outlines of the corpus."""
    for name, row in outlines(corpus, every):
        contours = [np.array(row["outer"]), *map(np.array, row["holes"])]
        yield Drawing(name, [turned(contour, i == 0) for i, contour in enumerate(contours)])


def problem_of(drawing: Drawing, edge: float, count: int) -> Problem:
    """The drawing, and what others get of it."""
    even = []
    for contour in drawing.contours:
        length = np.hypot(*(np.roll(contour, -1, axis=0) - contour).T).sum()
        even.append(resampled(contour, max(4, round(length / edge))))
    return Problem(drawing.contours, even if is_simple(even) else drawing.contours, count)


def fault(mesh: Mesh, drawing: Drawing) -> str | None:
    """What is wrong with a mesh, if anything."""
    used, flat = np.unique(mesh.triangles, return_inverse=True)
    vertices, triangles = mesh.vertices[used], flat.reshape(-1, 3)
    corners = vertices[triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    least = (areas * np.sign(areas.sum())).min()
    if least <= 0:
        return "inverted"
    halves = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    edges, uses = edges_of(triangles)
    if uses.max() > 2 or len(np.unique(halves, axis=0)) < len(halves):
        return "not manifold"
    rim = edges[uses == 1]
    if np.bincount(rim.ravel()).max() > 2:
        return "boundary touches itself"
    # Each contour is one loop, and the mesh one piece with as many holes.
    loops, pieces = parts(rim), parts(edges)
    if pieces != 1 or loops != len(drawing.contours):
        return "other holes or pieces"
    if len(vertices) - len(edges) + len(triangles) != 2 - loops:
        return "other topology"
    return None


def parts(edges: np.ndarray) -> int:
    """The number of connected components."""
    number, edges = np.unique(edges, return_inverse=True)
    edges = edges.reshape(-1, 2)
    label = np.arange(len(number))
    while True:
        least = label.copy()
        np.minimum.at(least, edges[:, 0], label[edges[:, 1]])
        np.minimum.at(least, edges[:, 1], label[edges[:, 0]])
        least = least[least]
        if (least == label).all():
            return len(np.unique(label))
        label = least


def outcome(mesher: Mesher, drawing: Drawing, count: int, sender: Connection) -> None:
    """What a mesher makes of a drawing, sent back."""
    edge = edge_length(drawing, count)
    problem = problem_of(drawing, edge, count)
    row: dict[str, Any] = {}
    try:
        size = mesher.guess(problem, edge)
        mesh = mesher.mesh(problem, size, keep=True)
        ratio = mesh.n_triangles / count
        if abs(ratio - 1) > 0.05 and not isinstance(mesher, Ours):
            again = mesher.mesh(problem, size * np.clip(ratio, 0.25, 4.0) ** (-1 / mesher.power), keep=True)
            if abs(again.n_triangles / count - 1) < abs(ratio - 1):
                mesh = again
        row["cpu"], row["triangles"] = mesh.seconds, mesh.n_triangles
        wrong = fault(mesh, drawing)
        if wrong is None:
            row |= measure(mesh.vertices, mesh.triangles, drawing, edge)
            if max(row["mesh_to_curve"], row["curve_to_mesh"]) > FARTHEST:
                wrong = "far from the drawing"
        if wrong is not None:
            row["failed"] = wrong
    except Failed as failed:
        row["failed"] = f"error: {str(failed)[:60]}"
    sender.send(row)


def tried(mesher: Mesher, drawing: Drawing, count: int) -> dict[str, Any]:
    """Its outcome, out of a process that may crash or hang."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=outcome, args=(mesher, drawing, count, sender))
    process.start()
    sender.close()
    try:
        return receiver.recv() if receiver.poll(PATIENCE) else {"failed": "takes over a minute"}
    except EOFError:
        return {"failed": "crash"}
    finally:
        process.kill()
        process.join()


def table(rows: list[dict[str, Any]]) -> str:
    """Failures and tails of each mesher in Markdown, over the outlines that all have tried."""
    by_mesher = defaultdict(list)
    for row in rows:
        by_mesher[row["mesher"]].append(row)
    lines = [
        "| mesher | outlines | failed | irregular, %: 50 / 95 | least angle, °: 50 / 5 / 1 | with chords "
        "| largest deviation, edges: 50 / 95 | CPU, ms: 50 / 95 |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for name, own in by_mesher.items():
        fine = [row for row in own if "failed" not in row]

        def tails(values: list[float], at: list[int], digits: int) -> str:
            return " / ".join(f"{p:.{digits}f}" for p in np.percentile(values, at)) if values else ""

        off = [max(row["mesh_to_curve"], row["curve_to_mesh"]) for row in fine]
        cells = [
            name,
            str(len(own)),
            str(len(own) - len(fine)),
            tails([row["irregular"] for row in fine], [50, 95], 2),
            tails([row["angle"] for row in fine], [50, 5, 1], 1),
            str(sum(row["chords"] > 0 for row in fine)),
            tails(off, [50, 95], 2),
            tails([1000 * row["cpu"] for row in fine], [50, 95], 1),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    for name, own in by_mesher.items():
        reasons = Counter(row["failed"].partition(":")[0] for row in own if "failed" in row)
        if reasons:
            lines.append(
                f"\n{name}: " + ", ".join(f"{reason} {times}" for reason, times in reasons.most_common())
            )
    return "\n".join(lines)


def main() -> None:
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=raw)
    parser.add_argument("corpus", type=Path)
    parser.add_argument("journal", type=Path)
    parser.add_argument("--every", type=int, default=200, help="take only every n-th outline")
    parser.add_argument("--count", type=int, default=2000, help="number of triangles")
    parser.add_argument("--minutes", type=float, default=np.inf, help="stop after so many, with the table")
    chosen = parser.parse_args()
    rows = resumed(chosen.journal)
    done = {(row["name"], row["mesher"]) for row in rows}
    since = time.monotonic()
    meshers: list[Mesher] = [Ours("gridmesh"), *peers()]
    with chosen.journal.open("a") as journal:
        for drawing in drawings(chosen.corpus, chosen.every):
            if time.monotonic() - since > 60 * chosen.minutes:
                break
            for mesher in meshers:
                if (drawing.name, mesher.name) not in done:
                    row = {"name": drawing.name, "mesher": mesher.name}
                    rows.append(row | tried(mesher, drawing, chosen.count))
                    journal.write(json.dumps(rows[-1]) + "\n")
                    journal.flush()
    print(table(rows))


if __name__ == "__main__":
    main()
