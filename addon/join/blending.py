# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of how parts are joined, for operators and for what joined bodies remember."""

from __future__ import annotations

from typing import Any

from bpy.props import BoolProperty, FloatProperty

from ..data import defaults


def blend(**more: Any) -> Any:
    """Property of the width of the transitions."""
    return FloatProperty(
        name="Blend Width",
        description="Edge lengths to each side of the line where two parts meet that become a smooth transition; 0 keeps "
        "the crease",
        default=defaults.BLEND,
        min=0.0,
        soft_max=10.0,
        max=1000.0,
        **more,
    )


def edge_length(**more: Any) -> Any:
    """Property of the length that the width counts in."""
    return FloatProperty(
        name="Edge Length",
        description="The edge length that Blend Width counts in; 0 for that of each part",
        subtype="DISTANCE",
        default=0.0,
        min=0.0,
        **more,
    )


def strict(**more: Any) -> Any:
    """Property that joints are checked."""
    return BoolProperty(
        name="Strict",
        description="Refuse joints that meet themselves or the parts, instead of warning of them",
        default=False,
        **more,
    )
