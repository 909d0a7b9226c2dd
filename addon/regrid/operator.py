# SPDX-License-Identifier: GPL-3.0-or-later
"""`mesh.gridmesh_regrid`: selected areas of the mesh being edited are meshed anew."""

from __future__ import annotations

from time import perf_counter

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty

from .. import api
from ..data import defaults
from ..fill.editmesh import EditMesh
from ..fill.filling import faces_made, warnings_of
from ..text.messages import counted, listed
from ..text.telling import told
from ..ui.progress import Pointer
from ..ui.properties import PATCH_FACES
from .regridding import Job, replace_all


class MESH_OT_gridmesh_regrid(bpy.types.Operator):  # noqa: N801
    """Mesh the selected faces, or the area inside a selected loop, anew with a regular grid on the same surface"""  # noqa: D400

    bl_idname = "mesh.gridmesh_regrid"
    bl_label = "Regrid"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    keep_shape: BoolProperty(
        name="Keep Shape",
        description="Lay the grid on the old surface; without, the area becomes a smooth patch between its edges",
        default=True,
    )
    smooth: EnumProperty(
        name="Smoothness",
        description="How a patch continues the surface around it",
        items=[
            ("FLAT", "Flat", "Stretched into the hole like a soap film"),
            ("TANGENT", "Tangent", "With the slope of the surface"),
            ("CURVATURE", "Curvature", "With the slope and the curvature of the surface"),
        ],
        default="TANGENT",
    )
    cells: EnumProperty(
        name="Faces",
        description="What patches are made of",
        items=PATCH_FACES,
        default=defaults.CELLS,
    )
    result: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a mesh in Edit Mode."""
        if context.mode == "EDIT_MESH":
            return True
        cls.poll_message_set(told("Edit a mesh and select faces, or a closed loop of edges", "tooltips"))
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Find the areas, mesh them as arrays, and only then change the meshes."""
        started = perf_counter()
        try:
            api.native("regrid")
        except api.NativeError as error:
            self.report({"ERROR"}, told(str(error)))
            return {"CANCELLED"}
        jobs = [Job(EditMesh(ob)) for ob in context.objects_in_mode_unique_data if ob.type == "MESH"]
        for job in jobs:
            job.find()
        jobs = [job for job in jobs if job.areas or job.problems]
        if not jobs:
            self.report({"ERROR"}, told("Nothing is selected; select faces, or a closed loop of edges"))
            return {"CANCELLED"}
        try:
            with Pointer(context) as pointer:
                for index, job in enumerate(jobs):
                    part = pointer.part(index / len(jobs), (index + 1) / len(jobs))
                    job.solve(self.smooth.lower(), part, keep_shape=self.keep_shape, cells=self.cells.lower())
        except api.CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was changed"))
            return {"CANCELLED"}
        problems = [problem for job in jobs for problem in job.problems]
        done = [job for job in jobs if job.regions]
        if not done:
            self.report({"ERROR"}, told(listed(problems)))
            return {"CANCELLED"}
        replace_all(done)
        self._tell(done, problems, perf_counter() - started)
        return {"FINISHED"}

    def _tell(self, jobs: list[Job], problems: list[str], seconds: float) -> None:
        """Report numbers, and what the user should know."""
        reports = [region.made.report for job in jobs for region in job.regions]
        faces = [len(face.verts) for job in jobs for face in job.added.faces]
        quads = sum(n == 4 for n in faces)
        made = faces_made(quads, len(faces) - quads)
        irregular = sum(report["irregular"] for report in reports)
        self.result = (
            f"Meshed {counted(len(reports), 'area')} anew: {made}, {counted(irregular, 'irregular vertex')}, "
            f"{1000 * seconds:.0f} ms"
        )
        self.report({"INFO"}, told(self.result))
        for warning in warnings_of(reports):
            self.report({"WARNING"}, told(warning))
        if problems:
            self.report({"WARNING"}, told(f"{counted(len(problems), 'area')} left out:\n{listed(problems)}"))

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        if self.result:
            numbers = layout.column(align=True)
            for part in self.result.split(", ", 1):  # on one line they would be cut off
                numbers.label(text=told(part, "interface"))
        layout.prop(self, "cells")
        layout.prop(self, "keep_shape")
        if not self.keep_shape:
            layout.prop(self, "smooth")


classes = (MESH_OT_gridmesh_regrid,)
