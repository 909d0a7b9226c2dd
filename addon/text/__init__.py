# SPDX-License-Identifier: GPL-3.0-or-later
"""Words: translations, messages, reports."""
