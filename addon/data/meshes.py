# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies into Blender: new objects, and objects brought up to date in place."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..api import Body, Failure
from ..bodies.outlines import Sketch, transformed
from ..bodies.strokes import selected
from ..fill.creases import rim_creases
from . import colors, frames
from .placing import Collections, Transaction
from .written import by_hand, is_edited, sign

LINK = "gridmesh_stroke"
"""Custom property of a body without a link that says which stroke it was made from, and how it lies to that."""

UV_MAP = "UVMap"


def made_before(context: bpy.types.Context) -> dict[tuple[str, str, int], bpy.types.Object]:
    """Objects of this view layer that were made from strokes, by stroke; the first one of duplicates."""
    found: dict[tuple[str, str, int], bpy.types.Object] = {}
    for ob in filter(None, context.view_layer.objects):
        key = stroke_key(ob)
        if key is not None:
            found.setdefault(key, ob)
    return found


def stroke_key(ob: bpy.types.Object) -> tuple[str, str, int] | None:
    """Key of the stroke that the object was made from, or None."""
    if ob.type != "MESH":
        return None
    if frames.is_linked(ob):
        live = ob.gridmesh_live
        return None if live.source is None else (live.source.name, live.layer, live.stroke)
    link = ob.get(LINK)
    if not hasattr(link, "get"):
        return None
    key = link.get("source"), link.get("layer"), link.get("stroke")
    return key if None not in key else None


def frame(ob: bpy.types.Object, carrier: np.ndarray) -> np.ndarray:
    """Matrix (4, 4) from what carries the strokes of a body, linked or not, to the body's space.

    carrier : matrix from there to the world.
    """
    return frames.frame(ob) if frames.is_linked(ob) else frame_of_link(ob, carrier)


def frame_of_link(ob: bpy.types.Object, carrier: np.ndarray) -> np.ndarray:
    """Return the frame that a body without a link remembers; see `frame`."""
    link = ob[LINK]
    values = np.array(list(link.get("frame", ())), float)
    if values.size == 16:
        return values.reshape(4, 4)
    values = np.array(
        list(link.get("matrix", ())), float
    )  # of 0.1.0: from the body's space to the world, then
    return np.linalg.inv(values.reshape(4, 4)) @ carrier if values.size == 16 else np.eye(4)


def selected_bodies(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Objects in the selection that were made from strokes."""
    return [ob for ob in selected(context) if stroke_key(ob) is not None]


def obstacle(ob: bpy.types.Object) -> str:
    """Why the object cannot be brought up to date in place; empty if it can."""
    if not ob.is_editable or not ob.data.is_editable:
        return f"'{ob.name}' is linked from another file; make it local or turn off Update Existing"
    if is_edited(ob):
        return f"'{ob.name}' is being edited; leave its mode or turn off Update Existing"
    if ob.data.shape_keys is not None:
        return f"'{ob.name}' has shape keys, which fit no new mesh; remove them or turn off Update Existing"
    if by_hand(ob.data) and (frames.is_linked(ob) or "frame" in ob[LINK]):  # 0.1.0 did not remember
        return (
            f"'{ob.name}' was changed by hand and is left as it is; delete it, press Rebuild from Outline "
            "in the panel Live Body, or turn off Update Existing"
        )
    return ""


def obstacle_of_mesh(ob: bpy.types.Object) -> str:
    """Why the mesh of an object cannot be replaced; empty if it can."""
    if not ob.is_editable or not ob.data.is_editable:
        return "it is linked from another file; make it local"
    if ob.data.shape_keys is not None:
        return "it has shape keys, which fit no new mesh; remove them"
    if by_hand(ob.data):
        return "it was changed by hand and is left as it is; make it anew from the picture"
    return ""


def made_from_holes(context: bpy.types.Context, sketches: list[Sketch]) -> list[str]:
    """Tell which objects were made from strokes that are holes of others now; they are left as they are."""
    before = made_before(context)
    holes = [hole.stroke for sketch in sketches for hole in sketch.holes]
    return [
        f"{stroke.label}: it is a hole now; '{before[stroke.key].name}' was made from it and is left as it is"
        for stroke in holes
        if stroke.key in before
    ]


def separate_blocked(
    context: bpy.types.Context, sketches: list[Sketch]
) -> tuple[list[Sketch], list[Failure]]:
    """Sketches whose object is new or can be brought up to date, and the others with the reason."""
    free: list[Sketch] = []
    failures: list[Failure] = []
    before = made_before(context)
    for sketch in sketches:
        target = before.get(sketch.stroke.key)
        reason = obstacle(target) if target is not None else ""
        if reason:
            failures.append(Failure(sketch.stroke.label, reason))
        else:
            free.append(sketch)
    return free, failures


def place(
    context: bpy.types.Context,
    bodies: list[Body],
    *,
    update: bool,
    collection: str,
    crease_angle: float,
    made: list[bpy.types.Object] | None = None,
) -> list[str]:
    """Make an object of every body, or bring the one made earlier up to date; return what is worth telling.

    The objects are appended to `made`, one for each body.

    collection : "SOURCE", "ACTIVE" or "NEW". crease_angle : in radians, creases from which on are marked sharp.
    In Object Mode the objects become the selection, the first one active. If anything fails, everything made
    is removed again.
    """
    before = made_before(context) if update else {}
    objects = []
    with Transaction() as transaction:
        into = Collections(context, transaction, collection)
        for body in bodies:
            ob = before.get(body.sketch.stroke.key)
            objects.append(
                ob if ob is not None else _new_object(context, body, into, transaction, crease_angle)
            )
        for body, ob in zip(bodies, objects, strict=True):
            if body.sketch.stroke.key in before:
                refresh(ob, in_space(body, frames.space(ob)), crease_angle)
                if LINK in ob:
                    ob[LINK] = _link(body, frame(ob, _carrier_world(context, body.sketch)))
    _show(context, objects)
    if made is not None:
        made += objects
    return list(dict.fromkeys(transaction.notes))


def localized(context: bpy.types.Context, sketches: list[Sketch], close_gaps: float) -> list[Sketch]:
    """Take the sketches (world) that have an object already into its space; the others stay as they are."""
    before = made_before(context)
    found = []
    for sketch in sketches:
        ob = before.get(sketch.stroke.key)
        if ob is None:
            found.append(sketch)
            continue
        carrier = _carrier_world(context, sketch)
        matrix = frame(ob, carrier) @ np.linalg.inv(carrier)
        found.append(transformed(sketch, matrix, close_gaps))
    return found


def in_space(body: Body, matrix: np.ndarray | None = None) -> Body:
    """Return the body with its vertices where its sketch is, and not in the plane of that; then moved by `matrix`.

    Where that mirrors, the faces are turned round, so that they still face outward.
    """
    vertices = body.sketch.plane.world(body.vertices)
    if matrix is None:
        return replace(body, vertices=vertices)
    body = replace(body, vertices=frames.moved(vertices, matrix))
    if np.linalg.det(matrix[:3, :3]) > 0:
        return body
    faces = np.asarray(body.faces)
    order = np.roll(np.arange(faces.shape[1])[::-1], 1)
    uv = np.asarray(body.uv).reshape(*faces.shape, 2)[:, order].reshape(np.shape(body.uv))
    return replace(body, faces=faces[:, order], uv=uv)


def _carrier_world(context: bpy.types.Context, sketch: Sketch) -> np.ndarray:
    """Matrix from what carries a sketch to the world; annotations are in the world."""
    source = context.view_layer.objects.get(sketch.stroke.source)
    return np.eye(4) if source is None else frames.carrier_world(source, sketch.stroke.layer)


def _new_object(
    context: bpy.types.Context,
    body: Body,
    into: Collections,
    transaction: Transaction,
    crease_angle: float,
) -> bpy.types.Object:
    stroke = body.sketch.stroke
    mesh = transaction.new(
        bpy.data.meshes, f"{stroke.source}.{stroke.layer}" if stroke.layer else stroke.source
    )
    fill(mesh, body, crease_angle)
    material = surface_material(stroke.material, stroke.filled, transaction)
    painted = colors.of_sketch(body.sketch, surface_color(stroke.material, stroke.filled))
    if painted is not None and painted.several:
        name = _shortened(stroke.material.name, " Colors")
        material = colors.material(name, painted.surface, transaction)
    if material is not None:
        mesh.materials.append(material)
    ob = transaction.new(bpy.data.objects, f"{stroke.source}.mesh", mesh)
    ob.matrix_basis = Matrix(body.sketch.plane.matrix.tolist())
    ob[LINK] = _link(body, np.linalg.inv(body.sketch.plane.matrix) @ _carrier_world(context, body.sketch))
    into.of(stroke.source).objects.link(ob)
    return ob


def _link(body: Body, matrix: np.ndarray) -> dict[str, Any]:
    source, layer, index = body.sketch.stroke.key
    return {"source": source, "layer": layer, "stroke": index, "frame": matrix.ravel().tolist()}


def fill(mesh: bpy.types.Mesh, body: Body, crease_angle: float) -> None:
    """Put the body's geometry and UV map into an empty mesh. Faces are smooth, creases marked sharp.

    body : with vertices in the space of the mesh.
    """
    faces = np.ascontiguousarray(body.faces, np.int32)
    n_corners = faces.size
    mesh.vertices.add(len(body.vertices))
    mesh.loops.add(n_corners)
    mesh.polygons.add(len(faces))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(body.vertices, np.float32).ravel())
    mesh.loops.foreach_set("vertex_index", faces.ravel())
    mesh.polygons.foreach_set("loop_start", np.arange(0, n_corners, faces.shape[1], dtype=np.int32))
    mesh.update(calc_edges=True)
    layer = mesh.uv_layers.new(name=UV_MAP, do_init=False)
    layer.uv.foreach_set("vector", np.ascontiguousarray(body.uv, np.float32).ravel())
    mark_creases(mesh, body, crease_angle)
    _paint(mesh, body)
    sign(mesh)


def _paint(mesh: bpy.types.Mesh, body: Body) -> None:
    """Give the vertices the colours of the drawing, if it has more than one."""
    if body.sketch is None:
        return
    stroke = body.sketch.stroke
    painted = colors.of_sketch(body.sketch, surface_color(stroke.material, stroke.filled))
    if painted is not None:
        colors.paint(mesh, body.silhouette, painted)


def mark_creases(mesh: bpy.types.Mesh, body: Body, angle: float) -> None:
    """Mark the edges along the rim sharp where front and back meet at more than `angle`, and no others.

    Of quads they are creased, too, and the corners of the drawing: a Subdivision Surface modifier keeps both. A rim that
    was placed for it is not: it would not come to lie on the drawing.
    """
    edges = np.empty(len(mesh.edges) * 2, np.int32)
    mesh.edges.foreach_get("vertices", edges)
    sides = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", sides)
    edges, sides = edges.reshape(-1, 2), sides.reshape(np.shape(body.faces))
    sharp = rim_creases(body.vertices, body.faces, body.silhouette, edges, sides, angle)
    if sharp.any() or mesh.attributes.get("sharp_edge") is not None:
        mesh.edges.foreach_set("use_edge_sharp", sharp)
    if np.shape(body.faces)[1] == 4:  # to be subdivided
        corners = np.zeros(len(mesh.vertices), np.float32)
        for loop, turn in zip(body.silhouette, body.corner, strict=True):
            corners[loop] = np.asarray(turn) != 0
        _put(mesh, "crease_vert", "POINT", corners)
        _put(mesh, "crease_edge", "EDGE", (sharp & (not body.smooth_rim)).astype(np.float32))


def _put(mesh: bpy.types.Mesh, name: str, domain: str, values: np.ndarray) -> None:
    """Set an attribute of numbers, which is not there where all are 0."""
    attribute = mesh.attributes.get(name)
    if attribute is None and values.any():
        attribute = mesh.attributes.new(name, "FLOAT", domain)
    if attribute is not None:
        attribute.data.foreach_set("value", values)


def refresh(ob: bpy.types.Object, body: Body, crease_angle: float) -> None:
    """Replace the geometry of an object made earlier; keep name, materials, modifiers, children, shading, place.

    body : with vertices in the object's space.
    """
    mesh = ob.data
    flat_shaded = _flat_shaded(mesh)
    groups = [group.name for group in ob.vertex_groups]
    mesh.clear_geometry()
    fill(mesh, body, crease_angle)
    for name in groups:  # cleared with the geometry, but modifiers refer to them
        if name not in ob.vertex_groups:
            ob.vertex_groups.new(name=name)
    if flat_shaded:
        mesh.shade_flat()


def _flat_shaded(mesh: bpy.types.Mesh) -> bool:
    attribute = mesh.attributes.get("sharp_face")
    if attribute is None or not len(attribute.data):
        return False
    sharp = np.empty(len(attribute.data), bool)
    attribute.data.foreach_get("value", sharp)
    return bool(sharp.all())


BLACK = 0.02
"""Ink with no channel above this, in linear colour, is black."""


def surface_material(
    material: bpy.types.Material | None, filled: bool, transaction: Transaction
) -> bpy.types.Material | None:
    """Return the material for a body drawn with `material`: itself, or for grease pencil its twin.

    A grease pencil material shows on a mesh as plain grey. Its twins have its colours: "<name> Surface" that of
    the stroke, "<name> Fill" that of the fill, for bodies of filled strokes. Each is made once and found by name
    afterwards, so that it can be edited. Black ink is for drawing with, as Blender's first pencil is: a body
    drawn with it has no material, and shows its form.
    """
    if material is None or not material.is_grease_pencil:
        return material
    color = surface_color(material, filled)
    if color is None:
        return None
    filled = filled or colors.shows(material.grease_pencil, "show_fill", False)
    name = _shortened(material.name, " Fill" if filled else " Surface")
    twin = bpy.data.materials.get(name)
    if twin is not None and not twin.is_grease_pencil:
        if not np.allclose(twin.diffuse_color, color, atol=1e-3):
            transaction.notes.append(f"material '{name}' was there and is used with its own colour")
        return twin
    twin = transaction.new(bpy.data.materials, name)
    twin.diffuse_color = color
    if twin.node_tree is None:
        twin.use_nodes = True  # before Blender 5.0
    for node in twin.node_tree.nodes:
        if node.type == "BSDF_PRINCIPLED":
            node.inputs["Base Color"].default_value = color
    return twin


def surface_color(material: bpy.types.Material | None, filled: bool) -> tuple[float, ...] | None:
    """Return the colour of a body drawn with a grease pencil material; None for black ink and for other materials."""
    if material is None or not material.is_grease_pencil:
        return None
    style = material.grease_pencil
    filled = filled or colors.shows(style, "show_fill", False)
    color = (*(style.fill_color if filled else style.color)[:3], 1.0)
    return None if not filled and max(color[:3]) < BLACK else color


def _shortened(name: str, suffix: str) -> str:
    """Return the name with a suffix, cut so that every Blender version can hold it."""
    return name.encode()[: 63 - len(suffix)].decode(errors="ignore") + suffix


def _show(context: bpy.types.Context, objects: list[bpy.types.Object]) -> None:
    """Select the objects and make the first active, unless something is being edited or drawn."""
    view_layer = context.view_layer
    space = context.space_data
    if space is not None and space.type == "VIEW_3D" and space.local_view is not None:
        for ob in objects:
            ob.local_view_set(space, True)
    active = view_layer.objects.active
    if active is not None and active.mode != "OBJECT":
        return
    for ob in selected(context):
        ob.select_set(False)
    for ob in objects:
        ob.select_set(True)
    view_layer.objects.active = objects[0]
