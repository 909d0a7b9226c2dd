# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies that have become a part of another: they go, with their strokes; what hung on them stays."""

from __future__ import annotations

import bpy
from mathutils import Matrix

from ..data import frames
from ..live import engine
from .pencil import erase
from .shapes import Drawn

Place = tuple[bpy.types.Object, Matrix]
"""An object and where it is in the world."""


def indices(drawn: Drawn) -> list[int]:
    """Strokes of a body in its layer: its outline and its holes."""
    return [one.stroke.index for one in (drawn.sketch, *drawn.sketch.holes)]


def same_layer(one: Drawn, other: Drawn) -> bool:
    """Whether the strokes of two bodies are in one layer."""
    mine, others = one.ob.gridmesh_live, other.ob.gridmesh_live
    return mine.source == others.source and mine.layer == others.layer


def absorb(others: list[Drawn], kept: Drawn) -> list[Place]:
    """Take bodies away that are now a part of another; return what hung on them and where it is.

    kept : the body that goes on; strokes in its layer are left to whoever writes it.
    """
    ob = kept.ob
    orphans: list[Place] = []
    for other in others:
        gone = other.ob
        source, layer = gone.gridmesh_live.source, gone.gridmesh_live.layer
        own = frames.owned(gone) is not None
        orphans += [
            (child, child.matrix_world.copy()) for child in gone.children if child not in (source, ob)
        ]
        for child in (ob, source):
            if child.parent == gone and not (own and child == source):
                place = child.matrix_world.copy()
                child.parent = gone.parent
                child.matrix_world = place
        elsewhere = not own and not same_layer(other, kept)
        numbers = indices(other)
        engine.freeze(gone)
        mesh = gone.data
        bpy.data.objects.remove(gone)
        if not mesh.users:
            bpy.data.meshes.remove(mesh)
        if elsewhere:
            erase(source, layer, numbers)
    return [(child, place) for child, place in orphans if _alive(child)]


def adopt(ob: bpy.types.Object, children: list[Place]) -> None:
    """Make objects children of a body; they stay where they were."""
    for child, place in children:
        child.parent = ob
        child.matrix_world = place


def _alive(ob: bpy.types.Object) -> bool:
    """Whether an object was not removed meanwhile."""
    try:
        return bool(ob.name)
    except ReferenceError:
        return False
