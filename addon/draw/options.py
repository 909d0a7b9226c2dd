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
    ("PART", "Part", "A stroke of its own over a body, which it is joined to"),
]

LIES = [
    ("AUTO", "Automatic", "In front where the stroke lies inside the body, else in the middle"),
    ("FRONT", "In Front", "The middle of the part is on the side of the body that is seen"),
    ("MIDDLE", "Middle", "The part goes through the middle of the body"),
    ("BEHIND", "Behind", "The middle of the part is on the far side of the body"),
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
    part_lies: EnumProperty(
        name="Part Lies",
        description="Where a part lies, seen from the view; its depth can be changed later in the sidebar",
        items=LIES,
        default="AUTO",
    )
    use_twin: BoolProperty(
        name="Twin",
        description="Give a part a mirror image, across the X axis of the body, that follows the same stroke",
        default=False,
    )
    use_join: BoolProperty(
        name="Join Part",
        description="Make one closed body of the part and what it is drawn over; without, it is a body of its own and a child of that",
        default=True,
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


PART = ("part_lies", "use_twin", "use_join")
"""Names of the options that only parts have."""


def of_operator(operator: Any) -> dict[str, Any]:
    """Options as they are set, by name."""
    operator.settle_resolution()
    return {name: getattr(operator, name) for name in (*SHAPING, *PART, "curve")}


def draw_part(layout: Any, operator: Any) -> None:
    """Draw the options that only parts have."""
    layout.prop(operator, "part_lies")
    layout.prop(operator, "use_twin")
    layout.prop(operator, "use_join")


def put(operator: Any, values: dict[str, Any]) -> None:
    """Set options by name."""
    for name, value in values.items():
        setattr(operator, name, value)


def of_body(live: Any) -> dict[str, Any]:
    """Options of a live body; its curve stays as it is."""
    return {**{name: getattr(live, name) for name in SHAPING}, "curve": "NONE"}
