# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: thin, so that all work can be called without them."""
