# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies of GridMesh 0.1.0, which lay beside their outlines: brought into the frame of today, once, in place.

They remember no frame but in which plane of the world they were made. Their meshes stay as they are, to the bit.
"""

from __future__ import annotations

import bpy
import numpy as np

from ..data import frames, meshes, written
from . import engine, family
from .reading import LostError, sketch_of
from .solve import ALGORITHM

message = ""
"""What was done to the file that is open; empty if nothing."""


def migrate() -> str:
    """Migrate all bodies of this file that have no frame; return what is to be told, or ""."""
    global message
    old = [ob for ob in family.bodies() if frames.stored(ob) is None and ob.library is None]
    message = ""
    if old:
        with engine.resting():
            bpy.context.view_layer.update()
            nested = sum(_migrate(ob) for ob in old)
            bpy.context.view_layer.update()
        message = (
            f"Live bodies of GridMesh 0.1.0: {len(old)}. Outlines that are now inside their bodies: {nested}"
        )
        print(f"GridMesh: {message}")
    return message


def _migrate(ob: bpy.types.Object) -> bool:
    """Give a body its frame; return whether its outline has become a part of it."""
    live = ob.gridmesh_live
    source, link = live.source, ob.get(meshes.LINK)
    values = np.array(list(link.get("matrix", ())), float) if hasattr(link, "get") else np.zeros(0)
    place = values.reshape(4, 4) if values.size == 16 else np.array(ob.matrix_world)
    if not ob.data.gridmesh_made:
        written.sign(ob.data)
    live.plane = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]
    if meshes.LINK in ob:
        del ob[meshes.LINK]
    if source is None:
        frames.remember(ob, np.eye(4))
        return False
    followed = _in_step(ob, place)
    frames.remember(ob, np.linalg.inv(place) @ frames.carrier_world(source, live.layer))
    nested = _made_by_tool(source, ob)
    if nested:
        source.gridmesh_outline, source.hide_render = True, True
        frames.nest(source, ob, frames.stored(ob))
        source.name = source.data.name = f"{ob.name} Outline"
    elif live.enabled:
        frames.carry(ob, source, live.layer)
    if followed:
        sketch = sketch_of(ob, bpy.context.evaluated_depsgraph_get())
        live.digest = engine.fingerprint(live, sketch)
    return nested


def _in_step(ob: bpy.types.Object, place: np.ndarray) -> bool:
    """Whether the mesh of an old body is that of its stroke, as the fingerprint says that it remembers."""
    live = ob.gridmesh_live
    if not live.digest or live.algorithm != ALGORITHM:
        return False
    frames.remember(ob, frames.carrier_world(live.source, live.layer))
    live.plane = [*place[:3, 3], *place[:3, :3].T.ravel()]
    try:
        sketch = sketch_of(ob, bpy.context.evaluated_depsgraph_get())
    except LostError:
        return False
    finally:
        live.plane = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]
    return engine.fingerprint(live, sketch) == live.digest


def _made_by_tool(source: bpy.types.Object, ob: bpy.types.Object) -> bool:
    """Whether a drawing is the outline of one body alone, as the tool of 0.1.0 made them, and may become its child."""
    layers = source.data.layers if source.type == "GREASEPENCIL" else ()
    return (
        [layer.name for layer in layers] == ["Outline"]
        and source.name.startswith("Outline")
        and layers[0].parent is None
        and source.parent is None
        and source.library is None
        and source not in frames.ancestors(ob)
        and family.bodies(source) == [ob]
    )
