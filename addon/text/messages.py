# SPDX-License-Identifier: GPL-3.0-or-later
"""How operators put numbers and lists of reasons."""

from collections.abc import Iterable

_NAMED = 3
"""A message names this many things; the others are counted."""

_PLURALS = {
    "body": "bodies",
    "irregular vertex": "irregular vertices",
    "patch": "patches",
    "mesh": "meshes",
    "pair of loops": "pairs of loops",
}


def counted(number: int, what: str) -> str:
    """Return the number with its noun."""
    return f"{number} {what if number == 1 else _PLURALS.get(what, what + 's')}"


def listed(reasons: Iterable[str]) -> str:
    """Join reasons into a message of bounded length."""
    reasons = list(reasons)
    more = len(reasons) - _NAMED
    text = "\n".join(reason[:1].upper() + reason[1:] for reason in reasons[:_NAMED])
    return f"{text}\n... and {more} more" if more > 0 else text


def faces_counted(sizes: Iterable[int]) -> str:
    """Tell how many quads and triangles there are. sizes : corners of each face, three or four."""
    sizes = list(sizes)
    quads = sum(n == 4 for n in sizes)
    triangles = len(sizes) - quads
    if not quads:
        return counted(triangles, "triangle")
    if not triangles:
        return counted(quads, "quad")
    return f"{counted(quads, 'quad')} and {counted(triangles, 'triangle')}"


def of_stroke(text: str) -> str:
    """What the library says of an outline, said of the stroke that was drawn."""
    return text.replace("the other outline", "the stroke").replace("the outline", "the stroke")
