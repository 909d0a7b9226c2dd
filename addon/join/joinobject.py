# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects to be joined: their meshes as arrays, and the joined mesh put into the first of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np
from mathutils import Matrix

from ..data import frames
from ..data.placing import Transaction
from ..live import engine
from . import joinmesh
from .uniting import JoinError, Part, United, reversed_faces, volume

_FLAT = 1e-9
"""An object scaled to less than this part of its largest scale along some direction has no thickness there."""


@dataclass(frozen=True, eq=False)
class Source:
    """An object that is a part, and a copy of its mesh in the space of the first one, wound outward."""

    ob: bpy.types.Object
    mesh: bpy.types.Mesh
    was_inside_out: bool


class Target:
    """Objects that become one. The first gives its place, its modifiers and its name."""

    def __init__(
        self,
        objects: Sequence[bpy.types.Object],
        transaction: Transaction,
        place: Matrix | None = None,
        placed: Sequence[Matrix] | None = None,
    ) -> None:
        """Read them. Meshes are taken as they are without modifiers and shape keys, as Blender's own Join does.

        place : where the whole is in the world, unless where the first object is. placed : where each is taken to be.

        Raises
        ------
        JoinError
            If one cannot be worked on.
        """
        for ob in objects:
            _require_usable(ob)
        self.objects = list(objects)
        place = objects[0].matrix_world if place is None else place
        placed = [ob.matrix_world for ob in objects] if placed is None else placed
        self.world = np.array(place, float)
        self._mirrored = np.linalg.det(self.world[:3, :3]) < 0
        to_whole = place.inverted()
        self.sources = [
            self._source(ob, to_whole @ matrix, transaction)
            for ob, matrix in zip(objects, placed, strict=True)
        ]
        self.parts = [self._part(source) for source in self.sources]

    @property
    def live(self) -> list[str]:
        """Names of those that follow a drawing."""
        return [ob.name for ob in self.objects if frames.is_linked(ob)]

    @property
    def colors(self) -> list[int]:
        """A number for each part, the same for parts that are of one and the same material alone."""
        found: dict[object, int] = {}
        each = [_materials(source.mesh) for source in self.sources]
        return [
            found.setdefault(own[0] if len(own) == 1 else ("several", number), len(found))
            for number, own in enumerate(each)
        ]

    def _source(self, ob: bpy.types.Object, matrix: Matrix, transaction: Transaction) -> Source:
        mesh = transaction.remember(bpy.data.meshes, ob.data.copy())
        for slot_index, slot in enumerate(ob.material_slots):
            if slot.link == "OBJECT":
                mesh.materials[slot_index] = slot.material
        inside_out = _volume(mesh) < 0
        mesh.transform(matrix, shape_keys=True)
        if _volume(mesh) < 0:
            mesh.flip_normals()
        return Source(ob, mesh, inside_out)

    def _part(self, source: Source) -> Part:
        points, corners, offsets = _arrays(source.mesh)
        if self._mirrored:
            corners = reversed_faces(corners, offsets)
        return Part(source.ob.name, frames.moved(points, self.world), corners, offsets)

    def apply(
        self, context: bpy.types.Context, made: United, transaction: Transaction, *, crease: bool, keep: bool
    ) -> bpy.types.Object:
        """Put the joined mesh into the first object, and take the others away; return the object.

        crease : edges of the collars that turn sharply are marked sharp. keep : all stay as they are, hidden, and a new object
        like the first one gets the mesh. Everything that can fail happens before any of them is changed.
        """
        with engine.resting():
            mesh = self._united(context, made, crease=crease)
            self._use_up()
            if keep:
                ob = self._beside(context, mesh, transaction)
            else:
                ob = self.objects[0]
                ob.property_unset("gridmesh_joined")
                _give(ob, mesh)
                for other in self.objects[1:]:
                    _take_away(other, ob)
            for other in filter(None, list(context.view_layer.objects.selected)):
                other.select_set(False)
            ob.select_set(True)
            context.view_layer.objects.active = ob
        return ob

    def replace(
        self, context: bpy.types.Context, made: United, ob: bpy.types.Object, *, crease: bool
    ) -> None:
        """Make the joined mesh that of an object which is none of them."""
        with engine.resting():
            mesh = self._united(context, made, crease=crease)
            self._use_up()
            if mesh.shape_keys is not None or ob.data.shape_keys is not None:
                _give(ob, mesh)
            else:
                _rewrite(ob, mesh)

    def _use_up(self) -> None:
        """Remove the copies that are in the joined mesh, which is the first of them."""
        for source in self.sources[1:]:
            bpy.data.meshes.remove(source.mesh)

    def _united(self, context: bpy.types.Context, made: United, *, crease: bool) -> bpy.types.Mesh:
        """Mesh of the result, in the space of the first object."""
        mesh = _together(context, [source.mesh for source in self.sources])
        local = frames.moved(made.vertices, np.linalg.inv(self.world))
        bm = bmesh.new(use_operators=True)
        try:
            bm.from_mesh(mesh, face_normals=False, vertex_normals=False)
            joinmesh.perform(bm, made, local, mirrored=self._mirrored, crease=crease)
            bm.to_mesh(mesh)
        finally:
            bm.free()
        mesh.update()
        return mesh

    def _beside(
        self, context: bpy.types.Context, mesh: bpy.types.Mesh, transaction: Transaction
    ) -> bpy.types.Object:
        """Make an object like the first one of the mesh; the parts stay, hidden."""
        first = self.objects[0]
        ob = transaction.remember(bpy.data.objects, beside(first, mesh))
        for part in self.objects:
            part.hide_set(True)
            part.hide_render = True
        space = context.space_data
        if space is not None and space.type == "VIEW_3D" and space.local_view is not None:
            ob.local_view_set(space, True)
        return ob


def _require_usable(ob: bpy.types.Object) -> None:
    if not ob.is_editable or not ob.data.is_editable:
        raise JoinError(f"'{ob.name}' is linked from another file; make it local first")
    if ob.data.is_editmode:
        raise JoinError(f"the mesh of '{ob.name}' is being edited; leave Edit Mode first")
    if not len(ob.data.polygons):
        raise JoinError(f"'{ob.name}' has no faces to join")
    linear = np.array(ob.matrix_world.to_3x3(), float)
    widths = np.linalg.svd(linear, compute_uv=False) if np.isfinite(linear).all() else np.zeros(3)
    if widths[-1] <= _FLAT * widths[0] or widths[0] == 0:
        raise JoinError(f"'{ob.name}' has no thickness, since a scale of it is zero; set its scale")


def _arrays(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (n, 3), corners and offsets."""
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    corners, offsets = np.empty(len(mesh.loops), np.int32), np.empty(len(mesh.polygons) + 1, np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_start", offsets[:-1])
    offsets[-1] = len(corners)
    return points.reshape(-1, 3).astype(float), corners, offsets


def _materials(mesh: bpy.types.Mesh) -> list[bpy.types.Material | None]:
    """Materials that its faces have."""
    slots = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", slots)
    return [mesh.materials[k] if k < len(mesh.materials) else None for k in np.unique(slots).tolist()]


def _volume(mesh: bpy.types.Mesh) -> float:
    points, corners, offsets = _arrays(mesh)
    return volume(points - points.mean(axis=0), corners, offsets)


def _together(context: bpy.types.Context, meshes: Sequence[bpy.types.Mesh]) -> bpy.types.Mesh:
    """Join meshes by Blender's own operator, which merges all that they carry; their elements tell where they come from.

    The first mesh becomes the result; the others are used up.
    """
    collection = context.scene.collection
    made: list[bpy.types.Object] = []
    try:
        for number, mesh in enumerate(meshes):
            joinmesh.number(mesh, number)
            ob = bpy.data.objects.new(mesh.name, mesh)
            made.append(ob)
            collection.objects.link(ob)
        if len(made) > 1:
            with context.temp_override(
                active_object=made[0],
                object=made[0],
                selected_objects=made,
                selected_editable_objects=made,
            ):
                bpy.ops.object.join()
        joined = made[0].data
    finally:
        for ob in made:
            if _is_there(ob):
                bpy.data.objects.remove(ob)
    return joined


def _is_there(ob: bpy.types.Object) -> bool:
    try:
        return bool(ob.name)
    except ReferenceError:  # the operator has removed it
        return False


def beside(first: bpy.types.Object, mesh: bpy.types.Mesh) -> bpy.types.Object:
    """Make an object like another one, where that is, with another mesh; it follows nothing."""
    ob = first.copy()
    ob.property_unset("gridmesh_joined")
    ob.property_unset("gridmesh_part")
    _give(ob, mesh)
    for collection in first.users_collection:
        collection.objects.link(ob)
    return ob


def _give(ob: bpy.types.Object, mesh: bpy.types.Mesh) -> None:
    """Make a mesh that of an object, which is a plain one from then on."""
    before, name = ob.data, ob.data.name
    ob.data = mesh
    engine.freeze(ob)
    for slot in ob.material_slots:
        slot.link = "DATA"
    if not before.users:
        bpy.data.meshes.remove(before)
        mesh.name = name


def _rewrite(ob: bpy.types.Object, mesh: bpy.types.Mesh) -> None:
    """Give the mesh of an object the contents of another one, which is removed.

    Not the other mesh itself: between two undo steps that would leave the object with a mesh that is freed.
    """
    own = ob.data
    holder = bpy.data.objects.new(mesh.name, mesh)
    groups = [group.name for group in holder.vertex_groups]
    bpy.data.objects.remove(holder)
    own.clear_geometry()
    ob.vertex_groups.clear()
    own.materials.clear()
    for material in mesh.materials:
        own.materials.append(material)
    for name in groups:
        ob.vertex_groups.new(name=name)
    bm = bmesh.new(use_operators=False)
    try:
        bm.from_mesh(mesh, face_normals=False, vertex_normals=False)
        bm.to_mesh(own)
    finally:
        bm.free()
    for name in ("active_color_index", "render_color_index"):
        at = getattr(mesh.color_attributes, name)
        if at >= 0:
            setattr(own.color_attributes, name, at)
    for slot in ob.material_slots:
        slot.link = "DATA"
    own.update()
    bpy.data.meshes.remove(mesh)


def _take_away(ob: bpy.types.Object, into: bpy.types.Object) -> None:
    """Remove an object that became a part; what hung on it hangs on the whole, where it is."""
    engine.freeze(ob)
    for child in list(ob.children):
        place = child.matrix_world.copy()
        child.parent, child.parent_type = into, "OBJECT"
        child.matrix_world = place
    mesh = ob.data
    bpy.data.objects.remove(ob)
    if not mesh.users:
        bpy.data.meshes.remove(mesh)
