"""The manifest by Blender's own rules: the validator that builds and installs extensions."""

import subprocess
import sys
from pathlib import Path

import bpy
import pytest
from conftest import ROOT


def validator():
    return Path(bpy.utils.resource_path("LOCAL")) / "scripts/addons_core/bl_pkg/cli/blender_ext.py"


@pytest.mark.smoke
def test_blender_finds_the_manifest_valid():
    command = [sys.executable, validator(), "validate", ROOT / "addon"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_blender_builds_the_extension(tmp_path):
    command = [sys.executable, validator(), "build", "--source-dir", ROOT / "addon", "--output-dir", tmp_path]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    (package,) = tmp_path.glob("gridmesh-*.zip")
    command = [sys.executable, validator(), "validate", package]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
