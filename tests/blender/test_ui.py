"""Panels, menus and redo panels, drawn into a layout that checks names: Blender draws nothing in background."""

import types

import bpy
import pytest
from drawings import activate, circle, grease_pencil, run_one
from holes import cylinder, edit

from addon.bodies.operator import OBJECT_OT_gridmesh_from_strokes
from addon.bridge.operator import MESH_OT_gridmesh_bridge
from addon.fill.operator import MESH_OT_gridmesh_fill
from addon.live import ui as live_ui
from addon.pictures.operator import OBJECT_OT_gridmesh_from_image
from addon.text import telling
from addon.ui import panels as ui
from addon.ui import patching


class Settings:
    """Properties of a button; those that the operator has not got are refused."""

    def __init__(self, idname):
        group, name = idname.split(".")
        object.__setattr__(self, "rna", getattr(getattr(bpy.ops, group), name).get_rna_type())

    def __setattr__(self, name, value):
        option = self.rna.properties[name]
        if option.type == "ENUM":
            assert value in option.enum_items.keys()  # noqa: SIM118


class Layout:
    """What was drawn, in order."""

    def __init__(self, drawn=None):
        self.drawn = [] if drawn is None else drawn

    def column(self, **_):
        return Layout(self.drawn)

    row = column

    def panel(self, idname, *, default_closed=False):
        self.drawn.append(idname)
        return Layout(self.drawn), Layout(self.drawn)

    def separator(self):
        pass

    def label(self, *, text, icon="NONE", translate=True):
        check_icon(icon)
        self.drawn.append(text)

    def operator(self, idname, *, text="", icon="NONE"):
        check_icon(icon)
        self.drawn.append(idname)
        return Settings(idname)

    def menu(self, idname, *, icon="NONE"):
        check_icon(icon)
        assert hasattr(bpy.types, idname)
        self.drawn.append(idname)

    def template_curve_mapping(self, owner, name):
        assert hasattr(owner, name)
        self.drawn.append(name)

    def prop(self, owner, name):
        assert hasattr(owner, name)
        self.drawn.append(name)


def check_icon(name):
    assert name in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys()  # noqa: SIM118


def panel():
    layout = Layout()
    own = types.SimpleNamespace(layout=layout)
    cls = ui.VIEW3D_PT_gridmesh
    for name in ("_draw_fill", "_draw_strokes"):
        setattr(own, name, getattr(cls, name).__get__(own))
    cls.draw(own, bpy.context)
    return layout.drawn


def test_panel_without_anything():
    activate()
    assert "Select a drawing or a curve" in panel()


def test_panel_with_a_drawing_and_with_a_body():
    grease_pencil([circle()])
    assert "object.gridmesh_from_strokes" in panel()
    run_one()
    assert "object.gridmesh_from_strokes" in panel()


def test_panel_with_a_picture_asks_for_no_drawing():
    ob = bpy.data.objects.new("Reference", None)
    ob.empty_display_type = "IMAGE"
    ob.data = bpy.data.images.new("Reference", 8, 8)
    bpy.context.scene.collection.objects.link(ob)
    activate(ob)
    assert "object.gridmesh_from_image" in panel()
    assert "Select a drawing or a curve" not in panel()


def test_panel_in_edit_mode():
    edit(cylinder())
    own = ["mesh.gridmesh_fill"] * 2 + ["mesh.gridmesh_bridge", "mesh.gridmesh_regrid"]
    assert panel() == own + ["object.gridmesh_cut"] * 2


def test_menu_of_presets():
    menu = types.SimpleNamespace(layout=Layout())
    ui.VIEW3D_MT_gridmesh_presets.draw(menu, bpy.context)
    assert len(menu.layout.drawn) >= 6


@pytest.mark.parametrize("entry", [ui._fill_entry, ui._bridge_entry, ui._stroke_entry])
def test_menu_entries(entry):
    grease_pencil([circle()])
    menu = types.SimpleNamespace(layout=Layout())
    entry(menu, bpy.context)
    assert len(menu.layout.drawn) == (2 if entry is ui._fill_entry else 1)


def options(cls, context=None, **changed):
    """Stand for an operator with its default options."""
    rna = Settings(cls.bl_idname).rna
    own = types.SimpleNamespace(layout=Layout(), bl_idname=cls.bl_idname)
    for option in rna.properties:
        if option.identifier != "rna_type":
            setattr(own, option.identifier, getattr(option, "default", None))
    drawing = ("draw_result", "draw_shape_options", "draw_curve", "draw_sketch_options", "draw_join")
    for name in (*drawing, "_paths"):
        if hasattr(cls, name):
            setattr(own, name, getattr(cls, name).__get__(own))
    for name, value in changed.items():
        assert hasattr(own, name)
        setattr(own, name, value)
    cls.draw(own, context or bpy.context)
    return own.layout.drawn


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"result": "1 body: 4 triangles, 3 ms"},
        {"shape": "SHEET"},
        {"curve": "RING"},
        {"curve": "RING", "follow": True},
        {"use_sides": True, "angle_mode": "FIXED", "resolution": "EDGE_LENGTH"},
    ],
)
def test_redo_panel_of_strokes(changed):
    drawn = options(OBJECT_OT_gridmesh_from_strokes, **changed)
    assert {"shape", "boundary", "use_holes", "collection"} <= set(drawn)
    assert ("edge_length" in drawn) == ("resolution" in changed)


@pytest.mark.parametrize(
    ("shading", "gray"),
    [
        (("SOLID", "MATERIAL"), True),
        (("SOLID", "TEXTURE"), False),
        (("WIREFRAME", "TEXTURE"), True),
        (("MATERIAL", "MATERIAL"), False),
        (None, False),
    ],
)
def test_redo_panel_of_pictures_says_that_the_view_is_gray(shading, gray):
    kind, color = shading or ("", "")
    space = types.SimpleNamespace(shading=types.SimpleNamespace(type=kind, color_type=color))
    drawn = pictured([], types.SimpleNamespace(space_data=space if shading else None))
    assert ("See it in Material Preview" in drawn) == gray
    assert "hide_source" in drawn


def test_redo_panel_of_pictures_hides_nothing_for_files():
    assert "hide_source" not in pictured(["a.png"], types.SimpleNamespace(space_data=None))


def pictured(paths, context):
    return options(OBJECT_OT_gridmesh_from_image, context, _paths=lambda: paths)


def live_panel():
    layout = Layout()
    layout.operator_context = "INVOKE_DEFAULT"  # what others append to the panel is drawn with it
    live_ui.VIEW3D_PT_gridmesh_live.draw(types.SimpleNamespace(layout=layout), bpy.context)
    return layout.drawn


def test_panel_of_a_live_body():
    grease_pencil([circle()])
    run_one(follow=True)
    assert live_panel().count("object.gridmesh_curve") == 1
    bpy.ops.object.gridmesh_curve(shape="RING")
    drawn = live_panel()
    assert drawn.count("object.gridmesh_curve") == 6
    assert "map_curve" in drawn


def test_redo_panel_of_fill():
    drawn = options(MESH_OT_gridmesh_fill, result="Filled 1 hole: 4 triangles, 0 irregular vertices, 1 ms")
    assert drawn[:2] == ["Filled 1 hole: 4 triangles", "0 irregular vertices, 1 ms"]
    assert {"holes", "smooth", "cells", "close_chains"} <= set(drawn)
    assert "max_edges" in options(MESH_OT_gridmesh_fill, holes="ALL")


def test_numbers_in_redo_panels_are_translated_as_a_whole(monkeypatch):
    """Told in halves, the sentence stayed English: "Joined by 9 Reihen"."""
    monkeypatch.setattr(patching, "told", lambda text, _of: telling.translate(text, "de_DE"))
    drawn = options(MESH_OT_gridmesh_bridge, result="Joined by 9 rows: 4 triangles, 1 irregular vertex, 3 ms")
    assert drawn[:2] == ["Verbunden durch 9 Reihen: 4 Dreiecke", "1 unregelmäßiger Punkt, 3 ms"]


@pytest.mark.parametrize("has_tube", [True, False])
def test_redo_panel_of_bridge_says_what_two_loops_alone_have(has_tube):
    drawn = options(MESH_OT_gridmesh_bridge, has_tube=has_tube)
    assert {"rows", "smooth", "twist", "cells"} <= set(drawn)
    assert ("Rows and Twist are for two loops" in drawn) != has_tube


@pytest.mark.parametrize(
    "cls", [MESH_OT_gridmesh_fill, MESH_OT_gridmesh_bridge, OBJECT_OT_gridmesh_from_strokes]
)
def test_every_option_has_a_name_and_a_description(cls):
    for option in Settings(cls.bl_idname).rna.properties:
        if option.identifier == "rna_type" or option.is_hidden:
            continue
        assert option.name
        assert option.description
        assert not option.description.endswith(".")
        for item in getattr(option, "enum_items", ()):
            assert item.description
            assert not item.description.endswith(".")
