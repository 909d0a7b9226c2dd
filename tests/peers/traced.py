# /// script
# requires-python = ">=3.11"
# dependencies = ["numpy", "gridmesh"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = "../.." }
# ///
"""How near outlines traced from pictures come to what was drawn: the drawings and shapes of the tests, rasterised and traced back.

uv run tests/peers/traced.py [--sizes 256 1024]

Pixels have 4 x 4 samples. Compared are the areas (intersection over union), and the distances from points every two pixels along what
was traced to the drawing; corners are those of straight sides of six pixels and more that meet at 45 degrees and more, and the
distance is from each to the nearest such corner that was traced.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import gridmesh
import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "core")]

from checks import distance_to_curve  # noqa: E402
from rasters import corners, coverage, dense, likeness, placed  # noqa: E402
from sketches import DRAWINGS, SHAPES  # noqa: E402

SIDE = 8.0
"""Pixels of the sides of a corner."""


def main() -> None:
    """Print what was measured."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[256, 1024])
    for size in parser.parse_args().sizes:
        alike, aways, missed = {}, [], []
        for name, sheet in {**DRAWINGS, **SHAPES}.items():
            drawn = placed([np.asarray(sheet["points"], float)], size)
            traced = gridmesh.trace_image(np.rint(255 * coverage(drawn, size, size)).astype(np.uint8))
            found = [contour for outline, holes in traced for contour in [outline, *holes]]
            alike[name] = likeness(found, drawn, size, 8 if size <= 256 else 4)
            aways.append(np.concatenate([distance_to_curve(dense(one, 2.0), drawn[0]) for one in found]))
            points = np.concatenate(found)
            missed += [(np.hypot(*(points - corner).T).min(), name) for corner in corners(drawn[0], SIDE)]
        values = np.array(list(alike.values()))
        off = np.array([far for far, _ in missed])
        share = [np.quantile(away, 0.95) for away in aways]
        print(f"{size} pixels, {len(alike)} drawings")
        print(
            f"  intersection over union: median {np.median(values):.4f}, least {values.min():.4f} ({min(alike, key=alike.get)})"
        )
        print(
            f"  95 % of the points lie within {np.quantile(np.concatenate(aways), 0.95):.3f} pixels; of the worst drawing {max(share):.3f}"
        )
        print(
            f"  {len(off)} corners: median {np.median(off):.2f} pixels off, most {off.max():.2f}; farther than 0.7: {sorted({name for far, name in missed if far > 0.7})}"
        )


if __name__ == "__main__":
    main()
