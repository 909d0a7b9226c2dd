"""One version everywhere: Cargo.toml has it, the rest must follow; and what the manifest must keep."""

import re
import tomllib
from pathlib import Path

import gridmesh
import pytest

from addon import api

ROOT = Path(__file__).parents[2]
CARGO = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]

# Those that Blender's platform knows for add-ons.
TAGS = {
    *("3D View", "Add Curve", "Add Mesh", "Animation", "Bake", "Camera", "Compositing", "Development"),
    *("Game Engine", "Geometry Nodes", "Grease Pencil", "Import-Export", "Lighting", "Material", "Mesh"),
    *("Modeling", "Node", "Object", "Paint", "Physics", "Pipeline", "Render", "Rigging", "Scene", "Sculpt"),
    *("Sequencer", "System", "Text Editor", "Tracking", "User Interface", "UV"),
}


@pytest.mark.parametrize("version", [api.MANIFEST["version"], api.NATIVE_VERSION, gridmesh.__version__])
def test_version_is_that_of_cargo(version):
    assert version == CARGO


def test_manifest_keeps_what_no_validator_looks_at():
    """Rules of the platform that are found out about only when an extension is uploaded."""
    manifest = api.MANIFEST
    assert "blender" not in manifest["name"].lower()
    assert len(manifest["tagline"]) <= 64
    assert manifest["tagline"][-1].isalnum()
    assert set(manifest["tags"]) <= TAGS
    assert manifest["blender_version_min"] == "4.5.0"
    assert "blender_version_max" not in manifest
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert all(re.fullmatch(r"\d{4} .+", line) for line in manifest["copyright"])
    assert manifest["maintainer"].strip()
    for wheel in manifest.get("wheels", []):
        assert (ROOT / "addon" / wheel).is_file(), f"{wheel} is listed but not there"
