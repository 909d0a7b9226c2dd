# SPDX-License-Identifier: GPL-3.0-or-later
"""Files into Blender, through its own importers: objects with meshes, and strokes."""

from __future__ import annotations

import contextlib
import re
import shutil
import tempfile
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from xml.parsers import expat

import addon_utils
import bmesh
import bpy
import numpy as np

from ..bodies import strokes
from ..bodies.outlines import Stroke
from . import files, inputs, sound
from .inputs import InputError

_NEEDED = {".svg": "io_curve_svg", ".glb": "io_scene_gltf2", ".gltf": "io_scene_gltf2"}
"""Add-ons that come with Blender, for formats that need one."""

_TORN = (".ply", ".glb", ".gltf")
"""Formats with one normal and one UV for each vertex: it is doubled wherever faces do not agree on them."""

_PLAIN = (".json", ".csv")
"""Read by our own code, into no Blender data."""

_BAD_NUMBER = re.compile(r"(?i)(?<![a-z])(nan|[+-]?inf(inity)?)(?![a-z])")
_SHAPES = {
    "d", "points", "x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "rx", "ry", "width", "height", "transform",
    "viewBox",
}  # fmt: skip


class LoadError(InputError):
    """A file could not be loaded. The message says why."""


def clear() -> None:
    """Empty the session."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def tidy(path: Path, objects: list[bpy.types.Object]) -> None:
    """Empty the session after a file from which these objects were made."""
    if path.suffix.lower() not in _PLAIN:
        clear()
        return
    for ob in objects:  # far faster, and nothing else was loaded
        mesh = ob.data
        bpy.data.objects.remove(ob)
        bpy.data.meshes.remove(mesh)


def meshes(
    path: Path, pattern: str | None, *, scripts: bool, weld: bool | None, instances: bool = False
) -> tuple[list[bpy.types.Object], list[str]]:
    """Load a file; its mesh objects, and what the user should know of the choice.

    pattern : which objects, as in a shell; None: all that are visible. scripts : whether a .blend file may run its own.
    weld : whether vertices at the same place become one; None: in files whose format tears meshes at seams. instances : all
    objects that share a mesh, not only one of them.
    """
    damage = sound.require_whole(path)
    _load(path, scripts=scripts)
    loaded = sum(len(ob.data.polygons) for ob in bpy.data.objects if ob.type == "MESH")
    damage += sound.left_out(path, loaded)
    found, notes = _chosen({"MESH"}, pattern, "meshes")
    first = {ob.data.name: ob for ob in reversed(found)}  # of objects that share a mesh, one
    if path.suffix.lower() in _TORN if weld is None else weld:
        for ob in first.values():
            _weld(ob.data)
    if not instances:
        found = [ob for ob in found if first[ob.data.name] is ob]
    return found, damage + notes + _unusable(found)


def pieces(ob: bpy.types.Object) -> list[bpy.types.Object]:
    """Make an object of each piece of a mesh that hangs together; cavities stay with what is around them.

    Vertices and edges without faces are no pieces.
    """
    _select([ob])
    bpy.ops.mesh.separate(type="LOOSE")
    found = sorted(bpy.context.selected_objects, key=lambda one: (one != ob, one.name))
    found = [one for one in found if len(one.data.polygons)] or [ob]
    volumes = {one: _volume(one.data) for one in found}
    solid = sorted((one for one in found if volumes[one] >= 0), key=volumes.__getitem__)
    for cavity in [one for one in found if volumes[one] < 0]:
        around = next((one for one in solid if _is_within(cavity, one)), None)
        if around is not None:
            found.remove(cavity)
            _select([around, cavity])
            bpy.ops.object.join()
    return found


def _select(objects: list[bpy.types.Object]) -> None:
    """Select these alone; the first is the active one."""
    for other in bpy.context.view_layer.objects:
        other.select_set(other in objects)
    bpy.context.view_layer.objects.active = objects[0]


def _volume(mesh: bpy.types.Mesh) -> float:
    """The volume that a mesh encloses, negative where it faces inward."""
    bm = bmesh.new()
    try:
        bm.from_mesh(mesh)
        return bm.calc_volume(signed=True)
    finally:
        bm.free()


def _is_within(one: bpy.types.Object, other: bpy.types.Object) -> bool:
    """Whether the box of a mesh is within that of another one."""
    inner, outer = (np.array(ob.bound_box) for ob in (one, other))
    return bool((inner >= outer.min(axis=0)).all() and (inner <= outer.max(axis=0)).all())


def _unusable(objects: list[bpy.types.Object]) -> list[str]:
    """What of these meshes nothing can be made of."""
    notes = []
    if bare := [ob.name for ob in objects if not len(ob.data.polygons)]:
        notes.append(f"{len(bare)} of {len(objects)} meshes have no faces: '{bare[0]}'")
    for ob in objects:
        if n := int((~np.isfinite(_points(ob.data)).reshape(-1, 3).all(axis=1)).sum()):
            notes.append(f"'{ob.name}': {n} vertices are not at finite places")
    return notes


def _points(mesh: bpy.types.Mesh) -> np.ndarray:
    """Coordinates, one after the other."""
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    return points


def _weld(mesh: bpy.types.Mesh) -> None:
    """Join the vertices that are at exactly the same place."""
    points = _points(mesh) + 0.0  # -0 is 0
    places = points.view("V12")  # compared as bytes: one key, not three
    _, first, which = np.unique(places, return_index=True, return_inverse=True)
    doubles = np.flatnonzero(first[which] != np.arange(len(places)))
    if not len(doubles):
        return
    bm = bmesh.new()
    try:
        bm.from_mesh(mesh)
        bm.verts.ensure_lookup_table()
        targets = zip(doubles.tolist(), first[which[doubles]].tolist(), strict=True)
        bmesh.ops.weld_verts(bm, targetmap={bm.verts[at]: bm.verts[to] for at, to in targets})
        bm.to_mesh(mesh)
    finally:
        bm.free()


def drawn(path: Path, pattern: str | None, *, scripts: bool) -> tuple[list[Stroke], list[str], list[str]]:
    """Load a file; its strokes, what could not be read, and what the user should know."""
    if path.suffix.lower() in _PLAIN:
        return inputs.curves(path, files.read_bytes(path)), [], []
    _load(path, scripts=scripts)
    found, notes = _chosen(strokes.SOURCE_TYPES, pattern, "drawings or curves")
    reading = strokes.read_objects(bpy.context, found)
    failures = [str(failure) for failure in reading.failures]
    if not reading.strokes:
        raise LoadError("; ".join(failures + reading.notes + notes) or "it has no strokes")
    return reading.strokes, failures, notes + reading.notes


def line(path: Path, *, cyclic: bool) -> list[Stroke]:
    """Strokes of a file of curves, beside what is loaded already."""
    if path.suffix.lower() != ".svg":
        return inputs.curves(path, files.read_bytes(path), cyclic=cyclic)
    before = set(bpy.data.objects)
    _import(path)
    made = [ob for ob in bpy.data.objects if ob not in before]
    bpy.context.view_layer.update()
    reading = strokes.read_objects(bpy.context, [ob for ob in made if ob.type == "CURVE"])
    for ob in made:
        bpy.data.objects.remove(ob)
    return reading.strokes


def _load(path: Path, *, scripts: bool) -> None:
    if path.suffix.lower() == ".blend":
        _operate(bpy.ops.wm.open_mainfile, filepath=str(path), load_ui=False, use_scripts=scripts)
        if not len(bpy.context.scene.objects):  # a library, whose objects are in no scene
            for ob in bpy.data.objects:
                bpy.context.scene.collection.objects.link(ob)
    else:
        _import(path)
    bpy.context.view_layer.update()


def _import(path: Path) -> None:
    suffix, name = path.suffix.lower(), str(path)
    if not path.stat().st_size:
        raise LoadError("it is empty")
    if suffix in _NEEDED and addon_utils.enable(_NEEDED[suffix], default_set=False) is None:
        raise LoadError(f"Blender's add-on '{_NEEDED[suffix]}' is missing, which reads {suffix} files")
    if suffix == ".svg":
        _check_svg(path)
        with _named_in_text(path) as alias:
            _operate(bpy.ops.import_curve.svg, filepath=str(alias))
    elif suffix == ".ply":
        _operate(bpy.ops.wm.ply_import, filepath=name, forward_axis="Y", up_axis="Z")
    elif suffix == ".obj":
        _operate(bpy.ops.wm.obj_import, filepath=name, forward_axis="Y", up_axis="Z", validate_meshes=True)
    elif suffix == ".stl":
        _operate(bpy.ops.wm.stl_import, filepath=name, forward_axis="Y", up_axis="Z", use_mesh_validate=True)
    else:
        _operate(bpy.ops.import_scene.gltf, filepath=name)


@contextlib.contextmanager
def _named_in_text(path: Path) -> Iterator[Path]:
    """Path of the file, or of a copy if its name is no text: the importer of SVG gives it to what it makes."""
    stem = path.stem.encode("utf-8", "replace").decode()
    if stem == path.stem:
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(shutil.copy(path, Path(folder, stem + path.suffix)))


def _operate(operator: object, **options: object) -> None:
    try:
        done = operator(**options)
    except RuntimeError as error:
        raise LoadError(said(error)) from error
    if done != {"FINISHED"}:
        raise LoadError("Blender's importer refused it; it is damaged, or no file of this kind")


def said(error: RuntimeError) -> str:
    """What an operator's error says: the last line, without where in Blender's code it was."""
    lines = [line.strip() for line in str(error).splitlines()]
    lines = [line for line in lines if line and not line.startswith(("Location:", "File ", "^", "~"))]
    return lines[-1].removeprefix("Error: ") if lines else "Blender does not say why"


def _check_svg(path: Path) -> None:
    """Refuse numbers that are not finite: Blender's importer takes the others as if they were not there."""

    def start(tag: str, attributes: dict[str, str]) -> None:
        for name, value in attributes.items():
            if name in _SHAPES and (bad := _BAD_NUMBER.search(value)):
                where = f"line {parser.CurrentLineNumber}: <{tag} {name}=...>"
                raise LoadError(f"{where} has '{bad.group()}', which is no finite number")

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    try:
        with path.open("rb") as file:
            parser.ParseFile(file)
    except expat.ExpatError as error:
        raise LoadError(f"it is no SVG: {error}") from error


def _chosen(types: set[str], pattern: str | None, what: str) -> tuple[list[bpy.types.Object], list[str]]:
    """Objects of these types that are visible and fit the pattern, by name, and which of them are hidden."""
    fitting = [ob for ob in bpy.context.view_layer.objects if ob.type in types]
    if pattern is not None:
        fitting = [ob for ob in fitting if fnmatchcase(ob.name, pattern)]
    fitting.sort(key=lambda ob: ob.name)
    visible = [ob for ob in fitting if ob.visible_get()]
    hidden = [ob.name for ob in fitting if not ob.visible_get()]
    named = f" named '{pattern}'" if pattern is not None else ""
    if not visible:
        raise LoadError(
            f"all {what}{named} are hidden; show one: '{hidden[0]}'" if hidden else f"it has no {what}{named}"
        )
    return visible, [f"{len(hidden)} hidden left out: '{hidden[0]}'"] if hidden else []
