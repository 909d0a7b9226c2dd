# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that the redo panel shows, and what the module `gridmesh` makes of them.

No limits are enforced here but in the module, which says what is allowed instead of changing the value.
"""

from math import pi, radians
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from ..bodies import profilecurve
from ..data import defaults

FACES = [
    ("TRIANGLES", "Triangles", "Triangles, six around almost every vertex"),
    (
        "QUADS",
        "Quads",
        "Quads, four around almost every vertex, in edge loops along the outline; for subdivision and rigging",
    ),
]


PATCH_FACES = [
    ("TRIANGLES", "Triangles", "Triangles, six around almost every vertex"),
    (
        "QUADS",
        "Quads",
        "Quads, four around almost every vertex, that go on from those around; one triangle where the number of edges is odd",
    ),
]


def fineness_of(options: Any) -> str:
    """Name of the option that gives the fineness."""
    return "edge_length" if options.resolution == "EDGE_LENGTH" else options.cells.lower()


def may_bend(options: Any) -> bool:
    """Whether the grid bends with the drawing: only then can faces have several sizes."""
    free = options.boundary == "OPTIMAL" and options.angle_mode == "AUTO"
    return free and (options.cells == "QUADS" or options.bend > 0)


class SketchOptions:
    """How an outline is meshed. Mixed into operators."""

    cells: EnumProperty(
        name="Faces",
        description="What the mesh is made of",
        items=FACES,
        default=defaults.CELLS,
    )
    resolution: EnumProperty(
        name="Resolution",
        description="How the fineness of the mesh is given",
        # The numbers are those that files have stored.
        items=[
            (
                "AUTO",
                "Automatic",
                "As many faces as put five across the thinnest limb: 1000 to 20000 triangles of each side, or half "
                "as many quads",
                "NONE",
                2,
            ),
            ("TRIANGLES", "Number", "Give the number of triangles or quads of each side", "NONE", 0),
            ("EDGE_LENGTH", "Edge Length", "Give the length of the edges", "NONE", 1),
        ],
        default="AUTO",
    )
    triangles: IntProperty(
        name="Triangles of Each Side",
        description="Number of triangles of one side, reached within 10%; a body has two sides",
        default=defaults.TRIANGLES,
        soft_min=50,
        soft_max=100_000,
    )
    quads: IntProperty(
        name="Quads of Each Side",
        description="Number of quads of one side, reached within 10%; a body has two sides",
        default=defaults.QUADS,
        soft_min=50,
        soft_max=100_000,
    )
    edge_length: FloatProperty(
        name="Edge Length",
        description="Length of the edges of the mesh, seeded from the strokes",
        subtype="DISTANCE",
        default=0.1,
        soft_min=0.001,
        soft_max=10.0,
        precision=4,
        options={"SKIP_SAVE"},
    )
    boundary: EnumProperty(
        name="Boundary",
        description="How the rim of the grid is chosen",
        items=[
            (
                "OPTIMAL",
                "Optimal",
                "Find the rim with the fewest turns near the stroke, for the fewest irregular vertices",
            ),
            ("GROWN", "Grown", "Grow the grid from the middle and straighten its rim; for triangles"),
        ],
        default="OPTIMAL",
    )
    max_distance: FloatProperty(
        name="Max Distance",
        description="How far the grid's rim may stray before it is moved onto the stroke, in edge lengths",
        default=1.5,
        soft_min=0.5,
        soft_max=3.0,
    )
    bend: FloatProperty(
        name="Bend",
        description="How far a grid of triangles may bend with the stroke, which leaves fewer irregular vertices; 0 is straight",
        subtype="FACTOR",
        default=defaults.BEND,
        min=0.0,
        max=1.0,
    )
    detail: FloatProperty(
        name="Detail in Thin Parts",
        description="How much smaller faces are in thin parts than elsewhere, on a grid that bends; at 0 they are about as large",
        subtype="FACTOR",
        default=defaults.DETAIL,
        min=0.0,
        max=1.0,
    )
    angle_mode: EnumProperty(
        name="Grid Angle",
        description="Direction of the grid; a fixed one does not bend with the drawing",
        items=[
            ("AUTO", "Automatic", "Take the best of several angles"),
            ("FIXED", "Fixed", "Give the angle"),
        ],
        default="AUTO",
    )
    angle: FloatProperty(
        name="Angle",
        description="Angle of the grid in the drawing plane, from 0 to 60 degrees, of quads to 90",
        subtype="ANGLE",
        default=0.0,
        soft_min=0.0,
        soft_max=pi / 2 - 1e-4,
    )
    corner_angle: FloatProperty(
        name="Corner Angle",
        description="Keep corners where the stroke turns by more than this angle",
        subtype="ANGLE",
        default=defaults.CORNER_ANGLE,
        soft_min=radians(5.0),
        soft_max=pi,
    )

    mirror: EnumProperty(
        name="Mirror",
        description="Whether the mesh of a symmetric drawing is its own mirror image",
        items=[
            ("OFF", "Off", "Mesh the drawing as it is"),
            (
                "AUTO",
                "Automatic",
                "Find the axis of a drawing that is symmetric within 2% of its size, and mesh both halves alike",
            ),
        ],
        default="OFF",
    )
    use_union: BoolProperty(
        name="Resolve Crossings",
        description="Take the outer outline of strokes that cross themselves, instead of refusing them",
        default=False,
    )

    def settle_resolution(self) -> None:
        """Who gives a number of faces, and does not say how the fineness is given, means that number and those faces."""
        given = getattr(self, "properties", self)  # an operator's
        if given.is_property_set("resolution"):
            return
        if given.is_property_set("quads") and not given.is_property_set("cells"):
            self.cells = "QUADS"
        if given.is_property_set(self.cells.lower()):
            self.resolution = "TRIANGLES"

    def sketch_options(self) -> dict[str, Any]:
        """Keyword arguments of `gridmesh.mesh_sketch`."""
        self.settle_resolution()
        kind = self.cells.lower()
        fineness = {
            "AUTO": {kind: "auto"},
            "TRIANGLES": {kind: getattr(self, kind)},
            "EDGE_LENGTH": {"edge_length": self.edge_length},
        }
        return {
            # Quads always bend: poles cost more than irregular vertices of triangles.
            **({"cells": kind} if kind == "quads" else {"bend": self.bend}),
            **({"density": self.detail} if may_bend(self) else {}),
            **fineness[self.resolution],
            "boundary": self.boundary.lower(),
            "max_distance": self.max_distance,
            "angle": self.angle if self.angle_mode == "FIXED" else None,
            "corner_angle": self.corner_angle,
            "mirror": "auto" if self.mirror == "AUTO" else None,
            "self_crossing": "union" if self.use_union else "error",
        }

    def draw_sketch_options(self, layout: bpy.types.UILayout) -> None:
        """Draw the resolution, and the grid's options in a closed panel below."""
        layout.prop(self, "cells")
        column = layout.column()
        column.prop(self, "resolution")
        if self.resolution != "AUTO":
            column.prop(self, fineness_of(self))
        row = column.row()
        row.active = may_bend(self)
        row.prop(self, "detail")
        column.prop(self, "mirror")
        header, body = layout.panel(f"{self.bl_idname}_grid", default_closed=True)
        header.label(text="Grid")
        if body is not None:
            body.prop(self, "boundary")
            body.prop(self, "max_distance")
            if self.cells == "TRIANGLES":
                row = body.row()
                row.active = self.boundary == "OPTIMAL" and self.angle_mode == "AUTO"
                row.prop(self, "bend")
            body.prop(self, "angle_mode")
            if self.angle_mode == "FIXED":
                body.prop(self, "angle")
            body.prop(self, "corner_angle")


class ShapeOptions:
    """What is made of the meshed outline. Mixed into operators."""

    shape: EnumProperty(
        name="Shape",
        description="What is made of a stroke",
        items=[
            ("BODY", "Body", "A smooth closed body, inflated to both sides of the drawing plane"),
            ("SHEET", "Flat Sheet", "A flat mesh in the drawing plane"),
        ],
        default="BODY",
    )
    profile: EnumProperty(
        name="Profile",
        description="Cross-section of the body",
        items=[
            ("ROUND", "Round", "Round; a circle becomes a sphere"),
            ("EVEN", "Even", "Round; a long limb becomes a round tube"),
            ("FLAT", "Flat", "Flat with a rounded rim"),
            ("PEAK", "Peak", "Rising evenly to a ridge"),
        ],
        default="ROUND",
    )
    depth: FloatProperty(
        name="Depth",
        description="Thickness of the body; at 1 a circle becomes a sphere",
        default=1.0,
        soft_min=0.01,
        soft_max=3.0,
    )
    use_sides: BoolProperty(
        name="Separate Sides",
        description="Give the depth of the front and the back separately",
        default=False,
    )
    depth_front: FloatProperty(
        name="Front",
        description="Depth of the side that faces up or to the front",
        default=1.0,
        soft_min=0.0,
        soft_max=3.0,
    )
    depth_back: FloatProperty(
        name="Back",
        description="Depth of the side that faces down or to the back",
        default=1.0,
        soft_min=0.0,
        soft_max=3.0,
    )
    uv_layout: EnumProperty(
        name="UV Layout",
        description="Where the back of a body lies in the UV map",
        items=[
            ("APART", "Side by Side", "Beside the front: each side can be painted by itself"),
            ("SHARED", "On Top of Each Other", "Where the front is: what is painted on one side is on both"),
        ],
        default="APART",
    )

    use_subdivision: BoolProperty(
        name="Fit for Subdivision",
        description="Lay the rim of quads so far outside that it lies on the drawing when a Subdivision Surface modifier smooths the body",
        default=False,
    )

    def body_options(self) -> dict[str, Any] | None:
        """Keyword arguments of `gridmesh.inflate`; None for a flat sheet."""
        if self.shape == "SHEET":
            return None
        options: dict[str, Any] = {"profile": self.profile.lower(), "corner_angle": self.corner_angle}
        if self.uv_layout == "SHARED":
            options["uv"] = "shared"
        if self.use_subdivision:
            options["subdivided"] = True
        if self.use_sides:
            options |= {"front": self.depth_front, "back": self.depth_back}
        else:
            options["depth"] = self.depth
        return options

    def draw_curve(self, layout: bpy.types.UILayout) -> None:
        """Draw what reshapes the profile, below it."""

    def draw_shape_options(self, layout: bpy.types.UILayout) -> None:
        """Draw the shape and, for a body, its profile and depth."""
        layout.prop(self, "shape")
        if self.shape == "SHEET":
            return
        layout.prop(self, "profile")
        self.draw_curve(layout)
        column = layout.column()
        column.prop(self, "use_sides")
        if self.use_sides:
            column.prop(self, "depth_front")
            column.prop(self, "depth_back")
        else:
            column.prop(self, "depth")
        layout.prop(self, "uv_layout")
        if self.cells == "QUADS":
            layout.prop(self, "use_subdivision")


class CurveOption(ShapeOptions):
    """The shape, and a curve that reshapes its profile. Mixed into operators, which cannot hold a curve themselves."""

    curve: EnumProperty(
        name="Curve",
        description="Curve that reshapes the profile; that of a live body is edited in its panel in the sidebar",
        items=[
            ("NONE", "None", "The profile as it is; a live body that is updated keeps the curve it has"),
            *profilecurve.ITEMS,
            ("ACTIVE", "Active Body", "As the curve of the active live body; none if that has none"),
        ],
        default="NONE",
    )
    _points: Any = None

    def resolve_curve(self, context: bpy.types.Context) -> None:
        """Find out which curve is meant, before another object becomes the active one."""
        if self.curve == "ACTIVE":
            self._points = profilecurve.points(context.view_layer.objects.active)
        else:
            self._points = profilecurve.SHAPES.get(self.curve)

    def curve_points(self) -> Any:
        """Points of the curve that was found; None without one."""
        return self._points

    def body_options(self) -> dict[str, Any] | None:
        """Keyword arguments of `gridmesh.inflate`; None for a flat sheet."""
        options = super().body_options()
        values = profilecurve.values_of(self._points) if self._points is not None else None
        if options is not None and values is not None:
            options["curve"] = list(values)
        return options

    def draw_curve(self, layout: bpy.types.UILayout) -> None:
        """Draw which curve is taken, and where it can be edited: redoing takes back what is changed beside options."""
        layout.prop(self, "curve")
        if self.curve == "NONE":
            return
        if getattr(self, "follow", True):
            layout.label(text="Edit the curve in the sidebar, Live Body", icon="INFO")
        else:
            layout.label(text="Follow the Stroke, to edit the curve", icon="INFO")
