# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves from JSON and CSV files. No bpy."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from ..bodies.outlines import Stroke

# Longer integers are beyond the largest float.
DIGITS = 308


_CURVE = "one curve is {'points': [[x, y], ...]}, or a list with one list of points"
"""How curves are written in JSON."""


class InputError(ValueError):
    """A file holds no curves. The message says why."""


def curves(path: Path, data: bytes, *, cyclic: bool = True) -> list[Stroke]:
    """Curves of a file, in the plane z = 0; closed unless it is said that they are not.

    JSON: {"points": [[x, y], ...], "holes": [[[x, y], ...], ...]}, or a list of curves.
    CSV: x, y in each row; an empty row between curves.
    """
    try:
        text = data.decode("utf-8-sig")
        found = _json(json.loads(text, parse_int=_integer)) if path.suffix.lower() == ".json" else _csv(text)
        arrays = [np.asarray(points, float) for points in found]
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise InputError(f"it is no list of curves: {error}") from error
    if not arrays:
        raise InputError("it has no curves")
    for points in arrays:
        if points.ndim != 2 or points.shape[1] != 2:
            raise InputError(f"a curve has shape {points.shape}; it must be a list of points [x, y]")
    return [
        Stroke(np.column_stack([points, np.zeros(len(points))]), cyclic, path.stem, "", at, len(arrays))
        for at, points in enumerate(arrays)
    ]


def _integer(digits: str) -> int:
    if len(digits) > DIGITS:
        raise InputError(f"a curve has a number of {len(digits)} digits")
    return int(digits)


def _json(value: Any) -> list[Any]:
    if isinstance(value, dict):
        if "points" not in value:
            raise InputError(f"it has no 'points'; {_CURVE}")
        holes = value.get("holes", [])
        if not isinstance(holes, list):
            raise InputError(f"its 'holes' are {holes!r:.40}; they must be a list of curves")
        value = [value["points"], *holes]
    if not isinstance(value, list):
        raise InputError(f"it holds {json.dumps(value):.40}; {_CURVE}")
    for points in value:
        if not isinstance(points, list):
            raise InputError(f"it has {json.dumps(points):.40} where a curve belongs; {_CURVE}")
        for point in points:
            if not isinstance(point, list):
                raise InputError(f"a curve has {point!r:.40} where a point [x, y] belongs; {_CURVE}")
            for number in point:
                if type(number) not in (int, float, type(None)):  # numpy would take true and "1" for 1
                    raise InputError(f"a curve has {number!r:.40}, which is no number")
    return list(value)


def _csv(text: str) -> list[list[list[float]]]:
    found: list[list[list[float]]] = [[]]
    for row, line in enumerate(text.splitlines(), 1):
        if line.strip(" \t,;"):
            found[-1].append(_point(row, line))
        elif found[-1]:
            found.append([])
    return [points for points in found if points]


def _point(row: int, line: str) -> list[float]:
    try:
        point = [float(cell) for cell in line.split(",")]
    except ValueError:
        point = []
    if len(point) != 2:
        hint = "a row is x,y, with a point in decimals; no headings, quotes or other separators"
        raise InputError(f"row {row} is {line.strip()!r:.40}; {hint}")
    return point
