# SPDX-License-Identifier: GPL-3.0-or-later
"""Outer borders of sheets, which are no holes: what would fill them would lie on the sheet. numpy only, no bpy."""

from __future__ import annotations

import numpy as np

_ON_FACES = 0.9
"""Cosine of 26 degrees: a border is that of a sheet if its faces lead into what it encloses, at less than this on average."""


def is_outer(points: np.ndarray, faces: np.ndarray) -> bool:
    """Whether a loop is the outer border of a sheet that is flat there, and no hole in one and no end of a pipe.

    points : (n, 3), in the direction of a patch. faces : (n, 3), from the edge behind each point into its face, of any
    length; zero where there is no face.
    """
    if not (np.isfinite(points).all() and np.isfinite(faces).all()):
        return False
    along = np.roll(points, -1, axis=0) - points
    lengths = np.linalg.norm(along, axis=1)
    about = points - points.mean(axis=0)
    normal = np.cross(about, np.roll(about, -1, axis=0)).sum(axis=0)
    inward = _units(np.cross(normal, along))
    tangents = _units(along)
    into = _units(faces - (faces * tangents).sum(axis=1, keepdims=True) * tangents)
    return bool((lengths * (inward * into).sum(axis=1)).sum() > _ON_FACES * lengths.sum())


def _units(vectors: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths > 0, lengths, 1.0)
