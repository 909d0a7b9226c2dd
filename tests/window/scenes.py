"""What users see and do, in a real window: run inside Blender by run.py. Each scene checks, and takes pictures."""

import os
import sys
import time
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import live_scenes
import numpy as np
from mathutils import Vector
from stage import Stage, perform

PICTURES = Path(sys.argv[-1])
stage = Stage(PICTURES)
bpy.context.preferences.view.show_splash = False
bpy.context.preferences.system.viewport_aa = "FXAA"


def fresh(mode="OBJECT", axis="FRONT"):
    """The scene that Blender starts with, without its objects, seen along an axis."""
    bpy.ops.wm.read_homefile(load_ui=False)
    yield 0.6
    for ob in list(bpy.data.objects):
        bpy.data.objects.remove(ob)
    view = stage.view.spaces.active
    view.overlay.show_cursor = view.overlay.show_wireframes = False
    view.shading.type = "SOLID"
    with stage.override():
        bpy.ops.view3d.view_axis(type=axis)
    view.region_3d.view_perspective = "ORTHO"
    view.region_3d.view_distance = 7
    view.region_3d.view_location = (0, 0, 0)
    bpy.ops.ed.undo_push(message="Empty")
    yield 0.6


def mesh_objects():
    return [ob for ob in bpy.data.objects if ob.type == "MESH"]


def clover(size=150, n=60):
    """Points in the window, of a shape about the middle of the view."""
    x, y = stage.middle()
    t = np.linspace(0, 2 * np.pi, n)
    r = size * (1 + 0.3 * np.cos(3 * t))
    return [(x - 60 + r_ * np.sin(t_), y + r_ * np.cos(t_)) for r_, t_ in zip(r, t, strict=True)]


def grease_pencil(strokes, name="Drawing"):
    """A grease pencil object with strokes (n, 3), selected."""
    v3 = hasattr(bpy.data, "grease_pencils_v3")  # before Blender 5.0
    data = (bpy.data.grease_pencils_v3 if v3 else bpy.data.grease_pencils).new(name)
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    material = bpy.data.materials.new("Ink")
    bpy.data.materials.create_gpencil_data(material)
    material.grease_pencil.color = (0.07, 0.36, 0.62, 1)
    data.materials.append(material)
    drawing = data.layers.new("Lines").frames.new(1).drawing
    drawing.add_strokes([len(stroke) for stroke in strokes])
    drawing.attributes["position"].data.foreach_set(
        "vector", np.concatenate(strokes).astype(np.float32).ravel()
    )
    for stroke in drawing.strokes:
        stroke.cyclic = True
    drawing.tag_positions_changed()
    select(ob)
    bpy.ops.ed.undo_push(message="Drawing")  # the redo panel goes back to it
    return ob


def select(ob):
    bpy.context.view_layer.update()  # what is new is only now in it
    for other in bpy.context.view_layer.objects:
        other.select_set(other == ob)
    bpy.context.view_layer.objects.active = ob


def whale(n=160):
    """(n, 3) points of a round shape with a tail, in the plane y = 0."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = 1 + 0.28 * np.cos(t) + 0.3 * np.cos(3 * t + 0.5) + 0.08 * np.sin(5 * t)
    return np.stack([1.3 * r * np.cos(t), 0 * t, r * np.sin(t)], axis=1)


def turn_view(x=1.15, y=0.0, z=0.6):
    """See the scene from the side and above."""
    import mathutils

    view = stage.view.spaces.active.region_3d
    view.view_rotation = mathutils.Euler((x, y, z)).to_quaternion()


# ------------------------------------------------------------------------------------------------------- scenes


def install():
    """Install the zip from an empty profile: Preferences, Get Extensions, the arrow, Install from Disk."""
    addon = "bl_ext.user_default.gridmesh"
    assert addon not in bpy.context.preferences.addons, "it is installed already"
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"  # in this window, not in another
    yield from fresh()
    area = stage.view
    area.type = "PREFERENCES"
    bpy.context.preferences.active_section = "EXTENSIONS"
    yield 1.0
    yield from stage.click(area.x + area.width - 20, area.y + area.height - 46)
    yield 0.5
    yield from stage.picture("install_1_menu")
    yield from stage.choose("Install from Disk")
    browser = next((area for area in stage.window.screen.areas if area.type == "FILE_BROWSER"), None)
    assert browser is not None, "no file browser opened"
    package = Path(os.environ["ZIP"])
    browser.spaces.active.params.directory = str(package.parent).encode()
    browser.spaces.active.params.filename = package.name
    yield 1.0
    yield from stage.picture("install_2_file")
    yield from stage.move(browser.x + browser.width // 2, browser.y + browser.height // 3)
    yield from stage.key("RET")
    for _ in range(40):
        yield 0.5
        if addon in bpy.context.preferences.addons:
            break
    assert addon in bpy.context.preferences.addons, "nothing was installed"
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "GridMesh"
    area = stage.area("PREFERENCES")
    yield 0.5
    yield from stage.picture("install_3_addons")
    area.type = "VIEW_3D"
    yield 0.5
    bpy.ops.wm.save_userpref()


def first_body():
    """A stranger's way: draw with grease pencil, open the tab, press the button."""
    yield from fresh()
    bpy.ops.object.grease_pencil_add(type="EMPTY")
    with stage.override():
        bpy.ops.object.mode_set(mode="PAINT_GREASE_PENCIL")
        bpy.ops.brush.asset_activate(
            asset_library_type="ESSENTIALS",
            relative_asset_identifier="brushes/essentials_brushes-gp_draw.blend/Brush/Pencil",
        )
    yield 1.0
    yield from stage.drag(clover())
    yield 0.5
    ob = bpy.context.object
    assert ob.type == "GREASEPENCIL"
    frame = ob.data.layers[0].current_frame()
    assert frame is not None, "nothing was drawn"
    assert len(frame.drawing.strokes) == 1
    yield from stage.picture("first_1_drawing")
    stage.clicks = stage.keys = 0
    started = time.monotonic()
    yield from stage.open_sidebar()
    yield from stage.picture("first_2_panel")
    yield from stage.press_button("UI", "gridmesh_from_strokes")
    assert len(mesh_objects()) == 1, "no body was made"
    print(
        f"STRANGER {stage.clicks} clicks and {stage.keys} key after the drawing, "
        f"{time.monotonic() - started:.0f} s of simulated events",
        flush=True,
    )
    assert stage.clicks + stage.keys <= 6
    body = mesh_objects()[0]
    assert len(body.data.polygons) > 3000
    turn_view()
    yield from stage.picture("first_3_body")
    # Ctrl-Z takes the body, and only the body.
    yield from stage.move(*stage.middle())
    yield from stage.key("Z", ctrl=True)
    yield 0.8
    assert not mesh_objects(), "undo left the body"
    assert len(bpy.context.object.data.layers[0].current_frame().drawing.strokes) == 1
    yield from stage.key("Z", ctrl=True, shift=True)
    yield 0.8
    assert len(mesh_objects()) == 1, "redo did not bring it back"


def redo_panel():
    """Change an option afterwards: the same body, made anew."""
    yield from fresh()
    grease_pencil([whale()])
    yield from stage.open_sidebar()
    yield from stage.press_button("UI", "gridmesh_from_strokes")
    (body,) = mesh_objects()
    before = len(body.data.polygons), max(body.dimensions)
    turn_view()
    hud = yield from stage.open_redo_panel()
    yield from stage.picture("redo_1_before")
    fields = yield from numbers_of(hud, "triangles", "800")
    assert fields, "the number of triangles could not be changed in the redo panel"
    (body,) = mesh_objects()
    assert len(body.data.polygons) < before[0]
    yield from stage.picture("redo_2_after")


def numbers_of(hud, name, value):
    """Type a value into the field of an option, found by what Ctrl-C copies from it; whether the option has it."""
    manager = bpy.context.window_manager
    for y in range(hud.y + hud.height - 30, hud.y + 10, -11):
        manager.clipboard = ""
        yield from stage.move(hud.x + int(hud.width * 0.72), y)
        yield 0.1
        yield from stage.key("C", ctrl=True)
        if manager.clipboard == f"{getattr(manager.operators[-1], name)}":
            yield from stage.click(*stage.mouse)
            yield from stage.key("A", ctrl=True)
            yield from stage.write(value)
            yield from stage.key("RET")
            yield 1.5
            return f"{getattr(manager.operators[-1], name)}" == value
    return False


def update():
    """The drawing is changed, and the button brings the same object up to date."""
    yield from fresh()
    drawing = grease_pencil([whale()])
    yield from stage.open_sidebar()
    yield from stage.press_button("UI", "gridmesh_from_strokes", "OBJECTS")
    (body,) = mesh_objects()
    name, before = body.name, body.dimensions.x
    drawing = bpy.data.objects["Drawing"]
    points = (whale() * [1, 1, 1.5]).astype(np.float32)
    strokes = drawing.data.layers[0].frames[0].drawing
    strokes.attributes["position"].data.foreach_set("vector", points.ravel())
    strokes.tag_positions_changed()
    height = body.dimensions.y
    bpy.ops.ed.undo_push(message="Drawing changed")
    yield from stage.press_button("UI", "gridmesh_from_strokes", "update_existing")
    (body,) = mesh_objects()
    assert body.name == name
    assert abs(body.dimensions.x - before) < 0.1 * before
    assert body.dimensions.y > 1.3 * height


def menus():
    """The entry in Object > Convert, the presets, and the search; each by keyboard."""
    yield from fresh()
    grease_pencil([whale()])
    yield from stage.open_sidebar()
    yield from stage.move(*stage.middle())
    with stage.override():
        bpy.ops.wm.call_menu(name="VIEW3D_MT_object_convert")
    yield 0.5
    yield from stage.picture("menu_convert")
    yield from stage.choose("Strokes to Mesh")
    assert len(mesh_objects()) == 1, "the menu made nothing"
    yield from fresh()
    grease_pencil([whale()])
    yield from stage.search("Strokes to Mesh")
    assert len(mesh_objects()) == 1, "the search made nothing"


def sprites():
    """A flat sheet from the menu of presets."""
    yield from fresh()
    grease_pencil([whale()])
    yield from stage.open_sidebar()
    yield from stage.move(*stage.middle())
    with stage.override():
        bpy.ops.wm.call_menu(name="VIEW3D_MT_gridmesh_presets")
    yield 0.5
    yield from stage.picture("sprite_1_presets")
    yield from stage.choose("Sprite Standard")
    (sheet,) = mesh_objects()
    assert np.ptp([vertex.co.z for vertex in sheet.data.vertices]) < 1e-5
    stage.view.spaces.active.overlay.show_wireframes = True
    assert len(sheet.data.polygons) < 250
    yield from stage.picture("sprite_2_sheet")


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
    yield from stage.move(*stage.middle())
    yield from stage.key("Z", ctrl=True)
    yield 0.8
    assert faces() == open_faces, "undo left the patch"
    yield from stage.move(*stage.middle())
    yield from stage.key("F", ctrl=True)
    yield 0.5
    yield from stage.picture("fill_3_menu")
    yield from stage.choose("Grid Patch Fill")
    assert faces() == filled, "the Face menu filled nothing"
    yield from stage.key("Z", ctrl=True)
    yield 0.8
    yield from stage.press_button("UI", "gridmesh_fill", "ALL")
    assert faces() == filled, "Fill All Holes filled nothing"
    hud = yield from stage.open_redo_panel()
    assert (yield from numbers_of(hud, "max_edges", "40")), "Max Edges could not be changed"
    assert faces() == filled, "the redo panel did not fill again"


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
    """Cut a ball along a stroke, by the panel's button; then by a line drawn in the viewport, and Enter."""
    yield from fresh()
    target = ball()
    stroke = grease_pencil([wave()], "Cut")
    stroke.data.layers[0].frames[0].drawing.strokes[0].cyclic = False
    select(target)
    stroke.select_set(True)
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

    yield from fresh()
    ball()
    bpy.ops.ed.undo_push(message="Ball")
    yield from stage.open_sidebar()
    yield from stage.press_button("UI", "gridmesh_cut", "DRAWN")
    x, y = stage.middle()
    path = [(x - 250 + 12 * k, y + 25 * np.sin(0.25 * k)) for k in range(36)]
    yield from stage.drag(path)
    yield from stage.picture("cut_3_drawn")
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


def draw():
    """The tool in the toolbar: each stroke with the left button is a body at once."""
    yield from fresh()
    with stage.override():
        bpy.ops.wm.tool_set_by_id(name="gridmesh.draw")
    yield 0.5
    yield from stage.drag(clover())
    yield 1.0
    assert len(mesh_objects()) == 1, "no body was drawn"
    yield from stage.open_sidebar()
    yield from stage.picture("draw_body")
    yield from stage.move(*stage.middle())
    yield from stage.key("Z", ctrl=True)
    yield 0.8
    assert not mesh_objects(), "undo left the body"
    with stage.override():
        bpy.ops.wm.tool_set_by_id(name="builtin.select_box")


def long_work():
    """A million triangles can be stopped by Esc; two hundred thousand are waited for, and are one undo step."""
    yield from fresh()
    grease_pencil([whale()])
    yield from stage.open_sidebar()
    with stage.override():
        started = bpy.ops.object.gridmesh_from_strokes("INVOKE_DEFAULT", triangles=1_500_000)
    assert started == {"RUNNING_MODAL"}, started
    yield 1.0
    yield from stage.picture("long_work")
    assert not mesh_objects()
    yield from stage.move(*stage.middle())
    yield from stage.key("ESC")
    for _ in range(60):
        yield 0.5
        if not stage.window.modal_operators:
            break
    assert not stage.window.modal_operators, "it did not stop"
    assert not mesh_objects(), "something was made all the same"
    with stage.override():
        bpy.ops.object.gridmesh_from_strokes("INVOKE_DEFAULT", triangles=100_000)
    yield from stage.key("A")  # selects nothing: the operator takes it
    for _ in range(60):
        yield 0.5
        if mesh_objects():
            break
    (body,) = mesh_objects()
    assert len(body.data.polygons) > 180_000
    yield from stage.open_redo_panel()
    yield from stage.key("Z", ctrl=True)
    yield 1.0
    assert not mesh_objects(), "undo left the body"


def german():
    """The sidebar in German, if this Blender has languages."""
    if not bpy.app.build_options.international:
        raise NotImplementedError("this Blender has no languages")
    view = bpy.context.preferences.view
    if "de_DE" not in bpy.app.translations.locales:
        raise NotImplementedError("this Blender has no German")
    language = view.language
    view.language = "de_DE"
    view.use_translate_interface = view.use_translate_tooltips = True
    try:
        yield from fresh()
        grease_pencil([whale()])
        yield from stage.open_sidebar()
        assert bpy.app.translations.pgettext_iface("Strokes to Mesh", "Operator") == "Striche zu Mesh"
        yield from stage.picture("german")
    finally:
        view.language = language


SCENES = (
    *(install, first_body, redo_panel, update, menus, sprites, fill, cut, draw, long_work, german),
    *live_scenes.make(stage, fresh),
)


def finish(results):
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


wanted = os.environ.get("SCENES", "").split()
perform([(scene.__name__, scene) for scene in SCENES if not wanted or scene.__name__ in wanted], finish)
