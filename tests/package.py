# /// script
# requires-python = ">=3.11"
# dependencies = []
#
# [tool.uv]
# python-downloads = "never"
# ///
"""Build the wheel and the extension's zip, and check both.

    uv run tests/package.py                          # this platform: wheel and zip, in dist/
    uv run tests/package.py --wheel-only             # the wheel alone
    uv run tests/package.py --wheels DIR             # zips of wheels that are there, one for each platform

The zip is built and validated by Blender's own builder, out of the pinned `bpy` wheel unless `--builder` names another
(a `blender_ext.py`, or a Blender). What the validator does not look at is checked here.
"""

from __future__ import annotations

import argparse
import ast
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ADDON = ROOT / "addon"
UV = os.environ.get("UV") or shutil.which("uv")

GLIBC = (2, 28)
"""Blender's own binaries need as much."""

PLATFORMS = {
    r"manylinux_2_28_x86_64": "linux-x64",
    r"win_amd64": "windows-x64",
    r"win_arm64": "windows-arm64",
    r"macosx_\d+_\d+_x86_64": "macos-x64",
    r"macosx_\d+_\d+_arm64": "macos-arm64",
}
"""Platform tag of a wheel, and Blender's name of the platform."""

PERMISSIONS = {"files", "network", "clipboard", "camera", "microphone"}

# Those that Blender's platform knows for add-ons.
TAGS = {
    *("3D View", "Add Curve", "Add Mesh", "Animation", "Bake", "Camera", "Compositing", "Development"),
    *("Game Engine", "Geometry Nodes", "Grease Pencil", "Import-Export", "Lighting", "Material", "Mesh"),
    *("Modeling", "Node", "Object", "Paint", "Physics", "Pipeline", "Render", "Rigging", "Scene", "Sculpt"),
    *("Sequencer", "System", "Text Editor", "Tracking", "User Interface", "UV"),
}

LARGEST = 100 * 2**20
"""Bytes; Blender's platform takes about twice as much."""


class PackageError(Exception):
    """What was built must not be shipped. The message lists why."""


def main() -> None:
    """Build, check, and say what was made."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wheels", type=Path, metavar="DIR", help="bundle these instead of building one")
    parser.add_argument("--wheel-only", action="store_true", help="build the wheel and no zip")
    parser.add_argument("--builder", metavar="PATH", help="blender_ext.py or a Blender; fetched if not given")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder for what is built")
    arguments = parser.parse_args()
    if UV is None:
        sys.exit("uv is missing; install it with: python3 -m pip install uv")
    try:
        wheels = sorted(arguments.wheels.glob("*.whl")) if arguments.wheels else [build_wheel(arguments.out)]
        if not wheels:
            raise PackageError(f"there are no wheels in {arguments.wheels}")
        if arguments.wheel_only:
            print(wheels[0])
            return
        for package in build_zips(wheels, arguments.out, builder(arguments.builder)):
            print(f"{package}  {package.stat().st_size / 2**20:.1f} MiB")
    except (PackageError, subprocess.CalledProcessError) as error:
        sys.exit(f"{error}\n{getattr(error, 'output', '') or ''}")


def build_wheel(out: Path) -> Path:
    """Build the wheel of this platform: one for every Python from 3.11 on. It is checked."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    tools = [word for tool in project["dependency-groups"]["package"] for word in ("--with", tool)]
    options = ["--release", "--locked", "--out", str(out)]
    if sys.platform == "linux":
        # zig links against an old glibc, whatever this system has.
        options += ["--zig", "--compatibility", "manylinux_2_28"]
    with tempfile.TemporaryDirectory() as folder:
        options[options.index("--out") + 1] = folder
        run([UV, "run", "--no-project", "--python", sys.executable, *tools, "maturin", "build", *options])
        built = list(Path(folder).glob("*.whl"))
        if len(built) != 1:
            raise PackageError(f"one wheel was expected, found {[path.name for path in built]}")
        if problems := wheel_problems(built[0]):
            raise PackageError("\n".join(problems))
        out.mkdir(parents=True, exist_ok=True)
        return Path(shutil.copy(built[0], out))


def build_zips(wheels: list[Path], out: Path, build: list[str]) -> list[Path]:
    """Build a zip for the platform of each wheel with Blender's builder, and check everything."""
    if problems := [problem for wheel in wheels for problem in wheel_problems(wheel)]:
        raise PackageError("\n".join(problems))
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "gridmesh"
        shutil.copytree(ADDON, source, ignore=shutil.ignore_patterns("__pycache__", "*.pyc", ".*"))
        shutil.copy(ROOT / "LICENSE-GPL", source / "LICENSE")
        (source / "wheels").mkdir()
        for wheel in wheels:
            shutil.copy(wheel, source / "wheels")
        _list_wheels(source / "blender_manifest.toml", wheels)
        manifest = tomllib.loads((source / "blender_manifest.toml").read_text(encoding="utf-8"))
        if problems := manifest_problems(manifest, source):
            raise PackageError("\n".join(problems))
        built = Path(folder) / "built"
        built.mkdir()
        run([*build, "validate", *_tags(build), str(source)])
        where = ["--source-dir", str(source), "--output-dir", str(built)]
        run([*build, "build", *_tags(build), *where, "--split-platforms"])
        packages = sorted(built.glob("*.zip"))
        if len(packages) != len(wheels):
            raise PackageError(f"{len(wheels)} zips were expected, found {[path.name for path in packages]}")
        for package in packages:
            run([*build, "validate", str(package)])
            if problems := zip_problems(package):
                raise PackageError("\n".join(problems))
        return [Path(shutil.copy(package, out)) for package in packages]


def builder(given: str | None = None, python: str = "3.11") -> list[str]:
    """Command of Blender's builder: the one given, or that of the pinned `bpy` wheel, with its list of tags."""
    if given is not None and not given.endswith(".py"):
        return [given, "--command", "extension"]
    if given is None:
        project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
        pinned = next(p for p in project["dependency-groups"]["blender45"] if str(p).startswith("bpy=="))
        where = (
            "import importlib.util, pathlib\n"
            "(folder,) = importlib.util.find_spec('bpy').submodule_search_locations\n"
            "print(*pathlib.Path(folder).glob('*/scripts/addons_core/bl_pkg/cli/blender_ext.py'))"
        )
        fetch = [UV, "run", "--no-project", "--quiet", "--python", python, "--with", pinned]
        given = run([*fetch, "python", "-c", where]).strip()
    return [sys.executable, given]


def _tags(build: list[str]) -> list[str]:
    """Option that makes the builder check the tags; a whole Blender does so by itself."""
    if not build[-1].endswith(".py"):
        return []
    scripts = Path(build[-1]).parents[3]
    return ["--valid-tags", str(scripts / "modules" / "_bpy_internal" / "extensions" / "tags.py")]


def run(command: list[str]) -> str:
    """Run a command; its output. One that fails raises with it."""
    print("+", *command, flush=True)
    done = subprocess.run(
        command, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    )
    if done.returncode:
        raise subprocess.CalledProcessError(done.returncode, command, done.stdout)
    return done.stdout


# --------------------------------------------------------------------------------------------------- checks


def wheel_problems(wheel: Path) -> list[str]:
    """What is wrong with a wheel: its tags must be true and its version that of the extension."""
    match = re.fullmatch(r"gridmesh-([\d.]+)-cp311-abi3-(.+)\.whl", wheel.name)
    if match is None:
        return [f"{wheel.name}: not an abi3 wheel of gridmesh for Python 3.11 and later"]
    version, tag = match.groups()
    problems = []
    if version != addon_version():
        problems.append(f"{wheel.name}: the extension is {addon_version()}")
    if _platform(tag) is None:
        problems.append(f"{wheel.name}: no platform of Blender has the tag {tag}")
    with zipfile.ZipFile(wheel) as archive:
        native = [name for name in archive.namelist() if re.search(r"\.(so|pyd|dylib)$", name)]
        others = {name.split("/")[0] for name in archive.namelist()} - {
            "gridmesh",
            f"gridmesh-{version}.dist-info",
        }
        if len(native) != 1 or Path(native[0]).name not in {"_native.abi3.so", "_native.pyd"}:
            problems.append(f"{wheel.name}: one abi3 module was expected, found {native}")
        elif tag.startswith("manylinux") and (needed := glibc_needed(archive.read(native[0]))) > GLIBC:
            problems.append(f"{wheel.name}: needs glibc {'.'.join(map(str, needed))}, more than its tag says")
        if others:
            problems.append(f"{wheel.name}: installs more than gridmesh: {sorted(others)}")
    return problems


def glibc_needed(library: bytes) -> tuple[int, ...]:
    """Newest version of glibc among the symbol versions that a library names."""
    named = re.findall(rb"GLIBC_(\d+(?:\.\d+)+)\0", library)
    return max((tuple(int(part) for part in name.split(b".")) for name in named), default=(0,))


def manifest_problems(manifest: dict, folder: Path) -> list[str]:
    """What Blender's validator lets pass and its platform does not."""
    problems = []
    if "blender" in manifest["name"].lower():
        problems.append("the name must not contain 'Blender'")
    if len(manifest["tagline"]) > 64 or not re.search(r"[\w)\]}]$", manifest["tagline"]):
        problems.append("the tagline has at most 64 characters and no punctuation at its end")
    problems += [f"unknown tag: {tag}" for tag in manifest.get("tags", []) if tag not in TAGS]
    known = set(PLATFORMS.values())
    problems += [f"unknown platform: {name}" for name in manifest.get("platforms", []) if name not in known]
    for name, reason in manifest.get("permissions", {}).items():
        if name not in PERMISSIONS:
            problems.append(f"unknown permission: {name}")
        if len(reason) > 64 or not re.search(r"[\w)\]}]$", reason):
            problems.append(f"reason of {name}: at most 64 characters and no punctuation at its end")
    if "network" in manifest.get("permissions", {}):
        problems.append("the extension uses no network")
    if manifest["license"] != ["SPDX:GPL-3.0-or-later"]:
        problems.append("add-ons are under GPL-3.0-or-later")
    if "blender_version_max" in manifest:
        problems.append("no later Blender is shut out")
    if not all(re.fullmatch(r"\d{4}(-\d{4})? .+", line) for line in manifest["copyright"]):
        problems.append("a line of copyright is 'YEAR NAME' or 'YEAR-YEAR NAME'")
    if not manifest["maintainer"].strip():
        problems.append("the maintainer is missing")
    covered = set()
    for wheel in manifest.get("wheels", []):
        if not (folder / wheel).is_file():
            problems.append(f"{wheel} is listed but not there")
        covered.add(_platform(Path(wheel).stem.split("-")[-1]))
    if (listed := set(manifest.get("platforms", []))) != covered:
        problems.append(f"platforms are {sorted(listed)}, wheels are for {sorted(map(str, covered))}")
    return problems


def zip_problems(package: Path) -> list[str]:
    """What must not be in a zip, or must and is not."""
    problems = []
    with zipfile.ZipFile(package) as archive:
        names = archive.namelist()
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
        platforms = manifest["platforms"]
        if generated := manifest.get("build", {}).get("generated"):
            platforms, manifest["wheels"] = generated["platforms"], generated["wheels"]
        wheels = [name for name in names if name.endswith(".whl")]
        if [f"./{name}" for name in wheels] != manifest["wheels"]:
            problems.append(f"lists {manifest['wheels']}, has {wheels}")
        if len(platforms) != 1 or len(wheels) != 1:
            problems.append(f"is for {platforms} and has {wheels}; one of each was expected")
        for name in names:
            path = Path(name)
            if any(part.startswith(".") or part == "__pycache__" for part in path.parts):
                problems.append(f"has {name}, which nobody needs")
            elif path.suffix in {".so", ".pyd", ".dll", ".dylib", ".pyc", ".zip"}:
                problems.append(f"has {name}; native code comes in wheels, and nothing is compiled")
            elif path.suffix == ".py":
                problems += _source_problems(name, archive.read(name).decode())
        if "LICENSE" not in names:
            problems.append("has no licence")
    if package.stat().st_size > LARGEST:
        problems.append(f"is larger than {LARGEST >> 20} MiB")
    return [f"{package.name} {problem}" for problem in problems]


def _source_problems(name: str, source: str) -> list[str]:
    """Imports and calls that Blender's platform forbids; the oldest supported Python must read the file."""
    try:
        tree = ast.parse(source, name, feature_version=(3, 11))
    except SyntaxError as error:
        return [f"has {name}, which Python 3.11 does not read: {error}"]
    banned = {"pip", "ensurepip", "socket", "urllib", "http", "requests", "ftplib", "bl_ext"}
    problems = []
    for node in ast.walk(tree):
        imported = []
        if isinstance(node, ast.Import):
            imported = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            imported = [node.module or ""]
        elif isinstance(node, ast.Attribute) and ast.unparse(node) == "sys.path":
            problems.append(f"has {name}, which touches sys.path in line {node.lineno}")
        problems += [f"has {name}, which imports {one}" for one in imported if one.split(".")[0] in banned]
    return problems


def addon_version() -> str:
    """Version of the extension."""
    manifest = tomllib.loads((ADDON / "blender_manifest.toml").read_text(encoding="utf-8"))
    return manifest["version"]


def _platform(tag: str) -> str | None:
    """Blender's name of the platform of a wheel's tag."""
    return next((name for pattern, name in PLATFORMS.items() if re.fullmatch(pattern, tag)), None)


def _list_wheels(manifest: Path, wheels: list[Path]) -> None:
    """Write into a manifest which wheels the zip has, and for which platforms they are."""
    platforms = [_platform(wheel.stem.split("-")[-1]) for wheel in wheels]
    lines = [f"platforms = {_toml(platforms)}", f"wheels = {_toml([f'./wheels/{w.name}' for w in wheels])}"]
    text = manifest.read_text(encoding="utf-8")
    first_table = re.search(r"^\[", text, re.MULTILINE)
    at = first_table.start() if first_table else len(text)
    manifest.write_text(text[:at] + "\n".join(lines) + "\n\n" + text[at:], encoding="utf-8")


def _toml(strings: list[str]) -> str:
    return "[" + ", ".join(f'"{string}"' for string in strings) + "]"


if __name__ == "__main__":
    main()
