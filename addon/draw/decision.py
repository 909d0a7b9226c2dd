# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stroke does, and to which body: the same rule while it is drawn and when it is finished.

numpy only, no bpy. A decision depends on the stroke, the keys that are held and the bodies that are there; it changes
nothing. Adding is the default, to take away is asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..api import reason_of
from ..bodies.outlines import Plane, area
from ..native import native
from ..text.messages import of_stroke
from . import parts
from .regions import Part, covered, inside, relation, united
from .trace import Mirror, Trace, closed

__all__ = ["Decision", "DecisionError", "Part", "Shape", "Wanted", "decide", "inside", "relation", "united"]

TURNED, APART = 0.94, 0.5
"""A stroke is in a body's plane if its own is turned by at most 20 degrees from it (here the cosine), and is at most
this part of the body's size away from its middle: views are seldom turned back exactly."""

CHOSEN_TURNED, CHOSEN_APART = 0.99, 0.1
"""The same where the plane was chosen and not only looked at, and for bodies that are joined: 8 degrees."""

EDGE_ON = 0.26
"""Sine of 15 degrees: a stroke does not take the plane of a body that is seen at less."""


class DecisionError(ValueError):
    """A stroke does nothing. The message says why."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A body as decisions see it: its outline and holes in the frame of its plane, in the world's units."""

    name: str
    plane: Plane
    outline: np.ndarray
    holes: list[np.ndarray]
    thickness: float = 0.0
    """From its plane to where it ends, on the thicker side."""
    surface: np.ndarray | None = None
    """(k, 3) points of its surface, in the frame of its plane."""
    across: Mirror | None = None
    """Where twins of its parts are mirrored."""
    twin: bool = False
    """Whether it is the mirror image of the body: its plane is that of the body mirrored, what is drawn in it is the body's own."""
    fixed: str = ""
    """Why its outline cannot be changed; empty if it can."""
    apart: str = ""
    """Why no part can be joined to it; empty if one can."""
    low: np.ndarray = field(init=False)
    high: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "low", self.outline.min(axis=0))
        object.__setattr__(self, "high", self.outline.max(axis=0))

    @property
    def part(self) -> Part:
        """Outline and holes."""
        return self.outline, self.holes

    def mirrored(self) -> Shape:
        """Return its twin."""
        origin = self.across.across(self.plane.origin[None])[0]
        normal = self.across.normal
        axes = self.plane.axes - 2 * np.outer(self.plane.axes @ normal, normal)
        return replace(self, plane=Plane(origin, axes), twin=True)

    @property
    def middle(self) -> np.ndarray:
        """(3,) in the world."""
        return self.plane.world(np.append((self.low + self.high) / 2, 0.0))

    @property
    def size(self) -> float:
        """Diagonal of its bounds."""
        return float(np.linalg.norm(self.high - self.low))

    def height(self, place: np.ndarray) -> float:
        """How far its surface is from its plane near a point (3,) of the plane's frame, on the side of that."""
        if self.surface is None or not len(self.surface):
            return self.thickness
        apart = self.surface[:, :2] - place[:2]
        near = np.argsort((apart * apart).sum(axis=1), kind="stable")[:12]
        side = -1.0 if place[2] < 0 else 1.0
        return float((side * self.surface[near, 2]).max())

    def on(self, plane: Plane) -> Part:
        """Outline and holes in the frame of another plane."""

        def laid(ring: np.ndarray) -> np.ndarray:
            return plane.local(self.plane.world(np.column_stack([ring, np.zeros(len(ring))])))[:, :2]

        return laid(self.outline), [laid(hole) for hole in self.holes]


@dataclass(frozen=True)
class Wanted:
    """What was asked for: an action, or the keys that are held."""

    action: str = "AUTO"
    subtract: bool = False
    part: bool = False
    lies: str = "AUTO"
    """Where a part lies: "FRONT", "MIDDLE" or "BEHIND"; "AUTO": in front where it lies inside the outline, else in the middle."""
    twin: bool = False
    """Whether a part has a mirror image."""
    joins: bool = True
    """Whether a part is joined to the body that it is drawn over."""


@dataclass(frozen=True, eq=False)
class Decision:
    """What a stroke does."""

    action: str
    """"NEW", "EXTEND", "TRIM", "HOLE" or "PART"; empty if it does nothing."""
    plane: Plane
    strokes: list[np.ndarray]
    """(n, 2) in the plane, closed: the stroke, and its mirror image if that belongs to the same body."""
    body: str = ""
    """The body that is changed, or that a part belongs to."""
    joined: tuple[str, ...] = ()
    """Other bodies that become one with it."""
    hint: str = ""
    """What else is worth saying."""
    symmetric: bool = False
    depth: float = 0.0
    """Of a part: how far it lies in front, 1 with its middle on the surface of the body, 0 in the middle, -1 behind."""
    reach: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of a part: from depth 0 to depth 1, in the world."""
    twin: Mirror | None = None
    """Where the mirror image of a part is."""

    def parts(self) -> list[Part]:
        """What the strokes cover, united where they meet."""
        return covered(self.strokes)


def decide(trace: Trace, shapes: list[Shape], wanted: Wanted, mirror: Mirror | None = None) -> list[Decision]:
    """Decide what a stroke does; with a mirror its image too, in the same decision if both belong together.

    Raises
    ------
    DecisionError
        If it does nothing. What it would do if it were a little longer is not guessed.
    """
    first = _decided(trace, shapes, wanted)
    if mirror is None or first.twin is not None:
        return [first]
    image = mirror.image(first.plane, first.strokes[0])
    if first.action in {"NEW", "PART"} and _meet((first.strokes[0], []), (image, [])):
        return [_with(first, [first.strokes[0], image], symmetric=True)]
    world = first.plane.world(np.column_stack([image, np.zeros(len(image))]))
    try:
        second = _decided(trace.through(world), shapes, wanted)
    except DecisionError:
        return [first]
    if second.action in {"EXTEND", "TRIM", "HOLE"} and second.body == first.body:
        joined = tuple(dict.fromkeys((*first.joined, *second.joined)))
        action = "TRIM" if "TRIM" in {first.action, second.action} else first.action
        if np.linalg.det(first.plane.axes) * np.linalg.det(second.plane.axes) < 0:
            image = second.strokes[0]  # one of the two lies over the twin
        return [_with(first, [first.strokes[0], image], action=action, joined=joined)]
    if second.action in {"NEW", "PART"}:
        second = _with(second, [image]) if second.plane is first.plane else second
    return [first, second]


def _with(decision: Decision, strokes: list[np.ndarray], **changed: Any) -> Decision:
    values = {**decision.__dict__, "strokes": strokes, **changed}
    return Decision(**values)


@dataclass(frozen=True, eq=False)
class _Met:
    """A body that a stroke may change, and how the stroke lies to it."""

    shape: Shape
    how: str
    stroke: np.ndarray
    begins: bool
    """Whether the stroke begins in it."""
    depth: float
    inside: int
    """Points of the stroke that lie in it."""


def _decided(trace: Trace, shapes: list[Shape], wanted: Wanted) -> Decision:
    own = trace.on(trace.plane)
    if own is None or not len(own):
        raise DecisionError("the stroke leaves the plane; turn the view or choose another plane")
    own = closed(own)
    _require_one(own)
    action = wanted.action
    taking = action in {"TRIM", "HOLE"} or (action == "AUTO" and wanted.subtract)
    met = _ranked([one for shape in shapes if (one := _met(trace, shape, taking)) is not None])
    if taking:
        if not met:
            raise DecisionError("there is no body under the stroke to take away from")
        return _taken(met[0])
    if action == "PART" or (action == "AUTO" and wanted.part):
        return _part(trace, own, met, shapes, wanted)
    across = [one for one in met if one.how == "across"]
    if action == "EXTEND":
        across += [one for one in met if one.how == "around"]
        if not across:
            reason = (
                f"the stroke lies inside '{met[0].shape.name}', which it does not extend"
                if met
                else "there is no body under the stroke to extend"
            )
            raise DecisionError(reason)
    if across and action != "NEW":
        return _extended(across[0], shapes)
    return Decision("NEW", trace.plane, [own], hint=_hidden(trace, own, shapes))


def _require_one(stroke: np.ndarray) -> None:
    """Refuse what falls into parts where it crosses itself. A line, which encloses nothing yet, may become something."""
    gridmesh = native("combine")
    try:
        covered([stroke])
    except gridmesh.GridMeshError as error:
        if error.kind == "disconnected":
            raise DecisionError(of_stroke(reason_of(error))) from error


def _require_free(shape: Shape) -> None:
    if shape.fixed:
        raise DecisionError(f"'{shape.name}': {shape.fixed}")


def _taken(met: _Met) -> Decision:
    _require_free(met.shape)
    hint = "nothing would be left of it" if met.how == "around" else ""
    action = "HOLE" if met.how == "inside" else "TRIM"
    return Decision(action, met.shape.plane, [met.stroke], met.shape.name, hint=hint)


def _extended(met: _Met, shapes: list[Shape]) -> Decision:
    _require_free(met.shape)
    plane = met.shape.plane
    joined = []
    for other in shapes:
        if other.twin or met.shape.twin or other is met.shape or not together(met.shape, other):
            continue
        part = other.on(plane)
        # What overlaps already was drawn as a part of its own and stays one.
        if _meet((met.stroke, []), part) and not _meet(met.shape.part, part):
            joined.append(other.name)
    return Decision("EXTEND", plane, [met.stroke], met.shape.name, tuple(joined))


def _part(trace: Trace, own: np.ndarray, met: list[_Met], shapes: list[Shape], wanted: Wanted) -> Decision:
    if met:
        return _laid(trace, met[0].shape, wanted)
    under = []
    for shape in shapes:
        points = trace.on(shape.plane)
        if trace.seen and points is not None and inside(shape.part, points[:1])[0]:
            under.append((trace.depth(shape.plane), shape.name, shape))
    if under:
        return _laid(trace, min(under, key=lambda one: one[:2])[2], wanted)
    return Decision("NEW", trace.plane, [own], hint="there is no body that it could be a part of")


def _laid(trace: Trace, shape: Shape, wanted: Wanted) -> Decision:
    """Lay a part before, behind or into the middle of a body."""
    turned = abs(float(trace.plane.axes[2] @ shape.plane.axes[2]))
    base = parts.base(
        trace, shape.plane, shape.middle, near=turned > (TURNED if trace.free else CHOSEN_TURNED)
    )
    points, on_body = trace.on(base), trace.on(shape.plane)
    if points is None:
        raise DecisionError("the stroke leaves the plane; turn the view or choose another plane")
    depth = parts.DEPTHS.get(wanted.lies)
    if depth is None:
        depth = float(on_body is not None and bool(inside(shape.part, on_body).all()))
    world = shape.plane.world(shape.surface) if shape.surface is not None else np.zeros((0, 3))
    front = parts.toward(trace, base)
    length = parts.reach(base, closed(points), world, toward=-front if depth < 0 else front)
    reach = (length or max(shape.thickness, 0.1 * shape.size)) * front
    plane = Plane(base.origin + depth * reach, base.axes)
    stroke = trace.on(plane)
    if stroke is None:
        raise DecisionError("the stroke leaves the plane; turn the view or choose another plane")
    stroke = closed(stroke)
    hint = _hidden(trace, stroke, [shape], plane)
    if hint.startswith("inside") and depth == 0:
        hint = f"inside '{shape.name}': not visible; let it lie in front"
    if wanted.joins and shape.apart:
        hint = f"the part stays apart from '{shape.name}': {shape.apart}"
    return Decision(
        "PART",
        plane,
        [stroke],
        shape.name,
        hint=hint,
        depth=depth,
        reach=tuple(reach.tolist()),
        twin=shape.across if wanted.twin else None,
    )


def _hidden(trace: Trace, own: np.ndarray, shapes: list[Shape], plane: Plane | None = None) -> str:
    """Say so if a new body would not be seen, or would hide another. plane : that of the stroke, unless the trace's."""
    plane = plane or trace.plane
    world = plane.world(np.column_stack([own, np.zeros(len(own))]))
    for shape in shapes:
        place = shape.plane.local(world)
        middle = place.mean(axis=0)
        turned = abs(plane.axes[2] @ shape.plane.axes[2]) < TURNED
        if turned or abs(middle[2]) > shape.thickness:
            continue
        how = _lies(shape, place[:, :2])
        # As thick as a ball of its area: that is the most that sticks out.
        if how == "inside" and abs(middle[2]) + np.sqrt(area(own) / np.pi) < shape.height(middle):
            return f"inside '{shape.name}': not visible; use Plane: Surface"
        if how == "around":
            return f"'{shape.name}' will be inside it: not visible"
    return ""


def _met(trace: Trace, shape: Shape, taking: bool) -> _Met | None:
    """How a stroke lies to a body; None if it is not in its plane or beside it."""
    points = trace.on(shape.plane)
    if points is None:
        return None
    begins = bool(inside(shape.part, points[:1])[0])
    points = closed(points)
    turned = abs(float(trace.plane.axes[2] @ shape.plane.axes[2]))
    apart = abs(float(trace.plane.local(shape.plane.origin[None])[0, 2])) / max(shape.size, 1e-30)
    limits = (TURNED, APART) if trace.free else (CHOSEN_TURNED, CHOSEN_APART)
    near = turned > limits[0] and apart < limits[1]
    sine = abs(float(trace.directions[0] @ shape.plane.axes[2]))
    if not near and not (trace.seen and begins and sine > EDGE_ON and (trace.free or taking)):
        return None
    how = _lies(shape, points)
    if how == "apart":
        return None
    within = int(np.count_nonzero(inside(shape.part, points)))
    return _Met(shape, how, points, begins, trace.depth(shape.plane), within)


def _ranked(met: list[_Met]) -> list[_Met]:
    """Those that the stroke begins in first: the nearest, and of those in one plane the smallest."""
    begun = [one for one in met if one.begins]
    nearest = min((one.depth for one in begun), default=0.0)
    tie = max((one.shape.thickness + 0.02 * one.shape.size for one in begun), default=0.0)

    def rank(one: _Met) -> tuple[bool, float, float, int, str]:
        far = 0.0 if not one.begins or one.depth - nearest <= tie else one.depth
        size = area(one.shape.outline) if one.begins else 0.0
        return not one.begins, far, size, -one.inside, one.shape.name

    return sorted(met, key=rank)


def together(one: Shape, other: Shape) -> bool:
    """Whether two bodies lie in one plane."""
    if abs(one.plane.axes[2] @ other.plane.axes[2]) < CHOSEN_TURNED:
        return False
    world = other.plane.world(np.column_stack([other.outline, np.zeros(len(other.outline))]))
    off = np.abs(one.plane.local(world)[:, 2]).max()
    return bool(off < CHOSEN_APART * max(one.size, other.size))


def _lies(shape: Shape, points: np.ndarray) -> str:
    """How a stroke lies to a body; while it encloses nothing yet, its points tell."""
    if (points.max(axis=0) < shape.low).any() or (points.min(axis=0) > shape.high).any():
        return "apart"
    if len(points) > 2:
        try:
            return relation(shape.outline, shape.holes, points)
        except native("combine").GridMeshError:
            pass  # a line: it is told by its points
    within = inside(shape.part, points)
    return "inside" if within.all() else "across" if within.any() else "apart"


def _meet(one: Part, other: Part) -> bool:
    # Each outline filled against the other with its holes: one may lie in a hole of the other.
    try:
        return relation(*one, other[0]) != "apart" and relation(*other, one[0]) != "apart"
    except native("combine").GridMeshError:
        return False  # one encloses nothing yet
