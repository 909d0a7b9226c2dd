"""The watch over the worker: whatever it does, it is ended, and why is told apart."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from time import monotonic

import pytest

from addon.cli import drafts, limits, process, runner

ROOT = Path(__file__).parents[2]
READY = "import os, sys, signal, mmap, time; print('@gridmesh {}', flush=True); sys.stdin.readline()\n"
TOUCH = "x = bytearray(1_000_000)\nwhile True: x += bytes(10_000_000)\n"
posix = pytest.mark.skipif(os.name != "posix", reason="Windows has no signals, and does not say what lives")
linux = pytest.mark.skipif(sys.platform != "linux", reason="memory is watched on Linux alone")


@pytest.fixture
def ask(monkeypatch):
    """Ask a worker that is this script, once."""
    workers = []

    def asked(script, *requests, megabytes=0.0, seconds=0.0):
        monkeypatch.setattr(process, "_command", lambda **_: [sys.executable, "-c", READY + script])
        worker = process.Worker(process.Limits(100, megabytes, seconds), scripts=False)
        workers.append(worker)
        return worker.do(*(requests or ({},)))

    yield asked
    for worker in workers:
        worker.close()


ENDS = {
    "killed by the system": "os.kill(os.getpid(), getattr(signal, 'SIGKILL', signal.SIGTERM))",
    "segmentation fault": "os.kill(os.getpid(), signal.SIGSEGV)",
    "abort": "os.abort()",
    "exit": "os._exit(1)",
    "half an answer": "os.write(1, b'@gridmes'); os._exit(0)",
}


@pytest.mark.parametrize("end", ENDS)
def test_a_crash_is_a_crash(ask, end):
    answer = ask(ENDS[end], megabytes=4000, seconds=100)
    assert (answer["status"], answer["kind"]) == ("error", "crashed")


@posix
def test_a_crash_names_its_signal(ask):
    assert "SIGSEGV" in ask(ENDS["segmentation fault"])["message"]


@linux
@pytest.mark.parametrize(
    "script",
    [
        TOUCH,
        "x = mmap.mmap(-1, 600_000_000, flags=mmap.MAP_PRIVATE)\nwhile True: pass",
        "x = [mmap.mmap(-1, 10_000_000, flags=mmap.MAP_PRIVATE) for _ in range(60)]\ntime.sleep(1000)",
    ],
)
def test_above_its_memory_it_is_ended_whatever_it_would_do_then(ask, script):
    """It is the watch that ends it: no allocation fails, so no library has to say why."""
    answer = ask(script, megabytes=500, seconds=100)
    assert answer["kind"] == "out_of_memory"
    assert "500 megabytes" in answer["message"]


@linux
@pytest.mark.parametrize(
    "said",
    [
        "memory allocation of 99 bytes failed",
        "Malloc returns null: len=99 in mesh",
        "terminate called after throwing an instance of 'std::bad_alloc'",
        "MemoryError",
    ],
)
def test_what_asks_for_too_much_at_once_says_so_before_it_ends(ask, said):
    assert ask(f"sys.stderr.write({said!r}); sys.stderr.flush(); os.abort()")["kind"] == "out_of_memory"


@linux
def test_the_system_without_memory_is_told_from_a_kill(ask, monkeypatch):
    count = iter(range(100))
    monkeypatch.setattr(limits, "system_kills", lambda: next(count))
    answer = ask(ENDS["killed by the system"])
    assert answer["kind"] == "out_of_memory"
    assert "the system" in answer["message"]


@linux
def test_the_memory_of_a_process_is_what_it_took():
    with subprocess.Popen(
        [
            sys.executable,
            "-c",
            READY + "x = bytearray(200_000_000); print(1, flush=True); sys.stdin.readline()",
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as child:
        child.stdout.readline()
        before = limits.in_use(child.pid)
        child.stdin.write("\n")
        child.stdin.flush()
        child.stdout.readline()
        assert limits.in_use(child.pid) - before == pytest.approx(200, abs=5)
        child.kill()
    assert limits.in_use(child.pid) == 0


def test_an_item_without_end_is_stopped(ask):
    answer = ask("while True: pass", seconds=0.3)
    assert (answer["kind"], "--max-seconds" in answer["message"]) == ("stopped", True)


def test_time_is_that_of_all_requests_of_an_item(ask):
    answers = (
        "for line in ['{}', *sys.stdin]: print('@gridmesh {\"status\": \"ok\"}', flush=True); time.sleep(0.2)"
    )
    assert ask(answers, {}, {}, {}, {}, {}, {}, seconds=0.5)["kind"] == "stopped"


def test_the_start_of_blender_is_not_the_time_of_an_item(ask):
    slow = 'time.sleep(0.6); print(\'@gridmesh {"status": "ok"}\', flush=True); sys.stdin.readline()'
    assert ask(slow, {"do": "prepare"}, seconds=0.2)["status"] == "ok"


def test_a_worker_that_closes_its_output_and_lives_on_is_ended(ask, monkeypatch):
    monkeypatch.setattr(process, "_PATIENCE", 0.3)
    assert ask("os.close(1); time.sleep(1000)", seconds=0)["kind"] == "crashed"


@posix
def test_a_worker_that_hangs_at_its_end_is_ended(monkeypatch):
    monkeypatch.setattr(process, "_PATIENCE", 0.3)
    answers = 'print(\'@gridmesh {"status": "ok"}\', flush=True)\nsignal.signal(signal.SIGTERM, signal.SIG_IGN)\ntime.sleep(1000)'
    monkeypatch.setattr(process, "_command", lambda **_: [sys.executable, "-c", READY + answers])
    worker = process.Worker(process.Limits(), scripts=False)
    assert worker.do({})["status"] == "ok"
    child = worker.process
    worker.close()
    assert child.returncode == -signal.SIGKILL


@linux
def test_a_worker_that_kept_memory_is_renewed(monkeypatch):
    """The next item is not refused for what the last one took."""
    answers = (
        'x = bytearray(400_000_000)\nprint(\'@gridmesh {"status": "ok"}\', flush=True)\nsys.stdin.readline()'
    )
    monkeypatch.setattr(process, "_command", lambda **_: [sys.executable, "-c", READY + answers])
    worker = process.Worker(process.Limits(100, 600, 0), scripts=False)
    assert [worker.do({})["status"] for _ in range(3)] == ["ok"] * 3
    assert worker.process is None
    worker.close()


def test_talk_without_end_fills_no_disk(ask, monkeypatch):
    monkeypatch.setattr(process, "_CHATTER", 1 << 20)
    answer = ask("while True: sys.stderr.write('x' * 100_000)", seconds=1)
    assert answer["kind"] == "stopped"


@posix
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    "script", ["while True: pass", "signal.signal(15, signal.SIG_IGN); time.sleep(1000)"]
)
def test_two_signals_end_whatever_it_does(ask, monkeypatch, number, script):
    stops, heard = [], threading.Event()
    monkeypatch.setattr(runner.os, "write", lambda *_: (stops.append(1), heard.set()))
    before = process.Worker.do

    def signals():
        os.kill(os.getpid(), number)
        # Two that come before one is heard are one to Python.
        heard.wait()
        os.kill(os.getpid(), number)

    def do(worker, *requests):
        stop = runner._Stop(worker)
        threading.Timer(0.3, signals).start()
        try:
            return before(worker, *requests)
        finally:
            stop.forget()

    monkeypatch.setattr(process.Worker, "do", do)
    handler = signal.getsignal(number)
    answer = ask(script)
    assert (answer["kind"], answer["message"]) == ("stopped", "stopped by the user")
    assert stops == [1]
    assert signal.getsignal(number) == handler


@posix
def test_a_signal_that_is_handled_for_long_does_not_end_the_watch(ask):
    """The wait for an answer had no end after it, and no limit was looked at any more."""
    handled = []

    def handle(*_):
        assert not handled, "the watch has ended"
        handled.append(1)
        threading.Event().wait(10 * process._PERIOD)

    before = signal.signal(signal.SIGUSR1, handle)
    # The second comes only if nothing stops the worker, and ends a wait without end.
    timers = [threading.Timer(after, os.kill, (os.getpid(), signal.SIGUSR1)) for after in (0.5, 120.0)]
    for timer in timers:
        timer.start()
    try:
        answer = ask("while True: pass", seconds=2.0)
    finally:
        for timer in timers:
            timer.cancel()
        signal.signal(signal.SIGUSR1, before)
    assert handled == [1]
    assert (answer["kind"], "--max-seconds" in answer["message"]) == ("stopped", True)


def test_after_the_second_signal_nothing_is_started():
    worker = process.Worker(process.Limits(), scripts=False)
    worker.kill()
    assert worker.do({})["kind"] == "stopped"
    assert worker.process is None
    worker.close()


@posix
def test_drafts_of_the_dead_are_removed_and_those_of_the_living_stay(tmp_path):
    """Two runs may write the same file at once, each to a draft of its own."""
    out = tmp_path / ("n" * 240 + ".ply")
    with subprocess.Popen([sys.executable, "-c", ""]) as child:
        pass
    dead = tmp_path / f"{drafts.prefix(out, child.pid)}a.ply"
    living = tmp_path / f"{drafts.prefix(out, os.getppid())}a.ply"
    other = tmp_path / f"{drafts.prefix(tmp_path / 'other.ply', os.getppid())}a.ply"
    for file in (dead, living, other):
        file.touch()
    drafts.sweep(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted([living, other])
    drafts.remove(out, os.getppid())
    assert list(tmp_path.iterdir()) == [other]
    drafts.remove(tmp_path / "nowhere" / "a.ply", os.getpid())
    drafts.sweep(tmp_path / "nowhere")


@linux
def test_a_worker_ends_with_its_owner(tmp_path):
    """A run that was killed leaves nothing behind that still writes."""
    script = (
        "import subprocess, sys, os, time; child = subprocess.Popen([sys.executable, '-c', "
        "\"import sys; sys.path.insert(0, '.'); from addon.cli import limits; limits.end_with_owner(); "
        "print('on', flush=True)\\nwhile True: pass\"], stdout=subprocess.PIPE); child.stdout.readline(); "
        "print(child.pid, flush=True); time.sleep(1000)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as owner:
        number = int(owner.stdout.readline())
        owner.kill()
    give_up = monotonic() + 30
    while (state := _state(number)) not in ("", "Z"):
        assert monotonic() < give_up, state
        os.sched_yield()


def _state(number):
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(") ")[2][:1]
    except OSError:
        return ""
