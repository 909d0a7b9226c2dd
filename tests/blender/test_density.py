"""Enough triangles for thin parts: chosen by default, told where there are too few, mended by a button; UV layouts."""

import bpy
import numpy as np
import pytest
from drawings import activate, grease_pencil, vertices

from addon.bodies import density
from addon.bodies.operator import OBJECT_OT_gridmesh_from_strokes
from addon.live import engine, refine
from addon.text import entries
from addon.ui import preset_files


def snake(width=0.05):
    """A ball with a long thin arm, (n, 3) in the plane y = 0."""
    t = np.linspace(-np.pi / 2, np.pi / 2, 12)
    ball = np.linspace(np.pi - 0.1, -np.pi + 0.1, 60)
    cap = width / 2 * np.c_[np.cos(t), np.sin(t)] + [2, 0]
    body = 0.6 * np.c_[-np.cos(ball), np.sin(ball)]
    flat = np.r_[body, cap]
    return np.c_[flat[:, 0], np.zeros(len(flat)), flat[:, 1]]


def made(**options):
    activate(grease_pencil([snake()]))
    assert bpy.ops.object.gridmesh_from_strokes(use_union=True, **options) == {"FINISHED"}
    return bpy.context.view_layer.objects.active


def sides(ob):
    return len(ob.data.polygons) // 2


def test_the_default_is_automatic_and_scripts_that_give_a_number_mean_it():
    automatic = sides(made())
    assert automatic > 2500
    for triangles in (3000, 4000):
        assert abs(sides(made(triangles=triangles)) / triangles - 1) <= 0.1
    assert abs(sides(made(triangles=3000, resolution="AUTO")) / automatic - 1) <= 0.1


def test_thin_parts_are_told_and_mended(capfd):
    ob = made(triangles=800, follow=True)
    assert "across; " in capfd.readouterr().out
    depsgraph = bpy.context.evaluated_depsgraph_get()
    engine.remake(ob)
    found = refine.of_body(ob, depsgraph)
    assert found.is_low
    assert found.across < density.ENOUGH
    assert found.wanted > 800
    assert bpy.ops.object.gridmesh_refine() == {"FINISHED"}
    assert ob.gridmesh_live.resolution == "AUTO"
    after = refine.of_body(ob, bpy.context.evaluated_depsgraph_get())
    assert after.across > 4.5
    assert not after.is_low


def mean_edges(ob):
    """Mean edge length of the arm and of the ball."""
    mesh = ob.data
    points = np.array([v.co[:] for v in mesh.vertices]) + np.array(ob.location)
    edges = np.array([e.vertices[:] for e in mesh.edges])
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    middles = 0.5 * (points[edges[:, 0]] + points[edges[:, 1]])[:, 0]
    return lengths[middles > 0.8].mean(), lengths[middles < 0.4].mean()


@pytest.mark.parametrize("cells", ["TRIANGLES", "QUADS"])
def test_thin_parts_have_smaller_faces_where_that_is_asked_for(cells):
    ratios = []
    for detail in (0.0, 0.5, 1.0):
        ob = made(cells=cells, resolution="TRIANGLES", triangles=4000, quads=2000, detail=detail)
        arm, ball = mean_edges(ob)
        ratios.append(arm / ball)
    assert ratios[2] < 0.8 * ratios[0]
    assert ratios[2] < 0.95 * ratios[1]


@pytest.mark.parametrize("options", [{"bend": 0.0}, {"boundary": "GROWN"}, {"angle_mode": "FIXED"}])
def test_detail_is_without_effect_on_a_straight_grid(options):
    plain = made(resolution="TRIANGLES", triangles=4000, **options)
    detailed = made(resolution="TRIANGLES", triangles=4000, detail=1.0, **options)
    assert np.array_equal(vertices(plain.data), vertices(detailed.data))


@pytest.mark.parametrize("layout", ["APART", "SHARED"])
def test_uv_layout(layout):
    ob = made(triangles=1500, uv_layout=layout)
    uv = np.empty(len(ob.data.loops) * 2, np.float32)
    ob.data.uv_layers.active.uv.foreach_get("vector", uv)
    front, back = uv.reshape(2, -1, 3, 2)
    same = np.array_equal(front, back[:, [0, 2, 1]])
    assert same == (layout == "SHARED")
    assert uv.min() >= 0
    assert uv.max() <= 1


def test_every_entry_has_its_own_tooltip():
    class Entry:
        def __init__(self, **values):
            self.values = values

        def is_property_set(self, name):
            return name in self.values

        def __getattr__(self, name):
            return self.values[name]

    shipped = preset_files.shipped(entries.STROKES)
    texts = [entries.described(Entry(source="OBJECTS", **values)) for values in shipped.values()]
    texts += [entries.described(Entry(source="OBJECTS")), entries.described(Entry(update_existing=True))]
    assert shipped.keys() == entries.PRESETS.keys()
    assert len(set(texts)) == len(shipped) + 2
    plain = OBJECT_OT_gridmesh_from_strokes.description(bpy.context, Entry(source="OBJECTS"))
    assert plain == entries.OWN
