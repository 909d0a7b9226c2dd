# SPDX-License-Identifier: GPL-3.0-or-later
"""Sprites as files of other programs: glTF, Spine, Godot. numpy only, no bpy."""
