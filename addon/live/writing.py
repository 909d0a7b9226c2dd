# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that a body has, changed in place while its faces stay."""

from __future__ import annotations

import bpy
import numpy as np

from ..api import Body
from ..data import meshes, written


def write(ob: bpy.types.Object, body: Body, crease_angle: float, *, marks: bool) -> None:
    """Give an object another mesh of the same name; all that belongs to vertices stays where the faces do.

    body : with vertices in the object's space. marks : whether creases are marked anew where the faces stay;
    while dragging they wait.
    """
    mesh = ob.data
    faces = np.ascontiguousarray(body.faces, np.int32)
    counts = len(mesh.vertices), len(mesh.loops), len(mesh.polygons)
    if counts != (len(body.vertices), faces.size, len(faces)):
        meshes.refresh(ob, body, crease_angle)
        return
    corners = written.corners_of(mesh)
    if not np.array_equal(corners, faces.ravel()):
        meshes.refresh(ob, body, crease_angle)
        return
    points = np.ascontiguousarray(body.vertices, np.float32).ravel()
    mesh.vertices.foreach_set("co", points)
    layer = mesh.uv_layers.get(meshes.UV_MAP)
    if layer is not None:
        layer.uv.foreach_set("vector", np.ascontiguousarray(body.uv, np.float32).ravel())
    if marks:
        meshes.mark_creases(mesh, body, crease_angle)
    mesh.update()
    mesh.gridmesh_made = written.fingerprint(points, corners, len(mesh.polygons))
    written.keep(mesh.gridmesh_made, points)
