"""Models to cut, strokes to cut along, and what must hold of the pieces."""

from collections import Counter

import bpy
import numpy as np
from drawings import activate, curve, mesh_objects, vertices
from holes import directed, faces_of


def line(a, b, n=2, wave=0.0):
    """(n, 3) points from a to b; a wave along z."""
    t = np.linspace(0, 1, n)[:, None]
    points = (1 - t) * np.asarray(a, float) + t * np.asarray(b, float)
    points[:, 2] += wave * np.sin(2 * np.pi * t[:, 0])
    return points


def stroke_object(points, *, cyclic=False):
    return curve([np.asarray(points, float)], cyclic=cyclic)


def cut(ob, points=None, *, cyclic=False, **options):
    """Cut as from a script; return the objects that the model became, the old one first."""
    before = set(mesh_objects())
    if points is None:
        activate(ob)
    else:
        activate(ob, stroke_object(points, cyclic=cyclic))
    assert bpy.ops.object.gridmesh_cut(**{"direction": "Y", **options}) == {"FINISHED"}
    bpy.context.view_layer.update()
    return [ob, *(other for other in mesh_objects() if other not in before)]


def drawn(points):
    """The hidden property that holds a drawn stroke."""
    return [{"name": "", "location": tuple(map(float, point))} for point in points]


def volume(ob):
    """Signed volume in the object's space."""
    mesh = ob.data
    mesh.calc_loop_triangles()
    tri = np.array([t.vertices[:] for t in mesh.loop_triangles])
    a, b, c = (vertices(mesh)[tri[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def is_closed(mesh):
    runs = directed(faces_of(mesh))
    return max(runs.values()) == 1 and all(pair[::-1] in runs for pair in runs)


def check_sound(ob, *, closed=True):
    """Blender finds nothing to repair; no face or edge is used twice; nothing is loose."""
    mesh = ob.data
    assert not mesh.validate(verbose=True)
    faces = faces_of(mesh)
    assert max(Counter(map(frozenset, faces)).values()) == 1, "a face is there twice"
    assert max(directed(faces).values()) == 1, "an edge is used twice in one direction"
    if closed:
        assert is_closed(mesh)
    used = {index for face in faces for index in face}
    assert used == set(range(len(mesh.vertices))), "a vertex is loose"
    sides = {frozenset(pair) for pair in directed(faces)}
    assert sides == {frozenset(edge.vertices) for edge in mesh.edges}, "an edge is loose"


def caps(ob):
    """Faces of the caps: they are left selected."""
    return [polygon for polygon in ob.data.polygons if polygon.select]


def attribute(mesh, name, width=1):
    data = mesh.attributes[name].data
    key = {1: "value", 2: "vector", 3: "vector", 4: "color"}[width]
    values = np.empty(len(data) * width, np.float32)
    data.foreach_get(key, values)
    return values.reshape(-1, width)


def corner_vertices(mesh):
    index = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", index)
    return index


def rich_cylinder(n=24, rings=6):
    """A closed cylinder from z = -1 to 1 whose data all tell the height or the angle.

    Corner UVs: u the share of the turn (with a seam), v the height; at the lids u = v = 9. Vertex group "up" and the
    float attribute "height" run from 0 to 1, the corner colours from black to white; the shape key "lean" moves
    by (height, 0, 0), and "wide" doubles x and y.
    """
    t = 2 * np.pi * np.arange(n) / n
    z = np.linspace(-1, 1, rings)
    points = [(np.cos(a), np.sin(a), h) for h in z for a in t]
    faces = [
        (r * n + k, r * n + (k + 1) % n, (r + 1) * n + (k + 1) % n, (r + 1) * n + k)
        for r in range(rings - 1)
        for k in range(n)
    ]
    faces += [tuple(range(n))[::-1], tuple((rings - 1) * n + k for k in range(n))]
    mesh = bpy.data.meshes.new("Cylinder")
    mesh.from_pydata(points, [], faces)
    mesh.shade_smooth()
    ob = bpy.data.objects.new("Cylinder", mesh)
    bpy.context.scene.collection.objects.link(ob)
    activate(ob)

    mesh.uv_layers.new(name="UVMap")
    mesh.color_attributes.new("Shade", "FLOAT_COLOR", "CORNER")
    mesh.attributes.new("height", "FLOAT", "POINT")
    mesh.attributes.new("column", "INT", "CORNER")
    group = ob.vertex_groups.new(name="up")
    for vertex in mesh.vertices:
        group.add([vertex.index], (vertex.co.z + 1) / 2, "REPLACE")
    # A new layer moves the others: look them up when all are there.
    uv, colors = mesh.uv_layers["UVMap"], mesh.attributes["Shade"]
    heights, number = mesh.attributes["height"], mesh.attributes["column"]
    for vertex in mesh.vertices:
        heights.data[vertex.index].value = (vertex.co.z + 1) / 2
    for polygon in mesh.polygons:
        side = len(polygon.vertices) == 4
        for place, loop in enumerate(polygon.loop_indices):
            share = (mesh.vertices[mesh.loops[loop].vertex_index].co.z + 1) / 2
            column = polygon.index % n + (place in (1, 2))
            uv.uv[loop].vector = (column / n, share) if side else (9.0, 9.0)
            colors.data[loop].color = (share, share, share, 1.0)
            number.data[loop].value = polygon.index % n
    for edge in mesh.edges:
        if all(vertex % n == 0 for vertex in edge.vertices):  # up the side, where u jumps
            edge.use_seam = edge.use_edge_sharp = True
    ob.shape_key_add(name="Basis")
    lean, wide = ob.shape_key_add(name="lean"), ob.shape_key_add(name="wide")
    lean.value = wide.value = 0.0  # not what every version begins with
    for vertex in mesh.vertices:
        x, y, h = vertex.co
        lean.data[vertex.index].co = (x + h, y, h)
        wide.data[vertex.index].co = (2 * x, 2 * y, h)
    return ob
