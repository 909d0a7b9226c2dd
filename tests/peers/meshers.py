"""The meshers that are compared, each behind the same face.

All get the same closed polygons and a size, and return the processor seconds of the meshing alone, the
vertices and the triangles. What a mesher needs before (points in its own types, a geometry model) is prepared
untimed, which is in favour of gmsh and netgen; arrays of the result are made within the time.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import gridmesh
import numpy as np
import triangle
from drawing import point_inside, sides
from netgen.geom2d import SplineGeometry

try:
    import gmsh
except OSError as error:
    # A desktop has the libraries of its window, which is never opened here.
    packages = (
        "libfontconfig1 libgl1 libglu1-mesa libgomp1 libxcursor1 libxfixes3 libxft2 libxinerama1 libxrender1"
    )
    sys.exit(f"gmsh does not load ({error}); on Debian it needs\n\n    sudo apt-get install {packages}\n")

# Ours would use every core; read when it first starts a thread. The others have one anyway.
os.environ["RAYON_NUM_THREADS"] = "1"


class Failed(Exception):
    """A mesher gave no mesh."""


@dataclass
class Problem:
    drawn: list[np.ndarray]
    """The contours as drawn: what our own mesher gets."""
    even: list[np.ndarray]
    """The same contours resampled to as many points as our boundary has vertices: what all others get."""
    target: int
    """Number of triangles."""


@dataclass
class Mesh:
    seconds: float
    n_triangles: int
    vertices: np.ndarray | None = None
    triangles: np.ndarray | None = None
    loops: list[int] | None = None
    """The number of boundary vertices on each contour; of our meshes only."""


class Mesher(ABC):
    power = -2.0
    """The number of triangles goes with this power of the size."""
    has_holes = True
    """Whether drawings with holes can be meshed."""
    is_peer = True
    """False for variants of our own: drawings are compared without them where they fail."""

    def __init__(self, name: str) -> None:
        self.name = name

    def guess(self, problem: Problem, edge: float) -> float:
        """The size to begin the search with; `edge` is that of equilateral triangles of the same number."""
        return edge

    @abstractmethod
    def mesh(self, problem: Problem, size: float, keep: bool) -> Mesh:
        """One run. The mesh itself is returned if it is to be kept."""


def timed(work: Callable[[], tuple]) -> tuple[float, tuple]:
    """Processor time of all threads."""
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


class Ours(Mesher):
    """Our own mesher through its Python module; the size is a number of triangles."""

    power = 1.0
    is_peer = False

    def __init__(self, name: str, **options: object) -> None:
        super().__init__(name)
        self.options = options
        self.has_holes = options.get("boundary") != "grown"

    def guess(self, problem: Problem, edge: float) -> float:
        return problem.target

    def mesh(self, problem: Problem, size: float, keep: bool) -> Mesh:
        outline, *holes = problem.drawn

        def work() -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
            patch = gridmesh.mesh_sketch(outline, holes, triangles=round(size), **self.options)
            return patch.vertices, patch.triangles, patch.loops

        try:
            seconds, (vertices, triangles, loops) = timed(work)
        except gridmesh.GridMeshError as error:
            raise Failed(error.kind) from error
        return Mesh(seconds, len(triangles), vertices, triangles, [len(loop) for loop in loops])


class Triangle(Mesher):
    """Triangle with its quality switch: no angle below 30 degrees, and a greatest area."""

    def mesh(self, problem: Problem, size: float, keep: bool) -> Mesh:
        data = {"vertices": np.concatenate(problem.even), "segments": sides(problem.even)}
        if len(problem.even) > 1:
            data["holes"] = np.array([point_inside(hole) for hole in problem.even[1:]])
        switches = f"pq30a{0.25 * 3**0.5 * size**2:.12f}"

        def work() -> tuple[np.ndarray, np.ndarray]:
            result = triangle.triangulate(data, switches)
            return result["vertices"], result["triangles"]

        seconds, (vertices, triangles) = timed(work)
        return Mesh(seconds, len(triangles), vertices, triangles)


class Gmsh(Mesher):
    """Gmsh's frontal Delaunay algorithm with one edge a side of the polygons, and an even size inside."""

    FRONTAL = 6
    TRIANGLES = 2

    def __init__(self, name: str) -> None:
        super().__init__(name)
        gmsh.initialize(["-nopopup"], readConfigFiles=False)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.Algorithm", self.FRONTAL)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)

    def mesh(self, problem: Problem, size: float, keep: bool) -> Mesh:
        gmsh.clear()
        geometry = gmsh.model.geo
        loops = []
        for contour in problem.even:
            points = [geometry.addPoint(x, y, 0) for x, y in contour.tolist()]
            lines = [geometry.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
            for line in lines:
                geometry.mesh.setTransfiniteCurve(line, 2)
            loops.append(geometry.addCurveLoop(lines))
        geometry.addPlaneSurface(loops)
        geometry.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)

        def work() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            gmsh.model.mesh.generate(2)
            tags, points, _ = gmsh.model.mesh.getNodes()
            return tags, points, gmsh.model.mesh.getElementsByType(self.TRIANGLES)[1]

        try:
            seconds, (tags, points, corners) = timed(work)
        except Exception as error:  # Its binding raises nothing more special.
            raise Failed(str(error)) from error
        number = np.zeros(int(tags.max()) + 1, int)
        number[tags.astype(int)] = np.arange(len(tags))
        triangles = number[corners.astype(int)].reshape(-1, 3)
        return Mesh(seconds, len(triangles), points.reshape(-1, 3)[:, :2], triangles)


class Netgen(Mesher):
    """Netgen's mesher of plane geometries as it is set by default."""

    def mesh(self, problem: Problem, size: float, keep: bool) -> Mesh:
        geometry = SplineGeometry()
        for contour in problem.even:
            points = [geometry.AppendPoint(x, y) for x, y in contour.tolist()]
            for a, b in zip(points, points[1:] + points[:1], strict=True):
                geometry.Append(["line", a, b], leftdomain=1, rightdomain=0)

        def work() -> tuple[np.ndarray, np.ndarray]:
            mesh = geometry.GenerateMesh(maxh=size)
            # Copies: the arrays lie in the mesh, which goes.
            return mesh.Coordinates().copy(), mesh.Elements2D().NumPy()["nodes"][:, :3].copy()

        try:
            seconds, (vertices, triangles) = timed(work)
        except Exception as error:  # Its binding raises nothing more special.
            raise Failed(str(error)) from error
        return Mesh(seconds, len(triangles), vertices[:, :2], triangles.astype(int) - 1)


class InRust(Mesher):
    """One of the meshers of the Rust example `peers`, which measures its own time."""

    def __init__(self, name: str, process: RustProcess, mesher: str, ours: bool = False) -> None:
        super().__init__(name)
        self.process, self.mesher, self.ours = process, mesher, ours
        self.power = Ours.power if ours else Mesher.power
        self.is_peer = not ours

    def guess(self, problem: Problem, edge: float) -> float:
        return problem.target if self.ours else edge

    def mesh(self, problem: Problem, size: float, keep: bool) -> Mesh:
        contours = problem.drawn if self.ours else problem.even
        answer = self.process.ask(
            mesher=self.mesher,
            contours=[contour.tolist() for contour in contours],
            size=size,
            target=problem.target,
            mesh=keep,
        )
        mesh = Mesh(answer["seconds"], answer["triangles"])
        if keep:
            mesh.vertices = np.array(answer["mesh"]["vertices"], float).reshape(-1, 2)
            mesh.triangles = np.array(answer["mesh"]["triangles"], int).reshape(-1, 3)
        return mesh


class RustProcess:
    """The running example, asked over its standard input."""

    def __init__(self, root: Path) -> None:
        build = ["cargo", "build", "--release", "--locked", "--package", "gridmesh", "--example", "peers"]
        subprocess.run(build, check=True, cwd=root)
        report = [*build, "--quiet", "--message-format", "json"]
        built = subprocess.run(report, check=True, cwd=root, capture_output=True, text=True)
        messages = [json.loads(line) for line in built.stdout.splitlines()]
        artifacts = [m for m in messages if m.get("target", {}).get("name") == "peers"]
        executable = next(m["executable"] for m in artifacts if m.get("executable"))
        self.process = subprocess.Popen(
            [executable], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )

    def ask(self, **request: object) -> dict:
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        if "error" in answer:
            raise Failed(answer["error"])
        return answer
