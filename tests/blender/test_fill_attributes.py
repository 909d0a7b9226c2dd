"""What a patch takes over from the mesh around it."""

import bpy
import numpy as np
import pytest
from drawings import vertices
from holes import (
    Before,
    ball_with_hole,
    cylinder,
    edit,
    faces_of,
    fill,
    grid,
    leave,
    rim,
    select,
    without_faces,
)

from addon.data.attributes import settle


def pierced(n=8, size=2.0):
    """A grid with a square hole in its middle."""
    return without_faces(grid(n), lambda c: max(abs(c.x), abs(c.y)) > size)


def filled(ob, **options):
    """Fill the inner hole of a mesh in Object Mode, and return the patch's faces."""
    before = Before(ob)
    bm = edit(ob)
    select(ob, [edge for edge in rim(bm) if all(abs(v.co.x) < 3.5 and abs(v.co.y) < 3.5 for v in edge.verts)])
    fill(**options)
    leave()
    return range(len(before.faces), len(ob.data.polygons)), len(before.points)


def corners(mesh, faces):
    return [corner for face in faces for corner in mesh.polygons[face].loop_indices]


class TestFaces:
    def test_material_of_most_neighbours_and_smoothness(self):
        ob = pierced()
        for name in "AB":
            ob.data.materials.append(bpy.data.materials.new(name))
        ob.data.shade_smooth()
        for polygon in ob.data.polygons:
            polygon.material_index = int(polygon.center.x < 2.6)
            polygon.use_smooth = polygon.center.y < 2.4
        faces, _ = filled(ob)
        assert {ob.data.polygons[face].material_index for face in faces} == {1}
        assert all(ob.data.polygons[face].use_smooth for face in faces)

    def test_flat_neighbours(self):
        ob = pierced()
        ob.data.shade_flat()
        faces, _ = filled(ob)
        assert not any(ob.data.polygons[face].use_smooth for face in faces)

    def test_wire_loop_has_the_active_material(self):
        mesh = bpy.data.meshes.new("Wire")
        n = 12
        t = np.linspace(0, 2 * np.pi, n, endpoint=False)
        points = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
        mesh.from_pydata(points.tolist(), [(k, (k + 1) % n) for k in range(n)], [])
        ob = bpy.data.objects.new("Wire", mesh)
        bpy.context.scene.collection.objects.link(ob)
        for name in "AB":
            mesh.materials.append(bpy.data.materials.new(name))
        ob.active_material_index = 1
        bm = edit(ob)
        select(ob, bm.edges)
        fill()
        leave()
        assert {polygon.material_index for polygon in mesh.polygons} == {1}

    def test_new_face_set(self):
        ob = pierced()
        sets = ob.data.attributes.new(".sculpt_face_set", "INT", "FACE")
        sets.data.foreach_set("value", np.arange(len(ob.data.polygons), dtype=np.int32) % 3 + 1)
        faces, _ = filled(ob)
        values = {ob.data.attributes[".sculpt_face_set"].data[face].value for face in faces}
        assert values == {4}

    def test_custom_attribute_of_faces_is_that_of_a_neighbour(self):
        ob = pierced()
        ids = ob.data.attributes.new("part", "INT", "FACE")
        ids.data.foreach_set("value", np.full(len(ob.data.polygons), 7, np.int32))
        faces, _ = filled(ob)
        assert {ob.data.attributes["part"].data[face].value for face in faces} == {7}


class TestUv:
    def test_planar_map_goes_on(self):
        """Harmonic extension of a linear map over a flat patch: linear but for the spacing of the grid."""
        ob = pierced()
        layer = ob.data.uv_layers.new(name="Map")
        for loop in ob.data.loops:
            co = ob.data.vertices[loop.vertex_index].co
            layer.uv[loop.index].vector = (co.x / 8 + 0.5, co.y / 8 + 0.5)
        faces, _ = filled(ob)
        mesh = ob.data
        uv = mesh.uv_layers["Map"].uv
        for corner in corners(mesh, faces):
            co = mesh.vertices[mesh.loops[corner].vertex_index].co
            assert np.allclose(uv[corner].vector, (co.x / 8 + 0.5, co.y / 8 + 0.5), atol=0.03)

    def test_seam_is_closed_where_the_map_is_whole(self):
        ob = ball_with_hole()
        faces, n = filled_all(ob)
        mesh = ob.data
        uv = mesh.uv_layers.active.uv
        assert uv_range(mesh, faces)[0] >= uv_range(mesh, range(faces.start))[0] - 1e-6
        by_vertex = {}
        for corner in corners(mesh, range(faces.start)):
            by_vertex.setdefault(mesh.loops[corner].vertex_index, []).append(np.array(uv[corner].vector))
        joined = []
        for corner in corners(mesh, faces):
            vertex = mesh.loops[corner].vertex_index
            if vertex < n:
                apart = min(abs(value - uv[corner].vector).max() for value in by_vertex[vertex])
                joined.append(apart < 1e-5)
        assert all(joined)

    def test_islands_that_meet_at_the_hole(self, capfd):
        """The map is torn in two places of the loop: one stretch is continued, in range, and that is said."""
        ob = pierced()
        layer = ob.data.uv_layers.new(name="Map")
        for polygon in ob.data.polygons:
            for corner in polygon.loop_indices:
                co = ob.data.vertices[ob.data.loops[corner].vertex_index].co
                layer.uv[corner].vector = (
                    co.x / 16 + (0.75 if polygon.center.x > 0 else 0.25),
                    co.y / 8 + 0.5,
                )
        before = uv_range(ob.data, range(len(ob.data.polygons)))
        faces, _ = filled(ob)
        after = uv_range(ob.data, faces)
        assert before[0] <= after[0] <= after[1] <= before[1]
        assert (
            "UVs or colours are torn at 1 hole: continued from the longest stretch" in capfd.readouterr().out
        )

    def test_every_layer(self):
        ob = pierced()
        for k in range(3):
            layer = ob.data.uv_layers.new(name=f"Map {k}")
            layer.uv.foreach_set("vector", np.full(2 * len(ob.data.loops), 0.1 * (k + 1), np.float32))
        faces, _ = filled(ob)
        for k in range(3):
            uv = ob.data.uv_layers[f"Map {k}"].uv
            assert all(np.allclose(uv[corner].vector, 0.1 * (k + 1)) for corner in corners(ob.data, faces))


def uv_range(mesh, faces):
    uv = np.array([mesh.uv_layers.active.uv[corner].vector for corner in corners(mesh, faces)])
    return uv.min(), uv.max()


def filled_all(ob):
    before = Before(ob)
    edit(ob)
    fill(holes="ALL", max_edges=0)
    leave()
    before.check(ob)
    return range(len(before.faces), len(ob.data.polygons)), len(before.points)


class TestVertices:
    def test_weights(self):
        ob = pierced()
        whole, left = ob.vertex_groups.new(name="Whole"), ob.vertex_groups.new(name="Left")
        other = ob.vertex_groups.new(name="Far")
        for vertex in ob.data.vertices:
            whole.add([vertex.index], 1.0, "REPLACE")
            if vertex.co.x < -1:
                left.add([vertex.index], 0.8, "REPLACE")
            if vertex.co.y > 3.5:
                other.add([vertex.index], 1.0, "REPLACE")
        _, n = filled(ob)
        new = ob.data.vertices[n:]
        weights = [{g.group: g.weight for g in vertex.groups} for vertex in new]
        assert new
        for vertex, weight in zip(new, weights, strict=True):
            assert np.isclose(weight[whole.index], 1.0, atol=1e-5)
            assert 0 <= weight.get(left.index, 0) <= 0.8 + 1e-6
            assert other.index not in weight
            if vertex.co.x < -1:
                assert weight[left.index] > 0.3
        for vertex in ob.data.vertices[:n]:
            assert np.isclose(whole.weight(vertex.index), 1.0)

    @pytest.mark.parametrize("domain", ["POINT", "CORNER"])
    @pytest.mark.parametrize("kind", ["FLOAT_COLOR", "BYTE_COLOR"])
    def test_colours(self, domain, kind):
        ob = pierced()
        colors = ob.data.color_attributes.new("Paint", kind, domain)
        ids = (
            [loop.vertex_index for loop in ob.data.loops]
            if domain == "CORNER"
            else range(len(ob.data.vertices))
        )
        for item, vertex in zip(colors.data, ids, strict=True):
            item.color = (ob.data.vertices[vertex].co.x / 8 + 0.5, 0.25, 0.5, 1.0)
        faces, n = filled(ob)
        colors = ob.data.color_attributes["Paint"]
        new = corners(ob.data, faces) if domain == "CORNER" else range(n, len(ob.data.vertices))
        seen = np.array([colors.data[k].color for k in new])
        assert len(seen)
        assert np.allclose(seen[:, 1:], (0.25, 0.5, 1.0), atol=0.02)
        assert seen[:, 0].min() >= 0.2
        assert seen[:, 0].max() <= 0.8
        assert np.ptp(seen[:, 0]) > 0.1

    def test_numbers_of_its_own(self):
        ob = pierced()
        n = len(ob.data.vertices)
        heat = ob.data.attributes.new("heat", "FLOAT", "POINT")
        heat.data.foreach_set("value", np.array([v.co.x for v in ob.data.vertices], np.float32))
        flow = ob.data.attributes.new("flow", "FLOAT_VECTOR", "POINT")
        flow.data.foreach_set("vector", np.tile([1, 2, 3], n).astype(np.float32))
        same = ob.data.attributes.new("same", "INT", "POINT")
        same.data.foreach_set("value", np.full(n, 5, np.int32))
        mixed = ob.data.attributes.new("mixed", "INT", "POINT")
        mixed.data.foreach_set("value", np.arange(n, dtype=np.int32))
        _, n = filled(ob)
        get = ob.data.attributes
        new = range(n, len(ob.data.vertices))
        assert all(abs(get["heat"].data[k].value) <= 2.0 for k in new)
        assert (
            np.corrcoef([get["heat"].data[k].value for k in new], [ob.data.vertices[k].co.x for k in new])[
                0, 1
            ]
            > 0.9
        )
        assert all(np.allclose(get["flow"].data[k].vector, (1, 2, 3)) for k in new)
        assert {get["same"].data[k].value for k in new} == {5}
        assert {get["mixed"].data[k].value for k in new} == {0}

    def test_creases_are_kept_and_not_smeared(self):
        ob = pierced()
        edge_creases = ob.data.attributes.new("crease_edge", "FLOAT", "EDGE")
        edge_creases.data.foreach_set("value", np.ones(len(ob.data.edges), np.float32))
        point_creases = ob.data.attributes.new("crease_vert", "FLOAT", "POINT")
        point_creases.data.foreach_set("value", np.ones(len(ob.data.vertices), np.float32))
        m = len(ob.data.edges)
        _, n = filled(ob)
        values = np.array([d.value for d in ob.data.attributes["crease_edge"].data])
        assert (values[:m] == 1).all()
        assert (values[m:] == 0).all()
        values = np.array([d.value for d in ob.data.attributes["crease_vert"].data])
        assert (values[:n] == 1).all()
        assert (values[n:] == 0).all()

    def test_custom_normals_of_the_mesh_are_kept(self):
        ob = pierced()
        ob.data.normals_split_custom_set([(0.6, 0, 0.8)] * len(ob.data.loops))
        before = normals(ob.data)
        filled(ob)
        after = normals(ob.data)
        apart = np.linalg.norm(after[: len(before)] - before, axis=1)
        # Corners at the loop share a fan with the patch now: theirs may turn a little.
        away = ~np.isin(*corners_at_loop(ob.data, len(before)))
        assert apart[away].max() < 0.01
        assert np.isfinite(after).all()
        assert np.allclose(np.linalg.norm(after, axis=1), 1, atol=1e-3)

    def test_nan_weightless_layer_is_told(self, capfd):
        ob = pierced()
        heat = ob.data.attributes.new("heat", "FLOAT", "POINT")
        heat.data.foreach_set("value", np.full(len(ob.data.vertices), np.nan, np.float32))
        filled(ob)
        assert "1 layer of data not continued: a value at a hole is not finite" in capfd.readouterr().out


def normals(mesh):
    return np.array([item.vector for item in mesh.corner_normals])


def corners_at_loop(mesh, n_old):
    """Vertices of the old corners, and those of the new ones."""
    at = np.array([loop.vertex_index for loop in mesh.loops])
    return at[:n_old], at[n_old:]


class TestShapeKeys:
    def keyed(self):
        ob = ball_with_hole()
        ob.shape_key_add(name="Basis")
        tall = ob.shape_key_add(name="Tall", from_mix=False)
        moved = ob.shape_key_add(name="Moved", from_mix=False)
        for key, change in (
            (tall, lambda co: (co.x, co.y, 3 * co.z)),
            (moved, lambda co: (co.x + 5, co.y, co.z)),
        ):
            for point in key.data:
                point.co = change(point.co)
        return ob

    def key(self, ob, name):
        data = ob.data.shape_keys.key_blocks[name].data
        points = np.empty(len(data) * 3, np.float32)
        data.foreach_get("co", points)
        return points.reshape(-1, 3).astype(float)

    @pytest.mark.parametrize("active", [0, 1, 2])
    def test_every_key_is_solved_like_the_positions(self, active):
        ob = self.keyed()
        n = len(ob.data.vertices)
        before = {name: self.key(ob, name) for name in ("Basis", "Tall", "Moved")}
        ob.active_shape_key_index = active
        edit(ob)
        fill(holes="ALL", max_edges=0)
        leave()
        after = {name: self.key(ob, name) for name in before}
        for name, points in before.items():
            assert np.array_equal(after[name][:n], points)
        if active == 0:
            alone = ball_with_hole()
            edit(alone)
            fill(holes="ALL", max_edges=0)
            leave()
            assert np.allclose(after["Basis"], vertices(alone.data), atol=1e-5)
        assert np.allclose(after["Moved"] - (5, 0, 0), after["Basis"], atol=1e-4)
        tall = after["Tall"][n:]
        assert np.allclose(tall[:, :2], after["Basis"][n:, :2], atol=0.15)
        assert np.allclose(tall[:, 2] / 3, after["Basis"][n:, 2], atol=0.15)
        assert np.array_equal(vertices(ob.data), after["Basis"])

    def test_a_broken_key_is_named(self):
        ob = self.keyed()
        bm = edit(ob)
        edge = rim(bm)[0].index
        leave()
        vertex = ob.data.edges[edge].vertices[0]
        ob.data.shape_keys.key_blocks["Tall"].data[vertex].co.x = float("nan")
        count = len(ob.data.polygons)
        edit(ob)
        with pytest.raises(RuntimeError, match=r"(?i)in another shape key .*finite"):
            bpy.ops.mesh.gridmesh_fill(holes="ALL", max_edges=0)
        leave()
        assert len(ob.data.polygons) == count


def test_all_of_it_at_once():
    """UVs, weights, keys and colours on both ends of a cylinder, each extended by itself."""
    ob = cylinder(12)
    mesh = ob.data
    group = ob.vertex_groups.new(name="Top")
    for vertex in mesh.vertices:
        group.add([vertex.index], float(vertex.co.z > 0), "REPLACE")
    mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    ob.shape_key_add(name="Basis")
    ob.shape_key_add(name="Other", from_mix=False)
    n = len(mesh.vertices)
    faces, _ = filled_all(ob)
    for vertex in mesh.vertices[n:]:
        weight = {g.group: g.weight for g in vertex.groups}[group.index]
        assert np.isclose(weight, float(vertex.co.z > 0), atol=1e-5)
    assert len(faces_of(mesh)) == len(faces) + 12


class TestSettle:
    def loop(self, values):
        values = np.asarray(values, float)[:, None]
        return values.copy(), values.copy(), np.ones(len(values))

    def test_whole(self):
        before, after, arc = self.loop([0, 1, 2, 1])
        values, torn = settle(before, after, arc)
        assert not torn
        assert np.array_equal(values, after)

    def test_torn_at_one_vertex(self):
        before, after, arc = self.loop([0, 1, 2, 3])
        before[0] = 4  # as around a cylinder: 0 1 2 3 and again 4
        values, torn = settle(before, after, arc)
        assert torn
        assert values.ravel().tolist() == [0, 1, 2, 3]

    def test_two_islands(self):
        before, after, arc = self.loop([0, 1, 2, 3, 4, 5])
        after[4], before[5], after[5], before[0] = 14, 15, 15, 16
        values, torn = settle(before, after, arc)
        assert torn
        assert values.ravel().tolist() == [0, 1, 2, 3, 4, 2]

    def test_longer_by_length_and_not_by_number(self):
        before, after, arc = self.loop([0, 1, 2, 3, 4, 5])
        after[4], before[5], after[5], before[0] = 14, 15, 15, 16
        arc[4:] = 10
        values, _ = settle(before, after, arc)
        assert values.ravel()[[4, 5, 0]].tolist() == [14, 15, 16]
        assert ((values >= 0) & (values <= 16)).all()

    def test_edges_without_faces(self):
        before, after, arc = self.loop([0, 1, 2, 3])
        after[3] = before[0] = np.nan
        values, torn = settle(before, after, arc)
        assert torn
        assert values.ravel().tolist() == [0, 1, 2, 3]

    def test_wire(self):
        nothing = np.full((4, 2), np.nan)
        assert settle(nothing, nothing, np.ones(4)) == (None, False)

    @pytest.mark.parametrize("seed", range(20))
    def test_never_out_of_range(self, seed):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(3, 12))
        after = rng.integers(0, 3, (n, 1)).astype(float)
        before = np.where(rng.random((n, 1)) < 0.7, after, rng.integers(0, 3, (n, 1)))
        values, torn = settle(before, after, rng.random(n) + 0.1)
        assert torn == (not np.array_equal(before, after))
        assert values.min() >= 0
        assert values.max() <= 2
