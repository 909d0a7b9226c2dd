# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's data read and written: meshes, attributes, places, what was written by whom."""
