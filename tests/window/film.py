"""Pictures of a window to a film, by Blender itself: blender --background --python film.py -- FRAMES FILM.webm"""

import sys
from pathlib import Path

import bpy

SECOND = 8
"""Frames of the film in one of its seconds."""
LAST = 2 * SECOND
"""Frames for which the last picture stays."""
EMPTY = 0.1
"""A file with this share of the largest one's bytes shows no window yet."""


def different(frames):
    """Pictures of the window that are not the same as the one before."""
    most = max(frame.stat().st_size for frame in frames)
    before = None
    for frame in frames:
        data = frame.read_bytes()
        if data != before and len(data) > EMPTY * most:
            yield frame
        before = data


def main(folder, film):
    pictures = list(different(sorted(folder.glob("*.png"))))
    scene = bpy.context.scene
    width, height = bpy.data.images.load(str(pictures[0])).size
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.fps = SECOND
    scene.view_settings.view_transform = "Standard"
    strips = scene.sequence_editor_create().strips
    strip = strips.new_image("Window", str(pictures[0]), channel=1, frame_start=1)
    for picture in pictures[1:]:
        strip.elements.append(picture.name)
    strip.frame_final_duration = len(pictures) + LAST
    scene.frame_end = len(pictures) + LAST
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "VIDEO"  # from Blender 5.0 on
    settings.file_format = "FFMPEG"
    coding = scene.render.ffmpeg
    coding.format, coding.codec = "WEBM", "WEBM"
    coding.constant_rate_factor = "LOW"
    coding.gopsize = 60
    scene.render.use_file_extension = False
    scene.render.filepath = str(film)
    bpy.ops.render.render(animation=True)
    print(f"{len(pictures)} pictures, {film.stat().st_size / 1e6:.1f} MB")


main(*map(Path, sys.argv[sys.argv.index("--") + 1 :]))
