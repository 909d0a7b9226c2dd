# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh cut along a stroke, its pieces written back."""
