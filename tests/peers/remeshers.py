"""Instant Meshes and TriWild behind the face of `meshers.py`, and the list of all peers that have Python modules.

Instant Meshes lays a field of six directions over a mesh and extracts triangles from it; what it is given here is Triangle's
mesh of the drawing with four times as many triangles as are wanted, untimed, which is in its favour. TriWild gets the
sides of the resampled drawing.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pyinstantmeshes
import triangle
import wildmeshing
from drawing import point_inside, sides
from meshers import Failed, Gmsh, Mesh, Mesher, Netgen, Problem, Triangle, timed


@contextmanager
def quiet() -> Iterator[None]:
    """Without what libraries write to standard output."""
    kept, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nothing)


class InstantMeshes(Mesher):
    """Its field of six directions, with edges along the boundary or not; the size is a number of triangles."""

    power = 1.0
    is_peer = False
    FINER = 4

    def __init__(self, name: str, aligned: bool) -> None:
        super().__init__(name)
        self.aligned = aligned

    def guess(self, problem: Problem, edge: float) -> float:
        return problem.target

    def mesh(self, problem: Problem, size: float, keep: bool) -> Mesh:
        data = {"vertices": np.concatenate(problem.even), "segments": sides(problem.even)}
        if len(problem.even) > 1:
            data["holes"] = np.array([point_inside(hole) for hole in problem.even[1:]])
        low, high = data["vertices"].min(axis=0), data["vertices"].max(axis=0)
        scale = float((high - low).max())
        data["vertices"] = (data["vertices"] - low) / scale
        area = sum(abs(x @ np.roll(y, 1) - y @ np.roll(x, 1)) / 2 for x, y in (c.T for c in problem.even[:1]))
        fine = triangle.triangulate(data, f"pq30a{area / scale**2 / (self.FINER * problem.target):.12f}")
        flat = np.column_stack([fine["vertices"], np.zeros(len(fine["vertices"]))]).astype(np.float32)
        faces = fine["triangles"].astype(np.int32)

        def work() -> tuple[np.ndarray, np.ndarray]:
            return pyinstantmeshes.remesh(
                flat,
                faces,
                target_face_count=round(size),
                rosy=6,
                posy=3,
                align_to_boundaries=self.aligned,
                deterministic=True,
            )

        with quiet():
            try:
                seconds, (vertices, triangles) = timed(work)
            except RuntimeError as error:
                raise Failed(str(error)) from error
        if not len(triangles):
            raise Failed("no triangles")
        return Mesh(
            seconds, len(triangles), vertices[:, :2].astype(float) * scale + low, triangles.astype(int)
        )


class TriWild(Mesher):
    """TriWild by its Python module, with straight sides; the size is an edge length."""

    is_peer = False

    def mesh(self, problem: Problem, size: float, keep: bool) -> Mesh:
        points = np.concatenate(problem.even)
        edges = np.asarray(sides(problem.even), np.int32)
        holes = [point_inside(hole) for hole in problem.even[1:]]
        options = {"hole_pts": np.array(holes, float)} if holes else {}

        def work() -> tuple[np.ndarray, np.ndarray]:
            found = wildmeshing.triangulate_data(
                points, edges, target_edge_len=size, cut_outside=True, mute_log=True, **options
            )
            return found[0], found[1]

        with quiet():
            try:
                seconds, (vertices, triangles) = timed(work)
            except RuntimeError as error:
                raise Failed(str(error)) from error
        if not len(triangles):
            raise Failed("no triangles")
        return Mesh(seconds, len(triangles), vertices[:, :2], triangles.astype(int))


def peers() -> list[Mesher]:
    """The meshers of others that have Python modules, with their names in tables."""
    return [
        Triangle("Triangle `pq30a`"),
        Gmsh("gmsh, frontal"),
        Netgen("netgen"),
        InstantMeshes("Instant Meshes, 6-RoSy", aligned=False),
        InstantMeshes("Instant Meshes, 6-RoSy, boundary aligned", aligned=True),
        TriWild("TriWild"),
    ]
