"""Pictures of outlines, and how near an outline traced from one comes to what was drawn."""

from __future__ import annotations

import numpy as np


def sampled(contours: list[np.ndarray], width: int, height: int, samples: int) -> np.ndarray:
    """Whether each sample of a pixel lies inside (even-odd), (height samples, width samples), from below."""
    toggles = np.zeros((height * samples, width * samples + 1), np.int8)
    for contour in contours:
        for (x0, y0), (x1, y1) in zip(contour * samples, np.roll(contour, -1, axis=0) * samples, strict=True):
            low, high = sorted((y0, y1))
            rows = np.arange(max(np.ceil(low - 0.5), 0), min(np.ceil(high - 0.5), len(toggles)), dtype=int)
            if len(rows):
                x = x0 + (rows + 0.5 - y0) * (x1 - x0) / (y1 - y0)
                toggles[rows, np.clip(np.ceil(x - 0.5), 0, toggles.shape[1] - 1).astype(int)] ^= 1
    return np.bitwise_xor.accumulate(toggles, axis=1)[:, :-1].astype(bool)


def coverage(contours: list[np.ndarray], width: int, height: int, samples: int = 4) -> np.ndarray:
    """Coverage by pixel, rows from the top, as anti-aliased alpha."""
    inside = sampled(contours, width, height, samples)
    blocks = inside.reshape(height, samples, width, samples).mean(axis=(1, 3))
    return blocks[::-1]


def placed(contours: list[np.ndarray], size: int, border: float = 3.3) -> list[np.ndarray]:
    """Contours scaled into a square picture."""
    outline = contours[0]
    low, high = outline.min(axis=0), outline.max(axis=0)
    scale = (size - 2 * border) / (high - low).max()
    return [(contour - (low + high) / 2) * scale + size / 2 for contour in contours]


def likeness(found: list[np.ndarray], drawn: list[np.ndarray], size: int, samples: int = 8) -> float:
    """Intersection over union."""
    a, b = (sampled(contours, size, size, samples) for contours in (found, drawn))
    return float((a & b).sum() / (a | b).sum())


def corners(contour: np.ndarray, side: float = 6.0, turn: float = np.pi / 4) -> np.ndarray:
    """Points where straight sides of some length meet at an angle."""
    before, after = contour - np.roll(contour, 1, axis=0), np.roll(contour, -1, axis=0) - contour
    lengths = np.minimum(np.hypot(*before.T), np.hypot(*after.T))
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    angles = np.abs(np.arctan2(cross, (before * after).sum(axis=1)))
    return contour[(lengths >= side) & (angles >= turn)]


def dense(contour: np.ndarray, step: float = 0.5) -> np.ndarray:
    """Points all along a closed line."""
    ends = np.roll(contour, -1, axis=0)
    counts = np.maximum(np.ceil(np.hypot(*(ends - contour).T) / step), 1).astype(int)
    t = np.concatenate([np.arange(n) / n for n in counts])[:, None]
    return np.repeat(contour, counts, axis=0) * (1 - t) + np.repeat(ends, counts, axis=0) * t
