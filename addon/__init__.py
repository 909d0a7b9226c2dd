# SPDX-License-Identifier: GPL-3.0-or-later
"""GridMesh: smooth bodies with clean triangle meshes from drawn strokes.

    bodies: strokes, curves (from Blender) -> outlines, api (numpy only) -> data.meshes (to Blender)
    draw -> outlines of its own; live keeps bodies up to date with their strokes; overlay shows what meshes are like
    pictures: images (from Blender) -> cutouts (numpy only) -> placing, weights (to Blender), formats (to files)
    fill: editmesh (from Blender) -> holes, api (no bpy) -> editmesh, data.attributes (to Blender)
    regrid: regionmesh (from Blender) -> api (no bpy) -> regionmesh, carried (to Blender)
    cut: cutline, cutobject (from Blender) -> cutsweep, cutting (no bpy) -> cutmesh, cutcorners (to Blender)
    join: joinobject (from Blender) -> uniting (no bpy) -> joinmesh, joinobject (to Blender); joining does it all, following keeps it up to date

`ui.properties` holds what the redo panel shows, `ui.panels` the sidebar and the menus, `text` all words. The native module `gridmesh` is
imported by `native` when it is first needed, so that the extension registers, and can say what is wrong, without it;
and bpy only in `register`, so that `outlines` and `api` run in plain Python.
"""

from types import ModuleType


def register() -> None:
    """Register all classes, menu entries and the like; if one fails, none stays."""
    import bpy

    from .text import translations

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
    from .bodies import operator as strokes
    from .bridge import operator as bridge
    from .cut import operator as cut
    from .draw import operator as draw
    from .fill import operator as fill
    from .join import following
    from .join import operator as join
    from .live import properties as live
    from .live import refine
    from .live import ui as live_ui
    from .overlay import ui as overlay
    from .pictures import dropping, updating, weights_operator
    from .pictures import operator as pictures
    from .regrid import operator as regrid
    from .ui import panels as ui

    return (
        *strokes.classes,
        *fill.classes,
        *regrid.classes,
        *bridge.classes,
        *cut.classes,
        *following.classes,
        *join.classes,
        *pictures.classes,
        *updating.classes,
        *weights_operator.classes,
        *dropping.classes,
        *overlay.classes,
        *refine.classes,
        *live.classes,
        *draw.classes,
        *ui.classes,
        *live_ui.classes,
    )


def _parts() -> tuple[ModuleType, ...]:
    """Modules with more to register than classes; their `unregister` may be called at any time."""
    from . import cli
    from .cut import tool as cut_tool
    from .data import frames
    from .draw import tool as draw
    from .join import following
    from .live import engine, handlers, refine, watch
    from .live import properties as live
    from .overlay import ui as overlay
    from .text import translations
    from .ui import keys, preset_files
    from .ui import panels as ui

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
        following,
        draw,
        cut_tool,
        keys,
        cli,
    )
