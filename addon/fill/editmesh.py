# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in Edit Mode: what of them is open and selected, as plain data; and patches put into them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import bmesh
import bpy
import numpy as np

from ..bodies.outlines import LARGEST
from ..data import attributes
from ..data.mirrors import mirror_planes
from ..native import native
from . import holes
from .holes import Found, OpenEdge, Problem
from .patches import Filled, Snapshot

_FLAT = 1e-9
"""An object scaled to less than this part of its largest scale along some direction has no thickness there."""


class MeshError(ValueError):
    """A mesh that cannot be worked on. The message says why and what to do."""


class EditMesh:
    """A mesh that is being edited. Elements are looked up by index, so it serves until elements are added."""

    def __init__(self, ob: bpy.types.Object) -> None:
        self.ob, self.mesh = ob, ob.data
        self.bm = bmesh.from_edit_mesh(self.mesh)
        for elements in (self.bm.verts, self.bm.edges, self.bm.faces):
            elements.ensure_lookup_table()
        self.bm.verts.index_update()

    @property
    def name(self) -> str:
        """The object's name."""
        return self.ob.name

    def open_edges(self) -> list[OpenEdge]:
        """All edges with one face or none."""
        unusual = [edge for edge in self.bm.edges if not edge.is_manifold]  # the one pass over all of them
        found = [
            OpenEdge((corner.link_loop_next.vert.index, corner.vert.index), False, edge.select, edge.hide)
            for edge in unusual
            if edge.is_boundary
            for corner in edge.link_loops
        ]
        found += [
            OpenEdge((edge.verts[0].index, edge.verts[1].index), True, edge.select, edge.hide)
            for edge in unusual
            if edge.is_wire
        ]
        return found

    def selected_holes(self, *, close_chains: bool) -> Found:
        """Find the holes that the selection means."""
        bm = self.bm
        closed = [
            (edge.verts[0].index, edge.verts[1].index)
            for edge in bm.edges
            if edge.select and not (edge.hide or edge.is_boundary or edge.is_wire)
            if not any(face.select for face in edge.link_faces)
        ]
        vertices = [
            vertex.index
            for vertex in bm.verts
            if vertex.select and not vertex.hide and not any(face.select for face in vertex.link_faces)
        ]
        # With vertices being selected, edges come along wherever both ends are selected.
        strict = "VERT" not in bm.select_mode
        return holes.of_selection(
            self.open_edges(),
            closed,
            vertices,
            close_chains=close_chains,
            strict=strict,
            anything=self.has_selection(),
        )

    def all_holes(self, max_edges: int) -> Found:
        """Find all holes of at most so many edges (0: any number), but those that a Mirror modifier closes.

        Those that it continues are left open, too: a patch would run along its plane. The outer borders of flat sheets
        are none.
        """
        found = holes.all_of(self.open_edges(), max_edges)
        planes, within = mirror_planes(self.ob)
        linear = np.array(self.ob.matrix_world.to_3x3(), float)
        is_outer_border = native("is_outer_border").is_outer_border
        for hole in list(found.holes):
            points = np.array([self.bm.verts[vertex].co for vertex in hole.vertices], float) @ linear.T
            if is_outer_border(points, self._into_faces(hole) @ linear.T):
                found.holes.remove(hole)
                found.outer += 1
                continue
            near = max(within, _FLAT * float(np.ptp(points, axis=0).max()))
            at_planes = [np.abs((points - point) @ normal) <= near for point, normal in planes]
            if any(at_plane.all() for at_plane in at_planes):
                found.holes.remove(hole)
                found.mirrored += 1
            elif any((at_plane & np.roll(at_plane, -1)).any() for at_plane in at_planes):
                found.holes.remove(hole)
                found.across += 1
        return found

    def _into_faces(self, hole: holes.Hole) -> np.ndarray:
        """From each edge of a hole to the middle of its face, (n, 3); zero where it has none."""
        verts = self.bm.verts
        into = np.zeros((len(hole.vertices), 3))
        for k, vertex in enumerate(hole.vertices):
            other = hole.vertices[(k + 1) % len(hole.vertices)]
            edge = self.bm.edges.get((verts[vertex], verts[other]))
            if edge is not None and edge.link_faces:
                into[k] = edge.link_faces[0].calc_center_median() - verts[vertex].co
        return into

    def has_selection(self) -> bool:
        """Whether anything is selected."""
        return self.mesh.total_vert_sel > 0

    def snapshot(self) -> Snapshot:
        """Positions and triangles, as edited until now.

        Raises
        ------
        MeshError
            If the object is scaled to nothing.
        """
        linear = np.array(self.ob.matrix_world.to_3x3(), float)
        widths = np.linalg.svd(linear, compute_uv=False)
        if not np.isfinite(widths).all() or widths[-1] <= _FLAT * widths[0] or widths[0] == 0:
            raise MeshError("it has no thickness, since a scale of it is zero; set its scale and try again")
        self.ob.update_from_editmode()
        mesh = self.mesh
        keys = list(mesh.shape_keys.key_blocks) if mesh.shape_keys is not None else []
        poses = [_positions(key.data) @ linear.T for key in keys]
        positions = poses[self.ob.active_shape_key_index] if keys else _positions(mesh.vertices) @ linear.T
        mesh.calc_loop_triangles()
        triangles = np.empty(len(mesh.loop_triangles) * 3, np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
        polygons = np.empty(len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("polygon_index", polygons)
        return Snapshot(positions, triangles.reshape(-1, 3), polygons, np.linalg.inv(linear), poses)

    def sharp_edges(self) -> np.ndarray:
        """Vertices of the edges that are marked sharp, (e, 2)."""
        pairs = [[vertex.index for vertex in edge.verts] for edge in self.bm.edges if not edge.smooth]
        return np.array(pairs, np.int32).reshape(-1, 2)

    def faulty(self, hole: holes.Hole, positions: np.ndarray) -> Problem | None:
        """Say what is wrong with the positions of a loop, if anything."""
        loop = np.array(hole.vertices)
        points = positions[loop]
        bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
        if len(bad):
            vertex = int(loop[bad[0]])
            reason = f"vertex {vertex} has a coordinate that is not a finite number; move or delete it"
            return Problem(reason, tuple(int(v) for v in loop[bad]))
        far = np.flatnonzero(np.abs(points).max(axis=1) > LARGEST)
        if len(far):
            vertex, reach = int(loop[far[0]]), np.abs(points[far[0]]).max()
            reason = f"vertex {vertex} is {reach:.3g} away, up to {LARGEST:g} is supported; move or delete it"
            return Problem(reason, tuple(int(v) for v in loop[far]))
        steps = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
        none = np.flatnonzero(steps == 0)
        if len(none):
            a, b = int(loop[none[0]]), int(loop[(none[0] + 1) % len(loop)])
            reason = f"the edge between vertices {a} and {b} has no length; merge the vertices by distance"
            return Problem(reason, (a, b), ((a, b),))
        return None

    def add(self, patches: Sequence[Patch], added: Added) -> None:
        """Put patches into the mesh, and write into `added` what was made."""
        bm = self.bm
        surroundings = [
            attributes.Surroundings(bm, *([bm.verts[index] for index in loop] for loop in patch.loops))
            for patch in patches
        ]
        face_set = attributes.new_face_set(bm)
        for patch, around in zip(patches, surroundings, strict=True):
            faces = self._add_one(patch, around, added)
            if face_set is not None:
                for face in faces:
                    face[face_set[0]] = face_set[1]
            added.faces += faces
            added.torn += around.torn > 0
            added.broken += around.broken

    def take_back(self, added: Added) -> None:
        """Remove what was made: faces first, for with an edge or a vertex goes what is built on it."""
        for kind, elements in (
            (bmesh.types.BMFace, self.bm.faces),
            (bmesh.types.BMEdge, self.bm.edges),
            (bmesh.types.BMVert, self.bm.verts),
        ):
            for element in added.elements:
                if isinstance(element, kind):
                    elements.remove(element)

    def finish(self, added: Added) -> None:
        """Select what was made, and hand it to Blender."""
        self.deselect()
        for edge in added.hard:
            edge.smooth = False
        for face in added.faces:
            face.normal_update()
        for vertex in dict.fromkeys(vertex for face in added.faces for vertex in face.verts):
            vertex.normal_update()
        for face in added.faces:
            face.select_set(True)
        self.update()

    def _add_one(self, patch: Patch, around: attributes.Surroundings, added: Added) -> list[Any]:
        bm, made = self.bm, added.elements
        model = attributes.model_face(around.faces)
        layers = bm.verts.layers.shape.values()
        new = []
        for index, place in enumerate(patch.vertices.tolist()):
            vertex = bm.verts.new(place)
            made.append(vertex)
            new.append(vertex)
            for layer, pose in zip(layers, patch.poses, strict=True):
                vertex[layer] = pose[index].tolist()
        by_number = dict(zip((index for loop in patch.loops for index in loop), around.loop, strict=True))
        by_number.update(enumerate(new, patch.first))
        faces = []
        for numbers in patch.faces:
            corners = [by_number[index] for index in numbers]
            for at, vertex in enumerate(corners):
                if max(numbers[at], numbers[at - 1]) < patch.first:
                    ends = (corners[at - 1], vertex)
                    if bm.edges.get(ends) is None:
                        made.append(bm.edges.new(ends))
            face = bm.faces.new(corners, model) if model is not None else bm.faces.new(corners)
            made.append(face)
            faces.append(face)
            face.hide = False
        added.hard += [bm.edges.get([by_number[index] for index in pair]) for pair in patch.creases.tolist()]
        if model is None:
            for face in faces:
                face.material_index = self.ob.active_material_index
        around.write(new, faces, patch.extend)
        return faces

    def deselect(self) -> None:
        """Select nothing."""
        for elements, count in (
            (self.bm.faces, self.mesh.total_face_sel),
            (self.bm.edges, self.mesh.total_edge_sel),
            (self.bm.verts, self.mesh.total_vert_sel),
        ):
            for element in elements if count else ():
                if element.select:
                    element.select = False
        self.bm.select_history.clear()

    def point_out(self, problems: Sequence[Problem]) -> None:
        """Select the culprits, and nothing else."""
        bm = self.bm
        vertices = {index for problem in problems for index in problem.vertices}
        pairs = {frozenset(pair) for problem in problems for pair in problem.edges}
        if not vertices and not pairs:
            return
        by_edge = [edge for edge in bm.edges if frozenset(vertex.index for vertex in edge.verts) in pairs]
        if "VERT" not in bm.select_mode:
            # A vertex alone is not seen in this mode: its selected edges stand for it.
            alone = vertices - {index for pair in pairs for index in pair}
            around = {edge for index in alone for edge in bm.verts[index].link_edges if edge.select}
            by_edge += [edge for edge in around if edge not in by_edge]
        shown = [bm.verts[index] for index in vertices] + by_edge
        self.deselect()
        for element in shown:
            if not element.hide:
                element.select_set(True)
        self.update()

    def update(self) -> None:
        """Hand changes to Blender."""
        self.bm.select_flush_mode()
        bmesh.update_edit_mesh(self.mesh, loop_triangles=True, destructive=True)


@dataclass(frozen=True, eq=False)
class Patch:
    """A filled hole, or the faces between loops, in the object's space."""

    loops: Sequence[Sequence[int]]
    """The loops that it has as its boundary, one or several: vertices of the mesh in order."""
    first: int
    """Number of the first new vertex in `faces`; lower ones are the mesh's."""
    vertices: np.ndarray
    """(j, 3) new vertices."""
    faces: list[list[int]]
    """Vertices of each new face."""
    creases: np.ndarray
    """(e, 2) edges to be marked sharp, numbered as `faces` are."""
    poses: list[np.ndarray]
    """(j, 3) new vertices for every shape key."""
    extend: attributes.Extend
    """From values at the vertices of the loops, one loop after the other, to values at the new ones."""

    @classmethod
    def of(cls, made: Filled, loops: Sequence[Sequence[int]], at: Snapshot) -> Patch:
        """Take what was made for loops of a mesh to the object's space."""
        return cls(
            loops=loops,
            first=len(at.positions),
            vertices=made.vertices @ at.to_local.T,
            faces=[*made.quads.tolist(), *made.triangles.tolist()],
            creases=made.creases,
            poses=[pose @ at.to_local.T for pose in made.poses],
            extend=made.extend,
        )


@dataclass
class Added:
    """What came into a mesh."""

    elements: list[Any] = field(default_factory=list)
    """Everything, in the order in which it was made."""
    faces: list[Any] = field(default_factory=list)
    hard: list[Any] = field(default_factory=list)
    """Edges to be marked sharp."""
    torn: int = 0
    """Loops along which corner data does not agree."""
    broken: int = 0
    """Layers with values that are not finite."""


def _positions(collection: Any) -> np.ndarray:
    points = np.empty(len(collection) * 3, np.float32)
    collection.foreach_get("co", points)
    return points.reshape(-1, 3).astype(float)
