"""The zip in a real Blender in the background: by its command line, and by the steps of scenario.py.

    python tests/installed/real.py ZIP

Exit code 77 where there is no real Blender: nothing was tested then.
"""

import json
import re
import shutil
import signal
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


CODES = {"batch": 1, "resume": 1, "wrong": 2}
"""Exit codes that are not 0."""
SAYS = {
    "use": r"^USED \d{3}",
    "help": r"strokes[\s\S]*fill[\s\S]*cut[\s\S]*batch",
    "batch": "3 done, 1 failed, 0 skipped",
    "resume": "0 done, 1 failed, 3 skipped",
    "wrong": "none.jsonl",
}

BALL = """
import bpy
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16)
bpy.ops.wm.obj_export(filepath=__import__("sys").argv[-1], forward_axis="Y", up_axis="Z")
"""

ACROSS = [[-2, 0.1], [2, 0.2]]
BATCH = [
    {"id": "drawn", "op": "strokes", "in": "ring.svg", "params": {"triangles": 300}, "out": "out/ring.blend"},
    {
        "id": "cut",
        "op": "cut",
        "in": "ball.obj",
        "params": {"stroke": ACROSS, "keep": "left", "cap": False},
        "out": "out/half.glb",
    },
    {"id": "damaged", "op": "fill", "in": "damaged.blend", "out": "out/damaged.ply"},
    {"id": "filled", "op": "fill", "in": "out/half.glb", "params": {"max_edges": 0}, "out": "out/whole.ply"},
]
RING = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 H90 V90 H0 z M30 30 V60 H60 V30 z"/></svg>'


def write_jobs():
    """Write a file of jobs and what they read; all but one can be done."""
    folder = SHARE / "farm"
    folder.mkdir()
    (folder / "ring.svg").write_text(RING)
    (folder / "damaged.blend").write_bytes(b"BLENDER-v405 and then nothing")
    (folder / "ball.py").write_text(BALL)
    (folder / "jobs.jsonl").write_text("".join(json.dumps(job) + "\n" for job in BATCH))
    return folder


def said_by_batch(folder):
    """What the report says is not as it should be; nothing if all is well."""
    lines = (folder / "jobs.report.jsonl").read_text().splitlines()
    found = {result["id"]: result for result in map(json.loads, lines)}
    wrong = [] if set(found) == {job["id"] for job in BATCH} else ["items are missing"]
    for name, result in found.items():
        good = result["status"] == "error" if name == "damaged" else result.get("digest")
        wrong += [] if good else [f"{name}: {result}"]
    if found.get("filled", {}).get("holes") != 1:
        wrong.append("the cut left no hole to fill")
    return wrong


def command_line(blender, package):
    """Install, use in a second process, remove, and look that nothing is left; whether it failed."""
    profile = Path(tempfile.mkdtemp(dir=SHARE))
    (SHARE / "use.py").write_text(USE)
    farm = write_jobs()
    page = (HERE.parents[1] / "docs" / "batch.md").read_text(encoding="utf-8")
    (script,) = [
        code for code in re.findall(r"^```python\n(.*?)^```", page, re.M | re.S) if "bpy.ops" in code
    ]
    (SHARE / "bodies.py").write_text(script)
    headless = ["--background", "--python-exit-code", "3", "--python"]
    gridmesh = ["--background", "--command", "gridmesh"]
    jobs = blender.path(farm / "jobs.jsonl")
    extension = ["--command", "extension"]
    steps = {
        "validate": [*extension, "validate", blender.path(package)],
        "install": [*extension, "install-file", "-r", "user_default", "-e", blender.path(package)],
        "use": ["--background", "--python-exit-code", "3", "--python", blender.path(SHARE / "use.py")],
        "help": [*gridmesh, "--help"],
        "ball": [*headless, blender.path(farm / "ball.py"), "--", blender.path(farm / "ball.obj")],
        "batch": [*gridmesh, "batch", jobs],
        "resume": [*gridmesh, "batch", jobs, "--resume"],
        "wrong": [*gridmesh, "batch", blender.path(farm / "none.jsonl")],
        "script": [*headless, blender.path(SHARE / "bodies.py"), "--", blender.path(farm)],
        "remove": [*extension, "remove", "user_default.gridmesh"],
    }
    failed = 0
    for name, words in steps.items():
        if name == "remove":
            failed += (wrong := interrupted(blender, profile, farm)) != ""
            print(
                f"{'FAILED' if wrong else 'PASSED'}  command line: interrupted{chr(10) * bool(wrong)}{wrong}"
            )
        done = run(blender, profile, words)
        wrong = [] if done.returncode == CODES.get(name, 0) else [f"exit code {done.returncode}"]
        if name in SAYS and not re.search(SAYS[name], done.stdout, re.MULTILINE):
            wrong.append(f"it does not say {SAYS[name]}")
        if name == "batch":
            wrong += said_by_batch(farm)
        if name == "script" and not (farm / "ring.blend").exists():
            wrong.append("it wrote no file")
        if name == "remove" and any("gridmesh" in path.name for path in profile.rglob("*")):
            wrong.append("files are left")
        good = not wrong
        failed += not good
        print(
            f"{'PASSED' if good else 'FAILED'}  command line: {name}{'' if good else chr(10).join(['', *wrong, done.stdout])}"
        )
    print(f"command line: {len(steps) + 1 - failed} passed, {failed} failed, 0 skipped", flush=True)
    return failed


def interrupted(blender, profile, folder):
    """What is wrong with a batch that is told to stop; nothing if all is well."""
    job = {"op": "strokes", "in": "ring.svg"}
    items = [json.dumps({**job, "id": f"{n}", "out": f"many/{n}.ply"}) + "\n" for n in range(50)]
    (folder / "many.jsonl").write_text("".join(items))
    words = ["--background", "--command", "gridmesh", "batch", blender.path(folder / "many.jsonl")]
    with subprocess.Popen(
        command(blender, profile, words), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as process:
        told = []
        for line in process.stdout:
            told.append(line)
            if line.startswith("[2/"):
                process.send_signal(signal.SIGINT)
    done = len(list((folder / "many").glob("*.ply")))
    good = process.returncode == 130 and "--resume" in "".join(told) and 2 <= done < 50
    return "" if good else f"exit code {process.returncode}, {done} files\n{''.join(told)}"


def command(blender, profile, words):
    return blender.command([blender.program, *words], BLENDER_USER_RESOURCES=blender.path(profile))


def run(blender, profile, words):
    return subprocess.run(
        command(blender, profile, words),
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
        timeout=600,
    )


main()
