# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes out of Blender: grease pencil, hair curves and annotations, in bulk through numpy.

In world space, or in that of a body.
Curve and text objects are read in `curves`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from ..api import Failure
from ..data import frames
from . import curves, sampling
from .outlines import Stroke

SOURCE_TYPES = {"GREASEPENCIL", "CURVE", "FONT", "CURVES"}

# What the attribute `curve_type` means. Where it is absent, all are Catmull-Rom.
_CATMULL_ROM, _POLY, _BEZIER, _NURBS = range(4)

_RADIUS = 0.01
"""Radius of points where none is stored."""

# What the values of an attribute are called, where not "value".
_VALUES = {"FLOAT_VECTOR": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color"}


@dataclass
class Reading:
    """Strokes found, strokes that could not be read, and why places are empty."""

    strokes: list[Stroke] = field(default_factory=list)
    failures: list[Failure] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    wanted: set[tuple[str, str, int]] | None = None
    """Keys of the strokes that become bodies; the others are there as their holes. None: all."""

    def add(self, other: Reading) -> None:
        """Append what another reading found."""
        self.strokes += other.strokes
        self.failures += other.failures
        self.notes += other.notes


def selected(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Objects in the selection. Blender lists removed ones as None until the view layer is updated."""
    return [ob for ob in context.view_layer.objects.selected if ob is not None]


def source_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Objects whose strokes are meant: the selected ones, or those in the mode of the active one."""
    active = context.view_layer.objects.active
    if active is not None and active.mode != "OBJECT":
        together = context.objects_in_mode_unique_data if active.mode == "EDIT" else [active]
        return [ob for ob in together if ob.type in SOURCE_TYPES]
    chosen = [ob for ob in selected(context) if ob.type in SOURCE_TYPES]
    if chosen:
        return chosen
    return [active] if active is not None and active.type in SOURCE_TYPES else []


def annotation(scene: bpy.types.Scene) -> Any:
    """Return the scene's annotations, or None. They were called `grease_pencil` before Blender 5.0."""
    return scene.annotation if hasattr(scene, "annotation") else scene.grease_pencil


def read_objects(context: bpy.types.Context, objects: list[bpy.types.Object]) -> Reading:
    """Read all strokes of the objects that are not hidden, as modifiers leave them."""
    reading = Reading()
    depsgraph = context.evaluated_depsgraph_get()
    for ob in objects:
        if ob.type == "GREASEPENCIL":
            reading.add(read_grease_pencil(ob, depsgraph))
        elif ob.type == "CURVES":
            reading.add(read_hair(ob, depsgraph))
        else:
            strokes, failures, notes = curves.read(context, ob)
            reading.add(Reading(strokes, failures, notes))
    return reading


def _shown(ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Any:
    """Return the data that is seen: after the modifiers where there are any."""
    modified = any(modifier.show_viewport for modifier in ob.modifiers)
    return ob.evaluated_get(depsgraph).data if modified else ob.data


def read_grease_pencil(
    ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph, frame: np.ndarray | None = None
) -> Reading:
    """Read the strokes of the visible layers at the current frame.

    frame : (4, 4) from the space of what carries the layers to where the strokes are wanted; None: the world.
    """
    reading = Reading()
    data = _shown(ob, depsgraph)
    if not len(data.layers):
        reading.notes.append(f"'{ob.name}' has no layers; draw a closed shape in it")
        return reading
    visible = [layer for layer in data.layers if not _hidden(layer)]
    if not visible:
        reading.notes.append(f"all layers of '{ob.name}' are hidden; show the one to use")
        return reading
    drawings = [(layer, layer.current_frame()) for layer in visible]
    if all(shown is None for _, shown in drawings):
        reading.notes.append(f"'{ob.name}' has no drawing at the current frame; go to a frame that has one")
        return reading
    for layer, shown in drawings:
        if shown is None or shown.drawing is None or not len(shown.drawing.strokes):
            continue
        drawing = shown.drawing
        offsets = np.empty(len(drawing.curve_offsets), np.int32)
        drawing.curve_offsets.foreach_get("value", offsets)
        matrix = frames.carrier_world(ob, layer.name) if frame is None else frame
        matrix = matrix @ frames.layer_matrix(layer)
        reading.add(_read_geometry(ob, layer.name, drawing.attributes, offsets, matrix))
    if not reading.strokes and not reading.failures:
        reading.notes.append(f"the visible layers of '{ob.name}' have no strokes; draw a closed shape in one")
    return reading


def _hidden(layer: Any) -> bool:
    """Whether the layer or a group around it is hidden."""
    node = layer
    while node is not None:
        if node.hide:
            return True
        node = node.parent_group
    return False


def read_hair(
    ob: bpy.types.Object, depsgraph: bpy.types.Depsgraph, frame: np.ndarray | None = None
) -> Reading:
    """Read the curves of a curves object. frame : (4, 4) from its space to where they are wanted; None: the world."""
    data = _shown(ob, depsgraph)
    if not len(data.curves):
        return Reading(notes=[f"'{ob.name}' has no curves; draw a closed shape in it"])
    offsets = np.empty(len(data.curve_offset_data), np.int32)
    data.curve_offset_data.foreach_get("value", offsets)
    matrix = np.array(ob.matrix_world) if frame is None else frame
    return _read_geometry(ob, "", data.attributes, offsets, matrix)


class _Attributes:
    """Attributes of a curves geometry as arrays; absent ones have their default everywhere."""

    def __init__(self, attributes: Any, n_points: int, n_curves: int):
        self.attributes = attributes
        self.sizes = {"POINT": n_points, "CURVE": n_curves}

    def read(self, name: str, domain: str, default: Any) -> np.ndarray:
        default = np.asarray(default)
        size = self.sizes[domain]
        values = np.empty((size, *default.shape), default.dtype)
        values[:] = default
        attribute = self.attributes.get(name)
        if attribute is not None and attribute.domain == domain and len(attribute.data) == size:
            key = _VALUES.get(attribute.data_type, "value")
            flat = values.reshape(-1)
            attribute.data.foreach_get(key, flat)
        return values

    def vectors(self, name: str) -> np.ndarray | None:
        if self.attributes.get(name) is None:
            return None
        return self.read(name, "POINT", np.zeros(3, np.float32)).astype(float)

    def selected(self, offsets: np.ndarray) -> np.ndarray:
        """Whether each curve, or a point of it, is selected; all are where the attribute is absent."""
        attribute = self.attributes.get(".selection")
        if attribute is None:
            return np.ones(self.sizes["CURVE"], bool)
        if attribute.domain == "CURVE":
            return self.read(".selection", "CURVE", np.bool_(True))
        before = np.concatenate([[0], np.cumsum(self.read(".selection", "POINT", np.bool_(True)))])
        return before[offsets[1:]] > before[offsets[:-1]]

    def painted(self, offsets: np.ndarray) -> np.ndarray:
        """Whether each curve has colours painted over those of its material."""
        clear = np.zeros(4, np.float32)
        before = np.concatenate([[0], np.cumsum(self.read("vertex_color", "POINT", clear)[:, 3] > 0)])
        return (before[offsets[1:]] > before[offsets[:-1]]) | (
            self.read("fill_color", "CURVE", clear)[:, 3] > 0
        )


def _read_geometry(
    ob: bpy.types.Object, layer: str, attributes: Any, offsets: np.ndarray, matrix: np.ndarray
) -> Reading:
    """Read strokes of a drawing; `offsets` (strokes + 1,) says where each begins."""
    reading = Reading()
    n_curves = len(offsets) - 1
    table = _Attributes(attributes, int(offsets[-1]), n_curves)
    positions = table.vectors("position")
    cyclic = table.read("cyclic", "CURVE", np.bool_(False))
    selected = table.selected(offsets)
    materials = table.read("material_index", "CURVE", np.int32(0))
    filled = table.read("fill_id", "CURVE", np.int32(0)) != 0  # from Blender 5.2 on
    painted = table.painted(offsets)
    widths = table.read("radius", "POINT", np.float32(_RADIUS)).astype(float)
    kinds = table.read("curve_type", "CURVE", np.int8(_CATMULL_ROM))
    sample = _sampler(table, positions, cyclic, offsets)
    slots = [slot.material for slot in ob.material_slots]
    for index in range(n_curves):
        material = int(materials[index])
        about = {
            "cyclic": bool(cyclic[index]),
            "source": ob.name,
            "layer": layer,
            "index": index,
            "count": n_curves,
            "selected": bool(selected[index]),
            "material": slots[material] if 0 <= material < len(slots) else None,
            "filled": bool(filled[index]),
            "painted": bool(painted[index]),
        }
        try:
            points = sample(index)
        except sampling.SamplingError as error:
            stroke = Stroke(points=np.zeros((0, 3)), **about)
            reading.failures.append(Failure(stroke.label, str(error)))
            continue
        with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is refused by name later
            points = frames.moved(points, matrix)
        own = widths[offsets[index] : offsets[index + 1]] if kinds[index] == _POLY else None
        reading.strokes.append(Stroke(points=points, widths=own, **about))
    return reading


def _sampler(table: _Attributes, positions: np.ndarray, cyclic: np.ndarray, offsets: np.ndarray) -> Any:
    """Return the function from a stroke's index to its polyline (n, 3) in the layer's space."""
    kinds = table.read("curve_type", "CURVE", np.int8(_CATMULL_ROM))
    resolutions = np.maximum(table.read("resolution", "CURVE", np.int32(sampling.RESOLUTION)), 1)
    left, right = table.vectors("handle_left"), table.vectors("handle_right")
    orders = table.read("nurbs_order", "CURVE", np.int8(4))
    knots = table.read("knots_mode", "CURVE", np.int8(0))
    weights = table.read("nurbs_weight", "POINT", np.float32(1.0)).astype(float)

    def sample(index: int) -> np.ndarray:
        at = slice(offsets[index], offsets[index + 1])
        points, closed, resolution = positions[at], bool(cyclic[index]), int(resolutions[index])
        if kinds[index] == _BEZIER:
            if left is None or right is None:
                raise sampling.SamplingError(
                    "it is a Bezier stroke without handles; set its handle type to Automatic or its type to Poly"
                )
            return sampling.bezier(points, left[at], right[at], closed, resolution)
        if kinds[index] == _CATMULL_ROM:
            return sampling.catmull_rom(points, closed, resolution)
        if kinds[index] == _NURBS:
            order, mode = int(orders[index]), int(knots[index])
            return sampling.nurbs(points, weights[at], closed, order, mode, resolution)
        return points

    return sample


def read_annotations(context: bpy.types.Context) -> Reading:
    """Read the annotation strokes of the scene at the current frame. They have no materials."""
    data = annotation(context.scene)
    if data is None:
        return Reading(notes=["the scene has no annotations; draw some with the Annotate tool"])
    reading = Reading()
    for layer, frame in _annotation_frames(data, context.scene.frame_current):
        count = len(frame.strokes)
        for index, stroke in enumerate(frame.strokes):
            points = np.empty(len(stroke.points) * 3, np.float32)
            stroke.points.foreach_get("co", points)
            reading.strokes.append(
                Stroke(
                    points=points.reshape(-1, 3).astype(float),
                    cyclic=False,
                    source=data.name,
                    layer=layer.info,
                    index=index,
                    count=count,
                )
            )
    if not reading.strokes:
        reading.notes.append(
            "the visible layers of the annotations have no strokes; draw with the Annotate tool"
        )
    return reading


def _annotation_frames(data: Any, current: int) -> Iterator[tuple[Any, Any]]:
    """Visible layers with the frame that is shown: the last one that is not in the future."""
    for layer in data.layers:
        begun = [frame for frame in layer.frames if frame.frame_number <= current]
        if begun and not layer.annotation_hide:
            yield layer, max(begun, key=lambda frame: frame.frame_number)
