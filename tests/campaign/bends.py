"""Straight and bent lattices over many drawings: irregular vertices, angles, sizes, thin parts, refusals, time.

    python tests/campaign/bends.py CURVES [--triangles 2000] [--every 3] [--sets hand] [--bends 0 1] [--body] [--worst 5] [--keep FILE]

CURVES is a folder of *.jsonl files with one drawing a line: "points", or "outer" and "holes". Sets are parts of names of files;
those whose names begin with "synth" are left out unless named. Figures are of each drawing; the table has their quantiles over
the drawings that all bends could do. With --keep the rows are written to a file and those that it has are not computed again.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path

import gridmesh
import numpy as np

# Of a row: what is printed, which quantiles, how.
COLUMNS = [
    ("irregular", "irregular, %", (50, 90), "{:.3f}"),
    ("number", "number", (50, 90), "{:.0f}"),
    ("excess", "sum|v-6| / 1000", (50,), "{:.1f}"),
    ("angle", "least angle", (50, 10, 5, 0), "{:.1f}"),
    ("ratio", "radius ratio", (50, 10), "{:.4f}"),
    ("deviation", "deviation", (50, 90), "{:.2f}"),
    ("long", "99 % edges / median", (50, 100), "{:.2f}"),
    ("seconds", "CPU, ms", (50,), "{:.1f}"),
]
BODY = [
    ("body_angle", "body: least angle", (50, 10, 5, 0), "{:.1f}"),
    ("embedded", "embedded", (0,), "{:.0f}"),
]


def drawings(folder: Path, sets: list[str], every: int) -> Iterator[tuple[str, np.ndarray, list[np.ndarray]]]:
    """Name, outline and holes of the chosen drawings."""
    for path in sorted(folder.glob("*.jsonl")):
        chosen = any(s in path.stem for s in sets) if sets else not path.stem.startswith("synth")
        if not chosen:
            continue
        for k, line in enumerate(path.read_text(encoding="utf-8").splitlines()[::every]):
            row = json.loads(line)
            outline = np.asarray(row["points"] if "points" in row else row["outer"], float)
            name = f"{path.stem} {k * every} {row['name']}"
            yield name, outline, [np.asarray(hole, float) for hole in row.get("holes", [])]


def angles(vertices: np.ndarray, triangles: np.ndarray) -> tuple[float, float]:
    """The least angle in degrees and the mean radius ratio."""
    at = vertices[triangles]
    a, b, c = np.sort([np.linalg.norm(at[:, k - 1] - at[:, k - 2], axis=1) for k in range(3)], axis=0)
    u, v = at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]
    squares = (u * u).sum(1) * (v * v).sum(1) - (u * v).sum(1) ** 2
    doubled = np.sqrt(np.maximum(squares, 0))
    least = np.arctan2(2 * doubled, b * b + c * c - a * a).min()
    return float(np.degrees(least)), float((4 * doubled**2 / ((a + b + c) * a * b * c)).mean())


def thin_parts(contours: list[np.ndarray], samples: int = 600) -> tuple[np.ndarray, np.ndarray]:
    """Middles and widths of the thinnest tenth of the outlines: circles that touch them there and elsewhere."""
    contours = [c if (signed_area(c) > 0) == (k == 0) else c[::-1] for k, c in enumerate(contours)]
    lengths = [np.linalg.norm(np.roll(c, -1, axis=0) - c, axis=1).sum() for c in contours]
    points, inwards = [], []
    for contour, length in zip(contours, lengths, strict=True):
        closed = np.vstack([contour, contour[:1]])
        arcs = np.r_[0, np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))]
        n = max(12, int(samples * length / sum(lengths)))
        at = np.linspace(0, length, n, endpoint=False)
        even = np.column_stack([np.interp(at, arcs, closed[:, k]) for k in (0, 1)])
        ahead = np.roll(even, -1, axis=0) - np.roll(even, 1, axis=0)
        ahead /= np.maximum(np.linalg.norm(ahead, axis=1), 1e-300)[:, None]
        points.append(even)
        inwards.append(np.column_stack([-ahead[:, 1], ahead[:, 0]]))
    points, inwards = np.vstack(points), np.vstack(inwards)
    apart = points[None] - points[:, None]
    depth = (apart * inwards[:, None]).sum(2)
    with np.errstate(divide="ignore", invalid="ignore"):
        radii = np.where(depth > 0, (apart**2).sum(2) / (2 * depth), np.inf).min(axis=1)
    thin = np.argsort(radii, kind="stable")[: len(radii) // 10]
    return points[thin] + radii[thin, None] * inwards[thin], 2 * radii[thin]


def signed_area(points: np.ndarray) -> float:
    """Of a closed polygon, positive if counter-clockwise."""
    x, y = points.T
    return 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def measured(patch: gridmesh.Patch, thin: tuple[np.ndarray, np.ndarray]) -> dict[str, float]:
    """Numbers of a patch."""
    vertices, triangles = patch.vertices, patch.triangles
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    is_rim = np.zeros(len(vertices), bool)
    is_rim[edges[uses == 1]] = True
    valence = np.bincount(edges.ravel(), minlength=len(vertices))
    valence[is_rim] = 2 * valence[is_rim] - 2
    copies = np.where(is_rim, 1, 2)
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    angle, ratio = angles(vertices, triangles)
    corners = vertices[triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    size = np.sqrt((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) * 2 / 3**0.5)
    middles, widths = thin
    away = ((corners.mean(axis=1)[None] - middles[:, None]) ** 2).sum(2)
    near = np.argpartition(away, min(6, away.shape[1] - 1), axis=1)[:, :6]
    return {
        "irregular": 100 * patch.report["irregular"] / copies.sum(),
        "number": patch.report["irregular"],
        "excess": 1000 * (copies * np.abs(valence - 6)).sum() / copies.sum(),
        "angle": angle,
        "ratio": ratio,
        "deviation": patch.report["max_deviation"],
        "long": np.percentile(lengths, 99) / np.median(lengths),
        "across": float(np.median(widths / size[near].mean(axis=1))),
        "count": len(triangles),
        "bend": patch.report["bend"],
    }


def row_of(outline: np.ndarray, holes: list[np.ndarray], options: dict, with_body: bool) -> dict:
    """The numbers of one drawing, or why it was refused."""
    begun = time.process_time()
    try:
        patch = gridmesh.mesh_sketch(outline, holes, least=False, **options)
    except gridmesh.GridMeshError as refusal:
        return {"refused": refusal.kind}
    row = {"seconds": 1000 * (time.process_time() - begun)} | measured(patch, thin_parts([outline, *holes]))
    if with_body:
        body = gridmesh.inflate(patch)
        row["body_angle"] = angles(body.vertices, body.triangles)[0]
        row["embedded"] = float(body.report["embedded"])
    return row


def table(rows: dict[float, dict[str, dict]], columns: list) -> list[str]:
    """Quantiles of each bend over what all could do."""
    able = [k for k in next(iter(rows.values())) if all("refused" not in of[k] for of in rows.values())]
    names = [f"{name} {'/'.join(map(str, quantiles))}" for _, name, quantiles, _ in columns]
    lines = ["| bend | refused | bent, % | " + " | ".join(names) + " | across / first | CPU / first |"]
    lines.append("|---:|" + "---:|" * (len(columns) + 4))
    first = next(iter(rows.values()))
    for bend, of in rows.items():
        refused = sum("refused" in row for row in of.values())
        cells = [
            f"{bend:g}",
            f"{refused} of {len(of)}",
            f"{100 * np.mean([of[k]['bend'] > 0 for k in able]):.0f}",
        ]
        for key, _, quantiles, form in columns:
            found = np.percentile([of[k][key] for k in able], quantiles)
            cells.append(" / ".join(form.format(x) for x in found))
        across = [of[k]["across"] / first[k]["across"] for k in able]
        cells.append(" / ".join(f"{x:.2f}" for x in np.percentile(across, (50, 10))))
        seconds = [sum(of[k]["seconds"] for k in able) for of in (of, first)]
        ratios = [of[k]["seconds"] / first[k]["seconds"] for k in able]
        cells.append(f"{np.median(ratios):.2f} (sum {seconds[0] / seconds[1]:.2f})")
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("curves", type=Path)
    parser.add_argument("--triangles", type=int, default=2000)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--sets", default="")
    parser.add_argument("--bends", type=float, nargs="+", default=[0.0, 1.0])
    parser.add_argument("--closeness", type=float)
    parser.add_argument("--body", action="store_true")
    parser.add_argument("--worst", type=int, default=0, help="name so many drawings of the least angles")
    parser.add_argument("--keep", type=Path)
    args = parser.parse_args()
    known = json.loads(args.keep.read_text()) if args.keep and args.keep.exists() else {}
    options = {"triangles": args.triangles}
    if args.closeness is not None:
        options["closeness"] = args.closeness
    rows: dict[float, dict[str, dict]] = {bend: {} for bend in args.bends}
    for name, outline, holes in drawings(args.curves, [s for s in args.sets.split(",") if s], args.every):
        for bend in args.bends:
            key = f"{name} {options} {bend} {args.body}"
            if key not in known:
                known[key] = row_of(outline, holes, options | {"bend": bend}, args.body)
            rows[bend][name] = known[key]
            if "refused" in known[key]:
                print(f"refused at bend {bend:g}: {name}: {known[key]['refused']}")
    if args.keep:
        args.keep.write_text(json.dumps(known))
    print("\n".join(table(rows, COLUMNS + BODY if args.body else COLUMNS)))
    key = "body_angle" if args.body else "angle"
    last = {name: row for name, row in rows[args.bends[-1]].items() if "refused" not in row}
    for name in sorted(last, key=lambda name: last[name][key])[: args.worst]:
        print(
            f"{name[:40]:40s}",
            *(f"{rows[b][name].get(key, np.nan):.1f}" for b in args.bends),
            last[name]["number"],
        )


if __name__ == "__main__":
    main()
