"""Act in a window of Blender: move the mouse, click, type, look. Runs inside Blender, started with --enable-event-simulate.

A scene is a generator. Each `yield` lets Blender handle what happened and draw; a number is the seconds to wait.
"""

import subprocess
from pathlib import Path
from time import monotonic

import bpy

STEP = 0.06
"""Seconds between two events."""


class Stage:
    """The first window, and what can be done in it. Coordinates are pixels from the lower left."""

    def __init__(self, pictures: Path):
        self.pictures = pictures
        self.mouse = (640, 400)
        self.clicks = 0
        self.keys = 0
        self.searched = 0.0
        """Seconds in which a button was looked for that a user sees at once."""

    @property
    def window(self):
        return bpy.context.window_manager.windows[0]

    @property
    def view(self):
        return self.area("VIEW_3D")

    def area(self, kind):
        return next(area for area in self.window.screen.areas if area.type == kind)

    def region(self, kind, area=None):
        area = area or self.view
        return next(region for region in area.regions if region.type == kind)

    def override(self, region="WINDOW"):
        """Context of a region of the 3D view, for calls from outside."""
        return bpy.context.temp_override(window=self.window, area=self.view, region=self.region(region))

    def middle(self, region="WINDOW"):
        at = self.region(region)
        return at.x + at.width // 2, at.y + at.height // 2

    # ------------------------------------------------------------------------------------------- mouse and keys

    def move(self, x, y, **held):
        self.mouse = (int(x), int(y))
        self.window.event_simulate("MOUSEMOVE", "NOTHING", x=self.mouse[0], y=self.mouse[1], **held)
        yield STEP

    def glide(self, path, **held):
        """Move along points that come faster than the window is drawn: Blender calls all but the last in between."""
        for x, y in path[:-1]:
            self.window.event_simulate("INBETWEEN_MOUSEMOVE", "NOTHING", x=int(x), y=int(y), **held)
        yield from self.move(*path[-1], **held)

    def press(self, button="LEFTMOUSE", value="PRESS", **held):
        self.window.event_simulate(button, value, x=self.mouse[0], y=self.mouse[1], **held)
        yield STEP

    def click(self, x, y, button="LEFTMOUSE", **held):
        self.clicks += 1
        yield from self.move(x, y)
        yield STEP
        yield from self.press(button, "PRESS", **held)
        yield from self.press(button, "RELEASE", **held)
        yield 3 * STEP

    def drag(self, path):
        """Draw with the left button along points."""
        yield from self.move(*path[0])
        yield from self.press("LEFTMOUSE", "PRESS")
        for x, y in path[1:]:
            yield from self.move(x, y)
        yield from self.press("LEFTMOUSE", "RELEASE")
        yield 4 * STEP

    def key(self, key, **held):
        self.keys += 1
        yield from self.press(key, "PRESS", **held)
        yield from self.press(key, "RELEASE", **held)
        yield 2 * STEP

    def write(self, text):
        names = dict(
            zip(
                "0123456789",
                ["ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE"],
                strict=True,
            )
        )
        names |= {" ": "SPACE", ".": "PERIOD", "-": "MINUS"}
        for letter in text:
            name = names.get(letter, letter.upper())
            self.window.event_simulate(name, "PRESS", x=self.mouse[0], y=self.mouse[1], unicode=letter)
            yield STEP
            self.window.event_simulate(name, "RELEASE", x=self.mouse[0], y=self.mouse[1])
            yield STEP

    def choose(self, text):
        """Find an entry of the open menu by its name, and take it."""
        yield from self.key("SPACE")
        yield from self.write(text)
        yield 0.8
        yield from self.key("RET")
        yield 1.0

    def search(self, text):
        """Find an operator by its name, as F3 does, and run it."""
        yield from self.move(*self.middle())
        yield from self.key("F3")
        yield from self.write(text)
        yield 0.8
        yield from self.key("RET")
        yield 0.8

    # -------------------------------------------------------------------------------------------------- finding

    def buttons(self, region, idname):
        """Heights of a region's buttons that call an operator, from the top: each is hovered and asked."""
        at = self.region(region)
        before, found = None, []
        for y in range(at.y + at.height - 8, at.y + 8, -8):
            yield from self.move(at.x + at.width // 2 - 10, y)
            called = self.asked(region)
            if idname in called and called != before:
                found.append((self.mouse[0], y, called))
            before = called
        return found

    def asked(self, region):
        """Python command of the button under the mouse; empty where there is none."""
        bpy.context.window_manager.clipboard = ""
        with self.override(region):
            if not bpy.ops.ui.copy_python_command_button.poll():
                return ""
            try:
                bpy.ops.ui.copy_python_command_button()
            except RuntimeError:
                return ""
        return bpy.context.window_manager.clipboard

    def press_property(self, name, columns, top, bottom):
        """Click the field of a property, found by the data path that Blender copies from what is under the mouse.

        columns : x at which it is looked for, from `top` down to `bottom`.
        """
        manager = bpy.context.window_manager
        for column in columns:
            for y in range(int(top), int(bottom), -9):
                manager.clipboard = ""
                yield from self.move(column, y)
                yield from self.press("C", "PRESS", ctrl=True, shift=True, alt=True)
                yield from self.press("C", "RELEASE", ctrl=True, shift=True, alt=True)
                if manager.clipboard.endswith(name):
                    yield from self.click(column, y - 4)
                    yield 0.8
                    return
        raise AssertionError(f"no field of {name}")

    def press_button(self, region, idname, part=""):
        """Click the first button that calls the operator, with `part` in its command."""
        found, started = [], monotonic()
        for _ in range(3):
            yield from self.move(*self.middle())  # away from what was under it
            yield 0.3
            found = yield from self.buttons(region, idname)
            for x, y, called in found:
                if part not in called:
                    continue
                # Well inside the button; but on a busy machine Blender was behind, and its top was not seen.
                for below in (6, 2, 0):
                    yield from self.move(x, y - below)
                    yield 0.3
                    if self.asked(region) == called:
                        self.searched += monotonic() - started
                        yield from self.click(x, y - below)
                        yield 0.8
                        return
        raise AssertionError(f"no button for {idname} {part} in {region}: {found}")

    def open_sidebar(self):
        """Open the sidebar by N, and its tab by a click; the tabs are tried from the top."""
        if self.region("UI").width < 20:
            yield from self.move(*self.middle())
            yield from self.key("N")
            yield 0.5
        at = self.region("UI")
        clicks, started = self.clicks, monotonic()
        for y in range(at.y + at.height - 20, at.y + 40, -25):
            if at.active_panel_category == "GridMesh":
                break
            self.clicks, began = clicks, monotonic()  # a user sees which tab it is
            yield from self.click(at.x + at.width - 8, y)
            self.searched += began - started
            started = began
        yield 0.5
        assert at.active_panel_category == "GridMesh", at.active_panel_category

    # -------------------------------------------------------------------------------------------------- looking

    def open_redo_panel(self):
        """Open the panel at the lower left by a click on its header; return its region."""
        with self.override():
            self.view.spaces.active.show_region_hud = True
        yield 0.5
        hud = self.region("HUD")
        if hud.height < 50:
            yield from self.click(hud.x + hud.width // 2, hud.y + hud.height // 2)
            yield 1.0
        assert hud.height > 50, "there is no redo panel"
        return hud

    def picture(self, name):
        """Take a picture of the whole window, after Blender has drawn it."""
        for area in self.window.screen.areas:
            area.tag_redraw()
        yield 1.2
        self.pictures.mkdir(parents=True, exist_ok=True)
        path = self.pictures / f"{name}.png"
        subprocess.run(["import", "-window", "root", str(path)], check=True)
        yield STEP


def perform(acts, finish):
    """Run generators one after another from a timer; `finish` gets (name, error or None) of each."""
    results = []
    state = {"acts": iter(acts), "current": None, "name": None}

    def tick():
        while True:
            if state["current"] is None:
                try:
                    state["name"], start = next(state["acts"])
                except StopIteration:
                    finish(results)
                    return None
                state["current"] = start()
            try:
                pause = next(state["current"])
            except StopIteration:
                results.append((state["name"], None))
                state["current"] = None
                continue
            except Exception as error:
                results.append((state["name"], error))
                state["current"] = None
                continue
            return STEP if pause is None else pause

    bpy.app.timers.register(tick, first_interval=2.0, persistent=True)
