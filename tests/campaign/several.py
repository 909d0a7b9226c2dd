"""Random patches between three and more loops, checked without the library's own code.

`python tests/campaign/several.py --cases 60 --seed 1 --cells quads` prints how regular and well shaped they are, and which meet
themselves; with `--sheets` between holes in sheets, without between pieces of balls. Case k of a seed is always the same; `--only K` runs it alone.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter

import gridmesh
import numpy as np
from bridges import half_edges
from holed import sheet, with_holes


def ball(rings, around):
    """Vertices and triangles of a closed ball of radius 1."""
    heights = np.linspace(0, np.pi, rings + 1)[1:-1]
    angles = np.linspace(0, 2 * np.pi, around, endpoint=False)
    points = [(np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t)) for t in heights for a in angles]
    i, j = np.arange(around), (np.arange(around) + 1) % around
    rows = [
        np.r_[np.c_[i, i + around, j], np.c_[j, i + around, j + around]] + around * k
        for k in range(rings - 2)
    ]
    last = (rings - 2) * around
    poles = np.r_[np.c_[0 * i + len(points), i, j], np.c_[0 * i + len(points) + 1, last + j, last + i]]
    return np.array([*points, (0, 0, 1), (0, 0, -1)]), np.concatenate([*rows, poles])


def boundary_loops(faces):
    """The loops of open edges, as the missing surface's boundary runs; none if one passes through a vertex twice."""
    sides = {tuple(side) for side in half_edges(faces).tolist()}
    following = {}
    for a, b in sides:
        if (b, a) not in sides:
            if b in following:
                return []
            following[b] = a
    loops = []
    while following:
        start, after = following.popitem()
        loop = [start]
        while after != start:
            loop.append(after)
            after = following.pop(after)
        loops.append(loop)
    return sorted(loops, key=min)


def case(seed, number, rings=60, around=110):
    """A ball of which only some caps are left, or all but those: vertices, faces, loops. Caps that touch are drawn anew."""
    rng = np.random.default_rng([seed, number])
    while True:
        vertices, faces = ball(rings, around)
        count = rng.integers(3, 9)
        poles = rng.normal(size=(count, 3))
        poles /= np.linalg.norm(poles, axis=1, keepdims=True)
        sizes = rng.uniform(0.06, 0.45, count)
        middles = vertices[faces].mean(axis=1)
        middles /= np.linalg.norm(middles, axis=1, keepdims=True)
        faces = faces[(middles @ poles.T > np.cos(sizes)).any(axis=1)]
        vertices = vertices * rng.uniform(0.5, 1.5, 3)
        loops = boundary_loops(faces)
        if len(loops) == count:
            return vertices, faces, loops


def sheets(seed, number, rings=60):
    """A waved sheet with holes: vertices, faces, and the loops of the holes. Holes that touch are drawn anew."""
    rng = np.random.default_rng([seed, number])
    wave, bend, along = rng.uniform(0, 0.1), rng.uniform(-0.2, 0.2), rng.uniform(-2, 2, 2)
    vertices, quads = sheet(
        lambda x, y: wave * np.sin(along[0] * x + along[1] * y) + bend * (x * x + y * y), 2 * rings
    )
    while True:
        count = rng.integers(3, 7)
        x, y = rng.uniform(-1.4, 1.4, (2, count))
        centres = np.c_[x, y, wave * np.sin(along[0] * x + along[1] * y) + bend * (x * x + y * y)]
        sizes = rng.uniform(0.15, 0.45, count)
        gaps = np.linalg.norm(centres[:, None] - centres, axis=2) - sizes - sizes[:, None]
        if gaps[np.triu_indices(count, 1)].min() > 0.15:
            faces, _, loops = with_holes(vertices, quads, centres, sizes)
            return vertices, faces, loops


def faults(vertices, faces, loops, fill):
    """What a patch breaks of what is promised of it."""
    n, found = len(vertices), []
    own = half_edges(fill.triangles, fill.quads)
    new = Counter(map(tuple, own.tolist()))
    everything = Counter(map(tuple, np.r_[half_edges(faces), own].tolist()))
    if max(everything.values()) > 1:
        found.append("an edge is repeated, or wound against a neighbour")
    rims = {frozenset(e) for loop in loops for e in zip(loop, [*loop[1:], loop[0]], strict=True)}
    if {frozenset(e) for e in new if e[::-1] not in new} != rims:
        found.append("a loop edge has not one new face, or another not two")
    used = {v for side in new for v in side}
    if used != {v for loop in loops for v in loop} | set(range(n, n + len(fill.vertices))):
        found.append("vertices are not the loops' and the new ones")
    edges = {frozenset(e) for e in new}
    if len(used) - len(edges) + len(fill.triangles) + len(fill.quads) != 2 - len(loops):
        found.append("not a sphere with as many holes as loops")
    if len(fill.quads) and len(fill.triangles) != sum(map(len, loops)) % 2:
        found.append("not one triangle for an odd sum and none for an even one")
    if not np.isfinite(fill.vertices).all():
        found.append("not finite")
    return found


def corners(vertices, fill):
    """Corners of the new faces, in degrees."""
    found = []
    for faces in (fill.quads, fill.triangles):
        points = np.r_[vertices, fill.vertices][faces]
        ahead, back = np.roll(points, -1, axis=1) - points, np.roll(points, 1, axis=1) - points
        cross = np.linalg.norm(np.cross(ahead, back), axis=2)
        found.append(np.degrees(np.arctan2(cross, (ahead * back).sum(axis=2))).ravel())
    return np.concatenate(found)


def main():
    """Print numbers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--cells", choices=["triangles", "quads"], default="triangles")
    parser.add_argument("--rings", type=int, default=60)
    parser.add_argument("--sheets", action="store_true")
    options = parser.parse_args()
    rows, broken, meeting = [], {}, {}
    for number in range(options.cases) if options.only is None else [options.only]:
        if options.sheets:
            vertices, faces, loops = sheets(options.seed, number, options.rings)
        else:
            vertices, faces, loops = case(options.seed, number, options.rings, options.rings * 11 // 6)
        start = time.process_time()
        fill = gridmesh.fill_hole(vertices, faces, loops, cells=options.cells)
        seconds = time.process_time() - start
        if bad := faults(vertices, faces, loops, fill):
            broken[number] = bad
        if pairs := fill.report["self_intersections"]:
            meeting[number] = pairs
        angles = corners(vertices, fill)
        rows.append(
            (
                fill.report["irregular"] / max(1, len(fill.vertices)),
                fill.report["irregular_loop"] / sum(map(len, loops)),
                angles.min(),
                angles.max(),
                fill.report["folds"],
                seconds,
            )
        )
        if options.only is not None:
            print([len(loop) for loop in loops], fill.report)
    print(
        f"{len(rows)} patches, seed {options.seed}: {len(broken)} broken {broken or ''}, {len(meeting)} meet {meeting}"
    )
    names = ["irregular", "at loops", "least", "greatest", "folds", "seconds"]
    for name, values in zip(names, np.array(rows).T, strict=True):
        low, middle, high = np.percentile(values, [10, 50, 90])
        print(f"{name:10} median {middle:8.3f}  one in ten below {low:8.3f}, above {high:8.3f}")


if __name__ == "__main__":
    main()
