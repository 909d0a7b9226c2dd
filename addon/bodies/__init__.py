# SPDX-License-Identifier: GPL-3.0-or-later
"""From drawn strokes to bodies: reading, outlines, the operator."""
