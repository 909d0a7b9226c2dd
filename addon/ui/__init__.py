# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen around the tools: panels, keys, presets, properties, progress."""
