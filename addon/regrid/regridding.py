# SPDX-License-Identifier: GPL-3.0-or-later
"""Areas of a mesh being edited, found and meshed anew: what the operator does."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..api import Progress, part_of
from ..fill import patches
from ..fill.editmesh import Added, EditMesh, MeshError, Snapshot
from .regionmesh import AreaError, Region, areas, replace


@dataclass
class Job:
    """The work on one of the meshes being edited."""

    edited: EditMesh
    areas: list[list[int]] = field(default_factory=list)
    """Faces of each."""
    snapshot: Snapshot | None = None
    regions: list[Region] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    left: list[list[int]] = field(default_factory=list)
    """Faces of the areas that stay as they are."""
    added: Added = field(default_factory=Added)

    def find(self) -> None:
        """Find the areas that the selection means."""
        try:
            self.areas = areas(self.edited)
            if self.areas:
                self.snapshot = self.edited.snapshot()
        except (AreaError, MeshError) as error:
            self.problems.append(f"'{self.edited.name}': {error}")
            self.areas = []

    def solve(self, smooth: str, progress: Progress, *, keep_shape: bool) -> None:
        """Mesh the areas anew, without touching the mesh."""
        at = self.snapshot
        taken: set[frozenset[int]] = set()
        for index, faces in enumerate(self.areas):
            triangles = np.flatnonzero(np.isin(at.polygons, faces)).astype(np.int32)
            made = patches.regrid(
                at.positions,
                at.triangles,
                triangles,
                keep_shape=keep_shape,
                smooth=smooth,
                polygons=at.polygons,
                progress=part_of(progress, index / len(self.areas), (index + 1) / len(self.areas)),
            )
            if not isinstance(made, str):
                own = _chords(made.triangles, len(at.positions))
                if own & taken:
                    made = (
                        "it would have an edge that another area gets, too; choose them one after the other"
                    )
                else:
                    taken |= own
            if isinstance(made, str):
                self.problems.append(f"'{self.edited.name}': {made}")
                self.left.append(faces)
            else:
                self.regions.append(Region(faces, triangles, made))


def _chords(triangles: np.ndarray, n: int) -> set[frozenset[int]]:
    """Edges inside a patch between two vertices of the mesh."""
    sides = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    sides, times = np.unique(np.sort(sides[sides.max(axis=1) < n], axis=1), axis=0, return_counts=True)
    return set(map(frozenset, sides[times == 2].tolist()))


def replace_all(jobs: list[Job], *, quads: bool) -> None:
    """Put all patches in the place of their areas, and select them."""
    for job in jobs:
        replace(job.edited, job.snapshot, job.regions, job.added)
        job.edited.finish(job.added, quads=quads)
