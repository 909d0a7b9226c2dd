# SPDX-License-Identifier: GPL-3.0-or-later
"""The stroke, the grid inside it and a word at the mouse, over the viewport while it is drawn: what release will do."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..bodies.outlines import Plane
from ..ui.wrapping import lines
from .decision import Decision
from .gesture import Gesture
from .trace import Mirror, Trace

COLORS = {
    "NEW": (0.25, 0.6, 1.0),
    "EXTEND": (0.25, 0.85, 0.35),
    "TRIM": (1.0, 0.25, 0.2),
    "HOLE": (1.0, 0.25, 0.2),
    "PART": (0.75, 0.45, 1.0),
    "": (0.6, 0.6, 0.6),
}
_CLOSED = 20
"""A sidebar that is closed is at most so many pixels wide."""
_LINE, _AXIS = (1.0, 0.55, 0.1, 1.0), (1.0, 1.0, 1.0, 0.45)

Grid = tuple[np.ndarray, np.ndarray]
"""Vertices (v, 3) in the world and faces (f, 3) or (f, 4)."""


class Preview:
    """Draw handlers of one view; `remove` takes them away, as often as it is called."""

    def __init__(self, context: bpy.types.Context) -> None:
        self._area, self._region = context.area, context.region
        self._color = COLORS["NEW"]
        self._lines: list[np.ndarray] = []
        self._axis: np.ndarray | None = None
        self._grids: list[Grid] = []
        self._word, self._hint, self._mouse = "", "", (0.0, 0.0)
        add = bpy.types.SpaceView3D.draw_handler_add
        self._handles: list[Any] = [
            add(self._draw, (), "WINDOW", "POST_VIEW"),
            add(self._write, (), "WINDOW", "POST_PIXEL"),
        ]

    def show(
        self, trace: Trace, plane: Plane, decisions: list[Decision], gesture: Gesture, mirror: Mirror | None
    ) -> None:
        """Show a stroke in a plane, and what is decided of it."""
        points = trace.on(plane)
        self._color = COLORS[decisions[0].action if decisions else ""]
        self._lines, self._grids, self._axis = [], [], None
        if points is not None:
            self._lines.append(_world(plane, points))
            if mirror is not None:
                self._lines.append(_world(plane, mirror.image(plane, points)))
                self._axis = _axis(mirror, plane, points)
        for decision in decisions:
            for part in _parts(decision):
                grid = gesture.preview(part)
                if grid is not None:
                    self._grids.append(
                        (_world(decision.plane, grid[0]), np.ascontiguousarray(grid[1], np.int32))
                    )
        self._area.tag_redraw()

    def say(self, word: str, hint: str, mouse: tuple[float, float]) -> None:
        """Write a word at the mouse, and a hint below it."""
        self._word, self._hint, self._mouse = word, hint, mouse
        self._area.tag_redraw()

    def remove(self) -> None:
        """Take everything away."""
        for handle in self._handles:
            bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
        if self._handles:
            self._area.tag_redraw()
        self._handles = []

    def _draw(self) -> None:
        import gpu
        from gpu_extras.batch import batch_for_shader

        if bpy.context.region != self._region:
            return
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("NONE")
        plain = gpu.shader.from_builtin("UNIFORM_COLOR")
        light = tuple(0.5 + 0.5 * value for value in self._color)
        for vertices, faces in self._grids:
            plain.uniform_float("color", (*self._color, 0.24))
            halves = [faces[:, [0, k, k + 1]] for k in range(1, faces.shape[1] - 1)]
            triangles = np.ascontiguousarray(np.concatenate(halves))
            batch_for_shader(plain, "TRIS", {"pos": vertices}, indices=triangles).draw(plain)
            edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
            edges = np.unique(np.sort(edges, axis=1), axis=0)
            plain.uniform_float("color", (*light, 0.55))
            batch_for_shader(plain, "LINES", {"pos": vertices}, indices=edges).draw(plain)
        wide = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
        scale = bpy.context.preferences.system.ui_scale
        lines = [(line, _LINE, 2.5) for line in self._lines if len(line) > 1]
        if self._axis is not None:
            lines.append((self._axis, _AXIS, 1.0))
        for line, color, width in lines:
            wide.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
            wide.uniform_float("lineWidth", width * scale)
            wide.uniform_float("color", color)
            batch_for_shader(wide, "LINE_STRIP", {"pos": line}).draw(wide)
        gpu.state.blend_set("NONE")

    def _write(self) -> None:
        import blf

        if bpy.context.region != self._region or not self._word:
            return
        scale = bpy.context.preferences.system.ui_scale
        light = tuple(0.35 + 0.65 * value for value in self._color)
        margin = 6 * scale
        room = free_width(self._area, self._region) - 4 * margin
        rows, width = [], 0.0
        for text, size, color in (
            (self._word, 14.0 * scale, light),
            (self._hint, 11.0 * scale, (1.0, 0.85, 0.5)),
        ):
            blf.size(0, size)
            for line in lines(text, room, lambda part: blf.dimensions(0, part)[0]):
                rows.append((line, size, color))
                width = max(width, blf.dimensions(0, line)[0])
        left = max(2 * margin, min(self._mouse[0] + 18 * scale, room + 2 * margin - width))
        top = self._mouse[1] + 28 * scale
        height = sum(1.5 * size for _, size, _ in rows)
        _box(left - margin, top - height - margin / 2, left + width + margin, top + margin / 2)
        for text, size, color in rows:
            top -= 1.5 * size
            blf.size(0, size)
            blf.color(0, *color, 1.0)
            blf.position(0, left, top + 0.45 * size, 0)
            blf.draw(0, text)


def free_width(area: bpy.types.Area, region: bpy.types.Region) -> int:
    """Pixels of a view from its left edge to where the sidebar lies over it."""
    middle = region.x + region.width // 2
    sides = [
        side.x for side in area.regions if side.type == "UI" and side.width > _CLOSED and side.x > middle
    ]
    return min([region.width, *(side - region.x for side in sides)])


def _box(left: float, bottom: float, right: float, top: float) -> None:
    """Draw a dark box behind words, which may be over anything."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    gpu.state.blend_set("ALPHA")
    plain = gpu.shader.from_builtin("UNIFORM_COLOR")
    plain.uniform_float("color", (0.06, 0.06, 0.06, 0.8))
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    batch_for_shader(plain, "TRIS", {"pos": corners}, indices=[(0, 1, 2), (0, 2, 3)]).draw(plain)
    gpu.state.blend_set("NONE")


def _parts(decision: Decision) -> list[Any]:
    """What is filled: the strokes as they are, which is cheap, or united where they meet."""
    if decision.symmetric:
        from ..native import native

        try:
            return decision.parts()
        except native("combine").GridMeshError:
            pass  # a line yet
    return [(stroke, []) for stroke in decision.strokes]


def _axis(mirror: Mirror, plane: Plane, points: np.ndarray) -> np.ndarray:
    """Ends (2, 3) of the mirror's line, longer than the stroke."""
    normal, offset = mirror.line(plane)
    along = np.array([-normal[1], normal[0]])
    reach = points @ along
    more = max(float(np.ptp(reach)), float(np.ptp(points @ normal)), 1e-6)
    ends = np.array([reach.min() - more, reach.max() + more])
    return _world(plane, offset * normal + ends[:, None] * along)


def _world(plane: Plane, points: np.ndarray) -> np.ndarray:
    return plane.world(np.column_stack([points, np.zeros(len(points))])).astype(np.float32)
