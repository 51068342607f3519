"""A flood of large messages on the bus of a live run: real processes over a real Zenoh session."""

import json
from pathlib import Path

import pytest
from flood import FLOODS, Flood, flooded
from spoiling import copied, refilmed

pytestmark = pytest.mark.slow

LEAST_FLOODED = 50
"""Messages that a flood of several seconds has at least: 100 MB."""
BY_NAME = {flood.name: flood for flood in FLOODS}


@pytest.fixture
def slow_clip(clip: Path, tmp_path: Path) -> Path:
    """How it begins, at a third of its rate, so that a busy machine keeps up."""
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film[:45])
    meta = json.loads((folder / "meta.json").read_text())
    (folder / "meta.json").write_text(json.dumps({**meta, "fps": 5}))
    return folder


@pytest.mark.parametrize(
    ("flood", "counted"),
    [
        (BY_NAME["2 MB on the reports' key"], ""),
        (BY_NAME["1 MB there, taken in by Zenoh"], "foreign"),
        (BY_NAME["the same with the run's word"], "malformed"),
    ],
    ids=["larger than any of ours", "of a stranger", "of one who knows the run's word"],
)
def test_a_flood_loses_no_report_and_is_counted_under_its_cause(
    slow_clip: Path, tmp_path: Path, flood: Flood, counted: str
) -> None:
    """Zenoh refuses what is larger than any message of ours as it comes: nobody counts it.

    What has no pose was skipped by a viewer or came late, as a busy machine makes them.
    """
    got = flooded(slow_clip, tmp_path / "out", flood)
    assert got.flooded > LEAST_FLOODED
    causes = {"foreign": got.foreign, "malformed": got.malformed}
    assert {cause for cause, number in causes.items() if number} == ({counted} - {""})
    assert sum(causes.values()) <= got.flooded
    assert got.said > 0
    assert got.lost == 0
    assert got.missing <= got.skipped + got.late
