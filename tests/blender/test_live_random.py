"""Random actions of all kinds, undone, redone and reloaded: drawing and body stay one thing, nothing is orphaned or lost.

GRIDMESH_EDITS sets the number of steps.
"""

import os
import resource

import bpy
import numpy as np
import pytest
from drawings import (
    activate,
    at,
    bean,
    check_body,
    circle,
    grease_pencil,
    run,
    triangles,
    vertices,
    world_vertices,
)
from mathutils import Matrix

from addon.bodies import profilecurve
from addon.data import frames, meshes, written
from addon.draw.gesture import pack
from addon.live import engine, family
from addon.live.reading import sketch_of
from addon.live.solve import solve

STEPS = int(os.environ.get("GRIDMESH_EDITS", "70"))

MANY = 6
"""Bodies, above which some are deleted."""

pytestmark = pytest.mark.usefixtures("awake")


def draw(points, **options):
    flat = np.asarray(points, float)[:, :2]
    return bpy.ops.object.gridmesh_draw(
        "EXEC_DEFAULT",
        True,
        stroke=pack(flat, np.ones(len(flat))),
        matrix=np.eye(4).ravel().tolist(),
        triangles=300,
        **options,
    )


class Play:
    """A scene, what is done to it, and what is known of it that nobody but the user may change."""

    def __init__(self, seed, path):
        self.random = np.random.default_rng(seed)
        self.path = str(path / f"random{seed}.blend")
        self.done = {}
        self.waiting = self.looked = 0
        bpy.ops.ed.undo_push(message="base")
        draw(bean() * 2)
        grease_pencil([at(bean(), 6, 0, 0), at(circle(), 9, 0, 0)])
        run(follow=True, triangles=300)
        engine.settle()
        bpy.ops.ed.undo_push(message="drawn")

    def bodies(self):
        return sorted((ob for ob in engine.bodies() if ob.users_scene), key=lambda ob: ob.name)

    def one(self, found):
        return found[int(self.random.integers(len(found)))]

    # --------------------------------------------------------------------------------------------- what is done

    def edit(self):
        """Move the points of a drawing about, all strokes alike."""
        sources = {ob.gridmesh_live.source for ob in self.bodies()} - {None}
        if not sources:
            return
        source = self.one(sorted(sources, key=lambda ob: ob.name))
        drawing = source.data.layers[0].current_frame().drawing
        data = drawing.attributes["position"].data
        for _ in range(int(self.random.integers(1, 4))):
            points = np.empty(len(data) * 3, np.float32)
            data.foreach_get("vector", points)
            stretch = np.diag([*self.random.uniform(0.97, 1.03, 2), 1.0])
            data.foreach_set("vector", (points.reshape(-1, 3) @ stretch).astype(np.float32).ravel())
            drawing.tag_positions_changed()
            bpy.context.view_layer.update()

    def hole(self):
        draw(circle(30, 0.25, self.random.uniform(-1, 1, 2)), subtract=True)

    def across(self):
        draw(circle(40, 0.5, self.random.uniform(-2.2, 2.2, 2), start=self.random.uniform(0, 6)))

    def curve(self):
        activate(self.one(self.bodies()))
        shape = self.one([*profilecurve.SHAPES, "NONE"])
        bpy.ops.object.gridmesh_curve("EXEC_DEFAULT", True, shape=shape)

    def transform(self):
        """Move, turn or scale bodies, drawings, or everything, with the tools of Blender and by scripts."""
        body = self.one(self.bodies())
        source = body.gridmesh_live.source
        chosen = self.one([[body], [body, source], [source], list(bpy.context.scene.objects)])
        chosen = [ob for ob in chosen if ob is not None and ob.users_scene]
        activate(*chosen)
        way = self.one(["translate", "resize", "matrix"])
        if way == "matrix":
            motion = Matrix.Translation(self.random.uniform(-0.3, 0.3, 3)) @ Matrix.Rotation(
                self.random.uniform(-0.2, 0.2), 4, self.one("XYZ")
            )
            tops = [ob for ob in chosen if not set(frames.ancestors(ob)[1:]) & set(chosen)]
            for ob in tops:
                ob.matrix_world = motion @ ob.matrix_world
            return
        window = bpy.context.window_manager.windows[0]
        area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
        region = next(region for region in area.regions if region.type == "WINDOW")
        with bpy.context.temp_override(window=window, area=area, region=region):
            if way == "translate":
                bpy.ops.transform.translate("EXEC_DEFAULT", value=self.random.uniform(-0.3, 0.3, 3).tolist())
            else:
                factor = float(self.random.uniform(0.9, 1.1))
                bpy.ops.transform.resize("EXEC_DEFAULT", value=(factor,) * 3, center_override=(0, 0, 0))

    def duplicate(self):
        body = self.one(self.bodies())
        source = body.gridmesh_live.source
        chosen = [body] if source is None or self.random.random() < 0.6 else [body, source]
        if source is not None and self.random.random() < 0.2:
            chosen = [source]
        activate(*chosen)
        bpy.ops.object.duplicate(linked=bool(self.random.random() < 0.3))

    def parent(self):
        """Select everything of a body and give it an empty as parent, or take that away again."""
        body = self.one(self.bodies())
        if body.parent is not None and body.parent.type == "EMPTY":
            activate(body)
            bpy.ops.object.parent_clear(type="CLEAR_KEEP_TRANSFORM")
            return
        empty = bpy.data.objects.new("Empty", None)
        bpy.context.scene.collection.objects.link(empty)
        activate(
            empty, *(ob for ob in (body, body.gridmesh_live.source) if ob is not None and ob.users_scene)
        )
        bpy.ops.object.parent_set(type="OBJECT", keep_transform=True)

    def delete(self):
        body = self.one(self.bodies())
        source = body.gridmesh_live.source
        alone = source is not None and source.users_scene and self.random.random() < 0.3
        activate(source if alone else body)
        bpy.ops.object.delete()

    def hand(self):
        """Change a mesh by hand; or give up, or keep, what was changed."""
        body = self.one(self.bodies())
        activate(body)
        if written.by_hand(body.data):
            (
                bpy.ops.object.gridmesh_rebuild
                if self.random.random() < 0.7
                else bpy.ops.object.gridmesh_freeze
            )()
        else:
            body.data.vertices[int(self.random.integers(len(body.data.vertices)))].co.z += 0.1
            body.data.update()

    def hide(self):
        body = self.one(self.bodies())
        body.hide_set(True)
        engine.settle()
        body.hide_set(False)

    def apply(self):
        """Apply transforms, or set the origin, of a body, its drawing, or both: nothing may move."""
        body = self.one(self.bodies())
        source = body.gridmesh_live.source
        chosen = self.one([[body], [body, source], [source]])
        chosen = [ob for ob in chosen if ob is not None and ob.users_scene]
        if not chosen:
            return
        activate(*chosen)
        hands, place = written.by_hand(body.data), world_vertices(body)
        if self.random.random() < 0.7:
            try:
                bpy.ops.object.transform_apply(isolate_users=True)
            except RuntimeError as error:  # Blender's word: some linked duplicates are not isolated
                assert "multi user" in str(error)
        elif body.data.users == 1:
            bpy.ops.object.origin_set(type=self.one(["ORIGIN_GEOMETRY", "ORIGIN_CURSOR"]))
        self.settle()
        assert written.by_hand(body.data) == hands
        assert np.abs(world_vertices(body) - place).max() < 1e-4

    def undo(self):
        bpy.ops.ed.undo()

    def redo(self):
        bpy.ops.ed.redo()

    def reload(self):
        bpy.ops.wm.save_as_mainfile(filepath=self.path)
        bpy.ops.wm.open_mainfile(filepath=self.path)

    KINDS = (
        *("edit", "edit", "edit", "edit", "edit", "transform", "transform", "transform", "transform"),
        *("undo", "undo", "undo", "undo", "redo", "redo", "redo", "duplicate", "duplicate", "hole", "across"),
        *("curve", "parent", "delete", "hand", "hand", "hide", "reload", "apply", "apply"),
    )
    HISTORY = ("undo", "redo")

    def step(self, kind):
        if not self.bodies() and kind not in self.HISTORY:
            draw(bean() * 2)
        elif len(self.bodies()) > MANY and kind in ("duplicate", "across"):
            kind = "delete"
        before = self.by_hand()
        activate()  # what is selected may be hidden or gone
        if self.bodies() or kind in self.HISTORY:
            try:
                getattr(self, kind)()
            except RuntimeError as error:
                if kind not in self.HISTORY:
                    raise
                assert "poll" in str(error)  # there is no step
                return
        bpy.context.view_layer.update()
        pushed = kind not in (*self.HISTORY, "hole", "across", "curve")
        if pushed and self.random.random() < 0.5:
            bpy.ops.ed.undo_push(message=kind)  # before the bodies have followed, as the window does
            pushed = False
        self.settle()
        if pushed:
            bpy.ops.ed.undo_push(message=kind)
        self.done[kind] = self.done.get(kind, 0) + 1
        if kind not in ("hand", "delete", "apply", *self.HISTORY):  # applied, it is seen to stay
            after = self.by_hand()
            for name, mesh in before.items():
                assert after.get(name) == mesh, f"handwork on {name} was lost by {kind}"

    def settle(self):
        for _ in range(2):
            bpy.context.view_layer.update()
            engine.settle()
        bpy.context.view_layer.update()

    # ------------------------------------------------------------------------------------------ what must be so

    def by_hand(self):
        return {ob.name: vertices(ob.data).tobytes() for ob in self.bodies() if written.by_hand(ob.data)}

    def check(self):
        depsgraph = bpy.context.evaluated_depsgraph_get()
        for body in self.bodies():
            self.looked += 1
            self.check_body(body, depsgraph)
        used = {ob.gridmesh_live.source for ob in self.bodies()} - {None}
        outlines = {
            ob for ob in bpy.context.scene.objects if ob.type == "GREASEPENCIL" and ob.gridmesh_outline
        }
        assert outlines == {ob for ob in used if ob.gridmesh_outline}, "an outline without a body"
        for outline in outlines:
            assert frames.is_linked(outline.parent)
            assert outline.parent.gridmesh_live.source == outline
            assert outline.hide_render
        assert all(ob.users_scene for ob in used)

    def check_body(self, body, depsgraph):
        live = body.gridmesh_live
        writer = family.writer(body)
        if writer != body:  # it shares the mesh, and what is to be said of it
            assert live.problem == writer.gridmesh_live.problem
            return
        if live.problem == engine.BY_HAND:
            assert written.by_hand(body.data)
            return
        if live.source is None:
            assert "gone" in live.problem
            return
        if (
            live.problem
        ):  # a neck became too thin, or a stroke was trimmed away: it says so, and stays as it was
            self.waiting += 1
            return
        sketch = sketch_of(body, depsgraph)
        assert live.digest == engine.fingerprint(live, sketch)
        fresh, _ = solve(sketch, live.sketch_options(), live.body_options(), pen=live.pen)
        points, there = meshes.in_space(fresh, frames.space(body)).vertices, vertices(body.data)
        same = np.array_equal(fresh.faces, triangles(body.data))
        if not same or np.abs(points - there).max() >= 1e-5 * sketch.size:
            # Of equally good grids, as on a circle, rounding chooses, also between those with the same triangles, turned;
            # a body that was applied keeps the one that it has.
            assert "apply" in self.done
            assert abs(len(fresh.faces) / len(triangles(body.data)) - 1) < 0.05
            for one, two in (
                (points.min(axis=0), there.min(axis=0)),
                (points.max(axis=0), there.max(axis=0)),
            ):
                assert np.abs(one - two).max() < 0.02 * sketch.size
        check_body(body, genus=len(sketch.holes))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_actions(tmp_path, seed):
    play = Play(seed, tmp_path)
    play.check()
    deck, memory = [], []
    for step in range(STEPS):
        if not deck:  # every kind comes up in each round
            deck = list(play.random.permutation(play.KINDS))
        play.step(str(deck.pop()))
        play.check()
        if step % 50 == 49:
            memory.append(_resident())
    assert set(play.done) >= set(play.KINDS) - set(play.HISTORY) or len(play.KINDS) > STEPS, play.done
    assert play.looked > STEPS
    assert play.waiting <= 0.1 * play.looked, f"{play.waiting} of {play.looked} looks found a body that waits"
    # Undo steps and bodies that came with the steps take some; a mesh that is leaked at each would take 50 MB in 1000.
    assert not memory or max(memory) - memory[0] <= 10 + 0.03 * STEPS, memory
    print(f"steps {play.done}, waiting {play.waiting} of {play.looked}, bodies {len(play.bodies())}, megabytes "
          f"every 50 steps {memory}, most {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024}")  # fmt: skip


def _resident():
    with open("/proc/self/statm") as numbers:  # noqa: PTH123
        return int(numbers.read().split()[1]) * resource.getpagesize() // 2**20
