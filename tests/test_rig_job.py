"""What the process that finds rigs answers: rows come back as packed, and each part is told."""

from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from staging import RIG

from calibration.gate import moved_place, rig_trust
from calibration.person import person_calibration
from calibration.tracks.joint_tracks import JOINTS, Row
from common.rig.camera import paper_rig
from common.rig.rig_file import CalibrationError
from integrator.live_rig.rig_job import (
    TOO_LITTLE,
    Job,
    Solved,
    Stand,
    Unsolved,
    packed,
    solved,
    track_of_bytes,
)

FOUND = paper_rig((160, 120), (210.0, 190.0), (3.0, 5.0))


def row(time_s: float) -> Row:
    """Numbers that are all different."""
    joints_px = time_s + np.arange(2.0 * JOINTS).reshape(JOINTS, 2)
    sure = np.asarray(time_s + 0.01 * np.arange(JOINTS), np.float64)
    return (time_s, joints_px, sure, time_s + 0.5, time_s + 0.7)


def rows(*times_s: float) -> bytes:
    return b"".join(packed(row(time_s)) for time_s in times_s)


JOB = Job((160, 120), 1.7, 1 / 15, (rows(1.0, 2.0), rows(11.0)))


def test_rows_come_back_as_they_were_packed() -> None:
    track = track_of_bytes(rows(1.0, 2.0))
    for i, time_s in enumerate((1.0, 2.0)):
        time, joints_px, confidence, facing_deg, facing_confidence = row(time_s)
        assert track.times_s[i] == time
        assert track.joints_px[i] == pytest.approx(joints_px)
        assert track.confidence[i] == pytest.approx(confidence)
        assert track.facing_deg[i] == facing_deg
        assert track.facing_confidence[i] == facing_confidence


class Asked:
    """What those who calibrate, place and judge were asked; what they answer."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.calls: list[tuple[Any, ...]] = []
        self.placed: Any = SimpleNamespace(rig=FOUND, gap_mm=7.0, turn_error_deg=3.0)
        self.refusal = ""
        monkeypatch.setattr(person_calibration, "calibrated_by_person", self.calibrated)
        monkeypatch.setattr(moved_place, "placed", self.place)
        monkeypatch.setattr(rig_trust, "trust_of", self.trust)

    def calibrated(self, sightings: Any, stature_m: float) -> Any:
        self.calls.append((sightings, stature_m))
        if self.refusal:
            raise CalibrationError(self.refusal)
        cameras = [SimpleNamespace(turn_error_deg=(1.0,)), SimpleNamespace(turn_error_deg=(2.0,))]
        quality = SimpleNamespace(gap_mm=5.0, cameras=cameras)
        return SimpleNamespace(rig=FOUND, late_s=(0.2,), quality=quality)

    def place(self, *given: Any) -> Any:
        self.calls.append(given)
        return self.placed

    def trust(self, rig: Any, sighting: Any, period_s: float) -> Any:
        assert sighting.size_px == (160, 120)
        assert period_s == 1 / 15
        return SimpleNamespace(apart_mm=20.0 if rig == FOUND else 40.0, odd=("far",))


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Asked:
    return Asked(monkeypatch)


@pytest.mark.parametrize("before", [None, RIG], ids=["assumed", "in use"])
def test_a_rig_is_found_by_the_person_and_judged_beside_that_in_use(
    asked: Asked, before: Any
) -> None:
    found = solved(msgspec.structs.replace(JOB, rig=before))
    assert isinstance(found, Solved)
    ((((sighting,), stature_m)),) = asked.calls
    assert stature_m == 1.7
    assert sighting.first.times_s.tolist() == [1.0, 2.0]
    assert sighting.second.times_s.tolist() == [11.0]
    assert (found.rig, found.late_s, found.gap_mm, found.turn_error_deg) == (FOUND, 0.2, 5.0, 2.0)
    assert found.trust.apart_mm == 20.0
    assert found.trust.odd == ("far",)
    assert (found.before is None) == (before is None)
    if found.before is not None:
        assert found.before.apart_mm == 40.0


def test_what_cannot_be_found_is_refused_in_words(asked: Asked) -> None:
    asked.refusal = "nobody walked"
    assert solved(JOB) == Unsolved("nobody walked")
    asked.placed = None
    assert solved(msgspec.structs.replace(JOB, rig=RIG, moved=(2,))) == TOO_LITTLE


@pytest.mark.parametrize("moved", [(), (2,)], ids=["found", "placed"])
def test_a_rig_that_too_little_is_seen_of_to_be_judged_is_none(
    asked: Asked, monkeypatch: pytest.MonkeyPatch, moved: Any
) -> None:
    monkeypatch.setattr(rig_trust, "trust_of", lambda *_: None)
    assert solved(msgspec.structs.replace(JOB, rig=RIG, moved=moved)) == TOO_LITTLE


@pytest.mark.parametrize("stood", [False, True])
def test_a_camera_that_was_moved_is_placed_by_what_was_seen_before_and_since(
    asked: Asked, stood: bool
) -> None:
    stand = Stand(FOUND, (rows(3.0), rows(4.0, 5.0))) if stood else None
    found = solved(msgspec.structs.replace(JOB, rig=RIG, moved=(2,), late_s=0.1, stood=stand))
    assert isinstance(found, Solved)
    ((rig, sighting, moved, late_s, before),) = asked.calls
    assert (rig, moved, late_s) == (RIG, (2,), 0.1)
    assert sighting.first.times_s.tolist() == [1.0, 2.0]
    assert (before is not None) == stood
    if stood:
        assert before.rig == FOUND
        assert before.sighting.first.times_s.tolist() == [3.0]
        assert before.sighting.second.times_s.tolist() == [4.0, 5.0]
        assert before.sighting.size_px == (160, 120)
    assert (found.rig, found.late_s, found.gap_mm, found.turn_error_deg) == (FOUND, 0.1, 7.0, 3.0)
    assert found.before is not None
    assert (found.trust.apart_mm, found.before.apart_mm) == (20.0, 40.0)


def test_cameras_of_an_assumed_rig_that_were_moved_are_found_anew(asked: Asked) -> None:
    found = solved(msgspec.structs.replace(JOB, moved=(1,)))
    assert isinstance(found, Solved)
    assert found.gap_mm == 5.0
