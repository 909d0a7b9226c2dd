# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: many files, unattended.

    arguments -> jobs (from a file, or `listing`; by the table in `params`), places -> runner -> report
    runner -> process (the worker, watched by `limits`, restarted when it dies)
    worker -> files (what is read) -> loading, inputs, sound -> making (what the operators are made of) -> outputs (drafts, whole), pictures

Only `loading`, `making`, `outputs`, `pictures`, `worker` and `register` need bpy: a run is watched by a process that no file can crash,
for it opens none but the jobs and the report.
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
