"""Semi-regular triangle meshes from drawn closed curves, and grid patches for holes.

``mesh_sketch`` meshes the inside of a drawing, ``inflate`` makes a smooth watertight body of it, ``stitch``
a flat one, ``flat`` a sheet; ``map_sketches`` does many drawings in parallel. ``combine`` unites drawings or
cuts one from another, ``thickness`` measures their limbs; ``trace_image`` finds
the outlines in a picture, ``mesh_cutout`` meshes them all, ``decode_image`` reads its file.
``fill_hole`` and ``fill_holes`` close holes of a mesh with patches that fit their boundaries vertex for
vertex, ``is_outer_border`` tells borders that are no holes, ``bridge`` joins two of them by a tube,
``bridge_pairs`` more two by two, as where they ``look_apart``, ``regrid`` replaces a region by one.
``cut`` divides a mesh along a stroke and caps it; ``cut_reach`` tells how far a stroke's ends go. ``join``
makes one closed mesh of several that overlap. ``harmonic`` carries values on over a mesh, ``bone_weights``
makes a flat one follow bones.
Positions are float64, indices int32, angles radians, options keyword-only. The same input gives the same
bytes. The one exception for what cannot be done is ``GridMeshError``.
"""

from gridmesh._native import (
    Cut,
    Fill,
    GridMeshError,
    Joined,
    Patch,
    Piece,
    Regrid,
    Surface,
    __version__,
    bone_weights,
    bridge,
    bridge_pairs,
    combine,
    cover_sketch,
    cut,
    cut_reach,
    decode_image,
    fill_hole,
    fill_holes,
    flat,
    harmonic,
    inflate,
    is_outer_border,
    join,
    look_apart,
    map_sketches,
    mesh_cutout,
    mesh_sketch,
    regrid,
    stitch,
    thickness,
    trace_image,
)
from gridmesh._traced import Traced

__all__ = [
    "Cut",
    "Fill",
    "GridMeshError",
    "Joined",
    "Patch",
    "Piece",
    "Regrid",
    "Surface",
    "Traced",
    "__version__",
    "bone_weights",
    "bridge",
    "bridge_pairs",
    "combine",
    "cover_sketch",
    "cut",
    "cut_reach",
    "decode_image",
    "fill_hole",
    "fill_holes",
    "flat",
    "harmonic",
    "inflate",
    "is_outer_border",
    "join",
    "look_apart",
    "map_sketches",
    "mesh_cutout",
    "mesh_sketch",
    "regrid",
    "stitch",
    "thickness",
    "trace_image",
]
