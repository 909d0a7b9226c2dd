# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects joined to one closed body: what the operator, the command line and the drawing of strokes do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import bpy

from .. import api
from ..data import defaults
from ..data.placing import Transaction
from ..text.messages import counted
from . import uniting
from .joinobject import Target
from .parts import Placed


@dataclass(frozen=True)
class Options:
    """How parts are joined."""

    blend: float = defaults.BLEND
    edge_length: float | None = None
    strict: bool = False
    keep_parts: bool = False


@dataclass
class Done:
    """What came of it."""

    ob: bpy.types.Object
    parts: int
    report: dict[str, Any]
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def result(self, seconds: float) -> str:
        """The numbers, as they are told."""
        irregular = counted(self.report["irregular"], "irregular vertex")
        return (
            f"Joined {counted(self.parts, 'part')}: {_faces(self.ob)}, {irregular}, {1000 * seconds:.0f} ms"
        )


def join(
    context: bpy.types.Context,
    objects: Sequence[bpy.types.Object],
    options: Options,
    progress: api.Progress | None = None,
) -> Done:
    """Join mesh objects, or overlapping pieces of one, to one closed body in the first, which becomes the only one selected.

    Raises
    ------
    uniting.JoinError, api.NativeError, api.CancelledError
        The scene is as before.
    """
    api.native("join")
    with Transaction() as transaction:
        target = Target(objects, transaction)
        notes = _notes(target, options)
        made = _united(target, options, progress)
        if len(objects) == 1 and not made.report["overlapping"]:
            raise uniting.JoinError(
                f"'{objects[0].name}' is the only mesh, and none of its pieces overlap; select another one as well",
                "one_part",
            )
        crease = options.blend == 0
        ob = target.apply(context, made, transaction, crease=crease, keep=options.keep_parts)
    if made.report["overlapping"]:
        notes.append(f"overlapping pieces of meshes, joined like parts: {made.report['overlapping']}")
    if made.report["separated"]:
        notes.append(f"vertices added where faces met in one point or edge alone: {made.report['separated']}")
    return Done(ob, len(objects), made.report, notes, uniting.warnings_of(made.report))


def again(
    context: bpy.types.Context,
    ob: bpy.types.Object,
    placed: Sequence[Placed],
    options: Options,
) -> None:
    """Give an object the mesh that is joined of other objects, each taken to be somewhere; these stay. Raises as `join`."""
    api.native("join")
    objects, places = zip(*placed, strict=True)
    with Transaction() as transaction:
        target = Target(objects, transaction, ob.matrix_world, places)
        made = _united(target, options, None)
        target.replace(context, made, ob, crease=options.blend == 0)


def _united(target: Target, options: Options, progress: api.Progress | None) -> uniting.United:
    return uniting.unite(
        target.parts,
        blend=options.blend,
        edge_length=options.edge_length,
        strict=options.strict,
        colors=target.colors,
        progress=progress,
    )


def _notes(target: Target, options: Options) -> list[str]:
    notes = []
    turned = [source.ob.name for source in target.sources if source.was_inside_out]
    if turned:
        notes.append(f"inside out, and turned round: {', '.join(turned)}")
    modified = [ob.name for ob in target.objects[1:] if len(ob.modifiers)]
    if modified:
        notes.append(f"joined without their modifiers: {', '.join(modified)}")
    if target.live and not options.keep_parts:
        notes.append(f"frozen, since a joined body cannot follow its drawings: {', '.join(target.live)}")
    return notes


def _faces(ob: bpy.types.Object) -> str:
    sides = [len(polygon.vertices) for polygon in ob.data.polygons]
    triangles, quads = sides.count(3), sides.count(4)
    others = len(sides) - triangles - quads
    made = [
        counted(quads, "quad") if quads else "",
        counted(triangles, "triangle") if triangles else "",
        counted(others, "polygon") if others else "",
    ]
    return " and ".join(filter(None, made))
