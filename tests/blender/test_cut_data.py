"""What a mesh carries besides its shape goes on over a cut: UVs, colours, weights, shape keys, marks."""

import bpy
import numpy as np
import pytest
from cuts import attribute, caps, check_sound, corner_vertices, cut, line, rich_cylinder, stroke_object
from drawings import activate, uv_of, vertices
from holes import edit, leave

SLANTED = line((-3, 0, -0.1), (3, 0, 0.35), 30, wave=0.08)
OFF = {0.0: 1e-4, 0.12: 0.02}
"""By edge length how far values may be off: where the rim is rebuilt it lies on chords of the cylinder."""


@pytest.fixture(
    params=[(0.0, "TRIANGLES"), (0.12, "TRIANGLES"), (0.12, "QUADS")], ids=["exact", "even", "quads"]
)
def pieces(request):
    length, cells = request.param
    found = cut(rich_cylinder(), SLANTED, edge_length=length, cells=cells)
    for piece in found:
        check_sound(piece)
    return found, OFF[length]


def share(ob):
    return (basis(ob)[:, 2] + 1) / 2


def basis(ob):
    return positions(ob.data.shape_keys.key_blocks["Basis"])


def positions(key):
    points = np.empty(len(key.data) * 3, np.float32)
    key.data.foreach_get("co", points)
    return points.reshape(-1, 3).astype(float)


def rim_and_model(ob):
    """Vertices that are not inside a cap."""
    on = np.zeros(len(ob.data.vertices), bool)
    for polygon in ob.data.polygons:
        if not polygon.select:
            on[list(polygon.vertices)] = True
    return on


@pytest.mark.smoke
def test_weights_and_numbers_of_vertices(pieces):
    found, off = pieces
    for ob in found:
        expected = share(ob)
        on = rim_and_model(ob)
        weights = np.array([{g.group: g.weight for g in v.groups}.get(0, np.nan) for v in ob.data.vertices])
        for values in (weights, attribute(ob.data, "height")[:, 0]):
            assert np.abs(values - expected)[on].max() < off
            # Inside the caps harmonic: here that is nearly the height again, and never out of range.
            assert np.isfinite(values).all()
            rim = values[on & np.isin(np.arange(len(on)), [i for p in caps(ob) for i in p.vertices])]
            assert values[~on].min() >= rim.min() - 1e-5
            assert values[~on].max() <= rim.max() + 1e-5
            assert np.abs(values - expected)[~on].max() < 0.1


@pytest.mark.smoke
def test_shape_keys(pieces):
    found, off = pieces
    for ob in found:
        keys = ob.data.shape_keys.key_blocks
        assert [key.name for key in keys] == ["Basis", "lean", "wide"]
        assert np.array_equal(basis(ob), vertices(ob.data))
        x, y, z = basis(ob).T
        lean, wide = positions(keys["lean"]), positions(keys["wide"])
        on = rim_and_model(ob)
        assert np.abs(lean - np.column_stack([x + z, y, z]))[on].max() < 2 * off
        assert np.abs(wide - np.column_stack([2 * x, 2 * y, z]))[on].max() < 2 * off
        assert np.abs(wide - np.column_stack([2 * x, 2 * y, z]))[~on].max() < 0.1


def test_uvs_of_the_sides(pieces):
    found, off = pieces
    for ob in found:
        mesh = ob.data
        index, uv, z = corner_vertices(mesh), uv_of(ob), share(ob)
        for polygon in mesh.polygons:
            if polygon.select or abs(polygon.normal.z) > 0.9:
                continue
            loops = list(polygon.loop_indices)
            assert np.abs(uv[loops, 1] - z[index[loops]]).max() < off
            # No face reaches over the seam: u runs over a twelfth of the turn at most.
            assert np.ptp(uv[loops, 0]) < 0.1
            angle = np.arctan2(*vertices(mesh)[index[loops]].T[[1, 0]]) / (2 * np.pi)
            away = (uv[loops, 0] - angle + 0.5) % 1 - 0.5
            assert np.abs(away).max() < 0.01 + off


def test_uvs_of_caps(pieces):
    """Caps lie unrolled in the unit square, without distortion."""
    for ob in pieces[0]:
        uv, places, index = uv_of(ob), vertices(ob.data), corner_vertices(ob.data)
        ratios = []
        for polygon in caps(ob):
            loops = list(polygon.loop_indices)
            assert uv[loops].min() >= -1e-6
            assert uv[loops].max() <= 1 + 1e-6
            for a, b in zip(loops, loops[1:] + loops[:1], strict=True):
                ratios.append(
                    np.linalg.norm(uv[a] - uv[b]) / np.linalg.norm(places[index[a]] - places[index[b]])
                )
        assert max(ratios) < 1.1 * min(ratios)
        assert np.ptp(uv[[i for p in caps(ob) for i in p.loop_indices]], axis=0).max() > 0.9


def test_colours_of_corners(pieces):
    found, off = pieces
    for ob in found:
        mesh = ob.data
        index, z, colors = corner_vertices(mesh), share(ob), attribute(mesh, "Shade", 4)
        on = rim_and_model(ob)[index]
        assert np.abs(colors[:, 0] - z[index])[on].max() < off
        assert np.abs(colors[:, 0] - z[index])[~on].max() < 0.1
        assert np.allclose(colors[:, 3], 1, atol=1e-5)


def test_numbers_of_corners_are_not_mixed(pieces):
    for ob in pieces[0]:
        values = np.empty(len(ob.data.loops), np.int32)
        ob.data.attributes["column"].data.foreach_get("value", values)
        assert set(values.tolist()) <= set(range(24))


def test_seams_and_sharp_edges_go_on():
    for ob in cut(rich_cylinder(), SLANTED):
        marked = [edge for edge in ob.data.edges if edge.use_seam]
        places = vertices(ob.data)
        height = sorted(float(places[i][2]) for edge in marked for i in edge.vertices)
        ends = (-1.0, 1.0)
        assert min(abs(height[0] - ends[0]), abs(height[-1] - ends[1])) < 1e-6
        length = sum(np.linalg.norm(places[a] - places[b]) for a, b in (edge.vertices for edge in marked))
        assert length == pytest.approx(height[-1] - height[0], abs=1e-5)
        assert all(edge.use_edge_sharp for edge in marked)
        on_cut = [i for edge in marked for i in edge.vertices if abs(abs(places[i][2]) - 1) > 1e-6]
        assert on_cut


def test_smooth_model_gets_sharp_rims():
    for ob in cut(rich_cylinder(), SLANTED, edge_length=0.12):
        assert all(polygon.use_smooth for polygon in ob.data.polygons)
        sides = {}
        for polygon in ob.data.polygons:
            for pair in polygon.edge_keys:
                sides.setdefault(tuple(sorted(pair)), []).append(polygon.select)
        for edge in ob.data.edges:
            if len(set(sides[tuple(sorted(edge.vertices))])) == 2:
                assert edge.use_edge_sharp


def test_flat_model_gets_no_marks():
    bpy.ops.mesh.primitive_cube_add()
    for ob in cut(bpy.context.object, SLANTED, edge_length=0.12):
        assert not any(edge.use_edge_sharp for edge in ob.data.edges)
        assert not any(polygon.use_smooth for polygon in ob.data.polygons)


def test_tangent_caps_are_not_marked():
    for ob in cut(rich_cylinder(), SLANTED, edge_length=0.12, smooth="TANGENT"):
        assert sum(edge.use_edge_sharp for edge in ob.data.edges) < 20


def test_cut_is_where_the_shape_keys_show_the_model():
    """In Object Mode the stroke is drawn over the mix of the shape keys."""
    ob = rich_cylinder()
    ob.data.shape_keys.key_blocks["lean"].value = 1.0
    (piece,) = cut(ob, line((0.5, 0, -3), (0.5, 0, 3)), keep="RIGHT")
    check_sound(piece)
    lean = positions(ob.data.shape_keys.key_blocks["lean"])
    assert lean[:, 0].min() == pytest.approx(0.5, abs=1e-5)
    assert basis(ob)[:, 0].min() < -0.4


def test_active_shape_key_is_cut_in_edit_mode():
    ob = rich_cylinder()
    ob.active_shape_key_index = 2  # twice as wide
    stroke = stroke_object(line((1.5, 0, -3), (1.5, 0, 3)))
    activate(ob, stroke)
    edit(ob)
    stroke.select_set(True)
    bpy.ops.object.gridmesh_cut(direction="Y", keep="RIGHT")
    leave()
    check_sound(ob)
    keys = ob.data.shape_keys.key_blocks
    assert positions(keys["wide"])[:, 0].min() == pytest.approx(1.5, abs=1e-5)
    assert basis(ob)[:, 0].min() == pytest.approx(0.75, abs=1e-5)


def test_face_sets():
    ob = rich_cylinder()
    layer = ob.data.attributes.new(".sculpt_face_set", "INT", "FACE")
    for item in layer.data:
        item.value = 3
    for piece in cut(ob, SLANTED):
        sets = [item.value for item in piece.data.attributes[".sculpt_face_set"].data]
        assert {sets[polygon.index] for polygon in caps(piece)} == {4}
        assert {s for s, p in zip(sets, piece.data.polygons, strict=True) if not p.select} == {3}
