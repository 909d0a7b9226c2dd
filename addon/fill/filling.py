# SPDX-License-Identifier: GPL-3.0-or-later
"""Holes of a mesh being edited, found and filled: what the operator and the command line do."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ..api import Progress
from ..text.messages import counted
from . import patches
from .editmesh import Added, EditMesh, MeshError, Patch
from .holes import Found, Problem
from .patches import Snapshot

_LOST = 0.4
"""So many edges of its border a new surface may be off the old one until it is told."""

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

    def find_selected(self, *, close_chains: bool) -> None:
        """Find the holes that the selection means, and leave out those with bad positions."""
        self._check(self.edited.selected_holes(close_chains=close_chains))

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

    def fill(
        self, smooth: str, progress: Progress, *, keep_hard: bool = False, cells: str = "triangles"
    ) -> None:
        """Fill the holes, without touching the mesh. cells : "triangles" or "quads"."""
        if not self.found.holes:
            return
        at = self.snapshot
        loops = [hole.vertices for hole in self.found.holes]
        fills = patches.fill(
            at,
            loops,
            progress,
            smooth=smooth,
            sharp=_HARD if keep_hard else None,
            creases=self.edited.sharp_edges() if keep_hard else None,
            cells=cells,
        )
        for loop, fill in zip(loops, fills, strict=True):
            if isinstance(fill, str):
                edges = tuple(zip(loop, loop[1:] + loop[:1], strict=True))
                self.found.problems.append(Problem(fill, tuple(loop), edges))
                continue
            self.patches.append(Patch.of(fill, [loop], at))
            self.reports.append(fill.report)

    def name(self, problem: Problem, several: bool) -> str:
        """Message of a problem, with the object's name where there are several."""
        own = f"'{self.edited.name}'"
        return f"{own}: {problem.reason}" if several and own not in problem.reason else problem.reason


def add_all(jobs: list[Job]) -> None:
    """Put all patches into their meshes; if one fails, no mesh keeps any."""
    try:
        for job in jobs:
            job.edited.add(job.patches, job.added)
    except BaseException:
        for job in jobs:
            job.edited.take_back(job.added)
        raise
    for job in jobs:
        job.edited.finish(job.added)


def forgive_unselected(jobs: list[Job]) -> None:
    """Meshes without a selection are none of the user's trouble while another one has one."""
    idle = [job for job in jobs if not job.edited.has_selection()]
    if len(idle) < len(jobs):
        for job in idle:
            job.found = Found()


def left_open(jobs: list[Job], max_edges: int) -> list[str]:
    """Tell of holes that were not to be filled."""
    larger = sum(job.found.larger for job in jobs)
    hidden = sum(job.found.hidden for job in jobs)
    mirrored = sum(job.found.mirrored for job in jobs)
    across = sum(job.found.across for job in jobs)
    outer = sum(job.found.outer for job in jobs)
    left = []
    if larger:
        left.append(f"{counted(larger, 'hole')} with more than {max_edges} edges left open; raise Max Edges")
    if hidden:
        left.append(f"{counted(hidden, 'hidden hole')} left open")
    if mirrored:
        left.append(f"{counted(mirrored, 'hole')} left open at the plane of a Mirror modifier")
    if across:
        left.append(
            f"{counted(across, 'hole')} left open across the plane of a Mirror modifier; apply the modifier to fill them whole"
        )
    if outer:
        left.append(
            f"{counted(outer, 'outer border')} left open, inside which the mesh lies already; select a border to fill it"
        )
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
            else f"{patches} meet the mesh or themselves; check the shape"
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
    lost = sum(report.get("lost", 0.0) > _LOST for report in reports)
    if lost:
        most = max(report.get("lost", 0.0) for report in reports)
        warnings.append(
            f"{counted(lost, 'area')} lost shape: the new faces are up to {most:.1f} edges of the border off, which are too "
            "long for what lies within; select less, or subdivide first"
        )
    repaired = sum(report.get("repaired", 0) for report in reports)
    if repaired:
        warnings.append(f"{counted(repaired, 'patch')} made by a simpler method, since the smooth one failed")
    return warnings
