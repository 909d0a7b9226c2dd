# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_cut`: the selected meshes are cut along a stroke and closed with grid patches."""

from __future__ import annotations

from math import degrees
from time import perf_counter

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from .. import api
from ..data import defaults
from ..text.messages import counted, faces_counted, listed
from ..text.telling import told
from ..ui.progress import Pointer
from ..ui.properties import PATCH_FACES
from . import cutline, cutsweep, cutting
from .cutobject import Caps, Target, sharing
from .draw_operator import DrawnCut


class GRIDMESH_PG_cut_point(bpy.types.PropertyGroup):  # noqa: N801
    """A point of a drawn cut"""  # noqa: D400

    location: FloatVectorProperty(name="Location", description="In world space", subtype="XYZ", size=3)


class OBJECT_OT_gridmesh_cut(DrawnCut, bpy.types.Operator):  # noqa: N801
    """Cut the selected meshes along a stroke and close them with regular patches of triangles or quads"""  # noqa: D400 (the tooltip)

    bl_idname = "object.gridmesh_cut"
    bl_label = "Cut & Cap"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    source: EnumProperty(
        name="Source",
        description="Where the cut runs",
        items=[
            ("OBJECTS", "Selected Stroke", "Along a stroke of a selected grease pencil or curve object"),
            ("DRAWN", "Drawn", "Along a line drawn in the viewport"),
        ],
        default="OBJECTS",
        options={"SKIP_SAVE"},
    )
    keep: EnumProperty(
        name="Keep",
        description="Which side of the stroke is kept",
        items=[
            ("LEFT", "Left", "What is on the left of the stroke as it was drawn, or inside a closed one"),
            ("RIGHT", "Right", "What is on the right of the stroke as it was drawn, or outside a closed one"),
            ("BOTH", "Both", "Both sides"),
        ],
        default="BOTH",
    )
    pieces: EnumProperty(
        name="Pieces",
        description="What becomes of the two sides",
        items=[
            ("OBJECTS", "Two Objects", "The larger piece stays in the object, the other gets one of its own"),
            ("TOGETHER", "One Object", "Both pieces stay in the object, not joined"),
        ],
        default="OBJECTS",
    )
    direction: EnumProperty(
        name="Direction",
        description="Direction that the stroke is swept along, through the model",
        items=[
            ("VIEW", "View", "As the view sees it; without a view, along the normal of the stroke's plane"),
            ("PLANE", "Stroke Plane", "Along the normal of the plane that the stroke was drawn in"),
            ("X", "X", "Along the world's X axis; left and right are as in the right view"),
            ("Y", "Y", "Along the world's Y axis; left and right are as in the front view"),
            ("Z", "Z", "Along the world's Z axis; left and right are as in the top view"),
        ],
        default="VIEW",
    )
    number: IntProperty(
        name="Stroke",
        description="Number of the stroke to cut along; 0 for the selected one, or else the last one",
        default=0,
        min=0,
        options={"SKIP_SAVE"},
    )
    close_gaps: FloatProperty(
        name="Close Gaps",
        description="Largest gap between the ends of a stroke that is closed, relative to the stroke",
        subtype="FACTOR",
        default=defaults.CUT_CLOSE_GAPS,
        min=0.0,
        max=1.0,
    )
    extend_ends: BoolProperty(
        name="Extend Ends",
        description="Continue the ends of the stroke straight on through everything; otherwise only as far as the "
        "part of the mesh that the stroke crosses",
        default=False,
    )
    use_cap: BoolProperty(
        name="Cap",
        description="Close the pieces where they were cut",
        default=True,
    )
    edge_length: FloatProperty(
        name="Edge Length",
        description="Length of the edges along the cut, which makes even caps; 0 cuts exactly along the stroke "
        "and leaves the edges as the mesh divides them",
        subtype="DISTANCE",
        default=0.0,
        min=0.0,
    )
    smooth: EnumProperty(
        name="Smoothness",
        description="Shape of the caps",
        items=[
            ("FLAT", "Flat", "On the surface that the stroke swept"),
            ("TANGENT", "Tangent", "Bulging with the slope of the model"),
            ("CURVATURE", "Curvature", "Bulging with the slope and the curvature of the model"),
        ],
        default="FLAT",
    )
    cells: EnumProperty(
        name="Faces",
        description="What caps are made of",
        items=PATCH_FACES,
        default=defaults.CELLS,
    )
    gap: FloatProperty(
        name="Gap",
        description="Width of what is taken away along the cut",
        subtype="DISTANCE",
        default=0.0,
        min=0.0,
    )
    use_cap_slot: BoolProperty(
        name="Cap Material",
        description="Give the caps a material slot of their own",
        default=False,
    )
    cap_material: StringProperty(
        name="Material",
        description="Name of the material for caps; empty for an empty slot",
        default="",
        options={"SKIP_SAVE"},
    )
    stroke: CollectionProperty(type=GRIDMESH_PG_cut_point, options={"HIDDEN", "SKIP_SAVE"})
    view_kind: EnumProperty(
        items=[
            ("NONE", "None", ""),
            ("ORTHOGRAPHIC", "Orthographic", ""),
            ("PERSPECTIVE", "Perspective", ""),
        ],
        default="NONE",
        options={"HIDDEN", "SKIP_SAVE"},
    )
    view_eye: FloatVectorProperty(size=3, options={"HIDDEN", "SKIP_SAVE"})
    view_direction: FloatVectorProperty(size=3, options={"HIDDEN", "SKIP_SAVE"})
    result: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    suggest_length = False
    """Set by `invoke`: the edge length is chosen to suit the mesh."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for an active mesh in Object or Edit Mode."""
        ob = context.view_layer.objects.active
        if ob is not None and ob.type == "MESH" and context.mode in {"OBJECT", "EDIT_MESH"}:
            return True
        cls.poll_message_set(told("Make a mesh the active object, in Object or Edit Mode", "tooltips"))
        return False

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Let the user draw the cut, or take what the view and the mesh suggest."""
        self.suggest_length = not self.properties.is_property_set("edge_length")
        if self.source == "DRAWN" and not self.stroke:
            return self.begin_drawing(context, event)
        return self.execute(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Read and cut all meshes, and only then change the scene."""
        started = perf_counter()
        try:
            api.native("cut")
            material = self._material()
            strokes, notes = self._strokes(context)
            with Pointer(context) as pointer:
                done, missed = self._divided(strokes, pointer)
            if not done:
                raise cutsweep.CutError(listed(missed))
            others = sharing([target.ob for target, *_ in done], [ob for ob, *_ in strokes])
            objects, frozen = [], []
            for target, division, stroke, sweep in done:
                frozen += [target.ob.name] if target.is_live else []
                objects += target.apply(
                    context,
                    division.parts,
                    stroke,
                    sweep,
                    Caps(self.smooth == "FLAT", self.use_cap and self.use_cap_slot, material),
                    together=self.pieces == "TOGETHER",
                )
        except (api.NativeError, cutsweep.CutError) as error:
            self.report({"ERROR"}, told(listed([str(error)])))
            return {"CANCELLED"}
        except api.CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was cut"))
            return {"CANCELLED"}
        if context.mode == "OBJECT":
            for source in cutline.stroke_objects(context):
                if source not in objects:
                    source.select_set(False)
        if frozen:
            notes.append(f"frozen, since a cut body cannot follow its drawing: {', '.join(frozen)}")
        if others:
            notes.append(f"also changed, with the same mesh: {', '.join(others)}")
        self._tell([division for _, division, _, _ in done], notes, missed, perf_counter() - started)
        return {"FINISHED"}

    def _strokes(
        self, context: bpy.types.Context
    ) -> tuple[list[tuple[bpy.types.Object, np.ndarray, cutsweep.Sweep, bool]], list[str]]:
        """Return the stroke, the sweep and whether it is closed, for each mesh, and what the user should know."""
        points, cyclic, sweep, notes = self._line(context)
        return [(ob, points, sweep, cyclic) for ob in cut_objects(context)], notes

    def _divided(
        self, strokes: list[tuple[bpy.types.Object, np.ndarray, cutsweep.Sweep, bool]], pointer: Pointer
    ) -> tuple[list[tuple[Target, cutting.Division, np.ndarray, cutsweep.Sweep]], list[str]]:
        """Cut each mesh that can be cut; return these, and why the others cannot."""
        done, missed, several = [], [], len(strokes) > 1
        meshes: dict[bpy.types.Mesh, str] = {}
        for k, (ob, points, sweep, cyclic) in enumerate(strokes):
            try:
                if ob.data in meshes:
                    missed.append(
                        f"'{ob.name}' has the same mesh as '{meshes[ob.data]}' and is what that is; "
                        "make it single-user to cut it by itself"
                    )
                    continue
                target = Target(ob)
                stroke, own = target.line(points, sweep, cyclic=cyclic, close_gaps=self._gaps())
                if self.suggest_length:
                    self.edge_length = target.model.edge_length()
                    self.suggest_length = False
                division = cutting.divide(
                    target.model,
                    stroke,
                    own,
                    together=self.pieces == "TOGETHER",
                    progress=pointer.part(k / len(strokes), (k + 1) / len(strokes)),
                    keep=self.keep.lower(),
                    cap=self.use_cap,
                    edge_length=self.edge_length or None,
                    gap=self.gap,
                    smooth=self.smooth.lower(),
                    cells=self.cells.lower(),
                    extend_ends=self.extend_ends,
                )
            except cutsweep.CutError as error:
                missed.append(f"'{ob.name}' is left as it was: {error}" if several else str(error))
                continue
            meshes[ob.data] = ob.name
            done.append((target, division, stroke, own))
        return done, missed

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        if self.result:
            numbers = layout.column(align=True)
            parts = self.result.split(", ")
            for at in range(0, len(parts), 2):  # on one line they would be cut off
                numbers.label(text=told(", ".join(parts[at : at + 2]), "interface"))
        layout.prop(self, "keep")
        if self.keep == "BOTH":
            layout.prop(self, "pieces")
        layout.prop(self, "extend_ends")
        layout.prop(self, "gap")
        layout.prop(self, "edge_length")
        layout.prop(self, "use_cap")
        column = layout.column()
        column.active = self.use_cap
        column.prop(self, "smooth")
        column.prop(self, "cells")
        column.prop(self, "use_cap_slot")
        if self.use_cap_slot:
            column.prop_search(self, "cap_material", bpy.data, "materials")
        header, body = layout.panel(f"{self.bl_idname}_stroke", default_closed=True)
        header.label(text="Stroke")
        if body is not None:
            body.prop(self, "direction")
            if not self.stroke:
                body.prop(self, "number")
                body.prop(self, "close_gaps")

    def targets(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Meshes that are cut."""
        return cut_objects(context)

    def remember_view(self, view: cutline.View) -> None:
        """Keep the view in the properties, so that the redo panel cuts the same again."""
        self.view_kind = "PERSPECTIVE" if view.perspective else "ORTHOGRAPHIC"
        self.view_eye, self.view_direction = view.eye.tolist(), view.direction.tolist()

    def _view(self, context: bpy.types.Context) -> cutline.View | None:
        if self.view_kind == "NONE":
            region_data = context.region_data
            if region_data is None or bpy.app.background:
                return None
            self.remember_view(cutline.View.of(region_data))
        direction = np.array(self.view_direction, float)
        if not direction.any():
            raise cutsweep.CutError("view_direction is zero; give the direction in which the view looks")
        direction /= np.linalg.norm(direction)
        return cutline.View(np.array(self.view_eye, float), direction, self.view_kind == "PERSPECTIVE")

    def _line(self, context: bpy.types.Context) -> tuple[np.ndarray, bool, cutsweep.Sweep, list[str]]:
        """Return points and sweep in the world, whether the stroke is closed, and what the user should know of them."""
        view = self._view(context)
        notes: list[str] = []
        cyclic = False
        if self.stroke:
            points = np.array([point.location for point in self.stroke], float)
        elif self.source == "DRAWN":
            raise cutsweep.CutError("the stroke has no points; call this operator from a 3D view to draw one")
        else:
            found, notes = cutline.read(context, self.number)
            points, cyclic = np.asarray(found.points, float), found.cyclic
        cutsweep.require_finite(points)
        sweep, more = cutline.sweep_of(self.direction, points, view)
        return points, cyclic, sweep, notes + more

    def _gaps(self) -> float:
        """Gaps that are closed: none of a stroke that was drawn for the cut."""
        return 0.0 if self.stroke else self.close_gaps

    def _material(self) -> bpy.types.Material | None:
        if not (self.use_cap_slot and self.cap_material):
            return None
        material = bpy.data.materials.get(self.cap_material)
        if material is None:
            raise cutsweep.CutError(
                f"there is no material '{self.cap_material}'; choose another one, or none for an empty slot"
            )
        return material

    def _tell(
        self, divisions: list[cutting.Division], notes: list[str], missed: list[str], seconds: float
    ) -> None:
        """Report numbers, and what the user should know."""
        reports = [division.report for division in divisions]
        sides = [1 if self.gap else len(division.parts) for division in divisions]
        parts = [part for division in divisions for part in division.parts]

        def total(name: str) -> int:
            return sum(report[name] * n for report, n in zip(reports, sides, strict=True))

        faces = [len(face) for part in parts for face in part.caps]
        texts = [counted(len(parts), "piece")]
        if faces:
            least = min(report["cap_min_angle"] for report in reports)
            texts += [
                f"{counted(total('caps'), 'cap')}: {faces_counted(faces)}",
                counted(total("cap_irregular"), "irregular vertex"),
                f"smallest angle {degrees(least):.0f}°",
            ]
        self.result = ", ".join([*texts, f"{1000 * seconds:.0f} ms"])
        self.report({"INFO"}, told(self.result))
        if notes:
            self.report({"INFO"}, told(listed(notes)))
        summed = {
            name: sum(report[name] for report in reports)
            for name in ("open_lines", "uncapped", "flat_caps", "folded", "reduced_caps")
        }
        warnings = missed + cutting.warnings_of(summed, capped=self.use_cap)
        if warnings:
            self.report({"WARNING"}, told(listed(warnings)))


def cut_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Meshes that a stroke cuts, the active one first: those that are selected, or in Edit Mode those being edited."""
    active = context.view_layer.objects.active
    others = context.objects_in_mode if context.mode == "EDIT_MESH" else context.selected_objects
    return [active, *(ob for ob in others if ob.type == "MESH" and ob != active)]


classes = (GRIDMESH_PG_cut_point, OBJECT_OT_gridmesh_cut)
