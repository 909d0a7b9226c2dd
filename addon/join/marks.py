# SPDX-License-Identifier: GPL-3.0-or-later
"""Marks of what a whole was made of, compared as closely as Blender's matrices allow. numpy only, no bpy."""

from __future__ import annotations

import zlib

import numpy as np

TURNED = 2e-5
"""Entries of the linear part of a matrix that differ by less are the same."""

MOVED = 1e-5
"""Places that differ by less are the same, in the whole's own units."""

ROUNDED = 1e-6
"""The same for each unit of the distance from the world's origin: matrices have single precision."""


def mark(texts: list[str], own: np.ndarray, placed: list[np.ndarray]) -> str:
    """Mark of texts, and of how parts with these matrices lie to a whole with the matrix `own`: a hash, then numbers."""
    is_flat = abs(np.linalg.det(own)) == 0
    # Parts of what is flat lie to it in no way that could be told.
    lies = [own if is_flat else np.linalg.solve(own, matrix) for matrix in placed]
    far = max([np.linalg.norm(matrix[:3, 3]) for matrix in [own, *placed]])
    size = np.linalg.norm(own[:3, :3], axis=0).min()
    allowed = MOVED + ROUNDED * far / size if size > 0 else MOVED
    numbers = [allowed, *(number for matrix in lies for number in matrix[:3].ravel())]
    known = f"{zlib.crc32(' '.join(texts).encode()):08x}"
    return " ".join([known, *(f"{number:.9g}" for number in numbers)])


def is_same(first: str, second: str) -> bool:
    """Whether two marks are of the same texts and of parts that lie alike."""
    if first == second:
        return True
    if not first or not second:
        return False
    (known, *numbers), (other, *others) = first.split(" "), second.split(" ")
    if known != other or len(numbers) != len(others) or not numbers:
        return False
    before, after = np.array(numbers, float), np.array(others, float)
    apart = np.abs(after - before)[1:].reshape(-1, 3, 4)
    allowed = max(before[0], after[0])
    sizes = np.maximum(1.0, np.abs(after[1:]).reshape(-1, 3, 4)[..., :3])
    return bool((apart[..., :3] <= TURNED * sizes).all() and (apart[..., 3] <= allowed).all())
