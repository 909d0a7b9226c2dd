# /// script
# requires-python = ">=3.11"
# dependencies = []
#
# [tool.uv]
# python-downloads = "never"
# ///
"""Run every test: Rust, the Python module, and the extension in four versions of Blender.

    uv run tests/run.py [PART ...]

Parts (all but `window` without a name): fmt clippy doc cargo ruff core core313 blender45 blender52 blender50 zip installed45 installed52
installed50 real window. The module is built once, as the wheel that is shipped; every Python environment lives in `.venv/` and is
made when it is missing. Two parts run at a time where there are two processors; each line of output begins with the name of its
part. `zip` builds the extension; the parts after it install that zip, in the `bpy` modules and in a
real Blender, in the background and in a window. Blender 5.2 needs Python 3.13, and a real Blender has to be found
(see real_blender.py): what cannot be tested counts as skipped, never as passed.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import package
import system_libraries

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "out" / "tests"
UV = os.environ.get("UV") or shutil.which("uv")

# Part: Python version, dependency group of pyproject.toml, arguments of pytest.
PYTHON_PARTS = {
    "core": ("3.11", "core", ["tests/core"]),
    "blender45": ("3.11", "blender45", ["tests/blender"]),
    "core313": ("3.13", "blender52", ["tests/core", "-m", "not native"]),
    "blender52": ("3.13", "blender52", ["tests/blender", "-m", "not process"]),
    "blender50": ("3.11", "blender50", ["tests/blender", "-m", "smoke"]),
}
# Part: Python version, dependency group. Each in an environment that has never seen the module.
INSTALLED_PARTS = {
    "installed45": ("3.11", "blender45"),
    "installed52": ("3.13", "blender52"),
    "installed50": ("3.11", "blender50"),
}
REAL_PARTS = {
    "real": ["tests/installed/real.py"],
    "window": ["tests/window/run.py"],
}
AT_ONCE = 2
"""So many parts run side by side."""
SLOWEST_FIRST = (
    "ruff",
    "blender52",
    "blender45",
    "core",
    "core313",
    *INSTALLED_PARTS,
    "blender50",
    *REAL_PARTS,
)
"""The order in which parts in Python begin, so that none is left alone at the end for long."""
BY_NAME = {"window"}
"""Run only when they are named: simulated events need a machine that answers in time."""
SKIPPED = 77
"""Exit code of a script that could not test anything."""
# In order: those of one profile compile its dependencies one after the other, beside the wheel, whose profile is another.
# Two that share a folder of a profile would wait for each other.
RUST_PARTS = {
    "fmt": ["cargo", "fmt", "--all", "--check"],
    "clippy": [
        "cargo",
        "clippy",
        "--profile",
        "checked",
        "--locked",
        "--workspace",
        "--all-targets",
        "--",
        "-D",
        "warnings",
    ],
    "doc": ["cargo", "doc", "--profile", "checked", "--locked", "--no-deps"],
    "cargo": ["cargo", "test", "--profile", "checked", "--locked", "--features", "svg"],
}
RUFF = ["addon", "docs", "tests", "rust/gridmesh-python"]


@dataclass
class Result:
    """What came of one part."""

    part: str
    status: str = "passed"
    seconds: float = 0.0
    counts: dict[str, int] = field(default_factory=dict)
    note: str = ""
    code: int = 0


def main() -> int:
    """Run the parts that are asked for; 0 if nothing failed."""
    parts = [*RUST_PARTS, "ruff", *PYTHON_PARTS, "zip", *INSTALLED_PARTS, *REAL_PARTS]
    wanted = sys.argv[1:] or [part for part in parts if part not in BY_NAME]
    if unknown := sorted(set(wanted) - set(parts)):
        sys.exit(f"unknown: {', '.join(unknown)}; allowed: {', '.join(parts)}")
    if UV is None:
        sys.exit("uv is missing; install it with: python3 -m pip install uv")
    os.chdir(ROOT)
    OUT.mkdir(parents=True, exist_ok=True)
    if any(part.startswith(("blender", "installed")) for part in wanted):
        system_libraries.ensure()
    pythons = {version: find_python(version) for version in ("3.11", "3.13")}
    groups = {PYTHON_PARTS[p][1]: PYTHON_PARTS[p][:2] for p in wanted if p in PYTHON_PARTS}
    groups |= {p: INSTALLED_PARTS[p] for p in wanted if p in INSTALLED_PARTS}
    if "ruff" in wanted:
        groups.setdefault("core", ("3.11", "core"))
    # Downloads take their time: they go on while cargo compiles.
    environments = {
        name: Environment(name, group, pythons[version])
        for name, (version, group) in groups.items()
        if pythons[version]
    }
    return report(run_all(wanted, environments))


def run_all(wanted: list[str], environments: dict[str, Environment]) -> list[Result]:
    """Run the parts, those that need nothing built first; their results and those of what was built."""
    if {"fmt", "clippy"} & set(wanted) and shutil.which("rustup"):
        # A minimal toolchain has neither.
        subprocess.run(["rustup", "component", "add", "rustfmt", "clippy"], check=False, capture_output=True)
    needing_zip = {"zip", *INSTALLED_PARTS, *REAL_PARTS} & set(wanted)
    jobs: list[Future[Result]] = []
    # A part waits only for what was begun before it, so that it always comes.
    with ThreadPoolExecutor(max_workers=min(AT_ONCE, os.cpu_count() or 1)) as pool:
        wheel = extension = None
        if PYTHON_PARTS.keys() & set(wanted) or needing_zip:
            wheel = Built("wheel", lambda: package.build_wheel(emptied("wheel")))
            jobs.append(pool.submit(wheel.make))
        jobs += [pool.submit(run_rust, part) for part in RUST_PARTS if part in wanted]
        if needing_zip:
            extension = Built("zip", lambda: build_zip(wheel.wait()))
            jobs.append(pool.submit(extension.make))
        for part in (part for part in SLOWEST_FIRST if part in wanted):
            if part == "ruff":
                jobs.append(pool.submit(run_ruff, environments.get("core")))
            elif part in PYTHON_PARTS:
                jobs.append(pool.submit(run_pytest, part, environments, wheel))
            elif part in INSTALLED_PARTS:
                jobs.append(pool.submit(run_installed, part, environments, extension))
            elif part in REAL_PARTS:
                jobs.append(pool.submit(run_real, part, extension))
    return [job.result() for job in jobs]


# -------------------------------------------------------------------------------------------------- parts


def run_rust(part: str) -> Result:
    """One cargo command."""
    environment = {**os.environ, "RUSTDOCFLAGS": "-D warnings"} if part == "doc" else None
    result, output = run(part, RUST_PARTS[part], environment)
    for passed, failed, ignored in re.findall(r"(\d+) passed; (\d+) failed; (\d+) ignored", output):
        count(result, passed=int(passed), failed=int(failed), skipped=int(ignored))
    return result


def run_ruff(environment: Environment | None) -> Result:
    """Lint and format of all Python files."""
    if environment is None or (note := environment.wait()):
        return Result("ruff", "failed", note=note if environment else "Python 3.11 is missing")
    ruff = environment.script("ruff")
    result, _ = run("ruff", [ruff, "check", *RUFF])
    other, _ = run("ruff", [ruff, "format", "--check", *RUFF])
    result.seconds += other.seconds
    if other.status == "failed":
        result.status = "failed"
    return result


def run_pytest(part: str, environments: dict[str, Environment], wheel: Built) -> Result:
    """pytest in the environment of a part."""
    version, group, arguments = PYTHON_PARTS[part]
    if group not in environments:
        missing = f"PYTHON {version} IS MISSING, so {part} was not tested"
        return Result(part, "skipped" if version == "3.13" else "failed", note=missing)
    if (path := wheel.wait()) is None:
        return Result(part, "failed", note="the wheel was not built")
    environment = environments[group]
    if note := environment.wait() or environment.install(path):
        return Result(part, "failed", note=note)
    record = OUT / f"{part}.xml"
    record.unlink(missing_ok=True)
    command = [environment.script("python"), "-m", "pytest", "-q", f"--junitxml={record}", *arguments]
    result, _ = run(part, command, compiling_once())
    if not record.exists():
        result.status, result.note = "failed", "pytest left no record; it crashed or was killed"
        return result
    for suite in ElementTree.parse(record).getroot().iter("testsuite"):
        bad = int(suite.get("failures", 0)) + int(suite.get("errors", 0))
        skipped = int(suite.get("skipped", 0))
        count(result, passed=int(suite.get("tests", 0)) - bad - skipped, failed=bad, skipped=skipped)
    if result.counts["failed"] or not result.counts["passed"]:
        result.status = "failed"
    return result


def compiling_once() -> dict[str, str]:
    """Environment variables with which Python keeps what it compiles, outside the source tree.

    Tests of the command line start Blender again and again, and two thirds of a start can be Python's compiler.
    """
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"PYTHONPYCACHEPREFIX": str(OUT / "bytecode")}


class Built:
    """Something that is built once, and that other parts wait for."""

    def __init__(self, part: str, build: Callable[[], Path]) -> None:
        self.part, self.build = part, build
        self.path: Path | None = None
        self.ended = threading.Event()

    def make(self) -> Result:
        """Build it, or say why not."""
        say(self.part, "building")
        started = time.monotonic()
        try:
            self.path = self.build()
        except (package.PackageError, subprocess.CalledProcessError) as error:
            note = f"{error}\n{getattr(error, 'output', None) or ''}"
            return Result(self.part, "failed", time.monotonic() - started, note=note)
        finally:
            self.ended.set()
        return Result(self.part, "passed", time.monotonic() - started)

    def wait(self) -> Path | None:
        """Where it is, once it is built; None if it could not be."""
        self.ended.wait()
        return self.path


def build_zip(wheel: Path | None) -> Path:
    """The extension's zip, built and validated by Blender's builder."""
    if wheel is None:
        raise package.PackageError("the wheel was not built")
    return package.build_zips([wheel], emptied("zip"), package.builder())[0]


def emptied(name: str) -> Path:
    """A folder for what is built, with nothing of before in it."""
    shutil.rmtree(OUT / name, ignore_errors=True)
    return OUT / name


def run_installed(part: str, environments: dict[str, Environment], extension: Built) -> Result:
    """The zip in a `bpy` module."""
    if part not in environments:
        version = INSTALLED_PARTS[part][0]
        missing = f"PYTHON {version} IS MISSING, so {part} was not tested"
        return Result(part, "skipped" if version == "3.13" else "failed", note=missing)
    if (path := extension.wait()) is None:
        return Result(part, "failed", note="the zip was not built")
    environment = environments[part]
    if note := environment.wait():
        return Result(part, "failed", note=note)
    command = [environment.script("python"), "tests/installed/scenario.py", str(path)]
    return count_steps(*run(part, command))


def run_real(part: str, extension: Built) -> Result:
    """The zip in a real Blender."""
    if (path := extension.wait()) is None:
        return Result(part, "failed", note="the zip was not built")
    command = [sys.executable, *REAL_PARTS[part], str(path)]
    result, output = run(part, command)
    if result.code == SKIPPED:
        result.status, result.note = "skipped", output
        return result
    return count_steps(result, output)


def count_steps(result: Result, output: str) -> Result:
    """Add the counts that a scenario prints as its last line."""
    counts = re.findall(r": (\d+) passed, (\d+) failed, (\d+) skipped$", output, re.MULTILINE)
    for passed, failed, skipped in counts:
        count(result, passed=int(passed), failed=int(failed), skipped=int(skipped))
    if not result.counts.get("passed"):
        result.status, result.note = "failed", "no step passed; Blender crashed or was killed"
    return result


# ------------------------------------------------------------------------------------------- environments


class Environment:
    """A virtual environment with one dependency group, installed in the background."""

    def __init__(self, name: str, group: str, python: str) -> None:
        self.path = ROOT / ".venv" / name
        self.log = OUT / f"{name}.log"
        self.lock = threading.Lock()
        self.installed: str | None = None
        create = '"$0" venv --quiet --allow-existing --python "$1" "$2"'
        command = f'{create} && "$0" pip install --quiet --python "$2" --group "$3"'
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                ["sh", "-c", command, UV, python, self.path, group], stdout=log, stderr=subprocess.STDOUT
            )

    def script(self, name: str) -> str:
        """Path of a program of the environment."""
        return str(self.path / "bin" / name)

    def wait(self) -> str:
        """Wait for the installation; what went wrong, or nothing."""
        return f"installation failed:\n{self.log.read_text()}" if self.process.wait() else ""

    def install(self, wheel: Path) -> str:
        """Put the wheel in, once; what went wrong, or nothing."""
        command = [
            UV,
            "pip",
            "install",
            "--quiet",
            "--no-deps",
            "--reinstall",
            "--python",
            str(self.path),
            str(wheel),
        ]
        with self.lock:
            if self.installed is None:
                result = subprocess.run(command, capture_output=True, text=True, check=False)
                self.installed = result.stderr if result.returncode else ""
            return self.installed


def find_python(version: str) -> str | None:
    """An interpreter of this version that runs, on the path or from pyenv; nothing is downloaded."""
    found = [sys.executable]
    query = subprocess.run(
        [UV, "python", "find", "--no-python-downloads", "--no-project", "--system", version],
        capture_output=True,
        text=True,
        check=False,
    )
    found.append(query.stdout.strip())
    if pyenv := shutil.which("pyenv"):
        # Its shims refuse to run a version that is installed but not chosen.
        listed = subprocess.run([pyenv, "versions", "--bare"], capture_output=True, text=True, check=False)
        for name in listed.stdout.split():
            if name.startswith(f"{version}."):
                prefix = subprocess.run([pyenv, "prefix", name], capture_output=True, text=True, check=False)
                found.append(f"{prefix.stdout.strip()}/bin/python")
    return next((python for python in found if python and runs(python, version)), None)


def runs(python: str, version: str) -> bool:
    """Whether the interpreter starts and has this version."""
    tell = "import sys; print('%d.%d' % sys.version_info[:2])"
    try:
        told = subprocess.run([python, "-c", tell], capture_output=True, text=True, check=False, timeout=60)
    except OSError:
        return False
    return told.stdout.strip() == version


# ------------------------------------------------------------------------------------------ running, report


def run(part: str, command: list[str], environment: dict[str, str] | None = None) -> tuple[Result, str]:
    """Run a command, showing its output; the result and the output."""
    say(part, " ".join(str(word) for word in command))
    started = time.monotonic()
    lines = []
    with subprocess.Popen(
        command,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    ) as process:
        for line in process.stdout:
            lines.append(line)
            say(part, line.rstrip("\n"))
    status = "failed" if process.returncode else "passed"
    seconds = time.monotonic() - started
    return Result(part, status, seconds, code=process.returncode), "".join(lines)


def say(part: str, line: str) -> None:
    """Print a line of a part."""
    print(f"{part:<11} | {line}", flush=True)


def count(result: Result, **counts: int) -> None:
    """Add to the counts of a result."""
    for key, number in counts.items():
        result.counts[key] = result.counts.get(key, 0) + number


def report(results: list[Result]) -> int:
    """Print the summary; the exit code."""
    print(f"\n{'=' * 78}")
    for result in results:
        counts = ", ".join(f"{number} {key}" for key, number in result.counts.items() if number)
        print(f"{result.part:<12} {result.status.upper():<8} {result.seconds:7.1f} s   {counts}")
        if result.note:
            print(f"             {result.note.strip()}")
    failed = [result for result in results if result.status == "failed"]
    skipped = [result for result in results if result.status == "skipped"]
    tests = {key: sum(r.counts.get(key, 0) for r in results) for key in ("passed", "failed", "skipped")}
    print("=" * 78)
    print(
        f"parts: {len(results) - len(failed) - len(skipped)} passed, {len(failed)} failed, {len(skipped)} skipped"
    )
    print(f"tests: {tests['passed']} passed, {tests['failed']} failed, {tests['skipped']} skipped")
    if skipped:
        print(f"NOT TESTED HERE: {', '.join(result.part for result in skipped)}")
    print("FAILED" if failed else "ALL THAT RAN PASSED" if skipped else "ALL PASSED")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
