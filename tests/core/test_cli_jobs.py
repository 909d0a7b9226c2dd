"""Files of jobs, and what an item may read and write: what is refused, and with which words."""

import json
import os

import pytest

from addon.cli import arguments, files, jobs, places, runner

# Windows has no named pipes among its files, and lets few users make links.
posix = pytest.mark.skipif(os.name != "posix", reason="pipes and links among files are POSIX")

SQUARE = {"points": [[0, 0], [1, 0], [1, 1], [0, 1]]}


def job(name="a", source="in.json", out=None, op="strokes", **params):
    return {"id": name, "op": op, "in": source, "out": out or f"{name}.ply", "params": params}


def read(folder, *items, prefix=""):
    path = folder / "jobs.jsonl"
    lines = [one if isinstance(one, str) else json.dumps(one) for one in items]
    path.write_text(prefix + "\n".join(lines) + "\n", encoding="utf-8")
    return jobs.read(path)


def problems(found):
    return [one.problem and one.problem[0] for one in found]


@pytest.mark.parametrize("letter", ["\u2028", "\u2029", "\x85", "\u000b"])
def test_only_a_line_feed_ends_a_line(tmp_path, letter):
    line = json.dumps(job(f"a{letter}b"), ensure_ascii=False)
    assert [one.id for one in read(tmp_path, line, job("c"))] == [f"a{letter}b", "c"]


def test_a_byte_order_mark_is_no_part_of_the_first_line(tmp_path):
    assert len(read(tmp_path, job(), prefix="\ufeff")) == 1


def test_windows_line_ends_and_empty_lines(tmp_path):
    assert len(read(tmp_path, job("a"), "\r", job("b"))) == 2


@pytest.mark.parametrize(
    "value", ["1e400", "-1e400", "NaN", "9" * 400, "9" * 5000, "true", '"1"', "null", "[1]", "{}"]
)
@pytest.mark.parametrize("name", ["depth", "triangles", "close_gaps"])
def test_what_is_no_number_is_refused_before_the_first_runs(tmp_path, name, value):
    line = json.dumps(job()).replace('"params": {}', f'"params": {{"{name}": {value}}}')
    with pytest.raises(jobs.JobError, match="line 2"):
        read(tmp_path, job("b"), line)


@pytest.mark.parametrize(
    "line", ["[" * 100_000, '{"id":' * 50_000, "null", '"text"', "{", '{"id": "\\', "\x00", "{}", "[]"]
)
def test_lines_that_are_no_jobs_are_named(tmp_path, line):
    with pytest.raises(jobs.JobError, match="line 1"):
        read(tmp_path, line)


def test_a_file_without_jobs_says_so(tmp_path):
    with pytest.raises(jobs.JobError, match="no jobs"):
        read(tmp_path)


def test_bad_lines_without_end_are_counted(tmp_path):
    with pytest.raises(jobs.JobError) as error:
        read(tmp_path, *["{"] * 1500)
    assert str(error.value).endswith("and 500 more")


def test_a_huge_file_of_jobs_is_not_read_to_its_end(tmp_path):
    path = tmp_path / "jobs.jsonl"
    with path.open("wb") as file:
        file.truncate(1 << 36)
    with pytest.raises(jobs.JobError, match="line 1: it is longer"):
        jobs.read(path)


@pytest.fixture
def odd(tmp_path):
    """Things that are no files, by what they are called."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "zero").symlink_to("/dev/zero")
    (tmp_path / "link").symlink_to("pipe")
    (tmp_path / "loop").symlink_to("loop")
    return tmp_path


@posix
@pytest.mark.parametrize("name", ["pipe", "folder", "zero", "link", "loop", "nothing"])
def test_only_regular_files_are_read(odd, name):
    with pytest.raises((files.FileError, OSError)):
        files.opened(odd / name)
    with pytest.raises((files.FileError, OSError)):
        files.key_of([], [str(odd / name)], 1e9, outside=False)
    assert files.digest_of(odd / name) is None
    with pytest.raises(jobs.JobError):
        jobs.read(odd / name)


def gltf(folder, *uris, name="a.gltf"):
    path = folder / name
    path.write_text(json.dumps({"buffers": [{"byteLength": 9, "uri": uri} for uri in uris]}))
    return path


@posix
@pytest.mark.parametrize(
    ("uri", "kind"),
    [
        ("/dev/zero", "outside"),
        ("../secret.bin", "outside"),
        ("%2e%2e/secret.bin", "outside"),
        ("sub/../../secret.bin", "outside"),
        ("link.bin", "outside"),
        ("data:/../../secret.bin", "outside"),
        ("http://127.0.0.1:9/a.bin", "outside"),
        ("file:///etc/passwd", "outside"),
        ("a%00.bin", "bad_path"),
        ("\ud800.bin", "bad_path"),
        ("pipe.bin", "not_a_file"),
        ("sub", "not_a_file"),
    ],
)
def test_uris_stay_inside_the_folder(tmp_path, uri, kind):
    folder = tmp_path / "in"
    (folder / "sub").mkdir(parents=True)
    (tmp_path / "secret.bin").write_bytes(b"secret")
    (folder / "link.bin").symlink_to("../secret.bin")
    os.mkfifo(folder / "pipe.bin")
    plain = gltf(folder, uri)
    text = plain.read_bytes()
    binary = folder / "a.glb"
    binary.write_bytes(
        b"glTF"
        + (2).to_bytes(4, "little")
        + (20 + len(text)).to_bytes(4, "little")
        + len(text).to_bytes(4, "little")
        + b"JSON"
        + text
    )
    for path in (plain, binary):
        with pytest.raises(files.FileError) as error:
            files.key_of([], [str(path)], 1e9, outside=False)
        assert error.value.kind == kind


def test_uris_inside_and_outside_if_allowed(tmp_path):
    folder = tmp_path / "in"
    (folder / "sub").mkdir(parents=True)
    (tmp_path / "out.bin").write_bytes(b"1")
    (folder / "sub" / "ä b.bin").write_bytes(b"2")
    path = gltf(folder, "sub/%C3%A4%20b.bin", "data:;base64,AAAA", "")
    key, found = files.key_of([], [str(path)], 1e9, outside=False)
    assert [one.name for one in found] == ["a.gltf", "ä b.bin"]
    (folder / "sub" / "ä b.bin").write_bytes(b"3")
    assert files.key_of([], [str(path)], 1e9, outside=False)[0] != key
    path = gltf(folder, "../out.bin")
    assert len(files.key_of([], [str(path)], 1e9, outside=True)[1]) == 2


def test_size_is_looked_at_before_content(tmp_path):
    path = tmp_path / "a.gltf"
    with path.open("wb") as file:
        file.truncate(1 << 36)
    with pytest.raises(files.FileError, match="--max-megabytes") as error:
        files.key_of([], [str(path)], 1e6, outside=False)
    assert error.value.kind == "too_large"
    (tmp_path / "a.bin").write_bytes(b"x" * 1000)
    with pytest.raises(files.FileError, match="--max-megabytes"):
        files.key_of([], [str(gltf(tmp_path, "a.bin", name="b.gltf"))], 1000, outside=False)


@posix
def test_materials_of_an_obj_are_files_that_it_reads(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("mtllib none.mtl\nmtllib b.mtl\nv 0 0 0\n")
    (tmp_path / "b.mtl").write_text("newmtl b\n")
    (tmp_path / "a.mtl").write_text("newmtl a\n")
    assert {one.name for one in files.key_of([], [str(path)], 1e6, outside=False)[1]} == {
        "a.obj",
        "a.mtl",
        "b.mtl",
    }
    (tmp_path / "a.mtl").unlink()
    os.mkfifo(tmp_path / "a.mtl")
    with pytest.raises(files.FileError, match="named pipe"):
        files.key_of([], [str(path)], 1e6, outside=False)


@pytest.mark.parametrize("key", ["in", "out", "stroke"])
def test_half_characters_in_paths_are_errors_of_their_item(tmp_path, key):
    if key == "stroke":
        bad = job("b", "b.ply", "o.ply", "cut", stroke="\ud800.json")
    else:
        bad = job("b") | {key: f"\ud800{'.json' if key == 'in' else '.ply'}"}
    found = read(tmp_path, job("a"), bad, job("\ud800", out="c.ply"))
    assert problems(found) == [None, "bad_path", None]
    found[1].problem[1].encode()  # may be written anywhere


def test_names_that_windows_keeps_for_itself():
    assert places.problem_of("a/con.ply", "win32")
    assert places.problem_of("a\\LPT1.x\\b.ply", "win32")
    assert places.problem_of("a/con.ply", "linux") is None
    assert places.problem_of("a/console.ply", "win32") is None


def test_half_characters_are_refused_on_windows_too():
    assert "half a character" in places.problem_of("a/\ud800.ply", "win32")
    assert "half a character" in places.problem_of("a/\udc80.ply", "win32")
    assert places.problem_of("a/\udc80.ply", "linux") is None  # a byte that is no UTF-8


@posix
def test_ways_to_the_same_output_are_found(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "linked").symlink_to("real")
    (tmp_path / "real" / "to.ply").symlink_to("same.ply")
    ways = [
        "real/same.ply",
        "real/x/../same.ply",
        "linked/same.ply",
        "real/./same.ply",
        "real/to.ply",
        str(tmp_path / "real/same.ply"),
    ]
    found = read(tmp_path, *[job(str(at), out=way) for at, way in enumerate(ways)])
    assert problems(found) == [None] + ["duplicate_out"] * 5


def test_names_that_differ_by_case_are_the_same_where_the_system_says_so(tmp_path, monkeypatch):
    items = [job("a", out="Same.ply"), job("b", out="same.ply")]
    alone = problems(read(tmp_path, *items))
    assert alone == [None, "duplicate_out" if places._ignores_case(str(tmp_path)) else None]
    monkeypatch.setattr(places, "_ignores_case", lambda _: True)
    assert problems(read(tmp_path, *items)) == [None, "duplicate_out"]


@posix
def test_outputs_overwrite_no_input_and_no_jobs(tmp_path):
    (tmp_path / "other.ply").symlink_to("a.ply")
    (tmp_path / "j.ply").write_text(
        "\n".join(
            json.dumps(one)
            for one in [
                job("own", "a.ply", "x/../a.ply", "fill"),
                job("link", "a.ply", "other.ply", "fill"),
                job("jobs", "b.ply", "j.ply", "fill"),
                job("made", "c.ply", "d.ply", "fill"),
                job("chained", "d.ply", "e.ply", "fill"),
                job("back", "e.ply", "c.ply", "fill"),
            ]
        )
    )
    found = jobs.read(tmp_path / "j.ply")
    assert problems(found) == ["overwrites", "overwrites", "overwrites", None, None, "overwrites"]


@posix
@pytest.mark.parametrize(
    "report", ["jobs.jsonl", "x/../jobs.jsonl", "linked.jsonl", "in.json", "a.ply", "other.txt"]
)
def test_the_report_overwrites_nothing(tmp_path, report, capsys):
    (tmp_path / "in.json").write_text(json.dumps(SQUARE))
    (tmp_path / "linked.jsonl").symlink_to("jobs.jsonl")
    (tmp_path / "other.txt").write_text("of value")
    read(tmp_path, job())
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert arguments.main(["batch", str(tmp_path / "jobs.jsonl"), "--report", str(tmp_path / report)]) == 2
    assert "--report" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize("option", ["--max-megabytes", "--max-memory", "--max-seconds"])
@pytest.mark.parametrize("value", ["inf", "nan", "-1", "1e12", "1e400", "", "ten", "-inf"])
def test_limits_are_numbers_within_bounds(tmp_path, option, value, capsys):
    read(tmp_path, job())
    assert arguments.main(["batch", str(tmp_path / "jobs.jsonl"), f"{option}={value}"]) == 2
    assert f"{option}: " in capsys.readouterr().err


def test_no_megabytes_are_none_to_read(tmp_path):
    assert arguments.main(["batch", str(tmp_path / "jobs.jsonl"), "--max-megabytes", "0"]) == 2


@pytest.mark.parametrize("word", ["x" * 5000, "x" * 300 + "/*.json", "folder"])
def test_inputs_that_cannot_be_looked_at_are_named(tmp_path, word, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    assert arguments.main(["strokes", word, "-o", "{name}.ply", "--report", str(tmp_path / "r")]) in (1, 2)
    assert "Traceback" not in capsys.readouterr().err


def test_settings_of_a_run_begin_with_what_is_safe():
    chosen = arguments._parser().parse_args(["batch", "jobs.jsonl"])
    assert not runner.Settings().outside
    assert not arguments._settings(chosen).outside
    assert arguments._settings(arguments._parser().parse_args(["batch", "j", "--allow-outside"])).outside
