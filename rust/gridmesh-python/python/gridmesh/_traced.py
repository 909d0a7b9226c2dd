"""What ``trace_image`` returns."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


class Traced(list[tuple[npt.NDArray[np.float64], list[npt.NDArray[np.float64]]]]):
    """Outlines with their holes, largest first, and what was left out.

    Attributes
    ----------
    dropped : int
        Islands that were smaller than `min_area`.
    filled : int
        Holes that were smaller than `min_area`.
    threshold : float
        The threshold that was used.
    """

    def __init__(
        self,
        parts: list[tuple[npt.NDArray[np.float64], list[npt.NDArray[np.float64]]]],
        dropped: int = 0,
        filled: int = 0,
        threshold: float = 0.5,
    ) -> None:
        super().__init__(parts)
        self.dropped = dropped
        self.filled = filled
        self.threshold = threshold
