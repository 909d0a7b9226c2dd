"""``map_sketches`` over an executor: drawings in small groups, results in order."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from itertools import islice
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from gridmesh._native import GridMeshError, Surface

_GROUP = 8
"""Drawings that are sent together: enough to outweigh the sending, few enough to share the work evenly."""


def spread(
    executor: Executor,
    outlines: Iterable[Any],
    threads: int | None,
    progress: Callable[[float], object] | None,
    options: dict[str, Any],
) -> list[Surface | GridMeshError]:
    """Results of all drawings. A task has one thread unless more are asked for."""
    from gridmesh import _native

    if not callable(getattr(executor, "submit", None)):
        name = type(executor).__name__
        raise TypeError(f"executor is of type {name}; allowed: a concurrent.futures.Executor, or None")
    if progress is not None and not callable(progress):
        _native.map_sketches([], progress=progress)
    _native.map_sketches([], threads=threads, **options)  # both refuse what is not allowed
    tasks = [executor.submit(_group, group, threads or 1, options) for group in _groups(outlines)]
    try:
        _watch(tasks, progress)
        return [result for task in tasks for result in task.result()]
    except BaseException:
        for task in tasks:
            task.cancel()
        raise


def _group(drawings: list[Any], threads: int, options: dict[str, Any]) -> list[Surface | GridMeshError]:
    from gridmesh import _native

    return _native.map_sketches(drawings, threads=threads, **options)


def _groups(outlines: Iterable[Any]) -> Iterator[list[Any]]:
    rest = iter(outlines)
    while group := list(islice(rest, _GROUP)):
        yield group


def _watch(tasks: list[Future[Any]], progress: Callable[[float], object] | None) -> None:
    """Wait until all are done, or `progress`, asked at least ten times a second, wants to stop."""
    from gridmesh import _native

    left = set(tasks)
    while left:
        _, left = wait(left, timeout=0.1, return_when=FIRST_COMPLETED)
        if progress is not None and progress(1 - len(left) / len(tasks)) is False:
            _native.map_sketches([], progress=lambda _: False)  # raises what a cancelled map raises
