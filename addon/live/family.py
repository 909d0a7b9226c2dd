# SPDX-License-Identifier: GPL-3.0-or-later
"""Which bodies there are, and how bodies and their drawings stay together when objects come and go.

`mend` brings in order what Blender does to the two apart: an outline that was given another parent is put back, a copy of
a body gets a copy of the outline, a body that was deleted takes its outline along, and one that is hidden hides it.
It makes and removes objects: call it between updates, never from a handler of the dependency graph.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy
import numpy as np
from mathutils import Matrix

from ..data import frames, placing
from ..data.frames import is_linked
from . import linework
from .reading import LostError, sketch_of


@dataclass
class _Memory:
    """What has been seen in this session; all keys are `session_uid`, which undo keeps."""

    bodies: dict[int, bpy.types.Object] | None = None
    """Objects with a link; None: not known, to be counted again."""
    shown: dict[int, tuple[bool, bool, tuple[str, ...]]] = field(default_factory=dict)
    """Whether each body was hidden, in both ways, and its collections."""
    places: dict[int, Matrix] = field(default_factory=dict)
    """Where bodies were that are the children of their drawing."""
    present: set[int] = field(default_factory=set)
    """Drawings that have been in a scene."""
    lost: dict[int, int] = field(default_factory=dict)
    """The drawing that each body has lost."""


_memory = _Memory()


def forget(*, everything: bool) -> None:
    """Forget references to objects, which undo makes invalid; with `everything` what was seen, too."""
    _memory.bodies = None
    if everything:
        _memory.shown.clear()
        _memory.places.clear()
        _memory.present.clear()
        _memory.lost.clear()


def bodies(source: bpy.types.Object | None = None) -> list[bpy.types.Object]:
    """Bodies that are linked (to `source`). Walks all objects of the file."""
    linked = [ob for ob in bpy.data.objects if ob.type == "MESH" and is_linked(ob)]
    return [ob for ob in linked if source is None or ob.gridmesh_live.source == source]


def known() -> list[bpy.types.Object]:
    """Bodies that were there when they were counted last, or that have changed since: cheap where there are none."""
    if _memory.bodies is None:
        _memory.bodies = {ob.session_uid: ob for ob in bodies()}
    return list(_memory.bodies.values())


def nobody() -> bool:
    """Whether there are no bodies, as far as is known; costs nothing."""
    if _memory.bodies is None:
        known()
    return not _memory.bodies


def miss() -> bool:
    """Count bodies out that were removed; say whether there were any."""
    there = _memory.bodies or {}
    gone = [uid for uid, ob in there.items() if not _valid(ob)]
    for uid in gone:
        del there[uid]
    return bool(gone)


def meet(ob: bpy.types.Object) -> bool:
    """Count a linked body in; say whether it is new."""
    if _memory.bodies is None or ob.session_uid in _memory.bodies:
        return False
    _memory.bodies[ob.session_uid] = ob
    return True


def _valid(ob: bpy.types.Object) -> bool:
    try:
        return is_linked(ob)
    except ReferenceError:
        return False  # it was removed


def writer(ob: bpy.types.Object) -> bpy.types.Object:
    """Return the one of the bodies with the same mesh and drawing that writes the mesh."""
    if ob.data.users < 2:
        return ob
    source = ob.gridmesh_live.source
    return _first([other for other in bodies(source) if other.data == ob.data], source)


def _first(group: list[bpy.types.Object], source: bpy.types.Object | None) -> bpy.types.Object:
    if source is not None and source.parent in group:
        return source.parent
    return min(group, key=lambda ob: ob.session_uid)


def note_place(ob: bpy.types.Object) -> None:
    """Remember where a body is that is the child of its drawing: it stays there when that is deleted."""
    source = ob.gridmesh_live.source
    if source is not None and ob.parent == source:
        _memory.places[ob.session_uid] = ob.matrix_world.copy()


def mend() -> list[bpy.types.Object]:
    """Bring bodies and drawings in order; see above. Cost: a look at each object of the file.

    Returns the bodies without a drawing, which should say so.
    """
    followers: dict[bpy.types.Object, list[bpy.types.Object]] = {}
    everybody = bodies()
    for ob in everybody:
        if _kept(ob):
            followers.setdefault(ob.gridmesh_live.source, []).append(ob)
    for source, group in followers.items():
        if source.gridmesh_outline:
            _mend_own(source, group)
        else:
            _mend_shared(group)
    _part_unlike(everybody)
    used = {ob.gridmesh_live.source for ob in everybody}
    for source in [ob for ob in bpy.data.objects if ob.type == "GREASEPENCIL" and ob.gridmesh_outline]:
        if source not in used and source.users_scene and _ours(source):
            _mend_unused(source)
    for ob in everybody:
        if frames.owned(ob) is not None and _ours(ob):
            _show_alike(ob, frames.owned(ob))
    return [ob for ob in everybody if ob.gridmesh_live.source is None]


def _ours(ob: bpy.types.Object) -> bool:
    return ob.library is None and ob.override_library is None


def _returned(ob: bpy.types.Object) -> bpy.types.Object | None:
    """The drawing that a body has lost, if undo has brought it back: Blender takes the body, alike in both steps, as it is."""
    lost = _memory.lost.get(ob.session_uid)
    if lost is None:
        return None
    drawings = (other for other in bpy.data.objects if other.session_uid == lost and other.users_scene)
    return next(drawings, None)


def _kept(ob: bpy.types.Object) -> bool:
    """Whether a body still has its drawing. One that was appended alone brings it into the scene."""
    live = ob.gridmesh_live
    source = live.source
    if not _ours(ob) or not ob.users_scene:
        return False
    if source is None:
        source = _returned(ob)
        if source is not None:
            live.source, live.problem = source, ""
    if source is not None and not source.users_scene:
        if source.session_uid in _memory.present or not _ours(source):
            _memory.lost[ob.session_uid] = source.session_uid
            live.source = None  # a deleted drawing is not kept alive by its bodies
        else:
            _join_collections(source, ob)
    if live.source is None:
        _stay(ob)
        return False
    _memory.present.add(source.session_uid)
    note_place(ob)
    return True


def _stay(ob: bpy.types.Object) -> None:
    """Leave a body where it was when the drawing that carried it was deleted."""
    place = _memory.places.pop(ob.session_uid, None)
    if ob.parent is not None and not ob.parent.users_scene:
        place, ob.parent = ob.matrix_world.copy(), None
    if place is not None and ob.parent is None:
        ob.matrix_world = place


def _mend_own(source: bpy.types.Object, group: list[bpy.types.Object]) -> None:
    """Leave an outline to one body, as its child, and give the others copies; who shares the mesh shares the outline."""
    first = _first(group, source)
    if source.parent not in group:  # of those that share it, the one that was given the same parent
        first = next((ob for ob in group if source.parent in frames.ancestors(ob)), first)
    above = frames.ancestors(first)
    if source.parent != first and _ours(source) and source not in above:
        matrix = frames.stored(first)
        elsewhere = source.parent is not None and source.parent not in above and not is_linked(source.parent)
        if matrix is not None and not elsewhere:
            frames.nest(source, first, matrix)
    for ob in group:
        if ob.data == first.data:
            continue
        copy = source.copy()
        copy.data = source.data.copy()
        _join_collections(copy, ob)
        matrix = frames.stored(ob)
        if matrix is not None:
            frames.nest(copy, ob, matrix)
        ob.gridmesh_live.source = copy
        _memory.present.add(copy.session_uid)


def _part_unlike(everybody: list[bpy.types.Object]) -> None:
    """Give bodies that share a mesh meshes of their own where each has an outline, and those lie in other ways."""
    meshes: dict[bpy.types.Mesh, list[bpy.types.Object]] = {}
    for ob in everybody:
        if (
            ob.data.users > 1
            and _ours(ob)
            and ob.data.library is None
            and ob.gridmesh_live.source is not None
        ):
            meshes.setdefault(ob.data, []).append(ob)
    for group in meshes.values():
        first = min(group, key=lambda ob: ob.session_uid)
        source, frame = first.gridmesh_live.source, frames.frame(first)
        for ob in group:
            other = ob.gridmesh_live.source
            if other == source:
                continue
            lies = frames.frame(ob)
            if other.data != source.data or np.abs(lies - frame).max() > 1e-5 * np.abs(frame).max():
                ob.data = ob.data.copy()
                ob.gridmesh_live.digest = first.gridmesh_live.digest = ""


def _mend_shared(group: list[bpy.types.Object]) -> None:
    """Give copies of the bodies of a drawing outlines of their own; who shares the mesh follows the same stroke."""
    owners = {}
    for ob in group:
        if ob.gridmesh_live.uid == _uid(ob):
            owners[_stroke(ob)] = ob
    for ob in group:
        if ob.gridmesh_live.uid == _uid(ob):
            continue
        owner = owners.get(_stroke(ob))
        if owner is not None and owner.data != ob.data:
            _give_outline(ob)
        claim(ob)


def claim(ob: bpy.types.Object) -> None:
    """Let a body know itself: a copy of it is another one."""
    if ob.gridmesh_live.uid != _uid(ob):
        ob.gridmesh_live.uid = _uid(ob)


def _uid(ob: bpy.types.Object) -> int:
    return ob.session_uid & 0x7FFFFFFF


def _stroke(ob: bpy.types.Object) -> tuple[str, int]:
    return ob.gridmesh_live.layer, ob.gridmesh_live.stroke


def _give_outline(ob: bpy.types.Object) -> None:
    """Make an outline of a body's own from the stroke that it shares."""
    live = ob.gridmesh_live
    try:
        sketch = sketch_of(ob, bpy.context.evaluated_depsgraph_get())
    except LostError:
        return
    with placing.Transaction() as transaction:
        source, count = linework.redrawn(transaction, sketch, ob.name, bpy.context.scene.frame_current)
        _join_collections(source, ob)
    frames.nest(source, ob, np.eye(4))
    frames.remember(ob, np.eye(4))
    live.source, live.layer, live.stroke, live.count = source, linework.LAYER, 0, count
    _memory.present.add(source.session_uid)


def _mend_unused(source: bpy.types.Object) -> None:
    """Take the outline of a deleted body away; a copy of an outline alone is a drawing like any other."""
    if source.parent is None:
        linework.remove(source)
    else:
        source.gridmesh_outline = False
        source.hide_render = False


def _join_collections(source: bpy.types.Object, ob: bpy.types.Object) -> None:
    for collection in ob.users_collection:
        if source.name not in collection.objects:
            collection.objects.link(source)


def _show_alike(ob: bpy.types.Object, source: bpy.types.Object) -> None:
    """Hide or show an outline, and move it to another collection, when that was done to its body."""
    layer = bpy.context.view_layer
    if layer.objects.get(ob.name) != ob:
        return
    now = ob.hide_get(), ob.hide_viewport, tuple(one.name for one in ob.users_collection)
    before = _memory.shown.setdefault(ob.session_uid, now)
    if now == before:
        return
    _memory.shown[ob.session_uid] = now
    if now[2] != before[2]:
        _join_collections(source, ob)
        for collection in source.users_collection:
            if collection.name not in now[2]:
                collection.objects.unlink(source)
    if now[1] != before[1]:
        source.hide_viewport = now[1]
    if layer.objects.get(source.name) == source and now[0] != before[0]:
        source.hide_set(now[0])
