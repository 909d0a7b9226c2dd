"""Characters by mouse: parts drawn over a body, in front and behind, with twins; picked, moved, split off, deleted, dragged."""

from time import perf_counter

import bpy
import numpy as np
from draw_scenes import euler, words
from live_scenes import click, edited
from setting import (
    begin,
    bodies,
    limb,
    modules,
    outlines,
    redo,
    ring,
    stage,
    stroke,
    tool,
    turn_view,
    undo,
)


def wholes():
    return modules("join.following").wholes()


def parts():
    return modules("join.following").parts_of(wholes()[0])


def character(triangles=None):
    """A body with a head, an arm and its twin, and a belly: four strokes."""
    yield from begin()
    if triangles is not None:
        with stage.override():
            found = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT")
            options = found.operator_properties("object.gridmesh_draw")
        options.resolution, options.triangles = "TRIANGLES", triangles
    x, y = stage.middle()
    x -= 60
    yield from stroke(ring((x, y - 60), 130, 48))
    yield from stroke(ring((x, y + 110), 90, 40, start=-np.pi / 2), keys=("P",))
    yield from stroke(limb(np.array([x + 80, y - 30]), 0.5, 150, 34), keys=("P", "T"))
    yield from stroke(ring((x, y - 90), 60, 30), keys=("P",))
    return x, y


def part_character():
    """Strokes with P become parts of one closed body; T gives one a twin; the word says where it lies."""
    yield from begin()
    x, y = stage.middle()
    x -= 60
    yield from stroke(ring((x, y - 60), 130, 48))
    body = bodies()[0].name
    said = words()
    yield from stroke(
        ring((x, y + 110), 90, 40, start=-np.pi / 2), keys=("P",), picture="part_1_head", at=0.85
    )
    assert said[-1][0] == f"Part of '{body}', Middle", said[-1]
    assert len(wholes()) == 1
    assert [ob for ob in bpy.context.view_layer.objects if ob.visible_get()] == wholes()
    said.clear()
    yield from stroke(
        limb(np.array([x + 80, y - 30]), 0.5, 150, 34), keys=("P", "T"), picture="part_2_arm", at=0.85
    )
    yield from stroke(ring((x, y - 90), 60, 30), keys=("P",), picture="part_3_belly", at=0.85)
    assert said[-1][0] == f"Part of '{body}', In Front", said[-1]
    said.clear()
    yield from stroke(ring((x + 70, y - 190), 50, 30), keys=("P", "D", "D", "D"))
    assert said[-1][0] == f"Part of '{body}', Behind", said[-1]
    assert len(parts()) == 5
    assert len(bodies()) == len(outlines()) == 5
    (whole,) = wholes()
    assert euler(whole) == 2
    yield from stage.picture("part_4_character")
    turn_view()
    yield from stage.picture("part_5_turned")
    turn_view(np.pi / 2, 0, 0)
    yield from stage.key("Z", ctrl=True)
    yield 1.0
    assert len(parts()) == 4, "more or less than one step"
    yield from stage.key("Z", ctrl=True, shift=True)
    yield 1.0
    assert len(parts()) == 5
    assert euler(wholes()[0]) == 2


def part_moved():
    """A click on the whole selects it, another one the part; G moves that, X deletes it, the button splits it off."""
    x, y = yield from character()
    yield from stage.open_sidebar()
    yield from stage.click(x - 200, y + 250)
    yield from stage.click(x + 150, y + 10)
    assert bpy.context.view_layer.objects.active == wholes()[0]
    yield from stage.click(x + 190, y + 40)
    arm = bpy.context.view_layer.objects.active
    assert arm == parts()[2], arm
    assert wholes()[0].visible_get()
    yield 0.6
    yield from stage.picture("part_6_picked")
    wide = np.ptp([corner[0] for corner in wholes()[0].bound_box])
    yield from stage.move(*stage.middle())
    for key in ("G", "X"):
        yield from stage.key(key)
    yield from stage.write("0.3")
    yield from stage.key("RET")
    yield 1.5
    assert np.ptp([corner[0] for corner in wholes()[0].bound_box]) > wide + 0.5, "both arms move"
    assert euler(wholes()[0]) == 2
    yield from stage.picture("part_7_moved")
    yield from stage.key("Z", ctrl=True)
    yield 1.5
    assert abs(np.ptp([corner[0] for corner in wholes()[0].bound_box]) - wide) < 0.01, "not undone"
    yield from stage.press_button("UI", "gridmesh_split_part")
    yield 0.5
    assert len(parts()) == 3
    assert len(bodies()) == len(outlines()) == 5, "the arm, and its twin"
    yield from stage.picture("part_8_split")
    yield from stage.move(*stage.middle())
    yield from stage.key("Z", ctrl=True)
    yield 1.5
    assert len(parts()) == 4
    assert euler(wholes()[0]) == 2
    yield from stage.move(*stage.middle())
    yield from stage.key("X")
    yield 0.5
    yield from stage.key("RET")
    yield 1.5
    assert len(parts()) == 3
    assert euler(wholes()[0]) == 2
    seen = [ob for ob in bpy.context.scene.objects if ob.type == "GREASEPENCIL"]
    assert len(seen) == 3, "the outline stays"
    yield from stage.picture("part_9_deleted")
    yield from stage.key("Z", ctrl=True)
    yield 1.5
    assert len(parts()) == 4
    assert abs(np.ptp([corner[0] for corner in wholes()[0].bound_box]) - wide) < 0.01, "not undone"


def part_hidden():
    """A part that was picked is no longer seen when something else is clicked; Alt-H shows no part over the whole; an eye picks one."""
    x, y = yield from character()
    whole, arm = wholes()[0], parts()[2]
    yield from tool("builtin.select_box")
    with stage.override():
        bpy.ops.object.gridmesh_pick_part("EXEC_DEFAULT", True, name=arm.name)
    yield 0.8
    assert seen_now() == {whole, arm, arm.gridmesh_live.source}
    yield from stage.picture("part_14_wire")
    yield from stage.click(x - 60, y - 150)
    yield 0.8
    assert bpy.context.view_layer.objects.active == whole
    assert seen_now() == {whole}
    yield from stage.key("H")
    yield 0.8
    assert seen_now() == set()
    yield from stage.key("H", alt=True)
    yield 0.8
    assert seen_now() == {whole}
    yield from stage.picture("part_15_all_shown")
    for step in (undo, redo):
        yield from step()
        whole = wholes()[0]
        assert seen_now() == (set() if step is undo else {whole})
    with stage.override():
        bpy.ops.object.gridmesh_show_parts("EXEC_DEFAULT", True)
    yield 0.8
    shown = seen_now()
    assert whole not in shown
    assert shown >= set(parts())
    yield from stage.key("H", alt=True)
    yield 0.8
    assert seen_now() == shown
    with stage.override():
        bpy.ops.object.gridmesh_show_parts("EXEC_DEFAULT", True)
    yield 0.8
    arm = parts()[2]
    arm.hide_set(False)
    bpy.ops.ed.undo_push(message="Eye")
    yield 0.8
    assert bpy.context.view_layer.objects.active == arm
    assert arm.display_type == "WIRE"


def seen_now():
    return {ob for ob in bpy.context.view_layer.objects if ob.visible_get()}


def dragged(times):
    """What is selected is moved by the mouse, so many times, and not let go; how long that took."""
    yield from stage.move(*stage.middle())
    yield from stage.key("G")
    began = perf_counter()
    at = stage.mouse
    for k in range(times):
        yield from stage.move(at[0] + 2 + k % 40, at[1] + k % 7)
    return perf_counter() - began


def part_timing():
    """The stroke of a joined character of five parts of 1000 triangles a side is dragged: how often the body follows."""
    x, y = yield from character(1000)
    yield from stroke(ring((x + 70, y - 190), 50, 30), keys=("P",))
    yield 0.5
    (whole,) = wholes()
    faces = len(whole.data.polygons)
    modules("join.characters").pick(parts()[1])
    bpy.ops.ed.undo_push(message="Pick")
    yield 1.0
    yield from tool("builtin.select_box")
    yield from edited(parts()[1].gridmesh_live.source, 10)
    drafts = modules("join.drafts").timing
    bodies_alone = modules("live.engine").timing
    drafts.clear()
    bodies_alone.clear()
    seconds = yield from dragged(90)
    count = len(drafts)
    own, body = 1000 * np.array(drafts), 1000 * np.array(bodies_alone)
    yield from stage.picture("part_timing")
    yield from click()
    yield 2.0
    assert euler(wholes()[0]) == 2
    assert count > 10, "the body did not follow"
    for part in parts():
        part.gridmesh_live.enabled = False
    drafts.clear()
    alone = yield from dragged(90)
    yield from click()
    assert not drafts
    print(
        f"NUMBERS parts: {faces} triangles of {len(parts())} parts; {count} drafts in {seconds:.2f} s of dragging, "
        f"{count / seconds:.1f} a second; the window draws {90 / alone:.1f} a second where no body follows; a draft takes {np.median(own):.1f} ms (median), {own.max():.1f} ms (most), "
        f"its body before that {np.median(body):.1f} ms (median), {body.max():.1f} ms (most)"
    )


def part_armature():
    """From strokes to an armature with automatic weights: the join applied, bones, Ctrl-P, an arm and the head turned."""
    yield from character()
    spots = [np.array(part.matrix_world.translation) for part in parts()]
    whole = wholes()[0]
    yield from stage.open_sidebar()
    yield from stage.press_button("UI", "gridmesh_apply_join")
    yield 1.0
    assert not wholes()
    assert not bodies()
    assert euler(whole) == 2
    body, head, arm = spots[:3]
    side = arm * [-1, 1, 1] + [2 * body[0], 0, 0]
    bones = {
        "Body": (body - [0, 0, 0.8], body + [0, 0, 0.6]),
        "Head": (body + [0, 0, 0.9], head + [0, 0, 0.5]),
        "Arm.L": (arm - (arm - body) * 0.3, arm + (arm - body) * 0.45),
        "Arm.R": (side - (side - body) * 0.3, side + (side - body) * 0.45),
    }
    with stage.override():
        bpy.ops.object.armature_add()
        armature = bpy.context.view_layer.objects.active
        armature.location = (0, 0, 0)
        armature.show_in_front = True
        bpy.ops.object.mode_set(mode="EDIT")
        made = armature.data.edit_bones
        for bone in list(made):
            made.remove(bone)
        for name, (start, end) in bones.items():
            bone = made.new(name)
            bone.head, bone.tail = start, end
            if name != "Body":
                bone.parent = made["Body"]
        bpy.ops.object.mode_set(mode="OBJECT")
        whole.select_set(True)
    yield from stage.picture("part_10_bones")
    with stage.override():
        bpy.ops.object.parent_set(type="ARMATURE_AUTO")
        bpy.ops.object.mode_set(mode="POSE")
    assert min(sum(group.weight for group in vertex.groups) for vertex in whole.data.vertices) > 0.9
    yield from tool("builtin.select_box")
    for name, turn in (("Head", 25), ("Arm.L", 60)):
        armature.data.bones.active = armature.data.bones[name]
        for bone in armature.pose.bones:
            chosen = bone if hasattr(bone, "select") else bone.bone
            chosen.select = bone.name == name
        yield 0.3
        yield from stage.move(*stage.middle())
        yield from stage.key("R")
        yield from stage.write(str(turn))
        yield from stage.key("RET")
        yield 0.8
    seen = whole.evaluated_get(bpy.context.evaluated_depsgraph_get())
    moved = [
        np.linalg.norm(a.co - b.co) for a, b in zip(seen.data.vertices, whole.data.vertices, strict=True)
    ]
    assert max(moved) > 0.3, "the armature moves nothing"
    assert sorted(moved)[len(moved) // 4] < 0.1, "all of it moves"
    yield from stage.picture("part_11_posed")


SCENES = (part_character, part_moved, part_hidden, part_armature, part_timing)
