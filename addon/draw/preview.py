# SPDX-License-Identifier: GPL-3.0-or-later
"""The stroke and the grid inside it, over the viewport while it is drawn."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from ..outlines import Plane

_LINE, _FACE, _GRID = (1.0, 0.55, 0.1, 1.0), (0.25, 0.6, 1.0, 0.22), (0.75, 0.88, 1.0, 0.55)
_CUT_FACE, _CUT_GRID = (1.0, 0.25, 0.2, 0.22), (1.0, 0.7, 0.65, 0.5)


class Preview:
    """Draw handler of one view; `remove` takes it away, as often as it is called."""

    def __init__(self, context: bpy.types.Context, plane: Plane, *, subtract: bool) -> None:
        self._area, self._region, self._plane = context.area, context.region, plane
        self._face, self._grid = (_CUT_FACE, _CUT_GRID) if subtract else (_FACE, _GRID)
        self._line = np.zeros((0, 3), np.float32)
        self._vertices = np.zeros((0, 3), np.float32)
        self._triangles = np.zeros((0, 3), np.int32)
        self._handle: Any = bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", "POST_VIEW")

    def show(self, points: np.ndarray, grid: tuple[np.ndarray, np.ndarray] | None) -> None:
        """Show a stroke (n, 2) and a grid of vertices (v, 2) and triangles (t, 3) in the plane."""
        self._line = self._world(points)
        if grid is None:
            self._vertices, self._triangles = np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32)
        else:
            self._vertices, self._triangles = self._world(grid[0]), np.ascontiguousarray(grid[1], np.int32)
        self._area.tag_redraw()

    def _world(self, points: np.ndarray) -> np.ndarray:
        return self._plane.world(np.column_stack([points, np.zeros(len(points))])).astype(np.float32)

    def remove(self) -> None:
        """Take everything away."""
        if self._handle is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handle, "WINDOW")
            self._handle = None
            self._area.tag_redraw()

    def _draw(self) -> None:
        import gpu
        from gpu_extras.batch import batch_for_shader

        if bpy.context.region != self._region:
            return
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("NONE")
        plain = gpu.shader.from_builtin("UNIFORM_COLOR")
        if len(self._triangles):
            plain.uniform_float("color", self._face)
            batch_for_shader(plain, "TRIS", {"pos": self._vertices}, indices=self._triangles).draw(plain)
            edges = np.concatenate(
                [self._triangles[:, [0, 1]], self._triangles[:, [1, 2]], self._triangles[:, [2, 0]]]
            )
            edges = np.unique(np.sort(edges, axis=1), axis=0)
            plain.uniform_float("color", self._grid)
            batch_for_shader(plain, "LINES", {"pos": self._vertices}, indices=edges).draw(plain)
        if len(self._line) > 1:
            wide = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
            wide.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
            wide.uniform_float("lineWidth", 2.5 * bpy.context.preferences.system.ui_scale)
            wide.uniform_float("color", _LINE)
            batch_for_shader(wide, "LINE_STRIP", {"pos": self._line}).draw(wide)
        gpu.state.blend_set("NONE")
