# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a divided mesh into BMeshes, with all that the mesh carries.

What the cut does not meet is not touched: its elements stay, with every layer of data that Blender has.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import bmesh
import numpy as np

from ..data import attributes
from .cutcorners import Corners
from .cutextension import Extension, connected, rims_of
from .cutsweep import CutError, Sweep, unrolled
from .cutting import WEIGHT, Model, Part

_FLOATS = ("float", "float_vector", "float_color", "color")


@dataclass(frozen=True, eq=False)
class Surface:
    """What is needed of the cut besides its parts."""

    model: Model
    stroke: np.ndarray
    sweep: Sweep
    to_local: np.ndarray
    """(3, 3), from the model's directions to the object's space."""
    base: np.ndarray
    """(n, 3) positions that the mesh itself has, in the model's directions."""
    poses: list[np.ndarray]
    """(n, 3) those of every shape key, in the model's directions."""
    sharp_rims: bool
    cap_slot: int | None
    """Material slot of caps; None for that of the faces around."""


@dataclass
class Written:
    """What came into a mesh."""

    made: list[Any] = field(default_factory=list)
    """Everything new, in the order in which it was made."""
    caps: list[Any] = field(default_factory=list)
    """New faces of caps."""


class Surgery:
    """A BMesh that becomes one or more parts of itself."""

    def __init__(self, bm: bmesh.types.BMesh, surface: Surface) -> None:
        self.bm, self.surface = bm, surface
        self.verts, self.faces = list(bm.verts), list(bm.faces)
        bm.verts.index_update()
        bm.faces.index_update()
        self.written = Written()
        self.stays: set[int] = set()

    def perform(self, parts: Sequence[Part]) -> Written:
        """Put the parts in, and take out what is in none. If anything fails the BMesh is as before."""
        face_set = attributes.new_face_set(self.bm)
        try:
            for part in parts:
                self._add(part, face_set)
        except BaseException:
            self._take_back()
            raise
        gone = [face for index, face in enumerate(self.faces) if index not in self.stays]
        bmesh.ops.delete(self.bm, geom=gone, context="FACES")
        return self.written

    def _take_back(self) -> None:
        for kind, elements in (
            (bmesh.types.BMFace, self.bm.faces),
            (bmesh.types.BMEdge, self.bm.edges),
            (bmesh.types.BMVert, self.bm.verts),
        ):
            for element in self.written.made:
                if isinstance(element, kind):
                    elements.remove(element)

    def _add(self, part: Part, face_set: Any) -> None:
        self.stays.update(part.kept.tolist())
        extension = Extension(part, self.surface.model.vertices[part.old])
        verts = [self.verts[index] for index in part.old.tolist()]
        verts += self._add_vertices(part, extension)
        self._add_edges(part, verts)
        corners = Corners(self.verts, self.faces, part, self.surface.model)
        made = self._add_faces(part, verts)
        caps = self._add_caps(part, verts, face_set)
        self.written.caps += caps
        self._write_corners(part, extension, corners, made, caps)
        if self.surface.sharp_rims:
            for a, b in rims_of(part.cap_triangles).tolist():
                edge = self.bm.edges.get((verts[a], verts[b]))
                if edge is not None:
                    edge.smooth = False

    def _add_faces(self, part: Part, verts: list[Any]) -> list[Any]:
        """Make the faces that were divided or rebuilt; None for those that are there already."""
        n_old, made = len(part.old), []
        for face, source in zip(part.faces, part.source_face, strict=True):
            ring = [verts[index] for index in face]
            model = self.faces[source]
            if max(face) < n_old:
                before = self.bm.faces.get(ring)
                if before is not None:
                    # The cut's neighbourhood was rebuilt, and this face is one that was there.
                    self.stays.add(before.index)
                    made.append(None)
                    continue
            self._add_missing_edges(face, ring, n_old)
            new = self.bm.faces.new(ring, model)
            new.hide = model.hide
            self.written.made.append(new)
            made.append(new)
        return made

    def _add_caps(self, part: Part, verts: list[Any], face_set: Any) -> list[Any]:
        n_old, caps = len(part.old), []
        models = _models(part, self.faces)
        slot = self.surface.cap_slot
        for face, model in zip(part.caps, models, strict=True):
            ring = [verts[index] for index in face]
            if sum(index < n_old for index in face) > 1:
                if max(face) < n_old and self.bm.faces.get(ring) is not None:
                    raise CutError("a cap would lie on a face of the mesh; move the stroke a little")
                self._add_missing_edges(face, ring, n_old)
            new = self.bm.faces.new(ring, model) if model is not None else self.bm.faces.new(ring)
            self.written.made.append(new)
            caps.append(new)
            if new.hide:
                new.hide = False
            if slot is not None:
                new.material_index = slot
            if face_set is not None:
                new[face_set[0]] = face_set[1]
        return caps

    def _add_missing_edges(self, face: list[int], ring: list[Any], n_old: int) -> None:
        """Make edges between old vertices, so that they can be taken back: they do not go with a new vertex."""
        for k, index in enumerate(face):
            if index < n_old and face[k - 1] < n_old:
                ends = (ring[k - 1], ring[k])
                if self.bm.edges.get(ends) is None:
                    self.written.made.append(self.bm.edges.new(ends))

    def _add_vertices(self, part: Part, extension: Extension) -> list[Any]:
        surface = self.surface
        nearest = part.sources[np.arange(len(part.sources)), part.weights.argmax(axis=1)]
        places = self._moved(part, extension, surface.base)
        poses = [self._moved(part, extension, pose) for pose in surface.poses]
        new = []
        for place, source in zip(places.tolist(), nearest.tolist(), strict=True):
            vertex = self.bm.verts.new(place, self.verts[source])
            vertex.hide = False
            self.written.made.append(vertex)
            new.append(vertex)
        for layer, pose in zip(self.bm.verts.layers.shape.values(), poses, strict=True):
            for vertex, place in zip(new, pose.tolist(), strict=True):
                vertex[layer] = place
        needed = [self.verts[index] for index in extension.needed.tolist()]
        rim = [self.verts[index] for index in part.old[extension.rim_old].tolist()]
        for layer in attributes.layers_of(self.bm.verts.layers, _FLOATS):
            values = extension(_values(needed, layer), _values(rim, layer))
            scalar = values.shape[1] == 1
            for vertex, value in zip(new, values.tolist(), strict=True):
                vertex[layer] = value[0] if scalar else value
        deform = self.bm.verts.layers.deform.active
        if deform is not None and new:
            groups = attributes.groups_of(needed, deform)
            values = extension(_weights(needed, deform, groups), _weights(rim, deform, groups))
            member = extension(_members(needed, deform, groups), _members(rim, deform, groups))
            for vertex, row, inside in zip(new, values.tolist(), member.tolist(), strict=True):
                weights = vertex[deform]
                weights.clear()
                for group, weight, share in zip(groups, row, inside, strict=True):
                    # In a group with a weight of nothing is still in the group, where all around are.
                    if weight > attributes.LEAST_WEIGHT or share > 1 - 1e-6:
                        weights[group] = min(max(weight, 0.0), 1.0)
        return new

    def _moved(self, part: Part, extension: Extension, pose: np.ndarray) -> np.ndarray:
        """Positions of the new vertices in another pose of the model, in the object's space."""
        surface = self.surface
        offset = pose - surface.model.vertices
        places = part.places
        if offset.any():
            rim = part.old[extension.rim_old]
            places = places + extension(offset[extension.needed], offset[rim])
        return places @ surface.to_local.T

    def _add_edges(self, part: Part, verts: list[Any]) -> None:
        """Make the edges that lie on old ones, as these are: sharp, seams, creased."""
        n_old, get = len(part.old), self.bm.edges.get
        old = part.old.tolist()
        support: dict[int, frozenset[int]] = {}

        def sources(index: int) -> frozenset[int]:
            found = support.get(index)
            if found is None:
                if index < n_old:
                    found = frozenset((old[index],))
                else:
                    pairs = zip(
                        part.sources[index - n_old].tolist(),
                        part.weights[index - n_old].tolist(),
                        strict=True,
                    )
                    found = frozenset(source for source, weight in pairs if weight > WEIGHT)
                support[index] = found
            return found

        done: set[tuple[int, int]] = set()
        for face in part.faces:
            for a, b in zip(face, [*face[1:], face[0]], strict=True):
                pair = (a, b) if a < b else (b, a)
                if pair in done or pair[1] < n_old:
                    continue
                done.add(pair)
                both = sources(a) | sources(b)
                if len(both) != 2:
                    continue
                one, other = both
                example = get((self.verts[one], self.verts[other]))
                if example is not None:
                    edge = self.bm.edges.new((verts[a], verts[b]), example)
                    edge.hide = False
                    self.written.made.append(edge)

    def _write_corners(
        self, part: Part, extension: Extension, corners: Corners, made: list[Any], caps: list[Any]
    ) -> None:
        """Give UVs, colours and whatever else corners have to the new faces."""
        layers = self.bm.loops.layers
        loops: list[Any] = []
        for face, ring in zip(made, part.faces, strict=True):
            loops += face.loops if face is not None else [None] * len(ring)
        written = np.array([loop is not None for loop in loops], bool)
        loops = [loop for loop in loops if loop is not None]
        cap_loops = [loop for face in caps for loop in face.loops]
        cap_corners = [index for face in part.caps for index in face]
        floats = [
            (layer, kind == "uv")
            for kind in ("uv", *_FLOATS)
            for layer in attributes.layers_of(layers, (kind,))
        ]
        for layer, is_uv in floats:
            values = corners.interpolated(layer, is_uv=is_uv)
            _write(loops, layer, values[written], is_uv=is_uv)
            if not cap_corners:
                continue
            if is_uv:
                cap = _in_unit_square(self._unrolled(part))
            else:
                cap = self._around(part, extension, corners, values, layer)
            _write(cap_loops, layer, cap[cap_corners], is_uv=is_uv)
        for layer in attributes.layers_of(layers, ("int", "bool", "string")):
            values = corners.nearest(layer)
            for loop, value in zip(loops, (values[at] for at in np.flatnonzero(written)), strict=True):
                loop[layer] = value

    def _unrolled(self, part: Part) -> np.ndarray:
        places = np.vstack([self.surface.model.vertices[part.old], part.places])
        inside = np.zeros(len(places), bool)
        inside[part.cap_triangles] = True
        flat = np.zeros((len(places), 2))
        flat[inside] = unrolled(places[inside], self.surface.stroke, self.surface.sweep)
        flat[inside] -= flat[inside].min(axis=0)
        return flat

    def _around(
        self, part: Part, extension: Extension, corners: Corners, values: np.ndarray, layer: Any
    ) -> np.ndarray:
        """Values for a cap's vertices: at its rim the mean of the corners there, harmonic inside."""
        n_old, n = len(part.old), len(part.old) + len(part.places)
        total, count = np.zeros((n, values.shape[1])), np.zeros((n, 1))
        np.add.at(total, corners.vertex, values)
        np.add.at(count, corners.vertex, 1.0)
        for index in extension.rim_old.tolist():
            if not count[index]:
                for loop in self.verts[part.old[index]].link_loops:
                    total[index] += np.atleast_1d(loop[layer])
                    count[index] += 1
        known = total / np.maximum(count, 1.0)
        known[n_old:] = extension.of_new(known[n_old:], known[extension.rim_old])
        return known


def _models(part: Part, faces: list[Any]) -> list[Any]:
    """For each face of the caps, a face of the model with the material and smoothness of most around that cap."""
    if not part.caps:
        return []
    n = len(part.old) + len(part.places)
    in_cap = np.zeros(n, bool)
    in_cap[part.cap_triangles] = True
    cap_of = np.where(in_cap, connected(part.cap_triangles, n), -1).tolist()
    around: dict[int, list[Any]] = {}
    for face, source in zip(part.faces, part.source_face, strict=True):
        for cap in {cap_of[index] for index in face}:
            if cap >= 0:
                around.setdefault(cap, []).append(faces[source])
    chosen = {cap: attributes.model_face(found) for cap, found in around.items()}
    default = attributes.model_face([faces[index] for index in part.kept[:1].tolist()])
    return [chosen.get(cap_of[index], default) for index, *_ in part.caps]


def _in_unit_square(points: np.ndarray) -> np.ndarray:
    return points / max(float(points.max(initial=0.0)), 1e-300)


def _values(elements: Sequence[Any], layer: Any) -> np.ndarray:
    if not elements:
        return np.zeros((0, 1))
    return np.array([np.atleast_1d(element[layer]) for element in elements], float)


def _weights(vertices: Sequence[Any], layer: Any, groups: Sequence[int]) -> np.ndarray:
    table = [[vertex[layer].get(group, 0.0) for group in groups] for vertex in vertices]
    return np.array(table, float).reshape(len(vertices), len(groups))


def _members(vertices: Sequence[Any], layer: Any, groups: Sequence[int]) -> np.ndarray:
    table = [[float(group in vertex[layer]) for group in groups] for vertex in vertices]
    return np.array(table, float).reshape(len(vertices), len(groups))


def _write(loops: Sequence[Any], layer: Any, values: np.ndarray, *, is_uv: bool) -> None:
    rows = values.tolist()
    if is_uv:
        for loop, row in zip(loops, rows, strict=True):
            loop[layer].uv = row
    elif values.shape[1] == 1:
        for loop, (value,) in zip(loops, rows, strict=True):
            loop[layer] = value
    else:
        for loop, row in zip(loops, rows, strict=True):
            loop[layer] = row
