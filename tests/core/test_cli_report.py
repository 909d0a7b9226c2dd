"""The report is whole: on a full disk, after a kill, and when two runs write to it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from addon.cli.report import Report, ReportError

ROOT = Path(__file__).parents[2]
posix = pytest.mark.skipif(os.name != "posix", reason="pipes and locks on parts of files are POSIX")


def line(name, **more):
    return {"id": name, "status": "ok", "key": "k", "digest": "d", **more}


def names(path):
    data = path.read_bytes()
    assert not data or data.endswith(b"\n")
    return [json.loads(one)["id"] for one in data.splitlines()]


def test_names_that_are_no_text_are_escaped_and_read_back(tmp_path):
    name = "caf\udce9\ud800 \u2028 ü"
    report = Report(tmp_path / "r", resume=False)
    report.write(line(name))
    assert report.done() == {name: ("k", "d")}
    report.close()
    assert names(tmp_path / "r") == [name]
    assert b"\\udce9" in (tmp_path / "r").read_bytes()
    assert "ü".encode() in (tmp_path / "r").read_bytes()


@pytest.mark.parametrize(
    "damage",
    [b'{"id": "b", "op', b'{"id"', b"{", b"\0" * 5000, b'{"id": "b"}', b"\xff\xfe", b"x" * 3_000_000],
)
def test_a_line_that_was_cut_off_is_taken_back(tmp_path, damage):
    path = tmp_path / "r"
    report = Report(path, resume=False)
    report.write(line("a"))
    report.close()
    with path.open("ab") as file:
        file.write(damage)
    report = Report(path, resume=True)
    assert report.done().keys() == {"a"}
    report.write(line("c"))
    report.close()
    assert names(path) == ["a", "c"]


@pytest.mark.parametrize(
    "damage", [b'{"id": 3, "key": "k"}', b"[" * 100_000, b'{"id": ["x"]}', b"\xff", b"null", b"x" * 3_000_000]
)
def test_damaged_lines_say_nothing(tmp_path, damage):
    path = tmp_path / "r"
    path.write_bytes(
        json.dumps(line("a")).encode() + b"\n" + damage + b"\n" + json.dumps(line("b")).encode() + b"\n"
    )
    report = Report(path, resume=True)
    assert report.done().keys() == {"a", "b"}
    report.close()


@pytest.mark.parametrize(
    "odd",
    [
        "folder",
        pytest.param("pipe", marks=posix),
        pytest.param("linked pipe", marks=posix),
        "below a file",
        "text",
    ],
)
def test_what_can_be_no_report_is_refused(tmp_path, odd):
    (tmp_path / "folder").mkdir()
    (tmp_path / "text").write_text("of value")
    if "pipe" in odd:
        os.mkfifo(tmp_path / "pipe")
        (tmp_path / "linked pipe").symlink_to("pipe")
    path = tmp_path / odd if odd != "below a file" else tmp_path / "text" / "r"
    for resume in (False, True):
        with pytest.raises(ReportError):
            Report(path, resume=resume)
    assert (tmp_path / "text").read_text() == "of value"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device here")
def test_a_device_may_take_the_report():
    report = Report(Path("/dev/null"), resume=True)
    assert report.done() == {}
    report.write(line("a"))
    assert report.unwritten is None
    report.close()
    report = Report(Path("/dev/full"), resume=False)
    report.write(line("a"))
    assert report.unwritten is not None
    report.close()


def test_a_full_disk_leaves_whole_lines_and_gets_the_others_later(tmp_path):
    resource = pytest.importorskip("resource", reason="POSIX alone limits the size of files")
    path = tmp_path / "r"
    report = Report(path, resume=False)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
        for at in range(30):
            report.write(line(f"{at}"))
        assert report.unwritten is not None
        assert 900 < path.stat().st_size <= 1000
        assert names(path) == [str(at) for at in range(len(names(path)))]
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    report.write(line("30"))
    assert report.unwritten is None
    report.close()
    assert names(path) == [str(at) for at in range(31)]


WRITER = """
import sys
from pathlib import Path
from addon.cli.report import Report
report = Report(Path(sys.argv[1]), resume=False)
def write(first, last):
    for at in range(first, last):
        report.write({"id": f"{sys.argv[2]}{at}", "message": "m" * (at * 37 % 6000)})
write(0, 5)
print("shared" if report.shared else "alone", flush=True)
sys.stdin.readline()
write(5, 200)
assert report.unwritten is None
"""


@posix
def test_runs_at_once_tear_and_lose_no_lines(tmp_path):
    """None of them asked to resume: the others must not empty what the first wrote."""
    path = tmp_path / "r"
    words = [sys.executable, "-c", WRITER, str(path)]
    writers = []
    for name in "abc":
        process = subprocess.Popen(
            [*words, name], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert process.stdout.readline() == ("shared\n" if writers else "alone\n")
        writers.append(process)
    for process in writers:
        process.stdin.close()
    for process in writers:
        assert process.wait() == 0
        process.stdout.close()
    found = names(path)
    for name in "abc":
        assert [one for one in found if one[0] == name] == [f"{name}{at}" for at in range(200)]


def test_a_run_that_begins_anew_empties_the_report(tmp_path):
    path = tmp_path / "r"
    for name in "ab":
        report = Report(path, resume=False)
        assert not report.shared
        report.write(line(name))
        report.close()
    assert names(path) == ["b"]
