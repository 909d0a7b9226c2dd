"""The zip in a real Blender in the background: by its command line, and by the steps of scenario.py.

    python tests/installed/real.py ZIP

Exit code 77 where there is no real Blender: nothing was tested then.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import real_blender

HERE = Path(__file__).resolve().parent
SHARE = HERE.parents[1] / "out" / "tests" / "real"

USE = """
import sys
assert "bl_ext.user_default.gridmesh" in __import__("bpy").context.preferences.addons
assert "gridmesh" not in sys.modules
import bpy
bpy.ops.wm.read_homefile(use_empty=True)
bpy.ops.curve.primitive_bezier_circle_add()
assert bpy.ops.object.gridmesh_from_strokes(triangles=500) == {"FINISHED"}
print("USED", len(bpy.context.object.data.polygons))
"""


def main():
    extension = Path(sys.argv[1]).resolve()
    shutil.rmtree(SHARE, ignore_errors=True)
    try:
        blender = real_blender.find(SHARE)
    except real_blender.MissingError as error:
        print(f"NO REAL BLENDER, so nothing was tested in one: {error}")
        sys.exit(77)
    print(f"{blender.name}: {blender.program} in {blender.root or 'the system'}", flush=True)
    package = SHARE / extension.name
    shutil.copy(extension, package)
    shutil.copy(HERE / "scenario.py", SHARE)
    failed = command_line(blender, package)
    profile = Path(tempfile.mkdtemp(dir=SHARE))
    scenario = ["--python", blender.path(SHARE / "scenario.py"), "--", blender.path(package)]
    done = run(blender, profile, ["--background", "--python-exit-code", "3", *scenario])
    print(done.stdout)
    sys.exit(1 if failed or done.returncode else 0)


def command_line(blender, package):
    """Install, use in a second process, remove, and look that nothing is left; whether it failed."""
    profile = Path(tempfile.mkdtemp(dir=SHARE))
    (SHARE / "use.py").write_text(USE)
    extension = ["--command", "extension"]
    steps = {
        "validate": [*extension, "validate", blender.path(package)],
        "install": [*extension, "install-file", "-r", "user_default", "-e", blender.path(package)],
        "use": ["--background", "--python-exit-code", "3", "--python", blender.path(SHARE / "use.py")],
        "remove": [*extension, "remove", "user_default.gridmesh"],
    }
    failed = 0
    for name, words in steps.items():
        done = run(blender, profile, words)
        good = done.returncode == 0 and (
            name != "use" or re.search(r"^USED \d{3}", done.stdout, re.MULTILINE)
        )
        if name == "remove" and any("gridmesh" in path.name for path in profile.rglob("*")):
            good = False
        failed += not good
        print(
            f"{'PASSED' if good else 'FAILED'}  command line: {name}{'' if good else chr(10) + done.stdout}"
        )
    print(f"command line: {len(steps) - failed} passed, {failed} failed, 0 skipped", flush=True)
    return failed


def run(blender, profile, words):
    command = blender.command([blender.program, *words], BLENDER_USER_RESOURCES=blender.path(profile))
    return subprocess.run(
        command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, timeout=600
    )


main()
