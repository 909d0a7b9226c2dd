# SPDX-License-Identifier: GPL-3.0-or-later
"""What the entries of menus and panels say that call *Strokes to Mesh* with options of their own."""

from __future__ import annotations

from typing import Any

from ..ui import preset_files

STROKES = "object.gridmesh_from_strokes"

OWN = "Make a smooth body with a clean mesh of triangles or quads from each closed stroke"
UPDATE = (
    "Make the bodies of the selected drawings, or the selected bodies, anew with these options; each stays the same "
    "object. Strokes without a body get one"
)
ANNOTATIONS = "Make a smooth body with a clean mesh of triangles or quads from each closed annotation"

PRESETS = {
    "Body Flat Badge": "Make a flat body with a rounded rim of each closed stroke, like a badge",
    "Body Limbs and Tubes": "Make a body of each closed stroke whose long limbs are round tubes",
    "Body Round": "Make a round body of each closed stroke; a circle becomes a sphere",
    "Sprite Deformation Heavy": "Make a flat sheet of each closed stroke, fine enough to be bent much",
    "Sprite Deformation Little": "Make a flat sheet of each closed stroke, coarse, for little bending",
    "Body Round Quads": "Make a round body of each closed stroke, of quads in loops along the outline",
    "Sprite Quads": "Make a flat sheet of each closed stroke, of quads in loops along the outline",
    "Sprite Mirrored Face": "Make a flat sheet of each closed stroke whose halves are alike, for faces",
    "Sprite Standard": "Make a flat sheet of each closed stroke, for cut-out animation",
}


def described(properties: Any) -> str:
    """Tooltip, in English, of an entry with these properties of the operator: only what is set counts."""
    if properties.is_property_set("update_existing") and properties.update_existing:
        return UPDATE
    if properties.is_property_set("source") and properties.source == "ANNOTATIONS":
        return ANNOTATIONS
    for label, values in preset_files.shipped(STROKES).items():
        if all(
            properties.is_property_set(name) and _same(getattr(properties, name), value)
            for name, value in values.items()
        ):
            return PRESETS.get(label, OWN)
    return OWN


def _same(value: Any, wanted: Any) -> bool:
    return abs(value - wanted) < 1e-6 if isinstance(wanted, float) else value == wanted
