# SPDX-License-Identifier: GPL-3.0-or-later
"""What options are unless they are set: for operators, live bodies and the command line alike. No bpy."""

from math import radians

CELLS = "TRIANGLES"
"""What bodies are made of."""
TRIANGLES = 2000
"""Of each side of a body."""
QUADS = 1000
"""The same of quads: about as many vertices."""
CORNER_ANGLE = radians(40.0)
"""Turns sharper than this are corners."""
BEND = 1.0
"""How far the lattice may bend with the outline."""
DETAIL = 0.0
"""How much smaller faces are in thin parts: about as large as others, so that the ends of limbs look round."""
CLOSE_GAPS = 0.2
"""Largest gap between the ends of a drawn outline that is closed, relative to the stroke."""
CUT_CLOSE_GAPS = 0.1
"""The same of a stroke to cut along, which is more often meant to be open."""
MAX_HOLE_EDGES = 100
"""Where all holes of a mesh are filled, those with more edges are left open."""
MAX_OPEN_EDGES = 200_000
"""The command line refuses meshes with more open edges: they are not surfaces with holes."""
BLEND = 2.0
"""Edge lengths to each side of a joint that become a smooth transition."""
LAYER_DEPTH = 0.7
"""How far bodies of a layer stand out of those of the layers below, relative to half their thickness."""
