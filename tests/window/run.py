"""The zip in a real Blender in a window, with mouse and keyboard; and the pictures of the documentation.

    python tests/window/run.py ZIP [SCENE ...]              # pictures go to out/tests/window/pictures
    python tests/window/run.py ZIP --documentation          # and from there into docs/pictures/windows

The window is on a screen in memory (Xvfb). Exit code 77 where there is no real Blender: nothing was tested then.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import real_blender

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SHARE = ROOT / "out" / "tests" / "window"

SHELL = """
set -e
exec 3>&1
Xvfb -displayfd 4 -screen 0 1280x800x24 -nolisten tcp 4>"$1/display" >/dev/null 2>&1 &
screen=$!
trap 'kill $screen' EXIT
for _ in 1 2 3 4 5 6 7 8 9 10; do [ -s "$1/display" ] && break; sleep 0.5; done
export DISPLAY=":$(cat "$1/display")"
shift
"$@"
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("zip", type=Path)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument(
        "--documentation", action="store_true", help="put the pictures into docs/pictures/windows"
    )
    arguments = parser.parse_args()
    shutil.rmtree(SHARE, ignore_errors=True)
    try:
        blender = real_blender.find(SHARE)
        if blender.root is None and not (shutil.which("Xvfb") and shutil.which("import")):
            raise real_blender.MissingError("Xvfb or ImageMagick is missing")
    except real_blender.MissingError as error:
        print(f"NO WINDOW, so nothing was tested in one: {error}")
        sys.exit(77)
    print(f"{blender.name}: {blender.program} in {blender.root or 'the system'}", flush=True)
    for file in (file for file in HERE.glob("*.py") if file.name != "run.py"):
        shutil.copy(file, SHARE)
    (SHARE / "zip").mkdir()
    profile = Path(tempfile.mkdtemp(dir=SHARE))
    package, pictures = Path(shutil.copy(arguments.zip, SHARE / "zip")), SHARE / "pictures"
    settings = {
        "BLENDER_USER_RESOURCES": blender.path(profile),
        "SCENES": " ".join(arguments.scenes),
        "ZIP": blender.path(package),
        "LIBGL_ALWAYS_SOFTWARE": "1",
    }
    if arguments.scenes and "install" not in arguments.scenes:
        install = ["--command", "extension", "install-file", "-r", "user_default", "-e", settings["ZIP"]]
        words = blender.command([blender.program, *install], **settings)
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    window = ["--window-geometry", "0", "0", "1280", "800", "--enable-event-simulate"]
    play = ["--python", blender.path(SHARE / "scenes.py"), "--", blender.path(pictures)]
    words = ["sh", "-c", SHELL, "window", blender.path(SHARE), blender.program, *window, *play]
    try:
        done = subprocess.run(blender.command(words, **settings), check=False, timeout=1200)
    except subprocess.TimeoutExpired:
        sys.exit("Blender did not come to an end within 20 minutes")
    if arguments.documentation and done.returncode == 0:
        target = ROOT / "docs" / "pictures" / "windows"
        target.mkdir(parents=True, exist_ok=True)
        for picture in pictures.glob("*.png"):
            shutil.copy(picture, target)
    sys.exit(done.returncode)


main()
