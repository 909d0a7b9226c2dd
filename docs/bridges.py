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
"""Draw the picture of bridged loops in the manual, by operators in Blender.

    uv run docs/bridges.py [PICTURE.png] [--quads | --handles | --several]

Above, loops joined by Blender's *Bridge Edge Loops*; below, by *Grid Bridge*, what is new in colour: pipes of different sizes
and numbers of vertices, pipes tilted against each other, two spheres, and three pipes. With `--quads` Grid Bridge's triangles above, its quads below;
with `--handles` holes in a cup, two balls and between two balls, with `--several` three holes and more of which tubes come together, Blender's
faces above, quads below.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import fills
import quads
import studio

# isort: split
import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector

from addon.text.messages import counted

STEP, RISE = 3.1, 3.3
"""From one mesh to the next, and from the lower row to the upper one."""


def pipe(bm, segments, radius, place) -> None:
    """Two rows of quads around, open at both ends."""
    rings = [
        [
            bm.verts.new(place @ Vector((radius * math.cos(t), radius * math.sin(t), z)))
            for t in (math.tau * k / segments for k in range(segments))
        ]
        for z in (-0.35, 0.0)
    ]
    for k in range(segments):
        n = (k + 1) % segments
        bm.faces.new((rings[0][k], rings[0][n], rings[1][n], rings[1][k]))


def of_sizes(bm) -> None:
    """A pipe of 14 vertices below, of 40 above."""
    pipe(bm, 14, 0.5, Matrix.Translation((0, 0, -0.8)))
    pipe(bm, 40, 1.0, Matrix.Translation((0, 0, 0.8)) @ Matrix.Rotation(math.pi, 4, "X"))


def tilted(bm) -> None:
    """An elbow of pipes with 24 and 32 vertices."""
    pipe(bm, 24, 0.55, Matrix.Translation((-0.4, 0, -0.8)))
    pipe(bm, 32, 0.7, Matrix.Translation((0.3, 0, 0.85)) @ Matrix.Rotation(math.radians(-120), 4, "Y"))


def holed_ball(bm, place, size, segments, way) -> None:
    """A ball with a hole on one side."""
    before = set(bm.verts)
    bmesh.ops.create_uvsphere(bm, u_segments=segments, v_segments=segments // 2, radius=size)
    new = [v for v in bm.verts if v not in before]
    faces = {f for v in new for f in v.link_faces}
    turn = Vector((0, 0, 1)).rotation_difference(way.normalized()).to_matrix().to_4x4()
    gone = [f for f in faces if f.calc_center_median().normalized().z > 0.86]
    bmesh.ops.transform(bm, matrix=Matrix.Translation(place) @ turn, verts=new)
    bmesh.ops.delete(bm, geom=gone, context="FACES")


def spheres(bm) -> None:
    """An arm's end beside a body, a hole in each."""
    holed_ball(bm, (-0.45, 0, -0.4), 0.85, 32, Vector((0.75, 0, 0.65)))
    holed_ball(bm, (0.75, 0, 0.7), 0.45, 16, Vector((-0.75, 0, -0.65)))


def trousers(bm) -> None:
    """Two legs of 16 and 20 vertices below a waist of 32."""
    pipe(bm, 16, 0.42, Matrix.Translation((-0.62, 0, -0.8)))
    pipe(bm, 20, 0.42, Matrix.Translation((0.62, 0, -0.8)))
    pipe(bm, 32, 0.95, Matrix.Translation((0, 0, 0.8)) @ Matrix.Rotation(math.pi, 4, "X"))


def without(bm, *places, radius) -> None:
    """Holes around places."""
    gone = [f for f in bm.faces if min((f.calc_center_median() - place).length for place in places) < radius]
    bmesh.ops.delete(bm, geom=gone, context="FACES")


def cup(bm) -> None:
    """Two holes in a wall, one above the other."""
    bmesh.ops.create_cone(bm, segments=48, radius1=0.8, radius2=0.8, depth=1.9, cap_ends=True, cap_tris=False)
    tall = [e for e in bm.edges if abs(e.verts[0].co.z - e.verts[1].co.z) > 1]
    bmesh.ops.subdivide_edges(bm, edges=tall, cuts=17, use_grid_fill=True)
    bmesh.ops.rotate(bm, verts=bm.verts, matrix=Matrix.Rotation(math.radians(-20), 3, "Z"))
    top = [f for f in bm.faces if f.normal.z > 0.9]
    bmesh.ops.inset_individual(bm, faces=top, thickness=0.1)
    inner = bmesh.ops.extrude_discrete_faces(bm, faces=top)["faces"]
    bmesh.ops.translate(bm, vec=(0, 0, -1.7), verts=inner[0].verts)
    without(bm, Vector((0.75, -0.27, 0.45)), Vector((0.75, -0.27, -0.45)), radius=0.24)


def handle(bm) -> None:
    """Two holes beside each other in a ball."""
    bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=32, radius=0.9)
    holes = [Vector((0.9 * math.sin(a), -0.25, 0.9 * math.cos(a))) for a in (-0.55, 0.55)]
    without(bm, *holes, radius=0.26)


def tunnel(bm) -> None:
    """A hole in front of a ball and one above."""
    bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=32, radius=0.95)
    without(bm, Vector((0.2, -0.93, 0)), Vector((0, 0, 0.95)), radius=0.36)


def balls(bm) -> None:
    """Three balls, each with a hole that looks at the middle between them."""
    for k in range(3):
        turn = 0.5 + k * math.tau / 3
        way = Vector((math.cos(turn), 0, math.sin(turn)))
        holed_ball(bm, 0.95 * way, 0.45, 32, -way)


def slab(bm) -> None:
    """Four holes in the upper side of a slab."""
    place = Matrix.Translation((0, 0, -0.45)) @ (Matrix.Rotation(0.6, 4, "X") @ Matrix.Rotation(0.5, 4, "Z"))
    bmesh.ops.create_grid(bm, x_segments=36, y_segments=36, size=1.1)
    upper = bmesh.ops.extrude_face_region(bm, geom=bm.faces[:])["geom"]
    bmesh.ops.translate(bm, vec=(0, 0, 0.2), verts=[v for v in upper if isinstance(v, bmesh.types.BMVert)])
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
    bmesh.ops.transform(bm, matrix=place, verts=bm.verts)
    corners = [Vector((x, y, 0.2)) for x in (-0.57, 0.57) for y in (-0.57, 0.57)]
    without(bm, *(place @ corner for corner in corners), radius=0.17)


def front(bm) -> None:
    """Three holes in the front of a ball."""
    bmesh.ops.create_uvsphere(bm, u_segments=64, v_segments=40, radius=1)
    ways = [Vector((math.cos(t), -1.1, math.sin(t))).normalized() for t in (0.5, 2.6, 4.7)]
    without(bm, *ways, radius=0.32)


def crossing(bm) -> None:
    """Five pipes of different sizes that look at a middle."""
    for turn, radius, segments in (
        (0, 0.4, 24),
        (1.2, 0.3, 20),
        (2.4, 0.25, 16),
        (3.7, 0.35, 24),
        (5, 0.3, 18),
    ):
        way = Vector((math.cos(turn), 0.5 * math.sin(3 * turn), math.sin(turn))).normalized()
        place = (
            Matrix.Translation(-1.15 * way) @ Vector((0, 0, 1)).rotation_difference(way).to_matrix().to_4x4()
        )
        pipe(bm, segments, radius, place)


PIPES = (of_sizes, tilted, trousers, crossing)
"""Only their inner ends are joined."""

JOINED = (of_sizes, tilted, spheres, trousers)
PICTURES = {
    "": (JOINED, ("TRIANGLES", None)),
    "_quads": (JOINED, ("QUADS", "TRIANGLES")),
    "_handles": ((cup, handle, tunnel, spheres), ("QUADS", None)),
    "_several": ((balls, slab, front, crossing), ("QUADS", None)),
}
"""By the end of the name: what is shown, and the faces below and above; None is Blender's own bridge."""


def joined(make, cells: str | None):
    """The mesh of `make`, its facing loops joined; the new faces get the second material. cells : None for Blender's own."""
    mesh = bpy.data.meshes.new(make.__name__)
    bm = bmesh.new()
    make(bm)
    for face in bm.faces:
        face.smooth = True
    loops = [e for e in bm.edges if e.is_boundary]
    centres = [
        (sum((v.co for e in piece for v in e.verts), Vector()) / (2 * len(piece)), piece)
        for piece in pieces(loops)
    ]
    corners = [Vector([of(axis) for axis in zip(*(c for c, _ in centres), strict=True)]) for of in (min, max)]
    middle = (corners[0] + corners[1]) / 2
    centres.sort(key=lambda item: (item[0] - middle).length)
    chosen = centres[: len(centres) // 2] if make in PIPES else centres
    loops = [edge for _, piece in chosen for edge in piece]
    for edge in loops:
        edge.select_set(True)
    bm.to_mesh(mesh)
    bm.free()
    ob = bpy.data.objects.new(make.__name__, mesh)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.select_all(action="DESELECT")
    ob.select_set(True)
    count = len(mesh.polygons)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, True, False)
    if cells:
        bpy.ops.mesh.gridmesh_bridge(cells=cells)
    else:
        bpy.ops.mesh.bridge_edge_loops(number_cuts=4, interpolation="SURFACE")
    bpy.ops.object.mode_set(mode="OBJECT")
    chosen = np.arange(len(mesh.polygons)) >= count
    mesh.polygons.foreach_set("material_index", chosen.astype(np.int32))
    print(f"{make.__name__}: {counted(int(chosen.sum()), 'new face')}")
    return ob


def pieces(edges):
    """Connected chains of edges."""
    rest, found = set(edges), []
    while rest:
        piece, waiting = [], [rest.pop()]
        while waiting:
            edge = waiting.pop()
            piece.append(edge)
            near = {e for v in edge.verts for e in v.link_edges} & rest
            rest -= near
            waiting += near
        found.append(piece)
    return found


def main() -> None:
    """Make the meshes, join the loops, render."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("picture", nargs="?", type=Path)
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--quads", dest="kind", action="store_const", const="_quads", default="")
    kind.add_argument("--handles", dest="kind", action="store_const", const="_handles")
    kind.add_argument("--several", dest="kind", action="store_const", const="_several")
    options = parser.parse_args()
    name, (shown, rows) = f"bridges{options.kind}.png", PICTURES[options.kind]
    picture = (options.picture or Path(__file__).parent / "pictures" / name).resolve()
    # The renderer's own lines show quads cut into triangles.
    in_quads = "QUADS" in rows
    clay = quads.clay if in_quads else lambda name, colour: studio.body_material(name, colour, 0.4)
    plain, tube = clay("Mesh", "#9AA3AE"), clay("Tube", "#E8963A")
    line = studio.plain_material("Line", studio.WIRE)
    for k, make in enumerate(shown):
        for row, cells in enumerate(rows):
            ob = joined(make, cells)
            for material in (plain, tube):
                ob.data.materials.append(material)
            ob.rotation_euler = (0.35, 0, 0)
            ob.location = ((k - 1.5) * STEP, 0, (row - 0.5) * RISE)
            if in_quads:
                quads.wires(ob, line)
    fills.stage(4 * STEP, 2 * RISE + 0.1, 1300, 12)
    studio.render(picture)
    print(f"wrote {picture}")


if __name__ == "__main__":
    studio.run(main)
