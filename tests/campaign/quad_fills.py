"""Fills of quads beside fills of triangles, over the loops of a folder of meshes.

`python tests/campaign/quad_fills.py MESHES` reads `MESHES/manifest.json`, a list of {"id", "file", "loops": [{"index",
"vertices"}]}, and the binary .ply files that it names; where `ID.truthK.ply` is there, it is what loop K was cut out of.
Prints a line for each loop and, at the end, medians: least and greatest corner in degrees (above 180 where a quad is
concave), poles inside, mean deviation from 90 degrees; over that of triangles: the seam (root mean square angle
across the loop), the distance from the truth, and CPU time.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from pathlib import Path

import gridmesh
import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "peers"))
from closeness import angles_across, distances, samples

KINDS = {"float": "<f4", "float32": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4"}


def read(path):
    """Vertices and triangles of a binary .ply file."""
    data = path.read_bytes()
    at = data.index(b"end_header\n") + len(b"end_header\n")
    lines = [line.split() for line in data[:at].decode("ascii").splitlines()]
    counts = {words[1]: int(words[2]) for words in lines if words[:1] == ["element"]}
    row = np.dtype([(w[2], KINDS[w[1]]) for w in lines if w[:1] == ["property"] and w[1] != "list"])
    points = np.frombuffer(data, row, counts["vertex"], at)
    at += counts["vertex"] * row.itemsize
    faces = np.frombuffer(data, np.dtype([("n", "u1"), ("v", "<i4", 3)]), counts["face"], at)
    return np.c_[points["x"], points["y"], points["z"]].astype(float), faces["v"].astype(int)


def corners_of(points, quads):
    """Corners (q, 4) in degrees, seen along the normal of each quad."""
    p = points[quads]
    back, ahead = np.roll(p, 1, axis=1) - p, np.roll(p, -1, axis=1) - p
    normal, cross = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]), np.cross(ahead, back)
    angle = np.degrees(np.arctan2(np.linalg.norm(cross, axis=2), (ahead * back).sum(axis=2)))
    return np.where((cross * normal[:, None]).sum(axis=2) < 0, 360 - angle, angle)


def filled(vertices, faces, loop, truth, cells):
    """A fill, its points, and (seam, distance, seconds)."""
    started = time.process_time()
    fill = gridmesh.fill_hole(vertices, faces, loop, cells=cells)
    seconds = time.process_time() - started
    points = np.r_[vertices, fill.vertices]
    cut = np.r_[fill.quads[:, [0, 1, 2]], fill.quads[:, [0, 2, 3]], fill.triangles]
    near = np.isin(faces, loop).any(axis=1)
    off = math.nan
    if truth is not None:
        old, ours = truth[0][truth[1]], points[cut]
        both = np.r_[distances(samples(ours), old), distances(samples(old), ours)]
        off = math.sqrt(np.mean(both**2))
    return fill, points, (angles_across(points, cut, faces[near]), off, seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", type=Path)
    folder = parser.parse_args().meshes
    rows = []
    for mesh in json.loads((folder / "manifest.json").read_text(encoding="utf-8")):
        vertices, faces = read(folder / mesh["file"])
        for given in mesh["loops"]:
            loop = np.array(given["vertices"])
            path = folder / f"{mesh['id']}.truth{given['index']}.ply"
            truth = read(path) if path.exists() else None
            _, _, plain = filled(vertices, faces, loop, truth, "triangles")
            fill, points, ours = filled(vertices, faces, loop, truth, "quads")
            if len(fill.triangles) != len(loop) % 2:
                raise SystemExit(f"{mesh['id']} {given['index']}: {len(fill.triangles)} triangles")
            if not len(fill.quads):
                continue
            angles = corners_of(points, fill.quads)
            ratios = [b / a if a else math.nan for a, b in zip(plain, ours, strict=True)]
            poles = fill.report["irregular"]
            rows.append([angles.min(), angles.max(), poles, np.abs(angles - 90).mean(), *ratios])
            print(
                f"{mesh['id']} {given['index']}: {len(loop)} edges, {len(fill.quads)} quads, {fill.report['grid']}, "
                f"corners {angles.min():.0f} to {angles.max():.0f}, {poles} poles, "
                f"seam {plain[0]:.1f} to {ours[0]:.1f}",
                flush=True,
            )
    names = ("least", "greatest", "poles", "deviation", "seam", "distance", "time")
    middle = np.nanmedian(np.array(rows), axis=0)
    print(f"{len(rows)} loops:", ", ".join(f"{k} {v:.2f}" for k, v in zip(names, middle, strict=True)))


if __name__ == "__main__":
    main()
