# SPDX-License-Identifier: GPL-3.0-or-later
"""Two loops joined by a tube, or more by one patch."""
