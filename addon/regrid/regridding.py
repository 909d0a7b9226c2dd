# SPDX-License-Identifier: GPL-3.0-or-later
"""Areas of a mesh being edited, found and meshed anew: what the operator does."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ..api import Progress, part_of
from ..fill import patches
from ..fill.editmesh import Added, EditMesh, MeshError
from ..fill.patches import Snapshot
from .regionmesh import AreaError, Region, areas, named_areas, replace


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
        self._take(lambda: areas(self.edited))

    def find_named(self, name: str | None) -> None:
        """Find the areas of a vertex group, material or face attribute; without a name, those of one material each."""
        self._take(lambda: named_areas(self.edited, name))

    def _take(self, found: Callable[[], list[list[int]]]) -> None:
        try:
            self.areas = found()
            if self.areas:
                self.snapshot = self.edited.snapshot()
        except (AreaError, MeshError) as error:
            self.problems.append(f"'{self.edited.name}': {error}")
            self.areas = []

    def _hides(self, faces: list[int]) -> bool:
        """Whether hidden faces share an edge with some."""
        own = (self.edited.bm.faces[face] for face in faces)
        return any(other.hide for face in own for edge in face.edges for other in edge.link_faces)

    def solve(self, smooth: str, progress: Progress, *, keep_shape: bool, cells: str = "triangles") -> None:
        """Mesh the areas anew, without touching the mesh. cells : "triangles" or "quads"."""
        at = self.snapshot
        taken: set[frozenset[int]] = set()
        for index, faces in enumerate(self.areas):
            triangles = np.flatnonzero(np.isin(at.polygons, faces)).astype(np.int32)
            made = patches.regrid(
                at,
                triangles,
                part_of(progress, index / len(self.areas), (index + 1) / len(self.areas)),
                keep_shape=keep_shape,
                smooth=smooth,
                cells=cells,
            )
            if not isinstance(made, str):
                own = _chords([*made.quads.tolist(), *made.triangles.tolist()], len(at.positions))
                if own & taken:
                    made = (
                        "it would have an edge that another area gets, too; choose them one after the other"
                    )
                else:
                    taken |= own
            if isinstance(made, str) and self._hides(faces):
                made = "hidden faces lie beside or within the area; reveal them first"
            if isinstance(made, str):
                self.problems.append(f"'{self.edited.name}': {made}")
                self.left.append(faces)
            else:
                self.regions.append(Region(faces, triangles, made))


def _chords(faces: list[list[int]], n: int) -> set[frozenset[int]]:
    """Edges inside a patch between two vertices of the mesh."""
    times = Counter(frozenset((face[k - 1], face[k])) for face in faces for k in range(len(face)))
    return {side for side, count in times.items() if count == 2 and max(side) < n}


def replace_all(jobs: list[Job]) -> None:
    """Put all patches in the place of their areas, and select them."""
    for job in jobs:
        replace(job.edited, job.snapshot, job.regions, job.added)
        job.edited.finish(job.added)
