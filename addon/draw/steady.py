# SPDX-License-Identifier: GPL-3.0-or-later
"""A line that follows the mouse at a distance, which smooths it. No bpy."""

from __future__ import annotations

from itertools import pairwise
from math import dist

Pixel = tuple[float, float]

SPACING = 2.0
"""Points nearer than this, in pixels, are one."""

NEAR = 2.0
"""The mouse is back at its start if it is so near, in radii."""

TURN = 6.0
"""The shortest way, in radii, that goes around something."""

SETTLED = 8.0
"""After this way, in radii, nothing is left of how a line began."""


class Steady:
    """A line on its way, and how it would go on if the mouse went around once more.

    radius : pixels that the line stays behind. factor : from 0 to 1, how slowly it follows.
    """

    def __init__(self, radius: float, factor: float) -> None:
        self.radius, self.factor = radius, factor
        self._mouse: list[Pixel] = []
        self._line: list[tuple[int, Pixel]] = []

    def follow(self, mouse: Pixel) -> Pixel | None:
        """Where the line goes when the mouse is at a pixel; None while that is within the radius."""
        self._mouse.append(mouse)
        return self._next(self._line[-1][1], mouse) if self._line else mouse

    def add(self, pixel: Pixel) -> None:
        """Take a pixel where the line was told to go as its next point."""
        self._line.append((len(self._mouse) - 1, pixel))

    def _next(self, at: Pixel, mouse: Pixel) -> Pixel | None:
        if dist(at, mouse) < self.radius:
            return None
        share = 1 - self.factor
        return at[0] + share * (mouse[0] - at[0]), at[1] + share * (mouse[1] - at[1])

    def lap(self) -> tuple[int, list[Pixel]]:
        """How a line is closed whose mouse has come back to its start: how many first points are left out, and the pixels that come after the last.

        A line begins at the mouse and ends behind it, so that a straight line between would make a corner at the start. Instead it follows
        the mouse around once more, to where it runs along itself. Nothing is left out, and nothing comes, where the mouse is elsewhere.
        """
        if len(self._line) < 2 or dist(self._mouse[0], self._mouse[-1]) > NEAR * self.radius:
            return 0, []
        steps = [dist(a, b) for a, b in pairwise(self._mouse)]
        length = sum(steps)
        if length < TURN * self.radius:
            return 0, []
        at, pixels = self._line[-1][1], []

        def go(mouse: Pixel) -> None:
            nonlocal at
            following = self._next(at, mouse)
            if following is not None and dist(at, following) >= SPACING:
                at = following
                pixels.append(at)

        (x, y), (end_x, end_y) = self._mouse[-1], self._mouse[0]
        count = int(dist((x, y), (end_x, end_y)) * len(steps) / length)
        for k in range(1, count + 1):
            share = k / (count + 1)
            go((x + share * (end_x - x), y + share * (end_y - y)))
        own, way, far = 0, 0.0, min(length / 2, SETTLED * self.radius)
        for k, mouse in enumerate(self._mouse):
            go(mouse)
            while own + 1 < len(self._line) and self._line[own + 1][0] <= k:
                own += 1
            if way >= far or (own and dist(at, self._line[own][1]) < SPACING):
                break
            way += steps[k]
        return own + 1, pixels
