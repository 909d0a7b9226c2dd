# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "gridmesh", "numpy==1.26.4", "scipy==1.17.1"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""What the ways to place a patch's vertices trade against each other. From the folder of the project:

    uv run tests/peers/fills.py

Disks are cut from generated surfaces, so that it is known what was there: an ellipsoid, a torus, a sphere with
waves, and a wavy sheet with vertices strewn at random, whose loops are uneven. Each hole is filled

* by `gridmesh.fill_hole` with each `smooth`;
* with the same grid, its vertices placed by thin plates in three coordinates, as fairing usually is done: with
  weights of one, with the cotangents of the film, and with cotangents renewed five times;
* in Blender by Fill and by Grid Fill, for holes that the latter takes.

Prints a table in Markdown, medians over the holes. `seam`: root mean square of the angles across the loop's
edges, over that of the edges around the hole. `distance`: root mean square from the patch to the surface that
was cut out and back, over the hole's diameter. `shape`: mean of twice the inscribed by the circumscribed radius.
`sharp`: the tenth of the holes with the least angle is below this.
"""

from __future__ import annotations

import argparse
import math
import platform
from collections import defaultdict
from dataclasses import dataclass

import bpy  # noqa: F401  (bmesh is there once bpy is)

# isort: split
import bmesh
import gridmesh
import numpy as np
from closeness import angles_across, distances, samples
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import spsolve
from scipy.spatial import ConvexHull, Delaunay

DISKS = 15
"""Disks cut from each surface, one at a time."""


@dataclass
class Hole:
    """A mesh with a hole, and the disk that was there."""

    surface: str
    vertices: np.ndarray
    faces: np.ndarray
    loop: np.ndarray
    disk: np.ndarray


def ball(count):
    """Points spread evenly over the unit sphere, and their hull."""
    k = np.arange(count) + 0.5
    z, turn = 1 - 2 * k / count, math.pi * (1 + 5**0.5) * k
    flat = np.sqrt(1 - z * z)
    points = np.c_[flat * np.cos(turn), flat * np.sin(turn), z]
    faces = ConvexHull(points).simplices
    corners = points[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = (normal * corners.sum(1)).sum(1) < 0
    faces[inward] = faces[inward][:, ::-1]
    return points, faces


def ellipsoid():
    points, faces = ball(900)
    return points * [1.0, 0.8, 0.5], faces


def waves():
    points, faces = ball(1500)
    x, y, z = points.T
    return points * (1 + 0.08 * np.sin(5 * x) * np.cos(4 * y) + 0.05 * np.sin(6 * z))[:, None], faces


def torus(m=56, n=20):
    i, j = (a.ravel() for a in np.meshgrid(np.arange(m), np.arange(n), indexing="ij"))
    u, v = 2 * math.pi * i / m, 2 * math.pi * (j + 0.5 * (i % 2)) / n
    ring = 1 + 0.4 * np.cos(v)
    points = np.c_[ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)]

    def at(a, b):
        return (a % m) * n + b % n

    even = i % 2 == 0
    corner = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    one = np.where(
        even[:, None], np.c_[corner[0], corner[1], corner[3]], np.c_[corner[0], corner[1], corner[2]]
    )
    two = np.where(
        even[:, None], np.c_[corner[1], corner[2], corner[3]], np.c_[corner[0], corner[2], corner[3]]
    )
    return points, np.r_[one, two]


def strewn():
    rng = np.random.default_rng(5)
    flat = rng.uniform(-1, 1, (1400, 2))
    faces = Delaunay(flat).simplices
    a, b, c = (flat[faces[:, k]] for k in range(3))
    turned = np.cross(b - a, c - a) < 0
    faces[turned] = faces[turned][:, ::-1]
    return np.c_[flat, 0.25 * np.sin(3 * flat[:, 0]) * np.cos(2.5 * flat[:, 1])], faces


def half_edges(faces):
    return np.r_[faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]


def border(faces):
    """The one loop around a disk, against the mesh that it is cut from; None if it is no disk."""
    edges = half_edges(faces)
    known = set(map(tuple, edges.tolist()))
    after = {b: a for a, b in known if (b, a) not in known}
    corners, sides = len(np.unique(faces)), len(known | {(b, a) for a, b in known}) // 2
    if corners - sides + len(faces) != 1 or not after:
        return None
    loop = [min(after)]
    while len(loop) <= len(after) and after[loop[-1]] != loop[0]:
        loop.append(after[loop[-1]])
    return np.array(loop) if len(loop) == len(after) else None


def holes(surface):
    rng = np.random.default_rng(7)
    vertices, faces = surface()
    outline = {v for edge in open_edges(faces) for v in edge}
    found = []
    while len(found) < DISKS:
        disk = np.isin(faces, rng.integers(len(vertices))).any(1)
        for _ in range(rng.integers(1, 5)):
            disk = np.isin(faces, faces[disk]).any(1)
        loop = border(faces[disk])
        if loop is None or outline & set(np.unique(faces[disk]).tolist()):
            continue
        found.append(Hole(surface.__name__, vertices, faces[~disk], loop, faces[disk]))
    return found


def open_edges(faces):
    known = set(map(tuple, half_edges(faces).tolist()))
    return [edge for edge in known if edge[::-1] not in known]


# Other ways to place the vertices


def cotangents(points, faces):
    """Symmetric matrix of half the cotangents that face each edge."""
    rows, columns, values = [], [], []
    for k in range(3):
        i, j, o = faces[:, (k + 1) % 3], faces[:, (k + 2) % 3], faces[:, k]
        u, w = points[i] - points[o], points[j] - points[o]
        half = 0.5 * (u * w).sum(1) / np.maximum(np.linalg.norm(np.cross(u, w), axis=1), 1e-12)
        rows += [i, j]
        columns += [j, i]
        values += [half, half]
    shape = (len(points), len(points))
    return csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape)


def plate(hole, film, rounds, uniform=False):
    """A thin plate on the film's grid: least squared Laplacians inside and on the loop, one ring known."""
    first = len(hole.vertices)
    points = np.r_[hole.vertices, film.vertices]
    ring = hole.faces[np.isin(hole.faces, hole.loop).any(1)]
    faces = np.r_[film.triangles, ring]
    rows = np.r_[hole.loop, np.arange(first, len(points))]
    free = np.arange(first, len(points))
    for _ in range(rounds):
        weights = cotangents(points, faces)
        if uniform:
            weights.data[:] = 1.0
        area = np.zeros(len(points))
        corners = points[faces]
        size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        np.add.at(area, faces.ravel(), np.repeat(size / 6, 3))
        if uniform:
            area[:] = 1.0
        laplacian = (weights - diags(np.asarray(weights.sum(1)).ravel())).tocsr()[rows]
        inner, outer = laplacian[:, free], laplacian[:, :first]
        normal = inner.T @ diags(1 / area[rows])
        points[free] = spsolve((normal @ inner).tocsc(), -normal @ (outer @ hole.vertices)).reshape(-1, 3)
    return points[free], film.triangles


def ours(hole, smooth):
    fill = gridmesh.fill_hole(hole.vertices, hole.faces, hole.loop, smooth=smooth)
    return fill.vertices, fill.triangles


def blender(hole, grid):
    """What Blender's Fill or Grid Fill makes of the loop; None where it refuses."""
    bm = bmesh.new()
    made = [bm.verts.new(point) for point in hole.vertices]
    for face in hole.faces.tolist():
        bm.faces.new([made[v] for v in face])
    bm.verts.index_update()
    old = set(bm.faces)
    rim = [bm.edges.get((made[a], made[b])) for a, b in zip(hole.loop, np.roll(hole.loop, -1), strict=True)]
    try:
        if grid:
            opposite = len(rim) // 2
            span = len(rim) // 4
            two = rim[:span] + rim[opposite : opposite + span]
            bmesh.ops.grid_fill(bm, edges=two, use_interp_simple=False)
        else:
            bmesh.ops.triangle_fill(bm, edges=rim, use_beauty=True)
    except RuntimeError:
        bm.free()
        return None
    fresh = [face for face in bm.faces if face not in old]
    if fresh:
        result = bmesh.ops.triangulate(bm, faces=fresh)
        fresh = [face for face in bm.faces if face not in old or face in result["faces"]]
    bm.verts.index_update()
    points = np.array([vertex.co for vertex in bm.verts])
    triangles = np.array([[vertex.index for vertex in face.verts] for face in fresh]).reshape(-1, 3)
    bm.free()
    edges = np.sort(half_edges(triangles), axis=1) if len(triangles) else np.zeros((0, 2), int)
    kinds, times = np.unique(edges, axis=0, return_counts=True)
    rims = {
        (min(a, b), max(a, b))
        for a, b in zip(hole.loop.tolist(), np.roll(hole.loop, -1).tolist(), strict=True)
    }
    if {tuple(edge) for edge in kinds[times == 1].tolist()} != rims:
        return None
    return points[len(hole.vertices) :], triangles


# What is measured


def measure(hole, patch):
    fresh, triangles = patch
    points = np.r_[hole.vertices, fresh]
    near = np.isin(hole.faces, hole.loop).any(1)
    near = np.isin(hole.faces, hole.faces[near]).any(1)
    rim = hole.vertices[hole.loop]
    diameter = np.linalg.norm(rim[:, None] - rim[None], axis=-1).max()
    corners, truth = points[triangles], hole.vertices[hole.disk]
    off = np.r_[distances(samples(corners), truth), distances(samples(truth), corners)]
    sides = [corners[:, (k + 1) % 3] - corners[:, k] for k in range(3)]
    lengths = np.stack([np.linalg.norm(side, axis=1) for side in sides])
    area = np.linalg.norm(np.cross(sides[0], sides[1]), axis=1) / 2
    shape = 16 * area**2 / (lengths.prod(0) * lengths.sum(0))
    least = math.pi
    for k in range(3):
        u, w = sides[k], -sides[k - 1]
        angle = np.arctan2(np.linalg.norm(np.cross(u, w), axis=1), (u * w).sum(1))
        least = min(least, angle.min())
    valence = defaultdict(set)
    for a, b in half_edges(triangles).tolist():
        valence[a].add(b)
        valence[b].add(a)
    inner = [len(valence[v]) != 6 for v in range(len(hole.vertices), len(points))]
    return {
        "seam": angles_across(points, triangles, hole.faces[near]) / angles_across(points, hole.faces[near]),
        "distance": math.sqrt(np.mean(off**2)) / diameter,
        "shape": shape.mean(),
        "least": math.degrees(least),
        "irregular": np.mean(inner) if inner else 0.0,
    }


METHODS = {
    '`smooth="flat"`': lambda hole, film: ours(hole, "flat"),
    '`smooth="tangent"`, the default': lambda hole, film: ours(hole, "tangent"),
    '`smooth="curvature"`': lambda hole, film: ours(hole, "curvature"),
    "same grid, plate with weights of one": lambda hole, film: plate(hole, film, 1, uniform=True),
    "same grid, plate with the film's cotangents": lambda hole, film: plate(hole, film, 1),
    "same grid, cotangents renewed five times": lambda hole, film: plate(hole, film, 6),
    "Blender, Fill": lambda hole, film: blender(hole, grid=False),
    "Blender, Grid Fill": lambda hole, film: blender(hole, grid=True),
}


def main():
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    cut = [hole for surface in (ellipsoid, torus, waves, strewn) for hole in holes(surface)]
    found = defaultdict(list)
    for hole in cut:
        film = gridmesh.fill_hole(hole.vertices, hole.faces, hole.loop, smooth="flat")
        for name, method in METHODS.items():
            patch = method(hole, film)
            if patch is not None:
                found[name].append(measure(hole, patch))
    lengths = [len(hole.loop) for hole in cut]
    print(f"{len(cut)} holes of {min(lengths)} to {max(lengths)} edges, on {platform.machine()}\n")
    print("| | filled | irregular inside | seam | distance | shape | least angle | sharp |")
    print("|---|---|---|---|---|---|---|---|")
    for name in METHODS:
        rows = found[name]
        if not rows:
            print(f"| {name} | 0 | | | | | | |")
            continue
        column = {key: np.array([row[key] for row in rows]) for key in rows[0]}
        middle = {key: float(np.median(values)) for key, values in column.items()}
        print(
            f"| {name} | {len(rows)} | {middle['irregular']:.0%} | {middle['seam']:.2f} | {middle['distance']:.4f} "
            f"| {middle['shape']:.3f} | {middle['least']:.1f} | {np.quantile(column['least'], 0.1):.1f} |"
        )


if __name__ == "__main__":
    main()
