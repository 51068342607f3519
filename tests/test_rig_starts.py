"""Where a fit of a rig begins, held against a person and cameras that are known."""

import math

import numpy as np
import pytest

from calibration.person.rig_evidence import ClipEvidence, Evidence
from calibration.person.rig_starts import (
    FOCAL_SHARE,
    MIDDLE_SHARE,
    YAWS_DEG,
    known_of,
    level_starts,
)
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import JointTrack
from calibration.tracks.rig_guess import BODY, LATE, PLACE, pinholes

SIZE = (320, 240)
STATURE_M = 1.8


def test_a_stated_view_is_believed_ten_times_as_much_as_any() -> None:
    """A lens of 90 degrees has half a picture's width as its focal length."""
    usual, stated = known_of(320, STATURE_M, 1), known_of(320, STATURE_M, 3, 90.0)
    for n in ("1", "2"):
        at = PLACE[f"log_focal_{n}"]
        assert math.exp(usual.mean[at]) == pytest.approx(FOCAL_SHARE * 320)
        assert math.exp(stated.mean[at]) == pytest.approx(160.0)
        assert (usual.sigma[at], stated.sigma[at]) == (0.3, 0.02)
        assert (usual.mean[PLACE[f"height_{n}"]], usual.sigma[PLACE[f"height_{n}"]]) == (1.2, 0.6)
        assert usual.sigma[PLACE[f"pitch_{n}"]] == pytest.approx(math.radians(6.0))
        assert usual.sigma[PLACE[f"roll_{n}"]] == pytest.approx(math.radians(2.5))
        assert usual.soft[PLACE[f"pitch_{n}"]]
        assert not usual.soft[at]
    for name in ("yaw_2", "x_2", "z_2"):
        assert usual.sigma[PLACE[name]] == np.inf
    assert (len(usual.mean), len(stated.mean)) == (LATE + 1, LATE + 3)
    assert stated.sigma[LATE:].tolist() == [0.1] * 3
    assert stated.soft[LATE:].all()
    assert np.exp(usual.mean[BODY]) == pytest.approx(prior.SHARES * STATURE_M)
    assert (usual.stature_m, usual.stature_error) == (STATURE_M, 0.01)


def seen_at(column: float, row: float, times_s: np.ndarray) -> JointTrack:
    """A person whose trunk's middle is there in every frame."""
    joints = np.zeros((len(times_s), 15, 2))
    joints[:, prior.PELVIS], joints[:, prior.NECK] = (column, row + 20), (column, row - 20)
    sure, facing = np.full((len(times_s), 15), 0.9), np.zeros(len(times_s))
    return JointTrack(times_s, joints, sure, facing, facing)


def test_a_start_of_every_yaw_sees_the_person_where_both_views_do() -> None:
    """176 px high at a focal length of 352 px: 3.6 m away, in view 2 as far again."""
    known, times_s = known_of(320, STATURE_M, 1), np.arange(6) / 15
    first, second = seen_at(195.2, 84.8, times_s), seen_at(160.0, 120.0, times_s)
    evidence = Evidence((ClipEvidence(first, second, (176.0, 88.0)),), SIZE, known, 5.0)
    starts = level_starts(evidence, np.array([0.05]))
    assert [math.degrees(start[PLACE["yaw_2"]]) for start in starts] == pytest.approx(YAWS_DEG)
    assert len(starts) == 12
    for start in starts:
        one, other = pinholes(start)
        person_m = one.centre_m + np.array([0.36, 0.36, -3.6])
        assert person_m[1] == pytest.approx(MIDDLE_SHARE * STATURE_M)
        assert other.R @ (person_m - other.centre_m) == pytest.approx([0.0, 0.0, 7.2])
        assert start[LATE] == 0.05
        for name in ("pitch_1", "roll_1", "pitch_2", "roll_2"):
            assert start[PLACE[name]] == 0.0
