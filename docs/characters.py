# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "gridmesh", "numpy==1.26.4"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = ".." }
# ///
"""Characters from a few strokes each: drawn in layers, joined to one closed body by the operator, rendered.

    uv run docs/characters.py [NAME ...]

Each is one grease-pencil drawing. *Strokes to Mesh* with *Join Overlapping Strokes* makes one object of it. Leaves `out/characters.blend` and
`docs/pictures/characters.png`, and prints a table of numbers.
"""

from __future__ import annotations

import argparse
import math
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import studio

# isort: split
import bpy
import numpy as np
from mathutils import Vector

ROOT = Path(__file__).resolve().parent.parent
CELL, ROW = 2.7, 3.3
"""Width and height of a cell of the picture."""


# ---------------------------------------------------------------------------------------------- the strokes


def oval(x: float, y: float, width: float, height: float, turn: float = 0.0, n: int = 48) -> np.ndarray:
    """Points (n, 2) of an ellipse by its half axes, turned counter-clockwise by degrees."""
    t, a = np.linspace(0, 2 * np.pi, n, endpoint=False), math.radians(turn)
    u, v = width * np.cos(t), height * np.sin(t)
    return np.column_stack([x + u * np.cos(a) - v * np.sin(a), y + u * np.sin(a) + v * np.cos(a)])


def smooth(*points: tuple[float, float], n: int = 8) -> np.ndarray:
    """Points of a closed curve through a few, as a steady hand draws it (Catmull and Rom)."""
    p = np.array(points, float)
    before, after, next_one = np.roll(p, 1, axis=0), np.roll(p, -1, axis=0), np.roll(p, -2, axis=0)
    t = np.linspace(0, 1, n, endpoint=False)[None, :, None]
    a, b, c, d = (q[:, None] for q in (before, p, after, next_one))
    curve = b + t * (c - a) / 2 + t**2 * (a - 2.5 * b + 2 * c - d / 2) + t**3 * (1.5 * (b - c) + (d - a) / 2)
    return curve.reshape(-1, 2)


def straight(*points: tuple[float, float], n: int = 6) -> np.ndarray:
    """Points of a polygon with sharp corners."""
    p = np.array(points, float)
    t = np.linspace(0, 1, n, endpoint=False)[None, :, None]
    return (p[:, None] * (1 - t) + np.roll(p, -1, axis=0)[:, None] * t).reshape(-1, 2)


def box(x: float, y: float, width: float, height: float) -> np.ndarray:
    """A rectangle around a point, by its half sides."""
    return straight(
        (x - width, y - height), (x + width, y - height), (x + width, y + height), (x - width, y + height)
    )


def both(stroke: np.ndarray) -> list[np.ndarray]:
    """A stroke and its mirror image."""
    return [stroke, stroke * [-1, 1]]


@dataclass(frozen=True)
class Layer:
    """Strokes of one colour, in one layer."""

    colour: str
    strokes: list[np.ndarray]


@dataclass(frozen=True)
class Character:
    """A drawing, its layers from behind to the front, and options of the operator."""

    name: str
    layers: list[Layer]
    options: dict


def rabbit() -> list[Layer]:
    """From the front, sitting."""
    fur, inner, ink = "#D9C7AE", "#E3A6A6", "#3B3036"
    ear = smooth(
        (0.08, 0.95),
        (0.2, 1.4),
        (0.3, 1.95),
        (0.44, 2.08),
        (0.55, 1.92),
        (0.5, 1.5),
        (0.4, 1.05),
        (0.25, 0.8),
    )
    foot = oval(0.42, -0.92, 0.3, 0.19, 8)
    return [
        Layer(fur, both(ear)),
        Layer(fur, [oval(0, -0.28, 0.62, 0.72), oval(0, 0.72, 0.56, 0.48)]),
        Layer(fur, both(foot)),
        Layer(inner, [oval(0, 0.58, 0.12, 0.09)]),
        Layer(ink, both(oval(0.24, 0.8, 0.1, 0.12))),
    ]


def fish() -> list[Layer]:
    """From the side."""
    orange, white, ink = "#E4762B", "#F1EEE6", "#3B3036"
    tail = smooth(
        (0.6, 0.14),
        (1.0, 0.5),
        (1.22, 0.62),
        (1.2, 0.3),
        (1.12, 0.0),
        (1.2, -0.3),
        (1.22, -0.6),
        (1.0, -0.48),
        (0.6, -0.12),
    )
    fin = smooth((-0.5, 0.4), (-0.3, 0.95), (0.05, 1.08), (0.5, 0.85), (0.62, 0.4), (0.1, 0.4))
    below = smooth((-0.1, -0.4), (0.05, -0.85), (0.35, -0.95), (0.45, -0.7), (0.4, -0.35))
    side = smooth((-0.16, 0.1), (0.2, 0.26), (0.56, 0.2), (0.5, 0.0), (0.52, -0.24), (0.2, -0.26))
    body = smooth(
        (-1.15, 0.02),
        (-0.95, 0.34),
        (-0.5, 0.6),
        (0.0, 0.66),
        (0.5, 0.42),
        (0.85, 0.14),
        (0.85, -0.12),
        (0.5, -0.4),
        (0.0, -0.62),
        (-0.5, -0.58),
        (-0.95, -0.3),
    )
    return [
        Layer(orange, [tail, fin, below]),
        Layer(orange, [body]),
        Layer(white, [side, oval(-0.64, 0.14, 0.2, 0.2)]),
        Layer(ink, [oval(-0.68, 0.14, 0.12, 0.12)]),
    ]


def octopus() -> list[Layer]:
    """From the front, with six arms."""
    violet, ink = "#8E6BB0", "#2E2632"
    outer = smooth(
        (0.3, -0.02),
        (0.62, -0.3),
        (0.98, -0.36),
        (1.22, -0.12),
        (1.34, -0.02),
        (1.4, -0.16),
        (1.26, -0.48),
        (0.98, -0.66),
        (0.58, -0.6),
        (0.2, -0.32),
    )
    middle = smooth(
        (0.28, -0.15),
        (0.56, -0.6),
        (0.86, -0.88),
        (1.12, -0.9),
        (1.18, -1.04),
        (1.04, -1.16),
        (0.74, -1.12),
        (0.42, -0.88),
        (0.14, -0.4),
    )
    inner = smooth(
        (0.06, -0.2),
        (0.3, -0.25),
        (0.36, -0.8),
        (0.5, -1.14),
        (0.52, -1.34),
        (0.38, -1.4),
        (0.2, -1.2),
        (0.1, -0.8),
    )
    head = smooth(
        (0, -0.38),
        (0.42, -0.26),
        (0.56, 0.12),
        (0.76, 0.62),
        (0.7, 1.1),
        (0.36, 1.42),
        (0, 1.5),
        (-0.36, 1.42),
        (-0.7, 1.1),
        (-0.76, 0.62),
        (-0.56, 0.12),
        (-0.42, -0.26),
    )
    return [
        Layer(violet, both(middle)),
        Layer(violet, [*both(outer), head]),
        Layer(violet, both(inner)),
        Layer(ink, both(oval(0.28, 0.34, 0.13, 0.16))),
    ]


def dinosaur() -> list[Layer]:
    """From the side: the whole back is one stroke."""
    green, light, ink = "#5E8F7B", "#B9C98A", "#2E2632"
    back = smooth(
        (-1.14, 1.12),
        (-0.92, 1.3),
        (-0.64, 1.2),
        (-0.52, 0.9),
        (-0.44, 0.45),
        (-0.1, 0.3),
        (0.35, 0.28),
        (0.72, 0.02),
        (1.0, -0.3),
        (1.4, -0.5),
        (1.36, -0.6),
        (0.95, -0.56),
        (0.6, -0.52),
        (0.1, -0.55),
        (-0.4, -0.5),
        (-0.72, -0.25),
        (-0.8, 0.3),
        (-0.84, 0.78),
        (-1.1, 0.9),
    )
    far = [oval(-0.24, -0.68, 0.17, 0.4, 4), oval(0.62, -0.64, 0.17, 0.4, -4)]
    near = [
        smooth(
            (-0.66, -0.3),
            (-0.3, -0.25),
            (-0.3, -0.7),
            (-0.26, -1.06),
            (-0.5, -1.12),
            (-0.72, -1.06),
            (-0.66, -0.7),
        ),
        smooth(
            (0.14, -0.2),
            (0.56, -0.2),
            (0.56, -0.66),
            (0.54, -1.06),
            (0.3, -1.12),
            (0.08, -1.06),
            (0.16, -0.66),
        ),
    ]
    return [
        Layer(green, far),
        Layer(green, [back]),
        Layer(green, near),
        Layer(
            light, [oval(-0.1, 0.06, 0.15, 0.13), oval(0.3, 0.06, 0.12, 0.11), oval(-0.6, 0.5, 0.09, 0.12)]
        ),
        Layer(ink, [oval(-0.88, 1.1, 0.085, 0.09)]),
    ]


def characters() -> list[Character]:
    """All of them."""
    brown, cream, ink = "#B9773F", "#EBCFA2", "#3B3036"
    bear = [
        Layer(brown, [*both(oval(0.36, -0.72, 0.26, 0.32, -12)), *both(oval(0.44, 1.36, 0.2, 0.2))]),
        Layer(brown, [oval(0, -0.1, 0.62, 0.74), oval(0, 1.0, 0.58, 0.5)]),
        Layer(
            brown,
            both(smooth((0.4, 0.42), (0.62, 0.38), (0.92, 0.0), (0.98, -0.25), (0.78, -0.32), (0.62, -0.05))),
        ),
        Layer(cream, [oval(0, 0.86, 0.27, 0.21)]),
        Layer(ink, [oval(0, 0.95, 0.12, 0.09), *both(oval(0.22, 1.17, 0.1, 0.11))]),
    ]
    blue, white, orange = "#4F8FC0", "#EEF1EC", "#E8963A"
    bird = [
        Layer(
            orange,
            both(
                smooth((0.1, -0.75), (0.28, -0.75), (0.3, -1.02), (0.46, -1.1), (0.2, -1.16), (0.06, -1.08))
            ),
        ),
        Layer(blue, [smooth((-0.45, -0.55), (-0.75, -0.95), (-1.05, -1.05), (-0.95, -0.65), (-0.7, -0.2))]),
        Layer(
            blue,
            [
                smooth(
                    (0.05, -0.8),
                    (0.55, -0.55),
                    (0.72, 0.0),
                    (0.66, 0.55),
                    (0.42, 0.95),
                    (0.0, 1.08),
                    (-0.38, 0.9),
                    (-0.52, 0.45),
                    (-0.68, 0.0),
                    (-0.55, -0.55),
                )
            ],
        ),
        Layer(
            white, [smooth((0.25, -0.66), (0.55, -0.3), (0.56, 0.1), (0.3, 0.28), (0.05, 0.05), (0.02, -0.4))]
        ),
        Layer(
            blue,
            [
                smooth(
                    (-0.5, 0.35),
                    (-0.18, 0.3),
                    (0.02, -0.05),
                    (-0.12, -0.45),
                    (-0.6, -0.75),
                    (-0.85, -0.62),
                    (-0.72, -0.1),
                )
            ],
        ),
        Layer(orange, [smooth((0.42, 0.72), (0.7, 0.66), (1.0, 0.52), (0.72, 0.42), (0.44, 0.46))]),
        Layer(ink, [oval(0.12, 0.64, 0.13, 0.14)]),
    ]
    steel, dark, lamp = "#8C9BA8", "#5A6672", "#E2C044"
    robot = [
        Layer(
            dark,
            [
                *both(box(0.3, -0.95, 0.16, 0.4)),
                box(0, 0.55, 0.14, 0.25),
                *both(box(0.75, 0.05, 0.28, 0.12)),
                box(0, 1.5, 0.06, 0.3),
            ],
        ),
        Layer(
            steel,
            [
                box(0, -0.1, 0.55, 0.6),
                box(0, 1.0, 0.5, 0.36),
                *both(box(0.98, -0.2, 0.16, 0.42)),
                *both(box(0.34, -1.32, 0.26, 0.14)),
            ],
        ),
        Layer(
            lamp, [*both(oval(0.2, 1.06, 0.12, 0.12)), oval(0, 1.82, 0.13, 0.13), box(0, -0.02, 0.28, 0.2)]
        ),
    ]
    skin = "#D9A282"
    hand = [
        Layer(
            skin,
            [
                smooth(
                    (-0.42, -1.1),
                    (0.38, -1.1),
                    (0.42, -0.6),
                    (0.56, -0.1),
                    (0.5, 0.3),
                    (0.0, 0.42),
                    (-0.5, 0.3),
                    (-0.52, -0.2),
                    (-0.4, -0.6),
                ),
                smooth(
                    (-0.54, 0.1),
                    (-0.26, 0.12),
                    (-0.3, 0.6),
                    (-0.4, 1.0),
                    (-0.54, 1.04),
                    (-0.6, 0.9),
                    (-0.58, 0.5),
                ),
                smooth(
                    (-0.24, 0.1),
                    (0.04, 0.12),
                    (0.03, 0.75),
                    (-0.02, 1.22),
                    (-0.15, 1.28),
                    (-0.24, 1.18),
                    (-0.25, 0.7),
                ),
                smooth(
                    (0.06, 0.1),
                    (0.32, 0.12),
                    (0.36, 0.7),
                    (0.34, 1.1),
                    (0.22, 1.16),
                    (0.12, 1.06),
                    (0.09, 0.65),
                ),
                smooth(
                    (0.33, -0.02),
                    (0.55, 0.05),
                    (0.68, 0.5),
                    (0.72, 0.76),
                    (0.6, 0.84),
                    (0.5, 0.74),
                    (0.4, 0.4),
                ),
            ],
        ),
        Layer(
            skin,
            [
                smooth(
                    (-0.3, -0.6),
                    (-0.28, -0.25),
                    (-0.6, 0.0),
                    (-0.92, 0.28),
                    (-1.04, 0.24),
                    (-1.02, 0.08),
                    (-0.75, -0.3),
                    (-0.5, -0.68),
                )
            ],
        ),
    ]
    grey, pink = "#8F8A97", "#E3A6A6"
    cat = [
        Layer(
            grey,
            [
                smooth(
                    (0.3, -0.85),
                    (0.75, -0.8),
                    (1.02, -0.35),
                    (0.92, 0.15),
                    (1.05, 0.42),
                    (0.92, 0.5),
                    (0.74, 0.2),
                    (0.8, -0.3),
                    (0.62, -0.58),
                    (0.3, -0.6),
                )
            ],
        ),
        Layer(grey, both(smooth((0.12, 1.05), (0.5, 0.85), (0.62, 1.3), (0.58, 1.5), (0.42, 1.42)))),
        Layer(
            grey,
            [
                smooth(
                    (0, 0.5),
                    (0.32, 0.3),
                    (0.52, -0.4),
                    (0.5, -0.85),
                    (0.2, -0.98),
                    (-0.2, -0.98),
                    (-0.5, -0.85),
                    (-0.52, -0.4),
                    (-0.32, 0.3),
                ),
                oval(0, 0.75, 0.6, 0.48),
            ],
        ),
        Layer(
            white,
            [
                oval(0, -0.2, 0.25, 0.36),
                *both(oval(0.13, 0.58, 0.17, 0.13)),
                *both(oval(0.24, -0.95, 0.2, 0.14)),
            ],
        ),
        Layer(pink, [oval(0, 0.7, 0.12, 0.08)]),
        Layer(ink, both(oval(0.25, 0.9, 0.14, 0.16))),
    ]
    green, spot = "#6FA56A", "#C9D98A"
    turtle = [
        Layer(
            green,
            [
                *both(oval(0.72, 0.42, 0.4, 0.2, 28)),
                *both(oval(0.66, -0.6, 0.34, 0.18, -35)),
                smooth((-0.1, -0.8), (0.1, -0.8), (0.05, -1.05), (0, -1.15), (-0.05, -1.05)),
                oval(0, 1.02, 0.32, 0.4),
            ],
        ),
        Layer("#8A6A45", [oval(0, 0.0, 0.76, 0.88)]),
        Layer(
            spot,
            [
                oval(0, 0.02, 0.24, 0.26),
                *both(oval(0.4, 0.36, 0.16, 0.17)),
                *both(oval(0.4, -0.36, 0.16, 0.17)),
            ],
        ),
        Layer(ink, both(oval(0.14, 1.12, 0.1, 0.1))),
    ]
    fine = {"resolution": "EDGE_LENGTH", "edge_length": 0.035, "blend": 1.5, "layer_depth": 0.85}
    proud = {**fine, "layer_depth": 1.2}
    return [
        Character("bear", bear, proud),
        Character("bird", bird, fine),
        Character("robot", robot, {**fine, "profile": "FLAT", "depth": 0.8}),
        Character("hand", hand, fine),
        Character("cat", cat, fine),
        Character("turtle", turtle, fine),
        Character("rabbit", rabbit(), proud),
        Character("fish", fish(), proud),
        Character("octopus", octopus(), fine),
        Character("dinosaur", dinosaur(), proud),
    ]


def draw(character: Character, at: tuple[float, float]):
    """A grease-pencil object with a layer of filled strokes for each of the drawing's."""
    data = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new(character.name)
    drawn = bpy.data.objects.new(character.name, data)
    bpy.context.scene.collection.objects.link(drawn)
    inks: dict[str, int] = {}
    for number, layer in enumerate(character.layers):
        if layer.colour not in inks:
            ink = bpy.data.materials.new(f"{character.name} {len(inks)}")
            bpy.data.materials.create_gpencil_data(ink)
            ink.grease_pencil.show_fill, ink.grease_pencil.show_stroke = True, False
            ink.grease_pencil.fill_color = studio.linear(layer.colour)
            inks[layer.colour] = len(data.materials)
            data.materials.append(ink)
        drawing = data.layers.new(f"Layer {number}", set_active=True).frames.new(1).drawing
        drawing.add_strokes([len(stroke) for stroke in layer.strokes])
        points = np.concatenate(layer.strokes)
        place = np.column_stack([points, np.zeros(len(points))]).astype(np.float32)
        drawing.attributes["position"].data.foreach_set("vector", place.ravel())
        for stroke in drawing.strokes:
            stroke.cyclic, stroke.material_index = True, inks[layer.colour]
        drawing.tag_positions_changed()
    drawn.location = (*at, 0.0)
    return drawn


def make(character: Character, at: tuple[float, float]):
    """The one object that the operator makes of a character, and how long it took in seconds."""
    drawn = draw(character, at)
    bpy.context.view_layer.update()
    for other in bpy.context.selected_objects:
        other.select_set(False)
    drawn.select_set(True)
    bpy.context.view_layer.objects.active = drawn
    before = set(bpy.data.objects)
    started = time.perf_counter()
    bpy.ops.object.gridmesh_from_strokes(use_join=True, use_holes=False, **character.options)
    seconds = time.perf_counter() - started
    drawn.hide_render = True
    made = [ob for ob in bpy.data.objects if ob not in before]
    return made, seconds


def numbers(body) -> dict[str, float]:
    """Numbers of a mesh, taken from Blender alone."""
    mesh = body.data
    corners = np.array([polygon.vertices[:] for polygon in mesh.polygons])
    points = np.array([vertex.co for vertex in mesh.vertices])
    sides = points[np.roll(corners, -1, axis=1)] - points[corners]
    lengths = np.linalg.norm(sides, axis=2)
    cosines = -(sides * np.roll(sides, 1, axis=1)).sum(axis=2) / (lengths * np.roll(lengths, 1, axis=1))
    angles = np.degrees(np.arccos(np.clip(cosines, -1, 1))).min(axis=1)
    faces = Counter(key for polygon in mesh.polygons for key in polygon.edge_keys)
    valence = np.bincount(np.array([edge.vertices[:] for edge in mesh.edges]).ravel(), minlength=len(points))
    return {
        "triangles": len(corners),
        "closed": set(faces.values()) == {2},
        "irregular": 100 * float((valence != 6).mean()),
        "angle": float(angles.min()),
        "thin": int((angles < 10).sum()),
    }


def build(chosen: list[Character], pixels: int, samples: int, wires: bool) -> list[dict]:
    """Fill the scene; returns a row of numbers for each character."""
    columns = min(3 if len(chosen) < 7 else 5, len(chosen))
    rows = math.ceil(len(chosen) / columns)
    table = []
    for k, character in enumerate(chosen):
        at = ((k % columns - (columns - 1) / 2) * CELL, ((rows - 1) / 2 - k // columns) * ROW)
        made, seconds = make(character, at)
        row = {
            "name": character.name,
            "objects": len(made),
            "strokes": sum(len(layer.strokes) for layer in character.layers),
        }
        table.append({**row, **numbers(made[0]), "ms": 1000 * seconds})
        centre(made, at)
        for body in made:
            body.location.z += 0.9
            for slot, material in enumerate(body.data.materials):
                colour = material.diffuse_color[:]
                body.data.materials[slot] = clay(f"{material.name} clay", colour, 0.4 if wires else 0.0)
    studio.set_stage(CELL * columns, ROW * rows + 0.3, pixels, samples)
    bpy.context.scene.cycles.max_bounces = 2
    return table


def centre(made: list, at: tuple[float, float]) -> None:
    """Move what was made so that its middle is there, as the leaning camera shows it."""
    bpy.context.view_layer.update()
    corners = np.array([body.matrix_world @ Vector(corner) for body in made for corner in body.bound_box])
    x, y, _ = (corners.min(axis=0) + corners.max(axis=0)) / 2
    for body in made:
        body.location.x += at[0] - x
        body.location.y += at[1] - y - 0.9 * math.tan(studio.TILT)


def clay(name: str, colour: tuple[float, ...], wire: float):
    """Clay of a colour, with thin lines along the edges."""
    material = studio.body_material(name, "#808080", wire)
    tree = material.node_tree
    for node in tree.nodes:
        if node.type == "BSDF_PRINCIPLED":
            node.inputs["Base Color"].default_value = colour
    material.diffuse_color = colour
    return material


def show(table: list[dict]) -> None:
    """Print the numbers as a table."""
    print(
        f"\n{'character':<12}{'strokes':>8}{'objects':>8}{'closed':>8}{'triangles':>10}{'irregular':>10}{'angle':>8}{'< 10°':>7}{'ms':>8}"
    )
    for row in table:
        print(
            f"{row['name']:<12}{row['strokes']:>8}{row['objects']:>8}{row['closed']!s:>8}{row['triangles']:>10}{row['irregular']:>9.1f}%"
            f"{row['angle']:>7.1f}°{row['thin']:>7}{row['ms']:>8.0f}"
        )


def main() -> None:
    """Make, render and measure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="characters (default: all)")
    parser.add_argument("--width", type=int, default=1000, help="pixels of the picture")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "pictures" / "characters.png")
    parser.add_argument("--plain", action="store_true", help="without the lines of the mesh")
    choice = parser.parse_args()
    chosen = [one for one in characters() if not choice.names or one.name in choice.names]
    table = build(chosen, choice.width, choice.samples, not choice.plain)
    show(table)
    (ROOT / "out").mkdir(exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(ROOT / "out" / "characters.blend"))
    studio.render(choice.out)


if __name__ == "__main__":
    studio.run(main)
