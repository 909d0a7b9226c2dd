# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the outline of a picture with transparency runs, if that is not given: glows and shadows are seen, too. numpy only, no bpy."""

from __future__ import annotations

import numpy as np

LEVELS = (0.5, 0.25, 0.1, 0.04)
"""Alphas that an outline may follow. The first is that of edges, which are opaque on one side; what is below the last is not seen."""

LEFT_OUT = 0.01
"""Of what is seen of a picture a sheet may leave out so much: the share of the sum of alpha."""

LEFT_OUT_OF_BODY = 0.7
"""The same for bodies, which are opaque: glows and shadows are none of theirs, but what is nowhere opaque may become one."""

_FARTHEST = 16
"""The widest margin, in pixels, that is counted as such."""


def level_of(alpha: np.ndarray, margin: float, is_body: bool) -> float:
    """The highest level at which enough of a picture (h, w) lies inside its outline or within the margin, one pixel at least."""
    seen = alpha >= LEVELS[-1]
    total = float(alpha.sum(where=seen, dtype=np.float64))
    allowed = (LEFT_OUT_OF_BODY if is_body else LEFT_OUT) * total
    for level in LEVELS[:-1]:
        near = alpha >= level
        for _ in range(max(1, min(int(margin), _FARTHEST))):
            near = _wider(near)
        if total - float(alpha.sum(where=near & seen, dtype=np.float64)) <= allowed:
            return level
    return LEVELS[-1]


def _wider(mask: np.ndarray) -> np.ndarray:
    """The mask and all pixels beside it or across a corner."""
    rows = mask.copy()
    rows[1:] |= mask[:-1]
    rows[:-1] |= mask[1:]
    wider = rows.copy()
    wider[:, 1:] |= rows[:, :-1]
    wider[:, :-1] |= rows[:, 1:]
    return wider
