# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones of a sprite, read from a JSON file, and what each weighs at each vertex. numpy only, no bpy."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...api import cancelling
from ...native import native
from ..cutouts import Cutout

MOST = 256
"""Bones that a file may have."""

KEYS = {"name", "parent", "head", "tail"}

_DIGITS = 6
"""Of the weights in files: what is written sums to 1 but for the last bits."""


class RigError(ValueError):
    """The bones cannot be used. The message says which, and what is allowed; it does not name the file."""


@dataclass(frozen=True)
class Bone:
    """A bone at rest: its ends in pixels, x to the right, y up, from the lower middle of the picture."""

    name: str
    parent: int | None
    """Place of the parent, which comes before."""
    head: tuple[float, float]
    tail: tuple[float, float]

    @property
    def length(self) -> float:
        """In pixels."""
        return math.dist(self.head, self.tail)

    @property
    def angle(self) -> float:
        """From the x axis, counter-clockwise, in radians."""
        return math.atan2(self.tail[1] - self.head[1], self.tail[0] - self.head[0])

    def seen_from(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) in the bone's own axes: x along it, from its head."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        return (points - np.array(self.head)) @ np.array([[c, -s], [s, c]])


@dataclass(frozen=True, eq=False)
class Rig:
    """Bones, parents before their children, and the weights (v, b) of the vertices; rows sum to 1."""

    bones: list[Bone]
    weights: np.ndarray

    def at_rest(self, k: int) -> tuple[float, float, float]:
        """Place and angle of a bone in the axes of its parent."""
        bone = self.bones[k]
        if bone.parent is None:
            return (*bone.head, bone.angle)
        parent = self.bones[bone.parent]
        x, y = parent.seen_from(np.array([bone.head]))[0].tolist()
        return x, y, math.remainder(bone.angle - parent.angle, math.tau)


def read(data: bytes, width: int, height: int) -> list[Bone]:
    """Read bones: `{"bones": [{"name", "parent", "head", "tail"}, ...]}`, ends in pixels from the upper left corner, y down.

    Raises
    ------
    RigError
        If they are none.
    """
    try:
        text = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise RigError(f"it is no JSON: {error}") from error
    listed = text.get("bones") if isinstance(text, dict) else None
    if not isinstance(listed, list) or not 1 <= len(listed) <= MOST:
        raise RigError(f'it must be {{"bones": [...]}}, with 1 to {MOST} bones')
    named: dict[str, dict[str, Any]] = {}
    for at, bone in enumerate(listed):
        name = _checked(bone, at)
        if name in named:
            raise RigError(f"two bones are named '{name}'; each needs a name of its own")
        named[name] = bone

    def placed(end: list[float]) -> tuple[float, float]:
        return float(end[0]) - width / 2, height - float(end[1])

    order = _parents_first(named)
    return [
        Bone(
            name,
            None if named[name].get("parent") is None else order.index(named[name]["parent"]),
            placed(named[name]["head"]),
            placed(named[name]["tail"]),
        )
        for name in order
    ]


def _checked(bone: Any, at: int) -> str:
    """Name of a bone, all of which is as it should be but for its parent."""
    if not isinstance(bone, dict) or not isinstance(bone.get("name"), str) or not bone["name"].strip():
        raise RigError(f"bone {at} has no name; each is an object with {', '.join(sorted(KEYS))}")
    name = bone["name"]
    if unknown := sorted(bone.keys() - KEYS):
        raise RigError(f"bone '{name}' has '{unknown[0]}'; allowed: {', '.join(sorted(KEYS))}")
    if not isinstance(bone.get("parent"), str | None):
        raise RigError(f"the parent of bone '{name}' must be the name of a bone, or null")
    for end in ("head", "tail"):
        place = bone.get(end)
        if not isinstance(place, list) or len(place) != 2 or not all(map(_is_pixel, place)):
            raise RigError(f"the {end} of bone '{name}' must be two numbers, x and y in pixels")
    if bone["head"] == bone["tail"]:
        raise RigError(f"head and tail of bone '{name}' are in the same place; move one")
    return name


def _is_pixel(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= 1e6


def _parents_first(named: dict[str, dict[str, Any]]) -> list[str]:
    """Names in the order of the file, but that children come after their parents."""
    order: dict[str, None] = {}
    for name in named:
        chain: list[str] = []
        above: str | None = name
        while above is not None and above not in order:
            if above not in named:
                raise RigError(
                    f"the parent '{above}' of bone '{chain[-1]}' is no bone; allowed: the names of others"
                )
            if above in chain:
                raise RigError(f"bone '{above}' is its own ancestor; leave out a parent")
            chain.append(above)
            above = named[above].get("parent")
        order.update(dict.fromkeys(reversed(chain)))
    return list(order)


def weighed(
    cutout: Cutout, points: np.ndarray, bones: list[Bone], progress: Callable[[float], object] | None = None
) -> Rig:
    """Weights of bones at the vertices of a flat sprite; each part that no bone meets follows the nearest.

    Raises
    ------
    RigError
        If there are no weights.
    CancelledError
        If `progress` or Ctrl-C asked to stop.
    NativeError
        Without the module.
    """
    gridmesh = native("bone_weights")
    ends = np.array([[bone.head, bone.tail] for bone in bones])
    try:
        with cancelling(gridmesh):
            found = gridmesh.bone_weights(points[:, :2], cutout.faces, ends, progress=progress)
    except gridmesh.GridMeshError as error:
        raise RigError(str(error)) from error
    return Rig(bones, _rounded(found))


def _rounded(weights: np.ndarray) -> np.ndarray:
    """Weights of few digits; what rounding takes from a row's sum, its largest gets."""
    short = np.round(weights, _DIGITS)
    rows = np.arange(len(short))
    largest = short.argmax(axis=1)
    short[rows, largest] += 1.0 - short.sum(axis=1)
    return np.round(short, _DIGITS)
