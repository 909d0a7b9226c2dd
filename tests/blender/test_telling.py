"""What is chosen for the user is told: collections, materials, kinds of stroke; and the work can be stopped."""

import sys
import types

import bpy
import gridmesh
import numpy as np
import pytest
from drawings import (
    activate,
    at,
    bean,
    check_body,
    circle,
    fingerprint,
    grease_pencil,
    run,
    run_one,
)

from addon import api
from addon.ui import progress


def bezier(ob, keep_handles):
    drawing = ob.data.layers[0].current_frame().drawing
    attribute = drawing.attributes.get("curve_type") or drawing.attributes.new("curve_type", "INT8", "CURVE")
    attribute.data.foreach_set("value", np.full(len(drawing.strokes), 2, np.int32))
    for name in ("handle_left", "handle_right"):
        if name in drawing.attributes and not keep_handles:
            drawing.attributes.remove(drawing.attributes[name])


def test_bezier_stroke_without_handles_is_refused():
    bezier(grease_pencil([circle(6)]), keep_handles=False)
    before = fingerprint()
    with pytest.raises(RuntimeError, match="stroke 1 of 1: it is a Bezier stroke without handles"):
        bpy.ops.object.gridmesh_from_strokes(triangles=300)
    assert fingerprint() == before


def moved_to(ob, name):
    collection = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(ob)
    bpy.context.scene.collection.objects.unlink(ob)
    return bpy.context.view_layer.layer_collection.children[name]


class TestCollections:
    def test_hidden_collection_of_the_source(self, capfd):
        """An object that two collections hold is seen through one of them alone."""
        ob = grease_pencil([circle()])
        shut = moved_to(ob, "Shut")
        moved = bpy.data.collections.new("Open")
        bpy.context.scene.collection.children.link(moved)
        moved.objects.link(ob)
        shut.hide_viewport = True
        activate(ob)
        assert [c.name for c in run_one().users_collection] == ["Open"]
        assert "hidden" not in capfd.readouterr().out

    def test_hidden_collection_of_the_active_source_is_told(self, capfd):
        ob = grease_pencil([circle()])
        shut = moved_to(ob, "Shut")
        activate(ob)
        shut.hide_viewport = True
        bpy.context.view_layer.update()
        assert list(run_one().users_collection) == [bpy.context.scene.collection]
        told = capfd.readouterr().out
        assert (
            "The collection 'Shut' of 'Drawing' is hidden, excluded or linked; what was made of it is" in told
        )

    def test_linked_active_collection_is_told(self, capfd, tmp_path):
        path = str(tmp_path / "library.blend")
        bpy.data.libraries.write(path, {bpy.data.collections.new("Other")})
        bpy.data.collections.remove(bpy.data.collections["Other"])
        with bpy.data.libraries.load(path, link=True) as (_, into):
            into.collections = ["Other"]
        bpy.context.scene.collection.children.link(into.collections[0])
        grease_pencil([circle()])
        child = bpy.context.view_layer.layer_collection.children["Other"]
        bpy.context.view_layer.active_layer_collection = child
        assert list(run_one(collection="ACTIVE").users_collection) == [bpy.context.scene.collection]
        told = capfd.readouterr().out
        assert (
            "The active collection 'Other' is hidden, excluded or linked; what was made is in 'Scene" in told
        )


class TestMaterials:
    def ink(self, ob):
        material = bpy.data.materials.new("Ink")
        bpy.data.materials.create_gpencil_data(material)
        material.grease_pencil.color = (0.9, 0.1, 0.2, 1)
        material.grease_pencil.fill_color = (0.1, 0.6, 0.3, 1)
        ob.data.materials.append(material)
        return material

    @pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="fills belong to materials here")
    def test_filled_and_open_strokes_of_one_material(self):
        ob = grease_pencil([circle(), at(circle(), 4, 0, 0)])
        self.ink(ob)
        ob.data.layers[0].current_frame().drawing.strokes[1].fill_id = 1
        first, second = run()
        assert [body.data.materials[0].name for body in (first, second)] == ["Ink Surface", "Ink Colors"]
        assert np.allclose(first.data.materials[0].diffuse_color[:3], (0.9, 0.1, 0.2))
        assert np.allclose(second.data.materials[0].diffuse_color[:3], (0.1, 0.6, 0.3))

    def test_a_twin_of_another_colour_is_told(self, capfd):
        ob = grease_pencil([circle()])
        ink = self.ink(ob)
        run_one()
        assert "own colour" not in capfd.readouterr().out
        ink.grease_pencil.color = (0, 0, 1, 1)
        activate(ob)
        run_one(update_existing=False)
        assert "Material 'Ink Surface' was there and is used with its own colour" in capfd.readouterr().out

    def test_painted_strokes_are_told(self, capfd):
        ob = grease_pencil([circle(), at(bean(), 4, 0, 0)])
        run()
        assert "painted" not in capfd.readouterr().out
        drawing = ob.data.layers[0].current_frame().drawing
        colors = drawing.attributes.new("vertex_color", "FLOAT_COLOR", "POINT")
        values = np.zeros((len(colors.data), 4), np.float32)
        values[100] = (1, 0, 0, 1)
        colors.data.foreach_set("color", values.ravel())
        activate(ob)
        run()
        assert "A stroke is painted; bodies have the colour of the material instead" in capfd.readouterr().out


class TestCreases:
    def test_peak_is_sharp_at_its_rim(self):
        grease_pencil([bean()])
        mesh = run_one(profile="PEAK").data
        sharp = [edge for edge in mesh.edges if edge.use_edge_sharp]
        assert len(sharp) > 20
        assert all(abs(mesh.vertices[v].co.z) < 1e-7 for edge in sharp for v in edge.vertices)
        assert all(polygon.use_smooth for polygon in mesh.polygons)

    def test_round_is_smooth_all_over(self):
        grease_pencil([bean()])
        assert not any(edge.use_edge_sharp for edge in run_one().data.edges)

    def test_update_follows(self):
        ob = grease_pencil([bean()])
        body = run_one(profile="PEAK")
        activate(ob)
        run(update_existing=True)
        assert not any(edge.use_edge_sharp for edge in body.data.edges)


class TestStopping:
    @pytest.mark.parametrize("strokes", [1, 3])
    @pytest.mark.parametrize("shape", ["BODY", "SHEET"])
    def test_cancelled_work_changes_nothing(self, monkeypatch, capfd, strokes, shape):
        grease_pencil([at(bean(), 4 * k, 0, 0) for k in range(strokes)])
        monkeypatch.setattr(progress.Pointer, "__call__", lambda self, fraction: False)
        before = fingerprint()
        assert bpy.ops.object.gridmesh_from_strokes(triangles=4000, shape=shape) == {"CANCELLED"}
        assert fingerprint() == before
        assert "Cancelled; nothing was made" in capfd.readouterr().out

    @pytest.mark.parametrize("strokes", [1, 3])
    def test_ctrl_c_changes_nothing(self, monkeypatch, strokes):
        grease_pencil([at(bean(), 4 * k, 0, 0) for k in range(strokes)])

        def interrupted(self, fraction):
            raise KeyboardInterrupt

        monkeypatch.setattr(progress.Pointer, "__call__", interrupted)
        before = fingerprint()
        assert bpy.ops.object.gridmesh_from_strokes(triangles=4000) == {"CANCELLED"}
        assert fingerprint() == before

    def test_the_pointer_shows_rising_steps_of_this_thread_only(self):
        calls = []
        manager = types.SimpleNamespace(
            progress_begin=lambda *a: calls.append(a),
            progress_update=calls.append,
            progress_end=lambda: calls.append("end"),
        )
        pointer = progress.Pointer(bpy.context)
        pointer._manager = manager
        with pointer:
            assert all(pointer(fraction) for fraction in (0.0, 0.104, 0.1, 0.5, 0.2, 1.0))
            pointer._thread += 1
            pointer._step = 0
            assert pointer(0.9)
        assert calls == [(0, 100), 10, 50, 100, "end"]

    def test_progress_rises_from_stroke_to_stroke(self, monkeypatch):
        seen = []
        monkeypatch.setattr(progress.Pointer, "__call__", lambda self, fraction: seen.append(fraction))
        grease_pencil([bean(), at(bean(), 4, 0, 0)])
        run(shape="SHEET")
        assert seen == sorted(seen)
        assert 0 <= seen[0] <= seen[-1] <= 1
        assert seen[-1] > 0.9


class TestNative:
    def test_unfinished_build(self, monkeypatch):
        grease_pencil([circle()])
        module = types.ModuleType("gridmesh")
        module.__version__, module.__file__ = api.NATIVE_VERSION, "/somewhere/gridmesh/__init__.py"
        monkeypatch.setitem(sys.modules, "gridmesh", module)
        before = fingerprint()
        with pytest.raises(
            RuntimeError,
            match=r"from /somewhere/gridmesh/__init__.py\) is an unfinished build without 'mesh_sketch'",
        ):
            bpy.ops.object.gridmesh_from_strokes()
        assert fingerprint() == before

    @pytest.mark.smoke
    def test_the_module_installed_serves(self):
        assert api.native("mesh_sketch") is gridmesh
        grease_pencil([circle()])
        check_body(run_one())
