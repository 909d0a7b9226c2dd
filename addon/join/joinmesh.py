# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of all parts together becomes the joined one: what is not in it goes, collars come.

Faces outside the collars stay, with every layer of data that Blender has. Collars carry on what is around them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import bmesh
import bpy
import numpy as np

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
    kept = {faces[source] for source in _pairs(made.face_part, made.source_face)}
    old = [vertices[source] for source in _pairs(made.vertex_part, made.source_vertex) if source[0] >= 0]
    look = Counter((face.material_index, face.smooth) for face in bm.faces).most_common(1)[0][0]
    bmesh.ops.delete(bm, geom=[face for face in bm.faces if face not in kept], context="FACES")
    made_faces = _Collars(bm, made, old, places).make(look, mirrored=mirrored)
    if crease:
        for edge in dict.fromkeys(edge for face in made_faces for edge in face.edges):
            if edge.is_manifold and edge.calc_face_angle() > _SHARP:
                edge.smooth = False
    for elements, domain in ((bm.verts, "point"), (bm.faces, "face")):
        for name in (_PART, _NUMBER):
            elements.layers.int.remove(elements.layers.int[name.format(domain)])
    for face in bm.faces:
        face.normal_update()


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

    def make(self, look: tuple[int, bool], *, mirrored: bool) -> list[Any]:
        """Make them. look : material and smoothness where nothing is around."""
        bm = self.bm
        around = attributes.Surroundings(bm, *self.loops) if self.loops else None
        examples = self._examples()
        new = [bm.verts.new(place) for place in self.places[self.free].tolist()]
        self._write_poses(new)
        face_set = attributes.new_face_set(bm)
        ring = self.old + new
        faces = []
        for triangle, example in zip(self.made.collars.tolist(), examples, strict=True):
            corners = [ring[index] for index in (reversed(triangle) if mirrored else triangle)]
            face = bm.faces.new(corners, example) if example is not None else bm.faces.new(corners)
            if example is None:
                face.material_index, face.smooth = look
            if face_set is not None:
                face[face_set[0]] = face_set[1]
            face.hide = False
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

    def _examples(self) -> list[Any]:
        """For each new face one with the material of what is nearest around it; None where nothing is."""
        beside = [list(vertex.link_faces) for loop in self.loops for vertex in loop]
        by_material: dict[int, dict[Any, None]] = {}
        for faces in beside:
            for face in faces:
                by_material.setdefault(face.material_index, {})[face] = None
        models = [attributes.model_face(list(faces)) for faces in by_material.values()]
        if len(models) < 2 or not len(self.free):
            return [models[0] if models else None] * len(self.made.collars)
        column = {material: at for at, material in enumerate(by_material)}
        shares = np.zeros((len(beside), len(models)))
        for row, faces in zip(shares, beside, strict=True):
            for face in faces:
                row[column[face.material_index]] += 1 / len(faces)
        everywhere = np.zeros((len(self.made.vertices), len(models)))
        everywhere[self.rim], everywhere[self.free] = shares, self._extend(shares)
        return [models[at] for at in everywhere[self.made.collars].mean(axis=1).argmax(axis=1).tolist()]
