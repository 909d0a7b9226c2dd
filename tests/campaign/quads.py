"""Quads over many drawings: refusals, poles of bodies and of sheets, corners with a single quad, corners, edges, time.

    python tests/campaign/quads.py CURVES [--quads 1000] [--every 1] [--sets hand,icons] [--body] [--worst 5]

CURVES is a folder of *.jsonl files with one drawing a line: "points", or "outer" and "holes".
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from pathlib import Path

import gridmesh
import numpy as np


def corners(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Corners of flat quads in degrees, 0 to 360."""
    at = vertices[quads]
    ahead, back = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
    cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    return np.degrees(np.arctan2(cross, (ahead * back).sum(2))) % 360


def edges(quads: np.ndarray) -> np.ndarray:
    """All edges once."""
    pairs = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    return np.unique(np.sort(pairs, axis=1), axis=0)


def measured(patch: gridmesh.Patch) -> dict[str, float]:
    """Numbers of a patch of quads."""
    angles = corners(patch.vertices, patch.quads)
    ends = edges(patch.quads)
    lengths = np.linalg.norm(np.diff(patch.vertices[ends], axis=1)[:, 0], axis=1)
    of_sheet = np.bincount(patch.quads.ravel())
    n_rim = sum(map(len, patch.loops))
    return {
        "poles": patch.report["poles"],
        "single": (of_sheet[:n_rim] == 1).sum(),
        "flat": (of_sheet[n_rim:] != 4).sum(),
        "least": angles.min(),
        "most": angles.max(),
        "off": np.abs(angles - 90).mean(),
        "ratio": np.percentile(lengths, 99) / np.median(lengths),
        "deviation": patch.report["max_deviation"],
        "count": len(patch.quads),
        "bend": patch.report["bend"],
    }


def drawn_in(patch: gridmesh.Patch, body: gridmesh.Surface) -> np.ndarray:
    """How far the vertices of the rim lie from the drawing when the body is subdivided (Catmull-Clark), in edges; no corners."""
    quads, at = body.quads, body.vertices
    beside, across, faces = np.zeros_like(at), np.zeros_like(at), np.bincount(quads.ravel())[:, None]
    for k in range(4):
        # Each edge is met twice.
        np.add.at(beside, quads[:, k], (at[quads[:, k - 1]] + at[quads[:, (k + 1) % 4]]) / 2)
        np.add.at(across, quads[:, k], at[quads[:, k - 2]])
    limit = (faces**2 * at + 4 * beside + across) / (faces * (faces + 5))
    off = []
    patch = patch.belt
    for loop, corner in zip(patch.loops, patch.corner, strict=True):
        drawn = patch.vertices[loop]
        tangent = np.roll(drawn, -1, axis=0) - np.roll(drawn, 1, axis=0)
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        way = limit[loop, :2] - drawn
        across_line = way[:, 0] * tangent[:, 1] - way[:, 1] * tangent[:, 0]
        off.append(np.abs(across_line[corner == 0]))
    ends = edges(quads)
    return np.concatenate(off) / np.median(np.linalg.norm(at[ends[:, 0]] - at[ends[:, 1]], axis=1))


def drawings(folder: Path, sets: list[str], every: int):
    """Set, name, outline and holes of the chosen drawings."""
    for path in sorted(folder.glob("*.jsonl")):
        if path.stem.startswith("synth") or (sets and not any(s in path.stem for s in sets)):
            continue
        for line in path.read_text().splitlines()[::every]:
            row = json.loads(line)
            outline = np.asarray(row["points"] if "points" in row else row["outer"], float)
            yield path.stem, row["name"], outline, [np.asarray(h, float) for h in row.get("holes", [])]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("curves", type=Path)
    parser.add_argument("--quads", type=int, default=1000)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--sets", default="")
    parser.add_argument("--body", action="store_true")
    parser.add_argument("--least", action="store_true", help="ask for numbers that work, and try them")
    parser.add_argument("--worst", type=int, default=0)
    args = parser.parse_args()
    found: dict[str, list[dict]] = {}
    refused: Counter[str] = Counter()
    for group, name, outline, holes in drawings(
        args.curves, [s for s in args.sets.split(",") if s], args.every
    ):
        begun = time.perf_counter()
        try:
            patch = gridmesh.mesh_sketch(outline, holes, quads=args.quads, least=args.least)
        except gridmesh.GridMeshError as refusal:
            refused[group] += 1
            print("refused", group, name[:30], refusal.kind, str(refusal)[:120] if args.least else "")
            found.setdefault(group, [])
            continue
        row = measured(patch)
        if args.body:
            body = gridmesh.inflate(patch)
            row["bodytime"] = time.perf_counter() - begun
            row["embedded"] = body.report["embedded"]
            valences = np.bincount(edges(body.quads).ravel())
            fit = gridmesh.inflate(patch, subdivided=True)
            for key, of in (("rim", body), ("fit", fit)):
                off = drawn_in(patch, of)
                row[key], row[key + "_within"] = np.median(off), (off < 0.02).mean()
            row["valid"] = body.report["watertight"] and set(valences.tolist()) <= {3, 4, 5}
        row["time"] = sum(patch.report["seconds"].values())
        found.setdefault(group, []).append(row | {"name": name})
    print(
        f"{'set':16s} {'n':>3s} {'refused':>7s} poles  p90  flat single  least  p10   most  p90   off  ratio  p90  deviation bent    ms"
    )
    everything = [row for rows in found.values() for row in rows]
    hand = [row for group, rows in found.items() if group.startswith("hand") for row in rows]
    for group, rows in [*found.items(), ("hand-drawn", hand), ("all", everything)]:
        if not rows:
            print(group, "none")
            continue
        of = {key: np.array([row[key] for row in rows]) for key in rows[0] if key != "name"}
        n_refused = (
            refused[group]
            if group in refused
            else sum(
                v
                for k, v in refused.items()
                if group == "all" or (group == "hand-drawn" and k.startswith("hand"))
            )
        )
        print(
            f"{group:16s} {len(rows):3d} {n_refused:7d} {np.median(of['poles']):5.0f} {np.percentile(of['poles'], 90):4.0f}"
            f" {np.median(of['flat']):5.0f} {np.median(of['single']):6.0f}"
            f" {np.median(of['least']):6.1f} {np.percentile(of['least'], 10):5.1f} {np.median(of['most']):6.1f} {np.percentile(of['most'], 90):5.1f}"
            f" {np.median(of['off']):5.1f} {np.median(of['ratio']):5.2f} {np.percentile(of['ratio'], 90):5.2f} {np.median(of['deviation']):8.2f}"
            f" {(of['bend'] > 0).mean():6.2f} {1000 * np.median(of['time']):6.1f}"
            + (
                f" body {1000 * np.median(of['bodytime']):5.1f} ms, valid {of['valid'].mean():.3f}, embedded {of['embedded'].mean():.3f}"
                f", subdivided rim off by {np.median(of['rim']):.3f} edges ({100 * np.median(of['rim_within']):.0f} % below a fiftieth),"
                f" fit for it {np.median(of['fit']):.3f} ({100 * np.median(of['fit_within']):.0f} %)"
                if args.body
                else ""
            )
        )
    for row in sorted(everything, key=lambda row: row["least"])[: args.worst]:
        print({k: round(v, 2) if isinstance(v, float) else v for k, v in row.items()})


if __name__ == "__main__":
    main()
