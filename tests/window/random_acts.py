"""Acts of an artist, chosen at random: drawing, objects, modes, history, settings."""

from random import Random

import bpy
import numpy as np
from setting import (
    bodies,
    limb,
    outlines,
    redo,
    reopened,
    ring,
    select,
    stage,
    stroke,
    tool,
    turn_view,
    undo,
)

PART_KEYS = ((), (), ("P",), ("P",), ("P", "T"), ("P", "D"), ("P", "D", "D"), ("X",))
AS_CALLED = ("EXEC_DEFAULT", True)
"""For operators: with an undo step, as a menu calls them."""
COMMANDS = (
    "Apply All Transforms",
    "Apply Join",
    "Convert To Mesh",
    "Grid Join",
    "Grid Patch Fill",
    "Join Overlapping",
    "Make Single User",
    "Parent",
    "Purge Unused",
    "Set Origin",
    "Shade Smooth",
    "Split Off Part",
    "Strokes to Mesh",
    "Update Bodies",
)
SHORTCUTS = {
    "copy and paste": ("ctrl C", "ctrl V"),
    "mirror": ("ctrl M", "X", "RET"),
    "give a parent": ("ctrl P", "RET"),
    "clear the parent": ("alt P", "RET"),
    "apply a transform": ("ctrl A", "RET"),
    "clear the location": ("alt G",),
    "clear the rotation": ("alt R",),
    "subdivide": ("ctrl ONE",),
    "insert keys": ("K", "RET"),
    "to a collection": ("M", "RET"),
    "link data": ("ctrl L", "RET"),
    "see it alone": ("NUMPAD_SLASH",),
}


class Play:
    """What is done, one act after another; each is a generator of pauses as scenes are."""

    def __init__(self, seed):
        self.random = Random(seed)

    def spot(self, spread):
        """A place in the window, about the middle of the view."""
        x, y = stage.middle()
        return np.array(
            [x - 60 + self.random.uniform(-spread, spread), y + self.random.uniform(-spread, spread)]
        )

    def over_view(self):
        yield from stage.move(*self.spot(100))

    # ------------------------------------------------------------------------------------------------ drawing

    def draw_blob(self):
        yield from pen()
        radius, start, wobble = (self.random.uniform(*span) for span in ((25, 170), (0, 6), (0, 0.35)))
        path = ring(self.spot(260), radius, 40, start, wobble)
        yield from stroke(path, keys=self.random.choice(PART_KEYS))

    def draw_limb(self):
        yield from pen()
        angle, length, half = (self.random.uniform(*span) for span in ((0, 6.3), (60, 220), (12, 45)))
        yield from stroke(limb(self.spot(150), angle, length, half), keys=self.random.choice(PART_KEYS[:6]))

    def scribble(self):
        yield from pen()
        point = self.spot(260)
        path = [tuple(point)]
        for _ in range(self.random.randint(2, 30)):
            point = point + [self.random.uniform(-50, 50), self.random.uniform(-50, 50)]
            path.append(tuple(point))
        yield from stroke(path, keys=self.random.choice(((), ("P",))))

    def draw_across(self):
        yield from pen()
        start, end = self.spot(300), self.spot(300)
        yield from stroke([tuple(start + (end - start) * t) for t in np.linspace(0, 1, 24)])

    def give_up_a_stroke(self):
        yield from pen()
        yield from stroke(ring(self.spot(260), 80, 30), end=self.random.choice(("ESC", "RIGHTMOUSE")))

    def draw_with_a_key_held(self):
        yield from pen()
        held = self.random.choice(("shift", "ctrl", "alt"))
        yield from stroke(ring(self.spot(260), self.random.uniform(30, 120), 30), **{held: True})

    # ------------------------------------------------------------------------------------------------ objects

    def click(self):
        if self.random.random() < 0.5:
            yield from self.random.choice((pen(), tool("builtin.select_box")))
        for _ in range(self.random.randint(1, 2)):
            yield from stage.click(*self.spot(180))

    def select_all(self):
        yield from self.over_view()
        yield from stage.key("A", alt=self.random.random() < 0.3)

    def transform(self):
        yield from self.over_view()
        yield from stage.key(self.random.choice("GRS"))
        for _ in range(4):
            x, y = stage.mouse
            yield from stage.move(x + self.random.uniform(-30, 30), y + self.random.uniform(-30, 30))
        yield from stage.key(self.random.choice(("RET", "RET", "ESC")))
        yield 0.6

    def move_all(self):
        yield from self.over_view()
        yield from stage.key("A")
        yield from self.transform()

    def delete(self):
        yield from self.over_view()
        yield from stage.key("X")
        yield 0.4
        yield from stage.key("RET")
        yield 0.5

    def duplicate(self):
        yield from self.over_view()
        yield from stage.key("D", **{self.random.choice(("shift", "shift", "alt")): True})
        yield from stage.move(*self.spot(260))
        yield from stage.key("RET")
        yield 0.6

    def join(self):
        yield from self.over_view()
        yield from stage.key("J", ctrl=True)
        yield 0.5

    def hide(self):
        yield from self.over_view()
        yield from stage.key("H", **self.random.choice(({}, {"alt": True}, {"shift": True})))

    def press_a_shortcut(self):
        what = self.random.choice(list(SHORTCUTS))
        print(f"    {what}")
        yield from self.over_view()
        for pressed in SHORTCUTS[what]:
            *held, key = pressed.split()
            yield from stage.key(key, **dict.fromkeys(held, True))
            yield 0.4
        yield from stage.key("ESC")
        yield 0.3

    def call_a_command(self):
        yield from stage.search(self.random.choice(COMMANDS))
        yield from stage.key("ESC")
        yield 0.3

    def call_operator(self, kind, name):
        """One of ours, then perhaps with another option, as its panel sets it."""
        done = set()
        with stage.override():
            operator = getattr(getattr(bpy.ops, kind), name)
            if operator.poll():
                try:
                    done = operator(*AS_CALLED)
                except RuntimeError as error:
                    print(f"    {error}")
            print(f"    {name}: {done}")
        yield 0.6
        last = bpy.context.window_manager.operators
        if "FINISHED" in done and last and self.random.random() < 0.5:
            self.change(last[-1].properties)
            with stage.override():
                if bpy.ops.ed.undo_redo.poll():
                    bpy.ops.ed.undo_redo()
            yield 0.6

    # -------------------------------------------------------------------------------------------------- modes

    def pencil(self):
        """A drawing with Blender's pencil, and bodies of it."""
        yield from in_object_mode()
        with stage.override():
            bpy.ops.object.grease_pencil_add(*AS_CALLED, type="EMPTY")
            bpy.ops.object.mode_set(*AS_CALLED, mode="PAINT_GREASE_PENCIL")
        yield 0.6
        for _ in range(self.random.randint(1, 3)):
            radius, start, wobble = (self.random.uniform(*span) for span in ((25, 120), (0, 6), (0, 0.35)))
            yield from stroke(ring(self.spot(200), radius, 40, start, wobble))
        yield from in_object_mode()
        yield from self.call_operator("object", "gridmesh_from_strokes")

    def edit(self):
        yield from self.over_view()
        yield from stage.key("TAB")
        yield 0.4
        for _ in range(self.random.randint(0, 2)):
            yield from stage.key("A")
            yield from self.random.choice((self.transform, self.delete, self.undo))()
        yield from self.over_view()
        yield from stage.key("TAB")
        yield 0.5

    def edit_an_outline(self):
        found = [ob for ob in outlines() if ob.visible_get()]
        if found and bpy.context.mode == "OBJECT":
            select(self.random.choice(found))
            yield from self.edit()

    def sculpt(self):
        ob = bpy.context.view_layer.objects.active
        if bpy.context.mode != "OBJECT" or ob is None or ob.type != "MESH" or not ob.visible_get():
            return
        with stage.override():
            bpy.ops.object.mode_set(*AS_CALLED, mode="SCULPT")
        yield 0.4
        yield from stage.drag([tuple(self.spot(150)) for _ in range(4)])
        yield from in_object_mode()

    # ------------------------------------------------------------------------------------------------ history

    def undo(self):
        for _ in range(self.random.randint(1, 4)):
            yield from undo()

    def redo(self):
        for _ in range(self.random.randint(1, 3)):
            yield from redo()

    def undo_and_redo(self):
        """The same is there as before."""
        if bpy.context.mode == "OBJECT":
            before = what_is_there()
            yield from undo()
            yield from redo()
            yield 1.0
            check_same(before, "undone and redone")

    def save_and_open(self):
        """The same is there as before."""
        yield from in_object_mode()
        before = what_is_there()
        yield from reopened()
        check_same(before, "saved and opened")

    # ------------------------------------------------------------------------------------------------ settings

    def turn_view(self):
        yield from self.over_view()
        if self.random.random() < 0.5:
            pads = ("NUMPAD_1", "NUMPAD_3", "NUMPAD_7", "NUMPAD_5", "NUMPAD_0", "HOME")
            yield from stage.key(self.random.choice(pads))
        else:
            turn_view(self.random.uniform(0, 3), 0, self.random.uniform(-3, 3))
        yield 0.4

    def front_view(self):
        with stage.override():
            bpy.ops.view3d.view_axis(type="FRONT")
        stage.view.spaces.active.region_3d.view_perspective = "ORTHO"
        yield 0.3

    def change_frame(self):
        yield from self.over_view()
        yield from stage.key(self.random.choice(("RIGHT_ARROW", "LEFT_ARROW")))
        yield 0.3

    def change_tool_options(self):
        yield from pen()
        with stage.override():
            active = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT")
        for _ in range(2):
            self.change(active.operator_properties("object.gridmesh_draw"))
        yield 0.2

    def change_a_body(self):
        if found := bodies():
            self.change(self.random.choice(found).gridmesh_live)
            yield 0.8
            bpy.ops.ed.undo_push(message="Setting")

    def change(self, options):
        """Set one property of a group to a value that the panel offers."""
        kinds = {"BOOLEAN", "INT", "FLOAT", "ENUM"}
        found = [p for p in options.bl_rna.properties if p.type in kinds and not p.is_readonly]
        chosen = self.random.choice([p for p in found if not getattr(p, "is_array", False)])
        if chosen.type == "BOOLEAN":
            value = not getattr(options, chosen.identifier)
        elif chosen.type == "INT":
            value = self.random.randint(max(chosen.soft_min, 1), min(chosen.soft_max, 3000))
        elif chosen.type == "FLOAT":
            value = self.random.uniform(chosen.soft_min, min(chosen.soft_max, 3))
        else:
            value = self.random.choice([item.identifier for item in chosen.enum_items])
            value = {value} if chosen.is_enum_flag else value
        print(f"    {chosen.identifier} = {value}")
        setattr(options, chosen.identifier, value)

    OFTEN = (
        *(draw_blob, draw_limb, undo) * 8,
        *(click, transform) * 5,
        *(call_a_command, front_view, change_a_body) * 4,
        *(press_a_shortcut,) * 6,
        *(redo, delete, duplicate, edit, edit_an_outline, pencil) * 3,
        *(
            scribble,
            draw_across,
            draw_with_a_key_held,
            move_all,
            undo_and_redo,
            turn_view,
            change_tool_options,
        )
        * 2,
        *(give_up_a_stroke, select_all, join, hide, sculpt, change_frame, save_and_open),
    )


def pen():
    """The tool that draws; there is none in other modes."""
    yield from in_object_mode()
    yield from tool("gridmesh.draw")


def in_object_mode():
    if bpy.context.mode != "OBJECT" and bpy.ops.object.mode_set.poll():
        with stage.override():
            bpy.ops.object.mode_set(*AS_CALLED, mode="OBJECT")
        yield 0.6


def what_is_there():
    """Vertices of every mesh that is shown, by name."""
    bpy.context.view_layer.update()
    found = {}
    for ob in bpy.context.view_layer.objects:
        if ob.type == "MESH":
            points = np.empty(len(ob.data.vertices) * 3, np.float32)
            ob.data.vertices.foreach_get("co", points)
            found[ob.name] = (ob.visible_get(), points, np.array(ob.matrix_world))
    return found


def check_same(before, what):
    after = what_is_there()
    assert after.keys() == before.keys(), f"{what}: {sorted(after)} instead of {sorted(before)}"
    for name, (visible, points, place) in before.items():
        shown, now, there = after[name]
        assert shown == visible, f"{what}: {name} is {'shown' if shown else 'hidden'}"
        assert np.array_equal(now, points), f"{what}: {name} has another mesh"
        assert np.allclose(there, place, atol=1e-5), f"{what}: {name} is elsewhere"
