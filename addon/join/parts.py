# SPDX-License-Identifier: GPL-3.0-or-later
"""What a part of a joined body remembers: how far in front of the whole it lies, and whether it has a mirror image.

The twin of a part is no object: the part is joined a second time, mirrored across the plane x = 0 of the whole. So the two are always alike.
"""

from __future__ import annotations

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, PointerProperty
from mathutils import Matrix, Vector

MIRROR = Matrix.Scale(-1.0, 4, Vector((1.0, 0.0, 0.0)))
"""Takes a part to its twin, in the space of the whole."""

Placed = tuple[bpy.types.Object, Matrix]
"""A part and where it is taken to be in the world."""


def _moved(options: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    ob = options.id_data
    step, options.lies_at = options.depth - options.lies_at, options.depth
    above = frame(ob.parent).to_3x3() if ob.parent is not None else Matrix.Identity(3)
    move = above @ Vector(options.reach) * step
    if move.length:
        ob.matrix_world = Matrix.Translation(move) @ ob.matrix_world


def _changed(options: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    options.id_data.update_tag()


class GridMeshPartOptions(bpy.types.PropertyGroup):
    """How a part lies to the body that it is joined to"""  # noqa: D400

    depth: FloatProperty(
        name="Part Depth",
        description="1: the middle of the part is on the surface of the body, as the view saw it that it was drawn in; "
        "0: it goes through the middle of the body; -1: it is behind",
        default=0.0,
        soft_min=-1.5,
        soft_max=1.5,
        min=-100.0,
        max=100.0,
        update=_moved,
    )
    lies_at: FloatProperty(options={"HIDDEN"})
    """The depth that it lies at now."""
    reach: FloatVectorProperty(size=3, options={"HIDDEN"})
    """From depth 0 to depth 1, in the space of the whole that its `frame` is of. All 0: depth has no meaning."""
    held: BoolProperty(options={"HIDDEN"})
    """Whether it hangs on a whole, or did when that was deleted."""
    twin: BoolProperty(
        name="Twin",
        description="Join the mirror image of the part, too, across the X axis of the joined body; it follows the same stroke",
        default=False,
        update=_changed,
    )


def is_whole(ob: bpy.types.Object) -> bool:
    """Whether an object is joined of parts that it remembers. To read a group of properties that is not there would make it."""
    system = getattr(ob, "bl_system_properties_get", None)  # from Blender 5.0 on
    stored = ob if system is None else system()
    return stored is not None and "gridmesh_joined" in stored and len(ob.gridmesh_joined.parts) > 0


def is_held(ob: bpy.types.Object) -> bool:
    """Whether an object hangs on a whole as a part, or did when that was deleted. Makes no group of properties."""
    system = getattr(ob, "bl_system_properties_get", None)  # from Blender 5.0 on
    stored = ob if system is None else system()
    return stored is not None and "gridmesh_part" in stored and ob.gridmesh_part.held


def frame(ob: bpy.types.Object) -> Matrix:
    """Matrix from the space of a whole that its parts lie in to the world; of any other object its own.

    It stays what it was where a scale, a rotation or a place of the whole is applied, or its origin set.
    """
    values = ob.gridmesh_joined.space if is_whole(ob) else None
    if values is None or not values[15]:
        return ob.matrix_world.copy()
    return ob.matrix_world @ Matrix([values[row : row + 4] for row in range(0, 16, 4)])


def note(
    ob: bpy.types.Object,
    whole: bpy.types.Object,
    *,
    depth: float,
    reach: tuple[float, float, float],
    twin: bool,
) -> None:
    """Let a part know how it lies. reach : from depth 0 to 1, in the world."""
    options = ob.gridmesh_part
    options.reach = frame(whole).to_3x3().inverted() @ Vector(reach)
    options.lies_at = depth  # before `depth`, which then moves nothing
    options.depth = depth
    options.twin = twin


def has_depth(ob: bpy.types.Object) -> bool:
    """Whether it is known what is in front of the whole, for a part."""
    return any(ob.gridmesh_part.reach)


def twin_of(whole: Matrix, part: Matrix) -> Matrix:
    """Where the mirror image of a part is, by the frame of the whole and the place of the part in the world."""
    return whole @ MIRROR @ whole.inverted() @ part


def with_twins(ob: bpy.types.Object, parts: list[Placed]) -> list[Placed]:
    """Parts of a whole and the twins of those that have one, each twin after its part."""
    found, whole = [], frame(ob)
    for part, place in parts:
        found.append((part, place))
        if part.gridmesh_part.twin and abs(np.linalg.det(np.array(whole, float))) > 0:
            found.append((part, twin_of(whole, place)))
    return found


classes = (GridMeshPartOptions,)


def register() -> None:
    """Give objects what they remember as parts."""
    bpy.types.Object.gridmesh_part = PointerProperty(type=GridMeshPartOptions)


def unregister() -> None:
    """Take it away; what is stored in files stays."""
    if hasattr(bpy.types.Object, "gridmesh_part"):
        del bpy.types.Object.gridmesh_part
