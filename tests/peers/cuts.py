"""Cuts beside Blender's own: bisect with fill, and boolean with a swept solid. Same models, same strokes, one run.

    python tests/peers/cuts.py [--json FILE]

needs the module `bpy` and the built module `gridmesh`. Caps of several corners are triangulated as Blender does it
(Triangulate Faces, beauty). Prints for every cut the caps' mean radius ratio, the share of triangles with an angle
under 5 degrees, the share of inner vertices without six neighbours, and the time; at the end the time for a
model of 100,000 triangles.
"""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).parents[2]
os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-peers-")
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "blender")]

import bpy  # noqa: E402

# isort: split
import bmesh  # noqa: E402  (there once bpy is)
import numpy as np  # noqa: E402
from mathutils import Vector  # noqa: E402

import addon  # noqa: E402

FAR = 6.0


def straight(height, slope=0.0):
    return np.array([[-FAR, 0, height - FAR * slope], [FAR, 0, height + FAR * slope]])


def wave(height, n=200):
    x = np.linspace(-FAR, FAR, n)
    return np.column_stack([x, 0 * x, height + 0.12 * np.sin(5 * x)])


def cube():
    bpy.ops.mesh.primitive_cube_add()


def cylinder():
    bpy.ops.mesh.primitive_cylinder_add(vertices=48)


def suzanne():
    bpy.ops.mesh.primitive_monkey_add()
    bpy.ops.object.modifier_add(type="SUBSURF")
    bpy.context.object.modifiers[-1].levels = 1
    bpy.ops.object.modifier_apply(modifier=bpy.context.object.modifiers[-1].name)


def torus():
    bpy.ops.mesh.primitive_torus_add(major_segments=64, minor_segments=24)


def ball():
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)


CUTS = [
    ("cube, slanted", cube, straight(0.1, 0.2)),
    ("cube, wave", cube, wave(0.1)),
    ("cylinder, slanted", cylinder, straight(0.1, 0.3)),
    ("cylinder, wave", cylinder, wave(0.1)),
    ("ball, straight", ball, straight(0.13)),
    ("ball, wave", ball, wave(0.1)),
    ("Suzanne, chin", suzanne, straight(-0.52, 0.03)),
    ("torus, in two", torus, straight(0.0, 0.9)),
    ("torus, along it", torus, straight(0.05)),
]


def fresh(make):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    make()
    return bpy.context.object


def with_gridmesh(ob, stroke, suggested=True):
    """Right of the stroke, that is below it. Returns seconds; the cap is left selected."""
    points = [{"name": "", "location": tuple(point)} for point in stroke.tolist()]
    length = 0.0
    if suggested:
        from addon.cut.cutobject import Target

        length = Target(ob).model.edge_length()
    since = perf_counter()
    bpy.ops.object.gridmesh_cut(
        source="DRAWN", stroke=points, direction="Y", keep="RIGHT", edge_length=length
    )
    return perf_counter() - since


def with_bisect(ob, stroke):
    """Only along planes. Returns seconds; the cap is left selected."""
    along = stroke[-1] - stroke[0]
    normal = np.cross(along, (0, 1, 0))
    normal *= np.sign(normal[2]) / np.linalg.norm(normal)  # components beyond 1 would be clamped
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    since = perf_counter()
    bpy.ops.mesh.bisect(
        plane_co=Vector(stroke[0]),
        plane_no=Vector(normal),
        use_fill=True,
        clear_outer=True,
        clear_inner=False,
    )
    seconds = perf_counter() - since
    bpy.ops.object.mode_set(mode="OBJECT")
    # What lies in the plane: the cap's selection is lost with some select modes.
    for polygon in ob.data.polygons:
        places = np.array([ob.data.vertices[index].co for index in polygon.vertices])
        polygon.select = bool(np.abs((places - stroke[0]) @ normal).max() < 1e-5)
    return seconds


def swept_solid(stroke):
    """What is above the stroke, as a closed solid with a material of its own."""
    n = len(stroke)
    low = [tuple(point + (0, y, 0)) for y in (-FAR, FAR) for point in stroke]
    high = [(x, y, FAR) for x, y, _ in low]
    faces = [(k, k + 1, n + k + 1, n + k) for k in range(n - 1)]  # the swept surface
    top = 2 * n
    faces += [(top + n + k, top + n + k + 1, top + k + 1, top + k) for k in range(n - 1)]
    front, back = list(range(n)), list(range(n, 2 * n))
    faces += [(*front[::-1], *(top + k for k in front)), (*back, *(top + k for k in back[::-1]))]
    faces += [(0, n, top + n, top), (2 * n - 1, n - 1, top + n - 1, top + 2 * n - 1)]
    mesh = bpy.data.meshes.new("Solid")
    mesh.from_pydata(low + high, [], faces)
    mesh.materials.append(bpy.data.materials.new("Cap"))
    bm = bmesh.new()
    bm.from_mesh(mesh)
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
    bm.to_mesh(mesh)
    bm.free()
    solid = bpy.data.objects.new("Solid", mesh)
    bpy.context.scene.collection.objects.link(solid)
    return solid


def with_boolean(ob, stroke):
    """Exact solver. Returns seconds; the cap is left selected."""
    ob.data.materials.append(bpy.data.materials.new("Model"))
    solid = swept_solid(stroke)
    modifier = ob.modifiers.new("Boolean", "BOOLEAN")
    modifier.operation, modifier.solver, modifier.object = "DIFFERENCE", "EXACT", solid
    modifier.material_mode = "TRANSFER"
    bpy.context.view_layer.objects.active = ob
    since = perf_counter()
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    seconds = perf_counter() - since
    cap = [slot for slot, material in enumerate(ob.data.materials) if material and material.name == "Cap"]
    for polygon in ob.data.polygons:
        polygon.select = polygon.material_index in cap
    return seconds


def cap_quality(ob):
    """Numbers about the selected faces."""
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    caps = [face for face in bm.faces if face.select]
    n_faces = len(caps)
    if not caps:
        bm.free()
        return None
    done = bmesh.ops.triangulate(bm, faces=caps, quad_method="BEAUTY", ngon_method="BEAUTY")
    bm.verts.index_update()
    triangles = np.array([[v.index for v in face.verts] for face in done["faces"]])
    points = np.array([v.co for v in bm.verts], float)
    bm.free()
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, times = np.unique(edges, axis=0, return_counts=True)
    inner = np.setdiff1d(triangles, edges[times == 1])
    valence = np.bincount(edges.ravel(), minlength=len(points))
    a, b, c = (
        np.linalg.norm(points[triangles[:, k]] - points[triangles[:, k - 1]], axis=1) for k in range(3)
    )
    half = (a + b + c) / 2
    area = np.sqrt(np.maximum(half * (half - a) * (half - b) * (half - c), 0))
    ratio = 8 * area**2 / np.maximum(half * a * b * c, 1e-300)
    cosines = [
        (y**2 + z**2 - x**2) / np.maximum(2 * y * z, 1e-300) for x, y, z in ((a, b, c), (b, c, a), (c, a, b))
    ]
    least = np.degrees(np.arccos(np.clip(cosines, -1, 1)).min(axis=0))
    return {
        "faces": n_faces,
        "triangles": len(triangles),
        "radius_ratio": float(ratio.mean()),
        "under_5": float((least < 5).mean()),
        "median_angle": float(np.median(least)),
        "min_angle": float(least.min()),
        "irregular": float((valence[inner] != 6).mean()) if len(inner) else 0.0,
        "max_valence": int(valence[np.unique(triangles)].max()),
    }


def is_closed(ob):
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    closed = all(edge.is_manifold for edge in bm.edges)
    bm.free()
    return closed


def large():
    """A ball of about 100,000 triangles."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=320, ring_count=160)
    ob = bpy.context.object
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    bmesh.ops.triangulate(bm, faces=bm.faces)
    bm.to_mesh(ob.data)
    bm.free()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path)
    parser.add_argument("--repeat", type=int, default=3)
    arguments = parser.parse_args()
    rows = []
    print(f"Blender {bpy.app.version_string}")
    head = f"{'cut':20}{'by':10}{'closed':>7}{'faces':>7}{'tris':>7}{'ratio':>7}{'<5°':>6}{'median':>8}{'least':>7}{'irreg.':>8}{'val.':>6}{'ms':>8}"
    print(head)
    for name, make, stroke in CUTS:
        ways = [("gridmesh", with_gridmesh), ("boolean", with_boolean)]
        if len(stroke) == 2:
            ways.insert(1, ("bisect", with_bisect))
        for way, function in ways:
            ob = fresh(make)
            seconds = function(ob, stroke)
            row = {
                "cut": name,
                "by": way,
                "closed": is_closed(ob),
                "seconds": seconds,
                **(cap_quality(ob) or {}),
            }
            rows.append(row)
            if "faces" not in row:
                print(f"{name:20}{way:10} no cap")
                continue
            print(
                f"{name:20}{way:10}{'yes' if row['closed'] else 'no':>7}{row['faces']:7}{row['triangles']:7}"
                f"{row['radius_ratio']:7.3f}{row['under_5']:6.0%}{row['median_angle']:7.1f}°{row['min_angle']:6.1f}°"
                f"{row['irregular']:8.1%}{row['max_valence']:6}{1000 * seconds:8.0f}"
            )
    for name, stroke in (("straight", straight(0.1)), ("wave", wave(0.1))):
        for way, function in (
            ("gridmesh", with_gridmesh),
            ("gridmesh exact", lambda ob, stroke: with_gridmesh(ob, stroke, suggested=False)),
            ("boolean", with_boolean),
            ("bisect", with_bisect),
        ):
            if way == "bisect" and len(stroke) > 2:
                continue
            times = []
            for _ in range(arguments.repeat):
                ob = fresh(large)
                n = len(ob.data.polygons)
                times.append(function(ob, stroke))
            rows.append({"cut": f"{n} triangles, {name}", "by": way, "seconds": min(times)})
            print(f"{n} triangles, {name}, {way}: {1000 * min(times):.0f} ms (least of {len(times)})")
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    status = 1
    addon.register()
    try:
        main()
        status = 0
    finally:
        addon.unregister()
        sys.stdout.flush()
        if status == 0:
            os._exit(0)  # Blender 4.5 can hang in its own clean-up
