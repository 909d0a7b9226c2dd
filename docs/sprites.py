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
"""From a drawing on paper to a waving figure: writes docs/pictures/sprites.png, and the scene to out/sprites.blend.

    uv run docs/sprites.py

The photograph is drawn here: felt pen and crayon on paper, with a shadow from one side, a bright corner and noise.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import studio

# isort: split
import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

ROOT = Path(__file__).resolve().parent.parent
WIDTH, HEIGHT = 420, 560
LIMBS = {
    "body": ((210, 250), (210, 350), 62),
    "head": ((210, 440), (210, 450), 60),
    "arm.L": ((160, 335), (70, 250), 24),
    "arm.R": ((260, 335), (350, 250), 24),
    "leg.L": ((185, 230), (160, 70), 30),
    "leg.R": ((235, 230), (262, 70), 30),
}
"""Ends and half widths, in pixels from the lower left corner."""
BONES = [
    ("spine", (210, 205), (210, 345), None),
    ("side.L", (166, 210), (160, 318), "spine"),
    ("side.R", (254, 210), (260, 318), "spine"),
    ("head", (210, 365), (210, 490), "spine"),
    ("arm.L", (152, 327), (113, 291), "spine"),
    ("hand.L", (113, 291), (66, 246), "arm.L"),
    ("arm.R", (268, 327), (307, 291), "spine"),
    ("hand.R", (307, 291), (354, 246), "arm.R"),
    ("leg.L", (186, 225), (174, 150), "spine"),
    ("foot.L", (174, 150), (160, 62), "leg.L"),
    ("leg.R", (234, 225), (248, 150), "spine"),
    ("foot.R", (248, 150), (262, 62), "leg.R"),
]
POSE = {"arm.R": 62, "hand.R": 58, "arm.L": 14, "spine": -4, "head": -9, "leg.L": -7, "foot.L": -9}
"""Degrees about the axis towards the viewer."""
TRIANGLES = 700


def photograph() -> np.ndarray:
    """(h, w, 4), rows from below: a figure in felt pen, its shirt and trousers crayoned, on paper in uneven light."""
    y, x = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    away = {name: to_limb(x, y, *limb) for name, limb in LIMBS.items()}
    figure = np.min(list(away.values()), axis=0)
    rng = np.random.default_rng(7)
    paper = np.ones((HEIGHT, WIDTH, 3)) * [0.93, 0.91, 0.86]

    def lay(color: tuple[float, ...], cover: np.ndarray) -> None:
        paper[:] = paper + np.clip(cover, 0, 1)[..., None] * (np.array(color) - paper)

    hatching = 0.75 + 0.25 * np.sin((x + 0.6 * y) * 0.9 + 2 * np.sin(0.03 * y))
    trousers = np.minimum(away["leg.L"], away["leg.R"])
    lay((0.95, 0.72, 0.55), np.clip(-figure / 2, 0, 1) * 0.8)
    lay((0.20, 0.42, 0.78), np.clip(-trousers / 2, 0, 1) * hatching)
    lay((0.86, 0.28, 0.22), np.clip(-away["body"] / 2, 0, 1) * hatching)
    lay((0.12, 0.11, 0.13), 3.6 - np.abs(figure))
    for eye in (188, 232):
        lay((0.12, 0.11, 0.13), 7.5 - np.hypot(x - eye, (y - 460) / 1.2))
    smile = np.abs(np.hypot(x - 210, y - 445) - 30)
    lay((0.12, 0.11, 0.13), np.where(y < 432, 3.2 - smile, 0))
    for button in (330, 295, 260):
        lay((0.97, 0.88, 0.40), 6.5 - np.hypot(x - 210, y - button))
    light = 0.62 + 0.30 * x / WIDTH + 0.22 * np.exp(-((x - WIDTH) ** 2 + (y - HEIGHT) ** 2) / 2.5e4)
    light *= 1 - 0.18 / (1 + np.exp((x - 110 - 0.25 * y) / 25))
    values = paper * light[..., None] + rng.normal(0, 0.012, (HEIGHT, WIDTH, 3))
    return np.dstack([np.clip(values, 0, 1), np.ones((HEIGHT, WIDTH))]).astype(np.float32)


def to_limb(x: np.ndarray, y: np.ndarray, head: tuple, tail: tuple, half: float) -> np.ndarray:
    """Distance of pixels from a limb; negative inside."""
    (a, b), (c, d) = head, tail
    share = np.clip(((x - a) * (c - a) + (y - b) * (d - b)) / ((c - a) ** 2 + (d - b) ** 2), 0, 1)
    return np.hypot(x - a - share * (c - a), y - b - share * (d - b)) - half


def place(pixel: tuple[float, float]) -> Vector:
    """Where a pixel of a file at the cursor is: one unit high, upright, its lower middle at the origin."""
    return Vector(((pixel[0] - WIDTH / 2) / HEIGHT, 0, pixel[1] / HEIGHT))


def sprite(path: Path) -> bpy.types.Object:
    """Make the sprite as a user does."""
    image = bpy.data.images.new("photograph", WIDTH, HEIGHT)
    image.pixels.foreach_set(photograph().ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    bpy.ops.object.gridmesh_from_image(
        filepath=str(path),
        shape="SHEET",
        background="PAPER",
        use_holes=False,
        triangles=TRIANGLES,
        min_area=400,
    )
    return bpy.context.view_layer.objects.active


def rig() -> bpy.types.Object:
    """Make the armature."""
    data = bpy.data.armatures.new("Rig")
    ob = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    for name, head, tail, parent in BONES:
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = place(head), place(tail)
        bone.parent = data.edit_bones[parent] if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")
    return ob


def wave(armature: bpy.types.Object, share: float) -> None:
    """Pose the figure."""
    for name, degrees in POSE.items():
        bone = armature.pose.bones[name]
        axis = bone.bone.matrix_local.to_3x3().inverted() @ Vector((0, -1, 0))
        bone.rotation_mode = "QUATERNION"
        bone.rotation_quaternion = Quaternion(axis, np.radians(share * degrees))
    bpy.context.view_layer.update()


def copied(ob: bpy.types.Object, at: float, *, wire: bool) -> None:
    """Leave the object as it looks now beside the others, with its edges as thin tubes if asked."""
    mesh = bpy.data.meshes.new_from_object(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    for part in (mesh, mesh.copy()) if wire else (mesh,):
        other = bpy.data.objects.new("panel", part)
        other.matrix_world = Matrix.Translation((at, 0, 0)) @ ob.matrix_world
        bpy.context.scene.collection.objects.link(other)
    if wire:
        modifier = other.modifiers.new("Wire", "WIREFRAME")
        modifier.thickness = 0.0022
        other.location.y -= 0.004
        part.materials.clear()
        part.materials.append(plain("Wire", (0.03, 0.04, 0.08, 1)))


def sticks(armature: bpy.types.Object, at: float) -> None:
    """Show the bones as slim kites."""
    for bone in armature.pose.bones:
        head, tail = bone.head, bone.tail
        along, out = tail - head, Vector((0, -0.02, 0))
        side = along.cross(Vector((0, 1, 0))).normalized() * 0.018
        corners = [head + out, head + 0.2 * along + side + out, tail + out, head + 0.2 * along - side + out]
        mesh = bpy.data.meshes.new("bone")
        mesh.from_pydata([corner[:] for corner in corners], [], [(0, 1, 2, 3)])
        mesh.materials.append(plain("Bone", (0.95, 0.75, 0.05, 1)))
        ob = bpy.data.objects.new("bone", mesh)
        ob.location.x = at
        bpy.context.scene.collection.objects.link(ob)


def paper(image: bpy.types.Image, at: float) -> None:
    """Show the photograph itself."""
    mesh = bpy.data.meshes.new("photograph")
    corners = [place(corner) for corner in ((0, 0), (WIDTH, 0), (WIDTH, HEIGHT), (0, HEIGHT))]
    mesh.from_pydata([corner[:] for corner in corners], [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new(name="UVMap")
    for corner, uv in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)]):
        layer.uv[corner].vector = uv
    mesh.materials.append(shining("Photograph", image))
    ob = bpy.data.objects.new("photograph", mesh)
    ob.location.x = at
    bpy.context.scene.collection.objects.link(ob)


def plain(name: str, color: tuple[float, ...]) -> bpy.types.Material:
    """Material of one colour that needs no light."""
    made = bpy.data.materials.get(name)
    if made is None:
        made = shining(name, None)
        made.node_tree.nodes["Emission"].inputs["Color"].default_value = color
    return made


def shining(name: str, image: bpy.types.Image | None) -> bpy.types.Material:
    """Material that shines in the colours of a picture."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    emission, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    if image is not None:
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
    return made


def render(path: Path, panels: int, step: float) -> None:
    """Write the picture of all panels."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", panels * step
    camera.location, camera.rotation_euler = ((panels - 1) * step / 2, -4, 0.5), (np.pi / 2, 0, 0)
    scene.camera = camera
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", 16
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.82, 0.84, 0.87, 1)
    scene.render.resolution_x, scene.render.resolution_y = 1500, round(1500 * 1.08 / (panels * step))
    studio.render(path)


def main() -> None:
    """Make the figure wave, and the picture of it."""
    step = 0.82
    with tempfile.TemporaryDirectory() as folder:
        figure = sprite(Path(folder, "photograph.png"))
        image = next(
            node.image for node in figure.data.materials[0].node_tree.nodes if node.type == "TEX_IMAGE"
        )
        image.pack()
        paper(image, 0)
        copied(figure, step, wire=True)
        armature = rig()
        figure.select_set(True)
        armature.select_set(True)
        bpy.context.view_layer.objects.active = armature
        bpy.ops.object.gridmesh_bone_weights()
        copied(figure, 2 * step, wire=False)
        sticks(armature, 2 * step)
        for panel, share in ((3, 0.55), (4, 1.0)):
            wave(armature, share)
            copied(figure, panel * step, wire=False)
        figure.hide_render = armature.hide_render = True
        render(ROOT / "docs" / "pictures" / "sprites.png", 5, step)
        (ROOT / "out").mkdir(exist_ok=True)
        bpy.ops.wm.save_as_mainfile(filepath=str(ROOT / "out" / "sprites.blend"), copy=True)


if __name__ == "__main__":
    studio.run(main)
