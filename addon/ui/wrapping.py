# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages in panels, broken into lines that are as wide as the panel. Blender itself cuts labels off."""

from __future__ import annotations

from collections.abc import Callable

import bpy

BESIDE = 90
"""What is beside the text of a label with an icon, in pixels at a scale of 1: margins, icon, tabs."""

NARROWEST = 60
"""Pixels at a scale of 1 that a line has at least, however narrow the panel."""


def lines(text: str, width: float, measure: Callable[[str], float]) -> list[str]:
    """Break a text into lines of at most `width`, between words; in words that are longer by themselves.

    measure : the width of a text. At least one character is on each line.
    """
    found: list[str] = []
    line = ""
    for word in text.split():
        longer = f"{line} {word}" if line else word
        if measure(longer) <= width:
            line = longer
            continue
        if line:
            found.append(line)
        line = word
        while measure(line) > width and len(line) > 1:
            fits = next((n for n in range(len(line) - 1, 1, -1) if measure(line[:n]) <= width), 1)
            found.append(line[:fits])
            line = line[fits:]
    return [*found, line] if line else found


def label(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, *, icon: str) -> None:
    """Draw a message below an icon's first line, as wide as the region."""
    import blf

    scale = context.preferences.system.ui_scale
    blf.size(0, context.preferences.ui_styles[0].widget.points * scale)
    width = context.region.width if context.region is not None else 0
    column = layout.column(align=True)
    room = max(width - BESIDE * scale, NARROWEST * scale)
    for at, line in enumerate(lines(text, room, lambda part: blf.dimensions(0, part)[0])):
        column.label(text=line, icon=icon if at == 0 else "BLANK1", translate=False)
