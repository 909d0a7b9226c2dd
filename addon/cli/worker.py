# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that does the work: a request a line on stdin, a result a line on stdout.

For each item: `look` at its files, which needs no Blender; `prepare` it, once; `make`.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

from . import files, limits, places

MARK = "@gridmesh "
"""What a result begins with; Blender prints other lines."""
_LONGEST = 2000
"""Letters of a message."""


def serve(megabytes: float) -> int:
    """Do what is asked until stdin ends; the owner sees to it that it takes no more memory than this."""
    # Blender and its add-ons may print anything in the middle of a line: results go where nobody else writes.
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as answers:
        os.dup2(2, 1)
        limits.end_with_owner()
        limits.limit(megabytes)
        if hasattr(signal, "SIGXFSZ"):  # files may be too large to be written: an error, not an end
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        print(f"{MARK}{{}}", file=answers, flush=True)
        for line in sys.stdin:
            answers.write(f"{MARK}{json.dumps(work(**json.loads(line)))}\n")
            answers.flush()
    return 0


_prepared = False


def _prepare() -> dict[str, Any]:
    """Start Blender, if this is not it, and its add-on."""
    global _prepared
    if not _prepared:
        import bpy

        from . import loading

        if not hasattr(
            bpy.types, "MESH_OT_gridmesh_fill"
        ):  # the `bpy` module, where nobody enabled the add-on
            import importlib

            importlib.import_module(__package__.rpartition(".")[0]).register()
        loading.clear()
        _prepared = True
    return {"status": "ok"}


def work(do: str, **item: Any) -> dict[str, Any]:
    """Do one thing; what came of it, never an exception."""
    started = perf_counter()
    try:
        result = {"look": _look, "prepare": _prepare, "make": _make}[do](**item)
    except MemoryError:
        result = {"status": "error", "kind": "out_of_memory", "message": "the memory allowed is used up"}
    except Exception as error:  # one bad item never stops the rest; its line says what happened
        result = {"status": "error", "kind": _kind(error), "message": str(error) or repr(error)}
    if len(result.get("message", "")) > _LONGEST:
        result["message"] = result["message"][: _LONGEST - 3] + "..."
    if do != "make":
        return result
    return {
        **result,
        "milliseconds": round(1000 * (perf_counter() - started)),
        "peak_megabytes": limits.peak(),
    }


def _kind(error: Exception) -> str:
    if isinstance(error, OSError):
        return type(error).__name__.lower()
    return getattr(error, "kind", None) or type(error).__name__.removesuffix("Error").lower()


def _look(
    asked: list[Any],
    named: list[str],
    outputs: list[str | None],
    most: float,
    outside: bool,
    before: tuple[str, str] | None,
) -> dict[str, Any]:
    """Read the files of an item: their hash, and whether nothing has changed since `before`.

    outputs : the output, its rendered picture and the picture beside it, if there are any.
    """
    key, found = files.key_of(asked, named, most, outside=outside)
    same = places.Places()
    out, picture, _ = outputs
    written = {same.of(Path(path)) for path in (out, picture) if path is not None}
    for path in found:
        if same.of(path) in written:
            text = f"out '{places.shown(out)}' would overwrite '{places.shown(path)}', which it reads"
            raise files.FileError("overwrites", f"{text}; give it another name")
    pictured = all(path is None or Path(path).exists() for path in outputs[1:])
    unchanged = before is not None and before[0] == key and before[1] == files.digest_of(Path(out))
    return {"status": "unchanged" if unchanged and pictured else "ok", "key": key}


def _make(
    op: str,
    source: str,
    pattern: str | None,
    params: dict[str, Any],
    outputs: list[str | None],
    settings: dict[str, Any],
) -> dict[str, Any]:
    from . import loading, making, pictures, sprites

    out, picture, beside = outputs
    try:
        make = {**making.OPS, **sprites.OPS}[op]
        made = make(Path(source), pattern, params, scripts=settings["scripts"])
        made.write(Path(out), None if beside is None else Path(beside))
        if picture is not None:
            pictures.render(Path(picture), made.objects, settings["engine"])
    except BaseException:
        loading.clear()
        raise
    made.tidy(Path(source))
    return {
        "status": "warning" if made.notes else "ok",
        "message": "; ".join(made.notes),
        **made.numbers,
        "digest": files.digest_of(Path(out)),
    }
