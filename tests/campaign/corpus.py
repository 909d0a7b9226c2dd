# /// script
# requires-python = ">=3.11"
# dependencies = ["fonttools==4.68.0", "numpy", "pyclipper==1.4.0", "svgelements==1.9.6"]
#
# [tool.uv]
# python-downloads = "never"
# ///
"""Tens of thousands of filled outlines with their holes, out of free icon sets, fonts and maps.

uv run tests/campaign/corpus.py CORPUS.jsonl [--packages FOLDER]

Packages are fetched by `npm pack` (of these versions, into FOLDER) unless they lie there. Shapes are filled by their own
rule, all shapes of a picture united; each part is an outline of its own, but for those that touch themselves. One a line: "name", "source", "outer", "holes".
Equal outlines are kept once. The digest that is printed is that of the file: two machines make the same one.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import itertools
import json
import math
import subprocess
import tarfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyclipper
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.ttLib import TTFont
from svgelements import SVG, Arc, CubicBezier, QuadraticBezier, Shape
from svgelements import Path as Drawn

ICONS = (
    "@iconify-json/game-icons@1.2.4",
    "@iconify-json/mdi@1.2.3",
    "@iconify-json/fa6-solid@1.2.4",
    "@iconify-json/bi@1.2.7",
    "@iconify-json/ph@1.2.2",
    "@iconify-json/ri@1.2.10",
    "@iconify-json/fluent-emoji-high-contrast@1.2.6",
)
FONTS = (
    "@expo-google-fonts/lobster@0.4.1",
    "@expo-google-fonts/pacifico@0.4.1",
    "@expo-google-fonts/playfair-display@0.4.2",
    "@expo-google-fonts/dancing-script@0.4.2",
    "@expo-google-fonts/noto-serif-jp@0.4.3",
)
MAPS = ("world-atlas@2.0.2",)

FLAT = 1e-3
"""Greatest distance of a curve from its chords, in sizes of the picture."""
UNITS = 2**24
"""Whole numbers across a picture, in which shapes are united."""
LEAST = 5e-4
"""Area of the smallest part that is kept, in squares of the picture's size."""

Point = tuple[float, float]


# ---------------------------------------------------------------- curves to polygons


def chords(points: list[complex], flat: float) -> list[complex]:
    """Points along a Bezier curve of degree two or three, without its first one."""
    degree = len(points) - 1
    bend = max(abs(a - 2 * b + c) for a, b, c in zip(points, points[1:], points[2:], strict=False))
    n = min(200, max(1, math.ceil(math.sqrt(degree * (degree - 1) * bend / (8 * flat)))))
    result = []
    for k in range(1, n + 1):
        left = points
        while len(left) > 1:
            left = [a + (b - a) * k / n for a, b in itertools.pairwise(left)]
        result.append(left[0])
    return result


def drawn_rings(path: Drawn, flat: float) -> list[list[complex]]:
    """Closed polygons of a path."""
    rings = []
    path.approximate_arcs_with_cubics()
    for part in path.as_subpaths():
        ring: list[complex] = []
        for segment in Drawn(part):
            if segment.end is None:
                continue
            end = complex(segment.end)
            if isinstance(segment, CubicBezier):
                control = [segment.start, segment.control1, segment.control2, segment.end]
                ring += chords([complex(p) for p in control], flat)
            elif isinstance(segment, QuadraticBezier):
                ring += chords([complex(p) for p in (segment.start, segment.control, segment.end)], flat)
            else:
                assert not isinstance(segment, Arc)
                ring.append(end)
        rings.append(ring)
    return rings


def glyph_rings(pen: DecomposingRecordingPen, flat: float) -> list[list[complex]]:
    """Closed polygons of a glyph."""
    rings: list[list[complex]] = []
    for name, given in pen.value:
        points = [complex(*p) for p in given if p is not None]
        if name == "moveTo":
            rings.append(points)
        elif name == "lineTo":
            rings[-1] += points
        elif name == "curveTo":
            rings[-1] += chords([rings[-1][-1], *points], flat)
        elif name == "qCurveTo":
            # Points on the curve lie halfway between those that are given.
            if given[-1] is None:
                points.append((points[0] + points[-1]) / 2)
                rings.append([points[-1]])
            *controls, end = points
            for control, after in itertools.zip_longest(controls, controls[1:]):
                to = end if after is None else (control + after) / 2
                rings[-1] += chords([rings[-1][-1], control, to], flat)
    return rings


def touching(rings: list[list[tuple[int, int]]]) -> bool:
    """Whether a corner of these rings lies nearer than two units to a side that does not end there.

    Coordinates are rounded to whole numbers once sides are cut: a corner that touched a side then lies beside it.
    """
    corners = np.array([point for ring in rings for point in ring], float)
    along = np.array([point for ring in rings for point in ring[1:] + ring[:1]], float) - corners
    squared = np.maximum((along**2).sum(axis=1), 1.0)
    first = 0
    for ring in rings:
        for k in range(first, first + len(ring)):
            share = np.clip(((corners[k] - corners) * along).sum(axis=1) / squared, 0.0, 1.0)
            distance = np.linalg.norm(corners + share[:, None] * along - corners[k], axis=1)
            distance[[k, k - 1 if k > first else first + len(ring) - 1]] = np.inf
            if distance.min() < 2.0:
                return True
        first += len(ring)
    return False


def united(shapes: list[tuple[list[list[complex]], bool]], low: complex, size: float) -> Iterator[dict]:
    """Parts of united shapes, each given by its rings and whether it is filled by the even-odd rule."""
    scale = UNITS / size
    whole: list[list[tuple[int, int]]] = []
    for rings, even_odd in shapes:
        clipper = pyclipper.Pyclipper()
        rounded = [[(round((p - low).real * scale), round((p - low).imag * scale)) for p in r] for r in rings]
        rounded = [ring for ring in rounded if pyclipper.Area(ring) != 0]
        if not rounded:
            continue
        clipper.AddPaths(rounded, pyclipper.PT_SUBJECT, True)
        rule = pyclipper.PFT_EVENODD if even_odd else pyclipper.PFT_NONZERO
        whole += clipper.Execute(pyclipper.CT_UNION, rule, rule)
    if not whole:
        return
    clipper = pyclipper.Pyclipper()
    clipper.AddPaths(whole, pyclipper.PT_SUBJECT, True)
    tree = clipper.Execute2(pyclipper.CT_UNION, pyclipper.PFT_NONZERO, pyclipper.PFT_NONZERO)
    stack = list(tree.Childs)
    while stack:
        part = stack.pop(0)
        stack += [inner for hole in part.Childs for inner in hole.Childs]
        rings = [part.Contour, *(hole.Contour for hole in part.Childs)]
        if abs(pyclipper.Area(part.Contour)) < LEAST * UNITS**2:
            continue
        rings = [ring for ring in rings if abs(pyclipper.Area(ring)) >= 0.02 * LEAST * UNITS**2]
        if touching(rings):
            continue
        outer, *holes = [[(x / UNITS, y / UNITS) for x, y in ring] for ring in rings]
        yield {"outer": outer, "holes": holes}


# ---------------------------------------------------------------- packages


def fetched(package: str, folder: Path) -> tarfile.TarFile:
    """The archive of a package, downloaded unless it is there."""
    name, _, version = package.removeprefix("@").partition("@")
    stem = name.replace("/", "-")
    there = sorted(folder.glob(f"{stem}-{version}*.tgz"))
    if not there:
        subprocess.run(["npm", "pack", "-s", package], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        there = sorted(folder.glob(f"{stem}-{version}*.tgz"))
    return tarfile.open(there[-1])


def icons(archive: tarfile.TarFile) -> Iterator[tuple[str, dict]]:
    """Parts of all filled icons of a set."""
    sets = json.load(archive.extractfile("package/icons.json"))
    for name, icon in sorted(sets["icons"].items()):
        width = icon.get("width", sets.get("width", 16))
        height = icon.get("height", sets.get("height", 16))
        size = max(width, height)
        head = f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 {width} {height}" width="{width}" height="{height}">'
        shapes = []
        for element in SVG.parse(io.StringIO(f"{head}{icon['body']}</svg>"), reify=True):
            if isinstance(element, Shape) and element.values.get("fill") != "none":
                rule = element.values.get("fill-rule") == "evenodd"
                shapes.append((drawn_rings(Drawn(element), FLAT * size), rule))
        for part in united(shapes, 0j, size):
            yield name, part


def glyphs(archive: tarfile.TarFile) -> Iterator[tuple[str, dict]]:
    """Parts of all glyphs of the first regular font of a package."""
    files = sorted(n for n in archive.getnames() if n.endswith((".ttf", ".otf")))
    regular = next((n for n in files if "400Regular." in n), files[0])
    font = TTFont(io.BytesIO(archive.extractfile(regular).read()))
    size = font["head"].unitsPerEm
    pictures = font.getGlyphSet()
    for name in sorted(pictures.keys())[:3000]:
        pen = DecomposingRecordingPen(pictures)
        pictures[name].draw(pen)
        for part in united([(glyph_rings(pen, FLAT * size), False)], 0j, size):
            yield name, part


def lands(archive: tarfile.TarFile) -> Iterator[tuple[str, dict]]:
    """Countries, islands one by one, out of a TopoJSON file."""
    for file in ("countries-10m", "countries-50m"):
        topology = json.load(archive.extractfile(f"package/{file}.json"))
        (sx, sy), (tx, ty) = topology["transform"]["scale"], topology["transform"]["translate"]
        arcs = []
        for arc in topology["arcs"]:
            xs, ys = (itertools.accumulate(steps) for steps in zip(*arc, strict=True))
            arcs.append([complex(x * sx + tx, y * sy + ty) for x, y in zip(xs, ys, strict=True)])
        for land in topology["objects"]["countries"]["geometries"]:
            several = land.get("arcs", []) if land["type"] == "MultiPolygon" else [land.get("arcs", [])]
            for polygon in several:
                rings = [
                    [p for k in ring for p in (arcs[k] if k >= 0 else arcs[~k][::-1])[:-1]]
                    for ring in polygon
                ]
                if not rings:
                    continue
                low = complex(min(p.real for p in rings[0]), min(p.imag for p in rings[0]))
                size = max(max((p - low).real, (p - low).imag) for p in rings[0])
                if size == 0:
                    continue
                for part in united([(rings, True)], low, size):
                    yield land["properties"]["name"], part


def main() -> None:
    """Write the corpus."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("corpus", type=Path)
    parser.add_argument("--packages", type=Path)
    chosen = parser.parse_args()
    folder = chosen.packages or chosen.corpus.parent
    folder.mkdir(parents=True, exist_ok=True)
    seen, total, digest = set(), 0, hashlib.sha256()
    with chosen.corpus.open("w") as corpus:
        for reader, packages in ((icons, ICONS), (glyphs, FONTS), (lands, MAPS)):
            for package in packages:
                count = 0
                with fetched(package, folder) as archive:
                    for name, part in reader(archive):
                        rings = json.dumps([part["outer"], part["holes"]])
                        if rings in seen:
                            continue
                        seen.add(rings)
                        count += 1
                        row = {"name": f"{name} {count}", "source": package.rpartition("@")[0] or package}
                        line = json.dumps(row | part) + "\n"
                        digest.update(line.encode())
                        corpus.write(line)
                if not count:
                    raise SystemExit(f"{package} has no outlines")
                total += count
                print(f"{count:6d} {package}", flush=True)
    print(f"{total:6d} outlines, sha256 {digest.hexdigest()}")


if __name__ == "__main__":
    main()
