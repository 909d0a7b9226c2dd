"""One version everywhere: Cargo.toml has it, the rest must follow."""

import tomllib
from pathlib import Path

import gridmesh
import pytest

from addon import api

ROOT = Path(__file__).parents[2]
CARGO = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]


@pytest.mark.parametrize("version", [api.MANIFEST["version"], api.NATIVE_VERSION, gridmesh.__version__])
def test_version_is_that_of_cargo(version):
    assert version == CARGO
