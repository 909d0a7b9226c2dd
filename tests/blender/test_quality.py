"""The quality of meshes in numbers: any mesh, closed and open, triangles and others."""

import bpy
import numpy as np
import pytest
from drawings import activate, bean, circle, grease_pencil, run_one

from addon.overlay import ui, viewport
from addon.overlay.quality import measure


def of(ob):
    return viewport.of_object(ob, bpy.context.evaluated_depsgraph_get())


def mesh(points, faces):
    corners = np.concatenate([np.asarray(face) for face in faces])
    return measure(np.asarray(points, float), corners, np.cumsum([0, *map(len, faces)]))


def test_an_icosphere_has_twelve_vertices_of_five_edges():
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    found = of(bpy.context.object)
    assert len(found.irregular) == 12
    assert set(found.valence) == {5}
    assert found.least == 6
    assert found.genus == 0
    assert found.curvature.sum() == pytest.approx(2)
    assert 0.8 < found.worst_angle < np.pi / 3


def test_a_torus_of_quadrilaterals_is_regular():
    bpy.ops.mesh.primitive_torus_add()
    found = of(bpy.context.object)
    assert len(found.irregular) == 0
    assert found.genus == 1
    assert found.sides == 4
    assert found.least == 16  # as a body of quads with a hole has
    bpy.context.object.modifiers.new("Triangulate", "TRIANGULATE")
    assert of(bpy.context.object).least == 9


def test_a_border_counts_half_a_neighbourhood():
    # Two rows of the triangle lattice: the rim of a parallelogram turns at four corners, twice by 60 and 120.
    points = [(x + y / 2, y, 0) for y in range(4) for x in range(5)]
    quads = [(5 * y + x, 5 * y + x + 1, 5 * y + x + 6, 5 * y + x + 5) for y in range(3) for x in range(4)]
    faces = [face for a, b, c, d in quads for face in ((a, b, d), (b, c, d))]
    found = mesh(points, faces)
    assert len(found.irregular) == 4
    assert found.border.all()
    assert sorted(np.round(6 * found.curvature).tolist()) == [1, 1, 2, 2]
    assert found.least == 6
    assert found.borders == 1
    as_quads = mesh(points, quads)
    assert len(as_quads.irregular) == 4
    assert np.allclose(as_quads.curvature, 0.25)


def test_the_numbers_are_those_of_the_maker():
    grease_pencil([bean(), circle(40, 0.3)])
    ob = run_one()
    found = of(ob)
    assert found.genus == 1
    assert found.least == 9
    assert found.non_manifold == 0
    assert found.components == 1
    assert found.curvature.sum() == pytest.approx(0)


def test_the_sharpest_corner_is_named():
    found = mesh([(0, 0, 0), (10, 0, 0), (0, 1, 0), (0, -9, 0)], [(0, 1, 2), (0, 3, 1)])
    assert found.worst_face == 0
    assert found.worst_angle == pytest.approx(np.arctan(0.1))


def test_what_is_no_manifold_is_counted():
    fan = mesh(np.eye(3)[[0, 1, 2, 0, 1]] + np.arange(5)[:, None], [(0, 1, 2), (0, 1, 3), (0, 1, 4)])
    assert fan.non_manifold == 1
    assert fan.genus is None
    assert fan.least is None
    bow = mesh([(0, 0, 0), (1, 1, 0), (1, -1, 0), (-1, 1, 0), (-1, -1, 0)], [(0, 2, 1), (0, 3, 4)])
    assert bow.non_manifold == 1


def test_a_moebius_strip_has_no_genus():
    n = 12
    faces = [(i, (i + 1) % n, n + i) for i in range(n)] + [
        ((i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)
    ]
    strip = faces
    untwisted = mesh(np.random.default_rng(1).normal(size=(2 * n, 3)), strip)
    assert untwisted.genus == 0
    assert untwisted.borders == 2
    # The last quadrilateral is joined to the first with its ends swapped.
    swap = {0: n, n: 0}
    last = [tuple(swap.get(v, v) for v in f) for f in ((n - 1, 0, 2 * n - 1), (0, n, 2 * n - 1))]
    kept = [f for f in strip if not ({f[0], f[1], f[2]} & {n - 1, 2 * n - 1} and {f[0], f[1], f[2]} & {0, n})]
    twisted = mesh(np.random.default_rng(1).normal(size=(2 * n, 3)), kept + last)
    assert twisted.borders == 1
    assert twisted.non_manifold == 0
    assert twisted.genus is None


def test_empty_and_loose():
    found = measure(np.zeros((3, 3)), np.zeros(0, int), np.zeros(1, int))
    assert found.faces == 0
    assert len(found.irregular) == 0
    assert found.worst_face == -1
    assert found.least is None


@pytest.mark.smoke
def test_operator_and_switch():
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
    ob = bpy.context.object
    before = len(bpy.app.handlers.depsgraph_update_post)
    assert bpy.ops.mesh.gridmesh_quality() == {"FINISHED"}
    manager = bpy.context.window_manager
    setattr(manager, ui.SWITCH, True)
    activate(ob)
    setattr(manager, ui.SWITCH, False)
    assert len(bpy.app.handlers.depsgraph_update_post) == before
    assert len(viewport.colours(of(ob))) == 12
    _, dots, colours = viewport._look(ob, bpy.context.evaluated_depsgraph_get())
    assert dots.dtype == colours.dtype == np.float32  # anything else is drawn as if it were
    assert np.allclose(np.linalg.norm(dots, axis=1), 1, atol=0.1)


def test_edit_mode_counts_what_is_being_edited():
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=1)
    assert len(of(bpy.context.object).irregular) == 12
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.delete(type="FACE")
    assert of(bpy.context.object).faces == 0
