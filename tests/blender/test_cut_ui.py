"""How the operator shows itself: texts, menu entries."""

import types

import bpy
import numpy as np
import pytest
from cuts import stroke_object
from drawings import activate
from test_ui import Layout

from addon.cut import cutting, draw_operator
from addon.cut.cutobject import Target
from addon.cut.cutsweep import CutError, Sweep
from addon.text import telling
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


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ([(-3, -2, 0), (3, -2, 0)], "Click: keep this side"),
        ([(-3, -2, 5), (3, -2, 5)], "The line crosses no selected mesh    D: draw again"),
        ([(-1, -2, -1), (1, -2, 1), (-1, -2, 1), (1, -2, -1)], "The stroke meets itself"),
        ([(0, -2, 0), (0.5, -2, 0), (0.5, -2, 0.5), (0, -2, 0)], "Click: keep this side"),
        (
            [(5, -2, 0), (6, -2, 0), (6, -2, 1), (5, -2, 0)],
            "The line crosses no selected mesh    D: draw again",
        ),
        ([(0, -2, 0), (0.5, -2, 0.5), (0, -2, 0.5), (0.5, -2, 0), (0, -2, 0)], "The stroke meets itself"),
    ],
)
def test_a_drawn_line_that_cuts_nothing_is_said_why(line, said):
    bpy.ops.mesh.primitive_cube_add()
    target, problems = Target(bpy.context.object), None
    try:
        own, sweep = target.line(
            np.array(line, float), Sweep(np.array([0, 1, 0.0])), cyclic=False, close_gaps=0.0
        )
        cutting.reach(target.model, own, sweep)
    except CutError as error:
        problems = [error]
    told = draw_operator.status(problems)
    assert told.startswith(said)
    assert "Esc: cancel" in told
    german = telling.translate(told, "de_DE")
    assert german.endswith("Esc: abbrechen")
    assert not {"line", "stroke", "mesh", "again"} & set(german.split())
