# SPDX-License-Identifier: GPL-3.0-or-later
"""`mesh.gridmesh_fill`: holes of the mesh being edited become grid patches."""

from __future__ import annotations

from time import perf_counter

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty

from .. import api
from ..data import defaults
from ..text.messages import counted, listed
from ..text.telling import told
from ..ui.patching import PatchFaces, edited_meshes, faces_made
from ..ui.progress import Pointer
from .editmesh import EditMesh
from .filling import Job, add_all, forgive_unselected, left_open, warnings_of


class MESH_OT_gridmesh_fill(PatchFaces, bpy.types.Operator):  # noqa: N801
    """Fill the selected hole with a regular patch of triangles or quads that fits its edges"""  # noqa: D400 (the tooltip)

    bl_idname = "mesh.gridmesh_fill"
    bl_label = "Grid Patch Fill"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    holes: EnumProperty(
        name="Holes",
        description="Which holes are filled",
        items=[
            (
                "SELECTED",
                "Selected",
                "Selected loops of open edges, and the whole holes that single selected edges or vertices lie on",
            ),
            ("ALL", "All", "All holes that are not hidden, up to a number of edges"),
        ],
        default="SELECTED",
        options={"SKIP_SAVE"},
    )
    max_edges: IntProperty(
        name="Max Edges",
        description="Holes with more edges are left open; 0 fills holes of any size. The outer border of a flat sheet is no hole",
        default=defaults.MAX_HOLE_EDGES,
        min=0,
        soft_max=1000,
    )
    close_chains: BoolProperty(
        name="Close Chains",
        description="Close selected chains of edges by a straight edge",
        default=False,
        options={"SKIP_SAVE"},
    )
    keep_hard: BoolProperty(
        name="Keep Hard Edges",
        description=(
            "Continue hard edges of the surroundings (bent by more than 30 degrees, or marked sharp) to where they "
            "meet, as at a corner of a cube"
        ),
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a mesh in Edit Mode."""
        return cls.can_edit(context, "Edit a mesh and select the edges of a hole")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Find the holes, fill them as arrays, and only then change the meshes."""
        started = perf_counter()
        if not self.has_module("fill_holes"):
            return {"CANCELLED"}
        jobs = [Job(EditMesh(ob)) for ob in edited_meshes(context)]
        several = len(jobs) > 1
        for job in jobs:
            if self.holes == "ALL":
                job.find_all(self.max_edges)
            else:
                job.find_selected(close_chains=self.close_chains)
        if self.holes == "SELECTED" and several:
            forgive_unselected(jobs)
        try:
            with Pointer(context) as pointer:
                for index, job in enumerate(jobs):
                    part = pointer.part(index / len(jobs), (index + 1) / len(jobs))
                    job.fill(self.smooth.lower(), part, keep_hard=self.keep_hard, cells=self.cells.lower())
        except api.CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was filled"))
            return {"CANCELLED"}
        problems = [job.name(problem, several) for job in jobs for problem in job.found.problems]
        if not any(job.patches for job in jobs):
            return self._refuse(jobs, problems)
        add_all([job for job in jobs if job.patches])
        self._tell(jobs, problems, perf_counter() - started)
        return {"FINISHED"}

    def _refuse(self, jobs: list[Job], problems: list[str]) -> set[str]:
        """Say why nothing was filled, and select what stands in the way."""
        for job in jobs:
            job.edited.point_out(job.found.problems)
        left = left_open(jobs, self.max_edges)
        if problems:
            self.report({"ERROR"}, told(listed(problems + left)))
        elif left:
            self.report({"WARNING"}, told(listed(left)))
        else:
            self.report({"WARNING"}, told("There are no holes"))
        return {"CANCELLED"}

    def _tell(self, jobs: list[Job], problems: list[str], seconds: float) -> None:
        """Report numbers, and what the user should know."""
        reports = [report for job in jobs for report in job.reports]
        made = faces_made(jobs)
        irregular = sum(report["irregular"] for report in reports)
        self.result = (
            f"Filled {counted(len(reports), 'hole')}: {made}, {counted(irregular, 'irregular vertex')}, "
            f"{1000 * seconds:.0f} ms"
        )
        left = left_open(jobs, self.max_edges)
        torn = sum(job.added.torn for job in jobs)
        if torn:
            left.append(
                f"UVs or colours are torn at {counted(torn, 'hole')}: continued from the longest stretch of each"
            )
        broken = sum(job.added.broken for job in jobs)
        if broken:
            left.append(f"{counted(broken, 'layer')} of data not continued: a value at a hole is not finite")
        if left:
            self.report({"INFO"}, told(listed(left)))
        # The status line shows what is reported last.
        self.report({"INFO"}, told(self.result))
        for warning in warnings_of(reports):
            self.report({"WARNING"}, told(warning))
        if problems:
            self.report(
                {"WARNING"}, told(f"{counted(len(problems), 'selection')} left out:\n{listed(problems)}")
            )

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.draw_result()
        layout.prop(self, "cells")
        layout.prop(self, "holes")
        if self.holes == "ALL":
            layout.prop(self, "max_edges")
        else:
            layout.prop(self, "close_chains")
        layout.prop(self, "smooth")
        layout.prop(self, "keep_hard")


classes = (MESH_OT_gridmesh_fill,)
