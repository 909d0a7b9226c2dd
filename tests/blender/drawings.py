"""Drawings for the tests, what the operator made of them, and a fingerprint of the whole file."""

import hashlib

import bpy
import numpy as np


def circle(n=64, radius=1.0, centre=(0.0, 0.0), start=0.0, turn=2 * np.pi, closed=True):
    """(n, 3) points on a circle in the plane z = 0."""
    t = start + np.linspace(0, turn, n, endpoint=not closed)
    return np.stack([centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t), 0 * t], axis=1)


def bean(n=120, size=1.0):
    """(n, 3) points on a smooth outline without symmetry, in the plane z = 0."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = size * (1 + 0.25 * np.cos(2 * t + 0.4) + 0.12 * np.sin(3 * t))
    return np.stack([r * np.cos(t), r * np.sin(t), 0 * t], axis=1)


def at(points, x, y, z):
    """Points moved to another place."""
    return points + np.array([x, y, z], float)


def on_plane(points, x, y, origin=(0.0, 0.0, 0.0)):
    """Points in the plane z = 0, moved into the plane spanned by x and y."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    return points[:, :1] * x + points[:, 1:2] * y + np.asarray(origin, float)


def grease_pencil(strokes, *, cyclic=True, name="Drawing", layer="Lines", ob=None, frame=1, active=True):
    """Object with a layer of strokes [(n, 3), ...]; another layer where `ob` is given."""
    v3 = hasattr(bpy.data, "grease_pencils_v3")  # before Blender 5.0
    blocks = bpy.data.grease_pencils_v3 if v3 else bpy.data.grease_pencils
    if ob is None:
        ob = bpy.data.objects.new(name, blocks.new(name))
        bpy.context.scene.collection.objects.link(ob)
    new = ob.data.layers.new(layer)
    drawing = new.frames.new(frame).drawing
    if strokes:
        drawing.add_strokes([len(stroke) for stroke in strokes])
        points = np.concatenate(strokes).astype(np.float32)
        drawing.attributes["position"].data.foreach_set("vector", points.ravel())
        for index, stroke in enumerate(drawing.strokes):
            if cyclic if isinstance(cyclic, bool) else cyclic[index]:
                stroke.cyclic = True
        drawing.tag_positions_changed()
    if active:
        activate(ob)
    return ob


def curve(splines, *, cyclic=True, name="Curve", dimensions="3D"):
    """Curve object with poly splines [(n, 3), ...]."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = dimensions
    for points in splines:
        spline = data.splines.new("POLY")
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", np.column_stack([points, np.ones(len(points))]).ravel())
        spline.use_cyclic_u = cyclic
    return linked(name, data)


def bezier_circle(*, name="Curve", dimensions="3D", radius=1.0):
    """Curve object with one cyclic Bezier spline of four points."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = dimensions
    spline = data.splines.new("BEZIER")
    spline.bezier_points.add(3)
    spline.use_cyclic_u = True
    for point, place in zip(spline.bezier_points, circle(4, radius), strict=True):
        point.co = place
        point.handle_left_type = point.handle_right_type = "AUTO"
    return linked(name, data)


def linked(name, data):
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    activate(ob)
    return ob


def activate(*objects):
    """Make the objects the selection and the first one active."""
    bpy.context.view_layer.update()
    for ob in list(bpy.context.view_layer.objects.selected):
        ob.select_set(False)
    for ob in objects:
        ob.select_set(True)
    bpy.context.view_layer.objects.active = objects[0] if objects else None
    bpy.context.view_layer.update()


def mesh_objects():
    return [ob for ob in bpy.data.objects if ob.type == "MESH"]


def run(**options):
    """Run the operator as a user does, and return the mesh objects that it added."""
    before = set(mesh_objects())
    options = {"triangles": 500, **options}
    assert bpy.ops.object.gridmesh_from_strokes(**options) == {"FINISHED"}
    bpy.context.view_layer.update()
    return [ob for ob in mesh_objects() if ob not in before]


def run_one(**options):
    (ob,) = run(**options)
    return ob


def vertices(mesh):
    points = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", points)
    return points.reshape(-1, 3).astype(float)


def triangles(mesh):
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return corners.reshape(-1, 3)


def world_vertices(ob):
    matrix = np.array(ob.matrix_world)
    return vertices(ob.data) @ matrix[:3, :3].T + matrix[:3, 3]


def check_body(ob, genus=0):
    """One closed body of a genus, wound outward, that Blender finds nothing to repair in."""
    tri, points = triangles(ob.data), vertices(ob.data)
    edges = np.concatenate([tri[:, [0, 1]], tri[:, [1, 2]], tri[:, [2, 0]]])
    directed = {tuple(edge) for edge in edges.tolist()}
    assert len(directed) == len(edges), "an edge is used twice in one direction"
    assert all((b, a) in directed for a, b in directed), "the mesh has a border"
    assert len(points) - len(edges) // 2 + len(tri) == 2 - 2 * genus
    a, b, c = (points[tri[:, k]] for k in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0, "inside out"
    assert not ob.data.validate(verbose=True)
    assert ob.data.uv_layers[0].name == "UVMap"
    uv = uv_of(ob)
    assert uv.min() >= 0
    assert uv.max() <= 1
    assert np.ptp(uv, axis=0).max() > 0.4
    assert all(polygon.use_smooth for polygon in ob.data.polygons)


def uv_of(ob):
    uv = np.empty(len(ob.data.loops) * 2, np.float32)
    ob.data.uv_layers.active.uv.foreach_get("vector", uv)
    return uv.reshape(-1, 2)


def fingerprint():
    """Every data block of the file with its users and contents, and the state of the view layer."""
    blocks = {}
    for name in dir(bpy.data):
        collection = getattr(bpy.data, name)
        if isinstance(collection, bpy.types.bpy_prop_collection):
            blocks[name] = [(block.name, block.users, _contents(block)) for block in collection]
    view_layer = bpy.context.view_layer
    active = view_layer.objects.active
    state = (
        active.name if active else None,
        [ob.name for ob in view_layer.objects.selected],
        bpy.context.mode,
        _collections(bpy.context.scene.collection),
    )
    return blocks, state


def _collections(collection):
    objects = [ob.name for ob in collection.objects]
    return collection.name, objects, [_collections(child) for child in collection.children]


def _contents(block):
    digest = hashlib.sha256(repr({key: str(block[key]) for key in block.keys()}).encode())  # noqa: SIM118
    if isinstance(block, bpy.types.Object):
        digest.update(repr((block.matrix_world[:], block.matrix_basis[:], block.mode)).encode())
        digest.update(repr((block.data, block.parent, list(block.modifiers))).encode())
    elif isinstance(block, bpy.types.Mesh):
        digest.update(vertices(block).tobytes() + bytes(len(block.polygons)))
    elif isinstance(block, bpy.types.Curve):
        digest.update(repr((block.extrude, block.bevel_depth, block.dimensions, block.fill_mode)).encode())
        for spline in getattr(block, "splines", ()):
            for point in (*spline.points, *spline.bezier_points):
                digest.update(repr(point.co[:]).encode())
    elif isinstance(block, bpy.types.Material):
        digest.update(repr(block.diffuse_color[:]).encode())
    elif hasattr(block, "layers") and hasattr(block, "layer_groups"):
        for layer in block.layers:
            digest.update(repr((layer.name, layer.hide, layer.matrix_local[:])).encode())
            for frame in layer.frames:
                for attribute in frame.drawing.attributes:
                    key = "vector" if attribute.data_type == "FLOAT_VECTOR" else "value"
                    for item in attribute.data:
                        value = getattr(item, key, None)
                        digest.update(repr(tuple(value) if key == "vector" else value).encode())
    return digest.hexdigest()
