# SPDX-License-Identifier: GPL-3.0-or-later
"""The native module `gridmesh`: imported when it is first needed, and only used if it fits this extension.

Blender installs it from the wheel in the extension's zip. What can go wrong there (a zip for another platform, an update
that replaced the files of a module that is loaded, another extension that brought another version) becomes
a message that says what to do. No bpy.
"""

from __future__ import annotations

import importlib
import platform
import sys
import tomllib
from pathlib import Path
from typing import Any

MANIFEST = tomllib.loads((Path(__file__).parent / "blender_manifest.toml").read_text(encoding="utf-8"))

NATIVE_VERSION: str = MANIFEST["version"]
"""Version of the `gridmesh` module that this extension is shipped with; newer patch releases serve too."""

RESTART = "Restart Blender to finish the update"


class NativeError(RuntimeError):
    """The module `gridmesh` cannot be used. The message says why and what to do."""


def native(*needed: str) -> Any:
    """Import the module `gridmesh` and check that it has this extension's version and what is needed of it.

    Raises
    ------
    NativeError
        If it is missing, was built for another platform, is left over from before an update, or has another
        version.
    """
    try:
        module = importlib.import_module("gridmesh")
    except ModuleNotFoundError as error:
        if error.name != "gridmesh":
            raise NativeError(_broken(error)) from error
        raise NativeError(
            f"The native module 'gridmesh' is missing; install the GridMesh zip for {_platform()} "
            "in Preferences > Get Extensions > Install from Disk"
        ) from error
    except Exception as error:  # a damaged file raises anything
        raise NativeError(_broken(error)) from error
    version = getattr(module, "__version__", "of unknown version")
    if not _serves(version):
        raise NativeError(_unfit(version))
    missing = [name for name in needed if not hasattr(module, name)]
    if missing:
        where = getattr(module, "__file__", None) or "an unknown place"
        raise NativeError(
            f"The native module 'gridmesh' ({version}, from {where}) is an unfinished build without "
            f"'{missing[0]}'; install GridMesh {NATIVE_VERSION} again and restart Blender"
        )
    return module


def _broken(error: BaseException) -> str:
    """Say what to do about a module that is there and does not load."""
    installed = _installed()
    if "gridmesh._native" in sys.modules or (installed is not None and not _serves(installed)):
        return f"{RESTART}: files of two versions of the native module 'gridmesh' are mixed ({error})"
    return (
        f"The native module 'gridmesh' could not be loaded ({error}); this is {_platform()} with Python "
        f"{platform.python_version()}: install the GridMesh zip for it again, and restart Blender"
    )


def _unfit(version: str) -> str:
    """Say what to do about a module of a version that does not serve."""
    installed = _installed()
    if installed is not None and installed != version and _serves(installed):
        return (
            f"{RESTART}: version {version} of the native module 'gridmesh' is still loaded, "
            f"this extension needs {NATIVE_VERSION}"
        )
    known = f"The native module 'gridmesh' is {version}, this extension needs {NATIVE_VERSION}"
    if (_numbers(version) or ()) > (_numbers(NATIVE_VERSION) or ()):
        return f"{known}; another extension has brought a newer one: update GridMesh, then restart Blender"
    return f"{known}; install GridMesh {NATIVE_VERSION} again, then restart Blender"


def _installed() -> str | None:
    """Version of the module in the files, which after an update is not the one that is loaded."""
    # Slow to import, and needed only to explain what is wrong.
    from importlib import metadata

    importlib.invalidate_caches()
    try:
        return metadata.version("gridmesh")
    except metadata.PackageNotFoundError:
        return None


def _platform() -> str:
    """Name of this platform as the extension's zips have it."""
    system = {"darwin": "macos", "win32": "windows"}.get(sys.platform, sys.platform)
    machine = platform.machine().lower()
    machine = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64"}.get(machine, machine)
    return f"{system}-{machine}"


def _serves(version: str) -> bool:
    """Whether a module of this version has the functions used here: same minor release, not older."""
    found, needed = _numbers(version), _numbers(NATIVE_VERSION)
    return found is not None and needed is not None and found[:2] == needed[:2] and found >= needed


def _numbers(version: str) -> tuple[int, ...] | None:
    try:
        return tuple(int(part) for part in version.split(".")[:3])
    except ValueError:
        return None
