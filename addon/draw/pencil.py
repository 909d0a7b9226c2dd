# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes in layers of drawings, and the bodies that know them by number."""

from __future__ import annotations

from typing import Any

import bpy

from ..live import engine


def layer_of(source: bpy.types.Object, name: str) -> Any:
    """Layer of a drawing by its name."""
    return next(layer for layer in source.data.layers if layer.name == name)


def renumber(source: bpy.types.Object, name: str, gone: list[int], new: int = 0) -> int:
    """Tell the bodies of a layer that strokes go, and `new` come after the others; return how many stay.

    The strokes themselves go when the layer is written. Bodies of strokes that go are left alone.
    """
    count = len(layer_of(source, name).current_frame().drawing.strokes)
    kept = [index for index in range(count) if index not in gone]
    for ob in engine.bodies(source):
        live = ob.gridmesh_live
        if live.layer != name:
            continue
        if live.stroke in kept:
            live.stroke = kept.index(live.stroke)
        live.count = len(kept) + new
    return len(kept)


def erase(source: bpy.types.Object, name: str, gone: list[int]) -> None:
    """Take strokes out of a layer; a drawing that is empty then goes, and what hung on it stays where it is."""
    renumber(source, name, gone)
    drawing = layer_of(source, name).current_frame().drawing
    drawing.remove_strokes(indices=sorted(gone))
    drawing.tag_positions_changed()
    if any(len(frame.drawing.strokes) for layer in source.data.layers for frame in layer.frames):
        return
    for child in source.children:
        place = child.matrix_world.copy()
        child.parent = source.parent
        child.matrix_world = place
    data = source.data
    bpy.data.objects.remove(source)
    if not data.users:
        bpy.data.batch_remove([data])
