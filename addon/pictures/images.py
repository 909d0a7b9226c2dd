# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures in the scene: image empties and image planes, and where their pixels lie in space."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from .tracing import PictureError, check_size

FLAT = 1e-3
"""How far corners of an image plane may be from where its UV map puts them, relative to its size."""


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture and its place: (4, 4) matrix from (u, v, height) to an object's space; heights keep their length."""

    image: bpy.types.Image
    matrix: np.ndarray
    source: bpy.types.Object | None
    """The object that shows it; None for a file."""

    @property
    def label(self) -> str:
        """How messages name it."""
        return f"'{self.source.name}'" if self.source is not None else f"'{self.image.name}'"


def shows_picture(ob: bpy.types.Object) -> bool:
    """Whether the object is an image empty, or a mesh with a picture on it."""
    return _image(ob) is not None


def _image(ob: bpy.types.Object) -> bpy.types.Image | None:
    if ob.type == "EMPTY":
        data = ob.data if ob.empty_display_type == "IMAGE" else None
        return data if isinstance(data, bpy.types.Image) else None
    if ob.type != "MESH" or not ob.data.uv_layers:
        return None
    for slot in ob.material_slots:
        tree = slot.material.node_tree if slot.material is not None else None
        for node in tree.nodes if tree is not None else ():
            if node.type == "TEX_IMAGE" and node.image is not None:
                return node.image
    return None


def of_object(ob: bpy.types.Object) -> Picture:
    """Return the picture that an object shows.

    Raises
    ------
    PictureError
        If its UV map does not lay the picture flat over it.
    """
    image = _image(ob)
    if image is None:
        raise PictureError("it shows no picture; select an image empty or an image plane")
    width, height = size(image)
    if ob.type == "EMPTY":
        across = ob.empty_display_size * np.array([width, height]) / max(width, height)
        corner = across * np.array(ob.empty_image_offset)
        return Picture(image, _frame(corner, [across[0], 0, 0], [0, across[1], 0]), ob)
    return Picture(image, _of_plane(ob.data), ob)


def of_file(image: bpy.types.Image, at: np.ndarray) -> Picture:
    """Return the picture of a file, one unit high, its lower middle at a point."""
    width, height = size(image)
    return Picture(
        image, _frame([at[0] - width / height / 2, at[1], at[2]], [width / height, 0, 0], [0, 0, 1]), None
    )


def size(image: bpy.types.Image) -> tuple[int, int]:
    """Width and height.

    Raises
    ------
    PictureError
        If it could not be loaded, moves, or is too large.
    """
    if image.source in {"MOVIE", "SEQUENCE", "TILED"}:
        raise PictureError("it has more than one frame or tile; save the one that is meant as a picture")
    width, height = image.size
    if width == 0 or height == 0:
        raise PictureError("its file is missing or damaged; find it, or save it again")
    check_size(width, height)
    return width, height


def pixels(image: bpy.types.Image) -> np.ndarray:
    """Colours and alpha (h, w, 4) from 0 to 1, rows from the top; a picture without colours is grey."""
    width, height = size(image)
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(height, width, image.channels)[::-1]
    if image.channels == 4:
        return values
    grey = values[..., :1] if image.channels < 3 else values[..., :3]
    alpha = values[..., 1:2] if image.channels == 2 else np.ones_like(values[..., :1])
    return np.concatenate([np.broadcast_to(grey, (height, width, 3)), alpha], axis=2)


def is_transparent(values: np.ndarray) -> bool:
    """Whether a picture has pixels that are seen through."""
    return bool((values[..., 3] < 0.99).any())


def _frame(corner: object, u: object, v: object) -> np.ndarray:
    """Matrix from (u, v, height) to space."""
    matrix = np.eye(4)
    matrix[: len(np.ravel(corner)), 3] = np.ravel(corner)
    matrix[:3, 0], matrix[:3, 1] = u, v
    normal = np.cross(matrix[:3, 0], matrix[:3, 1])
    matrix[:3, 2] = normal / np.linalg.norm(normal)
    return matrix


def _of_plane(mesh: bpy.types.Mesh) -> np.ndarray:
    """Matrix of a mesh whose UV map is flat: positions are an affine function of it."""
    n = len(mesh.loops)
    uv, co = np.empty(2 * n, np.float32), np.empty(3 * len(mesh.vertices), np.float32)
    at = np.empty(n, np.int32)
    mesh.uv_layers.active.uv.foreach_get("vector", uv)
    mesh.vertices.foreach_get("co", co)
    mesh.loops.foreach_get("vertex_index", at)
    uv, places = uv.reshape(-1, 2).astype(float), co.reshape(-1, 3).astype(float)[at]
    terms = np.column_stack([uv, np.ones(n)])
    affine, _, rank, _ = np.linalg.lstsq(terms, places, rcond=None)
    extent = np.ptp(places, axis=0).max() if n else 0.0
    flat = rank == 3 and np.abs(terms @ affine - places).max() <= FLAT * extent
    if not flat or np.linalg.norm(np.cross(affine[0], affine[1])) <= 1e-12 * extent**2:
        raise PictureError("its UV map does not lay the picture flat over it; use a plane or an image empty")
    return _frame(affine[2], affine[0], affine[1])
