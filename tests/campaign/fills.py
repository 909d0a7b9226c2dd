"""Random hostile holes: broken meshes and impossible loops, filled and checked without the library's own code.

`python tests/campaign/fills.py --cases 3000 --seed 1` prints the outcomes by kind, what was wrong and the slowest calls.
Case k of a seed is always the same; `--only K` runs it alone.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from dataclasses import dataclass, field

import gridmesh
import numpy as np

NO_FACES = np.zeros((0, 3), np.int64)
LARGE = 20_000
"""Triangles of a patch up to which time is judged, and beyond which the slower checks are left out."""


# ---------------------------------------------------------------- meshes


def sheet(rng):
    """A bumpy grid."""
    n, m = rng.integers(4, 22, 2)
    i, j = np.meshgrid(np.arange(n + 1), np.arange(m + 1), indexing="ij")
    bump = rng.uniform(0, 1.5) * np.sin(0.5 * i) * np.cos(0.4 * j)
    quad = ((m + 1) * np.arange(n)[:, None] + np.arange(m)).ravel()
    faces = np.r_[np.c_[quad, quad + m + 1, quad + 1], np.c_[quad + m + 1, quad + m + 2, quad + 1]]
    return np.c_[i.ravel(), j.ravel(), bump.ravel()].astype(float), faces


def torus(rng):
    """A closed torus."""
    n, m = rng.integers(5, 26, 2)
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    u, v = 2 * np.pi * i.ravel() / n, 2 * np.pi * j.ravel() / m
    r = 2 + 0.8 * np.cos(v)
    at = lambda a, b: ((i + a) % n * m + (j + b) % m).ravel()  # noqa: E731
    faces = np.r_[np.c_[at(0, 0), at(1, 0), at(0, 1)], np.c_[at(1, 0), at(1, 1), at(0, 1)]]
    return np.c_[r * np.cos(u), r * np.sin(u), 0.8 * np.sin(v)], faces


def tube(rng):
    """An open tube."""
    n, rows = rng.integers(3, 40), rng.integers(2, 6)
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    vertices = np.vstack([np.c_[np.cos(t), np.sin(t), np.full(n, -0.3 * k)] for k in range(rows)])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    faces = [np.r_[np.c_[i, i + n, j], np.c_[j, i + n, j + n]] + k * n for k in range(rows - 1)]
    return vertices, np.concatenate(faces)


def polyhedron(rng):
    """A closed cube or tetrahedron: few faces, many of them joining vertices of a hole."""
    if rng.random() < 0.5:
        return np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]), np.array(
            [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
        )
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])


def pierce(rng, vertices, faces):
    """Take discs of faces away, or random faces."""
    if rng.random() < 0.25:
        return vertices, faces[rng.random(len(faces)) > rng.choice([0.05, 0.2, 0.5])]
    for _ in range(rng.integers(1, 5)):
        gone = np.array([rng.integers(len(vertices))])
        for _ in range(rng.integers(0, 4)):
            gone = np.unique(faces[np.isin(faces, gone).any(axis=1)])
        keep = ~np.isin(faces, gone).any(axis=1)
        if keep.any():
            faces = faces[keep]
    return vertices, faces


# ---------------------------------------------------------------- breakages: (rng, vertices, faces) -> the same


def some(rng, n, most=4):
    return rng.integers(0, n, rng.integers(1, most + 1))


def put_value(values):
    def breakage(rng, vertices, faces):
        vertices = vertices.copy()
        at = some(rng, len(vertices))
        vertices[at, rng.integers(0, 3, len(at))] = rng.choice(values, len(at))
        return vertices, faces

    return breakage


def coincide(rng, vertices, faces):
    vertices = vertices.copy()
    vertices[some(rng, len(vertices))] = vertices[rng.integers(len(vertices))]
    return vertices, faces


def flip(rng, vertices, faces):
    faces = faces.copy()
    at = rng.random(len(faces)) < rng.choice([0.05, 0.5])
    faces[at] = faces[at][:, ::-1]
    return vertices, faces


def double(rng, vertices, faces):
    return vertices, np.r_[faces, faces[some(rng, len(faces))][:, rng.permutation(3)]]


def fins(rng, vertices, faces):
    return vertices, np.r_[faces, rng.integers(0, len(vertices), (rng.integers(1, 6), 3))]


def degenerate(rng, vertices, faces):
    more = []
    for _ in range(rng.integers(1, 12)):
        if len(faces) and rng.random() < 0.3:
            i, k = faces[rng.integers(len(faces))][:2]
        else:
            i, k = rng.integers(0, len(vertices), 2)
        more.append([[i, i, k], [i, k, i], [k, i, i], [i, i, i]][rng.integers(4)])
    return vertices, np.r_[faces, more]


def degenerate_at_border(rng, vertices, faces):
    """Faces (i, i, k) between vertices that lie on borders."""
    edges, counts = np.unique(np.sort(half_edges(faces), axis=1), axis=0, return_counts=True)
    border = np.unique(edges[counts == 1])
    if len(border) < 2:
        return vertices, faces
    pairs = rng.choice(border, (rng.integers(1, 2 * len(border)), 2))
    return vertices, np.r_[faces, np.c_[pairs[:, 0], pairs[:, 0], pairs[:, 1]]]


def missing_vertices(rng, vertices, faces):
    faces = faces.copy()
    if len(faces):
        faces[rng.integers(len(faces)), rng.integers(3)] = rng.choice([len(vertices), -1, 2**31 - 1])
    return vertices, faces


def chords(rng, vertices, faces):
    """Faces that join vertices of borders across the holes."""
    edges, counts = np.unique(np.sort(half_edges(faces), axis=1), axis=0, return_counts=True)
    border = np.unique(edges[counts == 1])
    if len(border) < 3:
        return vertices, faces
    more = rng.choice(border, (rng.integers(1, 8), 3))
    return vertices, np.r_[faces, more[(more[:, 0] != more[:, 1]) & (more[:, 1] != more[:, 2])]]


def jitter(rng, vertices, faces):
    return vertices + rng.normal(0, rng.choice([1e-6, 0.1, 1.0]), vertices.shape), faces


def flatten(rng, vertices, faces):
    vertices = vertices.copy()
    vertices[:, : rng.integers(1, 4)] = 0
    return vertices, faces


def scale(rng, vertices, faces):
    with np.errstate(over="ignore"):
        return vertices * 10.0 ** rng.choice([-200, -70, -55, -20, 20, 55, 70, 200]), faces


def shift(rng, vertices, faces):
    return vertices + 10.0 ** rng.choice([3, 8, 12, 16]), faces


BREAKAGES = {
    "nan": put_value([np.nan]),
    "infinite": put_value([np.inf, -np.inf]),
    "huge": put_value([1e60, 1e150, 1e300, -1.7e308]),
    "tiny": put_value([1e-300, 5e-324]),
    "coincide": coincide,
    "flip": flip,
    "double": double,
    "fins": fins,
    "degenerate": degenerate,
    "degenerate_at_border": degenerate_at_border,
    "missing_vertices": missing_vertices,
    "chords": chords,
    "jitter": jitter,
    "flatten": flatten,
    "scale": scale,
    "shift": shift,
}


# ---------------------------------------------------------------- loops of space


def fourier(rng, n):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    waves = rng.normal(0, 1, (3, 2, 6)) / np.arange(1, 7) ** 1.5
    return np.einsum(
        "xsk,skn->nx",
        waves,
        np.stack([np.sin(np.outer(np.arange(1, 7), t)), np.cos(np.outer(np.arange(1, 7), t))]),
    )


def noise(rng, n):
    return rng.uniform(-1, 1, (n, 3))


def walk(rng, n):
    steps = rng.normal(0, 1, (n, 3))
    return np.cumsum(steps - steps.mean(axis=0), axis=0)


def knot(rng, n):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    p, q = rng.choice([[2, 3], [3, 2], [2, 5], [3, 5], [5, 2]])
    r = 2 + np.cos(q * t)
    return np.c_[r * np.cos(p * t), r * np.sin(p * t), -np.sin(q * t)]


def moebius(rng, n):
    t = np.linspace(0, 4 * np.pi, n, endpoint=False)
    w = rng.uniform(0.1, 0.9)
    return np.c_[(1 + w * np.cos(t / 2)) * np.cos(t), (1 + w * np.cos(t / 2)) * np.sin(t), w * np.sin(t / 2)]


def star(rng, n):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = 1 + rng.uniform(0, 0.95) * np.sin(rng.integers(3, 12) * t)
    return np.c_[r * np.cos(t), r * np.sin(t), rng.choice([0, 0.3]) * np.cos(3 * t)]


def spiral(rng, n):
    half = n // 2
    t = np.linspace(0, rng.uniform(1, 6) * 2 * np.pi, half)
    out, back = (1 + 0.2 * t)[:, None], (1.08 + 0.2 * t[::-1])[:, None]
    ring = np.c_[np.cos(t), np.sin(t)]
    return np.c_[np.r_[out * ring, back * ring[::-1]], np.zeros(2 * half)]


def noisy_circle(rng, n):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.c_[np.cos(t), np.sin(t), 0 * t] + rng.normal(0, rng.choice([0.01, 0.1, 0.5]), (n, 3))


def uneven_circle(rng, n):
    t = (
        np.sort(rng.uniform(0, 2 * np.pi, n))
        if rng.random() < 0.5
        else 2 * np.pi * np.linspace(0, 1, n + 1)[:-1] ** 4
    )
    return np.c_[np.cos(t), np.sin(t), 0.2 * np.cos(2 * t)]


def needle(rng, n):
    x = np.r_[np.linspace(0, 1, n - n // 2), np.linspace(1, 0, n // 2 + 2)[1:-1]]
    return np.c_[
        x, 10.0 ** -rng.integers(1, 18) * np.sin(np.pi * x + (np.arange(len(x)) >= n - n // 2) * np.pi), 0 * x
    ]


def line(rng, n):
    return np.outer(np.sort(rng.uniform(-1, 1, n)), rng.normal(0, 1, 3))


def planar_noise(rng, n):
    return np.c_[rng.uniform(-1, 1, (n, 2)), np.zeros(n)]


def whole_numbers(rng, n):
    return rng.integers(-4, 5, (n, 3)).astype(float)


def staircase(rng, n):
    steps = np.eye(3)[rng.integers(0, 3, n)] * rng.choice([-1, 1], (n, 1))
    return np.cumsum(steps, axis=0) + 1e-3 * rng.normal(0, 1, (n, 3))


LOOPS = {
    f.__name__: f
    for f in (
        fourier, noise, walk, knot, moebius, star, spiral, noisy_circle, uneven_circle, needle, line, planar_noise,
        whole_numbers, staircase,
    )
}  # fmt: skip


# ---------------------------------------------------------------- checks


def half_edges(faces):
    """Directed edges of triangles, or of quads."""
    n = faces.shape[1]
    return np.concatenate([faces[:, [k, (k + 1) % n]] for k in range(n)])


def keys(pairs):
    """One number for each undirected edge."""
    low, high = pairs.min(axis=1).astype(np.int64), pairs.max(axis=1).astype(np.int64)
    return low << 32 | high


def faults(vertices, faces, loop, fill, others=()):
    """What a fill has got wrong. `others`: fills of the same call that came before."""
    n, loop = len(vertices), np.asarray(loop, np.int64)
    faces_of = faces_by_size(fill)
    cut, new = cut_up(fill), fill.vertices
    found = []

    def expect(right, what):
        if not right:
            found.append(what)

    expect(np.array_equal(fill.loop, loop), "the loop is another one")
    expect(np.isfinite(new).all(), "a new vertex is not finite")
    expect(len(cut) and cut.min() >= 0 and cut.max() < n + len(new), "vertices out of range")
    if found:
        return found
    for same in faces_of:
        expect(((np.sort(same, axis=1)[:, 1:] - np.sort(same, axis=1)[:, :-1]) > 0).all(), "a corner twice")
    if len(fill.quads):
        expect(len(fill.triangles) == len(loop) % 2, "not one triangle for an odd loop, none for an even one")
    used = np.unique(cut)
    expect(np.array_equal(used[used < n], np.sort(loop)), "other vertices than the loop's at the boundary")
    expect(np.array_equal(used[used >= n], np.arange(n, n + len(new))), "unused new vertices")
    edges = np.concatenate([half_edges(same) for same in faces_of])
    directed = edges[:, 0] << 32 | edges[:, 1]
    expect(len(np.unique(directed)) == len(directed), "an edge twice in one direction")
    unique, counts = np.unique(keys(edges), return_counts=True)
    expect(counts.max() <= 2, "an edge of three faces")
    rim = np.c_[loop, np.roll(loop, -1)]
    expect(np.array_equal(unique[counts == 1], np.sort(keys(rim))), "not one face at each edge of the loop")
    expect(len(used) - len(unique) + sum(map(len, faces_of)) == 1, "not a disk (Euler)")
    expect(pieces(cut, used) == 1, "not a disk (pieces)")
    expect(fans_close(cut, set(loop.tolist())), "not a disk (fans)")
    if len(faces):
        real = faces[(faces >= 0).all(axis=1) & (faces < n).all(axis=1)]
        old = keys(half_edges(real))
        expect(not np.isin(unique[counts == 2], old).any(), "a new edge repeats one of the mesh")
        rows = {tuple(row) for row in np.sort(real, axis=1).tolist()}
        expect(
            not any(tuple(row) in rows for row in np.sort(fill.triangles, axis=1).tolist()), "a face repeats"
        )
        sound = real[(real[:, 0] != real[:, 1]) & (real[:, 1] != real[:, 2]) & (real[:, 2] != real[:, 0])]
        there = half_edges(sound)
        along = np.isin(there[:, 0] << 32 | there[:, 1], directed).sum()
        wrong = fill.report["winding_conflicts"]
        expect(along == wrong, f"{along} edges are wound like their neighbour, {wrong} reported")
        beside = np.isin(keys(rim), keys(there)).sum()
        expect(2 * along <= beside, "wound like most neighbours")
        expect(fill.report["wire_edges"] == len(rim) - beside, "wire edges")
    for other in others:
        mine = unique[counts == 2]
        theirs = np.concatenate([keys(half_edges(same)) for same in faces_by_size(other)])
        high, low = (mine & 0xFFFFFFFF) < n, (mine >> 32) < n
        expect(not np.isin(mine[high & low], theirs).any(), "a new edge repeats one of another fill")
    expect(fill.report["triangles"] == len(fill.triangles), "number of triangles")
    expect(fill.report["quads"] == len(fill.quads), "number of quads")
    return found


def faces_by_size(fill):
    """The triangles and the quads of a fill."""
    return [fill.triangles.astype(np.int64), fill.quads.astype(np.int64)]


def cut_up(fill):
    """Triangles, and quads each cut in two."""
    triangles, quads = faces_by_size(fill)
    return np.concatenate([triangles, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def pieces(triangles, used):
    """Number of connected pieces."""
    compact = np.searchsorted(used, triangles)
    label = np.arange(len(used))
    edges = half_edges(compact)
    while True:
        least = label.copy()
        np.minimum.at(least, edges[:, 0], label[edges[:, 1]])
        np.minimum.at(least, edges[:, 1], label[edges[:, 0]])
        least = least[least]
        if np.array_equal(least, label):
            return len(np.unique(label))
        label = least


def fans_close(triangles, loop):
    """One fan at every vertex: open at the loop, closed elsewhere."""
    if len(triangles) > LARGE:
        return True
    following = {}
    for a, b, c in triangles.tolist():
        for vertex, first, second in ((a, b, c), (b, c, a), (c, a, b)):
            following.setdefault(vertex, {})[first] = second
    for vertex, fan in following.items():
        starts = set(fan) - set(fan.values())
        if len(starts) != (vertex in loop):
            return False
        at = first = next(iter(starts or fan))
        steps = 0
        while at in fan:
            at = fan[at]
            steps += 1
            if at == first:
                break
        if steps != len(fan):
            return False
    return True


# ---------------------------------------------------------------- one case


@dataclass
class Case:
    """A call and what came of it."""

    number: int
    name: str = ""
    outcomes: list[str] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)
    seconds: float = 0.0
    triangles: int = 0
    longest_wait: float = 0.0
    """Between two reports of progress."""


@dataclass
class Listener:
    """A progress callback that looks whether fractions grow, and may cancel."""

    stop_at: float = np.inf
    last: float = 0.0
    wrong: str = ""
    stopped: bool = False
    longest: float = 0.0
    since: float = field(default_factory=time.perf_counter)

    def __call__(self, fraction):
        """Take a report."""
        now = time.perf_counter()
        self.longest, self.since = max(self.longest, now - self.since), now
        if not 0 <= fraction <= 1:
            self.wrong = f"progress is {fraction}"
        if fraction < self.last - 1e-12:
            self.wrong = f"progress falls from {self.last} to {fraction}"
        if self.stopped:
            self.wrong = "progress after cancelling"
        self.last = max(self.last, fraction)
        self.stopped = fraction >= self.stop_at
        return not self.stopped

    def end(self):
        """Count the time to the end, too."""
        self.longest = max(self.longest, time.perf_counter() - self.since)


def dressed(rng, array, kinds):
    """The same numbers in another dtype, order or layout."""
    kind = rng.choice(kinds)
    if kind == "fortran":
        return np.asfortranarray(array)
    if kind == "strided":
        return np.repeat(array, 2, axis=0)[::2]
    if kind == "read_only":
        array = array.copy()
        array.setflags(write=False)
        return array
    if kind == "list":
        return array.tolist()
    return array.astype(kind)


def borders(faces):
    """Simple boundary loops, found by following edges of one face: those whose vertices have two such edges."""
    sound = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    if not len(sound):
        return []
    edges = half_edges(sound)
    unique, counts = np.unique(keys(edges), return_counts=True)
    once = unique[counts == 1]
    near = {}
    for a, b in np.c_[once >> 32, once & 0xFFFFFFFF].tolist():
        near.setdefault(a, []).append(b)
        near.setdefault(b, []).append(a)
    loops, seen = [], set()
    for start in near:
        path, before = [], None
        at = start
        while at not in seen and len(near[at]) == 2:
            seen.add(at)
            path.append(at)
            onward = [v for v in near[at] if v != before] or near[at]
            before, at = at, onward[0]
        if at == start and len(path) >= 3:
            loops.append(path)
    return loops


def run(number, seed, cells="triangles"):
    """Make and check case `number` of a seed."""
    rng = np.random.default_rng([seed, number])
    case = Case(number)
    if rng.random() < 0.35:
        vertices, faces, loops = space_loop(rng, case)
    else:
        shape = (sheet, torus, tube, polyhedron)[rng.integers(4)]
        vertices, faces = pierce(rng, *shape(rng))
        case.name = shape.__name__
        for name in rng.choice(list(BREAKAGES), rng.choice([0, 1, 1, 1, 2, 3]), replace=False):
            vertices, faces = BREAKAGES[name](rng, vertices, faces)
            case.name += f" {name}"
        loops = borders(faces) or [rng.permutation(len(vertices))[: rng.integers(3, 9)].tolist()]
    way = rng.choice(["fill_hole", "fill_holes", "all", "regrid"], p=[0.4, 0.3, 0.2, 0.1])
    if not len(faces) and way in ("all", "regrid"):
        way = "fill_hole"
    options = {"smooth": str(rng.choice(["flat", "tangent", "curvature"])), "cells": cells}
    if rng.random() < 0.15:
        options["strict"] = True
    if rng.random() < 0.15 and len(faces):
        options["polygons"] = np.arange(len(faces)) // 2
    listener = None
    if rng.random() < 0.5:
        listener = options["progress"] = Listener(rng.uniform(0, 1) if rng.random() < 0.3 else np.inf)
    case.name = f"{way} {options['smooth']} {case.name}"
    given = dressed(rng, vertices, ["f8", "f8", "f8", "fortran", "strided", "read_only", "list"])
    kinds = ["i4", "i4", "i8", "fortran", "strided", "read_only", ">i4"] + ["list"] * bool(len(faces))
    triangles = dressed(rng, faces, kinds)
    before = np.array(given, copy=True)
    started = time.process_time()
    try:
        with np.errstate(all="ignore"):
            done = call(rng, way, given, triangles, faces, loops, options)
    except gridmesh.GridMeshError as error:
        done = []
        refused(case, error)
    case.seconds = time.process_time() - started
    if listener is not None:
        listener.end()
        case.longest_wait = listener.longest
        if listener.wrong:
            case.wrong.append(listener.wrong)
        if listener.stopped and "cancelled" not in case.outcomes and listener.last < 1:
            case.wrong.append("not cancelled")
    if not np.array_equal(before, np.asarray(given), equal_nan=True):
        case.wrong.append("the mesh was changed")
    fills = []
    for loop, mesh, item in done:
        if isinstance(item, gridmesh.GridMeshError):
            refused(case, item)
            continue
        case.outcomes.append("filled")
        case.triangles = max(case.triangles, len(item.triangles) + 2 * len(item.quads))
        case.wrong += faults(vertices, mesh, item.loop if loop is None else loop, item, fills)
        fills.append(item)
    return case


def refused(case, error):
    """Count an error; a bug of the library is wrong."""
    case.outcomes.append(error.kind)
    if error.kind == "internal" or not str(error):
        case.wrong.append(f"{error.kind}: {error}")


def space_loop(rng, case):
    """A loop without a mesh, or with a few faces at it."""
    maker = LOOPS[rng.choice(list(LOOPS))]
    most = rng.choice([12, 40, 180, 420], p=[0.4, 0.35, 0.2, 0.05])
    vertices = np.ascontiguousarray(maker(rng, rng.integers(3, most)))
    case.name = f"{maker.__name__}({len(vertices)})"
    n = len(vertices)
    loop = np.arange(n)
    if rng.random() < 0.2:
        loop = rng.permutation(n)
    if rng.random() < 0.1:
        loop = np.insert(loop, rng.integers(n + 1), rng.integers(-1, n + 1))
        case.name += " inserted"
    if rng.random() < 0.1:
        vertices[rng.integers(n)] = vertices[rng.integers(n)]
        case.name += " coincide"
    if rng.random() < 0.05:
        vertices[rng.integers(n), rng.integers(3)] = rng.choice([np.nan, np.inf, 1e200])
        case.name += " value"
    faces = NO_FACES
    if rng.random() < 0.3:
        apex = n + np.arange(rng.integers(1, 4))
        vertices = np.r_[vertices, rng.normal(0, 2, (len(apex), 3))]
        k = rng.permutation(n)[: rng.integers(1, n + 1)]
        faces = np.c_[np.arange(n)[k], np.roll(np.arange(n), -1)[k], rng.choice(apex, len(k))]
        case.name += " with faces"
    return vertices, faces, [loop.tolist()]


def call(rng, way, vertices, triangles, faces, loops, options):
    """Call the library: (loop or None, the faces that stay, fill or error) for each loop."""
    if way == "fill_hole":
        loop = loops[rng.integers(len(loops))]
        return [(loop, faces, gridmesh.fill_hole(vertices, triangles, loop, **options))]
    if way == "fill_holes":
        items = gridmesh.fill_holes(vertices, triangles, loops, **options)
        return [(loop, faces, item) for loop, item in zip(loops, items, strict=True)]
    if way == "all":
        most = None if rng.random() < 0.5 else int(rng.integers(3, 60))
        return [
            (None, faces, item)
            for item in gridmesh.fill_holes(vertices, triangles, max_edges=most, **options)
        ]
    seed = faces[rng.integers(len(faces))]
    near = np.isin(faces, seed).any(axis=1)
    if rng.random() < 0.5:
        near = np.isin(faces, faces[near]).any(axis=1)
    chosen = np.flatnonzero(near)
    done = gridmesh.regrid(vertices, triangles, chosen, keep_shape=bool(rng.random() < 0.7), **options)
    return [(None, np.delete(faces, chosen, axis=0), done.fill)]


def campaign(cases, seed, *, cells="triangles", tell=lambda _case: None):
    """Run all cases of a seed."""
    done = []
    for number in range(cases):
        case = run(number, seed, cells)
        tell(case)
        done.append(case)
    return done


def main():
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--cells", choices=("triangles", "quads"), default="triangles")
    options = parser.parse_args()

    def tell(case):
        if case.number % 500 == 499:
            print(f"... {case.number + 1}", flush=True)
        if case.wrong or case.seconds > 5:
            print(f"{case.number}: {case.name}: {case.seconds:.2f} s; {'; '.join(case.wrong)}", flush=True)

    if options.only is not None:
        print(run(options.only, options.seed, options.cells))
        return
    done = campaign(options.cases, options.seed, cells=options.cells, tell=tell)
    print(Counter(outcome for case in done for outcome in case.outcomes).most_common())
    print(f"{sum(bool(case.wrong) for case in done)} of {len(done)} cases wrong")
    for title, key in (("slowest", "seconds"), ("longest without a report", "longest_wait")):
        print(f"{title}:")
        for case in sorted(done, key=lambda case: -getattr(case, key))[:10]:
            print(f"  {getattr(case, key):7.3f} s  {case.number}: {case.name}, {case.triangles} triangles")


if __name__ == "__main__":
    main()
