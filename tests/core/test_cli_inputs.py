"""Damaged inputs are told, and what is told can be written to any terminal."""

import io
import struct
from pathlib import Path

import pytest

from addon.cli import files, inputs, sound
from addon.cli.telling import Teller


def stl(claimed, there, more=b""):
    return bytes(80) + struct.pack("<I", claimed) + bytes(50) * there + more


TEXT = (
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
)


@pytest.mark.parametrize("data", [stl(1000, 2), stl(2, 3), stl(2, 2, b"x"), b"\x93" * 5000, b"x" * 10, b""])
def test_an_stl_that_is_not_as_long_as_it_says_is_an_error(tmp_path, data):
    path = tmp_path / "a.stl"
    path.write_bytes(data)
    with pytest.raises(files.FileError) as error:
        sound.require_whole(path)
    assert error.value.kind == "load"


@pytest.mark.parametrize(
    ("name", "data", "whole"),
    [
        ("a.stl", stl(2, 2), True),
        ("a.stl", b"solid" + stl(2, 2)[5:], True),
        ("a.stl", f"{TEXT}endsolid a\n".encode(), True),
        ("a.stl", TEXT.encode(), False),
        ("a.obj", b"v 0 0 0\nf 1 2 3\n", True),
        ("a.obj", b"v 0 0 0\nf 1 2", False),
        ("a.ply", b"ply", True),
    ],
)
def test_a_cut_off_text_is_a_warning(tmp_path, name, data, whole):
    path = tmp_path / name
    path.write_bytes(data)
    assert bool(sound.require_whole(path)) != whole


def test_faces_that_were_left_out_are_counted(tmp_path):
    path = tmp_path / "a.obj"
    path.write_bytes(b"v 0 0 0\nf 1 2 3\n  f\t1 2 4\n# f 1\nfo 3\nf 1 2 9\n")
    assert sound.left_out(path, 3) == []
    assert sound.left_out(path, 1)[0].startswith("2 of 3 faces")


@pytest.mark.parametrize("number", ["true", '"1"', "[1]", "{}", "9" * 400])
def test_what_is_no_number_is_no_coordinate(number):
    text = f"[[[0, 0], [1, 0], [1, {number}]]]"
    with pytest.raises(inputs.InputError):
        inputs.curves(Path("a.json"), text.encode())


@pytest.mark.parametrize(
    "text",
    ["[" * 100_000, "[[1, 2], [3, 4]]", "[1]", "3", "null", '{"points": 1}', '{"points": [], "holes": 1}'],
)
def test_what_is_no_list_of_curves_says_so(text):
    with pytest.raises(inputs.InputError):
        inputs.curves(Path("a.json"), text.encode())


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
def test_any_terminal_can_show_any_name(encoding):
    raw = io.BytesIO()
    teller = Teller(1, io.TextIOWrapper(raw, encoding=encoding))
    teller.item(1, {"id": "日本 \ud800 \udce9", "status": "ok"})
    teller.line("report: \udce9 日本")
    assert not teller.deaf
    assert raw.getvalue().count(b"\n") == 2


def test_nobody_to_tell_is_no_error(monkeypatch):
    monkeypatch.setattr("sys.stdout", None)
    Teller(1).item(1, {"id": "a", "status": "ok"})
