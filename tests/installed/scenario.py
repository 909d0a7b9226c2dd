"""Install the zip in a Blender, use it, take it out again: what a user does, in the order in which it is done.

    python tests/installed/scenario.py ZIP                                          # the bpy module
    blender --background --python tests/installed/scenario.py -- ZIP                # a real Blender

Blender's own code installs the zip; nothing of the source tree is imported. The profile is a temporary folder. Each step is a
function; all run, also after one failed. A line for each, the counts at the end, exit code 1 if any failed.
"""

import contextlib
import importlib
import os
import re
import shutil
import sys
import tempfile
import traceback
import zipfile
from pathlib import Path

if "bpy" not in sys.modules:
    # Before bpy is imported: it must not see this user's settings. A real Blender is started with this variable.
    os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-blender-")

import bpy
import numpy as np

ZIP = Path(sys.argv[-1]).resolve()
ADDON = "bl_ext.user_default.gridmesh"
VERSION = re.search(r"gridmesh-([\d.]+\d)", ZIP.name).group(1)
USER = Path(os.environ["BLENDER_USER_RESOURCES"])


class SkipError(Exception):
    """A step that cannot be taken here, and why."""


# ------------------------------------------------------------------------------------------------ what is left


def traces():
    """Everything in this session that names the extension."""
    found = {f"module {name}" for name in sys.modules if name.startswith(ADDON)}
    found |= {f"type {name}" for name in dir(bpy.types) if "gridmesh" in name.lower()}
    for group in dir(bpy.ops):
        found |= {f"operator {group}.{name}" for name in dir(getattr(bpy.ops, group)) if "gridmesh" in name}
    for name in dir(bpy.types):
        drawn = getattr(getattr(getattr(bpy.types, name), "draw", None), "_draw_funcs", ())
        found |= {f"menu {name} {draw.__name__}" for draw in drawn if _ours(draw)}
        properties = getattr(getattr(bpy.types, name), "bl_rna", None)
        if properties is not None:
            own = [key for key in properties.properties.keys() if "gridmesh" in key]  # noqa: SIM118
            found |= {f"property {name}.{key}" for key in own}
    for configuration in bpy.context.window_manager.keyconfigs:
        for keymap in configuration.keymaps:
            found |= {f"key {keymap.name} {k.idname}" for k in keymap.keymap_items if "gridmesh" in k.idname}
            found |= {f"keymap {keymap.name}"} if "gridmesh" in keymap.name.lower() else set()
    for name in dir(bpy.app.handlers):
        handlers = getattr(bpy.app.handlers, name)
        if isinstance(handlers, list):
            found |= {f"handler {name} {handler.__name__}" for handler in handlers if _ours(handler)}
    found |= {f"add-on {name}" for name in bpy.context.preferences.addons.keys() if "gridmesh" in name}  # noqa: SIM118
    return found


def _ours(function):
    return "gridmesh" in (getattr(function, "__module__", "") or "")


def files():
    """Files of the extension in the user's profile."""
    return {str(path.relative_to(USER)) for path in USER.rglob("*") if "gridmesh" in path.name.lower()}


# -------------------------------------------------------------------------------------------------------- tools


def site_packages():
    """Where Blender put the wheel."""
    (folder,) = (USER / "extensions" / ".local").rglob("site-packages")
    return folder


@contextlib.contextmanager
def changed_module():
    """The folder of the installed module, to be tampered with; afterwards it is as it was."""
    folder = site_packages()
    kept = Path(tempfile.mkdtemp())
    names = [path.name for path in folder.glob("gridmesh*")]
    for name in names:
        shutil.copytree(folder / name, kept / name)
    try:
        yield folder / "gridmesh"
    finally:
        for path in folder.glob("gridmesh*"):
            shutil.rmtree(path)
        for name in names:
            shutil.copytree(kept / name, folder / name)
        forget()


def forget():
    """Let the next import look at the files again. What is loaded of the library itself stays loaded."""
    sys.modules.pop("gridmesh", None)
    importlib.invalidate_caches()


def empty_scene():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def active(ob):
    bpy.context.view_layer.update()  # what is new is only now in it
    for other in bpy.context.view_layer.objects:
        other.select_set(other == ob)
    bpy.context.view_layer.objects.active = ob
    bpy.context.view_layer.update()


def drawing(points, name="Drawing"):
    """A grease pencil object with one closed stroke (n, 3)."""
    v3 = hasattr(bpy.data, "grease_pencils_v3")  # before Blender 5.0
    data = (bpy.data.grease_pencils_v3 if v3 else bpy.data.grease_pencils).new(name)
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    strokes = data.layers.new("Lines").frames.new(1).drawing
    strokes.add_strokes([len(points)])
    strokes.attributes["position"].data.foreach_set("vector", np.ravel(points).astype(np.float32))
    strokes.strokes[0].cyclic = True
    strokes.tag_positions_changed()
    active(ob)
    return ob


def clover(n=180):
    """(n, 3) points of r = 1 + 0.3 cos 3t."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = 1 + 0.3 * np.cos(3 * t)
    return np.stack([r * np.cos(t), r * np.sin(t), 0 * t], axis=1)


def tube(sides=24):
    """An open cylinder in Edit Mode."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=sides, end_fill_type="NOTHING")
    bpy.ops.object.mode_set(mode="EDIT")
    return bpy.context.object


def meshes():
    return [ob for ob in bpy.data.objects if ob.type == "MESH"]


def check_closed(mesh):
    """Each edge has two faces, and Blender finds nothing to repair."""
    edges = [tuple(sorted(pair)) for face in mesh.polygons for pair in face.edge_keys]
    assert len(edges) == 2 * len(set(edges)), "the mesh has a border"
    assert not mesh.validate(verbose=True)


def refused(part):
    """Run the operator, which must refuse with a message, and leave the scene alone."""
    empty_scene()
    drawing(clover())
    try:
        bpy.ops.object.gridmesh_from_strokes()
    except RuntimeError as error:
        text = str(error)
        assert "Traceback" not in text, text
        assert part in text, text
        assert not meshes()
        return text
    raise AssertionError("it was not refused")


# -------------------------------------------------------------------------------------------------------- steps


def test_nothing_is_there_before():
    assert not traces()
    assert not files()
    assert importlib.util.find_spec("gridmesh") is None, "the module is here without the extension"


def test_install_and_enable():
    bpy.ops.extensions.package_install_files(
        filepath=str(ZIP), repo="user_default", enable_on_install=True, overwrite=True
    )
    assert ADDON in bpy.context.preferences.addons
    assert hasattr(bpy.types, "VIEW3D_PT_gridmesh")


def test_the_module_is_not_loaded_before_it_is_needed():
    assert "gridmesh" not in sys.modules
    assert importlib.util.find_spec("gridmesh") is not None


def test_a_missing_module_is_told():
    with changed_module() as folder:
        for path in folder.parent.glob("gridmesh*"):
            shutil.rmtree(path)
        refused("is missing; install the GridMesh zip for")


def test_a_module_for_another_processor_is_told():
    with changed_module() as folder:
        (library,) = [
            path for path in folder.iterdir() if path.name.startswith("_native.") and path.suffix != ".pyi"
        ]
        code = bytearray(library.read_bytes())
        if code[:4] != b"\x7fELF":
            raise SkipError("the library is no ELF file")
        code[18] = 0xB7 if code[18] == 0x3E else 0x3E
        library.unlink()
        library.write_bytes(code)
        refused("could not be loaded")


def test_a_damaged_module_is_told():
    with changed_module() as folder:
        (library,) = [
            path for path in folder.iterdir() if path.name.startswith("_native.") and path.suffix != ".pyi"
        ]
        library.unlink()
        library.write_bytes(b"damaged")
        refused("could not be loaded")


def test_strokes():
    empty_scene()
    drawing(clover())
    assert bpy.ops.object.gridmesh_from_strokes(triangles=2000) == {"FINISHED"}
    (ob,) = meshes()
    check_closed(ob.data)
    assert len(ob.data.polygons) > 3000
    assert ob.data.uv_layers
    assert bpy.context.view_layer.objects.active is ob


def test_the_module_is_the_one_of_the_zip():
    module = sys.modules["gridmesh"]
    assert Path(module.__file__).is_relative_to(USER), module.__file__
    assert module.__version__ == VERSION


def test_strokes_are_one_undo_step():
    empty_scene()
    drawing(clover())
    bpy.ops.ed.undo_push(message="base")
    bpy.ops.object.gridmesh_from_strokes("EXEC_DEFAULT", True, triangles=500)
    assert len(meshes()) == 1
    bpy.ops.ed.undo()
    assert not meshes()
    assert "Drawing" in bpy.data.objects
    bpy.ops.ed.redo()
    assert len(meshes()) == 1


def test_flat_sheet_of_a_curve():
    empty_scene()
    bpy.ops.curve.primitive_bezier_circle_add()
    assert bpy.ops.object.gridmesh_from_strokes(shape="SHEET", triangles=300) == {"FINISHED"}
    (ob,) = meshes()
    assert np.ptp([vertex.co.z for vertex in ob.data.vertices]) < 1e-6
    assert 250 < len(ob.data.polygons) < 350


def test_a_stroke_that_cannot_be_is_refused():
    empty_scene()
    drawing(np.zeros((8, 3)))
    try:
        bpy.ops.object.gridmesh_from_strokes()
    except RuntimeError as error:
        assert "Traceback" not in str(error)
    else:
        raise AssertionError("it was not refused")
    assert not meshes()


def test_fill():
    empty_scene()
    ob = tube()
    assert bpy.ops.mesh.gridmesh_fill(holes="ALL", max_edges=0) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    check_closed(ob.data)


def test_fill_of_a_selected_loop_is_one_undo_step():
    empty_scene()
    ob = tube()
    bpy.ops.mesh.select_mode(type="EDGE")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.mesh.select_non_manifold()
    bpy.ops.ed.undo_push(message="base")
    before = len(ob.data.polygons)
    bpy.ops.mesh.gridmesh_fill("EXEC_DEFAULT", True)
    assert faces_of(ob) > before
    bpy.ops.ed.undo()
    assert faces_of(bpy.context.object) == before


def faces_of(ob):
    ob.update_from_editmode()
    return len(ob.data.polygons)


def test_cut():
    if "gridmesh_cut" not in dir(bpy.ops.object):
        raise SkipError("this build has no object.gridmesh_cut")
    empty_scene()
    bpy.ops.mesh.primitive_uv_sphere_add()
    ball = bpy.context.object
    t = np.linspace(-2, 2, 40)
    stroke = drawing(np.stack([t, 0.2 * np.sin(3 * t), 0 * t], axis=1))
    stroke.data.layers[0].frames[0].drawing.strokes[0].cyclic = False
    ball.select_set(True)
    bpy.context.view_layer.objects.active = ball
    assert bpy.ops.object.gridmesh_cut() == {"FINISHED"}
    pieces = meshes()
    assert pieces
    for piece in pieces:
        check_closed(piece.data)


def test_disable_leaves_nothing():
    bpy.ops.preferences.addon_disable(module=ADDON)
    left = {trace for trace in traces() if not trace.startswith("module ")}  # Blender keeps modules
    assert not left, left


def test_enable_again_and_use():
    bpy.ops.preferences.addon_enable(module=ADDON)
    test_strokes()
    test_fill()


def test_a_second_enable_changes_nothing():
    before = traces()
    bpy.ops.preferences.addon_enable(module=ADDON)
    assert traces() == before


def test_use_after_a_file_is_loaded():
    path = str(USER / "scene.blend")
    test_strokes()
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert len(meshes()) == 1
    test_fill()
    Path(path).unlink()


def test_an_update_asks_for_a_restart():
    """The files are those of the new version, what is loaded is the old one."""
    bpy.ops.extensions.package_install_files(
        filepath=str(newer()), repo="user_default", enable_on_install=True, overwrite=True
    )
    refused("Restart Blender to finish the update")


def newer():
    """The zip again, as that of the next minor release; the library inside still says the old version."""
    major, minor, _ = VERSION.split(".")
    new = f"{major}.{int(minor) + 1}.0"
    folder = Path(tempfile.mkdtemp())

    def renamed(source, target, dist_info):
        with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as made:
            for name in old.namelist():
                data = old.read(name)
                if name.endswith(".whl"):
                    (folder / "old.whl").write_bytes(data)
                    renamed(folder / "old.whl", folder / "new.whl", True)
                    data = (folder / "new.whl").read_bytes()
                elif name.endswith(("blender_manifest.toml", "METADATA", "RECORD")):
                    data = data.replace(VERSION.encode(), new.encode())
                made.writestr(name.replace(VERSION, new), data)

    path = folder / ZIP.name.replace(VERSION, new)
    renamed(ZIP, path, False)
    return path


def test_uninstall_leaves_nothing():
    repositories = [repository.module for repository in bpy.context.preferences.extensions.repos]
    bpy.ops.extensions.package_uninstall(repo_index=repositories.index("user_default"), pkg_id="gridmesh")
    assert not traces(), traces()
    assert not files(), files()


def test_install_again_after_all():
    """In the same session, with the version that is loaded."""
    test_install_and_enable()
    forget()
    test_strokes()
    test_fill()
    test_uninstall_leaves_nothing()


def main():
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    steps = [(name, step) for name, step in globals().items() if name.startswith("test_")]
    for name, step in steps:
        note = ""
        try:
            step()
            outcome = "passed"
        except SkipError as error:
            outcome, note = "skipped", f": {error}"
        except Exception:
            outcome, note = "failed", f"\n{traceback.format_exc()}"
        counts[outcome] += 1
        print(f"{outcome.upper():<8}{name.removeprefix('test_').replace('_', ' ')}{note}", flush=True)
    where = f"Blender {bpy.app.version_string}, Python {sys.version.split()[0]}, numpy {np.__version__}"
    print(f"{where}: {', '.join(f'{number} {outcome}' for outcome, number in counts.items())}")
    if ADDON in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_disable(module=ADDON)
    sys.stdout.flush()
    sys.stderr.flush()
    # Blender 4.5 can crash or hang in its own clean-up at exit.
    os._exit(1 if counts["failed"] else 0)


main()
