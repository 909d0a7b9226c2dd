"""The shared sketches of tests/sketches, and shapes made on the spot."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent.parent / "sketches"


def load(folder: str) -> dict[str, dict]:
    """All sketches of one folder by name; null coordinates are NaN."""
    sketches = {}
    for path in sorted((FOLDER / folder).glob("*.json")):
        sketch = json.loads(path.read_text(encoding="utf-8"))
        points = [[np.nan if c is None else c for c in point] for point in sketch["points"]]
        sketch["points"] = np.array(points, float).reshape(-1, 2)
        sketches[path.stem] = sketch
    return sketches


DRAWINGS = load("drawings")
SHAPES = load("shapes")
BAD = load("bad")


def circle(n: int = 100, radius: float = 1.0) -> np.ndarray:
    """Points on a circle around the origin, (n, 2)."""
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def blob(amplitudes: list[float], phases: list[float], n: int = 120) -> np.ndarray:
    """A closed curve around the origin: its radius is 1 plus one wave per amplitude, always above 0.2."""
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    waves = [a * np.cos((k + 2) * angle + p) for k, (a, p) in enumerate(zip(amplitudes, phases, strict=True))]
    radius = np.maximum(1 + np.sum(waves, axis=0), 0.2)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
