# SPDX-License-Identifier: GPL-3.0-or-later
"""Live bodies as decisions see them: read once when a stroke begins."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ..bodies.outlines import Plane, Sketch, project
from ..data import frames, written
from ..join import characters, following, parts, transforms
from ..live import engine
from ..live.reading import LostError, sketch_of
from .decision import Shape
from .trace import Mirror

SAMPLES = 2000
"""About how many points of a body's surface are looked at."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A body, its sketch, and its outline in the world."""

    ob: bpy.types.Object
    sketch: Sketch
    shape: Shape
    to_sketch: np.ndarray
    """(2, 2) from the shape's plane to the sketch's."""
    matrix: np.ndarray
    """(4, 4) from the body's space, in which the sketch is, to the world."""

    def back(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the shape's plane in the sketch's."""
        return points @ self.to_sketch.T

    def world(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 3) of the body's space in the world."""
        return points @ self.matrix[:3, :3].T + self.matrix[:3, 3]


def read(context: bpy.types.Context) -> dict[str, Drawn]:
    """Bodies that strokes may change, by name: those that are seen, if only joined, and follow a grease pencil drawing."""
    depsgraph = context.evaluated_depsgraph_get()
    found = {}
    for ob in engine.bodies():
        source = ob.gridmesh_live.source
        if source is None or source.type != "GREASEPENCIL" or not characters.shown(ob):
            continue
        try:
            sketch = sketch_of(ob, depsgraph)
        except LostError:
            continue  # without an outline there is nothing to draw on
        drawn = _drawn(ob, sketch)
        if drawn is not None:
            found[ob.name] = drawn
    return found


def seen(bodies: dict[str, Drawn]) -> list[Shape]:
    """Shapes of bodies, and of the twins of those that have one."""
    found = [drawn.shape for drawn in bodies.values()]
    twins = [drawn.shape.mirrored() for drawn in bodies.values() if _has_twin(drawn.ob)]
    return found + twins


def _has_twin(ob: bpy.types.Object) -> bool:
    return following.whole_of(ob) is not None and ob.gridmesh_part.twin


def _drawn(ob: bpy.types.Object, sketch: Sketch) -> Drawn | None:
    """Lay a sketch into the world; None if it is squeezed to nothing there."""
    matrix = frames.place(ob)
    own = sketch.plane
    x, y, _z = (matrix[:3, :3] @ axis for axis in own.axes)
    origin = matrix[:3, :3] @ own.origin + matrix[:3, 3]
    normal = np.cross(x, y)
    if not np.linalg.norm(normal) or not np.linalg.norm(x):
        return None
    normal /= np.linalg.norm(normal)
    x_axis = x / np.linalg.norm(x)
    plane = Plane(origin, np.stack([x_axis, np.cross(normal, x_axis), normal]))
    to_world = np.stack([plane.axes[:2] @ x, plane.axes[:2] @ y], axis=1)
    holes = [project(hole, own)[:, :2] @ to_world.T for hole in sketch.holes]
    points = np.empty(len(ob.data.vertices) * 3, np.float32)
    ob.data.vertices.foreach_get("co", points)
    some = points.reshape(-1, 3)[:: max(1, len(ob.data.vertices) // SAMPLES)]
    surface = plane.local(frames.moved(some, np.array(ob.matrix_world)))
    thickness = float(np.abs(surface[:, 2]).max(initial=0.0))
    outline = sketch.outline @ to_world.T
    fixed, apart = _hindrances(ob)
    shape = Shape(ob.name, plane, outline, holes, thickness, surface, _across(ob), fixed=fixed, apart=apart)
    return Drawn(ob, sketch, shape, np.linalg.inv(to_world), matrix)


def _hindrances(ob: bpy.types.Object) -> tuple[str, str]:
    """Why the outline of a body cannot be changed, and why no part can be joined to it; empty where it can."""
    whole = following.whole_of(ob)
    apart = following.BY_HAND if whole is not None and transforms.changed_by_hand(whole) else ""
    if written.by_hand(ob.data):
        return engine.BY_HAND, apart
    return ("" if ob.visible_get() else apart), apart


def _across(ob: bpy.types.Object) -> Mirror:
    """Where twins of parts are mirrored: across the X axis of the whole, which the body is or will be."""
    place = np.array(parts.frame(following.whole_of(ob) or ob), float)
    normal = np.cross(place[:3, 1], place[:3, 2])
    return Mirror(place[:3, 3], normal / max(float(np.linalg.norm(normal)), 1e-30))
