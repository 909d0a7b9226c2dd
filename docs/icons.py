"""Write the icons of the toolbar: `uv run docs/icons.py`.

Blender's toolbar shows triangles, not pictures: eight bytes of head ("VCO", version 0, width and height of the field,
an unused origin), then three corners (x, y) of each triangle, then their colours (red, green, blue, alpha); all bytes.
"""

from __future__ import annotations

import itertools
from math import cos, pi, sin
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "addon" / "draw" / "icons"

WHITE, GREY, GREEN, RED = (
    (229, 229, 229, 255),
    (155, 155, 155, 255),
    (117, 255, 175, 255),
    (245, 107, 91, 255),
)
"""Those of Blender's own tools."""
FILL = (117, 255, 175, 70)

Point = tuple[float, float]
Triangle = tuple[tuple[Point, Point, Point], tuple[int, int, int, int]]


def fan(points: list[Point], color: tuple[int, int, int, int]) -> list[Triangle]:
    """Triangles of a region that is seen whole from the middle of its corners."""
    middle = sum(x for x, _ in points) / len(points), sum(y for _, y in points) / len(points)
    return [((middle, a, b), color) for a, b in zip(points, points[1:] + points[:1], strict=True)]


def line(points: list[Point], width: float, color: tuple[int, int, int, int]) -> list[Triangle]:
    """Triangles of a line with round joints."""
    out: list[Triangle] = []
    for (ax, ay), (bx, by) in itertools.pairwise(points):
        length = ((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5
        x, y = -(by - ay) / length * width / 2, (bx - ax) / length * width / 2
        a, b, c, d = (ax + x, ay + y), (ax - x, ay - y), (bx - x, by - y), (bx + x, by + y)
        out += [((a, b, c), color), ((a, c, d), color)]
    for x, y in points[1:-1]:
        out += fan(
            [(x + width / 2 * cos(k * pi / 3), y + width / 2 * sin(k * pi / 3)) for k in range(6)], color
        )
    return out


def blob(
    x: float, y: float, size: float, begin: float = 0.0, end: float = 2 * pi, n: int = 22
) -> list[Point]:
    """Points on a round outline that is no circle."""
    angles = [begin + (end - begin) * k / n for k in range(n + (end - begin < 2 * pi - 1e-6))]
    return [
        (x + size * (1 + 0.12 * cos(2 * t + 0.6)) * cos(t), y + size * (1 + 0.12 * cos(2 * t + 0.6)) * sin(t))
        for t in angles
    ]


def draw() -> list[Triangle]:
    """A grid inside an outline, and the pencil that draws it."""
    outline = blob(112, 112, 78)
    out = fan(outline, FILL)
    rim = [(112 + 52 * cos(k * pi / 3), 112 + 52 * sin(k * pi / 3)) for k in range(7)]
    out += line(rim, 8, GREEN)
    for x, y in rim[:3]:
        out += line([(x, y), (224 - x, 224 - y)], 8, GREEN)
    out += line([*blob(112, 112, 78, 0.9, 2 * pi + 0.25)], 13, WHITE)
    out += fan([(168, 150), (186, 132), (240, 186), (222, 204)], WHITE)
    out += fan([(150, 114), (182, 128), (164, 146)], GREY)
    out += fan([(228, 210), (246, 192), (254, 200), (236, 218)], RED)
    return out


def cut() -> list[Triangle]:
    """A body in two halves that are drawn apart, the cut closed by a grid."""
    out: list[Triangle] = []
    left, right = blob(98, 128, 82, 0.42 * pi, 1.42 * pi), blob(150, 128, 82, -0.58 * pi, 0.42 * pi)
    out += fan(left, FILL) + line(left, 13, WHITE)
    out += fan(right, (150, 150, 150, 90)) + line(right, 9, GREY)
    out += line([left[-1], left[0]], 9, GREEN)
    (ax, ay), (bx, by) = (132, 26), (132 - (right[0][0] - right[-1][0]) * -1.0, 234)
    bx = 132 + (left[0][0] - left[-1][0]) * 1.2
    for k in range(5):
        s, e = k / 5 + 0.02, k / 5 + 0.12
        out += line(
            [(ax + s * (bx - ax), ay + s * (by - ay)), (ax + e * (bx - ax), ay + e * (by - ay))], 9, RED
        )
    return out


def packed(triangles: list[Triangle]) -> bytes:
    """Bytes of the file."""

    def byte(value: float) -> int:
        return min(255, max(0, round(value)))

    corners = bytes(byte(value) for triangle, _ in triangles for point in triangle for value in point)
    colors = bytes(value for _, color in triangles for _ in range(3) for value in color)
    return b"VCO\0" + bytes((255, 255, 0, 0)) + corners + colors


def main() -> None:
    """Write the files."""
    FOLDER.mkdir(exist_ok=True)
    for name, picture in (("gridmesh.draw", draw), ("gridmesh.cut", cut)):
        (FOLDER / f"{name}.dat").write_bytes(packed(picture()))


if __name__ == "__main__":
    main()
