# SPDX-License-Identifier: GPL-3.0-or-later
"""Areas of a mesh in Edit Mode: those that are selected or enclosed, and patches put in their place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..fill.editmesh import Added, EditMesh
from ..fill.patches import Regridded, Snapshot
from .carried import Carried, Places

_MEMBER = 0.5
"""Weight from which on a vertex belongs to a group."""


class AreaError(ValueError):
    """There is no area to mesh anew. The message says why and what to do."""


def areas(edited: EditMesh) -> list[list[int]]:
    """Faces of the selected areas; where no face is selected, of those that selected edges enclose.

    Raises
    ------
    AreaError
        If selected edges enclose nothing.
    """
    faces = [face for face in edited.bm.faces if face.select and not face.hide]
    if faces:
        return _components(faces, lambda edge: False)
    chosen = [edge for edge in edited.bm.edges if edge.select and not edge.hide]
    if not chosen:
        return []
    return _enclosed(chosen)


def named_areas(edited: EditMesh, name: str | None) -> list[list[int]]:
    """Faces of the areas of a name: connected faces whose vertices are all in this group, that have this material, or for
    which this attribute is not zero, those with different values apart. Without a name: connected faces of one material.
    """  # noqa: D205 (one sentence)
    bm = edited.bm
    if name is None:
        kinds = {face.index: face.material_index for face in bm.faces}
    else:
        kinds = {face.index: kind for face in bm.faces if (kind := _kind(edited, face, name))}
    faces = [face for face in bm.faces if face.index in kinds]

    def parts(edge: Any) -> bool:
        return len({kinds.get(face.index) for face in edge.link_faces}) > 1

    return _components(faces, parts)


def _kind(edited: EditMesh, face: Any, name: str) -> int:
    """A number above 0 if the face is meant by the name, the same for those that belong together."""
    bm, ob = edited.bm, edited.ob
    group = ob.vertex_groups.get(name)
    deform = bm.verts.layers.deform.active
    if group is not None and deform is not None:
        return int(all(vertex[deform].get(group.index, 0.0) >= _MEMBER for vertex in face.verts))
    slot = ob.material_slots.find(name)
    if slot >= 0:
        return int(face.material_index == slot)
    layers = bm.faces.layers
    layer = layers.bool.get(name) or layers.int.get(name)
    return int(face[layer]) if layer is not None else 0


def _components(faces: Sequence[Any], stops: Any) -> list[list[int]]:
    """Indices of the faces of each part that edges hold together, but those that stop; in order."""
    left = {face.index: face for face in faces}
    found = []
    while left:
        index, face = next(iter(left.items()))
        del left[index]
        part, waiting = [index], [face]
        while waiting:
            for edge in waiting.pop().edges:
                if stops(edge):
                    continue
                for other in edge.link_faces:
                    if left.pop(other.index, None) is not None:
                        part.append(other.index)
                        waiting.append(other)
        found.append(sorted(part))
    return found


def _enclosed(chosen: list[Any]) -> list[list[int]]:
    """Return the areas that selected edges part from the rest: all parts of a mesh that they meet but the largest."""
    walls = set(chosen)
    reached = {face.index: face for edge in chosen for face in edge.link_faces}
    whole: dict[int, Any] = {}
    waiting = list(reached.values())
    while waiting:
        face = waiting.pop()
        if whole.setdefault(face.index, face) is face:
            waiting += [
                other
                for edge in face.edges
                for other in edge.link_faces
                if other.index not in whole and not other.hide
            ]
    pieces = _components([whole[index] for index in sorted(whole)], lambda _: False)
    found = []
    for piece in pieces:
        parts = _components([whole[index] for index in piece], walls.__contains__)
        sizes = [sum(whole[index].calc_area() for index in part) for part in parts]
        largest = int(np.argmax(sizes))
        found += [part for at, part in enumerate(parts) if at != largest]
    if not found:
        raise AreaError("the selected edges enclose no area; select a closed loop of edges, or faces")
    return found


@dataclass(eq=False)
class Region:
    """An area and the patch that takes its place."""

    faces: list[int]
    triangles: np.ndarray
    """(t,) numbers of its triangles in the snapshot."""
    made: Regridded

    def places(self, at: Snapshot) -> Places:
        """Where the patch lies on the area."""
        number = np.full(len(at.triangles), -1)
        number[self.triangles] = np.arange(len(self.triangles))
        return Places(
            positions=at.positions,
            triangles=at.triangles[self.triangles],
            polygons=at.polygons[self.triangles],
            sources=number[self.made.source_faces],
            weights=self.made.source_weights,
            points=self.made.vertices,
            faces=[*self.made.quads.tolist(), *self.made.triangles.tolist()],
        )

    def poses(self, at: Snapshot, places: Places) -> list[np.ndarray]:
        """Positions (j, 3) of the new vertices in every shape key: as far beside the old surface as they are now."""
        beside = self.made.vertices - places.at_vertices(at.positions)
        return [places.at_vertices(pose) + beside for pose in at.poses]


def replace(edited: EditMesh, at: Snapshot, regions: Sequence[Region], added: Added) -> None:
    """Put the patches in the place of their areas, and write into `added` what was made."""
    bm = edited.bm
    jobs = []
    for region in regions:
        places = region.places(at)
        jobs.append((region, places, Carried(bm, places), [bm.faces[index] for index in region.faces]))
    verts, layers = list(bm.verts), bm.verts.layers.shape.values()
    for region, places, carried, old in jobs:
        edges = dict.fromkeys(edge for face in old for edge in face.edges)
        for face in old:
            bm.faces.remove(face)
        for edge in edges:
            if not edge.link_faces:
                bm.edges.remove(edge)
        new = []
        for place in (region.made.vertices @ at.to_local.T).tolist():
            new.append(bm.verts.new(place))
        for layer, pose in zip(layers, region.poses(at, places), strict=True):
            for vertex, place in zip(new, (pose @ at.to_local.T).tolist(), strict=True):
                vertex[layer] = place
        numbered = verts + new
        faces = [bm.faces.new([numbered[v] for v in face]) for face in places.faces]
        carried.write(new, faces)
        for face in faces:
            face.normal_update()
        for v in region.made.unused.tolist():
            bm.verts.remove(verts[v])
        added.faces += faces
