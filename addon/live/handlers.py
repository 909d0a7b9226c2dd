# SPDX-License-Identifier: GPL-3.0-or-later
"""When bodies are looked at: after changes, steps back and forth, opening, saving; never during a render.

Handlers never make data blocks: that would change the dependency graph that is calling them. What needs that waits for a
timer, in the window; in the background it waits for `engine.settle`.
"""

from __future__ import annotations

from typing import Any

import bpy

from ..bodies import strokes
from ..data import frames, listening, written
from . import applied, engine, family, migration

_DRAWINGS = tuple(
    getattr(bpy.types, name)
    for name in ("Curve", "Curves", "GreasePencilv3", "GreasePencil")
    if hasattr(bpy.types, name)
)

_ARRANGED = (bpy.types.Scene, bpy.types.Collection)
"""What Blender names when objects come, go, are hidden, or change their collection."""


@bpy.app.handlers.persistent
def _on_change(_scene: Any, depsgraph: bpy.types.Depsgraph) -> None:
    """Let bodies follow whose drawing, or whose own properties, were changed."""
    if not engine.awake() or family.nobody():
        return
    sources, drawings, own = [], [], []
    arranged = new = False
    for update in depsgraph.updates:
        changed = update.id
        if isinstance(changed, _DRAWINGS):
            drawings.append(changed.original)
        elif isinstance(changed, bpy.types.Object):
            ob = changed.original
            if ob.type in strokes.SOURCE_TYPES:
                sources.append(ob)
            elif ob.type == "MESH" and frames.is_linked(ob):
                new |= family.meet(ob)
                own.append((ob, update.is_updated_geometry or update.is_updated_shading))
        elif isinstance(changed, _ARRANGED):
            arranged = True
    gone = family.miss()
    followers = family.known()
    _take_over(followers, [ob for ob in sources if ob.data in drawings], [ob for ob, shaped in own if shaped])
    for ob in _concerned(followers, sources, drawings, own):
        engine.follow(ob, depsgraph)
    apart = any(frames.astray(ob) for ob in sources)
    for ob, _ in own:
        family.note_place(ob)
        applied.note(ob)
    for ob in sources:
        applied.note(ob)
    if arranged or new or apart or gone:
        _mend_soon()


def _take_over(
    followers: list[bpy.types.Object], sources: list[bpy.types.Object], shaped: list[bpy.types.Object]
) -> None:
    """Keep bodies in place where transforms were applied to them, or to the drawings that carry them."""
    with engine.resting():
        for ob in shaped:
            applied.absorb(ob)
        for ob in followers:
            if ob.gridmesh_live.source in sources:
                applied.reframe(ob)


def _concerned(
    followers: list[bpy.types.Object],
    sources: list[bpy.types.Object],
    drawings: list[bpy.types.ID],
    own: list[tuple[bpy.types.Object, bool]],
) -> list[bpy.types.Object]:
    """Bodies that may have to be made anew; one that was only moved has not."""
    found = [ob for ob, shaped in own if shaped]
    if sources or drawings:
        for ob in followers:
            source = ob.gridmesh_live.source
            if source is None or ob in found:
                continue
            if source.data in drawings or (source in sources and engine.lies_otherwise(ob)):
                found.append(ob)
    return found


def _mend_soon() -> None:
    if not bpy.app.background and not bpy.app.timers.is_registered(_mend):
        bpy.app.timers.register(_mend, first_interval=0.0)


def _mend() -> float | None:
    """Timer: bring bodies and drawings in order, once no tool is running."""
    if not engine.awake() or engine.tool_runs():
        return 0.1
    for ob in family.mend():
        engine.touch(ob)
    return None


@bpy.app.handlers.persistent
def _before_undo(*_: Any) -> None:
    family.forget(everything=False)


@bpy.app.handlers.persistent
def _on_undo(*_: Any) -> None:
    """After a step back or forth strokes and bodies may be of different times."""
    family.forget(everything=False)
    if not engine.awake():
        engine.forget()
        return
    bpy.context.evaluated_depsgraph_get()
    with engine.resting():
        for ob in family.known():
            applied.absorb(ob)
            applied.reframe(ob)
    engine.forget()
    if bpy.app.background:
        family.mend()
    else:
        _mend_soon()
    engine.refresh()
    for ob in family.bodies():
        applied.look(ob)


@bpy.app.handlers.persistent
def _on_load(*_: Any) -> None:
    """A file that was opened is left as it is until something is changed; one of 0.1.0 is brought into shape."""
    engine.forget()
    family.forget(everything=True)
    applied.forget()
    migration.migrate()
    if not family.nobody():
        bpy.context.view_layer.update()  # nothing knows yet where it is
    for ob in family.bodies():
        family.claim(ob)
        applied.look(ob)


@bpy.app.handlers.persistent
def _on_import(*_: Any) -> None:
    """Bodies may have been appended or linked, where there were none."""
    family.forget(everything=False)
    for ob in family.bodies():
        written.by_hand(ob.data)  # remembers the mesh


@bpy.app.handlers.persistent
def _on_save(*_: Any) -> None:
    """What is saved is made in full."""
    if engine.unsettled():
        engine.refresh()


@bpy.app.handlers.persistent
def _on_render(*_: Any) -> None:
    engine.rendering = True


@bpy.app.handlers.persistent
def _after_render(*_: Any) -> None:
    engine.rendering = False


def _handlers() -> list[tuple[list[Any], Any]]:
    on = bpy.app.handlers
    return [
        (on.depsgraph_update_post, _on_change),
        (on.undo_pre, _before_undo),
        (on.redo_pre, _before_undo),
        (on.undo_post, _on_undo),
        (on.redo_post, _on_undo),
        (on.load_post, _on_load),
        (on.blend_import_post, _on_import),
        (on.save_pre, _on_save),
        (on.render_init, _on_render),
        (on.render_complete, _after_render),
        (on.render_cancel, _after_render),
    ]


def register() -> None:
    """Start to listen."""
    listening.start(_handlers())


def unregister() -> None:
    """Stop; bodies stay as they are."""
    listening.stop(_handlers(), _mend)
    family.forget(everything=True)
