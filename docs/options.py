# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "numpy==1.26.4"]
#
# [tool.uv]
# python-downloads = "never"
# ///
"""Write docs/options.md: every option of every operator, as Blender knows it.

uv run docs/options.py
"""

from __future__ import annotations

import os
import sys
import tempfile
from math import degrees
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "options.md"

HEAD = """# Every option

Written by `docs/options.py` from the operators themselves; the same texts are in the tooltips. The panel at the lower left (F9) has them all. Blender remembers what was used last, except where it says *each time*.

![The options of a body](pictures/windows/redo_1_before.png)
"""


def page() -> str:
    """Text of the page; the extension must be registered."""
    import bpy

    from addon import _classes

    parts = [HEAD]
    for cls in _classes():
        # Those that are only called by another have its options.
        if issubclass(cls, bpy.types.Operator) and "INTERNAL" not in getattr(cls, "bl_options", ()):
            group, name = cls.bl_idname.split(".")
            operator = getattr(getattr(bpy.ops, group), name)
            options = [
                o
                for o in operator.get_rna_type().properties
                if o.identifier != "rna_type" and not o.is_hidden
            ]
            parts.append(
                f"## {cls.bl_label}\n\n`bpy.ops.{cls.bl_idname}`: {operator.get_rna_type().description}.\n"
            )
            if options:
                parts.append("| option | in scripts | default | what it does |\n|---|---|---|---|")
                parts[-1] += "".join(f"\n{_row(option)}" for option in options) + "\n"
    return "\n".join(parts)


def _row(option) -> str:
    what = f"{option.description}." + (" *Each time.*" if option.is_skip_save else "")
    for item in getattr(option, "enum_items_static", ()):
        what += f"<br>*{item.name}* (`{item.identifier}`): {item.description}."
    return f"| {option.name} | `{option.identifier}` | {_default(option)} | {what} |"


def _default(option) -> str:
    if option.type == "ENUM":
        if option.is_enum_flag:
            return ", ".join(sorted(option.default_flag)) or "none"
        return next((item.name for item in option.enum_items_static if item.identifier == option.default), "")
    if option.type == "BOOLEAN":
        return "on" if option.default else "off"
    if getattr(option, "is_array", False):
        return ", ".join(f"{value:g}" for value in option.default_array)
    if option.type == "FLOAT" and option.subtype == "ANGLE":
        return f"{degrees(option.default):.4g}°"
    return f"{option.default:.4g}" if option.type == "FLOAT" else f"{option.default}"


def main() -> None:
    """Write the page."""
    os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-blender-")
    sys.path.insert(0, str(ROOT))
    import bpy  # noqa: F401 (before the extension)

    import addon

    addon.register()
    PAGE.write_text(page(), encoding="utf-8")
    print(PAGE)
    addon.unregister()
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5 can crash in its own clean-up


if __name__ == "__main__":
    main()
