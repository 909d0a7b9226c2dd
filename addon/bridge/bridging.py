# SPDX-License-Identifier: GPL-3.0-or-later
"""Loops of a mesh being edited, found and joined: what the operator does.

Two are joined by a tube, three or more by one patch that has them all as its boundary, or two by two.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from ..api import Progress
from ..fill import patches
from ..fill.editmesh import Added, EditMesh, MeshError, Patch
from ..fill.holes import Hole, Problem
from ..fill.patches import Filled, Snapshot
from ..text.messages import counted

_PAIR = 2


@dataclass
class Job:
    """The work on one of the meshes being edited."""

    edited: EditMesh
    loops: list[Hole] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    snapshot: Snapshot | None = None
    patches: list[Patch] = field(default_factory=list)
    reports: list[dict] = field(default_factory=list)
    added: Added = field(default_factory=Added)
    is_tube: bool = False
    """Whether loops are joined two by two, which has rows and a twist; a patch with more loops has neither."""

    def find(self) -> None:
        """Find the loops that the selection means, or say why they cannot be joined."""
        if not self.edited.has_selection():
            self.problems.append(Problem("nothing is selected; select two or more loops of open edges"))
            return
        found = self.edited.selected_holes(close_chains=False)
        self.problems = list(found.problems)
        if not found.holes and self.edited.mesh.total_face_sel > 0:
            self.problems = [
                Problem(
                    "the selected faces have no open edges; delete them and select the loops that are left"
                )
            ]
        if self.problems:
            return
        self.loops = found.holes
        if len(self.loops) < _PAIR:
            loops = counted(len(self.loops), "loop")
            self.problems.append(Problem(f"{loops} of open edges selected; select two or more to join"))
            return
        partial = self._partial()
        if partial is not None:
            self.problems.append(partial)
            return
        touching = _touching(self.loops)
        if touching is not None:
            self.problems.append(touching)
            return
        try:
            self.snapshot = self.edited.snapshot()
        except MeshError as error:
            self.problems.append(Problem(f"'{self.edited.name}': {error}"))
            return
        faulty = [self.edited.faulty(hole, self.snapshot.positions) for hole in self.loops]
        self.problems += [problem for problem in faulty if problem is not None]

    def _partial(self) -> Problem | None:
        """Say that a row of edges is selected and not the loop that it is part of, if so; one edge stands for its loop."""
        bm = self.edited.bm
        for loop in self.loops:
            ends = zip(loop.vertices, loop.vertices[1:] + loop.vertices[:1], strict=True)
            row = tuple(pair for pair in ends if bm.edges.get([bm.verts[vertex] for vertex in pair]).select)
            if 1 < len(row) < len(loop.vertices):
                reason = (
                    f"{len(row)} of the {len(loop.vertices)} edges of a loop are selected; select all of them, or one that stands "
                    "for the loop: rows of edges are not joined"
                )
                return Problem(reason, loop.vertices, row)
        return None

    def bridge(
        self,
        smooth: str,
        rows: int,
        twist: float,
        progress: Progress,
        *,
        cells: str = "triangles",
        connect: str = "auto",
    ) -> None:
        """Make the patches, without touching the mesh.

        rows : 0 for as many as suit; these and twist count for tubes. cells : "triangles" or "quads". connect : of three loops or
        more, "one" patch, "pairs", or "auto": pairs where loops look away from each other.
        """
        if self.problems or self.snapshot is None:
            return
        at = self.snapshot
        loops = [hole.vertices for hole in self.loops]
        options = {"smooth": smooth, "cells": cells}
        more = len(loops) > _PAIR
        paired = more and (connect == "pairs" or (connect == "auto" and patches.look_apart(at, loops)))
        self.is_tube = paired or not more
        if self.is_tube:
            options |= {"rows": rows or None, "twist": twist}
        if paired:
            self._keep_pairs(loops, patches.bridge_pairs(at, loops, progress, **options))
        elif more:
            self._keep(loops, patches.fill_loops(at, loops, progress, **options))
        else:
            self._keep(loops, patches.bridge(at, *loops, progress, **options))

    def _keep(self, loops: Sequence[Sequence[int]], made: Filled | str) -> None:
        """Keep a patch between some loops, or the reason why there is none."""
        if isinstance(made, str):
            self.problems.append(Problem(made, tuple(vertex for loop in loops for vertex in loop)))
            return
        self.reports.append(made.report)
        self.patches.append(Patch.of(made, loops, self.snapshot))

    def _keep_pairs(
        self, loops: Sequence[Sequence[int]], made: list[tuple[int, int, Filled | str]] | str
    ) -> None:
        """Keep the tubes between pairs of loops, and the reasons why others have none."""
        if isinstance(made, str):
            self._keep(loops, made)
            return
        for one, other, tube in made:
            self._keep([loops[one], loops[other]], tube)
        if len(loops) % _PAIR:
            over = set(range(len(loops))).difference(*((one, other) for one, other, _ in made)).pop()
            self.problems.append(
                Problem("1 loop is left over; pairs want an even number", tuple(loops[over]))
            )

    def name(self, problem: Problem, *, several: bool) -> str:
        """Message of a problem, with the object's name where there are several."""
        own = f"'{self.edited.name}'"
        return f"{own}: {problem.reason}" if several and own not in problem.reason else problem.reason

    def warnings(self) -> list[str]:
        """What the patch tells about itself that a user should look at."""
        warnings = []
        if self._sum("self_intersections"):
            warnings.append(
                "The tube meets the mesh or itself; check the shape, or choose less smoothness"
                if self.is_tube
                else "The patch meets the mesh or itself; check the shape and which way the faces at the loops look"
            )
        if conflicts := self._sum("winding_conflicts"):
            faces = counted(conflicts, "face")
            warnings.append(
                f"{faces} at the loops look the other way than the tube; recalculate the normals"
                if self.is_tube
                else f"{faces} at the loops look the other way than the patch; recalculate the normals"
            )
        if any(report["grid"] == "graded" and report["irregular"] for report in self.reports):
            warnings.append(
                "No regular lattice suits these numbers of edges; choose other rows or subdivide a loop"
            )
        return warnings

    def _sum(self, name: str) -> int:
        return sum(report[name] for report in self.reports)


def summary(jobs: Sequence[Job], made: str, milliseconds: float) -> str:
    """Say in numbers what was joined. made : the faces that it took."""
    reports = [report for job in jobs for report in job.reports]
    irregular = counted(sum(report["irregular"] for report in reports), "irregular vertex")
    if all(job.is_tube for job in jobs):
        rows = counted(max(report["rows"] for report in reports), "row")
        if all(len(job.loops) == _PAIR for job in jobs):
            return f"Joined by {rows}: {made}, {irregular}, {milliseconds:.0f} ms"
        pairs = counted(len(reports), "pair of loops")
        return f"Joined {pairs} by {rows}: {made}, {irregular}, {milliseconds:.0f} ms"
    loops = counted(sum(len(job.loops) for job in jobs), "loop")
    return f"Joined {loops}: {made}, {irregular}, {milliseconds:.0f} ms"


def _touching(loops: Sequence[Hole]) -> Problem | None:
    """Say where loops have a vertex in common, if anywhere."""
    uses = Counter(vertex for hole in loops for vertex in hole.vertices)
    shared = sorted(vertex for vertex, number in uses.items() if number > 1)
    if not shared:
        return None
    first = shared[0]
    reason = (
        f"both loops pass through vertex {first}; split it, or choose loops that are apart"
        if len(loops) == _PAIR
        else f"{uses[first]} of the loops pass through vertex {first}; split it, or choose loops that are apart"
    )
    return Problem(reason, tuple(shared))
