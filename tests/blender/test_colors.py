"""Colours of grease-pencil drawings on their bodies: fills, lines, holes."""

import bpy
import numpy as np
import pytest
from drawings import at, circle, grease_pencil
from test_bodies import run, run_one

RED, GREEN, BLUE, BLACK = (0.9, 0.1, 0.2, 1), (0.1, 0.6, 0.3, 1), (0.1, 0.2, 0.9, 1), (0, 0, 0, 1)


def ink(ob, name, line, fill=None, *, stroke=0):
    """Material of a stroke, with a fill if that has a colour."""
    material = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(material)
    style = material.grease_pencil
    style.color = line
    ob.data.materials.append(material)
    drawn = ob.data.layers[0].current_frame().drawing.strokes[stroke]
    drawn.material_index = len(ob.data.materials) - 1
    if fill is not None:
        style.fill_color = fill
        if bpy.app.version >= (5, 2, 0):
            drawn.fill_id = stroke + 1
        else:
            style.show_fill = True
    return material


def colours(body):
    """Colours (v, 4) of the vertices, and how far they are from the axis of the drawing; a tenth less where they are not in its plane."""
    mesh = body.data
    values = np.empty(4 * len(mesh.vertices), np.float32)
    mesh.color_attributes["Color"].data.foreach_get("color", values)
    co = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", co)
    co = co.reshape(-1, 3)
    away = np.linalg.norm(co[:, :2], axis=1)
    return values.reshape(-1, 4), np.where(np.abs(co[:, 2]) < 1e-5, away, 0.9 * away)


@pytest.mark.parametrize("shape", ["BODY", "SHEET"])
def test_the_line_around_a_fill_colours_the_rim(shape):
    ob = grease_pencil([circle()])
    ink(ob, "Ink", BLACK, GREEN)
    body = run_one(shape=shape)
    values, away = colours(body)
    rim = away > 0.985 * away.max()
    assert rim.sum() > 20
    assert np.allclose(values[rim], BLACK)
    assert np.allclose(values[~rim], GREEN)
    (material,) = body.data.materials
    assert material.name == "Ink Colors"
    assert np.allclose(material.diffuse_color, GREEN)
    node = next(node for node in material.node_tree.nodes if node.type == "VERTEX_COLOR")
    assert node.layer_name == "Color"
    assert node.outputs["Color"].links[0].to_node.type == "BSDF_PRINCIPLED"


def test_holes_have_the_colours_of_their_lines():
    ob = grease_pencil([3 * circle(), circle()])
    ink(ob, "Outer", RED)
    ink(ob, "Inner", BLUE, stroke=1)
    values, away = colours(run_one())
    inner, outer = (away > 0.985) & (away < 1.001), away > 2.98
    assert inner.sum() > 10 < outer.sum()
    assert np.allclose(values[inner], BLUE)
    assert np.allclose(values[~inner], RED)


@pytest.mark.parametrize(("line", "fill"), [(RED, None), (BLACK, None), (GREEN, GREEN)])
def test_one_colour_needs_no_attribute(line, fill):
    ob = grease_pencil([3 * circle(), circle()])
    ink(ob, "Ink", line, fill)
    ob.data.layers[0].current_frame().drawing.strokes[1].material_index = 0
    body = run_one()
    assert not body.data.color_attributes
    assert not any(material.name.endswith("Colors") for material in body.data.materials)


def test_an_update_has_the_colours_of_now():
    ob = grease_pencil([circle(), at(circle(), 4, 0, 0)])
    material = ink(ob, "Ink", BLACK, GREEN)
    other = ob.data.layers[0].current_frame().drawing.strokes[1]
    other.material_index = 0
    if bpy.app.version >= (5, 2, 0):
        other.fill_id = 2
    first, second = run()
    assert first.data.materials[0] == second.data.materials[0]
    material.grease_pencil.color = BLUE
    bpy.context.view_layer.objects.active = ob
    ob.select_set(True)
    run(update_existing=True)
    values, away = colours(first)
    assert np.allclose(values[away > 0.985 * away.max()], BLUE)
