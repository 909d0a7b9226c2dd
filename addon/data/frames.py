# SPDX-License-Identifier: GPL-3.0-or-later
"""How a drawing and its bodies lie to each other.

The mesh of a body is a function of its strokes in the body's own space. `frame` takes the drawing's data there: where
the outline is the child of its body, that is how it lies in it, so that both can be moved by whatever carries them;
everywhere else it is a constant that the body remembers. Nothing of it depends on where things are in the world.

The body's own space is that of the sketch. `space` takes it to that of the object: the identity, until a scale, a rotation
or a place is applied, or the origin is set; from then on what was taken out of the object's matrix is there.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..bodies.outlines import Plane


def is_linked(ob: bpy.types.Object) -> bool:
    """Whether an object is a body with a link. To read a group of properties that is not there would make it."""
    system = getattr(ob, "bl_system_properties_get", None)  # from Blender 5.0 on
    stored = ob if system is None else system()
    return stored is not None and "gridmesh_live" in stored and ob.gridmesh_live.linked


def nested(source: bpy.types.Object | None, ob: bpy.types.Object) -> bool:
    """Whether a drawing is the child of a body."""
    return source is not None and source.parent == ob and source.parent_type == "OBJECT"


def owned(ob: bpy.types.Object) -> bpy.types.Object | None:
    """Return the outline that belongs to a linked body alone: made by the tool, and its child; or None."""
    source = ob.gridmesh_live.source
    return source if nested(source, ob) and source.gridmesh_outline else None


def astray(source: bpy.types.Object) -> bool:
    """Whether an outline of a body is no longer the child of it, or of anything that has a body's link."""
    return source.gridmesh_outline and (source.parent is None or not is_linked(source.parent))


def layer_matrix(layer: Any) -> np.ndarray:
    """Matrix (4, 4) from a grease pencil layer to what carries it: its object, or the layer's own parent."""
    if layer.parent is None:
        return np.array(layer.matrix_local)
    return np.array(layer.matrix_parent_inverse @ layer.matrix_local)


def _layer(source: bpy.types.Object, name: str) -> Any:
    """Return the grease pencil layer of a name; None where there is none."""
    layers = source.data.layers if source.type == "GREASEPENCIL" else ()
    return next((layer for layer in layers if layer.name == name), None)


def carrier(source: bpy.types.Object, layer: str) -> tuple[bpy.types.Object, str]:
    """Return the object that carries the strokes of a layer, and the bone of it or ""."""
    found = _layer(source, layer)
    if found is None or found.parent is None:
        return source, ""
    parent, bone = found.parent, found.parent_bone
    return parent, bone if bone and parent.type == "ARMATURE" and bone in parent.pose.bones else ""


def carrier_world(source: bpy.types.Object, layer: str) -> np.ndarray:
    """Matrix (4, 4) from the space that a layer's strokes are carried in to the world."""
    ob, bone = carrier(source, layer)
    matrix = ob.matrix_world @ ob.pose.bones[bone].matrix if bone else ob.matrix_world
    return np.array(matrix)


def stored(ob: bpy.types.Object) -> np.ndarray | None:
    """Return the frame that a linked body remembers; None for one that was made before there were frames."""
    matrix = np.array(ob.gridmesh_live.frame, float).reshape(4, 4)
    return matrix if matrix[3, 3] else None


def space(ob: bpy.types.Object) -> np.ndarray:
    """Matrix (4, 4) from a body's own space, in which its sketch is, to that of the object; identity without a link."""
    if not is_linked(ob):
        return np.eye(4)
    matrix = np.array(ob.gridmesh_live.space, float).reshape(4, 4)
    return matrix if matrix[3, 3] else np.eye(4)


def place(ob: bpy.types.Object) -> np.ndarray:
    """Matrix (4, 4) from a body's own space to the world."""
    return np.array(ob.matrix_world) @ space(ob)


def frame(ob: bpy.types.Object) -> np.ndarray:
    """Matrix (4, 4) from the space of a linked body's drawing (see `carrier`) to that of the body."""
    live = ob.gridmesh_live
    source = live.source
    if nested(source, ob) and carrier(source, live.layer)[0] == source:
        matrix = np.array(source.matrix_parent_inverse) @ np.array(source.matrix_basis)
        return np.linalg.solve(space(ob), matrix)
    matrix = stored(ob)
    return np.eye(4) if matrix is None else matrix


def remember(ob: bpy.types.Object, matrix: np.ndarray) -> None:
    """Store a frame, if it is another one."""
    values = matrix.astype(np.float32).ravel()
    if not np.array_equal(values, np.array(ob.gridmesh_live.frame, np.float32)):
        ob.gridmesh_live.frame = values.tolist()


def apart(source: bpy.types.Object, layer: str, ob: bpy.types.Object) -> np.ndarray:
    """Return the frame that leaves both where they are in the world. Both have to be evaluated."""
    return np.linalg.inv(place(ob)) @ carrier_world(source, layer)


def nest(source: bpy.types.Object, ob: bpy.types.Object, matrix: np.ndarray) -> None:
    """Make a drawing the child of a body, so that it lies in the body's own space by `matrix`."""
    source.parent, source.parent_type = ob, "OBJECT"
    source.matrix_basis = Matrix.Identity(4)
    source.matrix_parent_inverse = Matrix((space(ob) @ matrix).tolist())


def carry(ob: bpy.types.Object, source: bpy.types.Object, layer: str) -> None:
    """Make a body the child of what carries its strokes; it stays where it is. One with a parent keeps that."""
    above, bone = carrier(source, layer)
    if ob.parent is not None or ob in ancestors(above):
        return
    world = Matrix(carrier_world(source, layer).tolist())
    if bone:
        world = world @ Matrix.Translation((0, above.pose.bones[bone].length, 0))
    if abs(world.determinant()) < 1e-12:
        return  # nothing can keep its place in what is flat
    ob.parent = above
    if bone:
        ob.parent_type, ob.parent_bone = "BONE", bone
    ob.matrix_parent_inverse = world.inverted()


def ancestors(ob: bpy.types.Object | None) -> list[bpy.types.Object]:
    """The object, its parent, and so on."""
    found = []
    while ob is not None:
        found.append(ob)
        ob = ob.parent
    return found


def moved(points: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Points (n, 3) moved by a matrix (4, 4)."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def to_world(ob: bpy.types.Object, points: np.ndarray) -> np.ndarray:
    """Points (n, 3) of a body's space in the world."""
    return moved(points, place(ob))


def to_local(ob: bpy.types.Object, points: np.ndarray) -> np.ndarray:
    """Points (n, 3) of the world in a body's space.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the body is scaled to nothing.
    """
    return moved(points, np.linalg.inv(place(ob)))


def plane_local(ob: bpy.types.Object, plane: Plane) -> Plane:
    """Return a plane of the world in a body's space; raises as `to_local` does."""
    origin, x, y = to_local(ob, plane.origin + np.array([np.zeros(3), plane.axes[0], plane.axes[1]]))
    x = (x - origin) / np.linalg.norm(x - origin)
    normal = np.cross(x, y - origin)
    normal /= np.linalg.norm(normal)
    return Plane(origin, np.stack([x, np.cross(normal, x), normal]))


def register() -> None:
    """Let outlines know that they are a part of a body, and meshes what they were when they were made."""
    bpy.types.Object.gridmesh_outline = bpy.props.BoolProperty(options={"HIDDEN"})
    bpy.types.Mesh.gridmesh_made = bpy.props.StringProperty(options={"HIDDEN"})


def unregister() -> None:
    """Take it away; what is stored in files stays."""
    for cls, name in ((bpy.types.Object, "gridmesh_outline"), (bpy.types.Mesh, "gridmesh_made")):
        if hasattr(cls, name):
            delattr(cls, name)
