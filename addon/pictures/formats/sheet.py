# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file of a sprite is written from. numpy only, no bpy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..cutouts import Cutout
from .rig import Rig

IMAGES = "images"
"""Folder of pictures beside files that only name theirs."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """The mesh of a picture, and the picture."""

    name: str
    cutout: Cutout
    width: int
    height: int
    """Of the picture, in pixels."""
    picture: bytes
    """Its file, as it was read."""
    ending: str
    """Of the picture's name: ".png", ".jpg", ".jpeg" or ".webp"."""
    transparent: bool
    """Whether what is left out of the picture shows at the rim of the mesh."""
    flat: bool
    rig: Rig | None = None
    """Bones that move it, and their weights."""

    @property
    def points(self) -> np.ndarray:
        """(v, 3), pixels, x to the right, y up, from the lower middle of the picture, z towards the viewer."""
        return self.cutout.vertices - [self.width / 2, 0.0, 0.0]

    @property
    def uv(self) -> np.ndarray:
        """(v, 2), by vertex, from the upper left corner of the picture, 0 to 1."""
        across = self.cutout.vertices[:, :2] / [self.width, self.height]
        return np.column_stack([across[:, 0], 1.0 - across[:, 1]])

    def parts(self) -> Iterator[tuple[str, Part]]:
        """Parts that hang together, each with a name of its own."""
        starts, n = self.cutout.starts, len(self.cutout.vertices)
        for at, start in enumerate(starts):
            end = starts[at + 1] if at + 1 < len(starts) else n
            faces = self.cutout.faces
            own = faces[(faces[:, 0] >= start) & (faces[:, 0] < end)] - start
            loops = [loop - start for loop in self.cutout.silhouette if start <= loop[0] < end]
            name = self.name if len(starts) == 1 else f"{self.name}-{at + 1}"
            weights = None if self.rig is None else self.rig.weights[start:end]
            yield name, Part(self.points[start:end, :2], self.uv[start:end], own, loops, weights)


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a sprite that hangs together: its vertices' places in space and in the picture, triangles, contours."""

    points: np.ndarray
    uv: np.ndarray
    triangles: np.ndarray
    loops: list[np.ndarray]
    """The outer contour first; its vertices are the first ones, in order."""
    weights: np.ndarray | None = None
    """(v, b) of the bones, if there are any; rows sum to 1."""

    def edges(self) -> np.ndarray:
        """(e, 2) edges, each once."""
        pairs = np.concatenate([self.triangles[:, [a, (a + 1) % 3]] for a in range(3)])
        return np.unique(np.sort(pairs, axis=1), axis=0)
