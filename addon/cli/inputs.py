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
            raise InputError("it has no 'points'")
        value = [value["points"], *value.get("holes", [])]
    for points in value:
        for point in points:
            if not isinstance(point, list):
                hint = "one curve is {'points': [[x, y], ...]}, or a list with one list of points"
                raise InputError(f"a curve has {point!r:.40} where a point [x, y] belongs; {hint}")
            for number in point:
                if type(number) not in (int, float, type(None)):  # numpy would take true and "1" for 1
                    raise InputError(f"a curve has {number!r:.40}, which is no number")
    return list(value)


def _csv(text: str) -> list[list[list[float]]]:
    found: list[list[list[float]]] = [[]]
    for line in text.splitlines():
        if line.strip(" \t,;"):
            found[-1].append([float(cell) for cell in line.split(",")])
        elif found[-1]:
            found.append([])
    return [points for points in found if points]
