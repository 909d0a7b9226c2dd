"""What users see and do, in a real window: run inside Blender by run.py. Each scene checks, and takes pictures."""

import os
import sys
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import cut_scenes
import draw_scenes
import first_scenes
import live_scenes
import mesh_scenes
import part_scenes
import picture_scenes
import random_scenes
import together_scenes
from stage import perform

SCENES = (
    *first_scenes.SCENES,
    *mesh_scenes.SCENES,
    *cut_scenes.SCENES,
    *draw_scenes.SCENES,
    *part_scenes.SCENES,
    *live_scenes.SCENES,
    *picture_scenes.SCENES,
    *together_scenes.SCENES,
)
BY_NAME = random_scenes.SCENES
"""They are played when they are named."""


def finish(results):
    """Say what came of the scenes, and end."""
    passed = failed = skipped = 0
    for name, error in results:
        if error is None:
            passed += 1
            print(f"PASSED  {name}")
        elif isinstance(error, NotImplementedError):
            skipped += 1
            print(f"SKIPPED {name}: {error}")
        else:
            failed += 1
            print(f"FAILED  {name}\n{''.join(traceback.format_exception(error))}")
    print(
        f"Blender {bpy.app.version_string} in a window: {passed} passed, {failed} failed, {skipped} skipped"
    )
    sys.stdout.flush()
    os._exit(1 if failed else 0)


bpy.context.preferences.view.show_splash = False
bpy.context.preferences.view.show_tooltips = False  # they hide what the pictures show
bpy.context.preferences.system.viewport_aa = "FXAA"
wanted = os.environ.get("SCENES", "").split()
known = {scene.__name__: scene for scene in (*SCENES, *BY_NAME)}
if not known.keys() >= set(wanted):
    print(f"unknown: {set(wanted) - known.keys()}; there are {', '.join(known)}")
    os._exit(2)
perform([(name, known[name]) for name in wanted or [scene.__name__ for scene in SCENES]], finish)
