# SPDX-License-Identifier: GPL-3.0-or-later
"""GridMesh: smooth bodies with clean triangle meshes from drawn strokes.

    operators.strokes -> strokes, curves (from Blender) -> outlines, api (numpy only) -> meshes (to Blender)
    operators.fill -> editmesh (from Blender) -> holes, api (no bpy) -> editmesh, attributes (to Blender)
    operators.cut -> cutline, cutobject (from Blender) -> cutting (no bpy) -> cutmesh, cutcorners (to Blender)

`properties` holds what the redo panel shows, `ui` the sidebar and the menus. The native module `gridmesh` is
imported when it is first needed, so that the extension registers, and can say what is wrong, without it; and
bpy only in `register`, so that `outlines` and `api` run in plain Python.
"""


def register() -> None:
    """Register all classes and menu entries; if one fails, none stays."""
    import bpy

    from . import ui

    done = []
    try:
        for cls in _classes():
            bpy.utils.register_class(cls)
            done.append(cls)
        ui.add_menus()
    except BaseException:
        for cls in reversed(done):
            bpy.utils.unregister_class(cls)
        raise


def unregister() -> None:
    """Undo `register`, also where it was undone in part."""
    import bpy

    from . import ui

    ui.remove_menus()
    for cls in reversed(_classes()):
        if cls.is_registered:
            bpy.utils.unregister_class(cls)


def _classes() -> tuple[type, ...]:
    from . import ui
    from .operators import cut, fill, strokes

    return (*strokes.classes, *fill.classes, *cut.classes, *ui.classes)
