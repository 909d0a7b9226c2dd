# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects to files, through Blender's own exporters: whole, or not at all."""

from __future__ import annotations

import gc
import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from ..api import Body
from ..data import meshes
from . import drafts
from .loading import said
from .whole import is_whole


class OutputError(RuntimeError):
    """A file could not be written. The message says why."""

    kind = "output"


_swept: set[Path] = set()
"""Folders in which nothing is left of runs that were killed."""


def placed(name: str, bodies: list[Body], crease_angle: float) -> list[bpy.types.Object]:
    """Make objects of the bodies, in the scene."""
    made = []
    name = name.encode("utf-8", "replace").decode()  # of a file, which may be no text
    for body in bodies:
        mesh = bpy.data.meshes.new(name)
        ob = bpy.data.objects.new(name, mesh)
        meshes.fill(mesh, _turned(body), crease_angle)
        ob.matrix_world = Matrix(body.sketch.plane.matrix.tolist())
        bpy.context.scene.collection.objects.link(ob)
        made.append(ob)
    bpy.context.view_layer.update()
    return made


def _turned(body: Body) -> Body:
    """Return the body with quads that begin at an end of their shorter diagonal.

    Formats without quads get them cut from the first corner to the third.
    """
    faces = np.asarray(body.faces)
    if faces.shape[1] != 4:
        return body
    a, b, c, d = (np.asarray(body.vertices)[faces[:, k]] for k in range(4))
    turn = np.linalg.norm(d - b, axis=1) < np.linalg.norm(c - a, axis=1)
    order = (np.arange(4) + turn[:, None]) % 4
    uv = np.take_along_axis(np.asarray(body.uv).reshape(-1, 4, 2), order[..., None], axis=1)
    return replace(body, faces=np.take_along_axis(faces, order, axis=1), uv=uv.reshape(-1, 2))


def write(path: Path, objects: list[bpy.types.Object]) -> None:
    """Write the objects; a .blend file gets everything that is loaded."""
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob in objects)
    bpy.context.view_layer.objects.active = objects[0]
    depsgraph = bpy.context.evaluated_depsgraph_get()
    faces = sum(len(ob.evaluated_get(depsgraph).data.polygons) for ob in objects)
    safely(path, _export, faces)


def safely(path: Path, make: Callable[[Path], None], faces: int = 0) -> None:
    """Let a file be made under a temporary name beside `path`, look whether it is whole, and rename it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.parent not in _swept:  # in a large folder that takes its time
        drafts.sweep(path.parent)
        _swept.add(path.parent)
    prefix = drafts.prefix(path, os.getpid())
    number, name = tempfile.mkstemp(prefix=prefix, suffix=path.suffix.lower(), dir=path.parent)
    os.close(number)
    draft = Path(name)
    try:
        try:
            make(draft)
        except RuntimeError as error:  # what Blender's operators raise
            raise OutputError(said(error)) from error
        if not is_whole(draft, faces):
            raise OutputError(f"'{path.name}' could not be written to its end; is the disk full?")
        with draft.open("rb+") as file:
            os.fsync(file.fileno())
        draft.chmod(0o666 & ~_umask())
        try:
            draft.replace(path)
        except OSError as error:
            raise OutputError(f"'{path.name[:60]}' cannot be written: {error.strerror}") from error
    except BaseException:
        _release()
        raise
    finally:
        for left in (draft, draft.with_name(f"{draft.name}@")):  # Blender writes to the second one first
            left.unlink(missing_ok=True)


def _release() -> None:
    """Close the files that a failed exporter left open: a deleted one still fills the disk.

    Python keeps the frames of the last error that was printed.
    """
    for name in ("last_exc", "last_type", "last_value", "last_traceback"):
        vars(sys).pop(name, None)
    gc.collect()


def _umask() -> int:
    """Permissions that new files do not get; asking sets it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _export(path: Path) -> None:
    name, suffix = str(path), path.suffix
    axes = {"forward_axis": "Y", "up_axis": "Z", "export_selected_objects": True}
    if suffix == ".blend":
        path.unlink()  # or it would be kept as a backup
        done = bpy.ops.wm.save_as_mainfile(filepath=name, copy=True, compress=False)
    elif suffix == ".ply":
        done = bpy.ops.wm.ply_export(filepath=name, **axes)
    elif suffix == ".obj":
        done = bpy.ops.wm.obj_export(filepath=name, export_materials=False, **axes)
    elif suffix == ".stl":
        done = bpy.ops.wm.stl_export(filepath=name, **axes)
    else:
        done = bpy.ops.export_scene.gltf(filepath=name, export_format="GLB", use_selection=True)
    if done != {"FINISHED"}:
        raise OutputError(f"Blender's exporter answered {done}")
