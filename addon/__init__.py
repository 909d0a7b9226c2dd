# SPDX-License-Identifier: GPL-3.0-or-later
"""GridMesh: smooth bodies with clean triangle meshes from drawn strokes.

    operators.strokes -> strokes, curves (from Blender) -> outlines, api (numpy only) -> meshes (to Blender)
    draw -> outlines of its own; live keeps bodies up to date with their strokes; overlay shows what meshes are like
    operators.fill -> editmesh (from Blender) -> holes, api (no bpy) -> editmesh, attributes (to Blender)
    operators.cut -> cutline, cutobject (from Blender) -> cutsweep, cutting (no bpy) -> cutmesh, cutcorners (to Blender)

`properties` holds what the redo panel shows, `ui` the sidebar and the menus. The native module `gridmesh` is
imported by `native` when it is first needed, so that the extension registers, and can say what is wrong, without it;
and bpy only in `register`, so that `outlines` and `api` run in plain Python.
"""

from types import ModuleType


def register() -> None:
    """Register all classes, menu entries and the like; if one fails, none stays."""
    import bpy

    from . import translations

    done = []
    try:
        for cls in _classes():
            translations.claim(cls)
            bpy.utils.register_class(cls)
            done.append(cls)
        for part in _parts():
            part.register()
    except BaseException:
        for part in reversed(_parts()):
            part.unregister()
        for cls in reversed(done):
            bpy.utils.unregister_class(cls)
        raise


def unregister() -> None:
    """Undo `register`, also where it was undone in part."""
    import bpy

    for part in reversed(_parts()):
        part.unregister()
    for cls in reversed(_classes()):
        if cls.is_registered:
            bpy.utils.unregister_class(cls)


def _classes() -> tuple[type, ...]:
    from . import ui
    from .draw import operator as draw
    from .live import properties as live
    from .live import ui as live_ui
    from .operators import cut, fill, refine, strokes
    from .overlay import ui as overlay

    return (
        *strokes.classes,
        *fill.classes,
        *cut.classes,
        *overlay.classes,
        *refine.classes,
        *live.classes,
        *draw.classes,
        *ui.classes,
        *live_ui.classes,
    )


def _parts() -> tuple[ModuleType, ...]:
    """Modules with more to register than classes; their `unregister` may be called at any time."""
    from . import cli, frames, keys, preset_files, translations, ui
    from .draw import cut_tool
    from .draw import tool as draw
    from .live import engine, handlers, watch
    from .live import properties as live
    from .operators import refine
    from .overlay import ui as overlay

    return (
        translations,
        preset_files,
        ui,
        overlay,
        frames,
        live,
        engine,
        handlers,
        watch,
        refine,
        draw,
        cut_tool,
        keys,
        cli,
    )
