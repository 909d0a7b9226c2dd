"""`map_sketches` over executors: threads, processes, and a cluster of several workers."""

import multiprocessing
import re
import subprocess
import sys
import threading
import warnings
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import gridmesh
import numpy as np
import pytest
from sketches import BAD, SHAPES

OPTIONS = {"triangles": 400, "depth": 0.8}


@pytest.fixture(scope="module")
def drawings():
    """Outlines of every kind, some of them bad, more than fit into one task."""
    found = [shape["points"] for shape in SHAPES.values()] * 2
    found[3:3] = [BAD["figure_eight"]["points"], None, "text"]
    ring = SHAPES["circle"]["points"]
    found.append((ring, [(0.5 * np.asarray(ring)).tolist()]))
    return found


@pytest.fixture(scope="module")
def local(drawings):
    return told(gridmesh.map_sketches(drawings, **OPTIONS))


def told(results):
    """Everything that a result is, as bytes or words."""
    return [
        (result.kind, str(result))
        if isinstance(result, gridmesh.GridMeshError)
        else (
            result.vertices.tobytes(),
            result.triangles.tobytes(),
            result.uv.tobytes(),
            [loop.tobytes() for loop in result.silhouette],
        )
        for result in results
    ]


def test_threads_give_the_same(drawings, local):
    with ThreadPoolExecutor(3) as executor:
        assert told(gridmesh.map_sketches(iter(drawings), executor=executor, **OPTIONS)) == local


def test_processes_give_the_same(drawings, local):
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=context) as executor:
        assert told(gridmesh.map_sketches(drawings, executor=executor, **OPTIONS)) == local


def test_a_dask_cluster_of_four_workers_gives_the_same(drawings, local):
    distributed = pytest.importorskip("distributed", reason="DASK IS MISSING, so no cluster was tested")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of ports in use, and of what it is built on
        with (
            distributed.LocalCluster(
                n_workers=4, threads_per_worker=1, processes=True, dashboard_address=None
            ) as cluster,
            distributed.Client(cluster) as client,
            client.get_executor(pure=False) as executor,
        ):
            assert len(client.scheduler_info(n_workers=-1)["workers"]) == 4
            assert told(gridmesh.map_sketches(drawings, executor=executor, **OPTIONS)) == local


def test_the_example_of_the_manual_runs(tmp_path):
    pytest.importorskip("distributed", reason="DASK IS MISSING, so no cluster was tested")
    page = (Path(__file__).parents[2] / "docs" / "batch.md").read_text(encoding="utf-8")
    (code,) = [
        code for code in re.findall(r"^```python\n(.*?)^```", page, re.M | re.S) if "LocalCluster" in code
    ]
    script = tmp_path / "cluster.py"
    script.write_text(
        code + "        print([len(body.triangles) for body in same] == [len(b.triangles) for b in bodies])\n"
    )
    ran = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert ran.stdout.strip() == "True", ran.stdout + ran.stderr


def test_stitched_only_and_empty():
    outlines = [SHAPES["bean"]["points"]]
    with ThreadPoolExecutor(1) as executor:
        (flat,) = gridmesh.map_sketches(outlines, executor=executor, inflate=False, triangles=300)
        assert not flat.vertices[:, 2].any()
        assert gridmesh.map_sketches([], executor=executor) == []


class Reluctant(Executor):
    """Does its tasks only when it is told to."""

    def __init__(self):
        self.futures = []

    def submit(self, function, /, *arguments, **options):
        self.futures.append(Future())
        threading.Thread(target=self._first, args=(function, arguments)).start()
        return self.futures[-1]

    def _first(self, function, arguments):
        if len(self.futures) == 1 and self.futures[0].set_running_or_notify_cancel():
            self.futures[0].set_result(function(*arguments))


def test_cancelled_by_progress_leaves_no_task_waiting():
    executor = Reluctant()
    fractions = []
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.map_sketches(
            [SHAPES["bean"]["points"]] * 20,
            executor=executor,
            progress=lambda fraction: fractions.append(fraction) or fraction == 0,
            **OPTIONS,
        )
    assert caught.value.kind == "cancelled"
    assert [fraction for fraction in fractions if fraction] == pytest.approx([1 / 3])
    assert all(future.cancelled() for future in executor.futures[1:])


def test_bad_options_are_raised_before_anything_is_sent():
    executor = Reluctant()
    outlines = [SHAPES["bean"]["points"]]
    for options in ({"color": 3}, {"inflate": 1}, {"progress": 3}, {"threads": 1.5}):
        with pytest.raises(TypeError):
            gridmesh.map_sketches(outlines, executor=executor, **options)
    with pytest.raises(gridmesh.GridMeshError):
        gridmesh.map_sketches(outlines, executor=executor, threads=0)
    assert not executor.futures
    with pytest.raises(TypeError, match="executor is of type int"):
        gridmesh.map_sketches(outlines, executor=3)
