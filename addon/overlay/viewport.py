# SPDX-License-Identifier: GPL-3.0-or-later
"""Irregular vertices as coloured dots in the viewport, and the numbers of the active mesh beside them."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..bodies.strokes import selected
from ..text.telling import told
from .quality import Quality, measure

MARGIN, LINE, ABOVE = 14, 18, 36
"""Pixels at scale 1; the last is the height of the redo panel's header."""

# By curvature: few edges are warm, many are cold, strong colours are two or more away from regular.
_COLOURS = ((0.95, 0.16, 0.12, 1.0), (1.0, 0.62, 0.1, 1.0), (0.2, 0.68, 1.0, 1.0), (0.35, 0.2, 0.95, 1.0))

_WORDS = {
    3: ("4 edges or fewer", "5 edges", "7 edges", "8 edges or more"),
    4: ("2 edges", "3 edges", "5 edges", "6 edges or more"),
    0: ("Far too few edges", "Too few edges", "Too many edges", "Far too many edges"),
}
"""What the colours mean where all faces have so many corners, inside a mesh; on borders, and of mixed faces, the last."""

notes: list[Any] = []
"""Functions from an object and the context to rows that are written below its numbers."""

_handles: list[Any] = []
_known: dict[int, tuple[Quality, np.ndarray, np.ndarray]] = {}
"""By the object's session uid: its numbers, and places and colours of its dots in its own space."""


def of_object(ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Quality:
    """Measure an object's mesh as it is seen, modifiers included."""
    return _look(ob, depsgraph)[0]


def _look(ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> tuple[Quality, np.ndarray, np.ndarray]:
    """Measure, and place the dots a little above the surface."""
    seen = ob.evaluated_get(depsgraph)
    mesh = seen.to_mesh()
    try:
        points = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.vertices.foreach_get("co", points)
        corners = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", corners)
        starts = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("loop_start", starts)
        normals = np.empty(len(mesh.vertices) * 3, np.float32)
        mesh.vertex_normals.foreach_get("vector", normals)
    finally:
        seen.to_mesh_clear()
    points, normals = points.reshape(-1, 3), normals.reshape(-1, 3)
    found = measure(points, corners, np.append(starts, len(corners)))
    size = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
    lift = 0.1 * size / max(1.0, np.sqrt(len(points)))
    at = found.irregular
    dots = np.ascontiguousarray(points[at] + lift * normals[at], np.float32)  # the only type that is drawn
    return found, dots, colours(found)


def kinds(found: Quality) -> np.ndarray:
    """Number (k,) of the colour of each irregular vertex."""
    strong = np.abs(found.curvature) > (
        0.3 if found.sides == 4 else 0.2
    )  # an edge is a sixth, of quads a fourth
    return np.where(found.curvature > 0, np.where(strong, 0, 1), np.where(strong, 3, 2))


def colours(found: Quality) -> np.ndarray:
    """Colours (k, 4) of irregular vertices."""
    return np.array(_COLOURS, np.float32)[kinds(found)]


def shown(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The meshes that get dots: those of the selection and the active one."""
    objects = selected(context)
    active = context.view_layer.objects.active
    if active is not None and active not in objects:
        objects.append(active)
    return [ob for ob in objects if ob.type == "MESH" and ob.visible_get()]


def forget(_scene: Any, depsgraph: bpy.types.Depsgraph | None = None) -> None:
    """Handler: what has changed is measured again when it is drawn next."""
    if depsgraph is None:
        _known.clear()
        return
    for update in depsgraph.updates:
        if update.is_updated_geometry and isinstance(update.id, bpy.types.Object):
            _known.pop(update.id.original.session_uid, None)


def _entry(ob: bpy.types.Object, context: bpy.types.Context) -> tuple[Quality, np.ndarray, np.ndarray]:
    uid = ob.session_uid
    if uid not in _known:
        _known[uid] = _look(ob, context.evaluated_depsgraph_get())
    return _known[uid]


def _draw_dots() -> None:
    import gpu
    from gpu_extras.batch import batch_for_shader

    context = bpy.context
    if context.space_data is None or not context.space_data.overlay.show_overlays:
        return
    shader = gpu.shader.from_builtin("POINT_FLAT_COLOR" if bpy.app.version >= (4, 5) else "FLAT_COLOR")
    scale = context.preferences.system.ui_scale
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.blend_set("ALPHA")
    gpu.state.point_size_set(9 * scale)
    for ob in shown(context):
        _, points, colour = _entry(ob, context)
        if len(points):
            with gpu.matrix.push_pop():
                gpu.matrix.multiply_matrix(ob.matrix_world)
                batch_for_shader(shader, "POINTS", {"pos": points, "color": colour}).draw(shader)
    gpu.state.point_size_set(1)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def lines(found: Quality) -> list[str]:
    """What is written in the corner."""
    if found.sides == 4:
        rows = [f"{found.faces} quads", f"Poles {len(found.irregular)}"]
    else:
        rows = [f"{found.faces} faces", f"Irregular {len(found.irregular)}"]
    if found.least is not None:
        rows[1] = f"{rows[1]}  (least {found.least})"
    if found.worst_face >= 0:
        rows.append(f"Sharpest angle {np.degrees(found.worst_angle):.1f}°")
    if found.non_manifold:
        rows.append(f"Non-manifold {found.non_manifold}")
    return rows


def _draw_text() -> None:
    import blf

    context = bpy.context
    active = context.view_layer.objects.active
    if context.space_data is None or not context.space_data.overlay.show_overlays:
        return
    if active is None or active not in shown(context):
        return
    found = _entry(active, context)[0]
    scale = context.preferences.system.ui_scale
    font, line = 0, LINE * scale
    blf.size(font, 12 * scale)
    blf.enable(font, blf.SHADOW)
    blf.shadow(font, 3, 0.0, 0.0, 0.0, 0.9)
    toolbar = next((r.width for r in context.area.regions if r.type == "TOOLS"), 0)
    x, y = toolbar + MARGIN * scale, (MARGIN + ABOVE) * scale
    # Inside a mesh numbers say it best; on borders others are regular.
    words = _WORDS[0 if found.border.any() else found.sides]
    seen = np.unique(kinds(found))
    written = [*lines(found), *(row for note in notes for row in note(active, context))]
    rows = [(told(row, "interface"), (1.0, 1.0, 1.0, 1.0)) for row in written]
    rows += [(f"● {told(words[kind], 'interface')}", _COLOURS[kind]) for kind in seen]
    for text, tint in reversed(rows):
        blf.color(font, *tint)
        blf.position(font, x, y, 0)
        blf.draw(font, text)
        y += line
    blf.disable(font, blf.SHADOW)


def turn(on: bool) -> None:
    """Show the dots, or take everything away again."""
    if on == bool(_handles):
        return
    space = bpy.types.SpaceView3D
    if on:
        _handles.append(space.draw_handler_add(_draw_dots, (), "WINDOW", "POST_VIEW"))
        _handles.append(space.draw_handler_add(_draw_text, (), "WINDOW", "POST_PIXEL"))
        bpy.app.handlers.depsgraph_update_post.append(_forget_changed)
        bpy.app.handlers.undo_post.append(_forget_all)
        bpy.app.handlers.redo_post.append(_forget_all)
        bpy.app.handlers.load_post.append(_forget_all)
        bpy.app.handlers.frame_change_post.append(_forget_all)
    else:
        for handle in _handles:
            space.draw_handler_remove(handle, "WINDOW")
        _handles.clear()
        for handlers in (
            bpy.app.handlers.depsgraph_update_post,
            bpy.app.handlers.undo_post,
            bpy.app.handlers.redo_post,
            bpy.app.handlers.load_post,
            bpy.app.handlers.frame_change_post,
        ):
            for handler in (_forget_changed, _forget_all):
                if handler in handlers:
                    handlers.remove(handler)
        _known.clear()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


@bpy.app.handlers.persistent
def _forget_changed(scene: Any, depsgraph: Any = None) -> None:
    forget(scene, depsgraph)


@bpy.app.handlers.persistent
def _forget_all(*_: Any) -> None:
    _known.clear()
