# SPDX-License-Identifier: GPL-3.0-or-later
"""Several closed meshes joined to one."""
