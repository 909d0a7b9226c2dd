# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

op = bpy.context.active_operator
op.shape = "SHEET"
op.cells = "TRIANGLES"
op.resolution = "TRIANGLES"
op.triangles = 200
op.mirror = "OFF"
