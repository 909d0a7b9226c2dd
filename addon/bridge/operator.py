# SPDX-License-Identifier: GPL-3.0-or-later
"""`mesh.gridmesh_bridge`: two loops of the mesh being edited are joined by a tube, more by one patch or two by two."""

from __future__ import annotations

from time import perf_counter

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from .. import api
from ..fill.editmesh import EditMesh
from ..fill.filling import add_all
from ..text.messages import counted, listed
from ..text.telling import told
from ..ui.patching import PatchFaces, edited_meshes, faces_made
from ..ui.progress import Pointer
from .bridging import Job, summary

ONLY_TWO = "Rows and Twist are for two loops"


class MESH_OT_gridmesh_bridge(PatchFaces, bpy.types.Operator):  # noqa: N801
    """Join two selected loops by a regular tube, or more by one smooth patch, whatever their numbers of edges"""  # noqa: D400 (the tooltip)

    bl_idname = "mesh.gridmesh_bridge"
    bl_label = "Grid Bridge"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    connect: EnumProperty(
        name="Loops",
        description="How three loops or more are joined",
        items=[
            (
                "AUTO",
                "Automatic",
                "By one patch; where two look away from each other, as both ends of a pipe do, in pairs",
            ),
            ("ONE", "One Patch", "All by one patch"),
            ("PAIRS", "Pairs", "Two by two, by tubes: the nearest that face each other first"),
        ],
        default="AUTO",
        options={"SKIP_SAVE"},
    )
    rows: IntProperty(
        name="Rows",
        description="Rows of faces between two loops; 0 for as many as the lengths of the edges ask for",
        default=0,
        min=0,
        soft_max=100,
        max=10_000,
        options={"SKIP_SAVE"},
    )
    smooth: EnumProperty(
        name="Smoothness",
        description="How the tube or patch continues the surfaces at the loops",
        items=[
            ("FLAT", "Flat", "Straight from loop to loop"),
            ("TANGENT", "Tangent", "With the slope of the surface"),
            ("CURVATURE", "Curvature", "With the slope and the curvature of the surface"),
        ],
        default="TANGENT",
    )
    twist: FloatProperty(
        name="Twist",
        description="Turn of one of two loops against the other, from where they fit best",
        default=0.0,
        subtype="ANGLE",
        soft_min=-3.1416,
        soft_max=3.1416,
        options={"SKIP_SAVE"},
    )
    has_tube: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})
    """Whether a tube was made: only that has rows and a twist."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a mesh in Edit Mode."""
        return cls.can_edit(context, "Edit a mesh and select two or more loops of open edges")

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Find the loops, join them as arrays, and only then change the meshes."""
        started = perf_counter()
        if not self.has_module("bridge"):
            return {"CANCELLED"}
        edited = [EditMesh(ob) for ob in edited_meshes(context)]
        # Meshes without a selection are none of the user's trouble while another one has one.
        jobs = [Job(it) for it in edited if it.has_selection()] or [Job(it) for it in edited]
        try:
            with Pointer(context) as pointer:
                for index, job in enumerate(jobs):
                    job.find()
                    part = pointer.part(index / len(jobs), (index + 1) / len(jobs))
                    chosen = {"cells": self.cells.lower(), "connect": self.connect.lower()}
                    job.bridge(self.smooth.lower(), self.rows, self.twist, part, **chosen)
        except api.CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was joined"))
            return {"CANCELLED"}
        problems = [job.name(it, several=len(jobs) > 1) for job in jobs for it in job.problems]
        made = [job for job in jobs if job.patches]
        if not made:
            for job in jobs:
                job.edited.point_out(job.problems)
            if len(jobs) > 1 and all(len(job.loops) == 1 for job in jobs):
                problems = ["the selected loops are of several objects; join these first (Ctrl-J)"]
            self.report({"ERROR"}, told(listed(problems)))
            return {"CANCELLED"}
        add_all(made)
        self._tell(made, problems, perf_counter() - started)
        return {"FINISHED"}

    def _tell(self, jobs: list[Job], problems: list[str], seconds: float) -> None:
        """Report numbers, and what the user should know."""
        self.result = summary(jobs, faces_made(jobs), 1000 * seconds)
        self.has_tube = any(job.is_tube for job in jobs)
        torn = sum(job.added.torn for job in jobs)
        if torn:
            self.report(
                {"INFO"},
                told("UVs or colours are torn at the loops: continued from the longest stretch of each"),
            )
        broken = sum(job.added.broken for job in jobs)
        if broken:
            layers = counted(broken, "layer")
            self.report({"INFO"}, told(f"{layers} of data not continued: a value at a loop is not finite"))
        # The status line shows what is reported last.
        self.report({"INFO"}, told(self.result))
        for job in jobs:
            for warning in job.warnings():
                self.report({"WARNING"}, told(warning))
        if (self.rows or self.twist) and not self.has_tube:
            self.report({"INFO"}, told(ONLY_TWO))
        if problems:
            self.report(
                {"WARNING"}, told(f"{counted(len(problems), 'selection')} left out:\n{listed(problems)}")
            )

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.draw_result()
        layout.prop(self, "cells")
        layout.prop(self, "smooth")
        layout.prop(self, "connect")
        tube = layout.column()
        tube.active = self.has_tube
        tube.prop(self, "rows")
        tube.prop(self, "twist")
        if not self.has_tube:
            tube.label(text=told(ONLY_TWO, "interface"), icon="INFO")


classes = (MESH_OT_gridmesh_bridge,)
