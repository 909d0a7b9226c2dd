"""Run the add-on from the source tree in the bpy module: every test starts from an empty factory scene."""

import importlib.util
import os
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

if importlib.util.find_spec("bpy") is None:
    collect_ignore_glob = ["test_*.py"]
else:
    # Before bpy is imported: it must not see this user's settings.
    os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="gridmesh-blender-")
    sys.path.insert(0, str(ROOT))
    import bpy

    import addon
    from addon.live import engine

    _status = 0

    def pytest_sessionstart(session):
        addon.register()

    def pytest_sessionfinish(session, exitstatus):
        global _status
        _status = int(exitstatus)

    @pytest.hookimpl(trylast=True)
    def pytest_unconfigure(config):
        """Blender 4.5 can crash or hang in its own clean-up at exit, after all tests have been reported."""
        addon.unregister()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_status)

    @pytest.fixture(autouse=True)
    def scene():
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        return bpy.context.scene

    @pytest.fixture
    def awake(monkeypatch):
        """Live bodies follow, though this is in the background, and nothing is known of others."""
        monkeypatch.setattr(engine, "in_background", True)
        engine._states.clear()
        yield
        engine._states.clear()


def pytest_configure(config):
    config.addinivalue_line("markers", "smoke: the few tests that every supported Blender runs")
    words = "process: of processes, signals and limits around Blender, the same for all; run with one of them"
    config.addinivalue_line("markers", words)
