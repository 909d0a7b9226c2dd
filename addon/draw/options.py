# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of a stroke: those for new bodies, and those that a changed body has."""

from __future__ import annotations

from typing import Any

from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, StringProperty

from ..ui.properties import CurveOption, ShapeOptions, SketchOptions

ACTIONS = [
    (
        "AUTO",
        "Automatic",
        "As the stroke lies: across an outline it extends the body, elsewhere it is a new one",
    ),
    ("NEW", "New", "A new body, whatever the stroke meets"),
    (
        "EXTEND",
        "Extend",
        "Add to the body that the stroke meets; others that it reaches in the same plane join in",
    ),
    ("TRIM", "Trim", "Take away from the body that the stroke meets"),
    ("HOLE", "Hole", "Make a hole in the body that the stroke lies in"),
    ("PART", "Part", "A body of its own though it meets another one, whose child it becomes"),
]


class StrokeOptions(SketchOptions, CurveOption):
    """What is done with a stroke. Mixed into operators."""

    action: EnumProperty(
        name="Action",
        description="What the stroke does",
        items=ACTIONS,
        default="AUTO",
        options={"SKIP_SAVE"},
    )
    use_mirror: BoolProperty(
        name="Mirror Stroke",
        description="Draw the mirror image too, across an upright line through the active live body or the 3D cursor",
        default=False,
    )
    pen: FloatProperty(
        name="Pen Width",
        description="How much the pressure of the pen drives the depth of the body",
        subtype="FACTOR",
        default=0.0,
        min=0.0,
        max=1.0,
    )
    stroke: StringProperty(options={"HIDDEN", "SKIP_SAVE"})
    matrix: FloatVectorProperty(size=16, options={"HIDDEN", "SKIP_SAVE"})


SHAPING = (*SketchOptions.__annotations__, *ShapeOptions.__annotations__, "pen")
"""Names of the options that a live body has too."""


def of_operator(operator: Any) -> dict[str, Any]:
    """Options as they are set, by name."""
    operator.settle_resolution()
    return {name: getattr(operator, name) for name in (*SHAPING, "curve")}


def put(operator: Any, values: dict[str, Any]) -> None:
    """Set options by name."""
    for name, value in values.items():
        setattr(operator, name, value)


def of_body(live: Any) -> dict[str, Any]:
    """Options of a live body; its curve stays as it is."""
    return {**{name: getattr(live, name) for name in SHAPING}, "curve": "NONE"}
