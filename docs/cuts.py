# /// script
# requires-python = "==3.11.*"
# dependencies = ["gridmesh", "matplotlib==3.11.2", "numpy==1.26.4", "pillow==13.0.0"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = ".." }
# ///
"""Pictures of cuts: every stage of one, a flat cut with its patch, and a body cut many times.

    uv run docs/cuts.py

Leaves `cut-stages.png`, `cut-flat.png` and `cut-sculpture.png` in `docs/pictures`, and prints what the caps are like.
"""

from __future__ import annotations

import io
import json
from pathlib import Path

import gridmesh
import matplotlib as mpl
import numpy as np

mpl.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.collections import LineCollection, PolyCollection
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "pictures"

PAPER, INK, SKIN, CAP, LINE = "#F3EFE6", "#20242C", "#8FB6C9", "#E0873A", "#B3202A"

AHEAD = np.array([0.0, 1.0, 0.0])
"""The strokes here are drawn in the front view, (x, 0, z)."""

LIGHT = np.array([-0.45, -0.6, 0.75])


class View:
    """An orthographic view, turned about z and tilted; degrees."""

    def __init__(self, turn: float, tilt: float) -> None:
        """Take the angles."""
        a, b = np.radians(turn), np.radians(tilt)
        self.right = np.array([np.cos(a), np.sin(a), 0.0])
        self.away = np.array([-np.sin(a) * np.cos(b), np.cos(a) * np.cos(b), -np.sin(b)])
        self.up = np.cross(self.right, self.away)

    def seen(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 3) in the plane, (..., 2)."""
        return np.stack([points @ self.right, points @ self.up], axis=-1)


def body(name: str, edge_length: float) -> tuple[np.ndarray, np.ndarray]:
    """The body of a drawing, 1 wide, standing upright: vertices and triangles."""
    drawing = json.loads((ROOT / "tests" / "sketches" / "drawings" / f"{name}.json").read_text())
    outline = np.array(drawing["points"], float)
    low, size = outline.min(axis=0), np.ptp(outline, axis=0).max()
    outline = (outline - low) / size - 0.5 * np.ptp(outline, axis=0) / size
    made = gridmesh.inflate(gridmesh.mesh_sketch(outline, edge_length=edge_length))
    x, y, z = made.vertices.T
    return np.column_stack([x, -z, y]), made.triangles


def front(*points: tuple[float, float]) -> np.ndarray:
    """A stroke of the front view."""
    return np.array([[x, 0.0, z] for x, z in points])


def wave(height: float, width: float, times: float, slope: float = 0.0) -> np.ndarray:
    """A wavy stroke across the front view."""
    x = np.linspace(-0.75, 0.75, 120)
    return np.column_stack([x, 0 * x, height + slope * x + width * np.sin(times * x)])


def ring(x: float, z: float, radius: float) -> np.ndarray:
    """A closed stroke."""
    t = np.linspace(0, 2 * np.pi, 61)
    points = np.column_stack([x + radius * np.cos(t), 0 * t, z + radius * np.sin(t)])
    points[-1] = points[0]
    return points


def faces(piece: gridmesh.Piece) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of a piece, and which of them are of the cap."""
    return piece.corners.reshape(-1, 3), piece.source_face < 0


def draw(ax, view: View, vertices: np.ndarray, triangles: np.ndarray, is_cap: np.ndarray) -> None:
    """Draw what is seen of a closed mesh, the farthest first."""
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    inner = normals @ view.away > 0
    normals[inner] *= -1
    order = np.argsort(-(corners.mean(axis=1) @ view.away))
    bright = 0.45 + 0.55 * np.clip(normals @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
    base = np.where(is_cap[:, None], mpl.colors.to_rgb(CAP), mpl.colors.to_rgb(SKIN))
    base = np.where((inner & ~is_cap)[:, None], 0.72, base)
    collection = PolyCollection(
        view.seen(corners)[order], facecolors=(base * bright[:, None])[order], edgecolors=INK, linewidths=0.25
    )
    ax.add_collection(collection)


def stroke_on(ax, view: View, stroke: np.ndarray, near: float) -> None:
    """Draw a stroke in front of everything."""
    ax.plot(*view.seen(stroke - near * AHEAD).T, color=LINE, linewidth=2, solid_capstyle="round")


def framed(ax, title: str) -> None:
    """Fit the axes to what is drawn."""
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title(title, color=INK, fontsize=10)


def unrolled(points: np.ndarray, stroke: np.ndarray) -> np.ndarray:
    """Points of the swept surface in the plane: along the stroke, and away."""
    line = stroke[:, [0, 2]]
    step = np.diff(line, axis=0)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(step, axis=1))])
    off = points[:, None, [0, 2]] - line[None, :-1]
    share = np.clip((off * step).sum(axis=-1) / (step**2).sum(axis=-1), 0, 1)
    nearest = np.linalg.norm(off - share[..., None] * step, axis=-1).argmin(axis=1)
    rows = np.arange(len(points))
    along = way[nearest] + share[rows, nearest] * np.diff(way)[nearest]
    return np.column_stack([along, points[:, 1]])


def stages(model: tuple[np.ndarray, np.ndarray], stroke: np.ndarray, length: float) -> None:
    """Figure 2 of the paper: a picture for each stage."""
    view = View(24, 32)
    fig, axes = plt.subplots(2, 3, figsize=(11, 6.4), facecolor=PAPER, layout="constrained")
    cut = [
        gridmesh.cut(*model, stroke, direction=AHEAD, keep="right", edge_length=edge, cap=cap)
        for edge, cap in ((None, False), (length, False), (length, True))
    ]
    ax = axes.flat
    draw(ax[0], view, *model, np.zeros(len(model[1]), bool))
    stroke_on(ax[0], view, stroke, 0.35)
    framed(ax[0], "a body and a stroke")
    for k, title in ((0, "divided exactly: faces of all shapes"), (1, "the rim evened out")):
        piece = cut[k].pieces[0]
        draw(ax[k + 1], view, piece.vertices, *faces(piece))
        for loop in piece.cap_loops:
            ax[k + 1].plot(
                *view.seen(piece.vertices[[*loop, loop[0]]]).T, color=LINE, linewidth=1, marker=".", ms=3
            )
        framed(ax[k + 1], title)
    piece = cut[2].pieces[0]
    triangles, is_cap = faces(piece)
    for loop in piece.cap_loops:
        flat = unrolled(piece.vertices[[*loop, loop[0]]], stroke)
        ax[3].plot(*flat.T, color=LINE, linewidth=1, marker=".", ms=4)
    framed(ax[3], "the rim unrolled into the plane")
    flat = unrolled(piece.vertices, stroke)[triangles[is_cap]]
    ax[4].add_collection(PolyCollection(flat, facecolors=CAP, edgecolors=INK, linewidths=0.4))
    framed(ax[4], "a grid patch with the same boundary vertices")
    draw(ax[5], view, piece.vertices, triangles, is_cap)
    framed(ax[5], "rolled up again: the cap")
    save(fig, "cut-stages.png")
    tell("stages", cut[2].report)


def flat_cut(model: tuple[np.ndarray, np.ndarray], stroke: np.ndarray, length: float) -> None:
    """Figure 17: a simple flat cut, and the patch that closes it."""
    view = View(28, 34)
    cut = gridmesh.cut(*model, stroke, direction=AHEAD, keep="right", edge_length=length)
    piece = cut.pieces[0]
    triangles, is_cap = faces(piece)
    fig, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), facecolor=PAPER, layout="constrained")
    draw(left, view, piece.vertices, triangles, is_cap)
    framed(left, "a flat cut")
    flat = unrolled(piece.vertices, stroke)
    # The grid around it, as far as it can be seen to be one.
    patch = flat[triangles[is_cap]]
    rows = np.array([[a, b] for t in patch for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))])
    right.add_collection(PolyCollection(patch, facecolors=CAP, edgecolors="none"))
    right.add_collection(LineCollection(rows, colors=INK, linewidths=0.4))
    for loop in piece.cap_loops:
        right.plot(*flat[[*loop, loop[0]]].T, color=LINE, linewidth=1.4)
    framed(right, "its patch: six neighbours inside")
    save(fig, "cut-flat.png")
    tell("flat", cut.report)


def sculpture(length: float) -> None:
    """Figure 18: many cuts, one after the other, the pieces drawn apart."""
    view = View(20, 22)
    t = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    egg = np.column_stack([0.5 * np.cos(t) * (1 - 0.12 * np.sin(t)), 0.62 * np.sin(t)])
    made = gridmesh.inflate(gridmesh.mesh_sketch(egg, edge_length=length))
    x, y, z = made.vertices.T
    egg = (np.column_stack([x, -z, y]), made.triangles, np.zeros(len(made.triangles), bool))
    fig, (left, right) = plt.subplots(1, 2, figsize=(10, 6), facecolor=PAPER, layout="constrained")

    rest, shells = egg, []
    for k in range(4):
        above, rest = sliced(rest, wave(0.33 - 0.22 * k, 0.05, 9, slope=0.12 * (-1) ** k), length)
        shells.append(above)
    shells.append(rest)
    for number, (vertices, triangles, is_cap) in reversed(list(enumerate(shells))):
        draw(left, view, vertices - [0, 0, 0.3 * number], triangles, is_cap)
    framed(left, "an egg in five pieces")

    whole = egg
    strokes = (ring(0.0, 0.02, 0.2), ring(0.14, -0.34, 0.1), ring(-0.17, -0.3, 0.08), wave(0.42, 0.03, 14))
    for stroke in strokes:
        _, whole = sliced(whole, stroke, length)
    draw(right, view, *whole)
    framed(right, "three tunnels and a wave")
    save(fig, "cut-sculpture.png")


def sliced(model: tuple, stroke: np.ndarray, length: float) -> list[tuple]:
    """Both pieces of a model, each as vertices, triangles, and which of these are of a cap."""
    vertices, triangles, is_cap = model
    cut = gridmesh.cut(vertices, triangles, stroke, direction=AHEAD, edge_length=length)
    tell("slice", cut.report)
    pieces = []
    for piece in cut.pieces:
        own, new = faces(piece)
        pieces.append((piece.vertices, own, new | is_cap[piece.source_face]))
    return pieces


def save(fig, name: str) -> None:
    """Write a picture with few colours, which makes it small."""
    with io.BytesIO() as file:
        fig.savefig(file, dpi=120, facecolor=PAPER)
        Image.open(file).convert("RGB").quantize(96).save(PICTURES / name, optimize=True)


def tell(name: str, report: dict) -> None:
    """Print what the caps are like."""
    print(
        f"{name}: {report['cap_triangles']} triangles, {report['cap_irregular']} of {report['cap_vertices']} inner"
        f" vertices irregular, ratio {report['cap_radius_ratio']:.3f},"
        f" smallest angle {np.degrees(report['cap_min_angle']):.1f} degrees"
    )


def main() -> None:
    """Make all of them."""
    length = 0.03
    whale = body("whale", length)
    stages(whale, wave(0.02, 0.05, 8, slope=0.1), length)
    flat_cut(whale, front((-0.8, 0.0), (0.8, 0.12)), length)
    sculpture(length)


if __name__ == "__main__":
    main()
