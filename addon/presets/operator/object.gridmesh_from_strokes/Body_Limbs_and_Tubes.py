# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

op = bpy.context.active_operator
op.shape = "BODY"
op.profile = "EVEN"
op.use_sides = False
op.depth = 1.0
op.cells = "TRIANGLES"
op.resolution = "AUTO"
op.mirror = "OFF"
