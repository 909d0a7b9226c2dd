"""Meshes with holes, and what must hold after one was filled."""

from collections import Counter

import bmesh
import bpy
import numpy as np
from drawings import activate, vertices


def edit(ob, *, mode="EDGE"):
    """Enter Edit Mode with nothing selected; return the BMesh."""
    activate(ob)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = tuple(mode == m for m in ("VERT", "EDGE", "FACE"))
    bpy.ops.mesh.select_all(action="DESELECT")
    bm = bmesh.from_edit_mesh(ob.data)
    for elements in (bm.verts, bm.edges, bm.faces):
        elements.ensure_lookup_table()
    return bm


def select(ob, elements):
    """Select some elements of the BMesh."""
    bm = bmesh.from_edit_mesh(ob.data)
    for element in elements:
        element.select_set(True)
    bm.select_flush_mode()
    bmesh.update_edit_mesh(ob.data)


def rim(bm):
    return [edge for edge in bm.edges if edge.is_boundary]


def leave():
    bpy.ops.object.mode_set(mode="OBJECT")


def cylinder(n=16, **options):
    bpy.ops.mesh.primitive_cylinder_add(vertices=n, end_fill_type="NOTHING", **options)
    return bpy.context.object


def grid(n=6):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=n, y_subdivisions=n, size=n)
    return bpy.context.object


def suzanne():
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.object


def without_faces(ob, keep):
    """Delete the faces for which `keep(centre)` is false, and vertices that are left alone."""
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    gone = [face for face in bm.faces if not keep(face.calc_center_median())]
    bmesh.ops.delete(bm, geom=gone, context="FACES")
    bm.to_mesh(ob.data)
    bm.free()
    return ob


def ball_with_hole(segments=32, rings=16):
    """A sphere without its cap around +X, across the poles' direction, so that the rim is jagged."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=rings)
    ob = without_faces(bpy.context.object, lambda centre: centre.x < 0.6)
    ob.data.shade_smooth()
    return ob


def fill(**options):
    assert bpy.ops.mesh.gridmesh_fill(**options) == {"FINISHED"}


def fill_as_user(**options):
    """One undo step, as from a menu."""
    assert bpy.ops.mesh.gridmesh_fill("EXEC_DEFAULT", True, **options) == {"FINISHED"}


def faces_of(mesh):
    return [tuple(polygon.vertices) for polygon in mesh.polygons]


def directed(faces):
    return Counter(pair for face in faces for pair in zip(face, face[1:] + face[:1], strict=True))


class Before:
    """A mesh in Object Mode, to compare with what became of it."""

    def __init__(self, ob):
        self.points, self.faces = vertices(ob.data), faces_of(ob.data)
        self.edges = {frozenset(edge.vertices) for edge in ob.data.edges}

    def check(self, ob, *, closed=True, triangles=True):
        """Old geometry is as it was; the patch is manifold, wound like its neighbours, and selected."""
        mesh = ob.data
        n = len(self.points)
        assert np.array_equal(vertices(mesh)[:n], self.points)
        faces = faces_of(mesh)
        assert faces[: len(self.faces)] == self.faces
        patch = faces[len(self.faces) :]
        assert patch
        assert not mesh.validate(verbose=True)
        runs = directed(faces)
        assert max(runs.values()) == 1, "an edge is used twice in one direction"
        if closed:
            assert all(pair[::-1] in runs for pair in runs), "still open"
        if triangles:
            assert {len(face) for face in patch} == {3}
        inner = {frozenset(pair) for face in patch for pair in directed([face])}
        old = {pair for pair in inner if max(pair) < n}
        before = directed(self.faces)
        rims = {frozenset(pair) for pair in before if pair[::-1] not in before}
        assert old - rims <= {frozenset(edge.vertices) for edge in mesh.edges} - self.edges, (
            "an old edge is reused"
        )
        chosen = [polygon.select for polygon in mesh.polygons]
        assert all(chosen[len(self.faces) :])
        around = {vertex for face in patch for vertex in face}
        for face, is_chosen in zip(self.faces, chosen, strict=False):
            # With vertices being selected, a face comes along that has no other vertex.
            assert not is_chosen or set(face) <= around
        return patch
