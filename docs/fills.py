# /// script
# requires-python = "==3.11.*"
# dependencies = ["bpy==4.5.15", "gridmesh", "numpy==1.26.4"]
#
# [tool.uv]
# python-downloads = "never"
#
# [tool.uv.sources]
# gridmesh = { path = ".." }
# ///
"""Draw the picture of filled holes in the manual, by the operator in Blender.

    uv run docs/fills.py [PICTURE.png]

Above, each mesh with its holes; below, the same after *Fill All Holes*, patches in colour, of triangles and of quads: Suzanne
without her eyeballs, a cylinder, and a sphere with a shape key, at rest and with the key.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import studio

# isort: split
import bmesh
import bpy
import numpy as np
from mathutils import Vector

STEP, RISE = 2.9, 2.7
"""From one mesh to the next, and from a row to the one above."""


def suzanne():
    """The head alone, each socket open."""
    bpy.ops.mesh.primitive_monkey_add()
    ob = bpy.context.object
    subdivide(ob)
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bm.verts.ensure_lookup_table()
    largest = []
    rest = set(bm.verts)
    while rest:
        found = [rest.pop()]
        head = set(found)
        while found:
            near = {edge.other_vert(vertex) for vertex in [found.pop()] for edge in vertex.link_edges} - head
            head |= near
            found += near
        rest -= head
        largest = max(largest, list(head), key=len)
    bmesh.ops.delete(bm, geom=[vertex for vertex in bm.verts if vertex not in set(largest)], context="VERTS")
    bm.to_mesh(ob.data)
    bm.free()
    return ob


def subdivide(ob) -> None:
    """Smooth the mesh by one level of subdivision."""
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 1
    bpy.ops.object.modifier_apply(modifier="Subdivision")


def cylinder():
    """Both ends open."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=28, radius=0.75, depth=1.5, end_fill_type="NOTHING")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.bisect(plane_co=(0, 0, 0), plane_no=(0, 0, 1))
    bpy.ops.object.mode_set(mode="OBJECT")
    return bpy.context.object


def sphere():
    """A side is missing, and a shape key bends it."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=36, ring_count=18)
    ob = bpy.context.object
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    side = Vector((0.3, -1, 0.45)).normalized()
    gone = [face for face in bm.faces if face.calc_center_median().dot(side) > 0.72]
    bmesh.ops.delete(bm, geom=gone, context="FACES")
    bm.to_mesh(ob.data)
    bm.free()
    ob.shape_key_add(name="Basis")
    bent = ob.shape_key_add(name="Bent")
    for point in bent.data:
        x, y, z = point.co
        point.co = (x * (1 - 0.35 * z) + 0.25 * math.sin(2.5 * z), y * (1 - 0.35 * z), 1.25 * z)
    return ob


def bent_sphere():
    """The same as `sphere`, its key at one."""
    ob = sphere()
    ob.data.shape_keys.key_blocks["Bent"].value = 1.0
    return ob


def fill(ob, cells: str) -> int:
    """Fill all holes; the patch gets the second material. Returns how many faces are new."""
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    done = bpy.ops.mesh.gridmesh_fill(holes="ALL", max_edges=0, cells=cells)
    bpy.ops.object.mode_set(mode="OBJECT")
    if done != {"FINISHED"}:
        raise SystemExit(f"{ob.name} was not filled")
    chosen = np.zeros(len(ob.data.polygons), bool)
    ob.data.polygons.foreach_get("select", chosen)
    ob.data.polygons.foreach_set("material_index", chosen.astype(np.int32))
    return int(chosen.sum())


def wires(ob, material) -> None:
    """The edges as thin bars: the renderer's own lines show quads cut into triangles."""
    copy = ob.copy()
    copy.data = ob.data.copy()
    copy.data.materials.clear()
    copy.data.materials.append(material)
    bars = copy.modifiers.new("Wires", "WIREFRAME")
    bars.thickness, bars.use_relative_offset, bars.use_even_offset = 0.012, False, False
    bpy.context.scene.collection.objects.link(copy)


def stage(width: float, height: float, pixels: int, samples: int) -> None:
    """Light, camera and render settings for a page around the origin, seen along +Y."""
    scene = bpy.context.scene
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 2.8, 0.3
    light = bpy.data.objects.new("Sun", sun)
    light.rotation_euler = (math.radians(50), 0, math.radians(-32))
    scene.collection.objects.link(light)
    world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    sky = world.node_tree.nodes["Background"]
    sky.inputs["Color"].default_value = studio.linear("#E9EDF2")
    sky.inputs["Strength"].default_value = 0.7
    scene.world = world
    lens = bpy.data.cameras.new("Camera")
    lens.type, lens.ortho_scale = "ORTHO", width
    camera = bpy.data.objects.new("Camera", lens)
    camera.location, camera.rotation_euler = (0, -20, 0), (math.radians(90), 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render = scene.render
    render.engine, render.film_transparent = "CYCLES", False
    render.resolution_x, render.resolution_y = pixels, round(pixels * height / width)
    render.image_settings.file_format, render.image_settings.compression = "PNG", 100
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.max_bounces = samples, True, 2
    scene.view_settings.view_transform = "Standard"


def main() -> None:
    """Make the meshes, fill the lower row, render."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Path(__file__).parent / "pictures" / "fills.png"
    parser.add_argument("picture", nargs="?", type=Path, default=default)
    picture = parser.parse_args().picture.resolve()
    pixels = 1000
    plain = studio.body_material("Mesh", "#9AA3AE", 0.4)
    line = studio.body_material("Edges", "#3A3F47", 0.4)
    patch = studio.body_material("Patch", "#E8963A", 0.4)
    makers = (suzanne, cylinder, sphere, bent_sphere)
    tilts = ((0, 0, 0.25), (0.75, 0.2, 0), (0, 0, 0), (0, 0, 0))
    for k, (make, tilt) in enumerate(zip(makers, tilts, strict=True)):
        for row in range(3):
            ob = make()
            ob.data.materials.clear()
            ob.data.materials.append(plain)
            ob.data.materials.append(patch)
            if row < 2:
                cells = ("QUADS", "TRIANGLES")[row]
                print(f"{make.__name__}: {fill(ob, cells)} new {cells.lower()}")
            ob.rotation_euler = tilt
            ob.location = ((k - 1.5) * STEP, 0, (row - 1) * RISE)
            wires(ob, line)
    stage(4 * STEP, 3 * RISE + 0.1, pixels, 24)
    studio.render(picture)
    print(f"wrote {picture}")


if __name__ == "__main__":
    studio.run(main)
