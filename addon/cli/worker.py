# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that does the work: a job a line on stdin, a result a line on stdout."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

from . import limits

MARK = "@gridmesh "
"""What a result begins with; Blender prints other lines."""


def serve(megabytes: float) -> int:
    """Do jobs until stdin ends, in no more memory than this."""
    # Blender and its add-ons may print anything in the middle of a line: results go where nobody else writes.
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as answers:
        os.dup2(2, 1)
        _prepare()
        limits.limit(megabytes)
        print(f"{MARK}{{}}", file=answers, flush=True)  # from now on time counts
        for line in sys.stdin:
            answers.write(f"{MARK}{json.dumps(work(**json.loads(line)))}\n")
            answers.flush()
    return 0


def _prepare() -> None:
    import bpy

    from . import loading

    if not hasattr(bpy.types, "MESH_OT_gridmesh_fill"):  # the `bpy` module, where nobody enabled the add-on
        import importlib

        importlib.import_module(__package__.rpartition(".")[0]).register()
    loading.clear()


def work(**item: Any) -> dict[str, Any]:
    """Do one job; what came of it, never an exception."""
    started = perf_counter()
    try:
        result = _work(**item)
    except MemoryError:
        result = {"status": "error", "kind": "out_of_memory", "message": "the memory allowed is used up"}
    except Exception as error:  # one bad item never stops the rest; its line says what happened
        result = {"status": "error", "kind": _kind(error), "message": str(error) or repr(error)}
    return {
        **result,
        "milliseconds": round(1000 * (perf_counter() - started)),
        "peak_megabytes": limits.peak(),
    }


def _kind(error: Exception) -> str:
    return getattr(error, "kind", None) or type(error).__name__.removesuffix("Error").lower()


def _work(
    op: str,
    source: str,
    pattern: str | None,
    params: dict[str, Any],
    out: str,
    scripts: bool,
    picture: str | None,
    engine: str,
) -> dict[str, Any]:
    from . import loading, making, outputs, pictures

    try:
        made = making.OPS[op](Path(source), pattern, params, scripts=scripts)
        outputs.write(Path(out), made.objects)
        if picture is not None:
            pictures.render(Path(picture), made.objects, engine)
    except BaseException:
        loading.clear()
        raise
    loading.tidy(Path(source), made.objects)
    return {"status": "warning" if made.notes else "ok", "message": "; ".join(made.notes), **made.numbers}
