from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from typing import Any, Literal, TypedDict, Unpack, final

import numpy as np
import numpy.typing as npt

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
    "__version__",
    "_cut",
    "_fill",
    "_joined",
    "_patch",
    "_piece",
    "_regrid",
    "_surface",
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

__version__: str

_Points = npt.ArrayLike
_Side = float | npt.ArrayLike | None
_Axis = tuple[npt.ArrayLike, npt.ArrayLike]
_Progress = Callable[[float], object]

class _Options(TypedDict, total=False):
    edge_length: float | None
    triangles: int | Literal["auto"] | None
    cells: Literal["triangles", "quads"] | None
    quads: int | Literal["auto"] | None
    max_triangles: int
    boundary: Literal["optimal", "grown"]
    max_distance: float
    closeness: float
    angle: float | None
    origin: _Points | None
    corner_angle: float
    mirror: _Axis | Literal["auto"] | None
    self_crossing: Literal["error", "union"]
    proof_nodes: int
    bend: float | None
    density: Literal["width"] | float | npt.ArrayLike | Sequence[npt.ArrayLike] | None
    relax: bool
    open_corners: bool
    least: bool
    depth: float
    profile: Literal["round", "even", "flat", "peak"]
    curve: npt.ArrayLike | None
    front: _Side
    back: _Side
    uv: Literal["apart", "shared"]
    subdivided: bool

class GridMeshError(ValueError):
    kind: str
    least: int | None

@final
class Patch:
    @property
    def vertices(self) -> npt.NDArray[np.float64]: ...
    @property
    def triangles(self) -> npt.NDArray[np.int32]: ...
    @property
    def quads(self) -> npt.NDArray[np.int32]: ...
    @property
    def loops(self) -> list[npt.NDArray[np.int32]]: ...
    @property
    def arc(self) -> list[npt.NDArray[np.float64]]: ...
    @property
    def source(self) -> list[npt.NDArray[np.float64]]: ...
    @property
    def corner(self) -> list[npt.NDArray[np.float64]]: ...
    @property
    def belt(self) -> Patch: ...
    @property
    def edge_length(self) -> float: ...
    @property
    def angle(self) -> float: ...
    @property
    def origin(self) -> npt.NDArray[np.float64]: ...
    @property
    def report(self) -> dict[str, Any]: ...
    def __copy__(self) -> Patch: ...
    def __deepcopy__(self, _memo: object, /) -> Patch: ...

@final
class Surface:
    @property
    def vertices(self) -> npt.NDArray[np.float64]: ...
    @property
    def triangles(self) -> npt.NDArray[np.int32]: ...
    @property
    def quads(self) -> npt.NDArray[np.int32]: ...
    @property
    def silhouette(self) -> list[npt.NDArray[np.int32]]: ...
    @property
    def corner(self) -> list[npt.NDArray[np.float64]]: ...
    @property
    def uv(self) -> npt.NDArray[np.float64]: ...
    @property
    def report(self) -> dict[str, Any]: ...
    def __copy__(self) -> Surface: ...
    def __deepcopy__(self, _memo: object, /) -> Surface: ...

@final
class Fill:
    @property
    def loop(self) -> npt.NDArray[np.int32]: ...
    @property
    def vertices(self) -> npt.NDArray[np.float64]: ...
    @property
    def triangles(self) -> npt.NDArray[np.int32]: ...
    @property
    def quads(self) -> npt.NDArray[np.int32]: ...
    @property
    def creases(self) -> npt.NDArray[np.int32]: ...
    @property
    def report(self) -> dict[str, Any]: ...
    def extend(
        self, values: npt.ArrayLike, *, progress: _Progress | None = None
    ) -> npt.NDArray[np.float64]: ...
    def refit(
        self, vertices: npt.ArrayLike, *, progress: _Progress | None = None
    ) -> npt.NDArray[np.float64]: ...
    def __copy__(self) -> Fill: ...
    def __deepcopy__(self, _memo: object, /) -> Fill: ...

def mesh_sketch(
    outline: _Points,
    holes: Sequence[_Points] = (),
    *,
    edge_length: float | None = None,
    triangles: int | Literal["auto"] | None = None,
    cells: Literal["triangles", "quads"] | None = None,
    quads: int | Literal["auto"] | None = None,
    max_triangles: int = 20000,
    boundary: Literal["optimal", "grown"] = "optimal",
    max_distance: float = 1.5,
    closeness: float = 0.3,
    angle: float | None = None,
    origin: _Points | None = None,
    corner_angle: float = 0.6981317007977318,
    mirror: _Axis | Literal["auto"] | None = None,
    self_crossing: Literal["error", "union"] = "error",
    proof_nodes: int = 0,
    bend: float | None = None,
    density: Literal["width"] | float | npt.ArrayLike | Sequence[npt.ArrayLike] | None = None,
    keep: Patch | None = None,
    relax: bool = True,
    open_corners: bool = True,
    least: bool = True,
    progress: _Progress | None = None,
) -> Patch: ...
def cover_sketch(
    outline: _Points,
    holes: Sequence[_Points] = (),
    *,
    slack: float = 0.0,
    across: bool = False,
    beyond: float | None = None,
    progress: _Progress | None = None,
    **options: Any,
) -> Patch: ...
def mesh_cutout(
    parts: Sequence[tuple[_Points, Sequence[_Points]]],
    *,
    triangles: int | None = None,
    quads: int | None = None,
    margin: float = 0.0,
    cover: bool = True,
    faint: float = 1.0,
    most: float = 250.0,
    body: dict[str, Any] | None = None,
    progress: _Progress | None = None,
) -> tuple[list[Surface | GridMeshError], Literal["thin", "cut_off", "area", "short", "beside"] | None]: ...
def combine(
    outline: _Points,
    other: _Points,
    holes: Sequence[_Points] = (),
    *,
    how: Literal["union", "difference"] = "union",
) -> list[tuple[npt.NDArray[np.float64], list[npt.NDArray[np.float64]]]]: ...
def thickness(outline: _Points, holes: Sequence[_Points] = ()) -> npt.NDArray[np.float64]: ...
def harmonic(
    vertices: npt.ArrayLike, triangles: npt.ArrayLike, free: npt.ArrayLike, values: npt.ArrayLike
) -> npt.NDArray[np.float64]: ...
def bone_weights(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    bones: npt.ArrayLike,
    *,
    most: int = 4,
    reach: float = 1.0,
    progress: _Progress | None = None,
) -> npt.NDArray[np.float64]: ...
def decode_image(data: bytes) -> npt.NDArray[np.uint8]: ...
def trace_image(
    image: npt.ArrayLike,
    *,
    threshold: float | Literal["auto"] = 0.5,
    smooth: float = 1.0,
    min_area: float = 16,
    margin: float = 0.0,
    background: Literal["transparent", "paper"] = "transparent",
    progress: _Progress | None = None,
) -> Traced: ...
def stitch(patch: Patch) -> Surface: ...
def flat(patch: Patch) -> Surface: ...
def inflate(
    patch: Patch,
    *,
    depth: float = 1.0,
    profile: Literal["round", "even", "flat", "peak"] = "round",
    curve: npt.ArrayLike | None = None,
    front: _Side = None,
    back: _Side = None,
    corner_angle: float = 0.6981317007977318,
    uv: Literal["apart", "shared"] = "apart",
    subdivided: bool = False,
    progress: _Progress | None = None,
) -> Surface: ...

@final
class Regrid:
    @property
    def fill(self) -> Fill: ...
    @property
    def source_faces(self) -> npt.NDArray[np.int32]: ...
    @property
    def source_weights(self) -> npt.NDArray[np.float64]: ...
    @property
    def unused(self) -> npt.NDArray[np.int32]: ...
    @property
    def off(self) -> float: ...
    @property
    def lost(self) -> float: ...
    def __copy__(self) -> Regrid: ...
    def __deepcopy__(self, _memo: object, /) -> Regrid: ...

def fill_hole(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    loop: npt.ArrayLike | Sequence[npt.ArrayLike],
    *,
    smooth: Literal["flat", "tangent", "curvature"] = "tangent",
    strict: bool = False,
    polygons: npt.ArrayLike | None = None,
    sharp: float | None = None,
    creases: npt.ArrayLike | None = None,
    cells: Literal["triangles", "quads"] = "triangles",
    progress: _Progress | None = None,
) -> Fill: ...
def fill_holes(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    loops: Iterable[npt.ArrayLike] | None = None,
    *,
    max_edges: int | None = None,
    smooth: Literal["flat", "tangent", "curvature"] = "tangent",
    strict: bool = False,
    polygons: npt.ArrayLike | None = None,
    sharp: float | None = None,
    creases: npt.ArrayLike | None = None,
    cells: Literal["triangles", "quads"] = "triangles",
    progress: _Progress | None = None,
) -> list[Fill | GridMeshError]: ...
def is_outer_border(points: npt.ArrayLike, into: npt.ArrayLike) -> bool: ...
def bridge(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    loop: npt.ArrayLike,
    other: npt.ArrayLike,
    *,
    smooth: Literal["flat", "tangent", "curvature"] = "tangent",
    rows: int | None = None,
    twist: float = 0.0,
    strict: bool = False,
    polygons: npt.ArrayLike | None = None,
    cells: Literal["triangles", "quads"] = "triangles",
    progress: _Progress | None = None,
) -> Fill: ...
def bridge_pairs(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    loops: Iterable[npt.ArrayLike],
    *,
    smooth: Literal["flat", "tangent", "curvature"] = "tangent",
    rows: int | None = None,
    twist: float = 0.0,
    strict: bool = False,
    polygons: npt.ArrayLike | None = None,
    cells: Literal["triangles", "quads"] = "triangles",
    progress: _Progress | None = None,
) -> list[tuple[int, int, Fill | GridMeshError]]: ...
def look_apart(vertices: npt.ArrayLike, triangles: npt.ArrayLike, loops: Iterable[npt.ArrayLike]) -> bool: ...
def regrid(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    faces: npt.ArrayLike,
    *,
    keep_shape: bool = True,
    smooth: Literal["flat", "tangent", "curvature"] = "tangent",
    strict: bool = False,
    polygons: npt.ArrayLike | None = None,
    cells: Literal["triangles", "quads"] = "triangles",
    progress: _Progress | None = None,
) -> Regrid: ...

@final
class Piece:
    @property
    def vertices(self) -> npt.NDArray[np.float64]: ...
    @property
    def corners(self) -> npt.NDArray[np.int32]: ...
    @property
    def offsets(self) -> npt.NDArray[np.int32]: ...
    @property
    def source_face(self) -> npt.NDArray[np.int32]: ...
    @property
    def source_vertices(self) -> npt.NDArray[np.int32]: ...
    @property
    def source_weights(self) -> npt.NDArray[np.float64]: ...
    @property
    def cap_loops(self) -> list[npt.NDArray[np.int32]]: ...
    @property
    def side(self) -> Literal["left", "right"]: ...
    def __copy__(self) -> Piece: ...
    def __deepcopy__(self, _memo: object, /) -> Piece: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Cut:
    @property
    def pieces(self) -> list[Piece]: ...
    @property
    def report(self) -> dict[str, Any]: ...
    def __copy__(self) -> Cut: ...
    def __deepcopy__(self, _memo: object, /) -> Cut: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

def cut(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike | tuple[npt.ArrayLike, npt.ArrayLike],
    stroke: npt.ArrayLike,
    *,
    direction: npt.ArrayLike | None = None,
    eye: npt.ArrayLike | None = None,
    keep: Literal["left", "right", "both"] = "both",
    cap: bool = True,
    edge_length: float | None = None,
    gap: float = 0.0,
    smooth: Literal["flat", "tangent", "curvature"] = "flat",
    cells: Literal["triangles", "quads"] = "triangles",
    extend_ends: bool = True,
    mirrors: Sequence[Sequence[Sequence[float]]] | npt.NDArray[np.float64] = (),
    mirror_distance: float = 0.0,
    progress: _Progress | None = None,
) -> Cut: ...
def cut_reach(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike | tuple[npt.ArrayLike, npt.ArrayLike],
    stroke: npt.ArrayLike,
    *,
    direction: npt.ArrayLike | None = None,
    eye: npt.ArrayLike | None = None,
    progress: _Progress | None = None,
) -> npt.NDArray[np.float64]: ...

@final
class Joined:
    @property
    def vertices(self) -> npt.NDArray[np.float64]: ...
    @property
    def triangles(self) -> npt.NDArray[np.int32]: ...
    @property
    def quads(self) -> npt.NDArray[np.int32]: ...
    @property
    def corners(self) -> npt.NDArray[np.int32]: ...
    @property
    def offsets(self) -> npt.NDArray[np.int32]: ...
    @property
    def source_part(self) -> npt.NDArray[np.int32]: ...
    @property
    def source_face(self) -> npt.NDArray[np.int32]: ...
    @property
    def near_part(self) -> npt.NDArray[np.int32]: ...
    @property
    def vertex_part(self) -> npt.NDArray[np.int32]: ...
    @property
    def source_vertex(self) -> npt.NDArray[np.int32]: ...
    @property
    def collars(self) -> list[list[npt.NDArray[np.int32]]]: ...
    @property
    def report(self) -> dict[str, Any]: ...
    def __copy__(self) -> Joined: ...
    def __deepcopy__(self, _memo: object, /) -> Joined: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

def join(
    parts: Iterable[
        Surface | Joined | tuple[npt.ArrayLike, npt.ArrayLike | tuple[npt.ArrayLike, npt.ArrayLike]]
    ],
    *,
    blend: float = 2.0,
    edge_length: float | None = None,
    strict: bool = False,
    border: bool | Sequence[int] = False,
    progress: _Progress | None = None,
) -> Joined: ...
def map_sketches(
    outlines: Iterable[_Points | tuple[_Points, Sequence[_Points]]],
    *,
    inflate: bool = True,
    threads: int | None = None,
    executor: Executor | None = None,
    progress: _Progress | None = None,
    **options: Unpack[_Options],
) -> list[Surface | GridMeshError]: ...
def _patch(
    vertices: Any,
    triangles: Any,
    contours: Any,
    inlets: Any,
    lattice: Any,
    report: Any,
    quads: Any,
    belt: Any = None,
) -> Patch: ...
def _surface(
    vertices: Any, triangles: Any, silhouette: Any, uv: Any, report: Any, quads: Any, corner: Any
) -> Surface: ...
def _fill(
    loop: Any,
    backwards: Any,
    later: Any,
    smooth: Any,
    vertices: Any,
    flat: Any,
    positions: Any,
    outer: Any,
    triangles: Any,
    patch: Any,
    creases: Any,
    report: Any,
) -> Fill: ...
def _cut(pieces: Any, report: Any) -> Cut: ...
def _piece(left: Any, positions: Any, faces: Any, cap_loops: Any) -> Piece: ...
def _joined(vertices: Any, faces: Any, sources: Any, collars: Any, report: Any) -> Joined: ...
def _regrid(
    fill: Any, source_faces: Any, source_weights: Any, unused: Any, off: Any, lost: Any
) -> Regrid: ...
