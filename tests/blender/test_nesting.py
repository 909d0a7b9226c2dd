"""Strokes inside strokes: holes, islands, and bodies brought up to date with them."""

import json
import string

import bpy
import numpy as np
import pytest
from conftest import ROOT
from drawings import (
    activate,
    at,
    bean,
    check_body,
    circle,
    curve,
    fingerprint,
    grease_pencil,
    linked,
    run,
    run_one,
)
from mathutils import Vector


def drawn(name, size=4.0):
    """(n, 3) points of a drawing made by hand, its longer side `size`, in the plane z = 0."""
    text = (ROOT / f"tests/sketches/drawings/{name}.json").read_text(encoding="utf-8")
    points = np.array(json.loads(text)["points"], float)
    points -= (points.min(axis=0) + points.max(axis=0)) / 2
    points *= size / np.ptp(points, axis=0).max()
    return np.column_stack([points, np.zeros(len(points))])


@pytest.mark.smoke
def test_a_ring_is_the_default():
    grease_pencil([circle(radius=2), circle()])
    check_body(run_one(), genus=1)


@pytest.mark.parametrize("shape", ["BODY", "SHEET"])
def test_without_holes_each_stroke_is_its_own(shape):
    grease_pencil([circle(radius=2), circle()])
    assert len(run(use_holes=False, shape=shape)) == 2


def test_eye_with_iris_and_pupil(capfd):
    """A face with three holes; the island in one has a hole, and an island in it."""
    grease_pencil(
        [
            drawn("whale", 12),
            at(circle(radius=1.2), -3, -1, 0),
            at(bean(size=0.75), -3, -1, 0),
            at(circle(radius=0.35), -3, -1, 0),
            at(circle(radius=0.18), -3, -1, 0),
            at(bean(size=0.5), 0, -2, 0),
            at(circle(radius=0.4), 2.6, -3, 0),
        ]
    )
    face, iris, light = run(triangles=1500)
    check_body(face, genus=3)
    check_body(iris, genus=1)
    check_body(light)
    assert "3 bodies: " in capfd.readouterr().out


GLYPHS = {
    "A": [1],
    "B": [2],
    "8": [2],
    "%": [1, 1, 0],
    "&": [2],
    "®": [1, 1],
    "i": [0, 0],
    "O": [1],
    "Q": [1],
}


@pytest.mark.parametrize("glyph", GLYPHS)
def test_letters_of_a_font(glyph):
    data = bpy.data.curves.new("Text", "FONT")
    data.body = glyph
    linked("Text", data)
    bodies = run(triangles=1200)
    found = []
    for body in bodies:
        edges, faces = len(body.data.edges), len(body.data.polygons)
        found.append((2 - (len(body.data.vertices) - edges + faces)) // 2)
        check_body(body, genus=found[-1])
    assert sorted(found) == sorted(GLYPHS[glyph])


def test_sheet_with_a_hole():
    grease_pencil([drawn("frog"), at(circle(radius=0.2), 0.6, 0.5, 0)])
    sheet = run_one(shape="SHEET")
    mesh = sheet.data
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 0


def test_strokes_that_cross_are_two_bodies_and_it_is_said(capfd):
    grease_pencil([circle(radius=3), at(circle(), 2.8, 0, 0)])
    for body in run():
        check_body(body)
    assert "stroke 2 of 2: it crosses stroke 1 and is no hole in it" in capfd.readouterr().out


def test_holes_that_cross_each_other_are_refused_by_name():
    grease_pencil([circle(radius=3), circle(), at(bean(size=0.8), 0.9, 0, 0)])
    before = fingerprint()
    with pytest.raises(RuntimeError, match=r"stroke 1 of 3: .*hole"):
        bpy.ops.object.gridmesh_from_strokes(triangles=500)
    assert fingerprint() == before


def test_splines_of_a_curve():
    curve([circle(radius=2), at(circle(radius=0.5), 1, 0, 0), at(circle(radius=0.5), -1, 0, 0)])
    check_body(run_one(), genus=2)


class TestHidden:
    """Bodies inside others, which cannot be seen."""

    def face(self):
        """A face with eyes and a mouth on a layer above, the mouth over the rim."""
        eyes = [at(circle(radius=0.3), -0.8, 0.5, 0), at(circle(radius=0.3), 0.8, 0.5, 0)]
        ob = grease_pencil([circle(radius=2)], layer="Face")
        return grease_pencil([*eyes, at(circle(radius=0.5), 0, -2, 0)], layer="Above", ob=ob)

    def test_on_a_layer_above_joining_is_named_and_helps(self, capfd):
        self.face()
        made = run()
        out = capfd.readouterr().out
        assert "2 bodies lie hidden inside others; turn on Join Overlapping Strokes" in out
        for body in made:
            bpy.data.objects.remove(body)
        activate(bpy.data.objects["Drawing"])
        (whole,) = run(use_join=True)
        assert "hidden inside" not in capfd.readouterr().out
        check_body(whole)

    def test_without_holes_they_are_named(self, capfd):
        grease_pencil([circle(radius=2), at(circle(radius=0.3), 0.4, 0.2, 0)])
        run(use_holes=False)
        out = capfd.readouterr().out
        assert "1 body lies hidden inside another; move it forward, or turn on Holes" in out

    def test_other_objects(self, capfd):
        one = grease_pencil([circle(radius=2)], name="One")
        two = grease_pencil([circle(radius=0.5)], name="Two")
        activate(one, two)
        run()
        out = capfd.readouterr().out
        assert "1 body lies hidden inside another; move it forward" in out
        assert "turn on" not in out

    @pytest.mark.parametrize("options", [{"shape": "SHEET"}, {}])
    def test_flat_ones_and_holes_are_not(self, capfd, options):
        if options:
            self.face()
        else:
            grease_pencil([circle(radius=2), circle(radius=1), circle(radius=0.5)])
        run(**options)
        assert "hidden inside" not in capfd.readouterr().out

    def test_moved_forward_they_are_not(self, capfd):
        self.face()
        eyes = run()[1:3]
        assert "hidden inside" in capfd.readouterr().out
        for eye in eyes:
            eye.location += eye.matrix_world.to_3x3() @ Vector((0, 0, 2))
        bpy.context.view_layer.update()
        activate(bpy.data.objects["Drawing"])
        run()
        assert "hidden inside" not in capfd.readouterr().out


class TestUpdate:
    def test_from_the_body_keeps_its_hole(self):
        grease_pencil([circle(radius=2), circle(), at(bean(), 6, 0, 0)])
        ring, other = run()
        count = len(other.data.polygons)
        activate(ring)
        assert run(triangles=900, update_existing=True) == []
        check_body(ring, genus=1)
        assert abs(len(ring.data.polygons) / 1800 - 1) < 0.1
        assert len(other.data.polygons) == count

    def test_bad_strokes_beside_are_not_its_business(self, capfd):
        grease_pencil([circle(radius=2), circle(2)])
        body = run_one()
        capfd.readouterr()
        activate(body)
        run(triangles=900, update_existing=True)
        assert "left out" not in capfd.readouterr().out

    def test_a_body_whose_stroke_became_a_hole(self, capfd):
        ob = grease_pencil([circle(radius=2), circle()])
        outer, inner = run(use_holes=False)
        activate(inner)
        before = fingerprint()
        with pytest.raises(
            RuntimeError, match=r"stroke 2 of 2: it lies inside another stroke(?s:.*)turn off Holes"
        ):
            bpy.ops.object.gridmesh_from_strokes(update_existing=True)
        assert fingerprint() == before
        activate(ob)
        count = len(inner.data.polygons)
        run(update_existing=True)
        check_body(outer, genus=1)
        assert len(inner.data.polygons) == count
        told = capfd.readouterr().out
        assert (
            "stroke 2 of 2: it is a hole now; 'Drawing.mesh.001' was made from it and is left as it is"
            in told
        )


def test_each_letter_of_a_font_in_one_text(capfd):
    """Outlines of fonts may end a little beyond where they began and run back, as that of Q."""
    data = bpy.data.curves.new("Text", "FONT")
    data.body = string.ascii_letters + string.digits
    linked("Text", data)
    bodies = run(triangles=600)
    assert len(bodies) == len(data.body) + 3  # dots of i, j and 0
    assert "left out" not in capfd.readouterr().out
