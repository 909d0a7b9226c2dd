"""Random pairs of loops joined by tubes, checked without the library's own code.

`python tests/campaign/bridges.py --cases 500 --seed 1` prints how regular and well shaped the tubes are, and the slowest; with
`--cells quads` those of quads. Case k of a seed is always the same; `--only K` runs it alone.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass

import gridmesh
import numpy as np

NO_FACES = np.zeros((0, 3), np.int64)
TAU = 2 * np.pi


# ----------------------------------------------------------------------------------------------------- cases


@dataclass
class Case:
    """Two loops, each with or without a collar of faces beyond it."""

    vertices: np.ndarray
    triangles: np.ndarray
    loops: tuple[np.ndarray, np.ndarray]
    smooth: str


def ring(rng, n, radius, tilt, height):
    """A waved circle of n vertices about the z axis, tilted about a random level axis: positions, and the way up."""
    t = TAU * (np.arange(n) / n + rng.random())
    waves, size = rng.integers(2, 5), rng.uniform(0, 0.15) * radius * (n >= 12)
    wave = size * np.cos(waves * t + TAU * rng.random())
    out = radius + rng.uniform(0, 1) * wave
    points = np.c_[out * np.cos(t), out * np.sin(t), rng.uniform(0, 1) * wave]
    a = TAU * rng.random()
    axis = np.array([np.cos(a), np.sin(a), 0])
    turn = rotation(axis, tilt)
    return points @ turn.T + [0, 0, height], turn @ [0, 0, 1.0]


def rotation(axis, angle):
    """The matrix that turns by an angle about an axis."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def collar(ring, first, way, below):
    """Vertices of a row of triangles beyond a ring, away from the other one, and its triangles; `first`: their numbers."""
    n = len(ring)
    edge = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1).mean()
    beyond = 0.5 * (ring + np.roll(ring, -1, axis=0)) + 0.87 * edge * way
    own, far = np.arange(n) + first[0], np.arange(n) + first[1]
    following = np.roll(own, -1)
    faces = np.r_[np.c_[own, far, following], np.c_[following, far, np.roll(far, -1)]]
    return beyond, faces if below else faces[:, ::-1]


def case(seed, number):
    """Two loops of 5 to 200 vertices: sizes up to 1 : 3, tilted by up to 60 degrees to each other, waved."""
    rng = np.random.default_rng([seed, number])
    n, m = rng.integers(5, 201, 2)
    radius = 3 ** rng.uniform(-1, 1)
    share = rng.random()
    tilt = rng.uniform(0, np.pi / 3)
    # Far enough apart not to cross.
    reach = np.sin(share * tilt) + radius * np.sin((1 - share) * tilt) + 0.15 * (1 + radius)
    height = reach + rng.uniform(0.2, 2.0) * max(1, radius)
    lower, up = ring(rng, n, 1, share * tilt, 0)
    upper, on = ring(rng, m, radius, -(1 - share) * tilt, height)
    vertices, triangles = [lower, upper], NO_FACES
    if rng.random() < 0.5:
        one, faces = collar(lower, (0, n + m), -up, True)
        two, more = collar(upper, (n, 2 * n + m), on, False)
        vertices, triangles = [lower, upper, one, two], np.r_[faces, more]
    loops = np.roll(np.arange(n), rng.integers(n)), n + np.roll(np.arange(m), rng.integers(m))
    if rng.random() < 0.5:
        loops = loops[0][::-1], loops[1]
    if rng.random() < 0.5:
        loops = loops[1], loops[0]
    smooth = ["flat", "tangent", "curvature"][rng.choice(3, p=[0.2, 0.7, 0.1])]
    return Case(np.vstack(vertices), triangles, loops, smooth)


# ---------------------------------------------------------------------------------------------------- checks


def half_edges(*faces):
    """The directed sides of triangles or quads."""
    return np.concatenate([np.stack([f, np.roll(f, -1, axis=1)], axis=2).reshape(-1, 2) for f in faces])


def faults(case, fill):
    """What a tube breaks of what is promised of it."""
    n, found = len(case.vertices), []
    one, two = case.loops
    if not np.array_equal(fill.loop, np.r_[one, two]):
        found.append("the loops are not those given")
    if len(fill.quads) and len(fill.triangles) != (len(one) + len(two)) % 2:
        found.append("not one triangle for an odd sum and none for an even one")
    new = half_edges(fill.triangles, fill.quads)
    sides = np.r_[half_edges(case.triangles), new].astype(np.int64)
    _, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    own, times = np.unique(np.sort(new, axis=1), axis=0, return_counts=True)
    wanted = np.sort(np.vstack([np.c_[loop, np.roll(loop, -1)] for loop in case.loops]), axis=1)
    if not np.array_equal(own[times == 1], np.unique(wanted, axis=0)) or times.max() > 2:
        found.append("a loop edge has not one new face, or another not two")
    if counts.max() > 2:
        found.append("an edge is repeated")
    if len(np.unique(sides, axis=0)) != len(sides):
        found.append("wound against a neighbour")
    if set(new.ravel()) != set(one) | set(two) | set(range(n, n + len(fill.vertices))):
        found.append("vertices are not the loops' and the new ones")
    if len(one) + len(two) + len(fill.vertices) - len(own) + len(fill.triangles) + len(fill.quads) != 0:
        found.append("not an annulus")
    if not np.isfinite(fill.vertices).all():
        found.append("not finite")
    return found


@dataclass
class Measure:
    """How good a tube is."""

    irregular: float
    excess: float
    angle: float
    ratio: float
    meetings: int
    seconds: float
    grid: str


def measure(case, fill, seconds):
    """Regularity and shape, from the mesh alone."""
    if len(fill.quads):
        return measure_quads(case, fill, seconds)
    loops = np.concatenate(case.loops)
    valence = np.bincount(
        np.unique(np.sort(all_sides(case.triangles, fill.triangles), axis=1), axis=0).ravel()
    )
    outside = np.full(len(case.vertices), 4)
    if len(case.triangles):
        around = np.unique(np.sort(all_sides(case.triangles), axis=1), axis=0)
        outside = 8 - np.bincount(around.ravel(), minlength=len(case.vertices))
    own = np.unique(np.sort(all_sides(fill.triangles), axis=1), axis=0)
    patch = np.bincount(own.ravel(), minlength=len(case.vertices))
    inner = valence[len(case.vertices) :]
    corners = np.vstack([case.vertices, fill.vertices])[fill.triangles]
    sides = [np.linalg.norm(corners[:, (k + 1) % 3] - corners[:, (k + 2) % 3], axis=1) for k in range(3)]
    a, b, c = sides
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    angles = [2 * area / (sides[k - 1] * sides[k - 2]) for k in range(3)]
    cosines = [(sides[k - 1] ** 2 + sides[k - 2] ** 2 - sides[k] ** 2) for k in range(3)]
    cosines = [cosines[k] / (2 * sides[k - 1] * sides[k - 2]) for k in range(3)]
    least = np.degrees(np.arctan2(np.array(angles), np.array(cosines)).min())
    return Measure(
        irregular=float((inner != 6).mean()) if len(inner) else 0.0,
        excess=float(np.abs(patch[loops] - outside[loops]).mean()),
        angle=float(least),
        ratio=float((16 * area**2 / (a * b * c * (a + b + c))).mean()),
        meetings=fill.report["self_intersections"],
        seconds=seconds,
        grid=fill.report["grid"],
    )


def measure_quads(case, fill, seconds):
    """Poles inside, and how far the loops' vertices are from two new quads; the corners' distance from a right angle as `angle`
    (least) and `ratio` (mean, as a share of a right angle that is left).
    """
    at = np.bincount(np.r_[fill.quads.ravel(), fill.triangles.ravel()], minlength=len(case.vertices))
    inner = at[len(case.vertices) :]
    points = np.vstack([case.vertices, fill.vertices])[fill.quads]
    ahead, back = np.roll(points, -1, axis=1) - points, np.roll(points, 1, axis=1) - points
    cross = np.linalg.norm(np.cross(ahead, back), axis=2)
    corners = np.degrees(np.arctan2(cross, (ahead * back).sum(axis=2)))
    return Measure(
        irregular=float((inner != 4).mean()) if len(inner) else 0.0,
        excess=float(np.abs(at[np.concatenate(case.loops)] - 2).mean()),
        angle=float(corners.min()),
        ratio=float(1 - np.abs(corners - 90).mean() / 90),
        meetings=fill.report["self_intersections"],
        seconds=seconds,
        grid=fill.report["grid"],
    )


def all_sides(*faces):
    """The sides of triangles."""
    return np.concatenate(faces)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)


def run(case, cells="triangles"):
    """The tube and its measure."""
    start = time.process_time()
    fill = gridmesh.bridge(case.vertices, case.triangles, *case.loops, smooth=case.smooth, cells=cells)
    return fill, measure(case, fill, time.process_time() - start)


def campaign(cases, seed, cells="triangles"):
    """What is wrong, by case, and the measures."""
    wrong, measures = {}, []
    for number in range(cases):
        it = case(seed, number)
        fill, found = run(it, cells)
        measures.append(found)
        if bad := faults(it, fill):
            wrong[number] = bad
    return wrong, measures


def main():
    """Print numbers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--cells", choices=["triangles", "quads"], default="triangles")
    options = parser.parse_args()
    if options.only is not None:
        it = case(options.seed, options.only)
        fill, found = run(it, options.cells)
        print([len(loop) for loop in it.loops], it.smooth, len(it.triangles) > 0, found)
        print(faults(it, fill), fill.report)
        return
    wrong, measures = campaign(options.cases, options.seed, options.cells)
    print(f"{options.cases} pairs of loops, seed {options.seed}: {len(wrong)} broken {wrong or ''}")
    for name, best in [
        ("irregular", 0),
        ("excess", 0),
        ("angle", 1),
        ("ratio", 1),
        ("meetings", 0),
        ("seconds", 0),
    ]:
        values = np.array([getattr(it, name) for it in measures])
        tail = np.percentile(values, 10 if best else 90)
        print(f"{name:10} median {np.median(values):.4f}  mean {values.mean():.4f}  one in ten {tail:.4f}")
    worst = sorted(range(len(measures)), key=lambda k: measures[k].angle)[:8]
    print("graded:", sum(it.grid == "graded" for it in measures), " thinnest:")
    for number in worst:
        it = case(options.seed, number)
        print("  case", number, [len(loop) for loop in it.loops], measures[number])


if __name__ == "__main__":
    main()
