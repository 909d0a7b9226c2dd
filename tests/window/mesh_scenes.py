"""Filling holes and cutting, with mouse and keyboard."""

import bpy
import numpy as np
from mathutils import Vector
from setting import (
    fresh,
    grease_pencil,
    mesh_objects,
    numbers_of,
    points_of,
    redo,
    reopened,
    select,
    stage,
    stroke,
    tool,
    turn_view,
    typed,
    undo,
)


def holed_ball():
    """A sphere with a hole, in Edit Mode, the hole's rim selected."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=1.5)
    ob = bpy.context.object
    bpy.ops.object.shade_smooth()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="FACE")
    bpy.ops.mesh.select_all(action="DESELECT")
    import bmesh

    bm = bmesh.from_edit_mesh(ob.data)
    for face in bm.faces:
        face.select_set((face.calc_center_median() - Vector((0, -1.2, 0.9))).length < 0.75)
    bmesh.update_edit_mesh(ob.data)
    bpy.ops.mesh.delete(type="FACE")
    bpy.ops.mesh.select_mode(type="EDGE")
    bpy.ops.mesh.select_non_manifold()
    return ob


def faces():
    ob = bpy.context.object
    ob.update_from_editmode()
    return len(ob.data.polygons)


def again_by_menu(key, name, open_faces, picture):
    """Undo, which leaves so many faces; then the operator's name out of the menu of a key."""
    yield from stage.move(*stage.middle())
    yield from undo()
    assert faces() == open_faces, "undo left new faces"
    yield from stage.move(*stage.middle())
    yield from stage.key(key, ctrl=True)
    yield 0.5
    yield from stage.picture(picture)
    yield from stage.choose(name)


def fill():
    """Fill a hole by the panel's button, the redo panel, the Face menu, and undo."""
    yield from fresh()
    with stage.override():
        holed_ball()
    turn_view(1.0, 0.0, 0.2)
    bpy.ops.ed.undo_push(message="hole")
    yield from stage.open_sidebar()
    open_faces = faces()
    yield from stage.picture("fill_1_hole")
    yield from stage.press_button("UI", "gridmesh_fill", "")
    filled = faces()
    assert filled > open_faces, "the panel's button filled nothing"
    yield from stage.picture("fill_2_filled")
    yield from again_by_menu("F", "Grid Patch Fill", open_faces, "fill_3_menu")
    assert faces() == filled, "the Face menu filled nothing"
    yield from undo()
    yield from stage.press_button("UI", "gridmesh_fill", "ALL")
    assert faces() == filled, "Fill All Holes filled nothing"
    hud = yield from stage.open_redo_panel()
    assert (yield from numbers_of(hud, "max_edges", "40")), "Max Edges could not be changed"
    assert faces() == filled, "the redo panel did not fill again"


def opened_ball(*holes):
    """A ball in Edit Mode, the rims of its holes selected."""
    with stage.override():
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=32)
        ob = bpy.context.object
        bpy.ops.object.shade_smooth()
        bpy.ops.object.mode_set(mode="EDIT")
    import bmesh

    bm = bmesh.from_edit_mesh(ob.data)
    gone = [f for f in bm.faces if min((f.calc_center_median() - Vector(p)).length for p in holes) < 0.25]
    bmesh.ops.delete(bm, geom=gone, context="FACES")
    bm.select_mode = {"EDGE"}
    for edge in bm.edges:
        edge.select_set(edge.is_boundary)
    bmesh.update_edit_mesh(ob.data)
    turn_view(1.1, 0.0, 0.5)
    bpy.ops.ed.undo_push(message="holes")
    return ob


def bridged_by_button(picture):
    """Press the panel's button; faces before and after."""
    yield from stage.open_sidebar()
    open_faces = faces()
    yield from stage.press_button("UI", "gridmesh_bridge", "")
    joined = faces()
    assert joined > open_faces, "the panel's button joined nothing"
    yield from stage.picture(picture)
    return open_faces, joined


def handled(ob, picture):
    """The only mesh, in Edit Mode: all selected, moved, scaled, undone, redone, saved, opened."""
    yield from stage.move(*stage.middle())
    yield from stage.key("TAB")
    yield 0.5
    before = points_of(ob)
    for keys in (("A",), ("G", "X", "2", "RET"), ("S", "2", "RET")):
        yield from typed(*keys)
    put = points_of(ob)
    assert np.abs(np.ptp(put, axis=0) - 2 * np.ptp(before, axis=0)).max() < 1e-4, "scaled"
    for _ in range(2):
        yield from undo()
    (ob,) = mesh_objects()
    assert np.abs(points_of(ob) - before).max() < 1e-5, "moving and scaling are two steps"
    for _ in range(2):
        yield from redo()
    yield from reopened()
    (ob,) = mesh_objects()
    assert np.abs(points_of(ob) - put).max() < 1e-5, "redone, saved and opened"
    yield from stage.picture(picture)


def handle():
    """Two holes in a ball become a handle by the panel's button; undone, by the Edge menu, with other options in the redo panel."""
    yield from fresh()
    ob = opened_ball((0.85, 0, 0.5), (0.85, 0, -0.5))
    open_faces, joined = yield from bridged_by_button("handle_1_joined")
    reach = max(vertex.co.x for vertex in ob.data.vertices)
    assert reach > 1.2, "the tube does not stand on the outside"
    yield from again_by_menu("E", "Grid Bridge", open_faces, "handle_2_menu")
    assert faces() == joined, "the Edge menu joined nothing"
    hud = yield from stage.open_redo_panel()
    assert (yield from numbers_of(hud, "rows", "12")), "Rows could not be changed"
    assert open_faces < faces() < joined, "the redo panel did not join again"
    yield from stage.picture("handle_3_rows")
    yield from handled(ob, "handle_4_scaled")


def hub():
    """Three holes in a ball get tubes that come together, by the panel's button and by the Edge menu; the view turned, undone, redone."""
    yield from fresh()
    ob = opened_ball((0.85, 0, 0.5), (0.7, 0.5, -0.5), (0.7, -0.5, -0.5))
    open_faces, joined = yield from bridged_by_button("hub_1_joined")
    reach = max(vertex.co.x for vertex in ob.data.vertices)
    assert reach > 1.2, "the tubes do not stand on the outside"
    yield from again_by_menu("E", "Grid Bridge", open_faces, "hub_2_menu")
    assert faces() == joined, "the Edge menu joined nothing"
    turn_view(0.7, 0.0, 1.2)
    yield from stage.picture("hub_3_turned")
    yield from undo()
    assert faces() == open_faces, "undone"
    yield from redo()
    assert faces() == joined, "redone"
    yield from handled(ob, "hub_4_scaled")


def ball(**options):
    """A sphere in Object Mode, the only object."""
    with stage.override():
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=1.5, **options)
    ob = bpy.context.view_layer.objects.active
    for face in ob.data.polygons:
        face.use_smooth = True
    return ob


def wave(n=60):
    """(n, 3) points of a line across the ball, in front of it."""
    t = np.linspace(-2, 2, n)
    return np.stack([t, 0 * t - 2, 0.35 * np.sin(2.5 * t)], axis=1)


def cut():
    """Cut a ball along a stroke, by the panel's button."""
    yield from fresh()
    target = ball()
    line = grease_pencil([wave()], "Cut")
    line.data.layers[0].frames[0].drawing.strokes[0].cyclic = False
    select(target)
    line.select_set(True)
    bpy.ops.ed.undo_push(message="Stroke")
    yield from stage.open_sidebar()
    yield from stage.picture("cut_1_stroke")
    yield from stage.press_button("UI", "gridmesh_cut", "OBJECTS")
    assert len(mesh_objects()) == 2, "nothing was cut"
    stage.view.spaces.active.overlay.show_wireframes = True
    turn_view(0.9, 0.0, 0.4)
    smaller = min(mesh_objects(), key=lambda ob: len(ob.data.polygons))
    smaller.location.z += 1.2 if max(v.co.z for v in smaller.data.vertices) > 1.2 else -1.2
    yield from stage.open_redo_panel()
    yield from stage.picture("cut_2_capped")


def cut_drawn():
    """A line drawn by the panel's button, and Enter keeps both sides; Esc leaves everything as it was."""
    yield from fresh()
    ball()
    bpy.ops.ed.undo_push(message="Ball")
    yield from stage.open_sidebar()
    yield from stage.press_button("UI", "gridmesh_cut", "DRAWN")
    path = across()
    yield from stage.drag(path)
    yield from stage.key("RET")
    yield 1.0
    assert len(mesh_objects()) == 2, "the drawn line cut nothing"
    yield from stage.move(*stage.middle())
    yield from stage.key("Z", ctrl=True)
    yield 0.8
    assert len(mesh_objects()) == 1, "undo left the cut"
    yield from stage.press_button("UI", "gridmesh_cut", "DRAWN")
    yield from stage.drag(path)
    yield from stage.key("ESC")
    yield 0.8
    assert not stage.window.modal_operators, "Esc did not end the drawing of a cut"
    assert len(mesh_objects()) == 1, "Esc cut all the same"
    yield from stage.press_button("UI", "gridmesh_cut", "DRAWN")
    x, y = stage.middle()
    turn = np.linspace(0, 2 * np.pi, 60)
    yield from stage.drag(
        [(x + 90 * a, y + 90 * b) for a, b in zip(np.cos(turn), np.sin(2 * turn), strict=True)]
    )
    yield 0.5
    yield from stage.picture("cut_eight")
    yield from stage.key("ESC")
    yield 0.5


def across():
    """Points in the window, of a line across the ball."""
    x, y = stage.middle()
    return [(x - 250 + 12 * k, y + 25 * np.sin(0.25 * k)) for k in range(36)]


def cut_side():
    """The tool in the toolbar: drag across the ball, then click the side that is kept; once each."""
    yield from fresh()
    ball()
    bpy.ops.ed.undo_push(message="Ball")
    yield from tool("gridmesh.cut")
    x, y = stage.middle()
    try:
        for upper in (True, False):
            yield from stroke(across())
            assert [ob.bl_idname for ob in stage.window.modal_operators] == ["OBJECT_OT_gridmesh_cut"]
            yield from stage.move(x, y + (90 if upper else -90))
            yield from stage.picture("cut_side_0" if upper else "cut_side_1")
            yield from stage.click(*stage.mouse)
            yield 0.8
            (kept,) = mesh_objects()
            heights = [vertex.co.z for vertex in kept.data.vertices]
            assert (max(heights) > 1.4) == upper, "the wrong side was kept"
            assert (min(heights) < -1.4) != upper, "the other side is still there"
            if upper:
                yield from stage.key("Z", ctrl=True)
                yield 0.8
        turn_view(0.9, 0.0, 0.4)
        yield from stage.open_redo_panel()
        yield from stage.picture("cut_side_2")
        for end in ("ESC", "RIGHTMOUSE"):
            before = len(mesh_objects()[0].data.vertices)
            yield from stroke(across(), end=end)
            assert not stage.window.modal_operators, end
            assert len(mesh_objects()[0].data.vertices) == before, end
    finally:
        yield from tool("builtin.select_box")


SCENES = (fill, handle, hub, cut, cut_drawn, cut_side)
