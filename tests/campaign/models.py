"""Holes, cuts and joins of meshes as they are found, checked without the library's own code.

    python tests/campaign/models.py FOLDER JOURNAL.jsonl {holes,cuts,joins} [--cases 2000] [--seed 1] [--only K] [--summary]

`meshes.py` fills the folder. Holes are cut from the meshes, smooth or not, large or small; strokes, straight or bent, go through
them from any direction; two that are closed are put into each other. One line of the journal for each case;
those that are in it are not done again. Case k of a seed is always the same.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import fills
import gridmesh
import joins
import numpy as np
from json_lines import continued, rows_of

Mesh = tuple[np.ndarray, np.ndarray]
Row = dict[str, Any]


def mesh_of(file: Path) -> Mesh:
    """A mesh of size 1 around the origin."""
    with np.load(file) as held:
        return joins.scaled(held["vertices"]), held["faces"]


# ---------------------------------------------------------------- holes


def pierced(rng: np.random.Generator, faces: np.ndarray) -> tuple[np.ndarray, list[int]] | None:
    """The faces around a hole where a disk of faces was, and its loop; None if no disk is found."""
    for _ in range(20):
        gone = np.array([rng.choice(faces.ravel())])
        for _ in range(rng.integers(0, 9)):
            gone = np.unique(faces[np.isin(faces, gone).any(axis=1)])
        out = np.isin(faces, gone).any(axis=1)
        loops = fills.borders(faces[out])
        edges = len(np.unique(fills.keys(fills.half_edges(faces[out]))))
        disk = len(np.unique(faces[out])) - edges + out.sum() == 1
        # As the faces that stay wind it, or against them: the library has to find out.
        if disk and len(loops) == 1 and not out.all() and len(loops[0]) <= 400:
            return faces[~out], loops[0]
    return None


def hole(rng: np.random.Generator, files: list[Path], row: Row) -> None:
    """A hole, filled."""
    file = files[rng.integers(len(files))]
    row["name"] = file.stem
    vertices, faces = mesh_of(file)
    options = {
        "smooth": str(rng.choice(["flat", "tangent", "curvature"])),
        "cells": str(rng.choice(["triangles", "quads"])),
    }
    found = pierced(rng, faces)
    if found is None:
        row["refused"] = "no disk of faces"
        return
    around, loop = found
    row |= {"edges": len(loop), **options}
    since = time.process_time()
    fill = gridmesh.fill_hole(vertices, around, loop, **options)
    row["cpu"] = time.process_time() - since
    bad = fills.faults(vertices, around, fill.loop, fill)
    if sorted(fill.loop.tolist()) != sorted(loop):
        bad.append("another loop")
    if bad:
        row["wrong"] = "; ".join(bad)
    row["meets"] = fill.report["self_intersections"]
    row["angle"] = joins.least_angle(np.r_[vertices, fill.vertices][fills.cut_up(fill)])


# ---------------------------------------------------------------- cuts


def stroke(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A line through a mesh of size 1 that no end touches, and the direction it is seen along."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    t = np.linspace(-1, 1, rng.integers(2, 30))
    wave = rng.choice([0, 0.1, 0.2]) * np.sin(rng.uniform(2, 9) * t)
    line = np.c_[2 * t, wave + rng.uniform(-0.3, 0.3), 0 * t]
    return line @ turn, turn[2]


def cut(rng: np.random.Generator, files: list[Path], row: Row) -> None:
    """A mesh, cut in two."""
    file = files[rng.integers(len(files))]
    row["name"] = file.stem
    vertices, faces = mesh_of(file)
    line, direction = stroke(rng)
    options = {"cells": str(rng.choice(["triangles", "quads"]))}
    if rng.random() < 0.5:
        options["edge_length"] = float(rng.choice([0.01, 0.02, 0.05]))
    row |= options | {"closed": joins.close(joins.sides(faces))}
    since = time.process_time()
    done = gridmesh.cut(vertices, faces, line, direction=direction, **options)
    row["cpu"] = time.process_time() - since
    row["caps"] = len(done.pieces[0].cap_loops)
    if bad := cut_faults(vertices, faces, done, row["closed"], "edge_length" in options):
        row["wrong"] = "; ".join(bad)
    caps = [joins.fanned(piece) for piece in done.pieces]
    corners = [
        piece.vertices[it[piece.source_face[face] < 0]]
        for piece, (it, face) in zip(done.pieces, caps, strict=True)
    ]
    if len(corners[0]):
        row["angle"] = joins.least_angle(corners[0])


def area_of(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """The area of triangles."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def cut_faults(vertices: np.ndarray, faces: np.ndarray, done: Any, closed: bool, rebuilt: bool) -> list[str]:
    """What the pieces break of what is promised."""
    found, area, volume, caps = [], 0.0, 0.0, []
    for piece in done.pieces:
        triangles, face = joins.fanned(piece)
        if closed and not joins.close(joins.polygon_sides(piece)):
            found.append(f"the {piece.side} piece is not closed and manifold")
        if not np.isfinite(piece.vertices).all():
            found.append(f"the {piece.side} piece is not finite")
        cap = piece.source_face[face] < 0
        # Vertices inside caps have the data of a vertex near them.
        old = np.zeros(len(piece.vertices), bool)
        old[triangles[~cap]] = True
        old &= piece.source_weights[:, 0] == 1
        if not rebuilt and not np.array_equal(piece.vertices[old], vertices[piece.source_vertices[old, 0]]):
            found.append(f"vertices of the {piece.side} piece have moved")
        area += area_of(piece.vertices, triangles[~cap])
        volume += joins.volume(piece.vertices - vertices[0], triangles)
        cells = piece.vertices[triangles[cap]].tolist()
        caps.append(np.array(sorted(sorted(map(tuple, cell)) for cell in cells)))
    if len(caps) == 2 and not np.array_equal(caps[0], caps[1]):
        found.append("the caps are not those of each other")
    whole = area_of(vertices, faces)
    slack = 0.05 if rebuilt else 1e-9
    if abs(area - whole) > slack * whole:
        found.append(f"the area was {whole} and is {area}")
    before = joins.volume(vertices - vertices[0], faces)
    if closed and abs(volume - before) > slack * max(abs(before), 0.01):
        found.append(f"the volume was {before} and is {volume}")
    return found


# ---------------------------------------------------------------- joins


def join(rng: np.random.Generator, files: list[Path], row: Row) -> None:
    """Two closed meshes, put into each other and joined."""
    parts: list[Mesh] = []
    row["name"] = ""
    while len(parts) < 2:
        file = files[rng.integers(len(files))]
        vertices, faces = mesh_of(file)
        if not joins.close(joins.sides(faces)):
            continue
        if parts:
            turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            turn *= np.sign(np.linalg.det(turn))
            first = parts[0][0]
            vertices = (
                rng.uniform(0.4, 1) * vertices @ turn + rng.uniform(0.3, 1) * first[rng.integers(len(first))]
            )
        row["name"] += f"{' + ' * bool(parts)}{file.stem}"
        parts.append((vertices, faces))
    options = {"blend": float(rng.choice([0, 1, 2]))}
    row |= options
    since = time.process_time()
    done = gridmesh.join(parts, **options)
    row["cpu"] = time.process_time() - since
    if bad := joins.faults(parts, done):
        row["wrong"] = "; ".join(bad)
    row |= {"collars": done.report["collars"], "meets": done.report["self_intersections"]}
    if done.report["collars"]:
        it = joins.measure(done, row["cpu"])
        row |= {"angle": it.angle, "irregular": it.collar, "volume": it.volume}


KINDS = {"holes": hole, "cuts": cut, "joins": join}


def run(kind: str, files: list[Path], seed: int, number: int) -> Row:
    """A line of the journal."""
    rng = np.random.default_rng([seed, number])
    row: Row = {"kind": kind, "case": number}
    since = time.process_time()
    try:
        KINDS[kind](rng, files, row)
    except gridmesh.GridMeshError as error:
        row |= {"refused": error.kind, "words": str(error), "cpu": time.process_time() - since}
        if error.kind == "internal":
            row["wrong"] = str(error)
    return row


def summed_up(rows: list[Row]) -> None:
    """Print tails, refusals, and everything that is wrong."""
    refused = Counter(row["refused"] for row in rows if "refused" in row)
    print(f"{len(rows)} cases, {len(rows) - refused.total()} done, refused: {dict(refused)}")
    for key in ("angle", "irregular", "volume", "cpu"):
        values = [row[key] for row in rows if key in row and "refused" not in row]
        if values:
            low, tail, median, top, high = np.percentile(values, [0, 5, 50, 95, 100])
            print(
                f"    {key:9} least {low:.4f}, 5 % {tail:.4f}, median {median:.4f}, 95 % {top:.4f}, {high:.4f}"
            )
    print(f"    {sum(bool(row.get('meets')) for row in rows)} meet something")
    for row in sorted(rows, key=lambda row: -row.get("cpu", 0))[:5]:
        print(f"    {row['cpu']:.2f} s: case {row['case']} {row['name']} {row.get('refused', '')}")
    wrong = [row for row in rows if "wrong" in row]
    print(f"{len(wrong)} wrong")
    for row in wrong:
        print(f"    case {row['case']} {row['name']}: {row['wrong'][:300]}")


def main() -> int:
    """Do what is missing, and sum up; 1 if something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("journal", type=Path)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--cases", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--summary", action="store_true")
    chosen = parser.parse_args()
    files = sorted(chosen.folder.glob("*.npz"))
    if chosen.only is not None:
        print(json.dumps(run(chosen.kind, files, chosen.seed, chosen.only), indent=1))
        return 0
    if chosen.summary:
        rows = rows_of(chosen.journal)
    else:
        rows = continued(chosen.journal, chosen.cases, lambda k: run(chosen.kind, files, chosen.seed, k))
    summed_up(rows)
    return int(any("wrong" in row for row in rows))


if __name__ == "__main__":
    sys.exit(main())
