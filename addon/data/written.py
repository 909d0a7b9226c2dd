# SPDX-License-Identifier: GPL-3.0-or-later
"""What GridMesh has written into meshes, to be known again: by a fingerprint, and in this session by the coordinates.

`motion` tells a mesh that was only moved, scaled or mirrored as a whole from one that was changed by hand.
"""

from __future__ import annotations

import zlib

import bpy
import numpy as np

MOST = 20_000_000
"""Coordinates that are remembered, above which those that no mesh refers to are forgotten."""

_points: dict[str, np.ndarray] = {}
"""Vertices (n, 3) float32 by the fingerprint of their mesh. Undo and copies of meshes need no more."""


def forget() -> None:
    """Forget all coordinates."""
    _points.clear()


def fingerprint(points: np.ndarray, corners: np.ndarray, faces: int) -> str:
    """Fingerprint of vertices (float32), corners (int32) and a number of faces; see `digest`."""
    numbers = points.size, corners.size, faces, zlib.crc32(points.tobytes()), zlib.crc32(corners.tobytes())
    return " ".join(map(str, numbers))


def digest(mesh: bpy.types.Mesh) -> str:
    """Fingerprint of the vertices and faces of a mesh. Other data of it does not count."""
    return fingerprint(points_of(mesh), corners_of(mesh), len(mesh.polygons))


def sign(mesh: bpy.types.Mesh) -> None:
    """Remember that the mesh, as it is, was made by GridMesh."""
    points = points_of(mesh)
    mesh.gridmesh_made = fingerprint(points, corners_of(mesh), len(mesh.polygons))
    keep(mesh.gridmesh_made, points)


def by_hand(mesh: bpy.types.Mesh) -> bool:
    """Whether the shape of a mesh is not what GridMesh has made of it."""
    points = points_of(mesh)
    if mesh.gridmesh_made != fingerprint(points, corners_of(mesh), len(mesh.polygons)):
        return True
    keep(mesh.gridmesh_made, points)
    return False


def keep(made: str, points: np.ndarray) -> None:
    """Remember the coordinates (3 n, float32) of the mesh with this fingerprint."""
    if made in _points:
        return
    _points[made] = points.reshape(-1, 3).copy()
    if sum(one.size for one in _points.values()) > MOST:
        used = {mesh.gridmesh_made for mesh in bpy.data.meshes} | {made}
        for gone in _points.keys() - used:
            del _points[gone]


def is_edited(ob: bpy.types.Object) -> bool:
    """Whether the mesh of an object is being edited, sculpted or painted, there or at another object that has it: it is not to be written then."""
    if ob.mode != "OBJECT":
        return True
    mesh = ob.data
    return mesh.users > 1 and any(other.data == mesh and other.mode != "OBJECT" for other in bpy.data.objects)


def points_of(mesh: bpy.types.Mesh) -> np.ndarray:
    """Coordinates (3 n, float32) of the vertices."""
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    return points


def corners_of(mesh: bpy.types.Mesh) -> np.ndarray:
    """Vertex (int32) of each corner; as an attribute, which is many times as fast as from `loops`, but is not there in Edit Mode."""
    corners = np.empty(len(mesh.loops), np.int32)
    attribute = mesh.attributes.get(".corner_vert")
    if attribute is not None:
        attribute.data.foreach_get("value", corners)
    else:
        mesh.loops.foreach_get("vertex_index", corners)
    return corners


def motion(mesh: bpy.types.Mesh) -> np.ndarray | None:
    """Matrix (4, 4) that took the mesh, as GridMesh has made it, to what it is now as a whole; None if none did.

    Of a flat mesh the third direction stays perpendicular, and is scaled as the others are.
    """
    before = _points.get(mesh.gridmesh_made)
    if before is None or not len(before) or len(mesh.vertices) != len(before):
        return None
    corners, count, after = corners_of(mesh), len(mesh.polygons), points_of(mesh)
    if not count:
        return None
    if mesh.gridmesh_made.split()[1:3] != [str(corners.size), str(count)]:
        return None
    known = mesh.gridmesh_made.split()[4]
    if known not in (str(zlib.crc32(one.tobytes())) for one in (corners, _turned(mesh, corners))):
        return None
    return affine(before.astype(float), after.reshape(-1, 3).astype(float))


def _turned(mesh: bpy.types.Mesh, corners: np.ndarray) -> np.ndarray:
    """Vertices of the corners of faces that are turned round, as Blender 5 does it where a mirrored scale is applied."""
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    sizes = np.diff(np.append(starts, len(corners)))
    step = np.arange(len(corners)) - np.repeat(starts, sizes)
    back = np.repeat(sizes, sizes) - step
    return np.ascontiguousarray(corners[np.repeat(starts, sizes) + np.where(step == 0, 0, back)])


def affine(before: np.ndarray, after: np.ndarray) -> np.ndarray | None:
    """Return the regular matrix (4, 4) that takes points (n, 3) to others in single precision; None without one."""
    if not (np.isfinite(before).all() and np.isfinite(after).all()):
        return None
    origin, target = before.mean(axis=0), after.mean(axis=0)
    own, wanted = before - origin, after - target
    size = np.abs(own).max()
    if not size:
        return None
    # Least squares by the normal equations, in the main directions; the numbers are few.
    values, axes = np.linalg.eigh(own.T @ own / (len(own) * size * size))
    along = own @ axes
    images = np.zeros((3, 3))  # of the axes, as rows
    solid = values > 1e-12
    if solid.sum() < 2:
        return None
    images[solid] = np.linalg.lstsq(along[:, solid], wanted, rcond=None)[0]
    if not solid[0]:  # a sheet; eigenvalues ascend
        normal = np.cross(images[1], images[2]) * np.sign(np.linalg.det(axes))
        length = np.linalg.norm(normal)
        images[0] = normal / np.sqrt(length) if length else 0.0
    matrix = np.eye(4)
    matrix[:3, :3] = (axes @ images).T
    matrix[:3, 3] = target - matrix[:3, :3] @ origin
    found = before @ matrix[:3, :3].T + matrix[:3, 3]
    reach = np.abs(after).max() + np.abs(matrix[:3, :3]).max() * np.abs(before).max()
    if np.abs(found - after).max() > 2e-6 * reach or abs(np.linalg.det(matrix[:3, :3])) < 1e-12:
        return None
    return matrix
