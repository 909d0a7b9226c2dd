# SPDX-License-Identifier: GPL-3.0-or-later
"""`mesh.gridmesh_fill`: holes of the mesh being edited become grid patches."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from time import perf_counter

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from .. import api
from ..editmesh import Added, EditMesh, MeshError, Patch, Snapshot
from ..holes import Found, Problem
from ..progress import Pointer
from ..telling import told
from .messages import counted, listed


class MESH_OT_gridmesh_fill(bpy.types.Operator):  # noqa: N801
    """Fill the selected hole with a regular triangle patch that fits its edges"""  # noqa: D400 (the tooltip)

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
        description="Holes with more edges are left open; 0 fills holes of any size, the outer border too",
        default=100,
        min=0,
        soft_max=1000,
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
    close_chains: BoolProperty(
        name="Close Chains",
        description="Close selected chains of edges by a straight edge",
        default=False,
        options={"SKIP_SAVE"},
    )
    use_quads: BoolProperty(
        name="Quads",
        description="Join pairs of triangles to quads where that gives good ones",
        default=False,
    )
    keep_hard: BoolProperty(
        name="Keep Hard Edges",
        description=(
            "Continue hard edges of the surroundings (bent by more than 30 degrees, or marked sharp) to where they "
            "meet, as at a corner of a cube"
        ),
        default=False,
    )
    result: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for a mesh in Edit Mode."""
        if context.mode == "EDIT_MESH":
            return True
        cls.poll_message_set(told("Edit a mesh and select the edges of a hole", "tooltips"))
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Find the holes, fill them as arrays, and only then change the meshes."""
        started = perf_counter()
        try:
            api.native("fill_holes")
        except api.NativeError as error:
            self.report({"ERROR"}, told(str(error)))
            return {"CANCELLED"}
        jobs = [Job(EditMesh(ob)) for ob in context.objects_in_mode_unique_data if ob.type == "MESH"]
        several = len(jobs) > 1
        for job in jobs:
            job.find(self)
        if self.holes == "SELECTED" and several:
            _forgive_unselected(jobs)
        try:
            with Pointer(context) as pointer:
                for index, job in enumerate(jobs):
                    part = pointer.part(index / len(jobs), (index + 1) / len(jobs))
                    job.fill(self.smooth.lower(), part, keep_hard=self.keep_hard)
        except api.CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was filled"))
            return {"CANCELLED"}
        problems = [job.name(problem, several) for job in jobs for problem in job.found.problems]
        if not any(job.patches for job in jobs):
            return self._refuse(jobs, problems)
        add_all([job for job in jobs if job.patches], quads=self.use_quads)
        self._tell(jobs, problems, perf_counter() - started)
        return {"FINISHED"}

    def _refuse(self, jobs: list[Job], problems: list[str]) -> set[str]:
        """Say why nothing was filled, and select what stands in the way."""
        for job in jobs:
            job.edited.point_out(job.found.problems)
        left = _left_open(jobs, self.max_edges)
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
        faces = [len(face.verts) for job in jobs for face in job.added.faces]
        quads = sum(n == 4 for n in faces)
        made = counted(len(faces) - quads, "triangle")
        made = f"{counted(quads, 'quad')} and {made}" if quads else made
        irregular = sum(report["irregular"] for report in reports)
        self.result = (
            f"Filled {counted(len(reports), 'hole')}: {made}, {counted(irregular, 'irregular vertex')}, "
            f"{1000 * seconds:.0f} ms"
        )
        self.report({"INFO"}, told(self.result))
        left = _left_open(jobs, self.max_edges)
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
        for warning in warnings_of(reports):
            self.report({"WARNING"}, told(warning))
        if problems:
            self.report(
                {"WARNING"}, told(f"{counted(len(problems), 'selection')} left out:\n{listed(problems)}")
            )

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        if self.result:
            numbers = layout.column(align=True)
            for part in self.result.split(", ", 1):  # on one line they would be cut off
                numbers.label(text=told(part, "interface"))
        layout.prop(self, "holes")
        if self.holes == "ALL":
            layout.prop(self, "max_edges")
        else:
            layout.prop(self, "close_chains")
        layout.prop(self, "smooth")
        layout.prop(self, "keep_hard")
        layout.prop(self, "use_quads")


_HARD = math.radians(30.0)
"""Edges with more than this angle between their faces are hard."""


@dataclass
class Job:
    """The work on one of the meshes being edited."""

    edited: EditMesh
    found: Found = field(default_factory=Found)
    snapshot: Snapshot | None = None
    patches: list[Patch] = field(default_factory=list)
    reports: list[dict] = field(default_factory=list)
    added: Added = field(default_factory=Added)

    def find(self, options: MESH_OT_gridmesh_fill) -> None:
        """Find the holes, and leave out those with bad positions."""
        if options.holes == "ALL":
            self.find_all(options.max_edges)
        else:
            self._check(self.edited.selected_holes(close_chains=options.close_chains))

    def find_all(self, max_edges: int) -> None:
        """Find all holes of at most so many edges, 0: any number, and leave out those with bad positions."""
        self._check(self.edited.all_holes(max_edges))

    def _check(self, found: Found) -> None:
        self.found = found
        if not self.found.holes:
            return
        try:
            self.snapshot = self.edited.snapshot()
        except MeshError as error:
            self.found.problems.append(Problem(f"'{self.edited.name}': {error}"))
            self.found.holes = []
            return
        for hole in list(self.found.holes):
            problem = self.edited.faulty(hole, self.snapshot.positions)
            if problem is not None:
                self.found.problems.append(problem)
                self.found.holes.remove(hole)

    def fill(self, smooth: str, progress: api.Progress, *, keep_hard: bool = False) -> None:
        """Fill the holes, without touching the mesh."""
        if not self.found.holes:
            return
        at = self.snapshot
        loops = [hole.vertices for hole in self.found.holes]
        fills = api.fill(
            at.positions,
            at.triangles,
            loops,
            smooth=smooth,
            polygons=at.polygons,
            poses=at.poses,
            sharp=_HARD if keep_hard else None,
            creases=self.edited.sharp_edges() if keep_hard else None,
            progress=progress,
        )
        for loop, fill in zip(loops, fills, strict=True):
            if isinstance(fill, str):
                edges = tuple(zip(loop, loop[1:] + loop[:1], strict=True))
                self.found.problems.append(Problem(fill, tuple(loop), edges))
                continue
            self.patches.append(
                Patch(
                    loop=loop,
                    first=len(at.positions),
                    vertices=fill.vertices @ at.to_local.T,
                    triangles=fill.triangles,
                    creases=fill.creases,
                    poses=[pose @ at.to_local.T for pose in fill.poses],
                    extend=fill.extend,
                )
            )
            self.reports.append(fill.report)

    def name(self, problem: Problem, several: bool) -> str:
        """Message of a problem, with the object's name where there are several."""
        own = f"'{self.edited.name}'"
        return f"{own}: {problem.reason}" if several and own not in problem.reason else problem.reason


def add_all(jobs: list[Job], *, quads: bool) -> None:
    """Put all patches into their meshes; if one fails, no mesh keeps any."""
    try:
        for job in jobs:
            job.edited.add(job.patches, job.added)
    except BaseException:
        for job in jobs:
            job.edited.take_back(job.added)
        raise
    for job in jobs:
        job.edited.finish(job.added, quads=quads)


def _forgive_unselected(jobs: list[Job]) -> None:
    """Meshes without a selection are none of the user's trouble while another one has one."""
    idle = [job for job in jobs if not job.edited.has_selection()]
    if len(idle) < len(jobs):
        for job in idle:
            job.found = Found()


def _left_open(jobs: list[Job], max_edges: int) -> list[str]:
    larger = sum(job.found.larger for job in jobs)
    hidden = sum(job.found.hidden for job in jobs)
    left = []
    if larger:
        left.append(f"{counted(larger, 'hole')} with more than {max_edges} edges left open; raise Max Edges")
    if hidden:
        left.append(f"{counted(hidden, 'hidden hole')} left open")
    return left


def warnings_of(reports: list[dict]) -> list[str]:
    """What the fills tell about themselves that a user should look at."""
    warnings = []
    crossed = sum(report.get("self_intersections", 0) > 0 for report in reports)
    if crossed:
        patches = counted(crossed, "patch")
        warnings.append(
            f"{patches} meets the mesh or itself; check the shape"
            if crossed == 1
            else f"{patches} meet the mesh or itself; check the shape"
        )
    conflicts = sum(report.get("winding_conflicts", 0) for report in reports)
    if conflicts:
        faces = counted(conflicts, "face")
        warnings.append(
            f"{faces} around the holes is turned the other way than most; recalculate the normals"
            if conflicts == 1
            else f"{faces} around the holes are turned the other way than most; recalculate the normals"
        )
    smoothed = sum(report.get("creases", 0) > report.get("creases_kept", 0) for report in reports)
    if smoothed:
        warnings.append(
            f"{counted(smoothed, 'patch')} made without hard edges: those at the hole meet in no line or corner"
        )
    repaired = sum(report.get("repaired", 0) for report in reports)
    if repaired:
        warnings.append(f"{counted(repaired, 'patch')} made by a simpler method, since the smooth one failed")
    return warnings


classes = (MESH_OT_gridmesh_fill,)
