"""The zip in a real Blender in a window, with mouse and keyboard; and the pictures of the documentation.

    python tests/window/run.py ZIP [SCENE ...]              # pictures go to out/tests/window/pictures
    python tests/window/run.py ZIP --documentation          # and from there into docs/pictures/windows
    python tests/window/run.py ZIP SCENE ... --film FILM.webm    # what the window shows meanwhile, without waiting
    python tests/window/run.py ZIP random_play --seed 5 --acts 200    # whatever an artist might do, one act after another

The window is on a screen in memory (Xvfb). Exit code 77 where there is no real Blender: nothing was tested then.
"""

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import real_blender

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SHARE = ROOT / "out" / "tests" / "window"
PATIENCE = 2400
"""Seconds that all scenes together may take."""

SHELL = """
set -e
exec 3>&1
Xvfb -displayfd 4 -screen 0 1280x800x24 -nolisten tcp 4>"$1/display" >/dev/null 2>&1 &
screen=$!
trap 'kill $screen' EXIT
for _ in 1 2 3 4 5 6 7 8 9 10; do [ -s "$1/display" ] && break; sleep 0.5; done
export DISPLAY=":$(cat "$1/display")"
shift
if [ -n "$FRAMES" ]; then
  mkdir -p "$FRAMES"
  (k=0; while :; do k=$((k+1)); import -silent -window root -resize 960x600 +set date:create +set date:modify -define png:exclude-chunks=date,time "$FRAMES/$(printf %05d $k).png"; done) &
  film=$!
  trap 'kill $film $screen' EXIT
fi
"$@"
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("zip", type=Path)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument(
        "--documentation", action="store_true", help="put the pictures into docs/pictures/windows"
    )
    parser.add_argument("--film", type=Path, help="write what the window shows as a film (.webm)")
    parser.add_argument("--seed", type=int, default=1, help="of random_play and random_edits")
    parser.add_argument("--acts", type=int, default=150, help="of random_play and random_edits")
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
        "SEED": str(arguments.seed),
        "ACTS": str(arguments.acts),
        "LIBGL_ALWAYS_SOFTWARE": "1",
        "FRAMES": blender.path(SHARE / "frames") if arguments.film else "",
    }
    if arguments.scenes and "install" not in arguments.scenes:
        install = ["--command", "extension", "install-file", "-r", "user_default", "-e", settings["ZIP"]]
        words = blender.command([blender.program, *install], **settings)
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    window = ["--window-geometry", "0", "0", "1280", "800", "--enable-event-simulate"]
    play = [
        "--python-exit-code",
        "1",
        "--python",
        blender.path(SHARE / "scenes.py"),
        "--",
        blender.path(pictures),
    ]
    words = ["sh", "-c", SHELL, "window", blender.path(SHARE), blender.program, *window, *play]
    code = watched(blender.command(words, **settings))
    if arguments.film and code == 0:
        encode(blender, settings, arguments.film)
    if arguments.documentation and code == 0:
        illustrate(pictures, complete=not arguments.scenes)
    sys.exit(code)


def watched(words):
    """Run a command and show what it says; its exit code, or 1 if it told of an exception, which Blender goes on after."""
    thrown, late = False, threading.Event()
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(words, start_new_session=True, **pipes) as child:

        def end():
            late.set()
            os.killpg(child.pid, signal.SIGKILL)

        timer = threading.Timer(PATIENCE, end)
        timer.start()
        try:
            for line in child.stdout:
                print(line, end="", flush=True)
                thrown = thrown or line.startswith("Traceback")
        except KeyboardInterrupt:
            end()
            raise
        finally:
            timer.cancel()
    if late.is_set():
        sys.exit("Blender did not come to an end within 40 minutes")
    return child.returncode or int(thrown)


def encode(blender, settings, film):
    """Write the frames that were taken as a film."""
    made = SHARE / "film.webm"
    scripts = ["--python-exit-code", "1", "--python", blender.path(SHARE / "film.py")]
    words = [blender.program, "--background", "--factory-startup", *scripts, "--"]
    words += [blender.path(SHARE / "frames"), blender.path(made)]
    subprocess.run(blender.command(words, **settings), check=True)
    film.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(made, film)


def illustrate(pictures, *, complete):
    """Put the pictures that the documentation shows into it; complete : it has no others."""
    target = ROOT / "docs" / "pictures" / "windows"
    texts = "".join(
        page.read_text(encoding="utf-8") for page in (*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"))
    )
    shown = set(re.findall(r"pictures/windows/(\w+\.png)", texts))
    if complete:
        if missing := [name for name in sorted(shown) if not (pictures / name).exists()]:
            sys.exit(f"the documentation shows pictures that no scene takes: {', '.join(missing)}")
        shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True, exist_ok=True)
    for picture in pictures.glob("*.png"):
        if picture.name in shown:
            shutil.copy(picture, target)


main()
