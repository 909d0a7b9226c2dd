# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets that come with the extension: files as Blender itself writes them, below `presets/operator`.

Blender offers them in the redo panel, beside those that users save; the sidebar has a menu of them.
"""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path
from typing import Any

import bpy

HOME = Path(__file__).parent.parent
FOLDER = HOME / "presets" / "operator"


def register() -> None:
    """Let Blender look for presets here."""
    bpy.utils.register_preset_path(str(HOME))


def unregister() -> None:
    """Undo `register`, also where it was not called."""
    if str(HOME) in bpy.utils._preset_path_registry:
        bpy.utils.unregister_preset_path(str(HOME))


@cache
def shipped(idname: str) -> dict[str, dict[str, Any]]:
    """Label and properties of each preset of an operator, in alphabetical order."""
    files = sorted((FOLDER / idname).glob("*.py"))
    return {bpy.path.display_name(file.stem, has_ext=False): _properties(file) for file in files}


def _properties(file: Path) -> dict[str, Any]:
    """Values that a preset gives to the operator `op`; it has nothing else in it."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    lines = (line for line in tree.body if isinstance(line, ast.Assign))
    return {
        target.attr: ast.literal_eval(line.value)
        for line in lines
        for target in line.targets
        if isinstance(target, ast.Attribute)
    }
