# SPDX-License-Identifier: GPL-3.0-or-later
"""`mesh.gridmesh_regrid`: selected areas of the mesh being edited are meshed anew."""

from __future__ import annotations

from time import perf_counter

import bpy
from bpy.props import BoolProperty

from .. import api
from ..fill.editmesh import EditMesh
from ..fill.filling import warnings_of
from ..text.messages import counted, listed
from ..text.telling import told
from ..ui.patching import PatchFaces, edited_meshes, faces_made
from ..ui.progress import Pointer
from .regridding import Job, replace_all


class MESH_OT_gridmesh_regrid(PatchFaces, bpy.types.Operator):  # noqa: N801
    """Mesh the selected faces, or the area inside a selected loop, anew with a regular grid on the same surface"""  # noqa: D400

    bl_idname = "mesh.gridmesh_regrid"
    bl_label = "Regrid"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    keep_shape: BoolProperty(
        name="Keep Shape",
        description="Lay the grid on the old surface; without, the area becomes a smooth patch between its edges",
        default=True,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a mesh in Edit Mode."""
        return cls.can_edit(context, "Edit a mesh and select faces, or a closed loop of edges")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Find the areas, mesh them as arrays, and only then change the meshes."""
        started = perf_counter()
        if not self.has_module("regrid"):
            return {"CANCELLED"}
        jobs = [Job(EditMesh(ob)) for ob in edited_meshes(context)]
        for job in jobs:
            job.find()
        jobs = [job for job in jobs if job.areas or job.problems]
        if not jobs:
            self.report({"ERROR"}, told(self._nothing(context)))
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

    def _nothing(self, context: bpy.types.Context) -> str:
        """Why there is no area."""
        if any(ob.data.total_vert_sel for ob in edited_meshes(context)):
            return "Only vertices are selected; select faces, or a closed loop of edges"
        return "Nothing is selected; select faces, or a closed loop of edges"

    def _tell(self, jobs: list[Job], problems: list[str], seconds: float) -> None:
        """Report numbers, and what the user should know."""
        reports = [region.made.report for job in jobs for region in job.regions]
        made = faces_made(jobs)
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
        layout = self.draw_result()
        layout.prop(self, "cells")
        layout.prop(self, "keep_shape")
        if not self.keep_shape:
            layout.prop(self, "smooth")


classes = (MESH_OT_gridmesh_regrid,)
