# SPDX-License-Identifier: GPL-3.0-or-later
"""Two loops of a mesh being edited, found and joined: what the operator does."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..api import Progress
from ..fill import patches
from ..fill.editmesh import Added, EditMesh, MeshError, Patch, Snapshot
from ..fill.holes import Hole, Problem
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
    report: dict = field(default_factory=dict)
    added: Added = field(default_factory=Added)

    def find(self) -> None:
        """Find the two loops that the selection means, or say why not."""
        found = self.edited.selected_holes(close_chains=False)
        self.problems = list(found.problems)
        if self.problems:
            return
        self.loops = found.holes
        if len(self.loops) != _PAIR:
            loops = counted(len(self.loops), "loop")
            self.problems.append(Problem(f"{loops} of open edges selected; select two to join"))
            return
        shared = sorted(set(self.loops[0].vertices) & set(self.loops[1].vertices))
        if shared:
            reason = f"both loops pass through vertex {shared[0]}; split it, or choose loops that are apart"
            self.problems.append(Problem(reason, tuple(shared)))
            return
        try:
            self.snapshot = self.edited.snapshot()
        except MeshError as error:
            self.problems.append(Problem(f"'{self.edited.name}': {error}"))
            return
        faulty = [self.edited.faulty(hole, self.snapshot.positions) for hole in self.loops]
        self.problems += [problem for problem in faulty if problem is not None]

    def bridge(self, smooth: str, rows: int, twist: float, progress: Progress) -> None:
        """Make the tube, without touching the mesh. rows : 0 for as many as suit."""
        if self.problems or self.snapshot is None:
            return
        at = self.snapshot
        one, two = (hole.vertices for hole in self.loops)
        made = patches.bridge(
            at.positions,
            at.triangles,
            one,
            two,
            smooth=smooth,
            rows=rows or None,
            twist=twist,
            polygons=at.polygons,
            poses=at.poses,
            progress=progress,
        )
        if isinstance(made, str):
            self.problems.append(Problem(made, (*one, *two)))
            return
        self.report = made.report
        self.patches.append(
            Patch(
                loop=(*one, *two),
                split=len(one),
                first=len(at.positions),
                vertices=made.vertices @ at.to_local.T,
                faces=made.triangles.tolist(),
                creases=made.creases,
                poses=[pose @ at.to_local.T for pose in made.poses],
                extend=made.extend,
            )
        )

    def name(self, problem: Problem, *, several: bool) -> str:
        """Message of a problem, with the object's name where there are several."""
        own = f"'{self.edited.name}'"
        return f"{own}: {problem.reason}" if several and own not in problem.reason else problem.reason


def warnings_of(report: dict) -> list[str]:
    """What a tube tells about itself that a user should look at."""
    warnings = []
    if report["self_intersections"]:
        warnings.append("The tube meets the mesh or itself; check the shape, or choose less smoothness")
    if report["winding_conflicts"]:
        faces = counted(report["winding_conflicts"], "face")
        warnings.append(f"{faces} at the loops look the other way than the tube; recalculate the normals")
    if report["grid"] == "graded":
        warnings.append(
            "No regular lattice suits these numbers of edges; choose other rows or subdivide a loop"
        )
    return warnings
