# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: many files, unattended.

    arguments -> jobs (checked as a whole) -> runner (one worker process, restarted when it dies)
    worker -> work -> inputs, api, outputs

Only `outputs`, `worker` and `register` need bpy.
"""

from typing import Any

_commands: list[Any] = []


def register() -> None:
    """Add `blender --command gridmesh`."""
    import bpy

    _commands.append(bpy.utils.register_cli_command("gridmesh", _run))


def unregister() -> None:
    """Undo `register`, also where it was not called."""
    import bpy

    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())


def _run(argv: list[str]) -> int:
    from .arguments import main

    return main(argv)
