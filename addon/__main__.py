# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m addon`: the command line, from a checkout with the `bpy` module."""

import sys

from .cli.arguments import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
