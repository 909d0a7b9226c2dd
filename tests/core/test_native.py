"""A native module that is missing, broken, outdated or half updated: the message says what to do.

Each case is a package in files, loaded by Python as Blender would load it.
"""

import importlib
import sys

import pytest

from addon import native

MAJOR, MINOR, PATCH = (int(part) for part in native.NATIVE_VERSION.split("."))
NEXT_PATCH = f"{MAJOR}.{MINOR}.{PATCH + 1}"
NEXT_MINOR = f"{MAJOR}.{MINOR + 1}.0"
OLD = "0.0.9"


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Function that puts a package `gridmesh` in the place of the one that is installed."""
    for name in [name for name in sys.modules if name.split(".")[0] == "gridmesh"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(
        sys,
        "path",
        [str(tmp_path)] + [p for p in sys.path if not (native.Path(p) / "gridmesh").is_dir()],
    )
    monkeypatch.setattr(sys, "meta_path", [f for f in sys.meta_path if "gridmesh" not in repr(f)])

    def put(version, source=None):
        (tmp_path / "gridmesh").mkdir(exist_ok=True)
        code = f"__version__ = {version!r}\nmesh_sketch = None\n" if source is None else source
        (tmp_path / "gridmesh" / "__init__.py").write_text(code)
        for old in tmp_path.glob("*.dist-info"):
            (old / "METADATA").unlink()
            old.rmdir()
        about = tmp_path / f"gridmesh-{version}.dist-info"
        about.mkdir()
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: gridmesh\nVersion: {version}\n")
        importlib.invalidate_caches()

    yield put
    for name in [name for name in sys.modules if name.split(".")[0] == "gridmesh"]:
        del sys.modules[name]


def refusal(*needed):
    with pytest.raises(native.NativeError) as caught:
        native.native(*needed)
    return str(caught.value)


@pytest.mark.parametrize("version", [native.NATIVE_VERSION, NEXT_PATCH])
def test_versions_that_serve(installed, version):
    installed(version)
    assert native.native("mesh_sketch").__version__ == version


def test_missing(installed):
    text = refusal()
    assert "is missing; install the GridMesh zip for" in text
    assert "Install from Disk" in text


@pytest.mark.parametrize(
    "source",
    [
        "import gridmesh._native",
        "raise OSError('wrong machine')",
        "raise SystemError('damaged')",
        "import not_there",
    ],
)
def test_for_another_platform_or_damaged(installed, source):
    installed(native.NATIVE_VERSION, source)
    text = refusal()
    assert "could not be loaded" in text
    assert native._platform() in text
    assert "restart Blender" in text


def test_outdated(installed):
    installed(OLD)
    assert f"is {OLD}, this extension needs {native.NATIVE_VERSION}; install GridMesh" in refusal()


def test_newer_than_the_extension(installed):
    installed(NEXT_MINOR)
    assert "update GridMesh, then restart Blender" in refusal()


def test_loaded_before_an_update(installed):
    installed(OLD)
    refusal()
    installed(native.NATIVE_VERSION)
    assert refusal().startswith("Restart Blender to finish the update")


def test_files_of_two_versions(installed, monkeypatch):
    """Where the library could not be replaced while it was in use."""
    installed(native.NATIVE_VERSION, "from gridmesh._native import new_function")
    monkeypatch.setitem(sys.modules, "gridmesh._native", type(sys)("gridmesh._native"))
    assert refusal().startswith("Restart Blender to finish the update")


def test_unfinished_build(installed):
    installed(native.NATIVE_VERSION)
    assert "unfinished build without 'cut'" in refusal("mesh_sketch", "cut")


@pytest.mark.parametrize("version", ["strange", "", "1"])
def test_version_that_is_none(installed, version):
    installed(native.NATIVE_VERSION, f"__version__ = {version!r}")
    assert native.NATIVE_VERSION in refusal()
