"""What must not be shipped is found before it is: wheels, manifests and zips that break a rule."""

import shutil
import sys
import zipfile
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

import package

from addon import native

LINUX = f"gridmesh-{package.addon_version()}-cp311-abi3-manylinux_2_28_x86_64.whl"


def wheel(folder, name=LINUX, library=b"\0GLIBC_2.17\0", module="gridmesh/_native.abi3.so"):
    path = folder / name
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(module, library)
        archive.writestr("gridmesh/__init__.py", "")
    return path


def manifest(**changed):
    return {**native.MANIFEST, **changed}


def test_wheel_without_faults(tmp_path):
    assert package.wheel_problems(wheel(tmp_path)) == []


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        ({"library": b"\0GLIBC_2.35\0GLIBC_2.4\0"}, "needs glibc 2.35"),
        ({"name": LINUX.replace("abi3", "cp311")}, "not an abi3 wheel"),
        ({"name": LINUX.replace("0.1.0", "9.9.9")}, "the extension is"),
        ({"name": LINUX.replace("manylinux_2_28", "musllinux_1_2")}, "no platform of Blender"),
        ({"name": LINUX.replace("manylinux_2_28", "linux")}, "no platform of Blender"),
        ({"module": "gridmesh/_native.cpython-311-x86_64-linux-gnu.so"}, "one abi3 module"),
        ({"module": "other/_native.abi3.so"}, "installs more than gridmesh"),
    ],
)
def test_wheel_that_is_not_what_its_name_says(tmp_path, changed, problem):
    assert any(problem in found for found in package.wheel_problems(wheel(tmp_path, **changed)))


@pytest.mark.parametrize("platform", package.PLATFORMS.values())
def test_every_platform_has_a_wheel_of_its_own(tmp_path, platform):
    tag = {
        "linux-x64": "manylinux_2_28_x86_64",
        "windows-x64": "win_amd64",
        "windows-arm64": "win_arm64",
        "macos-x64": "macosx_10_12_x86_64",
        "macos-arm64": "macosx_11_0_arm64",
    }[platform]
    assert package._platform(tag) == platform
    module = "gridmesh/_native.pyd" if tag.startswith("win") else "gridmesh/_native.abi3.so"
    built = wheel(tmp_path, LINUX.replace("manylinux_2_28_x86_64", tag), module=module)
    assert package.wheel_problems(built) == []


def test_manifest_of_the_source_tree():
    assert package.manifest_problems(native.MANIFEST, package.ADDON) == []


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        ({"name": "GridMesh for Blender"}, "must not contain"),
        ({"tagline": "Meshes!"}, "tagline"),
        ({"tagline": "x" * 65}, "tagline"),
        ({"tags": ["Mesh", "Meshes"]}, "unknown tag: Meshes"),
        ({"platforms": ["linux-x86_64"]}, "unknown platform: linux-x86_64"),
        ({"platforms": ["linux-x64"]}, "wheels are for"),
        ({"wheels": [f"./wheels/{LINUX}"]}, "listed but not there"),
        ({"permissions": {"disk": "Files"}}, "unknown permission"),
        ({"permissions": {"network": "Updates"}}, "no network"),
        ({"permissions": {"files": "Reads files."}}, "reason of files"),
        ({"license": ["SPDX:MIT"]}, "GPL-3.0-or-later"),
        ({"copyright": ["GridMesh developers"]}, "line of copyright"),
        ({"blender_version_max": "5.3.0"}, "no later Blender"),
        ({"maintainer": " "}, "maintainer"),
    ],
)
def test_manifest_that_would_be_refused(tmp_path, changed, problem):
    assert any(problem in found for found in package.manifest_problems(manifest(**changed), tmp_path))


@pytest.fixture
def source(tmp_path):
    """Files of a zip, with nothing wrong about them."""
    folder = tmp_path / "source"
    (folder / "wheels").mkdir(parents=True)
    shutil.copy(package.ADDON / "blender_manifest.toml", folder)
    package._list_wheels(folder / "blender_manifest.toml", [wheel(folder / "wheels")])
    (folder / "LICENSE").write_text("GPL")
    (folder / "__init__.py").write_text("import sys\n")
    return folder


def zipped(source):
    path = source.parent / "gridmesh.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for file in filter(Path.is_file, sorted(source.rglob("*"))):
            archive.write(file, file.relative_to(source))
    return path


def test_zip_without_faults(source):
    assert package.zip_problems(zipped(source)) == []


@pytest.mark.parametrize(
    ("name", "text", "problem"),
    [
        ("loose.so", "", "native code comes in wheels"),
        ("__pycache__/a.py", "", "which nobody needs"),
        (".git/config", "", "which nobody needs"),
        ("fetch.py", "import urllib.request", "imports urllib.request"),
        ("fetch.py", "from pip import main", "imports pip"),
        ("paths.py", "import sys\nsys.path.append('x')", "touches sys.path"),
        ("future.py", "type X = int", "Python 3.11 does not read"),
        ("wheels/other.whl", "", "lists"),
    ],
)
def test_zip_that_breaks_a_rule(source, name, text, problem):
    (source / name).parent.mkdir(exist_ok=True)
    (source / name).write_text(text)
    assert any(problem in found for found in package.zip_problems(zipped(source)))


def test_zip_without_licence(source):
    (source / "LICENSE").unlink()
    assert any("no licence" in found for found in package.zip_problems(zipped(source)))
