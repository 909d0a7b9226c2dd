"""Bodies of random drawings: triangles and quads, bends, densities, profiles, depths; checked without the library's own code.

    python tests/campaign/bodies.py CASES [--seed S]

The drawings are those of `drawings.py`. Prints one line for each finding, the counts by outcome, and the ten slowest
cases. A case is its seed: it can be run again alone with `CASES` 1 and its seed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import drawings
import gridmesh
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "core"))
from checks import check_body
from quad_checks import check_quad_body, check_quad_patch

LONGEST = 10.0
"""Seconds of processor time that a case may take."""


def case(seed: int) -> tuple[drawings.Case, dict[str, Any]]:
    """A drawing with options of its lattice, and options of its body."""
    one = drawings.case(seed)
    random = np.random.default_rng([seed, 1])
    if one.options.get("boundary") == "grown":  # has none of these
        return one, body_options(random)
    if random.random() < 0.4:
        one.options["bend"] = float(random.choice([0.0, random.uniform(0, 1)]))
    if random.random() < 0.3:
        one.options["density"] = "width"
    elif random.random() < 0.2:
        one.options["density"] = 10.0 ** random.uniform(-0.5, 0.5, len(one.outline))
    if random.random() < 0.4:
        one.options["quads"] = max(one.options.pop("triangles") // 2, 8)
    body = body_options(random)
    if "quads" in one.options:
        body.pop("uv", None)  # the checks are for those that lie apart
    return one, body


def body_options(random: np.random.Generator) -> dict[str, Any]:
    """Options of `inflate`."""
    options: dict[str, Any] = {"profile": str(random.choice(["round", "even", "flat", "peak"]))}
    if random.random() < 0.3:
        options["curve"] = np.r_[0, random.uniform(0.05, 1, int(random.integers(1, 9)))]
    if random.random() < 0.3:
        options["depth"] = float(10 ** random.uniform(-2, 2))
    elif random.random() < 0.3:
        options["front"], options["back"] = random.uniform(0.1, 2, 2).tolist()
    if random.random() < 0.3:
        options["uv"] = "shared"
    if random.random() < 0.3:
        options["corner_angle"] = float(random.uniform(0, np.pi))
    return options


def outcome_of(one: drawings.Case, body: dict[str, Any]) -> tuple[str, str | None]:
    """What came of a case, and what is wrong with that."""
    try:
        patch = gridmesh.mesh_sketch(one.outline, one.holes, **one.options)
    except gridmesh.GridMeshError as refused:
        return refused.kind, None if refused.kind in drawings.EXPECTED else f"mesh_sketch: {refused}"
    is_quads = len(patch.quads) > 0
    try:
        if is_quads:
            check_quad_patch(patch, [one.outline, *one.holes])
        elif (wrong := drawings.fault(one, patch)) is not None:
            return "patch", wrong
    except AssertionError as wrong:
        return "patch", f"check_quad_patch: {wrong}"
    try:
        surface = gridmesh.inflate(patch, **body)
    except gridmesh.GridMeshError as refused:
        return f"body: {refused.kind}", str(refused)
    try:
        if is_quads:
            check_quad_body(surface, patch, len(one.holes))
        else:
            check_body(surface, patch)
    except AssertionError as wrong:
        return "body", f"check of the body: {wrong}"
    return "quads" if is_quads else "triangles", None


def main() -> int:
    """Run cases; 1 if something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("cases", type=int)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    outcomes: Counter[str] = Counter()
    times: list[tuple[float, str]] = []
    findings = 0
    for seed in range(arguments.seed, arguments.seed + arguments.cases):
        one, body = case(seed)
        since = time.process_time()
        outcome, wrong = outcome_of(one, body)
        seconds = time.process_time() - since
        told = {name: value for name, value in one.options.items() if not isinstance(value, np.ndarray)}
        what = f"seed {seed}: {one.kind} of {len(one.outline)} points {told} {sorted(body)}: {outcome}"
        if wrong is None and seconds > LONGEST and one.options.get("triangles", 0) <= drawings.LARGE:
            wrong = f"{seconds:.1f} s CPU"
        if wrong is not None:
            findings += 1
            print(f"{what}: {wrong}", flush=True)
        outcomes[outcome] += 1
        times.append((seconds, what))
    print(dict(outcomes.most_common()), f"{findings} findings")
    for seconds, what in sorted(times, reverse=True)[:10]:
        print(f"{seconds:8.2f} s CPU with its checks, {what}")
    return int(findings > 0)


if __name__ == "__main__":
    sys.exit(main())
