# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters of each operation: their names, what values they take, and what they do. No bpy."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..data import defaults

_MOST = 2**31 - 1
"""Largest count: what Blender can number."""


class ParameterError(ValueError):
    """A parameter that is not one. The message says what is allowed."""


@dataclass(frozen=True)
class Param:
    """One parameter. Whether a value suits a drawing is told when the item runs, not here."""

    kind: str
    """"number", "numbers" (a list), "count" (a whole number from 0), "switch", "choice", "text", "file" or "stroke"."""
    help: str
    choices: tuple[str, ...] = ()
    least: float = -math.inf
    most: float = math.inf

    def check(self, name: str, value: Any) -> None:
        """Raise ParameterError if the value is of another kind."""
        if self.kind == "switch":
            good, allowed = isinstance(value, bool), "true or false"
        elif self.kind == "choice":
            good, allowed = value in self.choices, " or ".join(self.choices)
        elif self.kind in ("text", "file"):
            good, allowed = (
                isinstance(value, str) and bool(value) and "\0" not in value,
                "a text that is not empty",
            )
        elif self.kind == "stroke":
            good = (isinstance(value, str) and bool(value) and "\0" not in value) or _is_line(value)
            allowed = "a file, the name of an object, or a list of points"
        elif self.kind == "numbers":
            good = isinstance(value, list) and len(value) >= 2 and all(map(_is_number, value))
            allowed = "a list of two finite numbers or more"
        elif self.kind == "count":
            good = isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= _MOST
            allowed = f"a whole number from 0 to {_MOST}"
        else:
            good = _is_number(value) and self.least <= value <= self.most
            bounded = math.isfinite(self.most)
            allowed = f"a number from {self.least:g} to {self.most:g}" if bounded else "a finite number"
        if not good:
            raise ParameterError(f"{name} is {_shortened(value)}; it must be {allowed}")


_SMOOTH = ("flat", "tangent", "curvature")
_GAPS = "largest gap that is closed, relative to the stroke"

SKETCH = {
    "cells": Param("choice", "what the mesh is made of (triangles)", ("triangles", "quads")),
    "triangles": Param("count", f"triangles of one side ({defaults.TRIANGLES})"),
    "quads": Param("count", f"quads of one side, instead ({defaults.QUADS} where cells are quads)"),
    "edge_length": Param("number", "length of the edges, instead of their number"),
    "boundary": Param("choice", "how the rim is found", ("optimal", "grown")),
    "max_distance": Param("number", "how far the rim may stray, in edge lengths"),
    "bend": Param("number", "how far the grid may bend with the outline (1)", least=0, most=1),
    "density": Param(
        "number",
        f"how much finer thin parts are than others, from 0 to 1 ({defaults.DETAIL:g}: about as fine)",
        least=0,
        most=1,
    ),
    "angle": Param("number", "angle of the grid, radians; the best one if not given"),
    "corner_angle": Param("number", "turns sharper than this are corners, radians"),
    "self_crossing": Param("choice", "what becomes of outlines that cross themselves", ("error", "union")),
}
BODY = {
    "depth": Param("number", "how thick bodies are"),
    "profile": Param("choice", "shape of the section", ("round", "even", "flat", "peak")),
    "curve": Param(
        "numbers", "heights from rim to top, evenly spaced, that reshape the section; the first is 0"
    ),
}

SPRITE_TRIANGLES, SPRITE_UNIT = 500, 100.0
"""Triangles of one side, and pixels of a metre in .glb, .gltf and .blend files."""

_WELD = Param(
    "switch", "join vertices at the same place (in .ply, .glb and .gltf files, which tear meshes at seams)"
)

_PATCH_CELLS = Param(
    "choice",
    "what patches are made of; of quads, one triangle if a rim is odd (triangles)",
    ("triangles", "quads"),
)

OPS: Mapping[str, Mapping[str, Param]] = {
    "strokes": {
        **SKETCH,
        **BODY,
        "close_gaps": Param("number", f"{_GAPS} ({defaults.CLOSE_GAPS})", least=0, most=1),
        "holes": Param("switch", "outlines inside others are holes (true)"),
    },
    "fill": {
        "weld": _WELD,
        "smooth": Param("choice", "how patches continue the surface (tangent)", _SMOOTH),
        "max_edges": Param(
            "count", f"holes with more edges stay open; 0: none does ({defaults.MAX_HOLE_EDGES})"
        ),
        "cells": _PATCH_CELLS,
        "max_open_edges": Param(
            "count", f"meshes with more open edges are refused ({defaults.MAX_OPEN_EDGES})"
        ),
    },
    "regrid": {
        "weld": _WELD,
        "select": Param(
            "text",
            "only the faces of this vertex group, material or face attribute; without, every connected area of one material",
        ),
        "cells": _PATCH_CELLS,
        "keep_shape": Param("switch", "lay the grid on the old surface (true)"),
        "smooth": Param("choice", "without keep_shape: how patches continue the surface (tangent)", _SMOOTH),
    },
    "cut": {
        "weld": _WELD,
        "stroke": Param("stroke", "file (.json, .csv, .svg), object of the .blend file, or points"),
        "closed": Param("switch", "whether the stroke is closed; otherwise as it was drawn"),
        "direction": Param(
            "choice",
            "what the stroke is swept along (z; in a .blend file its normal)",
            ("plane", "x", "y", "z"),
        ),
        "keep": Param("choice", "side that is kept (both)", ("left", "right", "both")),
        "together": Param("switch", "both sides stay one object (false)"),
        "cap": Param("switch", "close the pieces where they were cut (true)"),
        "edge_length": Param("number", "length of the edges along the cut; 0: as the mesh has them (0)"),
        "smooth": Param("choice", "shape of the caps (flat)", _SMOOTH),
        "cells": _PATCH_CELLS,
        "gap": Param("number", "width of what is taken away (0)"),
        "extend_ends": Param("switch", "the ends of the stroke are continued through everything (true)"),
        "close_gaps": Param("number", f"{_GAPS} ({defaults.CUT_CLOSE_GAPS})", least=0, most=1),
    },
    "join": {
        "weld": _WELD,
        "blend": Param(
            "number",
            f"edge lengths to each side of a joint that become smooth; 0 keeps the crease ({defaults.BLEND:g})",
            least=0,
            most=1000,
        ),
        "edge_length": Param("number", "the edge length that blend counts in; 0: that of each part (0)"),
        "strict": Param("switch", "joints that meet themselves or the parts are refused (false)"),
    },
    "sprites": {
        "shape": Param("choice", "a flat sheet, or a closed body (flat)", ("flat", "body")),
        "triangles": Param("count", f"triangles of one side ({SPRITE_TRIANGLES})"),
        "background": Param(
            "choice",
            "what of the picture is left out (auto: what is transparent, or paper where nothing is)",
            ("auto", "transparent", "paper"),
        ),
        "threshold": Param(
            "number",
            "cover of a pixel that lies inside; 0.5, less for glows and shadows of sheets, on paper the best one",
            least=0.001,
            most=0.999,
        ),
        "smooth": Param("number", "how far along the outline pixels are smoothed (1)", least=0, most=10),
        "min_area": Param(
            "number", "islands and holes of fewer pixels are left out (4, on paper 16)", least=0, most=1e9
        ),
        "margin": Param(
            "number",
            "pixels that the outline is moved outward (1; of a body, where it is opaque, 0)",
            least=0,
            most=1000,
        ),
        "holes": Param("switch", "holes of the picture stay open (true)"),
        "bones": Param("file", "JSON file of bones that get weights, for .json and .tscn"),
        **BODY,
        "unit": Param(
            "number", f"pixels of a metre in .glb, .gltf and .blend ({SPRITE_UNIT:g})", least=1e-6, most=1e9
        ),
    },
}


def check(op: str, params: dict[str, Any]) -> None:
    """Check the parameters of an item.

    Raises
    ------
    ParameterError
        If one is unknown, has a value of another kind, or is missing.
    """
    known = OPS[op]
    if unknown := sorted(params.keys() - known.keys()):
        raise ParameterError(f"unknown parameter '{unknown[0]}'; allowed: {', '.join(sorted(known))}")
    for name, value in params.items():
        known[name].check(name, value)
    if op == "strokes":
        _check_fineness(params)
    if op == "cut" and "stroke" not in params:
        raise ParameterError("the cut has no 'stroke'")


def _check_fineness(params: dict[str, Any]) -> None:
    given = [name for name in ("triangles", "quads", "edge_length") if name in params]
    if len(given) > 1:
        raise ParameterError(f"give {given[0]} or {given[1]}, not both")
    cells = params.get("cells", given[0] if given else "triangles")
    if given and given[0] != "edge_length" and given[0] != cells:
        raise ParameterError(f"cells are {cells} and {given[0]} are given; give {cells}, or leave one out")


def _is_line(value: Any) -> bool:
    """Whether this is a list of two or more points of the same dimension, 2 or 3."""
    if not isinstance(value, list) or len(value) < 2:
        return False
    dimensions = {len(point) if isinstance(point, list) else 0 for point in value}
    numbers = (number for point in value if isinstance(point, list) for number in point)
    return dimensions in ({2}, {3}) and all(map(_is_number, numbers))


def _is_number(value: Any) -> bool:
    """Whether this is a number that a float can hold; JSON has larger ones."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    return abs(value) <= sys.float_info.max  # of whole numbers of any size; false for nan


def _shortened(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
