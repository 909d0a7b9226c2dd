"""Random drawings of many kinds with random options, meshed and checked without the library's own code.

    python tests/campaign/drawings.py CASES [--seed S] [--journal FILE]

prints one line for each finding, the counts by outcome, and the ten slowest calls. A case is its seed: it can be
run again alone with `CASES` 1 and its seed. Ctrl-C ends the run with its summary; with a journal, a line of JSON
for each case, the same command goes on where it ended.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import gridmesh
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "core"))
from checks import check_patch
from json_lines import resumed

EXPECTED = {
    "too_coarse",
    "no_patch",
    "not_symmetric",
    "self_intersecting",
    "zero_area",
    "hole_misplaced",
    "inverted",
    "invalid_option",
    "disconnected",
    "extreme_size",
    "too_few_points",
}
"""Kinds of refusal that a random drawing may meet."""

LONGEST = 10.0
"""Seconds of processor time that a call for at most `LARGE` triangles may take."""
LARGE = 20_000


def circle(n: int, radius: float = 1.0, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Points (n, 2) of a circle."""
    t = np.arange(n) * 2 * np.pi / n
    return np.column_stack([centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t)])


def blob(random: np.random.Generator) -> np.ndarray:
    """A closed wave."""
    t = np.arange(int(random.integers(20, 600))) * 2 * np.pi / 600
    t *= 600 / len(t)
    r = np.ones(len(t))
    for k in range(1, int(random.integers(2, 14))):
        r += random.uniform(-0.5, 0.5) / k * np.cos(k * t + random.uniform(0, 6))
    r = np.maximum(r, random.uniform(0.02, 0.3))
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


def comb(random: np.random.Generator) -> np.ndarray:
    """Teeth with gaps."""
    teeth, width = int(random.integers(2, 14)), float(random.uniform(0.02, 0.8))
    points = [(0.0, -1.0), (float(teeth), -1.0)]
    for k in range(teeth - 1, -1, -1):
        points += [(k + width, 0.0), (k + width, random.uniform(1, 5)), (k, random.uniform(1, 5)), (k, 0.0)]
    return np.array(points)


def spiral(random: np.random.Generator) -> np.ndarray:
    """A band rolled up."""
    turns, width = int(random.integers(1, 9)), float(random.uniform(0.1, 0.9))
    t = np.linspace(0, turns * 2 * np.pi, turns * 40)
    r = 1 + t / (2 * np.pi)
    sides = [np.column_stack([(r + w) * np.cos(t), (r + w) * np.sin(t)]) for w in (width / 2, -width / 2)]
    return np.vstack([sides[0], sides[1][::-1]])


def needles(random: np.random.Generator) -> np.ndarray:
    """A box with needles and slits of three points, whose tips may end beside another wall."""
    points = [np.array([0.0, 0.0]), np.array([10.0, 0.0]), np.array([10.0, 8.0])]
    at = 9.5
    while at > 0.5:
        tip = np.array(
            [at - 0.02, random.uniform(0.3, 7.5) if random.random() < 0.5 else random.uniform(8.5, 20)]
        )
        tip[0] += random.uniform(-0.01, 0.01)
        points += [np.array([at, 8.0]), tip, np.array([at - random.uniform(0.05, 0.2), 8.0])]
        at -= random.uniform(0.4, 4)
    points.append(np.array([0.0, 8.0]))
    return turned(np.array(points), random)


def hook(random: np.random.Generator) -> np.ndarray:
    """A frame with a slanting needle whose tip ends near a wall far along the line."""
    w, tall = random.uniform(0.5, 2), random.uniform(4, 12)
    tip = np.array([random.uniform(6, 14), random.uniform(w + 0.05, w + 1)])
    base = np.array([w, tall])
    return turned(
        np.array([[0, 0], [15, 0], [15, w], [w, w], base, tip, base + [0.05, 0.3], [0, tall + 1]]), random
    )


def star(random: np.random.Generator) -> np.ndarray:
    """Long thin rays."""
    n, inner = 2 * int(random.integers(3, 20)), float(random.uniform(0.05, 0.9))
    t = np.arange(n) * 2 * np.pi / n
    r = np.where(np.arange(n) % 2 == 0, 1.0, inner)
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


def dumbbell(random: np.random.Generator) -> np.ndarray:
    """Two discs and a neck."""
    neck, long = float(random.uniform(0.005, 0.6)), float(random.uniform(0.2, 6))
    open_at = np.arcsin(neck)
    t = np.linspace(open_at, 2 * np.pi - open_at, 60)
    right = np.column_stack([np.cos(np.pi - t) + long / 2 + 1, np.sin(np.pi - t)])
    return np.vstack([right, -right])[::-1]


def sliver(random: np.random.Generator) -> np.ndarray:
    """A long thin strip, straight or waving."""
    long, n = float(10 ** random.uniform(1, 2.5)), int(random.integers(3, 60))
    x = np.linspace(0, long, n)
    y = random.uniform(0, 2) * np.sin(x * random.uniform(0, 0.2))
    width = random.uniform(0.2, 2)
    return np.vstack([np.column_stack([x, y]), np.column_stack([x, y + width])[::-1]])


def polygon(random: np.random.Generator) -> np.ndarray:
    """A few corners around a point."""
    n = int(random.integers(3, 16))
    t = np.sort(random.uniform(0, 2 * np.pi, n))
    r = random.uniform(0.05, 1, n)
    return np.column_stack([r * np.cos(t), r * np.sin(t)])


def slit(random: np.random.Generator) -> np.ndarray:
    """A disc cut open nearly to its far side."""
    deep, wide = float(random.uniform(-0.95, 0.9)), float(10 ** random.uniform(-3, -0.5))
    t = np.linspace(wide, 2 * np.pi - wide, int(random.integers(12, 200)))
    rim = np.column_stack([np.cos(t), np.sin(t)])
    return np.vstack([rim, [[deep, 0.0]]])


KINDS = [blob, comb, spiral, needles, hook, star, dumbbell, sliver, polygon, slit]


def turned(points: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Turn points by a random angle, and mirror them now and then."""
    c, s = np.cos(a := random.uniform(0, 2 * np.pi)), np.sin(a)
    turn = np.array([[c, -s], [s, c]])
    return points @ turn * ([1, -1] if random.random() < 0.5 else [1, 1])


def holes_in(random: np.random.Generator) -> list[np.ndarray]:
    """Holes near the middle, some of which nearly touch."""
    gap = float(10 ** random.uniform(-3, -0.7))
    r = float(random.uniform(0.02, 0.25))
    n = int(random.integers(3, 40))
    return [circle(n, r, (-r - gap / 2, 0)), circle(n, r, (r + gap / 2, 0))][: int(random.integers(1, 3))]


@dataclass
class Case:
    """A drawing with options."""

    kind: str
    outline: np.ndarray
    holes: list[np.ndarray]
    options: dict[str, Any] = field(default_factory=dict)


def case(seed: int) -> Case:
    """The drawing and the options of a seed."""
    random = np.random.default_rng(seed)
    make = KINDS[int(random.integers(len(KINDS)))]
    outline = make(random)
    holes = holes_in(random) if make in (blob, star, slit) and random.random() < 0.4 else []
    kind = make.__name__
    shift, scale = np.zeros(2), 1.0
    if random.random() < 0.3:
        scale = float(10 ** random.uniform(-8, 8))
    if random.random() < 0.2:
        shift = random.uniform(-1, 1, 2) * 10 ** random.uniform(0, 5)
    if random.random() < 0.2:
        outline = np.repeat(outline, random.integers(1, 4, len(outline)), axis=0)
    if random.random() < 0.2:
        outline = outline + random.normal(size=outline.shape) * 10 ** random.uniform(-9, -2)
    outline, holes = (outline + shift) * scale, [(hole + shift) * scale for hole in holes]
    options: dict[str, Any] = {"triangles": int(10 ** random.uniform(0.8, 3.9))}
    if random.random() < 0.02:
        options["triangles"] = int(random.integers(20_000, 50_000))
    if random.random() < 0.25 and not holes:
        options["boundary"] = "grown"
    elif random.random() < 0.2:
        options["mirror"] = "auto"
    elif random.random() < 0.1:
        options["proof_nodes"] = int(random.integers(1, 3000))
    if random.random() < 0.3:
        options["corner_angle"] = float(random.uniform(0, np.pi))
    if random.random() < 0.3:
        options["closeness"] = float(10 ** random.uniform(-2, 1))
    if random.random() < 0.1:
        options["relax"] = False
    if random.random() < 0.6:
        options["least"] = False
    return Case(kind, outline, holes, options)


def deviation(patch: Any, contours: list[np.ndarray], at_most: int = 20_000) -> float:
    """Greatest distance, in edges, of densely sampled contours from the boundary of a patch."""
    starts = np.concatenate([patch.vertices[loop] for loop in patch.loops])
    steps = np.concatenate([np.roll(patch.vertices[loop], -1, axis=0) for loop in patch.loops]) - starts
    squared = np.maximum((steps**2).sum(axis=1), 1e-300)
    total = sum(float(np.linalg.norm(np.roll(c, -1, axis=0) - c, axis=1).sum()) for c in contours)
    spacing = max(0.2 * patch.edge_length, total / at_most)
    far = 0.0
    for contour in contours:
        ends = np.roll(contour, -1, axis=0)
        counts = np.maximum(np.ceil(np.linalg.norm(ends - contour, axis=1) / spacing).astype(int), 1)
        start = np.repeat(np.arange(len(contour)), counts)
        along = (np.arange(len(start)) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[start]
        samples = contour[start] + along[:, None] * (ends - contour)[start]
        for block in np.array_split(samples, max(1, len(samples) * len(starts) // 2_000_000)):
            away = block[:, None] - starts[None]
            t = np.clip((away * steps).sum(axis=2) / squared, 0, 1)
            away -= t[..., None] * steps
            far = max(far, float(np.sqrt((away**2).sum(axis=2).min(axis=1).max())))
    return far / patch.edge_length


def check(case: Case) -> tuple[str, str | None, float]:
    """Outcome of a case, what is wrong with it, if anything, and the call's seconds of processor time."""
    fractions: list[float] = []
    since = time.process_time()
    try:
        patch = gridmesh.mesh_sketch(case.outline, case.holes, progress=fractions.append, **case.options)
    except gridmesh.GridMeshError as refused:
        seconds = time.process_time() - since
        wrong = None if refused.kind in EXPECTED else str(refused)
        return refused.kind, wrong or too_long(case, seconds) or untrue(case, refused), seconds
    seconds = time.process_time() - since
    if fractions != sorted(fractions):
        return "patch", "progress runs backwards", seconds
    return "patch", fault(case, patch) or too_long(case, seconds), seconds


def untrue(case: Case, refused: gridmesh.GridMeshError) -> str | None:
    """What is wrong with the number that a refusal says works, if it says one."""
    number = str(refused).partition("; ")[2].split(" work")[0]
    if refused.kind != "too_coarse" or not number.isdecimal():
        return None
    advised = Case(case.kind, case.outline, case.holes, case.options | {"triangles": int(number)})
    try:
        patch = gridmesh.mesh_sketch(advised.outline, advised.holes, **advised.options)
    except gridmesh.GridMeshError as again:
        return f"{number} do not work: {again}"
    wrong = fault(advised, patch)
    return None if wrong is None else f"at {number}, which are said to work: {wrong}"


def too_long(case: Case, seconds: float) -> str | None:
    """What is wrong with the time of a call."""
    if seconds <= LONGEST or case.options["triangles"] > LARGE:
        return None
    return f"{seconds:.1f} s CPU"


def fault(case: Case, patch: Any) -> str | None:
    """What is wrong with a patch, if anything."""
    contours = [case.outline, *case.holes]
    try:
        check_patch(patch, contours)
    except AssertionError as error:
        return f"check_patch: {error}"
    far, told = deviation(patch, contours), patch.report["max_deviation"]
    if far > 2 + 1e-6:
        return f"the drawing lies {far:.2f} edges from the boundary"
    if far > told + 0.01:
        return f"max_deviation is {told:.3f}, measured {far:.3f}"
    wanted, made = case.options["triangles"], len(patch.triangles)
    if abs(made - wanted) > max(0.1 * wanted, 6):
        return f"{wanted} triangles asked for, {made} made"
    return None


def main() -> int:
    """Run cases; 1 if something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("cases", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--journal", type=Path)
    arguments = parser.parse_args()
    done: dict[int, dict[str, Any]] = {}
    if arguments.journal is not None:
        done = {one["seed"]: one for one in resumed(arguments.journal)}
    try:
        for seed in range(arguments.seed, arguments.seed + arguments.cases):
            if seed in done:
                continue
            one = case(seed)
            outcome, wrong, seconds = check(one)
            done[seed] = {
                "seed": seed,
                "outcome": outcome,
                "wrong": wrong,
                "seconds": round(seconds, 3),
                "what": f"{one.kind} of {len(one.outline)} points {one.options}",
            }
            if wrong is not None:
                print(f"seed {seed}: {done[seed]['what']}: {outcome}: {wrong}", flush=True)
            if arguments.journal is not None:
                with arguments.journal.open("a") as journal:
                    journal.write(json.dumps(done[seed]) + "\n")
    except KeyboardInterrupt:
        print(f"stopped after {len(done)} cases")
    findings = sum(one["wrong"] is not None for one in done.values())
    print(dict(Counter(one["outcome"] for one in done.values()).most_common()), f"{findings} findings")
    for one in sorted(done.values(), key=lambda one: -one["seconds"])[:10]:
        print(f"{one['seconds']:8.2f} s CPU, seed {one['seed']}: {one['what']}: {one['outcome']}")
    return int(findings > 0)


if __name__ == "__main__":
    sys.exit(main())
