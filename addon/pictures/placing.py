# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut-outs into Blender: objects with the picture on them, and what they remember to be made anew."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import bpy
import numpy as np

from ..api import Body
from ..data import meshes
from ..data.placing import Transaction
from .cutouts import Cutout
from .images import Picture
from .tracing import Options
from .weights import Kept

LINK = "gridmesh_picture"
"""Custom property of an object made from a picture: how it was made."""

PLACE = (
    "location",
    "rotation_mode",
    "rotation_euler",
    "rotation_quaternion",
    "rotation_axis_angle",
    "scale",
    "delta_location",
    "delta_rotation_euler",
    "delta_rotation_quaternion",
    "delta_scale",
)
"""Where an object is, relative to its parent."""

CREASE = float(np.radians(40))


def body_of(cutout: Cutout, matrix: np.ndarray, width: int, height: int) -> Body:
    """Return the mesh in the space that the matrix of its picture leads to."""
    scale = np.sqrt(np.linalg.norm(matrix[:3, 0]) / width * np.linalg.norm(matrix[:3, 1]) / height)
    local = np.column_stack([cutout.vertices[:, :2] / [width, height], cutout.vertices[:, 2] * scale])
    vertices = local @ matrix[:3, :3].T + matrix[:3, 3]
    return Body(
        sketch=None,
        vertices=vertices,
        faces=cutout.faces,
        uv=cutout.uv,
        silhouette=cutout.silhouette,
        corner=cutout.corner,
        report={},
    )


def make(
    picture: Picture,
    cutout: Cutout,
    options: Options,
    material: bpy.types.Material,
    collection: bpy.types.Collection,
    transaction: Transaction,
) -> bpy.types.Object:
    """Make the object of a cut-out, with the origin, scale and parent of the picture's own."""
    width, height = picture.image.size
    name = bpy.path.display_name(picture.image.name, has_ext=True, title_case=False)
    mesh = transaction.new(bpy.data.meshes, name)
    meshes.fill(mesh, body_of(cutout, picture.matrix, width, height), CREASE)
    mesh.materials.append(material)
    ob = transaction.new(bpy.data.objects, name, mesh)
    collection.objects.link(ob)
    if picture.source is not None:
        ob.parent, ob.parent_type = picture.source.parent, picture.source.parent_type
        ob.parent_bone = picture.source.parent_bone
        ob.matrix_parent_inverse = picture.source.matrix_parent_inverse
        for channel in PLACE:
            setattr(ob, channel, getattr(picture.source, channel))
    remember(ob, picture, options)
    return ob


def remember(ob: bpy.types.Object, picture: Picture, options: Options) -> None:
    """Note how the object was made."""
    kept = {name: value for name, value in asdict(options).items() if value is not None}
    ob[LINK] = {"matrix": picture.matrix.ravel().tolist(), "options": kept}


def made_from_picture(ob: bpy.types.Object) -> bool:
    """Whether an object can be made anew from its picture."""
    return ob.type == "MESH" and hasattr(ob.get(LINK), "get")


def recall(ob: bpy.types.Object) -> tuple[np.ndarray, Options]:
    """Return how an object was made: the matrix of its picture, and the options."""
    link = ob[LINK].to_dict()
    values: dict[str, Any] = link["options"]
    return np.reshape(link["matrix"], (4, 4)), Options(**values)


def update(ob: bpy.types.Object, cutout: Cutout, image: bpy.types.Image) -> None:
    """Replace the mesh of an object; all else of it stays, weights at the places where they were."""
    width, height = image.size
    matrix = recall(ob)[0]
    kept = Kept(ob, matrix[:3, 2])
    meshes.refresh(ob, body_of(cutout, matrix, width, height), CREASE)
    kept.put(ob)


def material_of(
    image: bpy.types.Image, *, lit: bool, transparent: bool, transaction: Transaction
) -> bpy.types.Material:
    """Material with a picture on it, shining by itself or lit; one for each picture and way, found again by its nodes."""
    for material in bpy.data.materials:
        if material.get("gridmesh_image") == _key(image, lit, transparent) and _texture(material) == image:
            return material
    material = transaction.new(bpy.data.materials, image.name)
    if material.node_tree is None:
        material.use_nodes = True  # before Blender 5.0
    tree = material.node_tree
    tree.nodes.clear()
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.extension = image, "EXTEND"
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    texture.location, shader.location, output.location = (-400, 200), (-50, 200), (300, 200)
    if lit:
        tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    else:
        shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
        shader.inputs["Specular IOR Level"].default_value = 0
        shader.inputs["Roughness"].default_value = 1
        shader.inputs["Emission Strength"].default_value = 1
        tree.links.new(texture.outputs["Color"], shader.inputs["Emission Color"])
    if transparent:
        tree.links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
    tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    material["gridmesh_image"] = _key(image, lit, transparent)
    return material


def _key(image: bpy.types.Image, lit: bool, transparent: bool) -> str:
    return f"{image.name}/{int(lit)}{int(transparent)}"


def _texture(material: bpy.types.Material) -> bpy.types.Image | None:
    nodes = material.node_tree.nodes if material.node_tree is not None else ()
    return next((node.image for node in nodes if node.type == "TEX_IMAGE"), None)


def picture_of(ob: bpy.types.Object) -> bpy.types.Image | None:
    """Return the picture on an object made from one."""
    found = (_texture(slot.material) for slot in ob.material_slots if slot.material is not None)
    return next((image for image in found if image is not None), None)
