# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures to sprites and bodies: images (from Blender) -> cutouts (numpy only) -> operator, materials (to Blender)."""
