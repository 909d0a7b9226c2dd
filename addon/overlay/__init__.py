# SPDX-License-Identifier: GPL-3.0-or-later
"""What a mesh is like: numbers for scripts (`quality`), dots in the viewport (`viewport`), `mesh.gridmesh_quality`."""
