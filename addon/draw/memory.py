# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes that operators remember by a short name, so that neither the Info editor nor the history is full of numbers.

They last as long as Blender runs, as the history of operators does. Scripts give the points themselves.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import count
from typing import Any

import numpy as np

from ..bodies.outlines import Plane
from .decision import Wanted
from .trace import Mirror, Trace, flat, unpack

MARK = "#"
"""First letter of names, which base64 does not have."""

MOST = 200
"""Strokes that are kept; Blender repeats one of the last 32 operators at most."""


class ForgottenError(ValueError):
    """There is no stroke to draw again. The message says why."""


@dataclass(eq=False)
class Memory:
    """What was drawn, and what was asked for."""

    trace: Trace
    wanted: Wanted
    mirror: Mirror
    """Where the mirror is, whether it is on or not."""
    options: dict[str, Any] = field(default_factory=dict)
    """Options for a new body."""
    action: str = ""
    """What the stroke did the first time."""


_kept: dict[str, Memory] = {}
_numbers = count(1)


def keep(memory: Memory) -> str:
    """Remember a stroke; return its name."""
    name = f"{MARK}{next(_numbers)}"
    _kept[name] = memory
    while len(_kept) > MOST:
        del _kept[next(iter(_kept))]
    return name


def recall(name: str) -> Memory | None:
    """Return a stroke by its name; None for a text that is no name.

    Raises
    ------
    ForgottenError
        If there was one, before Blender was started again or many strokes ago.
    """
    if not name.startswith(MARK):
        return None
    if name not in _kept:
        raise ForgottenError(
            "the stroke is no longer known: it is remembered until Blender is closed; draw it again"
        )
    return _kept[name]


def given(text: str, matrix: list[float], wanted: Wanted, *, free: bool, place: Any) -> Memory:
    """Return a stroke that a script gives: points as text in a plane, whose matrix (16,) has its frame.

    place : (3,) a point of the mirror; it stands on the plane's x axis.

    Raises
    ------
    ForgottenError
        If the text cannot be read.
    """
    try:
        points, pressures = unpack(text)
    except ValueError as error:
        raise ForgottenError(f"the stroke cannot be read: {error}") from error
    frame = np.array(matrix, float).reshape(4, 4)
    plane = Plane(frame[:3, 3], frame[:3, :3].T)
    if not np.allclose(plane.axes @ plane.axes.T, np.eye(3), atol=1e-4):
        raise ForgottenError(
            "the matrix of the stroke is no frame: its axes must be unit vectors at right angles"
        )
    mirror = Mirror(np.array(place, float), plane.axes[0])
    return Memory(flat(plane, points, pressures, free=free), wanted, mirror)
