"""Live runs of three cameras: they equal offline ones, and the loss of any camera is a smaller
number of views."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest
from test_launch import RATE_HZ, assert_equals_offline, live_in_time, settings_of
from test_system_live_fallback import Run, Witness, harmed_run, pid_of, rows, slow

from synth.write import ClipSet, write_set
from tritrack.replaying import replay_run

pytestmark = [pytest.mark.slow, pytest.mark.live]
NAMES = ("cam1", "cam2", "cam3")

__all__ = ["harmed_run"]
"""A fixture, of another file."""


@pytest.fixture(scope="module")
def three(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A made-up clip of three cameras."""
    wanted = ClipSet("postures", seed=90_001, postures=("raise_right_lateral",), cameras=3)
    return write_set(tmp_path_factory.mktemp("three"), wanted, (160, 120))[0]


@pytest.fixture(scope="module")
def slow_three(three: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """At two thirds of its rate."""
    return slow(three, tmp_path_factory.mktemp("slow") / "clip", 0, RATE_HZ)


@pytest.fixture(scope="module")
def long_clip(three: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Minutes; the witness ends the run."""
    return slow(three, tmp_path_factory.mktemp("long") / "clip", 14)


def test_a_live_run_of_three_cameras_equals_an_offline_one(
    slow_three: Path, tmp_path: Path
) -> None:
    """... has a viewer for each, and a recording that replays."""
    facts = live_in_time(settings_of(slow_three), tmp_path / "out", record=True)
    told = facts["processes"]
    assert set(told) == {"integrator", "recognizer", *(f"viewer {n}" for n in (1, 2, 3))}
    assert facts["cameras"] == [*NAMES]
    assert_equals_offline(tmp_path / "out", slow_three)
    found = rows(tmp_path / "out")
    assert found["camera_names"].tolist() == [*NAMES]
    assert found["seen"].all(axis=1).sum() > 50
    again = replay_run(tmp_path / "out", tmp_path / "again")
    assert again["same"] == again["bodies"] == len(found["frame"])


def test_any_camera_that_is_lost_is_a_smaller_number_of_views_until_it_is_back(
    harmed_run: Run, tmp_path: Path
) -> None:
    """Of three first one viewer is killed, then two at once."""

    def harm(witness: Witness) -> None:
        witness.until_views("1+2+3", 8)
        witness.lost_at = witness.bodies[-1].frame
        os.kill(pid_of("viewer 1"), signal.SIGKILL)
        witness.until_views("2+3")
        witness.until_said("view 1 is lost (it was killed, or its link is cut); views 2, 3 go on")
        witness.until_views("1+2+3")
        witness.until_said("view 1 is back")
        for name in ("viewer 2", "viewer 3"):
            os.kill(pid_of(name), signal.SIGKILL)
        witness.until_views("1")
        witness.until_said("view 1 goes on alone")
        witness.until_views("1+2+3")

    facts, witness = harmed_run(harm)
    for name in ("viewer 1", "viewer 2", "viewer 3"):
        again = f"{name}: killed by signal 9; it is started again"
        assert any(again in told for told in facts["warnings"])
    found = rows(tmp_path)
    since = found["frame"] >= witness.lost_at
    assert np.isfinite(found["joints_m"][since]).all(), "a pose is missing"
    assert "measuring" not in found["status"][since], "measured again"
