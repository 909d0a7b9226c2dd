# SPDX-License-Identifier: GPL-3.0-or-later
"""`object.gridmesh_from_image`: pictures become sprites or bodies."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import Any

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    StringProperty,
)

from ..api import CancelledError
from ..bodies.strokes import selected
from ..data import defaults
from ..data.placing import Transaction, home
from ..native import NativeError
from ..text.messages import counted, listed
from ..text.telling import told
from ..ui.progress import Pointer
from ..ui.properties import FACES, ShapeOptions
from . import images, placing
from .cutouts import Cutout, cut_out
from .dropping import ENDINGS
from .tracing import Options, PictureError

READ = ";".join(f"*{ending}" for ending in ENDINGS)
_BETWEEN = 0.1
"""Room between files that are placed side by side, relative to their height."""


class OBJECT_OT_gridmesh_from_image(ShapeOptions, bpy.types.Operator):  # noqa: N801
    """Make a sprite or a body of what each picture shows, with the picture on it"""  # noqa: D400 (the tooltip)

    bl_idname = "object.gridmesh_from_image"
    bl_label = "Picture to Mesh"
    bl_options = {"REGISTER", "UNDO", "PRESET"}  # noqa: RUF012

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN", "SKIP_SAVE"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})
    filter_glob: StringProperty(default=READ, options={"HIDDEN", "SKIP_SAVE"})
    cells: EnumProperty(
        name="Faces", description="What the mesh is made of", items=FACES, default=defaults.CELLS
    )
    triangles: IntProperty(
        name="Triangles of Each Side",
        description="Number of triangles of one side of all that the picture shows; thin parts get more",
        default=1000,
        soft_min=50,
        soft_max=100_000,
    )
    quads: IntProperty(
        name="Quads of Each Side",
        description="Number of quads of one side of all that the picture shows; thin parts get more",
        default=500,
        soft_min=50,
        soft_max=100_000,
    )
    background: EnumProperty(
        name="Background",
        description="What of the picture is left out",
        items=[
            ("AUTO", "Automatic", "What is transparent; paper where nothing is"),
            ("TRANSPARENT", "Transparent", "What is transparent"),
            (
                "PAPER",
                "Paper",
                "The paper of a scan or photograph, also under uneven light; a dark board around what is bright",
            ),
        ],
        default="AUTO",
    )
    use_threshold: BoolProperty(
        name="Give a Threshold",
        description="Give the threshold, instead of the one that parts the pixels best on paper, and elsewhere 0.5, or less for glows and shadows of flat sheets",
        default=False,
    )
    threshold: FloatProperty(
        name="Threshold",
        description="How far a pixel must be covered to lie inside the outline",
        subtype="FACTOR",
        default=0.5,
        min=0.001,
        max=0.999,
    )
    smooth: FloatProperty(
        name="Smoothing",
        description="How far along the outline is looked to remove what pixels put in; 0 keeps it as it is",
        default=1.0,
        min=0.0,
        max=10.0,
    )
    min_area: FloatProperty(
        name="Least Area",
        description="Islands and holes of fewer pixels are left out; set it higher for specks on paper",
        default=4.0,
        min=0.0,
        soft_max=1000.0,
    )
    margin: FloatProperty(
        name="Margin",
        description="How far the outline is moved outward, in pixels; from 1 on the mesh covers pixels whole, but for the finest tips",
        default=1.0,
        min=0.0,
        soft_max=20.0,
        max=1000.0,
    )
    body_margin: FloatProperty(
        name="Margin",
        description="How far the outline is moved outward, in pixels; the margin of a body is opaque",
        default=0.0,
        min=0.0,
        soft_max=20.0,
        max=1000.0,
    )
    use_holes: BoolProperty(
        name="Holes",
        description="Leave holes open; without, closed lines are filled",
        default=True,
    )
    lit: BoolProperty(
        name="Lit",
        description="Let lights and shadows fall on the picture; without, it shines in its own colors",
        default=False,
    )
    hide_source: BoolProperty(
        name="Hide Picture",
        description="Hide the object that shows the picture, which is in the same place",
        default=True,
    )
    result: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def description(cls, _context: bpy.types.Context, _properties: Any) -> str:
        """Say what it does in the user's language."""
        return told("Make a sprite or a body of what each picture shows, with the picture on it", "tooltips")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Ask for Object Mode."""
        if context.mode == "OBJECT":
            return True
        cls.poll_message_set(told("Leave the mode to make meshes of pictures", "tooltips"))
        return False

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Take the selected pictures; with none, ask for files. Of files that were dropped, ask what they are to become."""
        if self._paths():
            return context.window_manager.invoke_props_dialog(self)
        if _chosen(context):
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Read and mesh all pictures, and only then change the scene."""
        started = perf_counter()
        failures: list[str] = []
        made: list[tuple[images.Picture, Options, bool, Cutout]] = []
        try:
            with Transaction() as transaction, Pointer(context) as pointer:
                pictures = self._pictures(context, transaction, failures)
                for at, picture in enumerate(pictures):
                    part = pointer.part(at / len(pictures), (at + 1) / len(pictures))
                    try:
                        values = images.pixels(picture.image)
                        transparent = images.is_transparent(values)
                        options = self._options(transparent)
                        made.append((picture, options, transparent, cut_out(values, options, part)))
                    except PictureError as error:
                        failures.append(f"{picture.label}: {error}")
                if not made:
                    raise PictureError(listed(failures))
                objects = self._place(context, made, transaction)
        except (PictureError, NativeError) as error:
            self.report({"ERROR"}, told(str(error)))
            return {"CANCELLED"}
        except CancelledError:
            self.report({"WARNING"}, told("Cancelled; nothing was made"))
            return {"CANCELLED"}
        _select(context, objects)
        faces = sum(len(cutout.faces) for *_, cutout in made)
        face = "quad" if self.cells == "QUADS" else "triangle"
        parts = sum(cutout.parts for *_, cutout in made)
        self.result = (
            f"{counted(len(made), 'picture')}: {counted(parts, 'part')}, {counted(faces, face)}, "
            f"{1000 * (perf_counter() - started):.0f} ms"
        )
        self.report({"INFO"}, told(self.result))
        for warning in failures + _left_out(made):
            self.report({"WARNING"}, told(warning))
        return {"FINISHED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the redo panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        if self.result:
            layout.label(text=told(self.result, "interface"))
        self.draw_shape_options(layout)
        layout.prop(self, "cells")
        layout.prop(self, self.cells.lower())
        column = layout.column()
        column.prop(self, "background")
        column.prop(self, "use_threshold")
        if self.use_threshold:
            column.prop(self, "threshold")
        column.prop(self, "margin" if self.shape == "SHEET" else "body_margin")
        column.prop(self, "smooth")
        column.prop(self, "min_area")
        column.prop(self, "use_holes")
        column = layout.column()
        column.prop(self, "lit")
        if not self._paths():
            column.prop(self, "hide_source")
        if _is_gray(context):
            column.label(text="See it in Material Preview", icon="INFO")

    corner_angle = placing.CREASE
    """What the profile asks for; the corners of pictures are found in them."""

    def _pictures(
        self, context: bpy.types.Context, transaction: Transaction, failures: list[str]
    ) -> list[images.Picture]:
        if paths := self._paths():
            return _side_by_side(paths, np.array(context.scene.cursor.location), transaction, failures)
        found = []
        for ob in _chosen(context):
            try:
                found.append(images.of_object(ob))
            except PictureError as error:
                failures.append(f"'{ob.name}': {error}")
        if not found and not failures:
            raise PictureError(
                "no picture is selected; select an image empty or an image plane, or give a file"
            )
        return found

    def _paths(self) -> list[str]:
        """Files that are given: several of a folder, or one."""
        names = [element.name for element in self.files if element.name]
        if self.directory and names:
            return [str(Path(bpy.path.abspath(self.directory), name)) for name in names]
        return [self.filepath] if self.filepath else []

    def _options(self, transparent: bool) -> Options:
        paper = self.background == "PAPER" or (self.background == "AUTO" and not transparent)
        body = self.body_options()
        return Options(
            paper=paper,
            threshold=self.threshold if self.use_threshold else None,
            smooth=self.smooth,
            min_area=self.min_area,
            margin=self.margin if body is None else self.body_margin,
            cover=body is not None,
            holes=self.use_holes,
            triangles=self.triangles,
            quads=self.quads if self.cells == "QUADS" else None,
            body=body,
        )

    def _place(
        self,
        context: bpy.types.Context,
        made: list[tuple[images.Picture, Options, bool, Cutout]],
        transaction: Transaction,
    ) -> list[bpy.types.Object]:
        into = home(context, transaction)
        objects = []
        for picture, options, transparent, cutout in made:
            material = placing.material_of(
                picture.image,
                lit=self.lit,
                transparent=transparent and not options.paper and options.body is None,
                transaction=transaction,
            )
            objects.append(placing.make(picture, cutout, options, material, into, transaction))
        if self.hide_source:
            for picture, *_ in made:
                if picture.source is not None:
                    picture.source.hide_set(True)
        return objects


def _side_by_side(
    paths: list[str], at: np.ndarray, transaction: Transaction, failures: list[str]
) -> list[images.Picture]:
    """Pictures of files, one beside the other, the first at a point."""
    found: list[images.Picture] = []
    for path in paths:
        try:
            picture = images.of_file(_loaded(path, transaction), at)
        except PictureError as error:
            if len(paths) == 1:
                raise
            failures.append(f"'{Path(path).name}': {error}")
            continue
        if found:
            width = picture.matrix[0, 0]
            at = at + [width / 2, 0, 0]
            picture = images.of_file(picture.image, at)
        found.append(picture)
        at = at + [picture.matrix[0, 0] / 2 + _BETWEEN, 0, 0]
    return found


def _loaded(path: str, transaction: Transaction) -> bpy.types.Image:
    """Return the picture of a file, loaded or there already."""
    try:
        known = set(bpy.data.images)
        image = bpy.data.images.load(bpy.path.abspath(path), check_existing=True)
    except RuntimeError as error:
        raise PictureError(f"'{Path(path).name}' cannot be read; save it as PNG, JPEG or WebP") from error
    if image not in known:
        transaction.remember(bpy.data.images, image)
    return image


def _chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    return [ob for ob in selected(context) if images.shows_picture(ob) and not placing.made_from_picture(ob)]


def _is_gray(context: bpy.types.Context) -> bool:
    """Tell whether the view shows no pictures on faces."""
    shading = getattr(context.space_data, "shading", None)
    return shading is not None and (
        shading.type == "WIREFRAME" or (shading.type == "SOLID" and shading.color_type != "TEXTURE")
    )


def _select(context: bpy.types.Context, objects: list[bpy.types.Object]) -> None:
    for ob in selected(context):
        ob.select_set(False)
    for ob in objects:
        ob.select_set(True)
    context.view_layer.objects.active = objects[0]


def _left_out(made: list[tuple[images.Picture, Options, bool, Cutout]]) -> list[str]:
    """Tell what of the pictures is missing, and why a mesh has more faces than were asked for."""
    told_of = []
    for picture, *_, cutout in made:
        told_of += [f"{picture.label}: a part is left out: {reason}" for reason in cutout.refused[:3]]
        if cutout.finer:
            told_of.append(f"{picture.label}: more faces than the {cutout.asked} asked for; {cutout.finer}")
        if cutout.widened:
            told_of.append(
                f"{picture.label}: lines are too thin for a mesh; all is {cutout.widened:g} px wider to each side"
            )
        if cutout.dropped:
            told_of.append(
                f"{picture.label}: {counted(cutout.dropped, 'island')} left out, smaller than Least Area"
            )
    return told_of


classes = (OBJECT_OT_gridmesh_from_image,)
