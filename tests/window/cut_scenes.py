"""Cutting with the tool: what a short stroke cuts and what the preview shows of it, several meshes, live bodies, mirrors."""

import gc

import bpy
import numpy as np
from setting import (
    begin,
    bodies,
    fresh,
    limb,
    mesh_objects,
    modules,
    outlines,
    points_of,
    redo,
    reopened,
    ring,
    select,
    stage,
    stroke,
    tool,
    turn_view,
    typed,
    undo,
)


def line(start, end, n=12):
    """Points in the window on a straight line."""
    return [tuple(point) for point in np.linspace(start, end, n)]


def shown():
    """The preview of the cut that is being drawn."""
    kind = modules("cut.draw_operator").Preview
    (preview,) = (one for one in gc.get_objects() if type(one) is kind and one._handler is not None)
    return preview


def choose_side(at, picture):
    """Point at the side that is kept, look, click."""
    yield from stage.move(*at)
    yield from stage.picture(picture)
    yield from stage.click(*at)
    yield 1.0


def open_edges(ob):
    """Number of edges with one face."""
    used = np.zeros(len(ob.data.edges), int)
    of_corner = np.empty(len(ob.data.loops), np.int32)
    ob.data.loops.foreach_get("edge_index", of_corner)
    np.add.at(used, of_corner, 1)
    return int((used == 1).sum())


def cut_arm():
    """A short stroke across the arm of a live body cuts the arm alone, shows so before, and freezes the body."""
    yield from begin()
    x, y = stage.middle()
    yield from stroke(ring((x - 60, y), 130, 60))
    yield from stroke(limb((x - 20, y), 0.0, 270, 30))
    (body,) = bodies()
    assert len(outlines()) == 1
    wide = np.ptp([vertex.co.x for vertex in body.data.vertices])
    yield from tool("gridmesh.cut")
    try:
        # Below it ends in the air; on and on it would go through nothing, above through nothing; aslant through the body.
        yield from stroke(line((x + 175, y - 45), (x + 120, y + 42)))
        assert [ob.bl_idname for ob in stage.window.modal_operators] == ["OBJECT_OT_gridmesh_cut"]
        ends = shown().ends
        assert ends is not None, "the preview does not know where the cut ends"
        at = stage.region("WINDOW")
        assert np.abs(ends - [[x + 175 - at.x, y - 45 - at.y], [x + 120 - at.x, y + 42 - at.y]]).max() < 60, (
            ends
        )
        yield from choose_side((x - 60, y), "cut_arm_1")
        (kept,) = mesh_objects()
        assert not bodies(), "a live body that was cut is not frozen"
        assert not outlines(), "its outline was left"
        assert open_edges(kept) == 0
        size = np.ptp([vertex.co.x for vertex in kept.data.vertices])
        assert 0.6 * wide < size < 0.85 * wide, "not the arm was cut off"
        assert len(kept.data.vertices) - len(kept.data.edges) + len(kept.data.polygons) == 2
        yield from stage.picture("cut_arm_2")
        yield from stage.key("Z", ctrl=True)
        yield 0.8
        (body,) = bodies()
        assert len(outlines()) == 1, "undo does not bring the outline back"
        assert body.gridmesh_live.problem == ""
    finally:
        yield from tool("builtin.select_box")


def cut_three():
    """Three selected balls, one stroke across all: each is cut and capped; another stroke names what it misses."""
    yield from fresh()
    for k in range(3):
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=48, ring_count=24, radius=0.8, location=(2 * k - 2, 0, 0)
        )
    for ob in mesh_objects():
        ob.select_set(True)
    bpy.ops.ed.undo_push(message="Balls")
    yield from tool("gridmesh.cut")
    x, y = stage.middle()
    try:
        yield from stroke(line((x - 380, y - 10), (x + 380, y + 25), 30))
        yield from choose_side((x, y + 120), "cut_three_1")
        assert len(mesh_objects()) == 3
        for ob in mesh_objects():
            heights = [vertex.co.z for vertex in ob.data.vertices]
            assert max(heights) > 0.7, f"{ob.name}: the wrong side"
            assert min(heights) > -0.4, f"{ob.name} was not cut"
            assert open_edges(ob) == 0, f"{ob.name} is not capped"
        turn_view(0.9, 0.0, 0.3)
        yield from stage.picture("cut_three_2")
    finally:
        yield from tool("builtin.select_box")


def cut_mirrored():
    """Half a ball with a Mirror modifier: the stroke cuts both sides, the cap goes on through the mirror."""
    yield from fresh()
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=1.5)
    ob = bpy.context.view_layer.objects.active
    with stage.override():
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.bisect(plane_co=(0, 0, 0), plane_no=(1, 0, 0), clear_inner=True)
        bpy.ops.object.mode_set(mode="OBJECT")
    ob.modifiers.new("Mirror", "MIRROR").use_clip = True
    select(ob)
    bpy.ops.ed.undo_push(message="Half")
    yield from tool("gridmesh.cut")
    x, y = stage.middle()
    try:
        yield from stroke(line((x - 260, y + 20), (x + 260, y + 20), 30))
        yield from choose_side((x + 40, y - 100), "cut_mirrored_1")
        (kept,) = mesh_objects()
        assert [modifier.type for modifier in kept.modifiers] == ["MIRROR"]
        bpy.context.view_layer.update()
        whole = kept.evaluated_get(bpy.context.evaluated_depsgraph_get())
        assert open_edges(whole) == 0, "the whole is not closed"
        assert max(vertex.co.z for vertex in kept.data.vertices) < 0.5, "the wrong side"
        turn_view(0.6, 0.0, 0.3)
        yield from stage.picture("cut_mirrored_2")
    finally:
        yield from tool("builtin.select_box")


def cut_options():
    """The options of the tool, which it keeps."""
    tools = bpy.context.workspace.tools
    return tools.from_space_view3d_mode("OBJECT").operator_properties("object.gridmesh_cut")


def cut_quads():
    """A ball of quads cut with *Faces: Quads* in the header: caps of quads; all selected, moved, scaled; undone, saved, opened."""
    yield from fresh()
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=1.5)
    bpy.ops.ed.undo_push(message="Ball")
    yield from tool("gridmesh.cut")
    cut_options().cells = "QUADS"
    x, y = stage.middle()
    try:
        t = np.linspace(-1, 1, 30)
        shaky = [(x + 260 * a, y + 60 * np.sin(4 * a) + 3 * np.sin(40 * a)) for a in t]
        yield from stroke(shaky)
        yield from choose_side((x, y - 110), "cut_quads_1")
        (kept,) = mesh_objects()
        assert open_edges(kept) == 0, "the ball is not capped"
        in_cap = [face for face in kept.data.polygons if face.normal.z > 0.5 and abs(face.center.z) < 0.7]
        odd = [face for face in in_cap if len(face.vertices) != 4]
        assert len(in_cap) > 50
        assert len(odd) <= 1, f"{len(odd)} of {len(in_cap)} faces of the cap are no quads"
        before = points_of(kept)
        yield from tool("builtin.select_box")
        yield from typed("A")
        yield from typed("G", "X", "1", "RET")
        yield from typed("S", "2", "RET")
        put = points_of(kept)
        assert np.abs(np.ptp(put, axis=0) - 2 * np.ptp(before, axis=0)).max() < 1e-4, "scaled"
        steps = []
        for _ in range(4):
            yield from undo()
            (ob,) = mesh_objects()
            steps.append(len(ob.data.polygons))
            if steps[-1] == 48 * 24:
                break
        assert steps[-1] == 48 * 24, "the cut itself is not undone"
        assert len(steps) >= 3, "moving, scaling and cutting are three steps"
        for _ in steps:
            yield from redo()
        (kept,) = mesh_objects()
        assert np.abs(points_of(kept) - put).max() < 1e-5, "redone"
        turn_view(0.7, 0.0, 0.4)
        with stage.override():
            bpy.ops.view3d.view_all()
        stage.view.spaces.active.overlay.show_wireframes = True
        yield 0.5
        yield from stage.picture("cut_quads_2")
        yield from reopened()
        (kept,) = mesh_objects()
        assert np.abs(points_of(kept) - put).max() < 1e-5, "opened"
        assert open_edges(kept) == 0
    finally:
        yield from tool("gridmesh.cut")
        cut_options().cells = "TRIANGLES"
        yield from tool("builtin.select_box")


SCENES = (cut_arm, cut_three, cut_mirrored, cut_quads)
