"""The extension's modules that need no Blender are tested here too."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))


def pytest_configure(config):
    config.addinivalue_line(
        "markers",
        "native: of the native module alone, which is the same file in every Python; run in one of them",
    )
