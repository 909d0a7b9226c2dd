# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies to files, through Blender's own exporters: whole, or not at all."""

from __future__ import annotations

import glob
import os
import shutil
import tempfile
from pathlib import Path

import bpy
from mathutils import Matrix

from .. import meshes
from ..api import Body


class OutputError(RuntimeError):
    """A file could not be written. The message says why."""


def write(path: Path, bodies: list[Body], crease_angle: float) -> None:
    """Write the bodies to a temporary folder beside `path`, and rename the finished file.

    The scene is empty before and after.
    """
    prefix = f".gridmesh-{path.name}-"
    for left in path.parent.glob(f"{glob.escape(prefix)}????????"):
        shutil.rmtree(left)  # of a run that was killed
    with tempfile.TemporaryDirectory(prefix=prefix, dir=path.parent) as folder:
        draft = Path(folder) / f"body{path.suffix.lower()}"
        objects = []
        try:
            for body in bodies:
                objects.append(_object(path.stem, body, crease_angle))
            _export(draft, objects)
        except RuntimeError as error:  # what Blender's operators raise
            raise OutputError(str(error).strip()) from error
        finally:
            for ob in objects:
                mesh = ob.data
                bpy.data.objects.remove(ob)
                bpy.data.meshes.remove(mesh)
        if not draft.exists() or not draft.stat().st_size:
            raise OutputError("Blender wrote no file")
        with draft.open("rb+") as file:
            os.fsync(file.fileno())
        draft.replace(path)


def _object(name: str, body: Body, crease_angle: float) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    ob = bpy.data.objects.new(name, mesh)
    meshes.fill(mesh, body, crease_angle)
    ob.matrix_world = Matrix(body.sketch.plane.matrix.tolist())
    bpy.context.scene.collection.objects.link(ob)
    return ob


def _export(path: Path, objects: list[bpy.types.Object]) -> None:
    bpy.context.view_layer.update()
    name, suffix = str(path), path.suffix
    if suffix == ".blend":
        bpy.data.libraries.write(name, set(objects), fake_user=False)
        return
    if suffix == ".ply":
        done = bpy.ops.wm.ply_export(filepath=name, forward_axis="Y", up_axis="Z")
    elif suffix == ".obj":
        done = bpy.ops.wm.obj_export(filepath=name, export_materials=False, forward_axis="Y", up_axis="Z")
    elif suffix == ".stl":
        done = bpy.ops.wm.stl_export(filepath=name, forward_axis="Y", up_axis="Z")
    else:
        done = bpy.ops.export_scene.gltf(filepath=name, export_format="GLB")
    if done != {"FINISHED"}:
        raise OutputError(f"Blender's exporter answered {done}")
