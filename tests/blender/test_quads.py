"""Bodies of quads in Blender: every operator, live bodies, what is shown of them, and what is refused."""

import json
from collections import Counter
from pathlib import Path

import bmesh
import bpy
import numpy as np
import pytest
from drawings import (
    activate,
    bean,
    bezier_circle,
    circle,
    grease_pencil,
    mesh_objects,
    run_one,
    uv_of,
    vertices,
)
from mathutils.bvhtree import BVHTree

from addon import api
from addon.live import engine
from addon.overlay import viewport
from addon.pictures.cutouts import Options, cut_out


def faces_of(mesh):
    """(f, 4) corners; every face must be a quad."""
    assert {len(polygon.vertices) for polygon in mesh.polygons} == {4}
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return corners.reshape(-1, 4)


def check_quads(ob, contours=1):
    """One closed body, wound outward, of quads with three, four or five at each vertex."""
    quads, points = faces_of(ob.data), vertices(ob.data)
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    directed = set(map(tuple, sides.tolist()))
    assert len(directed) == len(sides)
    assert all((b, a) in directed for a, b in directed), "the mesh has a border"
    assert len(points) - len(sides) // 2 + len(quads) == 4 - 2 * contours
    assert set(np.bincount(quads.ravel()).tolist()) <= {3, 4, 5}
    for triangle in (quads[:, :3], quads[:, [0, 2, 3]]):
        a, b, c = (points[triangle[:, k]] for k in range(3))
        assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0, "inside out"
    assert not ob.data.validate(verbose=True)
    uv = uv_of(ob).reshape(-1, 4, 2)
    assert uv.min() >= 0
    assert uv.max() <= 1
    assert np.ptp(uv, axis=1).max() < 0.2, "a seam runs through a quad"


FOLDER = Path(__file__).parents[1] / "sketches" / "drawings"


def drawing(name):
    outline = np.asarray(json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))["points"], float)
    outline = outline / np.ptp(outline, axis=0).max() * 3
    return np.column_stack([outline, np.zeros(len(outline))])


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.json")))
def test_drawings_become_bodies_of_quads(name):
    grease_pencil([drawing(name)])
    ob = run_one(quads=900)
    check_quads(ob)
    assert abs(len(ob.data.polygons) / 1800 - 1) < 0.1


def test_a_number_of_quads_asks_for_quads_and_other_options_are_what_they_were():
    grease_pencil([bean()])
    assert bpy.ops.object.gridmesh_from_strokes(quads=300) == {"FINISHED"}
    assert len(bpy.context.object.data.polygons) == pytest.approx(600, rel=0.12)
    assert faces_of(bpy.context.object.data).shape[1] == 4


@pytest.mark.parametrize("options", [{}, {"resolution": "EDGE_LENGTH", "edge_length": 0.1}])
def test_the_number_is_automatic_or_follows_from_an_edge_length(options):
    grease_pencil([bean()])
    ob = run_one(cells="QUADS", triangles=500, **{"resolution": "AUTO", **options})
    check_quads(ob)
    lengths = [
        np.linalg.norm(np.subtract(*(ob.data.vertices[v].co[:] for v in edge.vertices)))
        for edge in ob.data.edges
    ]
    assert len(ob.data.polygons) >= 600
    if options:
        assert 0.08 < np.median(lengths) < 0.15  # a body is stretched in the middle


def test_holes_curves_and_sheets():
    grease_pencil([circle(60, 2.0), circle(40, 0.7)])
    drawing = bpy.context.object
    ob = run_one(quads=900)
    check_quads(ob, contours=2)
    activate(drawing)
    sheet = run_one(quads=900, shape="SHEET", update_existing=False)
    assert len(faces_of(sheet.data)) * 2 == len(ob.data.polygons)
    bezier_circle()
    check_quads(run_one(quads=400))


def test_an_updated_body_goes_from_triangles_to_quads_and_back():
    grease_pencil([bean()])
    ob = run_one()
    bpy.ops.object.gridmesh_from_strokes(quads=400)
    check_quads(ob)
    bpy.ops.object.gridmesh_from_strokes(cells="TRIANGLES", triangles=400)
    assert {len(polygon.vertices) for polygon in ob.data.polygons} == {3}
    assert mesh_objects() == [ob]


def test_flat_bodies_are_creased_along_the_rim():
    drawing = grease_pencil([circle(80, 1.0)])
    ob = run_one(quads=500, profile="PEAK")
    sharp = np.array([edge.use_edge_sharp for edge in ob.data.edges])
    quads = faces_of(ob.data)
    rim = sum(1 for edge in ob.data.edges if all(abs(ob.data.vertices[v].co.z) < 1e-6 for v in edge.vertices))
    assert sharp.sum() == rim > 20
    assert len(quads) > 800
    activate(drawing)
    round_one = run_one(quads=500, update_existing=False)
    assert not any(edge.use_edge_sharp for edge in round_one.data.edges)


def check_mirrored(points, normal=0):
    """Every vertex has its image across the middle of an axis."""
    image = points.copy()
    image[:, normal] *= -1
    apart = np.linalg.norm(points[:, None, :2] - image[None, :, :2], axis=2).min(axis=1)
    assert apart.max() < 1e-4 * np.ptp(points)


def test_a_symmetric_drawing_gets_symmetric_quads():
    t = np.linspace(0, 2 * np.pi, 160, endpoint=False)
    radius = 1 + 0.25 * np.sin(t) - 0.1 * np.cos(2 * t) + 0.1 * np.sin(3 * t)
    grease_pencil([np.column_stack([radius * np.cos(t), radius * np.sin(t), 0 * t])])
    sheet = run_one(quads=400, mirror="AUTO", shape="SHEET")
    faces_of(sheet.data)
    check_mirrored(vertices(sheet.data))


@pytest.mark.usefixtures("awake")
class TestLive:
    def live(self, **options):
        source = grease_pencil([bean()])
        ob = run_one(follow=True, **options)
        engine.settle()
        return source, ob

    def drag(self, source, by):
        drawn = source.data.layers[0].current_frame().drawing
        points = bean()
        away = (np.arange(len(points)) - 40) / 4.0
        points = points * (1 + by * np.exp(-0.5 * away**2))[:, None]
        drawn.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
        drawn.tag_positions_changed()
        bpy.context.view_layer.update()

    def test_a_body_follows_with_its_quads_while_it_is_dragged_and_after(self):
        source, ob = self.live(quads=700)
        before = vertices(ob.data)
        for by in (0.1, 0.2, 0.3):
            self.drag(source, by)
            check_quads(ob)
            assert ob.gridmesh_live.digest == ""
        engine.refresh()
        check_quads(ob)
        assert ob.gridmesh_live.digest
        assert len(vertices(ob.data)) != len(before) or not np.allclose(vertices(ob.data), before)

    def test_a_body_made_in_full_is_that_of_the_operator(self):
        source, ob = self.live(quads=700)
        self.drag(source, 0.1)
        engine.refresh()
        activate(source)
        other = run_one(quads=700, update_existing=False)
        assert np.array_equal(faces_of(other.data), faces_of(ob.data))

    def test_faces_are_changed_in_the_panel(self):
        _, ob = self.live(triangles=600)
        ob.gridmesh_live.cells = "QUADS"
        check_quads(ob)
        ob.gridmesh_live.quads = 300
        ob.gridmesh_live.resolution = "TRIANGLES"
        assert len(ob.data.polygons) == pytest.approx(600, rel=0.12)
        ob.gridmesh_live.cells = "TRIANGLES"
        assert {len(polygon.vertices) for polygon in ob.data.polygons} == {3}

    def test_bodies_of_triangles_keep_the_fingerprints_that_they_had(self):
        _, ob = self.live(triangles=600)
        assert "cells" not in ob.gridmesh_live.sketch_options()
        assert "quads" not in ob.gridmesh_live.sketch_options()

    def test_work_by_hand_is_known_and_an_applied_scale_is_not_taken_for_it(self):
        source, ob = self.live(quads=400)
        activate(ob)
        ob.scale = (2.0, 1.0, 1.0)
        bpy.context.view_layer.update()
        bpy.ops.object.transform_apply(scale=True)
        engine.follow(ob, bpy.context.evaluated_depsgraph_get())
        assert not ob.gridmesh_live.problem
        ob.scale = (-1.0, 1.0, 1.0)
        bpy.context.view_layer.update()
        bpy.ops.object.transform_apply(scale=True)
        self.drag(source, 0.05)
        engine.refresh()
        assert not ob.gridmesh_live.problem
        check_quads(ob)
        ob.data.vertices[0].co.z += 0.3
        ob.data.update()
        self.drag(source, 0.1)
        assert ob.gridmesh_live.problem == engine.BY_HAND


class TestRefusals:
    def refused(self, capfd, **options):
        before = len(mesh_objects())
        with pytest.raises(RuntimeError) as error:
            bpy.ops.object.gridmesh_from_strokes(**options)
        assert len(mesh_objects()) == before
        return str(error.value)

    def test_a_drawing_too_thin_names_a_number_of_quads_that_works(self, capfd):
        bar = np.array([[0, 0, 0], [8, 0, 0], [8, 0.1, 0], [0, 0.1, 0]], float)
        grease_pencil([np.repeat(bar, 3, axis=0)])
        text = self.refused(capfd, quads=60)
        number = int(
            "".join(c for c in text.split("follow this drawing; ")[1].split(" work")[0] if c.isdigit())
        )
        check_quads(run_one(quads=number))

    def test_grown_rims_are_refused_and_say_what_works(self, capfd):
        grease_pencil([bean()])
        assert "triangles" in self.refused(capfd, quads=500, boundary="GROWN")


class TestQuality:
    def test_poles_are_counted_and_the_least_is_that_of_the_drawing(self):
        grease_pencil([circle(80, 2.0), circle(40, 0.7)])
        ob = run_one(quads=900)
        found = viewport.of_object(ob, bpy.context.evaluated_depsgraph_get())
        assert found.sides == 4
        assert found.least == 16
        assert "poles (least 16)" in found.text
        assert set(viewport.kinds(found).tolist()) <= {1, 2}
        assert viewport.lines(found)[1].startswith("Poles ")

    def test_a_cube_has_eight_poles_of_three_edges(self):
        bpy.ops.mesh.primitive_cube_add()
        found = viewport.of_object(bpy.context.object, bpy.context.evaluated_depsgraph_get())
        assert len(found.irregular) == found.least == 8
        assert set(viewport.kinds(found).tolist()) == {1}

    def test_a_sheet_of_quads_needs_four_for_each_contour(self):
        grease_pencil([circle(80, 2.0), circle(40, 0.7)])
        ob = run_one(quads=900, shape="SHEET")
        assert viewport.of_object(ob, bpy.context.evaluated_depsgraph_get()).least == 8


def test_pictures_become_quads_with_the_picture_on_them():
    y, x = np.mgrid[0:120, 0:160]
    pixels = np.ones((120, 160, 4), np.float32)
    pixels[..., 3] = ((x - 80) / 70.0) ** 2 + ((y - 60) / 50.0) ** 2 < 1
    for body in (None, {"profile": "round", "depth": 1.0}):
        found = cut_out(pixels, Options(threshold=0.5, quads=400, body=body))
        assert found.faces.shape[1] == 4
        assert abs(len(found.faces) / (400 if body is None else 800) - 1) < 0.25
        assert np.allclose(found.uv, found.vertices[found.faces.ravel(), :2] / [160, 120])


def test_a_quad_counts_as_two_triangles_in_what_is_expected():
    square = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], float)
    sketches, _, _ = api.sketches_of([api.Stroke(square, True, "a", "", 0, 1)], close_gaps=0.2, holes=True)
    assert api.expected_triangles(sketches, {"cells": "quads", "quads": 300}) == 600
    assert api.expected_triangles(sketches, {"cells": "quads", "edge_length": 0.1}) == pytest.approx(800)
    assert api.suggested_edge_length(sketches, 400, "quads") == pytest.approx(0.1)


def median_edge(mesh):
    quads = vertices(mesh)[faces_of(mesh)]
    return float(np.median(np.linalg.norm(quads - np.roll(quads, 1, axis=1), axis=2)))


def evaluated(ob):
    """Vertices after all modifiers, in the drawing's space."""
    mesh = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    found = np.array([(ob.matrix_world @ vertex.co)[:] for vertex in mesh.vertices])
    ob.to_mesh_clear()
    return found


def off_line(points, outline):
    """Distance of each point, in the plane, from a closed line."""
    points, a = points[:, None, :2], outline[:, :2]
    along = np.roll(a, -1, axis=0) - a
    length = np.maximum((along**2).sum(1), np.finfo(float).tiny)
    share = np.clip(((points - a) * along).sum(2) / length, 0, 1)
    return np.linalg.norm(points - a - share[..., None] * along, axis=2).min(1)


class TestSubdivision:
    def subdivided(self, ob):
        """Distance of the rim's vertices, in edges, from the surface after two subdivisions, and which are corners."""
        crease = ob.data.attributes.get("crease_vert")
        corners = np.zeros(len(ob.data.vertices), np.float32)
        if crease is not None:
            crease.data.foreach_get("value", corners)
        points = vertices(ob.data)
        rim = np.flatnonzero(np.abs(points[:, 2]) < 1e-6)
        quads = points[faces_of(ob.data)]
        edge = np.median(np.linalg.norm(quads - np.roll(quads, 1, axis=1), axis=2))
        ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
        depsgraph = bpy.context.evaluated_depsgraph_get()
        tree = BVHTree.FromObject(ob, depsgraph)
        off = np.array([tree.find_nearest(place)[3] for place in points[rim].tolist()]) / edge
        return off, corners[rim] > 0

    @pytest.mark.parametrize("name", ["whale", "guitar", "camel"])
    def test_corners_of_the_drawing_stay_and_the_rim_nearly_so(self, name):
        grease_pencil([drawing(name)])
        off, corners = self.subdivided(run_one(quads=1000))
        assert corners.sum() >= 1
        assert off[corners].max() < 1e-3
        assert np.median(off) < 0.05

    @pytest.mark.parametrize("name", ["whale", "guitar", "camel", "frog", "octopus"])
    def test_a_rim_that_is_fit_for_it_comes_to_lie_on_the_drawing(self, name):
        grease_pencil([drawing(name)])
        ob = run_one(quads=1000, use_subdivision=True)
        check_quads(ob)
        drawn = drawing(name)
        plain = evaluated(ob)
        moved = off_line(plain[np.abs(plain[:, 2]) < 1e-6], drawn)
        edge = median_edge(ob.data)
        assert np.median(moved) > 0.01 * edge, "the rim of the plain mesh is moved for it"
        ob.modifiers.new("Subdivision", "SUBSURF").levels = 2
        smooth = evaluated(ob)
        rim = smooth[np.abs(smooth[:, 2]) < 1e-6 * edge]
        assert len(rim) >= 4 * (np.abs(plain[:, 2]) < 1e-6).sum()
        # All of the smooth rim: between its vertices the drawing has detail of its own.
        off = off_line(rim, drawn) / edge
        assert np.median(off) < 0.005
        # The rim's vertices themselves, but for the few that the mesh has no room for: most in tips of few quads.
        index = np.flatnonzero(np.abs(plain[:, 2]) < 1e-6)
        assert (off_line(smooth[index], drawn) < 0.02 * edge).mean() > 0.93

    def test_multires_keeps_a_body_closed_and_its_rim(self):
        grease_pencil([drawing("whale")])
        ob = run_one(quads=1000, use_subdivision=True)
        drawn, edge, n_faces = drawing("whale"), median_edge(ob.data), len(ob.data.polygons)
        activate(ob)
        ob.modifiers.new("Multires", "MULTIRES")
        for _ in range(2):
            bpy.ops.object.multires_subdivide(modifier="Multires", mode="CATMULL_CLARK")
        ob.modifiers["Multires"].levels = 2
        fine = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        assert len(fine.polygons) == 16 * n_faces
        sides = np.sort([tuple(edge.vertices) for edge in fine.edges], axis=1)
        assert len(np.unique(sides, axis=0)) == len(sides) == 2 * len(fine.polygons)
        smooth = evaluated(ob)
        assert np.isfinite(smooth).all()
        rim = smooth[np.abs(smooth[:, 2]) < 1e-5 * edge]
        assert np.median(off_line(rim, drawn)) < 0.005 * edge

    def test_sharp_rims_stay(self):
        grease_pencil([circle(80, 1.0)])
        off, _ = self.subdivided(run_one(quads=1000, profile="PEAK"))
        assert off.max() < 0.02

    def test_a_live_body_that_loses_its_corner_loses_the_crease(self):
        grease_pencil([drawing("whale")])
        ob = run_one(quads=500)
        assert ob.data.attributes.get("crease_vert") is not None
        bpy.ops.object.gridmesh_from_strokes(quads=500, corner_angle=3.1)
        crease = ob.data.attributes.get("crease_vert")
        assert crease is None or max(item.value for item in crease.data) == 0

    def test_bodies_of_triangles_have_no_creases(self):
        grease_pencil([drawing("whale")])
        assert run_one().data.attributes.get("crease_vert") is None


def test_an_edge_loop_runs_around_a_limb():
    bar = np.array([[-4, -0.5, 0], [4, -0.5, 0], [4, 0.5, 0], [-4, 0.5, 0]], float)
    grease_pencil([bar])
    ob = run_one(quads=600)
    activate(ob)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, True, False)
    bpy.ops.mesh.select_all(action="DESELECT")
    bm = bmesh.from_edit_mesh(ob.data)
    middle = min(
        (
            edge
            for edge in bm.edges
            if abs(edge.verts[0].co.x - edge.verts[1].co.x) < 0.3 * edge.calc_length()
        ),
        key=lambda edge: sum(vertex.co.xy.length - 10 * vertex.co.z for vertex in edge.verts),
    )
    middle.select_set(True)
    bmesh.update_edit_mesh(ob.data)
    if "select_edge_loop_multi" in dir(bpy.ops.mesh):
        bpy.ops.mesh.select_edge_loop_multi()
    else:
        bpy.ops.mesh.loop_multi_select(ring=False)
    loop = [edge for edge in bm.edges if edge.select]
    ends = Counter(vertex for edge in loop for vertex in edge.verts)
    assert set(ends.values()) == {2}, "the loop is not closed"
    assert len(loop) >= 8
    assert all(len(vertex.link_edges) == 4 for vertex in ends)
    assert np.ptp([vertex.co.x for vertex in ends]) < 1
    assert min(vertex.co.z for vertex in ends) < -0.2 < 0.2 < max(vertex.co.z for vertex in ends)
