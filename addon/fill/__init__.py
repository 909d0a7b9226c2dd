# SPDX-License-Identifier: GPL-3.0-or-later
"""Holes of a mesh found and filled."""
