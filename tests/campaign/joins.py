"""Random bodies joined, checked without the library's own code.

`python tests/campaign/joins.py FOLDER --cases 200 --seed 1` takes outlines from the curves in FOLDER (JSON lines with "points"; without
it, those in tests/sketches), inflates pairs and triples of them, puts limbs at random places and depths, and prints how many are joined
and how good the joints are. Case k of a seed is always the same; `--only K` runs it alone, `--save FILE.npz` keeps its meshes.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import gridmesh
import numpy as np

SKETCHES = Path(__file__).resolve().parents[1] / "sketches"
HAND = ("hand_character", "hand_quickdraw", "icons", "mpeg7", "ne110m")


# ----------------------------------------------------------------------------------------------------- cases


@dataclass
class Case:
    """Bodies, and how they are joined."""

    parts: list
    blend: float = 2.0
    names: list = field(default_factory=list)

    def join(self, **options):
        """The joined mesh."""
        parts = [(vertices, triangles) for vertices, triangles in self.parts]
        return gridmesh.join(parts, blend=self.blend, **options)


@cache
def outlines(folder):
    """Names and outlines, each scaled to size 1 around the origin."""
    found = []
    if folder is None:
        for file in sorted((SKETCHES / "drawings").glob("*.json")):
            found.append((file.stem, np.array(json.loads(file.read_text(encoding="utf-8"))["points"], float)))
    else:
        for name in HAND:
            for line in (Path(folder) / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()[:400]:
                row = json.loads(line)
                found.append((f"{name}/{row['name']}", np.array(row["points"], float)))
    return [(name, scaled(points)) for name, points in found]


def scaled(points):
    """Of size 1, around the origin."""
    low, high = points.min(axis=0), points.max(axis=0)
    return (points - 0.5 * (low + high)) / (high - low).max()


def rotation(axis, angle):
    """The matrix that turns by an angle about an axis."""
    x, y, z = axis / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def limb(rng):
    """The outline of a limb, along x from the origin: a bent sausage, thicker at one end."""
    t = np.linspace(0, np.pi, 40)
    length, start, end = rng.uniform(0.5, 0.9), rng.uniform(0.07, 0.14), rng.uniform(0.07, 0.16)
    bend = rng.uniform(-0.5, 0.5)
    s = np.linspace(0, 1, 30)[1:-1]
    widths = start + (end - start) * s
    round_end = np.c_[length + end * np.sin(t), -end * np.cos(t)]
    round_start = np.c_[-start * np.sin(t), start * np.cos(t)]
    outline = np.vstack([np.c_[s * length, -widths], round_end, np.c_[s * length, widths][::-1], round_start])
    outline[:, 1] += bend * outline[:, 0] ** 2
    return outline


def body(outline, edge, depth):
    """Vertices and triangles of an inflated outline."""
    surface = gridmesh.inflate(gridmesh.mesh_sketch(outline, edge_length=edge), depth=depth)
    return surface.vertices, surface.triangles


def case(seed, number, folder=None):
    """A body with one or two others at random places, or limbs; None if an outline cannot be meshed."""
    rng = np.random.default_rng([seed, number])
    known = outlines(folder)
    parts, names = [], []
    edge = rng.uniform(0.012, 0.03)
    for k in range(rng.integers(2, 4)):
        is_limb = k > 0 and rng.random() < 0.6
        name, outline = ("limb", limb(rng)) if is_limb else known[rng.integers(len(known))]
        size = rng.uniform(0.4, 1.0) if k else 1.0
        own = edge * (1.0 if rng.random() < 0.7 else rng.uniform(0.6, 1.6))
        try:
            vertices, triangles = body(size * outline, own, rng.uniform(0.7, 1.2))
        except gridmesh.GridMeshError:
            return None
        if k:
            # A point of the part comes to a vertex of the first body, moved in depth.
            vertices = vertices - vertices[rng.integers(len(vertices))] * [1, 1, 0] * (not is_limb)
            if is_limb or rng.random() < 0.3:
                vertices = vertices @ rotation(np.array([0, 0, 1.0]), rng.uniform(0, 2 * np.pi)).T
            if rng.random() < 0.3:
                axis = np.r_[rng.normal(size=2), 0]
                vertices = vertices @ rotation(axis, rng.uniform(-1.2, 1.2)).T
            first = parts[0][0]
            place = first[rng.integers(len(first))] * [1, 1, rng.choice([0, 0.5, 1.0])]
            vertices = vertices + place
        parts.append((np.ascontiguousarray(vertices), triangles))
        names.append(name)
    return Case(parts, names=names)


# ---------------------------------------------------------------------------------------------------- checks


def sides(triangles):
    """The directed sides of triangles."""
    return np.asarray(triangles, np.int64)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)


def polygon_sides(mesh):
    """The directed sides of faces with any number of corners: those of a joined mesh, or of a piece of a cut one."""
    after = np.arange(len(mesh.corners)) + 1
    after[mesh.offsets[1:] - 1] = mesh.offsets[:-1]
    return np.c_[mesh.corners, mesh.corners[after]].astype(np.int64)


def close(directed):
    """Whether every directed side is there once, and so is the one against it."""
    codes, turned = directed[:, 0] << 32 | directed[:, 1], directed[:, 1] << 32 | directed[:, 0]
    return len(np.unique(codes)) == len(codes) and np.array_equal(np.sort(codes), np.sort(turned))


def pieces(triangles):
    """How many pieces triangles make that hang together by vertices."""
    root = np.arange(triangles.max() + 1)
    while True:
        least = root[triangles].min(axis=1)
        lower = root.copy()
        np.minimum.at(lower, triangles.ravel(), np.repeat(least, 3))
        if np.array_equal(lower, root):
            return len(np.unique(root[triangles]))
        root = lower


def fanned(joined):
    """All faces as triangles, and the face of each."""
    rows = []
    for f, (a, b) in enumerate(zip(joined.offsets[:-1], joined.offsets[1:], strict=True)):
        own = joined.corners[a:b]
        rows += [(own[0], own[k], own[k + 1], f) for k in range(1, len(own) - 1)]
    rows = np.array(rows, np.int64).reshape(-1, 4)
    return rows[:, :3], rows[:, 3]


def volume(vertices, triangles):
    """The volume enclosed."""
    a, b, c = (vertices[triangles[:, k]] - vertices[0] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def faults(parts, joined):
    """What a joined mesh breaks of what is promised; `parts`: pairs of vertices and faces of three or four corners."""
    found = []
    triangles, _ = fanned(joined)
    every = sides(triangles)
    if not close(every):
        found.append("not closed and manifold")
    used = np.unique(triangles)
    if not np.array_equal(used, np.arange(len(joined.vertices))):
        found.append("unused vertices")
    euler = len(joined.vertices) - len(every) // 2 + len(triangles)
    if euler != 2 * joined.report["components"] - 2 * joined.report["genus"]:
        found.append("genus is not as told")
    if not np.isfinite(joined.vertices).all():
        found.append("not finite")
    new = joined.vertex_part < 0
    for k, (vertices, faces) in enumerate(parts):
        mine = joined.vertex_part == k
        if not np.array_equal(joined.vertices[mine], np.asarray(vertices)[joined.source_vertex[mine]]):
            found.append(f"vertices of part {k} have moved")
        faces = np.asarray(faces)
        for f in np.flatnonzero(joined.source_part == k):
            own = joined.corners[joined.offsets[f] : joined.offsets[f + 1]]
            if not np.array_equal(joined.source_vertex[own], faces[joined.source_face[f]]):
                found.append(f"a face of part {k} has changed")
                break
    if not np.array_equal(new, joined.source_vertex < 0):
        found.append("sources disagree")
    for rims in joined.collars:
        for rim in rims:
            if len(set(rim.tolist())) != len(rim) or new[rim].any():
                found.append("a rim is not simple, or not of old vertices")
    return found


@dataclass
class Measure:
    """How good a joint is."""

    irregular: float
    collar: float
    angle: float
    ratio: float
    volume: float
    meetings: int
    seconds: float
    new: int


def measure(joined, seconds):
    """Regularity and shape, from the mesh alone."""
    triangles, face = fanned(joined)
    new = joined.source_part[face] < 0
    valence = np.bincount(np.unique(np.sort(sides(triangles), axis=1), axis=0).ravel())
    fresh = joined.vertex_part < 0
    corners = joined.vertices[triangles]
    edges = np.stack([np.linalg.norm(corners[:, k] - corners[:, k - 1], axis=1) for k in range(3)])
    # Edges of collars against the mean of the old edges at their rims.
    ratio, angle = 1.0, 60.0
    if new.any():
        rim = np.concatenate([rim for rims in joined.collars for rim in rims] or [np.zeros(0, np.int64)])
        beside = ~new & np.isin(triangles, rim).any(axis=1)
        if beside.any():
            low, high = edges[:, beside].min(), edges[:, beside].max()
            ratio = max(edges[:, new].max() / high, low / edges[:, new].min())
        angle = least_angle(corners[new])
    return Measure(
        irregular=float((valence != 6).mean()),
        collar=float((valence[fresh] != 6).mean()) if fresh.any() else 0.0,
        angle=angle,
        ratio=float(ratio),
        volume=abs(joined.report["volume"] / joined.report["exact_volume"] - 1),
        meetings=joined.report["self_intersections"],
        seconds=seconds,
        new=int(new.sum()),
    )


def least_angle(corners):
    """The smallest angle of triangles, in degrees."""
    least = 180.0
    for k in range(3):
        u, v = corners[:, k - 1] - corners[:, k], corners[:, k - 2] - corners[:, k]
        sine = np.linalg.norm(np.cross(u, v), axis=1)
        least = min(least, np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", u, v))).min())
    return float(least)


def campaign(cases, seed, folder=None, blend=2.0):
    """What is wrong, what was refused, and the measures, by case."""
    wrong, refused, measures = {}, {}, {}
    for number in range(cases):
        it = case(seed, number, folder)
        if it is None:
            continue
        it.blend = blend
        start = time.process_time()
        try:
            joined = it.join()
        except gridmesh.GridMeshError as error:
            refused[number] = f"{error.kind}: {error}"
            continue
        seconds = time.process_time() - start
        if bad := faults(it.parts, joined):
            wrong[number] = bad
        measures[number] = measure(joined, seconds), joined
    return wrong, refused, measures


def main():
    """Print numbers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--blend", type=float, default=2.0)
    parser.add_argument("--only", type=int)
    parser.add_argument("--save")
    options = parser.parse_args()
    if options.only is not None:
        it = case(options.seed, options.only, options.folder)
        it.blend = options.blend
        print(it.names, [len(triangles) for _, triangles in it.parts])
        joined = it.join()
        print(measure(joined, 0), joined.report)
        print(faults(it.parts, joined), [[len(rim) for rim in rims] for rims in joined.collars])
        if options.save:
            triangles, face = fanned(joined)
            np.savez(
                options.save, vertices=joined.vertices, triangles=triangles, new=joined.source_part[face] < 0
            )
        return
    wrong, refused, found = campaign(options.cases, options.seed, options.folder, options.blend)
    print(f"{len(found) + len(refused)} cases, seed {options.seed}: {len(found)} joined, {len(wrong)} broken")
    for number, reason in (*wrong.items(), *refused.items()):
        print("  case", number, reason)
    # Those whose parts have met.
    met = {number: it for number, it in found.items() if it[1].report["collars"]}
    kinds = Counter()
    for _, joined in met.values():
        for key in ("collars", "tubes", "fills", "curves"):
            kinds[key] += joined.report[key]
    print(f"{len(met)} with joints", dict(kinds))
    for name, best in [
        ("irregular", 0),
        ("collar", 0),
        ("angle", 1),
        ("ratio", 0),
        ("volume", 0),
        ("meetings", 0),
        ("seconds", 0),
    ]:
        values = np.array([getattr(it, name) for it, _ in met.values()])
        tail = np.percentile(values, 10 if best else 90)
        worst = min(met, key=lambda k: getattr(met[k][0], name) * (1 if best else -1))
        print(
            f"{name:10} median {np.median(values):.4f}  mean {values.mean():.4f}  one in ten {tail:.4f}"
            f"  worst {getattr(met[worst][0], name):.4f} (case {worst})"
        )
    fresh = sum((joined.vertex_part < 0).sum() for _, joined in met.values())
    odd = sum(joined.report["collar_irregular"] for _, joined in met.values())
    print(f"all new vertices: {odd / max(fresh, 1):.4f} irregular; cases with meetings:",
          [k for k, (it, _) in met.items() if it.meetings])  # fmt: skip


if __name__ == "__main__":
    main()
