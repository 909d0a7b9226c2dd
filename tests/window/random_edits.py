"""Acts in Edit Mode, chosen at random: holes, loops, cuts."""

import bpy
import numpy as np
from random_acts import AS_CALLED, Play, in_object_mode
from setting import select, stage, stroke, tool


class Editing(Play):
    """The same with meshes: holes, loops, cuts."""

    KINDS = ("cube", "cylinder", "grid", "monkey", "torus", "uv_sphere")
    OPERATORS = (
        ("mesh", "gridmesh_bridge"),
        ("mesh", "gridmesh_fill"),
        ("mesh", "gridmesh_fill"),
        ("mesh", "gridmesh_regrid"),
        ("object", "gridmesh_cut"),
        ("object", "gridmesh_join"),
    )

    def add(self):
        yield from in_object_mode()
        place = [self.random.uniform(-1.5, 1.5) for _ in range(3)]
        with stage.override():
            getattr(bpy.ops.mesh, f"primitive_{self.random.choice(self.KINDS)}_add")(
                *AS_CALLED, location=place
            )
        yield 0.4

    def in_edit_mode(self):
        """Edit some meshes; whether there are any."""
        if bpy.context.mode != "EDIT_MESH":
            yield from in_object_mode()
            found = [ob for ob in bpy.context.view_layer.objects if ob.type == "MESH" and ob.visible_get()]
            if not found:
                yield from self.add()
                found = [bpy.context.view_layer.objects.active]
            select(self.random.choice(found))
            if self.random.random() < 0.2:
                self.random.choice(found).select_set(True)
            with stage.override():
                bpy.ops.object.mode_set(*AS_CALLED, mode="EDIT")
            yield 0.4

    def select_some(self):
        yield from self.in_edit_mode()
        with stage.override():
            bpy.ops.mesh.select_mode(*AS_CALLED, type=self.random.choice(("VERT", "EDGE", "FACE")))
            bpy.ops.mesh.select_all(*AS_CALLED, action="DESELECT")
            ratio, seed = self.random.choice((0.02, 0.1, 0.3)), self.random.randint(0, 1000)
            bpy.ops.mesh.select_random(*AS_CALLED, ratio=ratio, seed=seed)
            for _ in range(self.random.randint(0, 2)):
                bpy.ops.mesh.select_more(*AS_CALLED)
        yield 0.3

    def select_a_loop(self):
        yield from self.in_edit_mode()
        yield from stage.click(*self.spot(150), alt=True)
        yield from stage.click(*self.spot(150), alt=True, shift=True)

    def delete_faces(self):
        yield from self.select_some()
        with stage.override():
            bpy.ops.mesh.delete(*AS_CALLED, type=self.random.choice(("FACE", "VERT", "EDGE")))
        yield 0.4

    def select_rims(self):
        yield from self.in_edit_mode()
        with stage.override():
            bpy.ops.mesh.select_mode(*AS_CALLED, type="EDGE")
            bpy.ops.mesh.select_all(*AS_CALLED, action="DESELECT")
            if bpy.ops.mesh.select_non_manifold.poll():  # not in a mesh that is hidden
                bpy.ops.mesh.select_non_manifold(*AS_CALLED)
        yield 0.3

    def call(self):
        """One of ours, with some options as a redo panel sets them."""
        kind, name = self.random.choice(self.OPERATORS)
        yield from self.in_edit_mode() if kind == "mesh" else in_object_mode()
        if name == "gridmesh_join":
            yield from self.select_all()
        yield from self.call_operator(kind, name)

    def cut(self):
        yield from in_object_mode()
        yield from tool("gridmesh.cut")
        held = self.random.choice(({}, {}, {"shift": True}, {"ctrl": True}))
        start, end = self.spot(250), self.spot(250)
        yield from stroke([tuple(start + (end - start) * t) for t in np.linspace(0, 1, 16)], **held)

    def shape_key(self):
        yield from in_object_mode()
        ob = bpy.context.view_layer.objects.active
        if ob is not None and ob.type == "MESH":
            for name in ("Basis", "Key"):
                ob.shape_key_add(name=name)
            ob.vertex_groups.new(name="Group").add([0], 0.5, "REPLACE")
            bpy.ops.ed.undo_push(message="Shape key")
        yield 0.2

    OFTEN = (
        *(call,) * 12,
        *(cut, delete_faces, select_rims) * 5,
        *(select_some, select_a_loop, Play.undo, Play.transform) * 4,
        *(Play.press_a_shortcut,) * 2,
        *(add, Play.redo, Play.click) * 3,
        *(shape_key, Play.delete, Play.duplicate, Play.turn_view, Play.front_view, Play.undo_and_redo) * 2,
        *(Play.draw_blob, Play.sculpt, Play.save_and_open, Play.join, Play.call_a_command, Play.select_all),
    )
