# SPDX-License-Identifier: GPL-3.0-or-later
"""`mesh.gridmesh_regrid`: areas of the mesh being edited become grid patches on the old surface.

regionmesh (from Blender) -> api (no bpy) -> regionmesh, carried (to Blender); regridding is what operators call.
"""
