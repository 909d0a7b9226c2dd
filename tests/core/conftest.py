"""The extension's modules that need no Blender are tested here too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))
