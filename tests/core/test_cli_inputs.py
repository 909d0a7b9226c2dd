"""Damaged inputs are told, and what is told can be written to any terminal."""

import io
import struct
from pathlib import Path

import pytest

from addon.cli import files, inputs, ply, sound
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
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", True),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2", False),
        ("a.ply", b"ply", True),
        ("a.ply", b"", True),
        ("a.ply", b"ply\ncomment a\nformat ascii 1.0\nelement vertex 1\nend_header\n10 20 30\n", True),
        ("a.ply", b"ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nend_header\r\n10 20 3", False),
    ],
)
def test_a_cut_off_text_is_a_warning(tmp_path, name, data, whole):
    path = tmp_path / name
    path.write_bytes(data)
    assert bool(sound.require_whole(path)) != whole


def binary_ply(order, polygons, count=None):
    """Four vertices and these polygons, each with a color."""
    byte = {"<": "little", ">": "big"}[order]
    head = (
        f"ply\nformat binary_{byte}_endian 1.0\ncomment format ascii 1.0\nelement vertex 4\n"
        "property float x\nproperty double y\nproperty float32 z\n"
        f"element face {len(polygons) if count is None else count}\n"
        "property list uchar int vertex_indices\nproperty uchar red\nend_header\n"
    )
    if order == "<":
        head = head.replace("property uchar red\n", "")
    rows = [
        struct.pack(f"{order}B{len(one)}i", len(one), *one) + (b"\0" if order == ">" else b"")
        for one in polygons
    ]
    return head.encode(), bytes(4 * 16) + b"".join(rows)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("polygons", [[(0, 1, 2)] * 5, [(0, 1, 2), (0, 1, 2), (0, 1, 2, 3), (), (2, 1, 0)]])
def test_a_binary_ply_that_is_cut_off_anywhere_is_an_error(tmp_path, order, polygons):
    """Without the last bytes of an index it was read as one that has zeros there."""
    path = tmp_path / "a.ply"
    head, rows = binary_ply(order, polygons)
    for more in (b"", b"x"):
        path.write_bytes(head + rows + more)
        assert sound.require_whole(path) == []
        assert ply.binary_size(head + rows + more) == len(head + rows)
    for end in range(len(rows)):
        path.write_bytes(head + rows[:end])
        with pytest.raises(files.FileError, match="ends before") as error:
            sound.require_whole(path)
        assert error.value.kind == "load"


@pytest.mark.parametrize("count", [6, 2**31, 10**30])
def test_a_ply_says_too_much_of_itself(tmp_path, count):
    path = tmp_path / "a.ply"
    path.write_bytes(b"".join(binary_ply("<", [(0, 1, 2)] * 5, count)))
    with pytest.raises(files.FileError, match="ends before"):
        sound.require_whole(path)


def test_a_header_that_is_not_understood_is_left_to_the_importer():
    head, rows = binary_ply("<", [(0, 1, 2)] * 5)
    for old, new in [
        (b"binary_little", b"middle"),
        (b"double", b"half"),
        (b"face 5", b"face -5"),
        (b"end_", b""),
    ]:
        assert ply.binary_size(head.replace(old, new) + rows) is None


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


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[[0, 0], [1, 0], [0, 1]]", "one curve is"),
        (f"[[[0, 0], [1, 0], [1, {'9' * 5000}]]]", "5000 digits"),
        ("null", "it holds null; one curve is"),
        ('{"points": 5}', "it has 5 where a curve belongs; one curve is"),
        ('{"outline": []}', "it has no 'points'; one curve is"),
        ('{"points": [[0, 0]], "holes": 1}', "its 'holes' are 1; they must be a list"),
    ],
)
def test_what_is_wrong_is_said_in_words_of_the_format(text, said):
    with pytest.raises(inputs.InputError, match=said):
        inputs.curves(Path("a.json"), text.encode())


@pytest.mark.parametrize("row", ["x,y", '"1","0"', "1;0", "1\t0", "1,5;0,5", "1,0,0", "1", "1,,0"])
def test_a_row_that_is_no_point_is_named(row):
    with pytest.raises(inputs.InputError, match=r"row 3 is .*; a row is x,y, with a point in decimals"):
        inputs.curves(Path("a.csv"), f"0,0\n\n{row}\n".encode())


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


TEXT_PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n{}\n{}\n"
)


@pytest.mark.parametrize(
    ("place", "face", "wrong"),
    [
        ("0 1 0", "3 0 1 2", None),
        ("0 nan 0", "3 0 1 2", "vertex 2 is not at a finite place"),
        ("-inf 1 0", "3 0 1 2", "vertex 2 is not at a finite place"),
        ("0 1 0", "3 0 1 -1", "face 0 refers to vertex -1 of 3"),
        ("0 1 0", "3 0 3 2", "face 0 refers to vertex 3 of 3"),
    ],
)
def test_a_ply_with_bad_numbers_is_an_error(tmp_path, place, face, wrong):
    """They were left out, or taken for others, without a word."""
    path = tmp_path / "a.ply"
    path.write_text(TEXT_PLY.format(place, face))
    if wrong is None:
        assert sound.require_whole(path) == []
        return
    with pytest.raises(files.FileError, match=f"damaged: {wrong}") as error:
        sound.require_whole(path)
    assert error.value.kind == "load"


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("polygons", [[(0, 1, 2)] * 3, [(0, 1, 2), (0, 1, 2, 3), ()]])
@pytest.mark.parametrize("index", [-1, 4])
def test_a_binary_ply_with_bad_numbers_is_an_error(tmp_path, order, polygons, index):
    path = tmp_path / "a.ply"
    head, rows = binary_ply(order, [*polygons, (0, 1, index)])
    path.write_bytes(head + rows)
    with pytest.raises(files.FileError, match=f"face {len(polygons)} refers to vertex {index} of 4"):
        sound.require_whole(path)
    head, rows = binary_ply(order, polygons)
    path.write_bytes(head + rows[:16] + struct.pack(order + "f", float("nan")) + rows[20:])
    with pytest.raises(files.FileError, match="vertex 1 is not at a finite place"):
        sound.require_whole(path)


@pytest.mark.parametrize(
    ("faces", "wrong"),
    [
        ("f 1 2 3\nf -3//-1 -2//-1 -1//-1\n", None),
        ("f 1 2 4\nv 1 1 0\n", None),
        ("f 1 2 4\n", "line 4 refers to vertex 4 of 3"),
        ("f 1 2 0\n", "line 4 refers to vertex 0 of 3"),
        ("f -4 2 1\n", "line 4 refers to vertex -4 of 3 before it"),
        ("v 1 nan 0\nf 1 2 3\n", "line 4 has a coordinate that is not finite"),
    ],
)
def test_an_obj_with_bad_numbers_is_an_error(tmp_path, faces, wrong):
    """Negative numbers count back from the last vertex: they are right as long as there are so many."""
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + faces)
    if wrong is None:
        assert sound.require_whole(path) == []
        return
    with pytest.raises(files.FileError, match=wrong):
        sound.require_whole(path)
