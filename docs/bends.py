"""Draw the same drawing on a straight and on a bent lattice: `docs/pictures/bent.svg`.

    python docs/bends.py

Needs the `gridmesh` module. Irregular vertices of the body are marked.
"""

from __future__ import annotations

import json
from pathlib import Path

import gridmesh
import numpy as np

ROOT = Path(__file__).parent.parent
SIZE = 420
NAMES = ("frog", "snowflake")
TRIANGLES = 1200


def irregular(patch: gridmesh.Patch) -> np.ndarray:
    """Boundary vertices that turn: of two glued copies they have another valence than six."""
    sides = np.concatenate([patch.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    valence = np.bincount(edges.ravel(), minlength=len(patch.vertices))
    rim = np.concatenate([np.asarray(loop) for loop in patch.loops])
    return rim[valence[rim] != 4]


def drawn(patch: gridmesh.Patch, x: float, y: float, low: np.ndarray, scale: float) -> str:
    """A patch as lines and dots, its box at x, y."""
    at = (patch.vertices - low) * scale
    at = np.column_stack([x + at[:, 0], y + SIZE - at[:, 1]])
    sides = np.concatenate([patch.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    lines = "".join("M{:.1f} {:.1f}L{:.1f} {:.1f}".format(*at[a], *at[b]) for a, b in edges)
    dots = "".join('<circle cx="{:.1f}" cy="{:.1f}" r="4"/>'.format(*at[v]) for v in irregular(patch))
    return f'<path d="{lines}" stroke="#346" stroke-width=".6" fill="none"/><g fill="#d32">{dots}</g>'


def main() -> None:
    """Write the picture."""
    parts = []
    for row, name in enumerate(NAMES):
        sketch = json.loads((ROOT / "tests" / "sketches" / "drawings" / f"{name}.json").read_text("utf-8"))
        points = np.array(sketch["points"], float)
        low = points.min(axis=0)
        scale = (SIZE - 30) / np.ptp(points, axis=0).max()
        for column, bend in enumerate((0.0, 1.0)):
            patch = gridmesh.mesh_sketch(points, triangles=TRIANGLES, bend=bend)
            x, y = 20 + column * SIZE, 10 + row * SIZE
            parts.append(drawn(patch, x, y, low, scale))
            count = f"{'bent' if bend else 'straight'}: {patch.report['irregular']} irregular vertices"
            parts.append(
                f'<text x="{x}" y="{y + SIZE + 4}" font-family="sans-serif" font-size="15">{count}</text>'
            )
    width, height = 20 + 2 * SIZE, 30 + len(NAMES) * SIZE
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">'
    ground = f'<rect width="{width}" height="{height}" fill="white"/>'
    text = head + ground + "".join(parts) + "</svg>\n"
    (ROOT / "docs" / "pictures" / "bent.svg").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
