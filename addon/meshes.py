# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies into Blender: new objects, and objects brought up to date in place."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from .api import Body, Failure
from .outlines import Sketch
from .strokes import selected

LINK = "gridmesh_stroke"
"""Custom property of an object that says which stroke it was made from, and where its plane was."""

UV_MAP = "UVMap"


class Transaction:
    """Data blocks made so far; all are removed again if the work is not finished."""

    def __init__(self) -> None:
        self._made: list[tuple[Any, bpy.types.ID]] = []

    def __enter__(self) -> Transaction:
        return self

    def __exit__(self, kind: Any, *_: object) -> None:
        if kind is not None:
            for collection, block in reversed(self._made):
                collection.remove(block)

    def new(self, collection: Any, *arguments: Any) -> Any:
        """Make a data block with `collection.new` and remember it."""
        block = collection.new(*arguments)
        self._made.append((collection, block))
        return block


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
    link = ob.get(LINK)
    if ob.type != "MESH" or not hasattr(link, "get"):
        return None
    key = link.get("source"), link.get("layer"), link.get("stroke")
    return key if None not in key else None


def selected_bodies(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Objects in the selection that were made from strokes."""
    return [ob for ob in selected(context) if stroke_key(ob) is not None]


def obstacle(ob: bpy.types.Object) -> str:
    """Why the object cannot be brought up to date in place; empty if it can."""
    if not ob.is_editable or not ob.data.is_editable:
        return f"'{ob.name}' is linked from another file; make it local or turn off Update Existing"
    if ob.mode != "OBJECT":
        return f"'{ob.name}' is being edited; leave its mode or turn off Update Existing"
    if ob.data.shape_keys is not None:
        return f"'{ob.name}' has shape keys, which fit no new mesh; remove them or turn off Update Existing"
    return ""


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
    context: bpy.types.Context, bodies: list[Body], *, update: bool, collection: str
) -> list[bpy.types.Object]:
    """Make an object of every body, or bring the one made earlier up to date.

    collection : "SOURCE", "ACTIVE" or "NEW". In Object Mode the objects become the selection, the first one
    active. If anything fails, everything made is removed again.
    """
    before = made_before(context) if update else {}
    objects = []
    with Transaction() as transaction:
        into = _Collections(context, transaction, collection)
        for body in bodies:
            ob = before.get(body.sketch.stroke.key)
            objects.append(ob if ob is not None else _new_object(body, into, transaction))
        for body, ob in zip(bodies, objects, strict=True):
            if body.sketch.stroke.key in before:
                _refresh(ob, body)
    _show(context, objects)
    return objects


def _new_object(body: Body, into: _Collections, transaction: Transaction) -> bpy.types.Object:
    stroke = body.sketch.stroke
    mesh = transaction.new(
        bpy.data.meshes, f"{stroke.source}.{stroke.layer}" if stroke.layer else stroke.source
    )
    fill(mesh, body)
    material = surface_material(stroke.material, stroke.filled, transaction)
    if material is not None:
        mesh.materials.append(material)
    ob = transaction.new(bpy.data.objects, f"{stroke.source}.mesh", mesh)
    ob.matrix_basis = Matrix(body.sketch.plane.matrix.tolist())
    ob[LINK] = _link(body)
    into.of(stroke.source).objects.link(ob)
    return ob


def _link(body: Body) -> dict[str, Any]:
    source, layer, index = body.sketch.stroke.key
    matrix = body.sketch.plane.matrix.ravel().tolist()
    return {"source": source, "layer": layer, "stroke": index, "matrix": matrix}


def fill(mesh: bpy.types.Mesh, body: Body) -> None:
    """Put the body's geometry and UV map into an empty mesh. Faces are smooth."""
    triangles = np.ascontiguousarray(body.triangles, np.int32)
    n_corners = triangles.size
    mesh.vertices.add(len(body.vertices))
    mesh.loops.add(n_corners)
    mesh.polygons.add(len(triangles))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(body.vertices, np.float32).ravel())
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.foreach_set("loop_start", np.arange(0, n_corners, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    layer = mesh.uv_layers.new(name=UV_MAP, do_init=False)
    layer.uv.foreach_set("vector", np.ascontiguousarray(body.uv, np.float32).ravel())


def _refresh(ob: bpy.types.Object, body: Body) -> None:
    """Replace the geometry of an object made earlier; keep name, materials, modifiers, children, shading.

    Where the drawing plane moved, the object moves along, from wherever it was put meanwhile.
    """
    mesh = ob.data
    flat_shaded = _flat_shaded(mesh)
    groups = [group.name for group in ob.vertex_groups]
    mesh.clear_geometry()
    fill(mesh, body)
    for name in groups:  # cleared with the geometry, but modifiers refer to them
        if name not in ob.vertex_groups:
            ob.vertex_groups.new(name=name)
    if flat_shaded:
        mesh.shade_flat()
    before = np.array(list(ob[LINK].get("matrix", ())), float)
    now = body.sketch.plane.matrix
    if before.size == 16 and not np.allclose(before.reshape(4, 4), now, rtol=0, atol=1e-6 * body.sketch.size):
        moved = Matrix(before.reshape(4, 4).tolist()).inverted()
        ob.matrix_world = ob.matrix_world @ moved @ Matrix(now.tolist())
    ob[LINK] = _link(body)


def _flat_shaded(mesh: bpy.types.Mesh) -> bool:
    attribute = mesh.attributes.get("sharp_face")
    if attribute is None or not len(attribute.data):
        return False
    sharp = np.empty(len(attribute.data), bool)
    attribute.data.foreach_get("value", sharp)
    return bool(sharp.all())


def surface_material(
    material: bpy.types.Material | None, filled: bool, transaction: Transaction
) -> bpy.types.Material | None:
    """Return the material for a body drawn with `material`: itself, or for grease pencil its surface twin.

    A grease pencil material shows on a mesh as plain grey. Its twin has its colour and the name
    "<name> Surface"; it is made once and found by name afterwards, so that it can be edited.
    """
    if material is None or not material.is_grease_pencil:
        return material
    name = _shortened(material.name, " Surface")
    twin = bpy.data.materials.get(name)
    if twin is not None and not twin.is_grease_pencil:
        return twin
    twin = transaction.new(bpy.data.materials, name)
    color = _color(material.grease_pencil, filled)
    twin.diffuse_color = color
    if twin.node_tree is None:
        twin.use_nodes = True  # before Blender 5.0
    for node in twin.node_tree.nodes:
        if node.type == "BSDF_PRINCIPLED":
            node.inputs["Base Color"].default_value = color
    return twin


def _shortened(name: str, suffix: str) -> str:
    """Return the name with a suffix, cut so that every Blender version can hold it."""
    return name.encode()[: 63 - len(suffix)].decode(errors="ignore") + suffix


def _color(style: bpy.types.MaterialGPencilStyle, filled: bool) -> tuple[float, float, float, float]:
    """Opaque colour of the fill if there is one, else of the stroke."""
    option = style.bl_rna.properties.get("show_fill")  # deprecated in 5.2, where strokes have fills
    if option is not None and not getattr(option, "is_deprecated", False):
        filled = filled or style.show_fill
    return (*(style.fill_color if filled else style.color)[:3], 1.0)


class _Collections:
    """Where new objects go. A new collection is made with the first object that needs it."""

    def __init__(self, context: bpy.types.Context, transaction: Transaction, choice: str):
        self.context, self.transaction, self.choice = context, transaction, choice
        self.usable = set(_usable(context.view_layer.layer_collection))
        self.made: bpy.types.Collection | None = None

    def of(self, source: str) -> bpy.types.Collection:
        if self.choice == "ACTIVE":
            return self.context.collection
        beside = self._beside(source)
        if self.choice == "SOURCE":
            return beside
        if self.made is None:
            self.made = self.transaction.new(bpy.data.collections, f"{source} Bodies")
            beside.children.link(self.made)
        return self.made

    def _beside(self, source: str) -> bpy.types.Collection:
        """First collection of the source that is shown and can be changed, else the active one."""
        ob = self.context.view_layer.objects.get(source)
        own = ob.users_collection if ob is not None else ()
        return next((one for one in own if one in self.usable), self.context.collection)


def _usable(layer_collection: bpy.types.LayerCollection) -> list[bpy.types.Collection]:
    """All collections of the view layer that are not excluded and can be changed."""
    own = layer_collection.collection
    found = [] if layer_collection.exclude or not own.is_editable or own.override_library else [own]
    for child in layer_collection.children:
        found += _usable(child)
    return found


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
