"""Wrong types and values in every argument of every public function: an exception with a message, or a result.

`python tests/campaign/arguments.py --cases 2000 --seed 1` prints the outcomes; each case changes one to three arguments of a
call that is right. Nothing but GridMeshError, TypeError and ValueError may come of it.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter

import gridmesh
import numpy as np

RING = np.c_[np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6), np.zeros(12)]
SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]
PICTURE = np.pad(np.full((20, 24, 1), 255, np.uint8), ((5, 5), (5, 5), (0, 0))).repeat(4, axis=2)


def grid():
    """A sheet of 8 by 8 squares with a hole of 2 by 2."""
    i, j = np.meshgrid(np.arange(9), np.arange(9), indexing="ij")
    quad = np.array([9 * a + b for a in range(8) for b in range(8) if not (2 < a < 5 and 2 < b < 5)])
    faces = np.r_[np.c_[quad, quad + 9, quad + 1], np.c_[quad + 9, quad + 10, quad + 1]]
    return np.c_[i.ravel(), j.ravel(), 0 * i.ravel()].astype(float), faces


def cube():
    """A closed cube."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])


def calls():
    """Every function with arguments that are right; methods and makers of pickles too."""
    vertices, faces = grid()
    corners, sides = cube()
    loop = [30, 31, 32, 41, 50, 49, 48, 39]
    border = [*range(9), *range(17, 81, 9), *range(79, 71, -1), *range(63, 0, -9)]
    patch = gridmesh.mesh_sketch(SQUARE, triangles=60)
    fill = gridmesh.fill_hole(vertices, faces, loop)
    made = {
        "mesh_sketch": {
            "outline": SQUARE,
            "holes": [[[1, 1], [2, 1], [2, 2]]],
            "triangles": 200,
            "boundary": "optimal",
            "max_distance": 1.5,
            "closeness": 0.3,
            "angle": None,
            "origin": None,
            "corner_angle": 0.7,
            "mirror": None,
            "self_crossing": "error",
            "relax": True,
            "proof_nodes": 0,
            "progress": None,
        },
        "mesh_sketch of quads": {
            "outline": SQUARE,
            "quads": 60,
            "cells": "quads",
            "max_triangles": 500,
            "closeness": 0.3,
            "corner_angle": 0.7,
            "progress": None,
        },
        "mesh_sketch on bent lattices": {
            "outline": SQUARE,
            "triangles": "auto",
            "cells": "triangles",
            "bend": 0.5,
            "density": None,
            "max_triangles": 500,
            "least": False,
        },
        "thickness": {"outline": SQUARE, "holes": [[[1, 1], [2, 1], [2, 2]]]},
        "harmonic": {
            "vertices": vertices,
            "triangles": faces,
            "free": np.array([10, 11, 12]),
            "values": np.column_stack([np.arange(len(vertices)), np.ones(len(vertices))]),
        },
        "trace_image": {
            "image": PICTURE,
            "threshold": 0.5,
            "smooth": 1.0,
            "min_area": 16.0,
            "margin": 0.0,
            "background": "transparent",
            "progress": None,
        },
        "stitch": {"patch": patch},
        "inflate": {
            "patch": patch,
            "depth": 0.5,
            "profile": "round",
            "curve": None,
            "front": None,
            "back": None,
            "progress": None,
        },
        "flat": {"patch": patch},
        "map_sketches": {"outlines": [SQUARE, SQUARE], "triangles": 60},
        "fill_hole": {
            "vertices": vertices,
            "triangles": faces,
            "loop": loop,
            "smooth": "tangent",
            "strict": False,
            "polygons": np.arange(len(faces)),
            "sharp": 0.5,
            "creases": [[30, 21]],
            "cells": "quads",
            "progress": None,
        },
        "fill_holes": {
            "vertices": vertices,
            "triangles": faces,
            "loops": [loop],
            "max_edges": None,
            "smooth": "curvature",
            "strict": False,
            "polygons": None,
            "sharp": None,
            "creases": None,
            "cells": None,
            "progress": None,
        },
        "bridge": {
            "vertices": vertices,
            "triangles": faces,
            "loop": loop,
            "other": border,
            "smooth": "tangent",
            "rows": 2,
            "twist": 0.1,
            "strict": False,
            "polygons": None,
            "cells": "quads",
            "progress": None,
        },
        "bridge_pairs": {
            "vertices": vertices,
            "triangles": faces,
            "loops": (loop, border),
            "smooth": "flat",
            "rows": None,
            "twist": 0.0,
            "strict": True,
            "polygons": None,
            "cells": "triangles",
            "progress": None,
        },
        "look_apart": {"vertices": vertices, "triangles": faces, "loops": (loop, border)},
        "regrid": {
            "vertices": vertices,
            "triangles": faces,
            "faces": np.flatnonzero(np.isin(faces, 11).any(axis=1)),
            "keep_shape": True,
            "smooth": "flat",
            "strict": False,
            "polygons": None,
            "cells": "triangles",
            "progress": None,
        },
        "cut": {
            "vertices": corners,
            "faces": sides,
            "stroke": [[-1, 0.4, 0.5], [2, 0.6, 0.5]],
            "direction": (0, 0, 1),
            "edge_length": 0.3,
            "smooth": "flat",
        },
        "cut_reach": {
            "vertices": corners,
            "faces": sides,
            "stroke": [[0.2, 0.4, 0.5], [0.6, 0.6, 0.5]],
            "direction": (0, 0, 1),
            "eye": None,
            "progress": None,
        },
        "combine": {
            "outline": SQUARE,
            "other": [[1, -1], [2, -1], [2, 5], [1, 5]],
            "holes": [],
            "how": "union",
        },
    }
    found = {
        name: (getattr(gridmesh, name.split()[0]), given)
        for name, given in made.items()
        if hasattr(gridmesh, name.split()[0])
    }
    found["Fill.extend"] = (fill.extend, {"values": np.zeros((8, 2))})
    found["Fill.refit"] = (fill.refit, {"vertices": vertices})
    rebuild, fields = fill.__reduce__()
    names = [
        "loop",
        "backwards",
        "second",
        "smooth",
        "vertices",
        "flat",
        "positions",
        "outer",
        "triangles",
        "patch",
        "creases",
        "report",
    ]
    found["_fill"] = (rebuild, dict(zip(names, fields, strict=True)))
    return found


class Odd:
    """An object with a length that lies."""

    def __len__(self):
        return 10**9

    def __getitem__(self, index):
        raise IndexError(index)


VALUES = [
    None, True, False, 0, 1, -1, 2, 3, 7, 10**6, 2**31, 2**63, -(2**63), 2**64, 10**400, 0.0, -0.0, 0.5, -1.5, 1e-300, 1e300,
    float("nan"), float("inf"), -float("inf"), 1j, "", "flat", "tangent", "nonsense", "\ud800", "a" * 1000, b"bytes", [], (), {},
    set(), [[]], [[[]]], [None], ["x"], [1, 2, 3], [[1, 2], [3]], [[0, 0], [1, 0], [0, 1]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
    range(5), object(), Odd(), int, len, lambda: None, lambda _f: None, lambda _f: False, lambda _f: "text", iter([]),
    np.float64(1), np.int8(-1), np.array(3), np.array("x"), np.array([None]), np.zeros((0, 2)), np.zeros((0, 3)), np.zeros((3, 0)),
    np.zeros((3, 3)), np.zeros((3, 3), np.int8), np.zeros((4, 2), np.uint8), np.zeros((2, 2, 2)), np.zeros(5), np.arange(12),
    np.full((3, 3), np.nan), np.full((3, 2), np.inf), np.full((4, 3), 2**31 - 1), np.full((4, 3), -1), np.full(4, 2**63 - 1),
    np.full((3, 3), 1e300), np.array([[1, 2, 3]], ">i4"), np.zeros((3, 3), complex), np.zeros((3, 3), bool), np.zeros((3, 3), "S3"),
    np.zeros((3, 3), "M8[s]"), np.zeros(3, [("a", "i4")]), np.zeros((3, 3), np.float16), np.zeros((3, 3), np.longdouble),
    np.ma.masked_array(np.zeros((3, 3)), True), np.asfortranarray(np.arange(12.0).reshape(4, 3)), np.arange(24.0).reshape(8, 3)[::-2],
    np.broadcast_to(np.zeros(3), (10**7, 3))[:4], memoryview(b"abc"), RING, np.random.default_rng(0),
]  # fmt: skip


def spoiled(rng, value):
    """A value of any kind, or a damaged one."""
    if isinstance(value, np.ndarray | list) and rng.random() < 0.4:
        array = np.array(value)
        if array.size and array.dtype.kind in "iuf":
            array = array.astype(rng.choice(["f8", "i8", "f4", "i4", "u1", ">f8", "O"]))
            way = rng.integers(5)
            if way == 0:
                array.reshape(-1)[rng.integers(array.size)] = (
                    rng.choice([0, 1, 100]) if array.dtype == "u1" else rng.choice([-1, 100])
                )
            elif way == 1:
                array = array[: rng.integers(len(array))]
            elif way == 2:
                array = array[..., :-1]
            elif way == 3 and array.dtype.kind == "f":
                array.reshape(-1)[rng.integers(array.size)] = rng.choice([np.nan, np.inf, 1e308, 5e-324])
            elif way == 4:
                array = array[None]
            return array
    return VALUES[rng.integers(len(VALUES))]


def run(functions, number, seed):
    """One case: its description, what came of it, what is wrong, seconds."""
    rng = np.random.default_rng([seed, number])
    name = list(functions)[number % len(functions)]
    function, right = functions[name]
    given = dict(right)
    changed = rng.choice(list(given), min(len(given), rng.choice([1, 1, 2, 3])), replace=False)
    for key in changed:
        given[key] = spoiled(rng, given[key])
    told = f"{name}({', '.join(f'{key}={given[key]!r:.60}' for key in changed)})".replace("\n", " ")
    started = time.process_time()
    try:
        with np.errstate(all="ignore"):
            call(name, function, given)
    except gridmesh.GridMeshError as error:
        outcome, wrong = error.kind, "" if str(error) and error.kind != "internal" else repr(error)
    except (TypeError, ValueError) as error:
        outcome, wrong = type(error).__name__, "" if str(error) else "no message"
    except OverflowError as error:
        # What Python itself says where the maker of pickles, which nobody calls by hand, gets a number out of range.
        outcome, wrong = "OverflowError", "" if name == "_fill" else repr(error)
    except Exception as error:
        outcome, wrong = type(error).__name__, repr(error)
    else:
        outcome, wrong = "result", ""
    return told, outcome, wrong, time.process_time() - started


def call(name, function, given):
    """Call a function, by position where it takes no names."""
    if name == "_fill":
        fill = function(*given.values())
        if isinstance(given["report"], dict) and len(fill.loop):
            fill.extend(np.zeros(len(fill.loop)))
    elif name == "map_sketches":
        list(function(given.pop("outlines"), **given))
    elif name in {"cut", "cut_reach"}:
        function(given.pop("vertices"), given.pop("faces"), given.pop("stroke"), **given)
    else:
        function(**given)


def campaign(cases, seed, *, tell=lambda *_: None):
    """Run all cases of a seed: outcomes by kind, and the wrong ones."""
    functions = calls()
    outcomes, wrong, slowest = Counter(), [], []
    for number in range(cases):
        told, outcome, bad, seconds = run(functions, number, seed)
        outcomes[outcome] += 1
        slowest = sorted([*slowest, (seconds, number, told)], reverse=True)[:10]
        if bad:
            wrong.append(f"{number}: {told}: {bad}")
            tell(wrong[-1])
    return outcomes, wrong, slowest


def main():
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    outcomes, wrong, slowest = campaign(
        options.cases, options.seed, tell=lambda text: print(text, flush=True)
    )
    print(outcomes.most_common())
    print(f"{len(wrong)} of {options.cases} cases wrong")
    for seconds, number, told in slowest:
        print(f"  {seconds:7.3f} s  {number}: {told}")


if __name__ == "__main__":
    main()
