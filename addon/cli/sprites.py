# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures to sprites: decoded and meshed without Blender, which is asked for .blend files and renderings alone."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..data import defaults
from ..data.placing import Transaction
from ..native import native
from ..pictures import images, placing
from ..pictures.cutouts import Cutout, cut_out
from ..pictures.formats import gltf, godot, rig, spine
from ..pictures.formats.sheet import Sheet
from ..pictures.tracing import Options
from ..text.messages import counted
from . import files, loading, outputs, params
from .making import MakeError

_OPAQUE = 252
"""Pixels with less alpha are seen through."""


class MadeSprite:
    """The mesh of a picture; objects in Blender when they are asked for."""

    def __init__(self, source: Path, sheet: Sheet, options: Options, unit: float) -> None:
        self.source, self.sheet, self.options, self.unit = source, sheet, options, unit
        cutout = sheet.cutout
        self.numbers = {
            "parts": cutout.parts,
            "triangles": len(cutout.faces),
            "min_angle": _least_angle(cutout),
        }
        self.notes = [f"a part is left out: {reason}" for reason in cutout.refused]
        if cutout.finer:
            self.notes.append(f"more faces than the {cutout.asked} asked for; {cutout.finer}")
        if cutout.widened:
            self.notes.append(
                f"lines are too thin for a mesh; all is {cutout.widened:g} px wider to each side"
            )
        if cutout.dropped:
            self.notes.append(f"{counted(cutout.dropped, 'island')} left out, smaller than min_area")

    @cached_property
    def objects(self) -> list[bpy.types.Object]:
        """The sprite as an object of the scene, upright in the plane y = 0."""
        sheet = self.sheet
        image = bpy.data.images.load(str(self.source))
        image.name = sheet.name
        width, height = sheet.width, sheet.height
        if tuple(image.size) != (width, height):
            raise MakeError("load", f"Blender reads {image.size[0]} by {image.size[1]} pixels of it")
        image.pack()
        matrix = np.eye(4)
        matrix[:3, 0], matrix[:3, 1] = [width / self.unit, 0, 0], [0, 0, height / self.unit]
        matrix[:3, 2], matrix[:3, 3] = [0, -1, 0], [-width / self.unit / 2, 0, 0]
        with Transaction() as transaction:
            material = placing.material_of(
                image, lit=not sheet.flat, transparent=sheet.transparent, transaction=transaction
            )
            picture = images.Picture(image, matrix, None)
            made = placing.make(
                picture, sheet.cutout, self.options, material, bpy.context.scene.collection, transaction
            )
        bpy.context.view_layer.update()
        return [made]

    def write(self, out: Path, beside: Path | None) -> None:
        """Write the sprite, and the picture beside it if the format only names it."""
        if beside is not None and not self.sheet.flat:
            raise MakeError(
                "params", f"{out.suffix} files are for flat sheets; write bodies to .glb, .gltf or .blend"
            )
        if beside is not None:
            _copy(self.source, self.sheet.picture, beside)
        suffix = out.suffix.lower()
        if suffix == ".blend":
            outputs.write(out, self.objects)
        elif suffix == ".json":
            outputs.safely(out, lambda path: spine.write(path, self.sheet, beside.stem))
        elif suffix == ".tscn":
            outputs.safely(out, lambda path: godot.write(path, self.sheet, beside.name))
        else:
            outputs.safely(out, lambda path: gltf.write(path, self.sheet, self.unit))

    def tidy(self, _source: Path) -> None:
        """Empty the session if anything was put into it."""
        if "objects" in vars(self):
            loading.clear()


def sprites(source: Path, _pattern: str | None, options: dict[str, Any], *, scripts: bool) -> MadeSprite:
    """Make a mesh of what a picture shows."""
    data = files.read_bytes(source)
    pixels = native("decode_image").decode_image(data)
    seen_through = bool((pixels[..., 3] < _OPAQUE).any())
    background = options.get("background", "auto")
    paper = background == "paper" or (background == "auto" and not seen_through)
    flat = options.get("shape", "flat") == "flat"
    if flat and (given := sorted(params.BODY.keys() & options.keys())):
        raise MakeError("params", f"{given[0]} is for bodies; add shape body")
    body = {
        "corner_angle": defaults.CORNER_ANGLE,
        **{key: value for key, value in options.items() if key in params.BODY},
    }
    chosen = Options(
        paper=paper,
        threshold=options.get("threshold"),
        smooth=options.get("smooth", 1.0),
        min_area=options.get("min_area", 16.0 if paper else 4.0),
        margin=options.get("margin", 1.0 if flat else 0.0),
        cover=not flat,
        holes=options.get("holes", True),
        triangles=options.get("triangles", params.SPRITE_TRIANGLES),
        body=None if flat else body,
    )
    cutout = cut_out(pixels, chosen)
    height, width = pixels.shape[:2]
    name = source.stem.encode("utf-8", "replace").decode()  # of a file, which may be no text
    ending = source.suffix.lower()
    transparent = seen_through and not paper and flat
    sheet = Sheet(name, cutout, width, height, data, _ending_of(data, ending), transparent, flat)
    if "bones" in options and flat:
        sheet = replace(sheet, rig=_rig(Path(options["bones"]), sheet))
    return MadeSprite(source, sheet, chosen, options.get("unit", params.SPRITE_UNIT))


def _rig(path: Path, sheet: Sheet) -> rig.Rig:
    try:
        bones = rig.read(files.read_bytes(path), sheet.width, sheet.height)
        return rig.weighed(sheet.cutout, sheet.points, bones)
    except rig.RigError as error:
        raise MakeError("bones", f"bones of '{path.name}': {error}") from error


def _ending_of(data: bytes, ending: str) -> str:
    """Ending that suits what is in a picture's file, whose name may say something else."""
    if data[:4] == b"\x89PNG":
        return ".png"
    if data[:2] == b"\xff\xd8":
        return ".jpg"
    return ".webp" if data[:4] == b"RIFF" else ending


def _copy(source: Path, picture: bytes, beside: Path) -> None:
    """Put the picture beside the output, unless it is there already."""
    if beside.exists() and beside.samefile(source):
        return
    outputs.safely(beside, lambda path: path.write_bytes(picture) and None)


def _least_angle(cutout: Cutout) -> float:
    corners = cutout.vertices[cutout.faces]
    least = np.inf
    for k in range(3):
        a, b = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        angles = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
        least = min(least, float(angles.min()))
    return least


OPS = {"sprites": sprites}
