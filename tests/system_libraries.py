"""Make sure that the system libraries are there which the bpy module needs.

A desktop has them all. A bare Debian or Ubuntu lacks some: as root they are installed by apt, otherwise the
command to run is shown. Used by tests/run.py and docs/gallery.py, or by itself: `python tests/system_libraries.py`.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys

# What bpy links against, and the Debian package of each.
NEEDED = {
    "libX11.so.6": "libx11-6",
    "libXrender.so.1": "libxrender1",
    "libXfixes.so.3": "libxfixes3",
    "libXi.so.6": "libxi6",
    "libXxf86vm.so.1": "libxxf86vm1",
    "libxkbcommon.so.0": "libxkbcommon0",
    "libSM.so.6": "libsm6",
    "libICE.so.6": "libice6",
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libgomp.so.1": "libgomp1",
}


def missing() -> list[str]:
    """Packages of the libraries that cannot be loaded; nothing on systems other than Linux."""
    return [package for library, package in NEEDED.items() if not _loads(library)]


def ensure() -> None:
    """Install what is missing, or exit and say how to."""
    if sys.platform != "linux" or not (packages := missing()):
        return
    install = ["apt-get", "install", "--yes", "--no-install-recommends", *packages]
    if shutil.which("apt-get") is None:
        sys.exit(f"Blender needs libraries that this system lacks; on Debian they are: {' '.join(packages)}")
    if os.geteuid() != 0:
        sys.exit(
            f"Blender needs libraries that this system lacks. Please run\n\n    sudo {' '.join(install)}\n"
        )
    print(f"Installing system libraries that Blender needs: {' '.join(packages)}", flush=True)
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    subprocess.run(["apt-get", "update", "--quiet"], check=True, env=environment)
    subprocess.run(install, check=True, env=environment)
    if still := missing():
        sys.exit(f"still missing after the installation: {' '.join(still)}")


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


if __name__ == "__main__":
    ensure()
