# SPDX-License-Identifier: GPL-3.0-or-later
"""How the parts of a joined body, or of a copy of it, lie to it, and the fingerprint of all that it is made of."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.props import FloatVectorProperty, PointerProperty
from mathutils import Matrix

from ..data import written
from . import marks, parts


def parts_of(ob: bpy.types.Object) -> list[bpy.types.Object]:
    """Parts that are still in a scene."""
    found = (part.ob for part in ob.gridmesh_joined.parts)
    return [part for part in found if part is not None and part.type == "MESH" and part.users_scene]


class GridMeshPart(bpy.types.PropertyGroup):
    """A part of a joined body"""  # noqa: D400

    ob: PointerProperty(type=bpy.types.Object, options={"HIDDEN"})
    lies: FloatVectorProperty(size=16, options={"HIDDEN"})
    """Where a part lies in the frame of a copy while it hangs on the body that this is a copy of, or did. All 0: in the world."""


def note(ob: bpy.types.Object) -> None:
    """Let a copy remember how the parts that hang on another whole lie to it; they may lose that."""
    for entry in ob.gridmesh_joined.parts:
        part = entry.ob
        if part is None or not part.users_scene or not ob.is_editable:
            continue
        if _is_foreign(part, ob):
            lies = np.array(parts.frame(part.parent).inverted_safe() @ part.matrix_world)
            if not np.allclose(lies.ravel(), entry.lies, rtol=1e-6, atol=1e-6):
                entry.lies = lies.ravel().tolist()
        elif part.parent == ob and entry.lies[15]:
            entry.lies = [0.0] * 16


def take_in(ob: bpy.types.Object) -> bool:
    """Hang hidden parts on a copy that have lost the body that this is a copy of; say whether there were any."""
    found = False
    for entry in ob.gridmesh_joined.parts:
        part = entry.ob
        if part is None or not part.users_scene or not entry.lies[15] or not ob.is_editable:
            continue
        if part.parent is None and part.hide_render and not part.visible_get() and part.is_editable:
            part.parent, part.parent_type = ob, "OBJECT"
            part.matrix_basis = Matrix.Identity(4)
            part.matrix_parent_inverse = (
                ob.matrix_world.inverted_safe() @ parts.frame(ob) @ _matrix(entry.lies)
            )
            entry.lies = [0.0] * 16
            found = True
    return found


def others(ob: bpy.types.Object, part: bpy.types.Object) -> bool:
    """Whether a part is one of another whole, too."""
    wholes = (one for one in bpy.data.objects if one.type == "MESH" and one != ob and one.users_scene)
    return any(part in parts_of(one) for one in wholes if parts.is_whole(one))


def placed(ob: bpy.types.Object) -> list[parts.Placed]:
    """Parts of a whole, with twins, and where they lie in the world; those of a copy as they lie to the body that it is a copy of."""
    found = []
    there = parts_of(ob)
    for entry in ob.gridmesh_joined.parts:
        part = entry.ob
        if part not in there:
            continue
        place = part.matrix_world.copy()
        if _is_foreign(part, ob):
            place = parts.frame(ob) @ parts.frame(part.parent).inverted() @ place
        elif part.parent != ob and entry.lies[15]:
            place = parts.frame(ob) @ _matrix(entry.lies)
        found.append((part, place))
    return parts.with_twins(ob, found)


def _is_foreign(part: bpy.types.Object, ob: bpy.types.Object) -> bool:
    """Whether a part of a whole hangs on another one."""
    return part.parent not in (None, ob) and parts.is_whole(part.parent)


def _matrix(values: bpy.types.bpy_prop_array) -> Matrix:
    return Matrix([values[row : row + 4] for row in range(0, 16, 4)])


def fingerprint(ob: bpy.types.Object) -> str:
    """Mark of all that a whole depends on, to be compared by `marks.is_same`."""
    joined = ob.gridmesh_joined
    found = placed(ob)
    texts = [f"{joined.blend:.6g} {joined.edge_length:.6g} {joined.strict}"]
    texts += [written.digest(part.data) for part, _ in found]
    places = [np.array(matrix, float) for _, matrix in found]
    return marks.mark(texts, np.array(parts.frame(ob), float), places)
