# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of all parts together becomes the joined one: what is not in it goes, collars come.

Faces outside the collars stay, with every layer of data that Blender has. Collars carry on what is around them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bmesh
import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..data import attributes
from ..native import native
from .uniting import United

_PART, _NUMBER = "gridmesh_{}_part", "gridmesh_{}_number"
"""Names of attributes that tell of which part an element is, and its number there."""

_SHARP = np.radians(30.0)
"""Edges of a crease that turn by more are marked sharp."""


def number(mesh: bpy.types.Mesh, part: int) -> None:
    """Let the elements of a part know where they come from."""
    for domain, n in (("POINT", len(mesh.vertices)), ("FACE", len(mesh.polygons))):
        for name, values in ((_PART, np.full(n, part)), (_NUMBER, np.arange(n))):
            attribute = mesh.attributes.new(name.format(domain.lower()), "INT", domain)
            attribute.data.foreach_set("value", values.astype(np.int32))


def perform(bm: Any, made: United, places: np.ndarray, *, mirrored: bool, crease: bool) -> None:
    """Make the BMesh of all parts (see `number`) the joined one.

    places : (v, 3) vertices of the result in the BMesh's space. mirrored : that is a mirror image of the space of `made`. crease :
    mark edges of collars that turn sharply.
    """
    vertices, faces = _by_source(bm.verts, "point"), _by_source(bm.faces, "face")
    old = [vertices[source] for source in _pairs(made.vertex_part, made.source_vertex) if source[0] >= 0]
    stays = [faces[source] for source in _pairs(made.face_part, made.source_face)]
    _take_apart(bm, made.apart.tolist(), stays, old)
    kept = set(stays)
    gone = [face for face in bm.faces if face not in kept]
    materials = _Materials(bm, gone)
    smooth = 2 * sum(face.smooth for face in bm.faces) > len(bm.faces)
    bmesh.ops.delete(bm, geom=gone, context="FACES")
    made_faces = _Collars(bm, made, old, places).make(materials, smooth=smooth, mirrored=mirrored)
    if crease:
        for edge in dict.fromkeys(edge for face in made_faces for edge in face.edges):
            if edge.is_manifold and edge.calc_face_angle() > _SHARP:
                edge.smooth = False
    for elements, domain in ((bm.verts, "point"), (bm.faces, "face")):
        for name in (_PART, _NUMBER):
            elements.layers.int.remove(elements.layers.int[name.format(domain)])
    for face in bm.faces:
        face.normal_update()


def _take_apart(bm: Any, apart: list[list[int]], faces: list[Any], vertices: list[Any]) -> None:
    """Put faces with vertices of their own in place of those that share them. apart : see `United`."""
    indices = {index for _, index in apart}
    own = {index: bm.verts.new(vertices[index].co, vertices[index]) for index in sorted(indices)}
    changes: dict[int, dict[Any, Any]] = {}
    for face, index in apart:
        changes.setdefault(face, {})[vertices[index]] = own[index]
    for face, change in changes.items():
        loops = list(faces[face].loops)
        faces[face] = bm.faces.new([change.get(loop.vert, loop.vert) for loop in loops], faces[face])
        for new, loop in zip(list(faces[face].loops), loops, strict=True):
            # What is copied to is no longer known to Python.
            if new.edge != loop.edge:
                new.edge.copy_from(loop.edge)
            new.copy_from(loop)
    for index, vertex in own.items():
        vertices[index] = vertex


def _pairs(parts: np.ndarray, numbers: np.ndarray) -> list[tuple[int, int]]:
    return list(zip(parts.tolist(), numbers.tolist(), strict=True))


def _by_source(elements: Any, domain: str) -> dict[tuple[int, int], Any]:
    """Elements by the part that they come from, and their number there."""
    part, index = (elements.layers.int[name.format(domain)] for name in (_PART, _NUMBER))
    return {(element[part], element[index]): element for element in elements}


class _Collars:
    """The new faces, and what they carry on."""

    def __init__(self, bm: Any, made: United, old: list[Any], places: np.ndarray) -> None:
        self.bm, self.made, self.old, self.places = bm, made, old, places
        self.loops = [[old[index] for index in rim.tolist()] for rim in made.rims]
        self.rim = np.concatenate([np.zeros(0, np.int64), *made.rims]).astype(np.int64)
        self.free = np.arange(len(old), len(made.vertices))
        self.used, triangles = np.unique(made.collars, return_inverse=True)
        self.triangles = triangles.reshape(-1, 3).astype(np.int32)

    def make(self, materials: _Materials, *, smooth: bool, mirrored: bool) -> list[Any]:
        """Make them. smooth : how they are shaded where nothing is around."""
        bm = self.bm
        around = attributes.Surroundings(bm, *self.loops) if self.loops else None
        example = attributes.model_face(around.faces) if around is not None else None
        slots = materials.of(self.made.collars, self.made.collar_part, self.places)
        new = [bm.verts.new(place) for place in self.places[self.free].tolist()]
        self._write_poses(new)
        face_set = attributes.new_face_set(bm)
        ring = self.old + new
        faces = []
        for triangle, slot in zip(self.made.collars.tolist(), slots, strict=True):
            corners = [ring[index] for index in (reversed(triangle) if mirrored else triangle)]
            face = bm.faces.new(corners, example) if example is not None else bm.faces.new(corners)
            face.material_index, face.hide = slot, False
            if example is None:
                face.smooth = smooth
            if face_set is not None:
                face[face_set[0]] = face_set[1]
            face.normal_update()
            faces.append(face)
        if around is not None:
            around.write(new, faces, self._extend)
        return faces

    def _extend(self, values: np.ndarray) -> np.ndarray:
        """From values at the rims' vertices (k, c) to values at the new ones (j, c)."""
        everywhere = np.tile(values.mean(axis=0), (len(self.made.vertices), 1))
        everywhere[self.rim] = values
        free = np.searchsorted(self.used, self.free).astype(np.int32)
        points = self.made.vertices[self.used]
        return native("harmonic").harmonic(points, self.triangles, free, everywhere[self.used])[free]

    def _write_poses(self, new: Sequence[Any]) -> None:
        """New vertices in every shape key: moved as those around are."""
        layers = self.bm.verts.layers.shape.values()
        if not layers or not new:
            return
        rim = [vertex for loop in self.loops for vertex in loop]
        if not rim:
            for layer in layers:
                for vertex in new:
                    vertex[layer] = vertex.co
            return
        moves = np.array([[vertex[layer] - vertex.co for layer in layers] for vertex in rim], float)
        moves = self._extend(moves.reshape(len(rim), -1)).reshape(len(new), len(layers), 3)
        for vertex, own in zip(new, moves.tolist(), strict=True):
            for layer, move in zip(layers, own, strict=True):
                vertex[layer] = [a + b for a, b in zip(vertex.co, move, strict=True)]


class _Materials:
    """Material slots of the faces that go, and so of what comes in their place."""

    def __init__(self, bm: Any, gone: Sequence[Any]) -> None:
        slots = {face.material_index for face in bm.faces}
        self.only = next(iter(slots)) if len(slots) == 1 or not gone else None
        self._of_part: dict[int, tuple[BVHTree, list[int]]] = {}
        if self.only is None:
            outer = _outside(bm, gone) or gone
            layer = bm.faces.layers.int[_PART.format("face")]
            parts: dict[int, list[Any]] = {}
            for face in outer:
                parts.setdefault(face[layer], []).append(face)
            self._all = _with_slots(outer)
            self._of_part = {part: _with_slots(own) for part, own in parts.items()}

    def of(self, triangles: np.ndarray, parts: np.ndarray, places: np.ndarray) -> list[int]:
        """Slots of new triangles (t, 3), each of the part `parts[t]` if that is known: that of the nearest face of this part."""
        if self.only is not None:
            return [self.only] * len(triangles)
        middles = places[triangles].mean(axis=1).tolist()
        return [self._nearest(part, middle) for part, middle in zip(parts.tolist(), middles, strict=True)]

    def _nearest(self, part: int, middle: list[float]) -> int:
        tree, slots = self._of_part.get(part, self._all)
        return slots[tree.find_nearest(middle)[2]]


def _with_slots(faces: Sequence[Any]) -> tuple[BVHTree, list[int]]:
    """Faces to be searched, and their material slots."""
    return _tree_of(faces), [face.material_index for face in faces]


def _outside(bm: Any, faces: Sequence[Any]) -> list[Any]:
    """Those of some faces whose middle is in no other part than their own."""
    layer = bm.faces.layers.int[_PART.format("face")]
    parts: dict[int, list[Any]] = {}
    for face in bm.faces:
        parts.setdefault(face[layer], []).append(face)
    solids = []
    for part, own in parts.items():
        points = np.array([vertex.co for face in own for vertex in face.verts])
        solids.append((part, points.min(axis=0), points.max(axis=0), _tree_of(own)))
    middles = np.array([face.calc_center_median() for face in faces])
    of_part = np.array([face[layer] for face in faces])
    outer = np.ones(len(faces), bool)
    for part, low, high, tree in solids:
        near = outer & (of_part != part) & ((middles >= low) & (middles <= high)).all(axis=1)
        for at in np.flatnonzero(near).tolist():
            middle = Vector(middles[at])
            place, normal, _, _ = tree.find_nearest(middle)
            outer[at] = (middle - place).dot(normal) > 0
    return [faces[at] for at in np.flatnonzero(outer).tolist()]


def _tree_of(faces: Sequence[Any]) -> BVHTree:
    verts: dict[Any, int] = {}
    rings = [[verts.setdefault(vertex, len(verts)) for vertex in face.verts] for face in faces]
    return BVHTree.FromPolygons([vertex.co.copy() for vertex in verts], rings)
