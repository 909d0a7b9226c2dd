"""How long a call can be deaf: for large inputs the longest processor time between two progress reports.

    RAYON_NUM_THREADS=1 python tests/campaign/cancel.py [NAME ...] [--scale S]

prints for each call its seconds of processor time, the number of reports, the longest time between two of them and
from the last to the end, and between which fractions that was. One thread, so that processor time is the time one waits.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import gridmesh
import numpy as np

ALLOWED = 0.2
"""Seconds of processor time within which a call has to answer."""


def circle(n: int, radius: float = 1.0, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Points (n, 2)."""
    t = np.arange(n) * 2 * np.pi / n
    return np.column_stack([centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t)])


def wave(n: int, lobes: int = 7, depth: float = 0.3) -> np.ndarray:
    """A closed wave of n points."""
    t = np.arange(n) * 2 * np.pi / n
    r = 1 + depth * np.cos(lobes * t) + 0.1 * np.cos(3 * t + 1)
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


def comb(teeth: int) -> np.ndarray:
    """Teeth with gaps."""
    points = [(0.0, -1.0), (float(teeth), -1.0)]
    for k in range(teeth - 1, -1, -1):
        points += [(k + 0.5, 0.0), (k + 0.5, 3.0), (k, 3.0), (k, 0.0)]
    return np.array(points)


def spiral(turns: int, width: float) -> np.ndarray:
    """A band rolled up."""
    t = np.linspace(0, turns * 2 * np.pi, turns * 40)
    r = 1 + t / (2 * np.pi)
    sides = [np.column_stack([(r + w) * np.cos(t), (r + w) * np.sin(t)]) for w in (width / 2, -width / 2)]
    return np.vstack([sides[0], sides[1][::-1]])


def sheet(n: int, hole: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """A bumpy grid of n by n squares, open in the middle."""
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    bump = 0.02 * n * np.sin(9 * i / n) * np.cos(7 * j / n)
    a, b = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    low, high = (n - hole) // 2, (n + hole) // 2
    there = ~((a >= low) & (a < high) & (b >= low) & (b < high))
    quad = ((n + 1) * a + b)[there]
    faces = np.r_[np.c_[quad, quad + n + 1, quad + 1], np.c_[quad + n + 1, quad + n + 2, quad + 1]]
    return np.c_[i.ravel(), j.ravel(), bump.ravel()].astype(float), faces


def ball(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed sphere of about 2 n n triangles."""
    rows, columns = n, n
    u = np.pi * np.arange(1, rows) / rows
    v = 2 * np.pi * np.arange(columns) / columns
    ring = np.array([[np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)] for a in u for b in v])
    vertices = np.vstack([ring, [[0, 0, 1.0], [0, 0, -1.0]]])
    at = lambda i, j: i * columns + j % columns  # noqa: E731
    north, south = len(ring), len(ring) + 1
    faces = [[north, at(0, j), at(0, j + 1)] for j in range(columns)]
    faces += [[south, at(rows - 2, j + 1), at(rows - 2, j)] for j in range(columns)]
    for i in range(rows - 2):
        for j in range(columns):
            faces += [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]]
    return vertices, np.array(faces)


class Clock:
    """A progress callback that measures."""

    def __init__(self) -> None:
        self.reports: list[tuple[float, float]] = []
        self.started = time.process_time()

    def __call__(self, fraction: float) -> None:
        self.reports.append((time.process_time(), fraction))

    def told(self) -> tuple[float, int, float, tuple[float, float], float]:
        """Seconds, reports, longest gap, its fractions, seconds from the last report to the end."""
        end = time.process_time()
        times = [(self.started, 0.0), *self.reports, (end, 1.0)]
        gaps = [(b[0] - a[0], (a[1], b[1])) for a, b in pairwise(times)]
        longest, where = max(gaps)
        return end - self.started, len(self.reports), longest, where, gaps[-1][0]


def calls(scale: float) -> dict[str, Callable[[Clock], Any]]:
    """Every function that can take long, on large inputs; the inputs are made before the clock starts."""
    made: dict[str, Any] = {}

    def once(name: str, make: Callable[[], Any]) -> Any:
        if name not in made:
            made[name] = make()
        return made[name]

    def sketch(outline: np.ndarray, triangles: int, **options: Any) -> Callable[[Clock], Any]:
        return lambda clock: gridmesh.mesh_sketch(
            outline, triangles=int(triangles * scale), progress=clock, **options
        )

    def body(triangles: int, **options: Any) -> Callable[[], Callable[[Clock], Any]]:
        def prepared() -> Callable[[Clock], Any]:
            patch = gridmesh.mesh_sketch(wave(600), triangles=int(triangles * scale))
            return lambda clock: gridmesh.inflate(patch, progress=clock, **options)

        return prepared

    def mesh_call(function: str, mesh: tuple[np.ndarray, np.ndarray], *arguments: Any, **options: Any) -> Any:
        return lambda clock: getattr(gridmesh, function)(*mesh, *arguments, progress=clock, **options)

    def hole(n: int, edges: int, **options: Any) -> Callable[[], Any]:
        return lambda: mesh_call("fill_holes", sheet(n, edges), max_edges=4 * edges, **options)

    def regrid(n: int, **options: Any) -> Callable[[], Any]:
        def prepared() -> Callable[[Clock], Any]:
            vertices, faces = sheet(n)
            centre = vertices[faces].mean(axis=1)[:, :2] - n / 2
            return mesh_call(
                "regrid", (vertices, faces), np.flatnonzero(np.hypot(*centre.T) < 0.4 * n), **options
            )

        return prepared

    def cut(n: int, points: int, **options: Any) -> Callable[[], Any]:
        def prepared() -> Callable[[Clock], Any]:
            x = np.linspace(-1.5, 1.5, points)
            stroke = np.column_stack([x, 0.3 * np.sin(4 * x) + 0.013, 0 * x])
            return mesh_call("cut", ball(n), stroke, direction=(0, 0, 1), **options)

        return prepared

    def plate(edge_length: float) -> Callable[[Clock], Any]:
        corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * [1, 1, 0.001]
        quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
        faces = np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])
        stroke = [[0.5, -1, 0.00037], [0.5, 2, 0.00037]]
        return mesh_call("cut", (corners, faces), stroke, direction=(1, 0, 0), edge_length=edge_length)

    def fill_of(edges: int) -> Any:
        return once(f"fill {edges}", lambda: gridmesh.fill_holes(*sheet(300, edges), max_edges=4 * edges)[0])

    return {
        "sketch 20,000": lambda: sketch(wave(600), 20_000),
        "sketch 100,000": lambda: sketch(wave(2000), 100_000),
        "sketch 100,000 grown": lambda: sketch(wave(2000), 100_000, boundary="grown"),
        "sketch 100,000 spiral": lambda: sketch(spiral(20, 0.2), 100_000),
        "sketch 50,000 quads": lambda: (
            lambda clock: gridmesh.mesh_sketch(wave(2000), quads=int(50_000 * scale), progress=clock)
        ),
        "sketch refused": lambda: sketch(spiral(8, 0.2), 1000),
        "sketch 100,000 mirror": lambda: sketch(wave(2000, 6), 100_000, mirror="auto"),
        "sketch of 100,000 points": lambda: sketch(wave(100_000, 30), 20_000),
        "sketch proof": lambda: sketch(comb(8), 2000, proof_nodes=300),
        "sketch bent": lambda: sketch(wave(600), 20_000, bend=0.5),
        "sketch bent 100,000": lambda: sketch(wave(600), 100_000, bend=0.5),
        "sketch density": lambda: sketch(wave(600), 20_000, bend=0.5, density="width"),
        "sketch sliver": lambda: sketch(np.array([[0, 0], [1000, 0], [1000, 0.52], [0, 0.52]]), 20_000),
        "sketch union": lambda: sketch(
            np.column_stack([np.cos(np.arange(4000) * 0.0314), np.sin(np.arange(4000) * 0.047)]),
            20_000,
            self_crossing="union",
        ),
        "inflate 20,000": body(20_000),
        "inflate 100,000": body(100_000),
        "inflate 100,000 flat": body(100_000, profile="flat"),
        "inflate 100,000 peak": body(100_000, profile="peak"),
        "map_sketches": lambda: (
            lambda clock: gridmesh.map_sketches(
                [wave(400, k) for k in range(2, 10)], triangles=int(20_000 * scale), progress=clock
            )
        ),
        "fill_holes 20,000": hole(200, int(70 * scale)),
        "fill_holes 100,000": hole(400, int(150 * scale), smooth="curvature"),
        "fill_holes 100,000 quads": hole(400, int(150 * scale), cells="quads"),
        "join 20,000": lambda: (
            lambda clock: gridmesh.join(
                [ball(int(70 * scale)), (lambda v, f: (v + [0.9, 0.1, 0.05], f))(*ball(int(70 * scale)))],
                progress=clock,
            )
        ),
        "fill_holes 100,000 flat": hole(400, int(150 * scale), smooth="flat"),
        "regrid 20,000": regrid(int(140 * scale)),
        "regrid 100,000": regrid(int(300 * scale)),
        "cut 20,000": cut(int(100 * scale), 200, edge_length=0.02),
        "cut 100,000": cut(int(224 * scale), 2000, edge_length=0.01),
        "cut 100,000 exact": cut(int(224 * scale), 5000),
        "cut 100,000 curvature": cut(int(224 * scale), 500, edge_length=0.01, smooth="curvature"),
        "cut plate": lambda: plate(0.01),
        "cut_reach 100,000": lambda: mesh_call(
            "cut_reach", ball(int(224 * scale)), [[-0.5, 0, 0.0], [0.5, 0.1, 0]], direction=(0, 0, 1)
        ),
        "Fill.refit": lambda: (lambda fill: lambda clock: fill.refit(sheet(300)[0], progress=clock))(
            fill_of(int(120 * scale))
        ),
        "Fill.extend": lambda: (
            lambda fill: (
                lambda clock: fill.extend(
                    np.random.default_rng(0).normal(size=(len(fill.loop), 3)), progress=clock
                )
            )
        )(fill_of(int(120 * scale))),
        "combine 20,000 points": lambda: (
            lambda _: gridmesh.combine(wave(20_000, 200), wave(20_000, 151) + [0.3, 0.1])
        ),
        "thickness 20,000 points": lambda: lambda _: gridmesh.thickness(wave(20_000, 40)),
        "stitch 100,000": lambda: (lambda patch: lambda _: gridmesh.stitch(patch))(
            gridmesh.mesh_sketch(wave(600), triangles=int(100_000 * scale))
        ),
    }


def main() -> None:
    """Measure all calls, or those whose names hold a word given."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--scale", type=float, default=1.0)
    arguments = parser.parse_args()
    for name, prepare in calls(arguments.scale).items():
        if arguments.names and not any(word in name for word in arguments.names):
            continue
        call = prepare()
        clock = Clock()
        try:
            call(clock)
            outcome = ""
        except gridmesh.GridMeshError as error:
            outcome = f" ({error.kind})"
        seconds, reports, longest, (a, b), last = clock.told()
        note = "  <-- deaf" if longest > ALLOWED else ""
        print(
            f"{name:26} {seconds:7.2f} s CPU, {reports:7} reports, longest {longest:6.3f} s "
            f"from {a:.4f} to {b:.4f}, last {last:6.3f} s{outcome}{note}",
            flush=True,
        )


if __name__ == "__main__":
    main()
