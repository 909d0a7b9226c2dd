"""Progress, cancelling, signals, threads, many drawings at once."""

import signal
import threading
import time

import gridmesh
import numpy as np
import pytest
from sketches import BAD, DRAWINGS, SHAPES, circle


def work(progress):
    patch = gridmesh.mesh_sketch(DRAWINGS["octopus"]["points"], triangles=20_000, progress=progress)
    return gridmesh.inflate(patch, progress=progress)


def map_work(progress):
    outlines = [drawing["points"] for drawing in DRAWINGS.values()]
    return gridmesh.map_sketches(outlines, triangles=3000, progress=progress)


@pytest.mark.parametrize(
    "call",
    [
        lambda progress: gridmesh.mesh_sketch(circle(), triangles=20_000, progress=progress),
        lambda progress: gridmesh.inflate(gridmesh.mesh_sketch(circle(), triangles=9000), progress=progress),
        map_work,
    ],
    ids=["mesh_sketch", "inflate", "map_sketches"],
)
def test_progress_rises_from_0_to_1(call):
    seen = []
    call(seen.append)
    assert seen
    assert all(type(fraction) is float and 0 <= fraction <= 1 for fraction in seen)
    assert seen == sorted(seen)


@pytest.mark.parametrize("call", [work, map_work])
@pytest.mark.parametrize("answer", [False, np.False_])
def test_false_cancels(call, answer):
    calls = []

    def stop(fraction):
        calls.append(fraction)
        return answer

    with pytest.raises(gridmesh.GridMeshError, match="cancelled") as caught:
        call(stop)
    assert caught.value.kind == "cancelled"
    assert len(calls) == 1, "it went on after it was cancelled"


@pytest.mark.parametrize("answer", [None, True, 0, "", []])
def test_only_false_cancels(answer):
    body = work(lambda _: answer)
    assert body.report["watertight"]


@pytest.mark.parametrize("call", [work, map_work])
@pytest.mark.parametrize("kind", [ZeroDivisionError, KeyboardInterrupt])
def test_what_the_callback_raises_is_raised(call, kind):
    def fail(_fraction):
        raise kind("from the callback")

    with pytest.raises(kind, match="from the callback"):
        call(fail)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no interval timers on this system")
@pytest.mark.parametrize(
    "call",
    [
        lambda: gridmesh.mesh_sketch(circle(2000), triangles=2_000_000),
        lambda: gridmesh.map_sketches([circle(2000)] * 40, triangles=100_000),
    ],
    ids=["mesh_sketch", "map_sketches"],
)
def test_a_signal_interrupts_without_a_callback(call):
    class Interrupted(Exception):
        pass

    def handler(_number, _frame):
        raise Interrupted

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        with pytest.raises(Interrupted):
            call()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_other_threads_run_meanwhile():
    """The longest pause of a busy thread is only a part of the time that the library works."""
    spans = []

    def mesh():
        start = time.perf_counter()
        gridmesh.mesh_sketch(circle(2000), triangles=400_000)
        spans.append((start, time.perf_counter()))

    worker = threading.Thread(target=mesh)
    worker.start()
    ticks = []
    while not spans:
        ticks.append(time.perf_counter())
    worker.join()
    start, end = spans[0]
    inside = np.array([start, *(tick for tick in ticks if start < tick < end), end])
    assert np.diff(inside).max() < 0.5 * (end - start)


def test_one_patch_serves_many_threads():
    patch = gridmesh.mesh_sketch(DRAWINGS["frog"]["points"], triangles=2000)
    expected = gridmesh.inflate(patch).vertices.tobytes()
    results = [None] * 4

    def inflate(k):
        results[k] = gridmesh.inflate(patch).vertices.tobytes()

    threads = [threading.Thread(target=inflate, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 4


def test_a_map_gives_bodies_and_errors_in_order():
    good = [SHAPES[name]["points"] for name in ("bean", "circle", "trefoil")]
    items = [good[0], BAD["figure_eight"]["points"], good[1], None, "text", good[2], [1, 2], []]
    results = gridmesh.map_sketches(iter(items), triangles=600)
    kinds = [getattr(result, "kind", None) for result in results]
    assert kinds == [
        None,
        "self_intersecting",
        None,
        "invalid_type",
        "invalid_type",
        None,
        "invalid_shape",
        "too_few_points",
    ]
    for points, result in zip(good, [results[0], results[2], results[5]], strict=True):
        alone = gridmesh.inflate(gridmesh.mesh_sketch(points, triangles=600))
        assert result.vertices.tobytes() == alone.vertices.tobytes()
        assert result.triangles.tobytes() == alone.triangles.tobytes()


@pytest.mark.parametrize("threads", [1, 2, 7, 10_000])
def test_the_number_of_threads_changes_nothing(threads):
    outlines = [shape["points"] for shape in SHAPES.values()]
    plain, other = (gridmesh.map_sketches(outlines, triangles=800, threads=t) for t in (None, threads))
    for a, b in zip(plain, other, strict=True):
        if isinstance(a, gridmesh.GridMeshError):
            assert (a.kind, str(a)) == (b.kind, str(b))
        else:
            assert a.vertices.tobytes() == b.vertices.tobytes()


def test_a_map_takes_the_options_of_both_steps():
    outline = SHAPES["bean"]["points"]
    patch = gridmesh.mesh_sketch(outline, triangles=500, corner_angle=1.0)
    deep = gridmesh.inflate(patch, depth=2.0, profile="peak", corner_angle=1.0)
    (result,) = gridmesh.map_sketches([outline], triangles=500, depth=2.0, profile="peak", corner_angle=1.0)
    assert result.vertices.tobytes() == deep.vertices.tobytes()
    (pillow,) = gridmesh.map_sketches([outline], inflate=False, triangles=500, corner_angle=1.0)
    assert pillow.vertices.tobytes() == gridmesh.stitch(patch).vertices.tobytes()


def test_a_map_of_nothing_is_empty():
    assert gridmesh.map_sketches([]) == []


def test_bad_options_of_a_map_are_raised_at_once():
    outlines = [circle()]
    with pytest.raises(TypeError, match="no option color"):
        gridmesh.map_sketches(outlines, color=3)
    with pytest.raises(TypeError, match="depth is of type"):
        gridmesh.map_sketches(outlines, depth="deep")
    with pytest.raises(TypeError, match="inflate is of type"):
        gridmesh.map_sketches(outlines, inflate=1)
    with pytest.raises(TypeError, match="threads is of type"):
        gridmesh.map_sketches(outlines, threads=1.5)
    for threads in (0, -1):
        with pytest.raises(gridmesh.GridMeshError, match="allowed: a positive whole number") as caught:
            gridmesh.map_sketches(outlines, threads=threads)
        assert caught.value.kind == "invalid_option"
    with pytest.raises(TypeError):
        gridmesh.map_sketches(5)


def test_an_iterable_that_fails_raises_its_own_error():
    def outlines():
        yield circle()
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        gridmesh.map_sketches(outlines(), triangles=100)
