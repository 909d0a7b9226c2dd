# SPDX-License-Identifier: GPL-3.0-or-later
"""What is to be seen of a joined body: it, or its parts instead of it, or it and the wire of a part that was picked.

What is hidden is not rendered either, and the wire of a part is not. So it is seen of an object whether it is shown here, or by Blender's
own *Show Hidden Objects*, which would lay all parts over their whole.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ..data import frames
from .lying import parts_of
from .parts import is_held, is_whole


def reveal(ob: bpy.types.Object, *, seen: bool) -> None:
    """Show or hide an object, with the outline of its own if it has one."""
    ob.hide_set(not seen)
    ob.hide_render = not seen
    if _is_wire(ob):
        ob.display_type = "TEXTURED"
    outline = _outline(ob)
    if outline is not None and outline.name in bpy.context.view_layer.objects:
        outline.hide_set(not seen)


def reveal_wire(part: bpy.types.Object) -> None:
    """Show a part over its whole."""
    reveal(part, seen=True)
    part.hide_render, part.display_type = True, "WIRE"


def choose(ob: bpy.types.Object) -> None:
    """Make an object the only one that is selected, and the active one."""
    layer = bpy.context.view_layer
    for other in filter(None, list(layer.objects.selected)):
        other.select_set(False)
    ob.select_set(True)
    layer.objects.active = ob


def put_away(wholes: Iterable[bpy.types.Object]) -> None:
    """Hide what is seen without being meant to be.

    Parts that were picked and are no longer selected; where Blender showed all that was hidden, parts over their whole, or a whole over
    its parts. A single part that was shown so, by its eye in the outliner, is picked.
    """
    for whole in wholes:
        if not whole.visible_get() or not whole.is_editable:
            continue
        own = [part for part in parts_of(whole) if part.parent == whole and part.is_editable]
        seen = [part for part in own if part.visible_get()]
        if whole.hide_render and any(not part.hide_render for part in seen):
            reveal(whole, seen=False)
            continue
        shown = [part for part in seen if part.hide_render and not _is_wire(part)]
        if len(shown) == 1 and len(own) > 1 and not _in_use(shown[0]):
            reveal_wire(shown[0])
            choose(shown[0])
            shown = []
        for part in seen:
            if part in shown or (_is_wire(part) and not _in_use(part)):
                reveal(part, seen=False)


def _in_use(part: bpy.types.Object) -> bool:
    """Whether a part or its outline is selected or being edited."""
    return any(ob is not None and (ob.select_get() or ob.mode != "OBJECT") for ob in (part, _outline(part)))


def _is_wire(ob: bpy.types.Object) -> bool:
    """Whether it is a part that was picked."""
    return ob.display_type == "WIRE" and (is_held(ob) or not is_whole(ob))


def _outline(ob: bpy.types.Object) -> bpy.types.Object | None:
    return frames.owned(ob) if frames.is_linked(ob) else None
