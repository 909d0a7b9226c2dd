# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights of flat meshes: for the bones of an armature, and carried from one mesh of a picture to the next. No operators."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
from mathutils.bvhtree import BVHTree

from ..api import cancelling
from ..native import native

FLAT = 1e-3
"""Thickness that a flat mesh may have, relative to its width."""


class WeightError(ValueError):
    """A mesh gets no weights. The message says why, without naming the mesh."""


def bones_of(armature: bpy.types.Object) -> tuple[list[str], np.ndarray]:
    """Names of the bones that deform, and their ends (b, 2, 3) at rest in the world."""
    bones = [bone for bone in armature.data.bones if bone.use_deform]
    ends = np.array([[bone.head_local, bone.tail_local] for bone in bones], float).reshape(-1, 2, 3)
    return [bone.name for bone in bones], _moved(ends, armature.matrix_world)


def for_bones(
    ob: bpy.types.Object,
    ends: np.ndarray,
    *,
    most: int,
    reach: float,
    progress: Callable[[float], object] | None = None,
) -> np.ndarray:
    """Weights (n, b) of the vertices of a flat mesh for bones (b, 2, 3) in the world.

    Raises
    ------
    WeightError
        If the mesh is not flat or has no faces.
    CancelledError
        If `progress` or Ctrl-C asked to stop.
    NativeError
        Without the module.
    """
    gridmesh = native("bone_weights")
    mesh = ob.data
    if not len(mesh.polygons):
        raise WeightError("it has no faces")
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    places = _moved(_points(mesh), ob.matrix_world)
    middle = places.mean(axis=0)
    _, sizes, axes = np.linalg.svd(places - middle, full_matrices=False)
    away = np.abs((places - middle) @ axes[2])
    if sizes[1] <= 1e-9 * sizes[0] or away.max() > FLAT * np.ptp((places - middle) @ axes[0]):
        raise WeightError(
            "it is not flat; select the body and then the armature, and choose Object > Parent > With Automatic Weights"
        )
    across = axes[:2].T
    try:
        with cancelling(gridmesh):
            return gridmesh.bone_weights(
                (places - middle) @ across,
                triangles.reshape(-1, 3),
                (ends - middle) @ across,
                most=most,
                reach=reach,
                progress=progress,
            )
    except gridmesh.GridMeshError as error:
        raise WeightError(str(error)) from error


def put(ob: bpy.types.Object, names: list[str], weights: np.ndarray) -> None:
    """Replace the vertex groups of these names; others stay."""
    for name, column in zip(names, weights.T, strict=True):
        group = ob.vertex_groups.get(name) or ob.vertex_groups.new(name=name)
        group.remove(range(len(column)))
        for value in np.unique(column[column > 0]):  # those that are alike at once: 1 above all
            group.add(np.flatnonzero(column == value).tolist(), float(value), "REPLACE")


def read(ob: bpy.types.Object) -> tuple[list[str], np.ndarray]:
    """Names of all vertex groups, and the weights (n, g)."""
    names = [group.name for group in ob.vertex_groups]
    weights = np.zeros((len(ob.data.vertices), len(names)))
    for vertex in ob.data.vertices if names else ():
        for element in vertex.groups:
            weights[vertex.index, element.group] = element.weight
    return names, weights


class Kept:
    """The vertex groups of an object, to be put onto the mesh that replaces its own."""

    def __init__(self, ob: bpy.types.Object, normal: np.ndarray) -> None:
        self.names, self.weights = read(ob)
        self.points = _points(ob.data)
        mesh = ob.data
        mesh.calc_loop_triangles()
        triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
        self.triangles = triangles.reshape(-1, 3)
        self.normal = normal / np.linalg.norm(normal)

    def put(self, ob: bpy.types.Object) -> None:
        """Give each vertex the weights of the nearest place of the old mesh, seen along the normal; front and back apart."""
        if not self.names or not self.weights.any() or not len(self.triangles):
            return
        points = _points(ob.data)
        corners = self._flat(self.points)[self.triangles]
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ self.normal
        below = points @ self.normal < np.median(self.points[np.unique(self._rim())] @ self.normal) - 1e-6
        found = np.zeros((len(points), len(self.names)))
        for side, vertices in ((facing >= 0, ~below), (facing < 0, below)):
            triangles = self.triangles[side] if side.any() else self.triangles
            found[vertices] = self._nearest(triangles, self._flat(points[vertices]))
        put(ob, self.names, found)

    def _flat(self, points: np.ndarray) -> np.ndarray:
        return points - np.outer(points @ self.normal, self.normal)

    def _rim(self) -> np.ndarray:
        """Vertices between the front and the back, or at the border of a sheet."""
        corners = self._flat(self.points)[self.triangles]
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ self.normal >= 0
        front, back = self.triangles[facing].ravel(), self.triangles[~facing].ravel()
        shared = np.intersect1d(front, back)
        return shared if len(shared) else np.arange(len(self.points))

    def _nearest(self, triangles: np.ndarray, points: np.ndarray) -> np.ndarray:
        old = self._flat(self.points)
        tree = BVHTree.FromPolygons(old.tolist(), triangles.tolist(), all_triangles=True)
        found = np.zeros((len(points), len(self.names)))
        for at, point in enumerate(points):
            place, _, which, _ = tree.find_nearest(point.tolist())
            if which is not None:
                corners = triangles[which]
                found[at] = _barycentric(old[corners], np.array(place)) @ self.weights[corners]
        return found


def _barycentric(corners: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Shares (3,) of the corners (3, 3) in a place on their triangle."""
    a, b = corners[1] - corners[0], corners[2] - corners[0]
    shares, *_ = np.linalg.lstsq(np.column_stack([a, b]), place - corners[0], rcond=None)
    shares = np.clip([1 - shares.sum(), *shares], 0, 1)
    return shares / shares.sum()


def _points(mesh: bpy.types.Mesh) -> np.ndarray:
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    return points.reshape(-1, 3).astype(float)


def _moved(points: np.ndarray, matrix: object) -> np.ndarray:
    matrix = np.array(matrix, float)
    return points @ matrix[:3, :3].T + matrix[:3, 3]
