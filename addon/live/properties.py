# SPDX-License-Identifier: GPL-3.0-or-later
"""What a body remembers of how it was made, so that it can be made again."""

from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..bodies import profilecurve
from ..bodies.strokes import SOURCE_TYPES
from ..data import defaults
from ..ui.properties import ShapeOptions, SketchOptions

SHAPE_ICONS = {
    "ROUND": "LINCURVE",
    "PLATEAU": "SPHERECURVE",
    "POINTED": "SHARPCURVE",
    "RING": "INVERSESQUARECURVE",
    "HAT": "SMOOTHCURVE",
}
"""Pictures of the curves to start from."""


def _changed(live: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    from . import engine

    if live.enabled and not live.quiet:
        engine.touch(engine.hand_over(live.id_data))


def _with_update(deferred: Any) -> Any:
    """Return the same property, which tells the body when it is changed."""
    return deferred.function(**{**deferred.keywords, "update": _changed})


class GridMeshLive(SketchOptions, ShapeOptions, bpy.types.PropertyGroup):
    """Link from a body to its stroke. A pointer to the drawing outlives renaming, appending and duplicating."""

    bl_idname = "gridmesh_live"
    bl_label = "Live Body"

    linked: BoolProperty(options={"HIDDEN"})
    enabled: BoolProperty(
        name="Follow",
        description="Let the body follow its stroke",
        default=False,
        update=_changed,
    )
    source: PointerProperty(
        type=bpy.types.Object, name="Drawing", poll=lambda _self, ob: ob.type in SOURCE_TYPES
    )
    layer: StringProperty(options={"HIDDEN"})
    stroke: IntProperty(options={"HIDDEN"})
    count: IntProperty(options={"HIDDEN"})
    close_gaps: FloatProperty(
        name="Close Gaps", subtype="FACTOR", default=defaults.CLOSE_GAPS, min=0.0, max=1.0
    )
    use_holes: BoolProperty(name="Holes", default=True)
    pen: FloatProperty(
        name="Pen Width",
        description="How much the width of the drawn line drives the depth of the body there",
        subtype="FACTOR",
        default=0.0,
        min=0.0,
        max=1.0,
        update=_changed,
    )
    pen_detail: FloatProperty(
        name="Detail by Pen Width",
        description="How much the width of the drawn line drives how many faces there are, on a grid that bends",
        subtype="FACTOR",
        default=0.0,
        min=0.0,
        max=1.0,
        update=_changed,
    )
    quiet: BoolProperty(options={"HIDDEN"})
    """Whether several properties are being set, and the body should wait."""
    algorithm: IntProperty(options={"HIDDEN"})
    digest: StringProperty(options={"HIDDEN"})
    """Fingerprint of the stroke and the options that the body was made of in full; empty while it is being dragged."""
    lattice: FloatVectorProperty(size=4, precision=6, options={"HIDDEN"})
    """Edge length, angle and origin in the plane."""
    frame: FloatVectorProperty(size=16, options={"HIDDEN"})
    """Matrix from the space of the drawing to that of the body, by rows; see `frames`. All 0 in files of 0.1.0."""
    space: FloatVectorProperty(size=16, options={"HIDDEN"})
    """Matrix from the body's own space, that of its sketch, to that of the object, by rows. All 0: the identity."""
    samples: FloatVectorProperty(size=24, options={"HIDDEN"})
    """Some points of the sketch in the body's own space when the body was made last."""
    carried: FloatVectorProperty(size=16, options={"HIDDEN"})
    """Matrix from the body to its parent, then: where that is a drawing that is applied, Blender gives it another."""
    plane: FloatVectorProperty(size=12, options={"HIDDEN"})
    """Plane of the sketch in the body's space when the body was made last: its origin and its axes."""
    uid: IntProperty(options={"HIDDEN"})
    """`session_uid` of the object, by which a copy is told from the body."""
    problem: StringProperty(options={"HIDDEN"})
    """Why the body does not follow now."""

    def curve_points(self) -> Any:
        """Points of the body's curve; None without one."""
        return profilecurve.points(self.id_data)

    def body_options(self) -> dict[str, Any] | None:
        """Keyword arguments of `gridmesh.inflate`; None for a flat sheet."""
        options = super().body_options()
        values = profilecurve.values(self.id_data)
        if options is not None and values is not None:
            options["curve"] = values
        return options

    def draw_curve(self, layout: bpy.types.UILayout) -> None:
        """Draw the curve itself, and what it can start from."""
        found = profilecurve.holder(self.id_data)
        idname = "object.gridmesh_curve"
        if found is None:
            layout.operator(idname, text="Add Profile Curve", icon="NORMALIZE_FCURVES").shape = "ROUND"
            return
        box = layout.column(align=True)
        row = box.row(align=True)
        for shape, icon in SHAPE_ICONS.items():
            row.operator(idname, text="", icon=icon).shape = shape
        row.operator(idname, text="", icon="X").shape = "NONE"
        box.template_curve_mapping(found, "map_curve")

    def copy_options(self, operator: Any) -> None:
        """Take over the options of an operator that made the body."""
        self.quiet = True
        names = self.bl_rna.properties.keys()
        for cls in (SketchOptions, ShapeOptions):
            for name in cls.__annotations__:
                if name in names and hasattr(operator, name):
                    setattr(self, name, getattr(operator, name))
        for name in ("close_gaps", "use_holes"):
            if hasattr(operator, name):
                setattr(self, name, getattr(operator, name))
        self.quiet = False


for _options in (SketchOptions, ShapeOptions):
    for _name, _deferred in _options.__annotations__.items():
        GridMeshLive.__annotations__[_name] = _with_update(_deferred)

classes = (GridMeshLive,)


def register() -> None:
    """Give objects the link."""
    bpy.types.Object.gridmesh_live = PointerProperty(type=GridMeshLive)


def unregister() -> None:
    """Take it away; what is stored in files stays."""
    if hasattr(bpy.types.Object, "gridmesh_live"):
        del bpy.types.Object.gridmesh_live
