# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

op = bpy.context.active_operator
op.shape = "BODY"
op.profile = "FLAT"
op.use_sides = False
op.depth = 0.5
op.cells = "TRIANGLES"
op.resolution = "AUTO"
op.mirror = "OFF"
