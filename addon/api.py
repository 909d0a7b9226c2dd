# SPDX-License-Identifier: GPL-3.0-or-later
"""From strokes in space to bodies: the calls into `gridmesh`, and what can go wrong on the way.

numpy only, no bpy: everything here runs in plain Python. Points are float64 in world units.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from .outlines import Sketch, Stroke, StrokeError, area, nest, prepare, project

NATIVE_VERSION = "0.1.0"
"""Version of the `gridmesh` module that this extension is shipped with; newer patch releases serve too."""


class NativeError(RuntimeError):
    """The module `gridmesh` cannot be used. The message says why and what to do."""


def native() -> Any:
    """Import the module `gridmesh` and check its version.

    Raises
    ------
    NativeError
        If it is missing, was built for another platform, or has another version.
    """
    try:
        module = importlib.import_module("gridmesh")
    except (ImportError, OSError) as error:
        raise NativeError(
            f"The native module 'gridmesh' could not be loaded ({error}); "
            "install the GridMesh extension for this platform again and restart Blender"
        ) from error
    version = getattr(module, "__version__", "of unknown version")
    if not _serves(version):
        raise NativeError(
            f"The native module 'gridmesh' is {version}, this extension needs {NATIVE_VERSION}; "
            "update GridMesh and every extension that brings the module, then restart Blender"
        )
    return module


def _serves(version: str) -> bool:
    """Whether a module of this version has the functions used here: same minor release, not older."""
    try:
        found, needed = (tuple(int(part) for part in v.split(".")[:3]) for v in (version, NATIVE_VERSION))
    except ValueError:
        return False
    return found[:2] == needed[:2] and found >= needed


@dataclass(frozen=True, eq=False)
class Body:
    """A finished mesh in the frame of `plane`."""

    sketch: Sketch
    vertices: np.ndarray
    triangles: np.ndarray
    uv: np.ndarray
    silhouette: list[np.ndarray]
    report: dict[str, Any]


@dataclass(frozen=True)
class Failure:
    """A stroke that did not become a body, and why."""

    label: str
    reason: str

    def __str__(self) -> str:
        return f"{self.label}: {self.reason}"


def sketches_of(
    strokes: list[Stroke], *, close_gaps: float, holes: bool
) -> tuple[list[Sketch], list[Failure]]:
    """Prepare every stroke; strokes that cannot be are returned with the reason."""
    sketches: list[Sketch] = []
    failures: list[Failure] = []
    for stroke in strokes:
        try:
            sketches.append(prepare(stroke, close_gaps))
        except StrokeError as error:
            failures.append(Failure(stroke.label, str(error)))
    return (nest(sketches) if holes else sketches), failures


def build(
    sketches: list[Sketch], sketch_options: dict[str, Any], body_options: dict[str, Any] | None
) -> tuple[list[Body], list[Failure]]:
    """Mesh every sketch, several at once, and inflate it unless `body_options` is None.

    sketch_options, body_options : keyword arguments of `gridmesh.mesh_sketch` and `gridmesh.inflate`.
    Sketches that are refused are returned with the reason. Raises NativeError without the module.
    """
    gridmesh = native()
    bodies: list[Body] = []
    failures: list[Failure] = []
    for sketch, surface in zip(
        sketches, _surfaces(gridmesh, sketches, sketch_options, body_options), strict=True
    ):
        if isinstance(surface, gridmesh.GridMeshError):
            failures.append(Failure(sketch.stroke.label, str(surface)))
            continue
        bodies.append(
            Body(
                sketch=sketch,
                vertices=surface.vertices,
                triangles=surface.triangles,
                uv=surface.uv,
                silhouette=list(surface.silhouette),
                report=dict(surface.report),
            )
        )
    return bodies, failures


def _surfaces(
    gridmesh: Any, sketches: list[Sketch], sketch_options: dict[str, Any], body_options: dict[str, Any] | None
) -> list[Any]:
    """Surface or GridMeshError for every sketch."""
    drawings = [
        (sketch.outline, [project(hole, sketch.plane)[:, :2] for hole in sketch.holes]) for sketch in sketches
    ]
    if body_options is not None and len(drawings) > 1:
        return list(gridmesh.map_sketches(drawings, **{**sketch_options, **body_options}))

    def surface(outline: np.ndarray, holes: list[np.ndarray]) -> Any:
        try:
            patch = gridmesh.mesh_sketch(outline, holes, **sketch_options)
            return gridmesh.flat(patch) if body_options is None else gridmesh.inflate(patch, **body_options)
        except gridmesh.GridMeshError as error:
            return error

    return [surface(outline, holes) for outline, holes in drawings]


def suggested_edge_length(sketches: list[Sketch], triangles: int) -> float | None:
    """Edge length at which the largest sketch has about that many triangles; None if none has an area."""
    largest = max((area(sketch.outline) for sketch in sketches), default=0.0)
    if largest <= 0 or triangles <= 0:
        return None
    return float(np.sqrt(largest / triangles * 4 / np.sqrt(3)))
