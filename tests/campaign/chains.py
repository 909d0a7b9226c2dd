"""Bodies taken through what an artist does to them in turn: joined, cut, opened and filled, regridded, given handles.

    python tests/campaign/chains.py JOURNAL.jsonl [--cases 300] [--seed 1] [--only K] [--summary]

What one operation leaves is what the next one gets. After each one the whole mesh is checked without the library's own code:
closed, manifold, finite, right side out, its topology what the operation promises, and no triangle through another one
that no report has told of. One line of the journal for each case; those that are in it are not done again. Case k of a
seed is always the same.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import gridmesh
import joins
import models
import numpy as np
from json_lines import continued, rows_of

Row = dict[str, Any]
SMOOTH = ("flat", "tangent", "curvature")
CELLS = ("triangles", "quads")


class Mesh(NamedTuple):
    """Vertices (n, 3) and faces of any number of corners."""

    vertices: np.ndarray
    corners: np.ndarray
    offsets: np.ndarray

    @property
    def faces(self) -> tuple[np.ndarray, np.ndarray]:
        """As the library takes them."""
        return self.corners, self.offsets


class Done(NamedTuple):
    """A mesh, by how much its Euler characteristic has to change, if that is known, and how often it is told to meet itself."""

    mesh: Mesh
    euler: int | None
    meets: int


def mesh_from(vertices: np.ndarray, faces: list[np.ndarray]) -> Mesh:
    """A mesh of the vertices that faces use."""
    used, corners = np.unique(np.concatenate(faces), return_inverse=True)
    return Mesh(vertices[used], corners, np.cumsum([0, *map(len, faces)]))


def rows_of_faces(mesh: Mesh) -> list[np.ndarray]:
    """The corners of each face."""
    return np.split(mesh.corners, mesh.offsets[1:-1])


# ---------------------------------------------------------------- operations


def body(rng: np.random.Generator) -> Mesh:
    """The body of a limb, of a blob or of a star."""
    kind = rng.integers(3)
    t = np.linspace(0, 2 * np.pi, 160, endpoint=False)
    if kind == 0:
        outline = joins.scaled(joins.limb(rng))
    else:
        waves = rng.normal(size=(2, 5)) * (0.3 / np.arange(1, 6))
        r = np.exp(sum(a * np.cos(k * t) + b * np.sin(k * t) for k, (a, b) in enumerate(waves.T, 2)))
        if kind == 2:
            r *= 1 + 0.4 * np.cos(rng.integers(3, 7) * t)
        outline = joins.scaled(np.c_[r * np.cos(t), r * np.sin(t)])
    asked = {str(rng.choice(CELLS)): int(rng.integers(150, 800))}
    made = gridmesh.inflate(gridmesh.mesh_sketch(outline, **asked), depth=float(rng.uniform(0.4, 1.2)))
    return mesh_from(made.vertices, [*made.triangles, *made.quads])


def placed(rng: np.random.Generator, mesh: Mesh, near: np.ndarray) -> Mesh:
    """A mesh turned and sized at random, at a point."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    return mesh._replace(vertices=rng.uniform(0.4, 1) * mesh.vertices @ turn + near)


def join(rng: np.random.Generator, mesh: Mesh, row: Row) -> Done:
    """Joined with one more body."""
    near = rng.uniform(0.5, 1) * mesh.vertices[rng.integers(len(mesh.vertices))]
    other = placed(rng, body(rng), near)
    blend = float(rng.choice([0, 1, 2, 4]))
    row["options"] = {"blend": blend}
    done = gridmesh.join([(mesh.vertices, mesh.faces), (other.vertices, other.faces)], blend=blend)
    return Done(Mesh(done.vertices, done.corners, done.offsets), None, done.report["self_intersections"])


def cut(rng: np.random.Generator, mesh: Mesh, row: Row) -> Done:
    """Cut by a stroke; the larger piece, with its cap."""
    size = np.ptp(mesh.vertices, axis=0).max()
    line, direction = models.stroke(rng)
    row["options"] = options = {"smooth": str(rng.choice(SMOOTH)), "cells": str(rng.choice(CELLS))}
    middle = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    done = gridmesh.cut(mesh.vertices, mesh.faces, size * line + middle, direction=direction, **options)
    pieces = [Mesh(piece.vertices, piece.corners, piece.offsets) for piece in done.pieces]
    pieces = [piece for piece in pieces if len(piece.offsets) > 1]
    larger = max(pieces, key=lambda piece: joins.volume(piece.vertices, joins.fanned(piece)[0]))
    # A cap may meet what is beside it, which no report of a cut counts.
    return Done(larger, None, meetings(larger))


def disk(rng: np.random.Generator, mesh: Mesh, rings: int, clear: np.ndarray | None = None) -> np.ndarray:
    """Which faces are in a random disk of so many rings; none if there is none away from the vertices `clear`."""
    faces = rows_of_faces(mesh)
    face = np.repeat(np.arange(len(faces)), np.diff(mesh.offsets))
    for _ in range(20):
        gone = np.array([rng.integers(len(mesh.vertices))])
        for _ in range(rings):
            gone = np.unique(mesh.corners[np.isin(face, face[np.isin(mesh.corners, gone)])])
        inside = np.bincount(face, np.isin(mesh.corners, gone)) == np.diff(mesh.offsets)
        used = np.isin(np.arange(len(mesh.vertices)), mesh.corners[inside[face]])
        sides = joins.polygon_sides(mesh)[inside[face]]
        codes = np.unique(np.sort(sides, axis=1), axis=0)
        if inside.all() or not inside.any() or (clear is not None and used[clear].any()):
            continue
        if used.sum() - len(codes) + inside.sum() == 1 and len(loops_of(sides)) == 1:
            return inside
    return np.zeros(len(faces), bool)


def loops_of(sides: np.ndarray) -> list[np.ndarray]:
    """The borders of faces, given by their directed sides, each a loop that passes no vertex twice."""
    codes, turned = sides[:, 0] << 32 | sides[:, 1], sides[:, 1] << 32 | sides[:, 0]
    border = sides[~np.isin(codes, turned)]
    after = dict(border.tolist())
    if len(after) != len(border):
        return []
    loops = []
    while after:
        loop = [next(iter(after))]
        while (at := after.pop(loop[-1])) != loop[0]:
            loop.append(at)
        loops.append(np.array(loop))
    return loops


def opened(mesh: Mesh, gone: np.ndarray) -> tuple[Mesh, np.ndarray, np.ndarray]:
    """A mesh without some faces, its triangles and the face of each; vertices keep their numbers."""
    kept = [face for face, out in zip(rows_of_faces(mesh), gone, strict=True) if not out]
    rest = Mesh(mesh.vertices, np.concatenate(kept), np.cumsum([0, *map(len, kept)]))
    return rest, *joins.fanned(rest)


def closed(rest: Mesh, *made: Any) -> Mesh:
    """A mesh with the new faces of fills."""
    vertices = [rest.vertices]
    faces = rows_of_faces(rest)
    for fill in made:
        vertices.append(fill.vertices)
        faces += [*fill.triangles.astype(np.int64), *fill.quads.astype(np.int64)]
    return mesh_from(np.concatenate(vertices), faces)


def fill(rng: np.random.Generator, mesh: Mesh, row: Row) -> Done | None:
    """A disk of faces taken out and filled."""
    gone = disk(rng, mesh, rng.integers(1, 7))
    if not gone.any():
        return None
    row["options"] = options = {"smooth": str(rng.choice(SMOOTH)), "cells": str(rng.choice(CELLS))}
    rest, triangles, polygons = opened(mesh, gone)
    (loop,) = loops_of(joins.polygon_sides(rest))
    done = gridmesh.fill_hole(mesh.vertices, triangles, loop, polygons=polygons, **options)
    return Done(closed(rest, done), 0, done.report["self_intersections"])


def regrid(rng: np.random.Generator, mesh: Mesh, row: Row) -> Done | None:
    """A disk of faces meshed anew."""
    gone = disk(rng, mesh, rng.integers(2, 7))
    if not gone.any():
        return None
    row["options"] = options = {"cells": str(rng.choice(CELLS))}
    triangles, polygons = joins.fanned(mesh)
    inside = np.flatnonzero(gone[polygons])
    done = gridmesh.regrid(mesh.vertices, triangles, inside, polygons=polygons, **options)
    return Done(closed(opened(mesh, gone)[0], done.fill), 0, done.fill.report["self_intersections"])


def bridge(rng: np.random.Generator, mesh: Mesh, row: Row) -> Done | None:
    """Two disks taken out, and a tube from one to the other: a handle."""
    first = disk(rng, mesh, rng.integers(1, 4))
    if not first.any():
        return None
    faces = rows_of_faces(mesh)
    taken = np.unique(np.concatenate([face for face, out in zip(faces, first, strict=True) if out]))
    second = disk(rng, mesh, rng.integers(1, 4), taken)
    if not second.any():
        return None
    row["options"] = options = {"smooth": str(rng.choice(SMOOTH)), "cells": str(rng.choice(CELLS))}
    rest, triangles, polygons = opened(mesh, first | second)
    one, other = loops_of(joins.polygon_sides(rest))
    done = gridmesh.bridge(mesh.vertices, triangles, one, other, polygons=polygons, **options)
    if done.report["winding_conflicts"]:
        # Told: one hole is behind the other, and a tube between them turns what is outside in.
        row["conflicts"] = True
        return None
    return Done(closed(rest, done), -2, done.report["self_intersections"])


OPERATIONS = {"join": join, "cut": cut, "fill": fill, "regrid": regrid, "bridge": bridge}


# ---------------------------------------------------------------- checks


def euler(mesh: Mesh) -> int:
    """The Euler characteristic of a closed mesh."""
    return len(mesh.vertices) - len(mesh.corners) // 2 + len(mesh.offsets) - 1


def meetings(mesh: Mesh) -> int:
    """How many pairs of triangles without a common corner pass through each other."""
    triangles = mesh.vertices[joins.fanned(mesh)[0]]
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    order = np.argsort(low[:, 0])
    low, high, triangles = low[order], high[order], triangles[order]
    ends = np.searchsorted(low[:, 0], high[:, 0], side="right")
    pairs = []
    for k, end in enumerate(ends):
        near = np.arange(k + 1, end)
        apart = (low[near, 1:] > high[k, 1:]).any(axis=1) | (high[near, 1:] < low[k, 1:]).any(axis=1)
        pairs.append(np.c_[np.full((~apart).sum(), k), near[~apart]])
    pairs = np.concatenate(pairs)
    a, b = triangles[pairs[:, 0]], triangles[pairs[:, 1]]
    shared = (a[:, :, None] == b[:, None]).all(axis=-1).any(axis=(1, 2))
    a, b = a[~shared], b[~shared]
    through = np.zeros(len(a), bool)
    for one, other in ((a, b), (b, a)):
        for k in range(3):
            through |= passes(one[:, k], one[:, (k + 1) % 3], other)
    return int(through.sum())


def passes(start: np.ndarray, end: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Whether each segment passes through the inside of its triangle, clear of its edges."""
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    heights = [((point - faces[:, 0]) * normal).sum(axis=1) for point in (start, end)]
    size = (normal**2).sum(axis=1)
    slack = 1e-9 * size**0.75
    across = (np.minimum(*heights) < -slack) & (np.maximum(*heights) > slack)
    some = np.flatnonzero(across)
    share = heights[0][some] / (heights[0][some] - heights[1][some])
    at = start[some] + share[:, None] * (end[some] - start[some])
    for k in range(3):
        turn = np.cross(faces[some, (k + 1) % 3] - faces[some, k], at - faces[some, k])
        across[some] &= (turn * normal[some]).sum(axis=1) > 1e-6 * size[some]
    return across


def wrong_with(done: Done, before: Mesh, told: int) -> list[str]:
    """What a mesh breaks of what is promised; `told`: how often it and what was before are told to meet themselves."""
    mesh, found = done.mesh, []
    if not np.isfinite(mesh.vertices).all():
        return ["not finite"]
    if not joins.close(joins.polygon_sides(mesh)):
        return ["not closed and manifold"]
    if done.euler is not None and euler(mesh) - euler(before) != done.euler:
        found.append(f"the Euler characteristic was {euler(before)} and is {euler(mesh)}")
    if joins.volume(mesh.vertices, joins.fanned(mesh)[0]) <= 0:
        found.append("inside out")
    if not told and (count := meetings(mesh)):
        found.append(f"{count} pairs of triangles meet, and none was told")
    return found


def run(seed: int, number: int) -> Row:
    """A line of the journal."""
    rng = np.random.default_rng([seed, number])
    row: Row = {"case": number, "steps": []}
    mesh, told = body(rng), 0
    for _ in range(rng.integers(3, 9)):
        name = str(rng.choice(list(OPERATIONS)))
        step: Row = {"op": name}
        row["steps"].append(step)
        since = time.process_time()
        try:
            done = OPERATIONS[name](rng, mesh, step)
        except gridmesh.GridMeshError as error:
            step |= {"refused": error.kind, "words": str(error)}
            if error.kind == "internal":
                row.setdefault("wrong", []).append(f"{name}: {error}")
            continue
        finally:
            step["cpu"] = time.process_time() - since
        if done is None:
            step["skipped"] = True
            continue
        told += done.meets
        if found := wrong_with(done, mesh, told):
            row.setdefault("wrong", []).extend(f"step {len(row['steps'])}, {name}: {it}" for it in found)
            break
        mesh = done.mesh
        step |= {"faces": len(mesh.offsets) - 1, "meets": done.meets}
    return row


def summed_up(rows: list[Row]) -> None:
    """Print what was done, refused, and everything that is wrong."""
    steps = [step for row in rows for step in row["steps"]]
    for name in OPERATIONS:
        mine = [step for step in steps if step["op"] == name]
        refused = Counter(step["refused"] for step in mine if "refused" in step)
        met = sum(bool(step.get("meets")) for step in mine)
        slowest = max((step["cpu"] for step in mine), default=0)
        print(f"{name:8} {len(mine)} times, meets {met}, slowest {slowest:.1f} s, refused {dict(refused)}")
    wrong = [row for row in rows if "wrong" in row]
    print(f"{len(rows)} cases, {len(wrong)} wrong")
    for row in wrong:
        print(f"    case {row['case']}: {'; '.join(row['wrong'])[:400]}")


def main() -> int:
    """Do what is missing, and sum up; 1 if something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("journal", type=Path)
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--summary", action="store_true")
    chosen = parser.parse_args()
    if chosen.only is not None:
        print(json.dumps(run(chosen.seed, chosen.only), indent=1))
        return 0
    if chosen.summary:
        rows = rows_of(chosen.journal)
    else:
        rows = continued(chosen.journal, chosen.cases, lambda k: run(chosen.seed, k))
    summed_up(rows)
    return int(any("wrong" in row for row in rows))


if __name__ == "__main__":
    sys.exit(main())
