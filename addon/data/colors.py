# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of grease-pencil drawings on bodies: that of the fill, and of the lines along the rim and around holes."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ..bodies.outlines import Sketch, Stroke
from .placing import Transaction

NAME = "Color"
"""Of the colour attribute."""

_GREY = (0.8, 0.8, 0.8, 1.0)
"""Of a body without a material."""


@dataclass(frozen=True)
class Colors:
    """Linear colours (red, green, blue, 1) of a body."""

    surface: tuple[float, ...]
    rims: tuple[tuple[float, ...], ...]
    """Of each contour, the outer one first."""

    @property
    def several(self) -> bool:
        """Whether any differs from the surface's."""
        return any(not np.allclose(rim, self.surface, atol=1e-3) for rim in self.rims)


def shows(style: bpy.types.MaterialGPencilStyle, option: str, otherwise: bool) -> bool:
    """Whether a material shows its strokes or fills ("show_stroke", "show_fill"); from Blender 5.2 on strokes say so themselves."""
    found = style.bl_rna.properties.get(option)
    if found is None or getattr(found, "is_deprecated", False):
        return otherwise
    return getattr(style, option)


def of_sketch(sketch: Sketch, surface: tuple[float, ...] | None) -> Colors | None:
    """Colours of what is drawn with grease pencil; None if the outline is not.

    surface : colour of the body's material; None if it has none.
    """
    if not _is_drawn(sketch.stroke):
        return None
    plain = _GREY if surface is None else tuple(surface)
    outer = sketch.stroke.material.grease_pencil
    filled = shows(outer, "show_fill", False) or sketch.stroke.filled
    rim = _line(sketch.stroke) if filled else None
    around = [_line(hole.stroke) if _is_drawn(hole.stroke) else None for hole in sketch.holes]
    if not filled and surface is None:  # black ink, for drawing with
        around = [None if color is not None and max(color[:3]) < 0.02 else color for color in around]
    return Colors(plain, tuple(plain if color is None else color for color in (rim, *around)))


def paint(mesh: bpy.types.Mesh, silhouette: list[np.ndarray], colors: Colors) -> None:
    """Give the vertices the colours: those of the rims theirs, all others the surface's. A body of one colour has no attribute."""
    if not colors.several or len(silhouette) != len(colors.rims):
        return
    values = np.tile(np.array(colors.surface, np.float32), (len(mesh.vertices), 1))
    for loop, color in zip(silhouette, colors.rims, strict=True):
        values[np.asarray(loop)] = color
    attribute = mesh.color_attributes.new(NAME, "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", values.ravel())
    mesh.color_attributes.active_color = attribute


def material(name: str, surface: tuple[float, ...], transaction: Transaction) -> bpy.types.Material:
    """Material that shows the colour attribute, made once and found by its name afterwards."""
    found = bpy.data.materials.get(name)
    if found is not None and not found.is_grease_pencil:
        return found
    made = transaction.new(bpy.data.materials, name)
    made.diffuse_color = surface
    if made.node_tree is None:
        made.use_nodes = True  # before Blender 5.0
    tree = made.node_tree
    node = tree.nodes.new("ShaderNodeVertexColor")
    node.layer_name, node.location = NAME, (-250, 250)
    for shader in tree.nodes:
        if shader.type == "BSDF_PRINCIPLED":
            tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    return made


def _is_drawn(stroke: Stroke) -> bool:
    return stroke.material is not None and stroke.material.is_grease_pencil


def _line(stroke: Stroke) -> tuple[float, ...] | None:
    """Colour of a stroke's line, or of its fill where it shows no line; None if it shows neither."""
    style = stroke.material.grease_pencil
    if shows(style, "show_stroke", True) and style.color[3] > 0:
        return (*style.color[:3], 1.0)
    if stroke.filled or shows(style, "show_fill", False):
        return (*style.fill_color[:3], 1.0)
    return None
