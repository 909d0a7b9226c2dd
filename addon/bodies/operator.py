# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_from_strokes`: every closed stroke becomes a mesh object."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from .. import api
from ..data import defaults, frames, meshes
from ..join import layering
from ..join.layering import JoinsBodies
from ..live import engine
from ..text import entries
from ..text.messages import counted, listed
from ..text.telling import told
from ..ui.patching import ResultShown
from ..ui.progress import Pointer
from ..ui.properties import CurveOption, SketchOptions
from ..ui.waiting import Waiting
from . import hidden, outlines, profilecurve, strokes
from .density import measure

LONG = 50_000
"""Flat triangles; with more, which take a second or so, the work can be watched and stopped."""


class OBJECT_OT_gridmesh_from_strokes(  # noqa: N801
    Waiting, JoinsBodies, SketchOptions, CurveOption, ResultShown, bpy.types.Operator
):
    """Make a smooth body with a clean mesh of triangles or quads from each closed stroke"""  # noqa: D400 (the tooltip)

    bl_idname = "object.gridmesh_from_strokes"
    bl_label = "Strokes to Mesh"
    bl_options = {"REGISTER", "UNDO", "PRESET"}  # noqa: RUF012

    source: EnumProperty(
        name="Source",
        description="Where the strokes are",
        items=[
            ("OBJECTS", "Objects", "Grease pencil, curve and text objects that are selected or being edited"),
            ("ANNOTATIONS", "Annotations", "Annotations of the scene, drawn in space"),
        ],
        default="OBJECTS",
        options={"SKIP_SAVE"},
    )
    use: EnumProperty(
        name="Use",
        description="Strokes that become meshes",
        items=[
            ("ALL", "All", "All strokes; those that cannot be closed are named"),
            ("SELECTED", "Selected", "Strokes that are selected, or have a selected point"),
            ("CLOSED", "Closed", "Strokes that are closed or nearly so; leave out open ones"),
        ],
        default="ALL",
    )
    close_gaps: FloatProperty(
        name="Close Gaps",
        description="Largest gap that is closed, and longest overshoot cut off, relative to the stroke",
        subtype="FACTOR",
        default=defaults.CLOSE_GAPS,
        min=0.0,
        max=1.0,
    )
    use_holes: BoolProperty(
        name="Holes",
        description="Make strokes inside others of the same layer holes in them, and strokes inside holes bodies",
        default=True,
    )
    update_existing: BoolProperty(
        name="Update Existing",
        description="Replace the mesh of the object made from the stroke before, and keep all else of it",
        default=True,
        options={"SKIP_SAVE"},
    )
    collection: EnumProperty(
        name="Collection",
        description="Collection that new objects go to",
        items=[
            ("SOURCE", "Of the Source", "Collection that the strokes are in"),
            ("ACTIVE", "Active", "Active collection"),
            ("NEW", "New", "New collection beside the strokes"),
        ],
        default="SOURCE",
    )
    follow: BoolProperty(
        name="Follow the Stroke",
        description="Let the body follow when its stroke is edited; the switch is in the sidebar",
        default=False,
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: Any) -> str:
        """Say what the entry does that is pointed at."""
        return told(entries.described(properties), "tooltips")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for an object with strokes, or annotations."""
        if strokes.source_objects(context) or meshes.selected_bodies(context):
            return True
        if strokes.annotation(context.scene) is not None:
            return True
        cls.poll_message_set(
            told("Select a grease pencil, curve or text object with closed strokes", "tooltips")
        )
        return False

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Fill in what the strokes suggest: which to use, and an edge length."""
        read = self._read(context).strokes
        active = context.view_layer.objects.active
        editing = active is not None and active.mode == "EDIT"
        if editing and not self.properties.is_property_set("use"):
            self.use = "SELECTED" if any(stroke.selected for stroke in read) else "ALL"
        if not self.properties.is_property_set("edge_length"):
            chosen = self._chosen(read)
            sketches, _, _ = api.sketches_of(chosen, close_gaps=self.close_gaps, holes=self.use_holes)
            kind = self.cells.lower()
            length = api.suggested_edge_length(sketches, getattr(self, kind), kind)
            self.edge_length = length if length is not None else self.edge_length
        self.may_wait = context.window is not None and not bpy.app.background
        return self.execute(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Read, mesh, and only then change the scene."""
        started = perf_counter() - self.waited()
        try:
            api.native()
        except api.NativeError as error:
            return self._refuse(str(error))
        self.resolve_curve(context)
        reading = self._read(context)
        failures = list(reading.failures)
        if not reading.strokes:
            return self._refuse(*map(str, failures), *reading.notes)
        chosen = self._chosen(reading.strokes)
        if not chosen:
            return self._refuse(_none_chosen(reading.strokes))
        sketches, refused, notes = api.sketches_of(chosen, close_gaps=self.close_gaps, holes=self.use_holes)
        if reading.wanted is not None:
            sketches, refused = _only(reading.wanted, sketches, chosen, refused)
        failures += refused
        known: set[tuple[str, str, int]] = set()
        update = self.update_existing and not self.joins
        if update:
            notes += meshes.made_from_holes(context, sketches)
            sketches, refused = meshes.separate_blocked(context, sketches)
            failures += refused
            known = set(meshes.made_before(context))
            sketches = meshes.localized(context, sketches, self.close_gaps)
        options = self.sketch_options(), self.body_options()
        if self.may_wait and api.expected_triangles(sketches, options[0]) > LONG:
            return self.wait(context, lambda progress: api.build(sketches, *options, progress))
        try:
            with Pointer(context) as pointer:
                bodies, refused = self.take_done() or api.build(sketches, *options, pointer)
        except api.CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was made"))
            return {"CANCELLED"}
        failures += refused
        if not bodies:
            return self._refuse(*map(str, failures))
        notes += _there_already(sum(body.sketch.stroke.key in known for body in bodies))
        made: list[bpy.types.Object] = []
        notes += meshes.place(
            context,
            bodies,
            update=update,
            collection=self.collection,
            crease_angle=self.corner_angle,
            made=made,
        )
        warnings = _warnings(bodies, failures)
        self.stack(context, bodies, made)
        self._link(context, bodies, made)
        whole = self.join(context, bodies, made, warnings)
        if whole is None:
            self.result = self._summary(bodies, perf_counter() - started)
            warnings += self._hidden(context, bodies, made)
        else:
            self.result = whole.result(perf_counter() - started)
        self.report({"INFO"}, told(self.result))
        if notes:
            self.report({"INFO"}, told(listed(notes)))
        for warning in warnings:
            self.report({"WARNING"}, told(warning))
        return {"FINISHED"}

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.draw_result()
        self.draw_shape_options(layout)
        self.draw_sketch_options(layout)
        header, body = layout.panel(f"{self.bl_idname}_strokes", default_closed=True)
        header.label(text="Strokes")
        if body is not None:
            body.prop(self, "use")
            body.prop(self, "close_gaps")
            body.prop(self, "use_holes")
            body.prop(self, "use_union")
            self.draw_join(body)
        header, body = layout.panel(f"{self.bl_idname}_objects", default_closed=True)
        header.label(text="Objects")
        if body is not None:
            body.prop(self, "update_existing")
            body.prop(self, "collection")
            body.prop(self, "follow")

    def _link(self, context: bpy.types.Context, bodies: list[api.Body], made: list[bpy.types.Object]) -> None:
        """Let the bodies know their drawings, and those that know them already the options they have now."""
        context.view_layer.update()
        for body, ob in zip(bodies, made, strict=True):
            source = context.view_layer.objects.get(body.sketch.stroke.source)
            if source is not None and (self.follow or frames.is_linked(ob)):
                follow = self.follow or ob.gridmesh_live.enabled
                engine.link(ob, body.sketch.stroke, source, self, follow=follow)
                if follow:
                    frames.carry(ob, source, body.sketch.stroke.layer)
                if self.curve_points() is None and profilecurve.holder(ob) is not None:
                    engine.remake(ob)  # with the curve that it has

    def _read(self, context: bpy.types.Context) -> strokes.Reading:
        if self.source == "ANNOTATIONS":
            return strokes.read_annotations(context)
        objects = strokes.source_objects(context)
        if objects:
            return strokes.read_objects(context, objects)
        selected = meshes.selected_bodies(context) if self.update_existing else []
        if selected:
            return _read_for(context, selected)
        return strokes.Reading(notes=["no object with strokes is selected; select a drawing or a curve"])

    def _chosen(self, found: list[outlines.Stroke]) -> list[outlines.Stroke]:
        """Strokes that `use` asks for; without those that are open where only closed ones are wanted."""
        if self.use == "SELECTED":
            return [stroke for stroke in found if stroke.selected]
        if self.use == "CLOSED":
            return [stroke for stroke in found if outlines.closable(stroke, self.close_gaps)]
        return found

    def _hidden(
        self, context: bpy.types.Context, bodies: list[api.Body], made: list[bpy.types.Object]
    ) -> list[str]:
        """Tell of bodies that cannot be seen, and what lets them be; sheets hide nothing."""
        pairs = hidden.pairs(made) if self.shape == "BODY" else []
        if not pairs:
            return []
        ranks = [layering.rank_of(context, body) for body in bodies]
        above = any(ranks[inner] > ranks[outer] for inner, outer in pairs)
        keys = [body.sketch.stroke.key[:2] for body in bodies]
        same = any(keys[inner] == keys[outer] for inner, outer in pairs)
        return [
            hidden.warning(len(pairs), layers=above and not self.joins, holes=same and not self.use_holes)
        ]

    def _refuse(self, *reasons: str) -> set[str]:
        """Report why nothing was made, and leave the scene alone."""
        self.report({"ERROR"}, told(listed(reasons)))
        return {"CANCELLED"}

    def _summary(self, bodies: list[api.Body], seconds: float) -> str:
        kind = "sheet" if self.shape == "SHEET" else "body"
        face = api.kind_of(bodies[0].faces)
        faces = sum(len(body.faces) for body in bodies)
        irregular = sum(body.report["irregular"] for body in bodies)
        text = (
            f"{counted(len(bodies), kind)}: {counted(faces, face)}, "
            f"{counted(irregular, 'irregular vertex')}, {1000 * seconds:.0f} ms"
        )
        gaps = sum(body.sketch.closed_gap > 0 for body in bodies)
        return f"{text}; {counted(gaps, 'gap')} closed" if gaps else text


def _there_already(updated: int) -> list[str]:
    """Say that bodies were updated that had been made before."""
    if not updated:
        return []
    if updated == 1:
        return ["1 body was there already and was updated; turn off Update Existing to make another"]
    return [f"{updated} bodies were there already and were updated; turn off Update Existing to make another"]


def _read_for(context: bpy.types.Context, bodies: list[bpy.types.Object]) -> strokes.Reading:
    """Read the strokes that the bodies were made from, and name the bodies whose stroke is gone."""
    made = {meshes.stroke_key(body): body for body in bodies}
    names = dict.fromkeys(key[0] for key in made)
    objects = [ob for ob in map(context.view_layer.objects.get, names) if ob is not None]
    sources = [ob for ob in objects if ob.type in strokes.SOURCE_TYPES]
    reading = strokes.read_objects(context, sources)
    # All strokes of their layers stay: some are holes.
    layers = {key[:2] for key in made}
    reading.strokes = [stroke for stroke in reading.strokes if stroke.key[:2] in layers]
    reading.wanted = set(made)
    found = {stroke.key for stroke in reading.strokes}
    for key, body in made.items():
        if key not in found:
            source, layer, index = key
            where = f"'{source}', layer '{layer}'" if layer else f"'{source}'"
            reason = f"its stroke ({where}, stroke {index + 1}) is gone or hidden; select the drawing instead"
            reading.failures.append(api.Failure(f"'{body.name}'", reason))
    return reading


def _only(
    wanted: set[tuple[str, str, int]],
    sketches: list[outlines.Sketch],
    chosen: list[outlines.Stroke],
    refused: list[api.Failure],
) -> tuple[list[outlines.Sketch], list[api.Failure]]:
    """Leave what concerns the wanted strokes, and name those of them that became holes."""
    sketches = [sketch for sketch in sketches if sketch.stroke.key in wanted]
    labels = {stroke.label for stroke in chosen if stroke.key in wanted}
    refused = [failure for failure in refused if failure.label in labels]
    labels -= {sketch.stroke.label for sketch in sketches} | {failure.label for failure in refused}
    reason = "it lies inside another stroke and is a hole there; turn off Holes to make a body of it"
    return sketches, refused + [api.Failure(label, reason) for label in sorted(labels)]


def _none_chosen(found: list[outlines.Stroke]) -> str:
    """Say why none of the strokes is used."""
    if any(stroke.selected is None for stroke in found):
        return "modifiers hide which strokes are selected; set Use to All, or apply the modifiers"
    return "none of the strokes is selected or closed; select one in Edit Mode, or set Use to All"


def _warnings(bodies: list[api.Body], failures: list[api.Failure]) -> list[str]:
    """Tell what the user should know about the strokes used, and name those left out."""
    warnings = []
    bent = [body.sketch for body in bodies if body.sketch.off_plane > outlines.NOTABLE * body.sketch.size]
    if bent:
        worst = max(bent, key=lambda sketch: sketch.off_plane / sketch.size)
        label = worst.stroke.label
        if len(bent) > 1:
            label = f"{label} (and {len(bent) - 1} more)"
        warnings.append(
            f"{label}: not flat, up to {worst.off_plane:.3g} from its plane; it was projected onto the plane"
        )
    crossed = sum(body.report.get("self_intersections", 0) > 0 for body in bodies)
    if crossed:
        some = counted(crossed, "body")
        warnings.append(
            f"{some} cuts through itself; use a smaller depth or more triangles"
            if crossed == 1
            else f"{some} cut through themselves; use a smaller depth or more triangles"
        )
    painted = sum(body.sketch.stroke.painted for body in bodies)
    if painted:
        warnings.append(
            "A stroke is painted; bodies have the colour of the material instead"
            if painted == 1
            else f"{painted} strokes are painted; bodies have the colour of the material instead"
        )
    warnings += _thin(bodies)
    if failures:
        warnings.append(f"{counted(len(failures), 'stroke')} left out:\n{listed(map(str, failures))}")
    return warnings


def _thin(bodies: list[api.Body]) -> list[str]:
    """Name the body with the fewest faces across a limb, if those are too few."""
    found = []
    for body in bodies:
        sides = 1 if not body.report["watertight"] else 2
        density = measure(body.sketch, len(body.faces) // sides, api.kind_of(body.faces))
        if density is not None and density.is_low:
            found.append((density.across, body.sketch.stroke.label, density.text))
    return [f"{label}: {text}" for _, label, text in sorted(found)[:1]]


classes = (OBJECT_OT_gridmesh_from_strokes,)
