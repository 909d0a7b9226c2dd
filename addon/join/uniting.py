# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes joined to one: the call of `gridmesh.join`, and what becomes of the parts' own elements.

numpy only, no bpy. Points are float64 in the world.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import api
from ..bodies.outlines import LARGEST
from ..text.messages import counted


class JoinError(ValueError):
    """The parts cannot be joined. The message says why and what to do."""

    def __init__(self, message: str, kind: str = "") -> None:
        super().__init__(message)
        self.kind = kind


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh that is to be joined, wound outward."""

    name: str
    vertices: np.ndarray
    """(n, 3)."""
    corners: np.ndarray
    offsets: np.ndarray
    """(m + 1,): face f has the corners `corners[offsets[f]:offsets[f + 1]]`."""


@dataclass(frozen=True, eq=False)
class United:
    """The joined mesh in terms of its parts: what stays, and the collars between."""

    vertices: np.ndarray
    """(v, 3) those of the parts that stay, then new ones."""
    vertex_part: np.ndarray
    """(v,) the part that each comes from, -1 for new ones."""
    source_vertex: np.ndarray
    """(v,) its number there."""
    face_part: np.ndarray
    """(k,) the part of each face that stays."""
    source_face: np.ndarray
    """(k,) its number there."""
    apart: np.ndarray
    """(d, 2) corners of faces that stay that have a vertex of their own where the part has one for several: the face's place among
    those that stay, and the vertex, the second of its source or a later one."""
    collars: np.ndarray
    """(t, 3) new triangles."""
    collar_part: np.ndarray
    """(t,) the part on whose side of the line between parts each lies, -1 where that was not asked for."""
    rims: list[np.ndarray]
    """Closed loops of vertices between what stays and the collars, as the faces that stay run."""
    report: dict[str, Any]


def unite(
    parts: Sequence[Part],
    *,
    blend: float,
    edge_length: float | None,
    strict: bool,
    colors: Sequence[int],
    progress: api.Progress | None = None,
) -> United:
    """Join the parts. colors : a number for each part; lines between parts with different ones run along edges.

    Raises
    ------
    JoinError
        If one of them is no closed mesh, or they cannot be joined, with the library's message.
    api.NativeError
        Without the module.
    api.CancelledError
        If `progress` or Ctrl-C asked to stop.
    """
    gridmesh = api.native("join", "harmonic")
    for part in parts:
        _check(part)
    try:
        with api.cancelling(gridmesh):
            made = gridmesh.join(
                [(part.vertices, (part.corners, part.offsets)) for part in parts],
                blend=blend,
                edge_length=edge_length,
                strict=strict,
                border=colors if len(set(colors)) > 1 else False,
                progress=progress,
            )
    except gridmesh.GridMeshError as error:
        raise JoinError(_named(str(error), parts), error.kind) from error
    stays = made.source_part >= 0
    new = ~stays[: len(made.triangles)]
    return United(
        vertices=made.vertices,
        vertex_part=made.vertex_part,
        source_vertex=made.source_vertex,
        face_part=made.source_part[stays],
        source_face=made.source_face[stays],
        apart=_taken_apart(made) if made.report["separated"] else np.zeros((0, 2), np.int64),
        collars=made.triangles[new],
        collar_part=made.near_part[: len(new)][new],
        rims=[np.asarray(rim) for rims in made.collars for rim in rims],
        report=dict(made.report),
    )


def _taken_apart(made: Any) -> np.ndarray:
    """See `United.apart`."""
    n_old = np.count_nonzero(made.vertex_part >= 0)
    sources = np.column_stack([made.vertex_part, made.source_vertex])[:n_old]
    later = np.setdiff1d(np.arange(n_old), np.unique(sources, axis=0, return_index=True)[1])
    corners = np.flatnonzero(np.isin(made.corners, later))
    faces = np.searchsorted(made.offsets, corners, side="right") - 1
    stays = made.source_part >= 0
    return np.column_stack([np.cumsum(stays)[faces] - 1, made.corners[corners]])[stays[faces]]


def volume(vertices: np.ndarray, corners: np.ndarray, offsets: np.ndarray) -> float:
    """Volume within closed faces, negative where they are wound inward."""
    first = np.repeat(corners[offsets[:-1]], np.diff(offsets))
    a, b, c = vertices[first], vertices[corners], vertices[after(corners, offsets)]
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def after(corners: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """For each corner the next one of its face."""
    following = np.roll(corners, -1)
    following[offsets[1:] - 1] = corners[offsets[:-1]]
    return following


def reversed_faces(corners: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return the corners with every face turned round."""
    place = np.arange(len(corners))
    sizes = np.diff(offsets)
    return corners[np.repeat(offsets[:-1] + offsets[1:] - 1, sizes) - place]


def _check(part: Part) -> None:
    bad = np.flatnonzero(~np.isfinite(part.vertices).all(axis=1))
    if len(bad):
        raise JoinError(
            f"vertex {bad[0]} of '{part.name}' has a coordinate that is not a finite number; move or delete it"
        )
    if np.abs(part.vertices).max(initial=0.0) > LARGEST:
        raise JoinError(f"'{part.name}' reaches farther than {LARGEST:g}; scale it down or move it nearer")
    ends = np.sort(np.column_stack([part.corners, after(part.corners, part.offsets)]), axis=1)
    keys = ends[:, 0].astype(np.int64) * len(part.vertices) + ends[:, 1]
    _, faces = np.unique(keys, return_counts=True)
    # An even number may be of bodies that meet along an edge, which the library takes apart.
    n_open, n_branching = int((faces == 1).sum()), int(((faces > 2) & (faces % 2 == 1)).sum())
    if n_open:
        raise JoinError(
            f"'{part.name}' is not closed: it has {counted(n_open, 'open edge')}; fill its holes or merge doubled vertices",
            "not_closed",
        )
    if n_branching:
        raise JoinError(
            f"'{part.name}' is not manifold: more than two faces meet at {counted(n_branching, 'edge')}; "
            "delete the faces inside",
            "not_closed",
        )


def _named(message: str, parts: Sequence[Part]) -> str:
    """Put the part's name where the library has its number."""

    def name(found: re.Match[str]) -> str:
        number = int(found.group(2))
        return f"{found.group(1)}'{parts[number].name}'" if number < len(parts) else found.group(0)

    return re.sub(r"^(part\s)(\d+)\b", name, message)


def warnings_of(report: dict[str, Any]) -> list[str]:
    """What a joined mesh tells about itself that a user should look at."""
    found = []
    if report["self_intersections"]:
        found.append(
            "The joints meet the parts or themselves; blend less, move a part, or switch Strict on to refuse that"
        )
    if report["creased"]:
        found.append(
            f"{counted(report['creased'], 'joint')} with a crease, since there is no room for a transition; blend less, or give the parts shorter edges there"
        )
    if report["exact"]:
        found.append(
            f"{counted(report['exact'], 'joint')} with thin faces, as the surfaces cut each other; faces are too large there: subdivide the parts"
        )
    if report["alone"]:
        found.append(
            f"{counted(report['alone'], 'part')} without contact to others; moved into another one it would be joined"
        )
    if report["swallowed"]:
        found.append(f"{counted(report['swallowed'], 'part')} inside others left out")
    return found
