# SPDX-License-Identifier: GPL-3.0-or-later
"""Joined bodies that follow their parts: these stay, hidden, and the whole is made anew when one of them has changed.

The parts are children of the whole, so that moving it moves them. How they lie to it, their shapes and the options make a fingerprint;
the whole is joined anew where that is another one, when changes have ended: from a timer, since data blocks are made.
"""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter
from typing import Any

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatVectorProperty, PointerProperty, StringProperty

from .. import api
from ..data import frames, listening, written
from ..live import engine
from . import blending, deleted, drafts, joining, leftover, lying, marks, parts, showing, transforms
from .lying import GridMeshPart, fingerprint, parts_of, placed
from .parts import is_whole
from .showing import choose, reveal
from .uniting import JoinError

BY_HAND = "its mesh was changed by hand; undo that, or apply the join"
"""Why a whole does not follow whose mesh is not what was made of its parts."""

GONE = "its parts are gone; undo that, or apply the join"
"""Why a whole does not follow that has no part left."""

_LOOKED_AT = (bpy.types.Object, bpy.types.Mesh, bpy.types.Collection, bpy.types.Scene)
"""What Blender names when parts change, or objects come and go."""

_since = 0.0
"""When something was seen to change last; 0 while nobody looks."""

_known: bool | None = None
"""Whether there are any in the file; None: to be looked for."""


def _changed(joined: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    if not joined.quiet and engine.awake():
        update(joined.id_data)


class GridMeshJoined(bpy.types.PropertyGroup):
    """What a joined body remembers of how it was made. Pointers to the parts outlive renaming and duplicating"""  # noqa: D400

    parts: CollectionProperty(type=GridMeshPart, options={"HIDDEN"})
    blend: blending.blend(update=_changed)
    edge_length: blending.edge_length(update=_changed)
    strict: blending.strict(update=_changed)
    quiet: BoolProperty(options={"HIDDEN"})
    digest: StringProperty(options={"HIDDEN"})
    """Fingerprint of what it was made of."""
    made: StringProperty(options={"HIDDEN"})
    """Fingerprint of the mesh that was made. Undo may bring one of the two back without the other."""
    problem: StringProperty(options={"HIDDEN"})
    """Why it does not follow now."""
    space: FloatVectorProperty(size=16, options={"HIDDEN"})
    """What was applied to it: from the space that its parts lie in to that of the object; see `parts.frame`. All 0: nothing."""


def wholes() -> list[bpy.types.Object]:
    """All of them. Walks all objects of the file."""
    return [ob for ob in bpy.data.objects if ob.type == "MESH" and is_whole(ob)]


def remember(ob: bpy.types.Object, objects: Sequence[bpy.types.Object], options: joining.Options) -> None:
    """Let a joined body follow its parts from now on."""
    global _known
    joined = ob.gridmesh_joined
    joined.quiet = True
    joined.blend, joined.edge_length, joined.strict = (
        options.blend,
        options.edge_length or 0.0,
        options.strict,
    )
    joined.quiet = False
    joined.parts.clear()
    bpy.context.view_layer.update()
    for part in objects:
        attach(ob, part)
    bpy.context.view_layer.update()
    joined.digest = fingerprint(ob)
    written.sign(ob.data)
    joined.made = ob.data.gridmesh_made
    _known = True


def attach(ob: bpy.types.Object, part: bpy.types.Object) -> None:
    """Make an object a part of a whole, and a child of it unless it hangs on something else; it stays where it is."""
    ob.gridmesh_joined.parts.add().ob = part
    drawing = part.gridmesh_live.source if frames.is_linked(part) else None
    if part.parent is None or part.parent == drawing:
        hang(part, ob)


def hang(part: bpy.types.Object, above: bpy.types.Object | None) -> None:
    """Give an object another parent, or none; it stays where it is."""
    place = part.matrix_world.copy()
    part.parent, part.parent_type = above, "OBJECT"
    if above is not None:
        part.matrix_parent_inverse = above.matrix_world.inverted()
    part.matrix_world = place


def changes(ob: bpy.types.Object) -> bool:
    """Whether an object changes by itself: it follows a drawing, or its own parts."""
    return frames.is_linked(ob) or is_whole(ob)


def whole_of(ob: bpy.types.Object) -> bpy.types.Object | None:
    """Return the joined body that an object is, or hangs on as a part of it; None if there is none."""
    if ob.type == "MESH" and is_whole(ob):
        return ob
    above = ob.parent
    if above is None or above.type != "MESH" or not is_whole(above):
        return None
    return above if any(part.ob == ob for part in above.gridmesh_joined.parts) else None


def apply(ob: bpy.types.Object, *, keep_parts: bool) -> None:
    """Make a plain mesh of a joined body (or of that of a part). Its parts are removed, or shown again and on their own."""
    whole = whole_of(ob)
    found = [part for part in parts_of(whole) if whole_of(part) in (whole, part)]
    own = [part for part in found if part.parent == whole]
    for other in wholes():
        lying.note(other)
    show(whole)
    whole.property_unset("gridmesh_joined")
    whole.data.property_unset("gridmesh_made")
    if not keep_parts:
        shared = [part for part in own if lying.others(whole, part)]
        discard([part for part in own if part not in shared])
        with engine.resting():
            for part in shared:
                part.parent = None
            for other in wholes():
                lying.take_in(other)
        return
    with engine.resting():
        for part in own:
            place = part.matrix_world.copy()
            part.parent = None
            part.matrix_world = place
            part.gridmesh_part.held = False
            reveal(part, seen=True)


def hidden_parts(objects: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Parts of those of some objects that are joined bodies, as far as they are nobody else's to be seen."""
    own = [part for ob in objects if is_whole(ob) for part in parts_of(ob) if part.parent == ob]
    return [part for part in own if part not in objects and not part.visible_get()]


def discard(objects: Sequence[bpy.types.Object]) -> None:
    """Remove parts whose whole has become something else."""
    with engine.resting():
        for part in objects:
            _remove(part)


def swap(ob: bpy.types.Object) -> None:
    """Show the parts of a joined body instead of it, or it instead of them."""
    whole = whole_of(ob)
    if not whole.visible_get():
        show(whole)
        refresh()
        return
    found = parts_of(whole)
    for part in found:
        reveal(part, seen=True)
    reveal(whole, seen=False)
    if found:
        choose(found[0])


def show(whole: bpy.types.Object) -> None:
    """Show a joined body and hide its parts."""
    reveal(whole, seen=True)
    for part in parts_of(whole):
        reveal(part, seen=False)
    choose(whole)


def _remove(part: bpy.types.Object) -> None:
    engine.freeze(part)
    mesh = part.data
    bpy.data.objects.remove(part)
    if not mesh.users:
        bpy.data.meshes.remove(mesh)


def _tell(joined: bpy.types.PropertyGroup, problem: str) -> None:
    """Say at once that a whole will not follow since its mesh was changed or its parts are gone, and no longer once that was undone."""
    if (problem or joined.problem in (BY_HAND, GONE)) and joined.problem != problem:
        joined.problem = problem


def update(ob: bpy.types.Object) -> bool:
    """Join a whole anew if its parts or options have changed; say whether that was done."""
    joined, by_hand = ob.gridmesh_joined, transforms.changed_by_hand(ob)
    found, now = placed(ob), fingerprint(ob)
    if not ob.is_editable or written.is_edited(ob):
        return False
    if not found:
        _tell(joined, GONE)
        return False
    if marks.is_same(now, joined.digest) and joined.made in ("", ob.data.gridmesh_made):
        _tell(joined, BY_HAND if by_hand else "")
        return False
    if by_hand:
        joined.problem = BY_HAND
        return False
    options = joining.Options(joined.blend, joined.edge_length or None, joined.strict)
    joined.digest, joined.made = now, ob.data.gridmesh_made
    try:
        joining.again(bpy.context, ob, found, options)
    except (JoinError, api.NativeError) as error:
        joined.problem = str(error)
        return False
    joined.problem = ""
    drafts.forget(ob)
    written.sign(ob.data)
    joined.made = ob.data.gridmesh_made
    return True


def refresh() -> int:
    """Join every whole anew whose parts have changed; return how many were."""
    if not engine.awake() or not any_there():
        return 0
    bpy.context.view_layer.update()
    for ob in wholes():
        deleted.put_aside(ob)
        lying.note(ob)
        lying.take_in(ob)
        leftover.hold(ob, parts_of(ob))
    leftover.remove()
    bpy.context.view_layer.update()
    return sum(update(ob) for ob in wholes())


def any_there() -> bool:
    """Whether there is a whole in the file, or what is left of one, as far as is known."""
    global _known
    if _known is None:
        _known = bool(wholes() or leftover.found())
    return _known


@bpy.app.handlers.persistent
def _on_change(_scene: Any, depsgraph: bpy.types.Depsgraph) -> None:
    if not any_there() or not engine.awake() or bpy.app.background:
        return
    if any(isinstance(update.id, _LOOKED_AT) for update in depsgraph.updates):
        _soon()


@bpy.app.handlers.persistent
def _on_other_time(*_: Any) -> None:
    """After undo, redo and opening a file."""
    global _known, _since
    _known, _since = None, 0.0
    drafts.forget()
    if any_there() and not bpy.app.background:
        _soon()


@bpy.app.handlers.persistent
def _on_load(*_: Any) -> None:
    transforms.forget()
    _on_other_time()
    for ob in wholes():
        deleted.let_go(ob)


@bpy.app.handlers.persistent
def _on_save(*_: Any) -> None:
    refresh()


@bpy.app.handlers.persistent
def _on_import(*_: Any) -> None:
    """After appending: what was hidden in a view layer, which stays behind, is hidden in this one."""
    _on_other_time()
    there = bpy.context.view_layer.objects
    for whole in wholes():
        for part in parts_of(whole):
            if part.hide_render and part.name in there and not part.hide_get():
                reveal(part, seen=False)


def _soon() -> None:
    """Look at the wholes from now on, until nothing has changed for a moment."""
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=0.0)


def _look() -> float | None:
    """Timer: show changes as drafts; join anew once they have ended, bodies are made in full and no tool is running."""
    global _since
    if not engine.awake():
        return 0.1
    if not engine.tool_runs():
        showing.put_away(wholes())
    drawn = [draft(ob) for ob in wholes()]
    if any(drawn) or not _since:
        _since = perf_counter()
    if perf_counter() - _since < engine.PAUSE or engine.tool_runs() or engine.unsettled():
        return drafts.OFTEN
    _since = 0.0
    refresh()
    return None


def draft(ob: bpy.types.Object) -> bool:
    """Show a whole whose parts have changed as these together, which is quick; say whether there was anything new."""
    if not ob.is_editable or not ob.visible_get() or written.is_edited(ob):
        return False
    by_hand = transforms.changed_by_hand(ob)
    lying.note(ob)
    found, now = placed(ob), fingerprint(ob)
    if not found or by_hand:
        return False
    if marks.is_same(now, ob.gridmesh_joined.digest) or marks.is_same(now, drafts.shown(ob)):
        return False
    return drafts.show(ob, found, now)


def _handlers() -> list[tuple[list[Any], Any]]:
    on = bpy.app.handlers
    return [
        (on.depsgraph_update_post, _on_change),
        (on.undo_post, _on_other_time),
        (on.redo_post, _on_other_time),
        (on.load_post, _on_load),
        (on.blend_import_post, _on_import),
        (on.save_pre, _on_save),
    ]


classes = (GridMeshPart, GridMeshJoined, *parts.classes)


def register() -> None:
    """Give objects what they remember, and start to listen."""
    global _known
    _known = None
    parts.register()
    bpy.types.Object.gridmesh_joined = PointerProperty(type=GridMeshJoined)
    listening.start(_handlers())


def unregister() -> None:
    """Stop; joined bodies stay as they are."""
    listening.stop(_handlers(), _look)
    if hasattr(bpy.types.Object, "gridmesh_joined"):
        del bpy.types.Object.gridmesh_joined
    parts.unregister()
