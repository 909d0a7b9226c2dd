"""How the operator shows itself: texts, menu entries."""

import types

import bpy
from cuts import stroke_object
from drawings import activate
from test_ui import Layout

from addon.ui import panels as ui


def test_texts():
    rna = bpy.ops.object.gridmesh_cut.get_rna_type()
    assert rna.name == "Cut & Cap"
    assert not rna.description.endswith(".")
    shown = [option for option in rna.properties if option.identifier != "rna_type" and not option.is_hidden]
    assert len(shown) > 10
    for option in shown:
        assert option.description, option.identifier
        assert not option.description.endswith(".")
        for item in getattr(option, "enum_items", ()):
            assert item.description
            assert not item.description.endswith(".")


def test_menu_entries():
    menu = types.SimpleNamespace(layout=Layout())
    activate(stroke_object([(0, 0, 0), (1, 0, 0)]))
    ui._cut_entry(menu, bpy.context)
    assert menu.layout.drawn == []
    bpy.ops.mesh.primitive_cube_add()
    ui._cut_entry(menu, bpy.context)
    assert menu.layout.drawn == ["object.gridmesh_cut"]
    activate(bpy.context.object, stroke_object([(0, 0, 0), (1, 0, 0)]))
    activate(bpy.data.objects["Cube"], bpy.data.objects["Curve"])
    ui._cut_entry(menu, bpy.context)
    assert len(menu.layout.drawn) == 3
