# SPDX-License-Identifier: GPL-3.0-or-later
"""The object to be cut: its mesh as arrays, and the parts put back, as one object or two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import bmesh
import bpy
import numpy as np

from ..bodies.outlines import LARGEST
from ..data import frames
from ..data.meshes import Transaction
from ..data.mirrors import mirror_planes
from ..live import engine
from .cutmesh import Surface, Surgery, Written
from .cutsweep import CutError, Sweep, checked
from .cutting import Model, Part

_FLAT = 1e-9
"""An object scaled to less than this part of its largest scale along some direction has no thickness there."""


@dataclass(frozen=True, eq=False)
class Caps:
    """What caps look like."""

    sharp_rims: bool
    own_slot: bool
    material: bpy.types.Material | None


class Target:
    """A mesh object in Object Mode or Edit Mode."""

    def __init__(self, ob: bpy.types.Object) -> None:
        """Read it. Positions are in the world's directions, about the object's origin.

        Raises
        ------
        CutError
            If it cannot be worked on.
        """
        self.ob, self.mesh = ob, ob.data
        self.editing = ob.mode == "EDIT"
        if not ob.is_editable or not self.mesh.is_editable:
            raise CutError(f"'{ob.name}' is linked from another file; make it local first")
        if not self.editing and self.mesh.is_editmode:
            raise CutError(
                f"the mesh of '{ob.name}' is being edited in another object; leave Edit Mode first"
            )
        linear = np.array(ob.matrix_world.to_3x3(), float)
        widths = np.linalg.svd(linear, compute_uv=False) if np.isfinite(linear).all() else np.zeros(3)
        if widths[-1] <= _FLAT * widths[0] or widths[0] == 0:
            raise CutError(f"'{ob.name}' has no thickness, since a scale of it is zero; set its scale")
        if self.editing:
            ob.update_from_editmode()
        mesh = self.mesh
        if not len(mesh.polygons):
            raise CutError(f"'{ob.name}' has no faces to cut")
        self.origin = np.array(ob.matrix_world.translation, float)
        self._to_local = np.linalg.inv(linear)
        keys = list(mesh.shape_keys.key_blocks) if mesh.shape_keys is not None else []
        poses = [_positions(key.data) for key in keys]
        own = poses[ob.active_shape_key_index] if keys and self.editing else _positions(mesh.vertices)
        shown = own if self.editing or not keys else _seen(ob, own, poses)
        corners, offsets = np.empty(len(mesh.loops), np.int32), np.empty(len(mesh.polygons) + 1, np.int32)
        mesh.loops.foreach_get("vertex_index", corners)
        mesh.polygons.foreach_get("loop_start", offsets[:-1])
        offsets[-1] = len(corners)
        mirrors, within = mirror_planes(ob)
        self.model = Model(shown @ linear.T, corners, offsets, mirrors, within)
        self._base, self._poses = own @ linear.T, [pose @ linear.T for pose in poses]
        self._check()

    @property
    def is_live(self) -> bool:
        """Whether it follows a drawing; a cut ends that."""
        return frames.is_linked(self.ob)

    def line(
        self, points: np.ndarray, sweep: Sweep, *, cyclic: bool, close_gaps: float
    ) -> tuple[np.ndarray, Sweep]:
        """Stroke and sweep about the object's origin, of those in the world."""
        own = sweep if sweep.eye is None else Sweep(sweep.direction, sweep.eye - self.origin)
        return checked(points - self.origin, cyclic=cyclic, sweep=own, close_gaps=close_gaps), own

    def _check(self) -> None:
        for points in (self.model.vertices, *self._poses):
            bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
            if len(bad):
                raise CutError(
                    f"vertex {bad[0]} of '{self.ob.name}' has a coordinate that is not a finite number; "
                    "move or delete it"
                )
            if np.abs(points).max(initial=0.0) > LARGEST:
                raise CutError(f"'{self.ob.name}' reaches farther than {LARGEST:g}; scale it down")

    def apply(
        self,
        context: bpy.types.Context,
        parts: Sequence[Part],
        stroke: np.ndarray,
        sweep: Sweep,
        caps: Caps,
        *,
        together: bool,
    ) -> list[bpy.types.Object]:
        """Make the object what is in the first part (or in all, if together), and new objects of the others.

        Everything that can fail happens before the object itself is changed. Returns the objects.
        """
        if self.is_live:
            # What its drawing would make of it is another mesh.
            engine.freeze(self.ob)
            self.mesh = self.ob.data
        slot = _cap_slot(self.mesh, caps) if caps.own_slot else None
        smooth = caps.sharp_rims and _any_smooth(self.mesh)
        surface = Surface(
            self.model,
            stroke,
            sweep,
            self._to_local,
            self._base,
            self._poses,
            sharp_rims=smooth,
            cap_slot=slot,
        )
        with Transaction() as transaction:
            others = [] if together else [self._other(part, surface, transaction) for part in parts[1:]]
            mine = parts if together else parts[:1]
            if self.editing:
                bm = bmesh.from_edit_mesh(self.mesh)
                written = Surgery(bm, surface).perform(mine)
                _select(bm, written, self.mesh)
                bm.select_flush_mode()
                bm.normal_update()
                bmesh.update_edit_mesh(self.mesh, loop_triangles=True, destructive=True)
            else:
                _operate(self.mesh, surface, mine)
        for ob in (self.ob, *others):
            if slot is not None:
                _fill_slots(ob.data, slot, caps.material)
        for ob in others:
            for collection in self.ob.users_collection:
                collection.objects.link(ob)
            ob.select_set(True)
        space = context.space_data
        if space is not None and space.type == "VIEW_3D" and space.local_view is not None:
            for ob in others:
                ob.local_view_set(space, True)
        return [self.ob, *others]

    def _other(self, part: Part, surface: Surface, transaction: Transaction) -> bpy.types.Object:
        """Make an object like this one of a part."""
        mesh = self.mesh.copy()
        transaction.remember(bpy.data.meshes, mesh)
        _operate(mesh, surface, [part])
        ob = self.ob.copy()
        transaction.remember(bpy.data.objects, ob)
        ob.data = mesh
        return ob


def sharing(cut: Sequence[bpy.types.Object], chosen: Sequence[bpy.types.Object]) -> list[str]:
    """Names of objects that change because they have the mesh of one that is cut, and were not chosen."""
    meshes = {ob.data for ob in cut}
    return [ob.name for ob in bpy.data.objects if ob.data in meshes and ob not in chosen]


def _operate(mesh: bpy.types.Mesh, surface: Surface, parts: Sequence[Part]) -> None:
    bm = bmesh.new(use_operators=True)
    try:
        bm.from_mesh(mesh, face_normals=False, vertex_normals=False)
        written = Surgery(bm, surface).perform(parts)
        _select(bm, written, mesh)
        bm.to_mesh(mesh)
    finally:
        bm.free()
    mesh.update()


def _select(bm: bmesh.types.BMesh, written: Written, before: bpy.types.Mesh) -> None:
    """Select the caps and nothing else."""
    for elements, domain in ((bm.faces, "poly"), (bm.edges, "edge"), (bm.verts, "vert")):
        if f".select_{domain}" in before.attributes:  # absent where nothing is selected
            for element in elements:
                element.select = False
    bm.select_history.clear()
    for face in written.caps:
        face.select_set(True)


def _seen(ob: bpy.types.Object, base: np.ndarray, poses: list[np.ndarray]) -> np.ndarray:
    """Positions as the shape keys mix them in Object Mode."""
    shape = ob.data.shape_keys
    keys = shape.key_blocks
    if ob.show_only_shape_key:
        return poses[ob.active_shape_key_index]
    if not shape.use_relative:
        return base
    number = {key.name: at for at, key in enumerate(keys)}
    mixed = poses[0].copy()
    for key, pose in zip(keys, poses, strict=True):
        if key.mute or key.value == 0.0:
            continue
        change = key.value * (pose - poses[number[key.relative_key.name]])
        group = ob.vertex_groups.get(key.vertex_group) if key.vertex_group else None
        if group is not None:
            change *= _group_weights(ob.data, group.index)[:, None]
        mixed += change
    return mixed


def _group_weights(mesh: bpy.types.Mesh, index: int) -> np.ndarray:
    weights = np.zeros(len(mesh.vertices))
    for vertex in mesh.vertices:
        for element in vertex.groups:
            if element.group == index:
                weights[vertex.index] = element.weight
    return weights


def _positions(collection: Any) -> np.ndarray:
    points = np.empty(len(collection) * 3, np.float32)
    collection.foreach_get("co", points)
    return points.reshape(-1, 3).astype(float)


def _any_smooth(mesh: bpy.types.Mesh) -> bool:
    smooth = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    return bool(smooth.any())


def _cap_slot(mesh: bpy.types.Mesh, caps: Caps) -> int:
    """Return the number of the material slot for caps; it may have to be made by `_fill_slots`."""
    slots = list(mesh.materials)
    if caps.material is not None and caps.material in slots[1:]:
        return slots.index(caps.material, 1)
    if caps.material is None and len(slots) > 1 and slots[-1] is None:
        return len(slots) - 1
    return max(len(slots), 1)


def _fill_slots(mesh: bpy.types.Mesh, slot: int, material: bpy.types.Material | None) -> None:
    while len(mesh.materials) < slot:
        mesh.materials.append(None)
    if len(mesh.materials) == slot:
        mesh.materials.append(material)
