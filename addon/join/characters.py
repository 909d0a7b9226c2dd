# SPDX-License-Identifier: GPL-3.0-or-later
"""Joined bodies as artists build them: a part is added, picked to be changed, and split off again.

All functions are called from operators, between updates of the dependency graph; each leaves the whole joined.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from mathutils import Vector

from ..live import engine, family
from . import deleted, following, joining, parts, showing
from .joinobject import beside

NAME = "Character"


@dataclass(frozen=True)
class Lies:
    """How a new part lies to the whole."""

    depth: float = 0.0
    reach: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """From depth 0 to depth 1, in the world."""
    twin: bool = False


def shown(ob: bpy.types.Object) -> bool:
    """Whether an object is to be seen, by itself or in the whole that it is a part of."""
    if ob.visible_get():
        return True
    whole = following.whole_of(ob)
    return whole is not None and whole.visible_get()


def seen(ob: bpy.types.Object) -> bpy.types.Object:
    """Return an object, or the whole where it is a hidden part of one."""
    whole = following.whole_of(ob)
    return whole if whole is not None and not ob.visible_get() else ob


def add(owner: bpy.types.Object, part: bpy.types.Object, lies: Lies) -> str:
    """Join a new part to a body, or to the joined body that this is a part of.

    Returns why it could not be joined; then it is a child of that body. Empty otherwise.
    """
    bpy.context.view_layer.update()
    whole = following.whole_of(owner)
    new = whole is None
    if new:
        whole = _begun(owner)
    deleted.let_go(whole)
    parts.note(part, whole, depth=lies.depth, reach=lies.reach, twin=lies.twin)
    following.attach(whole, part)
    showing.reveal(part, seen=False)
    bpy.context.view_layer.update()
    following.update(whole)
    if not whole.gridmesh_joined.problem:
        return ""
    problem = whole.gridmesh_joined.problem
    _let_go(whole, part)
    showing.reveal(part, seen=True)
    if new:
        _dissolve(whole, owner)
        following.hang(part, owner)
    else:
        following.hang(part, whole)
        following.update(whole)
    bpy.context.view_layer.update()
    return problem


def add_like(other: bpy.types.Object, bodies: list[bpy.types.Object]) -> None:
    """Join bodies that a part fell into to the whole of that part, if it is one."""
    whole = following.whole_of(other)
    if whole is None or whole == other:
        return
    for ob in bodies:
        if not any(part.ob == ob for part in whole.gridmesh_joined.parts):
            following.attach(whole, ob)
            options, own = ob.gridmesh_part, other.gridmesh_part
            options.reach, options.lies_at = own.reach, own.depth
            options.depth, options.twin = own.depth, own.twin
        showing.reveal(ob, seen=other.visible_get())


def _begun(first: bpy.types.Object) -> bpy.types.Object:
    """Make a whole of one part, where that is; the part stays, hidden."""
    with engine.resting():
        whole = beside(first, first.data.copy())
    whole.name = NAME
    following.remember(whole, [first], joining.Options())
    following.hang(first, whole)
    whole.gridmesh_joined.digest = ""
    showing.reveal(first, seen=False)
    return whole


def split(part: bpy.types.Object) -> list[bpy.types.Object]:
    """Take a part out of its whole; return it, a body of its own again, and its twin if it had one.

    A whole of which one part is left is that part again.
    """
    whole = following.whole_of(part)
    deleted.let_go(whole)
    _let_go(whole, part)
    twin = _own_twin(whole, part) if part.gridmesh_part.twin else None
    following.hang(part, whole.parent)
    made = [part] if twin is None else [part, twin]
    for ob in made:
        ob.property_unset("gridmesh_part")
        showing.reveal(ob, seen=True)
    bpy.context.view_layer.update()
    rest = following.parts_of(whole)
    if len(rest) == 1 and rest[0].parent == whole and not rest[0].gridmesh_part.twin:
        _dissolve(whole, rest[0])
    else:
        following.update(whole)
    for ob in reversed(made):
        showing.choose(ob)
    for ob in made:
        ob.select_set(True)
    return made


def apply(ob: bpy.types.Object, *, keep_parts: bool) -> None:
    """Make a plain mesh of a joined body (or of that of a part). Its parts are removed, or bodies of their own, as twins are then."""
    whole = following.whole_of(ob)
    deleted.let_go(whole)
    if keep_parts:
        for part in following.parts_of(whole):
            if part.parent == whole and part.gridmesh_part.twin:
                twin = _own_twin(whole, part)
                twin.property_unset("gridmesh_part")
                showing.reveal(twin, seen=True)
    following.apply(ob, keep_parts=keep_parts)


def pick(part: bpy.types.Object) -> None:
    """Show a part over its whole, to be moved, edited or deleted, and hide the others that were picked."""
    whole = following.whole_of(part)
    if whole is None:  # of a copy, and a body of its own again
        showing.reveal(part, seen=True)
        showing.choose(part)
        return
    for other in following.parts_of(whole):
        if other != part and other.visible_get() and whole.visible_get():
            showing.reveal(other, seen=False)
    if whole.visible_get():
        showing.reveal_wire(part)
    else:
        showing.reveal(part, seen=True)
    showing.choose(part)


def nearest(whole: bpy.types.Object, point: Vector) -> bpy.types.Object | None:
    """Part of a whole whose surface, or whose twin's, is nearest to a point of the world."""
    found = []
    for part, place in following.placed(whole):
        if len(part.data.polygons):
            hit, local, _, _ = part.closest_point_on_mesh(place.inverted() @ point)
            if hit:
                found.append(((place @ local - point).length, part.name, part))
    return min(found)[2] if found else None


def _let_go(whole: bpy.types.Object, part: bpy.types.Object) -> None:
    """Take a part out of the list of a whole."""
    entries = whole.gridmesh_joined.parts
    for at in reversed(range(len(entries))):
        if entries[at].ob == part:
            entries.remove(at)


def _own_twin(whole: bpy.types.Object, part: bpy.types.Object) -> bpy.types.Object:
    """Make an object of the twin of a part, with an outline of its own."""
    place = parts.twin_of(parts.frame(whole), part.matrix_world)
    with engine.resting():
        twin = part.copy()
        twin.data = part.data.copy()
        for collection in part.users_collection:
            collection.objects.link(twin)
    twin.matrix_world = place
    following.hang(twin, whole.parent)
    family.mend()
    return twin


def _dissolve(whole: bpy.types.Object, only: bpy.types.Object) -> None:
    """Remove a whole of which one part is left; what hangs on it hangs on that."""
    following.hang(only, whole.parent)
    for child in list(whole.children):
        if child != only:
            following.hang(child, only)
    showing.reveal(only, seen=True)
    only.property_unset("gridmesh_part")
    mesh = whole.data
    bpy.data.objects.remove(whole)
    if not mesh.users:
        bpy.data.meshes.remove(mesh)
