"""Find a real Blender, not the `bpy` module: for the tests in the background and in a window.

It is the one that GRIDMESH_BLENDER names, else `blender` on the path, if it is 4.5 or later. Where there is none, root on a Debian or
Ubuntu gets one: Debian unstable with its Blender, as a folder of its own in `.venv/debian` (1.3 GB, some minutes,
once), entered by chroot. Nothing of the system is changed. By itself: `python tests/real_blender.py` says what is found.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DEBIAN = ROOT / ".venv" / "debian"
OLDEST = (4, 5)

PACKAGES = [
    *("blender", "ca-certificates"),
    # Blender's own scripts import them; its package only recommends the first and forgets the last.
    *("python3-numpy", "python3-requests", "python3-zstandard", "python3-cattr"),
    # A screen without a screen, and pictures of it.
    *("xvfb", "imagemagick", "libgl1-mesa-dri", "libegl1", "libglx-mesa0"),
]

# Mounts are seen by the command alone, and are gone with it.
_ENTER = """
set -e
root=$1 share=$2
shift 2
mount -t proc proc "$root/proc"
mkdir -p "$root/gridmesh"
mount --bind "$share" "$root/gridmesh"
exec chroot "$root" "$@"
"""


class MissingError(Exception):
    """There is no real Blender here. The message says why."""


class Blender:
    """A Blender that runs, and the folder that it shares with us."""

    def __init__(self, program: str, share: Path, root: Path | None = None) -> None:
        share.mkdir(parents=True, exist_ok=True)
        self.program, self.share, self.root = program, share.resolve(), root
        said = subprocess.run(
            self.command([program, "--version"]), capture_output=True, text=True, check=False
        )
        found = re.search(r"Blender (\d+)\.(\d+)\S*", said.stdout)
        if found is None:
            raise MissingError(f"{program} does not start: {said.stderr.strip() or said.stdout.strip()}")
        self.name = found.group(0)
        if (int(found.group(1)), int(found.group(2))) < OLDEST:
            raise MissingError(f"{program} is {self.name}; 4.5 is the oldest that GridMesh supports")

    def command(self, words: list[str], **environment: str) -> list[str]:
        """Command that runs where this Blender is."""
        settings = [f"{name}={value}" for name, value in environment.items()]
        if self.root is None:
            return ["env", *settings, *words]
        clean = ["PATH=/usr/sbin:/usr/bin:/sbin:/bin", "HOME=/root", "LANG=C.UTF-8", "XDG_RUNTIME_DIR=/tmp"]
        settings = ["LIBGL_ALWAYS_SOFTWARE=1", "GALLIUM_DRIVER=llvmpipe", *settings]
        inside = ["env", "-i", *clean, *settings, *words]
        return ["unshare", "--mount", "sh", "-c", _ENTER, "enter", str(self.root), str(self.share), *inside]

    def path(self, path: Path) -> str:
        """Where this Blender finds a file of the shared folder."""
        if self.root is None:
            return str(path.resolve())
        return str(Path("/gridmesh") / path.resolve().relative_to(self.share))


def find(share: Path) -> Blender:
    """A real Blender that shares the folder; MissingError if there is none and none can be had."""
    if named := os.environ.get("GRIDMESH_BLENDER"):
        return Blender(named, share)
    reason = "there is no 'blender' on the path"
    if program := shutil.which("blender"):
        try:
            return Blender(program, share)
        except MissingError as error:
            reason = str(error)
    try:
        _install_debian()
    except MissingError as error:
        raise MissingError(
            f"{reason}, and {error}; set GRIDMESH_BLENDER to a Blender of 4.5 or later"
        ) from error
    return Blender("blender", share, DEBIAN)


def _install_debian() -> None:
    """Debian unstable with Blender in a folder, unless it is there."""
    done = DEBIAN / "gridmesh-done"
    if done.exists() and done.read_text().split() == PACKAGES:
        return
    if sys.platform != "linux" or os.geteuid() != 0 or shutil.which("apt-get") is None:
        raise MissingError("only root on a Debian or Ubuntu can install one by itself")
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive", "LC_ALL": "C"}
    if shutil.which("debootstrap") is None:
        _run(["apt-get", "update", "--quiet"], environment)
        _run(["apt-get", "install", "--yes", "--no-install-recommends", "debootstrap"], environment)
    if not (DEBIAN / "usr" / "bin" / "apt-get").exists():
        DEBIAN.mkdir(parents=True, exist_ok=True)
        _run(["debootstrap", "--variant=minbase", "--components=main", "sid", str(DEBIAN)], environment)
    # Names and routes as on this system; packages without manuals, that start no services.
    for name in ("resolv.conf", "hosts"):
        shutil.copy(Path("/etc") / name, DEBIAN / "etc" / name)
    asked = subprocess.run(["apt-config", "dump"], capture_output=True, text=True, check=False)
    routes = [
        line for line in asked.stdout.splitlines() if re.match(r"Acquire::.*proxy", line, re.IGNORECASE)
    ]
    settings = ['Acquire::Check-Valid-Until "false";', 'APT::Install-Recommends "false";', *routes]
    (DEBIAN / "etc/apt/apt.conf.d/90gridmesh").write_text("\n".join(settings) + "\n")
    excluded = [f"path-exclude=/usr/share/{name}/*" for name in ("doc", "man", "locale", "info")]
    (DEBIAN / "etc/dpkg/dpkg.cfg.d/90gridmesh").write_text("\n".join(excluded) + "\n")
    policy = DEBIAN / "usr/sbin/policy-rc.d"
    policy.write_text("#!/bin/sh\nexit 101\n")
    policy.chmod(0o755)
    enter = ["unshare", "--mount", "sh", "-c", _ENTER, "enter", str(DEBIAN), str(DEBIAN)]
    _run([*enter, "apt-get", "update", "--quiet"], environment)
    _run([*enter, "apt-get", "install", "--yes", "--quiet", *PACKAGES], environment)
    _run([*enter, "apt-get", "clean"], environment)
    done.write_text("\n".join(PACKAGES) + "\n")


def _run(command: list[str], environment: dict[str, str]) -> None:
    print("+", *[word for word in command if word != _ENTER], flush=True)
    done = subprocess.run(
        command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    )
    if done.returncode:
        raise MissingError(f"'{command[0]}' failed:\n{done.stdout[-2000:]}")


if __name__ == "__main__":
    try:
        blender = find(ROOT / "out" / "tests" / "real")
    except MissingError as error:
        sys.exit(str(error))
    print(f"{blender.name}: {' '.join(blender.command([blender.program]))}")
