"""Docstrings, their examples, and the stub file."""

import doctest
import inspect
import re
import subprocess
import sys
from pathlib import Path

import gridmesh
import pytest

FUNCTIONS = [
    gridmesh.bone_weights,
    gridmesh.bridge,
    gridmesh.combine,
    gridmesh.cover_sketch,
    gridmesh.cut,
    gridmesh.decode_image,
    gridmesh.fill_hole,
    gridmesh.fill_holes,
    gridmesh.flat,
    gridmesh.harmonic,
    gridmesh.inflate,
    gridmesh.is_outer_border,
    gridmesh.join,
    gridmesh.map_sketches,
    gridmesh.mesh_cutout,
    gridmesh.mesh_sketch,
    gridmesh.regrid,
    gridmesh.stitch,
    gridmesh.thickness,
    gridmesh.trace_image,
]

REFER_TO_OTHERS = [gridmesh.bridge, gridmesh.cover_sketch, gridmesh.fill_holes, gridmesh.regrid]
"""Some of their parameters are described at other functions."""

KINDS = Path(__file__).parents[2] / "rust" / "gridmesh" / "src" / "error" / "kind.rs"

README = Path(__file__).parents[2] / "README.md"


def readme_examples() -> list[str]:
    """The Python examples of the README that need no Blender."""
    text = README.read_text(encoding="utf-8") if README.exists() else ""
    return [code for code in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S) if "bpy" not in code]


@pytest.mark.parametrize("code", readme_examples())
def test_readme_examples_run(code, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "README.md", "exec"), {"__name__": "__main__"})


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.__name__)
def test_examples_run(function):
    example = doctest.DocTestParser().get_doctest(function.__doc__, {}, function.__name__, None, 0)
    assert example.examples
    failures = []
    runner = doctest.DocTestRunner(verbose=False, optionflags=doctest.NORMALIZE_WHITESPACE)
    runner.run(example, out=failures.append)
    assert not failures, "".join(failures)


@pytest.mark.parametrize(
    "function", [f for f in FUNCTIONS if f not in REFER_TO_OTHERS], ids=lambda f: f.__name__
)
def test_every_parameter_is_described(function):
    text = inspect.getdoc(function)
    for section in ("Parameters", "Returns", "Raises", "Examples"):
        assert f"{section}\n{'-' * len(section)}" in text
    for parameter in inspect.signature(function).parameters.values():
        stars = "**" if parameter.kind is parameter.VAR_KEYWORD else ""
        assert f"\n{stars}{parameter.name}" in text or f", {parameter.name} :" in text, parameter.name


@pytest.mark.parametrize("cls", [gridmesh.Patch, gridmesh.Surface], ids=lambda c: c.__name__)
def test_every_attribute_is_described(cls):
    text = inspect.getdoc(cls)
    for name in vars(cls):
        if not name.startswith("_"):
            assert f"\n{name} : " in text, name


@pytest.mark.native
def test_the_stub_file_is_true():
    command = [sys.executable, "-m", "mypy.stubtest", "gridmesh"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize(
    "picture", sorted((README.parent / "docs").rglob("*.png")), ids=lambda path: path.name
)
def test_pictures_hold_nothing_but_the_picture(picture):
    """Blender writes the path of the scene, the date and its settings into what it renders."""
    png, at, kinds = picture.read_bytes(), 8, []
    while at < len(png):
        kinds.append(png[at + 4 : at + 8])
        at += 12 + int.from_bytes(png[at : at + 4], "big")
    assert kinds[0] == b"IHDR"
    assert kinds[-1] == b"IEND"
    assert not {b"tEXt", b"zTXt", b"iTXt", b"eXIf"} & set(kinds)


@pytest.mark.skipif(not KINDS.exists(), reason="needs the sources")
def test_every_kind_of_error_is_described():
    kinds = set(re.findall(r'=> "(\w+)"', KINDS.read_text(encoding="utf-8")))
    described = set(re.findall(r'"(\w+)"', gridmesh.GridMeshError.__doc__))
    assert len(kinds) > 30
    assert not kinds - described
