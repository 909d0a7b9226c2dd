# SPDX-License-Identifier: GPL-3.0-or-later
"""How the parts of a joined body lie to it, and the fingerprint of all that it is made of."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from ..data import written
from . import marks, parts


def parts_of(ob: bpy.types.Object) -> list[bpy.types.Object]:
    """Parts that are still in a scene."""
    found = (part.ob for part in ob.gridmesh_joined.parts)
    return [part for part in found if part is not None and part.type == "MESH" and part.users_scene]


def placed(ob: bpy.types.Object) -> list[parts.Placed]:
    """Parts of a whole, with twins, and where they lie in the world; those of a copy as they lie to the body that it is a copy of."""
    found = []
    for part in parts_of(ob):
        above = part.parent
        own = above is None or above == ob or not parts.is_whole(above)
        to_own = Matrix.Identity(4) if own else parts.frame(ob) @ parts.frame(above).inverted()
        found.append((part, to_own @ part.matrix_world))
    return parts.with_twins(ob, found)


def fingerprint(ob: bpy.types.Object) -> str:
    """Mark of all that a whole depends on, to be compared by `marks.is_same`."""
    joined = ob.gridmesh_joined
    found = placed(ob)
    texts = [f"{joined.blend:.6g} {joined.edge_length:.6g} {joined.strict}"]
    texts += [written.digest(part.data) for part, _ in found]
    places = [np.array(matrix, float) for _, matrix in found]
    return marks.mark(texts, np.array(parts.frame(ob), float), places)
