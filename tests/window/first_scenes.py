"""From the zip to a body: installing, strokes, the redo panel, menus, presets, long work, another language."""

import json
import os
import re
import subprocess
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np
from setting import (
    begin,
    bodies,
    clover,
    fresh,
    grease_pencil,
    limb,
    mesh_objects,
    modules,
    numbers_of,
    ring,
    stage,
    stroke,
    tool,
    turn_view,
    whale,
)


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
    stage.clicks, stage.keys, stage.searched = 0, 0, 0.0
    started = time.monotonic()
    yield from stage.open_sidebar()
    pictured = time.monotonic()
    yield from stage.picture("first_2_panel")
    stage.searched += time.monotonic() - pictured
    yield from stage.press_button("UI", "gridmesh_from_strokes")
    assert len(mesh_objects()) == 1, "no body was made"
    print(
        f"STRANGER {stage.clicks} clicks and {stage.keys} key after the drawing, "
        f"{time.monotonic() - started - stage.searched:.1f} s until the body is there",
        flush=True,
    )
    assert stage.clicks + stage.keys <= 6
    body = mesh_objects()[0]
    assert len(body.data.polygons) > 1700  # Automatic: at least 1000 of each side, within 10 %
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


def first_newcomer():
    """The scene that Blender starts with, and the tool: a body with two limbs and a hole in few actions, none undone."""
    bpy.ops.wm.read_homefile(load_ui=False)
    yield 1.0
    actions = 0
    yield from stage.move(*stage.middle())
    yield from stage.key("NUMPAD_1")  # from the front
    yield 0.5
    yield from stage.key("X")  # away with the cube
    yield from stage.key("RET")
    actions += 3
    assert "Cube" not in bpy.context.scene.objects, "the cube is still there"
    with stage.override():
        stage.view.spaces.active.show_region_toolbar = True
    yield 0.5
    yield from stage.press_button("TOOLS", "tool_set_by_id", "gridmesh.draw")
    with stage.override():
        assert bpy.context.workspace.tools.from_space_view3d_mode("OBJECT").idname == "gridmesh.draw"
    actions += 1
    x, y = stage.middle()
    yield from stroke(ring((x, y), 130, 60, wobble=0.08))
    limbs = [limb((x - 60, y - 60), 4.1, 190, 28), limb((x + 60, y - 60), 5.3, 190, 28)]
    for k, path in enumerate(limbs):
        yield from stroke(path, picture=f"newcomer_{k + 1}_limb")
    yield from stroke(ring((x, y + 20), 40, 30), shift=True)
    actions += 4
    yield from stage.picture("newcomer_3_body")
    (body,) = bodies()
    mesh = body.data
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 0, "there is no hole"
    assert body.gridmesh_live.problem == ""
    turn_view()
    yield from stage.picture("newcomer_4_turned")
    print(f"NEWCOMER {actions} actions", flush=True)
    assert actions <= 10
    yield from tool("builtin.select_box")


def redo_panel():
    """Change an option afterwards: the same body, made anew."""
    yield from fresh()
    grease_pencil([whale()])
    yield from stage.open_sidebar()
    yield from stage.press_button("UI", "gridmesh_from_strokes")
    (body,) = mesh_objects()
    before = np.ptp([vertex.co.z for vertex in body.data.vertices])
    turn_view()
    hud = yield from stage.open_redo_panel()
    yield from stage.picture("redo_1_before")
    fields = yield from numbers_of(hud, "depth", "0.3")
    assert fields, "the depth could not be changed in the redo panel"
    (body,) = mesh_objects()
    assert np.ptp([vertex.co.z for vertex in body.data.vertices]) < 0.5 * before
    yield from stage.picture("redo_2_after")


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


def batch():
    """Drawings become bodies by the command line, and are opened here."""
    yield from fresh()
    folder = Path(tempfile.mkdtemp())
    with (folder / "jobs.jsonl").open("w") as jobs:
        for k in range(6):
            t = np.linspace(0, 2 * np.pi, 90, endpoint=False)
            r = 0.8 + 0.2 * np.cos((k + 2) * t)
            points = np.stack([r * np.cos(t), r * np.sin(t)], axis=1).tolist()
            (folder / f"{k}.json").write_text(json.dumps({"points": points}))
            job = {"id": f"body {k}", "op": "strokes", "in": f"{k}.json", "out": f"{k}.ply"}
            print(json.dumps({**job, "params": {"triangles": 600}}), file=jobs)
    words = ["--background", "--command", "gridmesh", "batch", str(folder / "jobs.jsonl")]
    done = subprocess.run([bpy.app.binary_path, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    for k in range(6):
        bpy.ops.wm.ply_import(filepath=str(folder / f"{k}.ply"))
        ob = bpy.context.object
        ob.location = (2.1 * (k % 3) - 2.1, 0, 1.1 - 2.2 * (k // 3))
        ob.rotation_euler.x = np.pi / 2
        ob.name = f"body {k}"
    assert len(mesh_objects()) == 6
    stage.view.spaces.active.overlay.show_wireframes = True
    yield from stage.picture("batch")


def german():
    """Sidebar, redo panel and live body in German, if this Blender has languages: nothing is cut off."""
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
        said = bpy.app.translations.pgettext_iface
        assert said("Strokes to Mesh", "Operator") == "Striche zu Mesh"
        triangles = bpy.ops.object.gridmesh_from_strokes.get_rna_type().properties["triangles"]
        assert said(triangles.name, triangles.translation_context) == "Dreiecke jeder Seite"
        yield from stage.press_button("UI", "gridmesh_from_strokes")
        yield from stage.open_redo_panel()
        yield from stage.picture("german_strokes")
        yield from begin()
        x, y = stage.middle()
        yield from stroke(ring((x - 100, y), 150, 36, wobble=0.2))
        yield from stage.open_redo_panel()
        yield from stage.picture("german_live")
    finally:
        view.language = language


class Names:
    """A layout that only collects the names that it is to show, and how they read in the language chosen."""

    def __init__(self):
        self.names = []

    def row(self, **_):
        return self

    column = row

    def separator(self, **_):
        pass

    def label(self, text, translate=True, **_):
        if translate:
            self.names.append((text, bpy.app.translations.pgettext_iface(text, "GridMesh")))

    def operator(self, *_, **__):
        pass

    def prop(self, data, name, text=None, **_):
        option = data.bl_rna.properties[name]
        say, context = bpy.app.translations.pgettext_iface, option.translation_context
        if text is None:
            self.names.append((option.name, say(option.name, context)))
        if option.type == "ENUM":
            item = option.enum_items[getattr(data, name)]
            self.names.append((item.name, say(item.name, context)))


ENGLISH = re.compile(
    r"\b(the|of|to|side|both|draw|drag|click|keep|line|again|take|away|part|mirror|leave|right|select|body|new|extend"
    r"|trim|hole|start|straight|closed|cancel|cut|plane|surface|stroke|visible|inside)\b",
    re.IGNORECASE,
)
"""Words that no German text has; those of keys are left out."""


def german_tool():
    """Both tools in German: header, status bar and the word at the mouse, while they wait and while they draw."""
    view = bpy.context.preferences.view
    if not bpy.app.build_options.international or "de_DE" not in bpy.app.translations.locales:
        raise NotImplementedError("this Blender has no German")
    language, view.language = view.language, "de_DE"
    view.use_translate_interface = view.use_translate_tooltips = True
    drawing, cutting = modules("draw.interaction"), modules("cut.draw_operator")
    said = []

    def listened(text, *where, told=drawing.told):
        said.append(told(text, *where))
        return said[-1]

    before = drawing.told, cutting.told
    try:
        yield from begin()
        drawing.told = cutting.told = listened
        x, y = stage.middle()
        yield from stroke(ring((x - 60, y), 140, 48), picture="german_draw_1")
        (body,) = bodies()
        yield from stroke(ring((x + 90, y), 70, 30, start=np.pi), picture="german_draw_2")
        yield from stroke(ring((x - 60, y), 50, 30), picture="german_draw_3", shift=True)
        yield from stroke(ring((x - 100, y + 90), 20, 20), keys=("P", "X"))
        yield from stage.picture("german_draw_4")
        header = Names()
        for name, kind in (("draw.tool", "GridMeshDrawTool"), ("cut.tool", "GridMeshCutTool")):
            entry = getattr(modules(name), kind)
            for chosen in (True, False):
                for ob in bodies():
                    ob.select_set(chosen)
                yield from tool(entry.bl_idname)
                with stage.override():
                    now = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT")
                    entry.draw_settings(bpy.context, header, now)
        left = sorted({name for name, german in header.names if name == german})
        assert left == [], f"not German in the header: {left}"
        for ob in bodies():
            ob.select_set(True)
        yield from stroke([(x - 250 + 12 * k, y + 5) for k in range(40)])
        yield from stage.picture("german_cut")
        yield from stage.key("ESC")
        said = [text.replace(f"'{body.name}'", "") for text in said]
        english = {text for text in said if ENGLISH.search(text)}
        assert said, "nothing was said"
        assert not english, f"not German: {sorted(english)}"
    finally:
        drawing.told, cutting.told = before
        view.language = language
        yield from tool("builtin.select_box")


SCENES = (
    install,
    first_body,
    first_newcomer,
    redo_panel,
    update,
    menus,
    sprites,
    long_work,
    batch,
    german,
    german_tool,
)
