"""Random batches, good and hostile, in short; by hand they are run at length (see tests/campaign/batch.py)."""

import os
import sys

import pytest
from batches import ROOT

sys.path.insert(0, str(ROOT / "tests" / "campaign"))

if os.name != "posix":
    pytest.skip("named pipes and signals", allow_module_level=True)

import batch


def test_hostile_items_stop_no_good_one(tmp_path):
    made, lines, _ = batch.mixed(tmp_path / "mixed", items=40, hostile=26, seed=7)
    assert sum(item.what.startswith("good") for item in made) == 14
    assert len(lines) == 40


@pytest.mark.process
def test_killed_doubled_and_without_room_the_outputs_are_the_same(tmp_path):
    counts = batch.disturbed(tmp_path / "disturbed", items=10, kills=3, seed=7)
    assert counts["kills"] == 3
    assert counts["lines of two runs"] >= 10


def test_every_kind_of_hostile_item_can_be_made(tmp_path):
    maker = batch.Maker(tmp_path / "made", 3)
    for name in dir(maker):
        if name.startswith("bad_"):
            for _ in range(12):
                job, statuses = getattr(maker, name)()
                assert {"id", "op", "in", "out"} <= job.keys()
                assert statuses
