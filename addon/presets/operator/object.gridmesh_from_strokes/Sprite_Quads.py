# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

op = bpy.context.active_operator
op.shape = "SHEET"
op.cells = "QUADS"
op.resolution = "TRIANGLES"
op.quads = 500
op.mirror = "OFF"
