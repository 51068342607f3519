"""What films without a truth tell of runs: figures of bodies whose motion is worked by hand."""

import numpy as np
import pytest
from film_quality import TWELVE, Course, jitter, spread, statures, steps

from common.body.body import JOINT_NAMES, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp

STANDING = np.asarray(joints(body_vector(thesis_bdp(1.75)), rest_pose()))
AT = [JOINT_NAMES.index(name) for name in TWELVE]
N = 121


def course(moved: np.ndarray | float = 0.0, frame: np.ndarray | None = None) -> Course:
    """Somebody whose joints are moved by (n, 12, 3) or (n, 1, 1) metres."""
    places = np.repeat(STANDING[None, AT], N, axis=0) + moved
    return Course(np.arange(N) if frame is None else frame, places)


def test_the_stature_is_that_of_the_body_whoever_bends() -> None:
    assert statures(course().places) == pytest.approx(np.full(N, 1.75), rel=0.1)
    bent = course().places
    bent[60:63, [TWELVE.index("l_ankle"), TWELVE.index("r_ankle")], 1] = STANDING[0, 1]
    assert statures(bent) == pytest.approx(statures(course().places))


def test_an_even_motion_has_no_jitter_and_a_shake_has_its_own() -> None:
    """A shake of a to and fro has the second difference 4 a."""
    ramp = 0.1 * np.arange(N)[:, None, None]
    assert jitter(course(ramp)) == pytest.approx(0.0, abs=1e-9)
    shake = ramp + np.array([0.02, 0.0, 0.0]) * (-1.0) ** np.arange(N)[:, None, None]
    tall_m = statures(course().places)[0]
    assert jitter(course(shake)) == pytest.approx(100 * 4 * 0.02 / tall_m, rel=1e-6)


def test_a_gap_is_no_jitter() -> None:
    """Neither of frames that are missing nor of frames without a pose."""
    jump = np.where(np.arange(N) < 60, 0.0, 1.0)[:, None, None]
    frame = np.arange(N) + 5 * (np.arange(N) >= 60)
    assert jitter(course(jump, frame)) == pytest.approx(0.0, abs=1e-9)
    unseen = course(jump)
    unseen.places[58:62] = np.nan
    assert jitter(unseen) == pytest.approx(0.0, abs=1e-9)
    assert np.isnan(jitter(course(np.full((N, 1, 1), np.nan))))


def walking(swing_m: float = 0.3, changed: bool = False) -> Course:
    """Six steps sideways through a picture, or with both legs' names changed in every other."""
    phase = np.linspace(0.0, 6 * np.pi, N)
    moved = np.zeros((N, 12, 3))
    moved[:, :, 0] = np.linspace(0.0, 3.0, N)[:, None]
    lead = np.sin(phase)
    if changed:
        lead = np.abs(lead)
    moved[:, TWELVE.index("l_ankle"), 0] += swing_m * lead
    moved[:, TWELVE.index("r_ankle"), 0] -= swing_m * lead
    walk = course(moved)
    walk.places[:, TWELVE.index("l_ankle"), 0] -= STANDING[JOINT_NAMES.index("l_ankle"), 0]
    walk.places[:, TWELVE.index("r_ankle"), 0] -= STANDING[JOINT_NAMES.index("r_ankle"), 0]
    return walk


def test_a_walk_alternates_and_one_whose_sides_flip_does_not() -> None:
    """Six times the feet part: five times it can be told which foot led before."""
    assert steps(walking()) == (5, 5)
    assert steps(walking(changed=True)) == (5, 0)


def test_who_stands_takes_no_step() -> None:
    assert steps(walking(swing_m=0.01)) == (0, 0)
    assert steps(course(np.full((N, 1, 1), np.nan))) == (0, 0)


def test_a_count_begins_anew_where_nobody_was_seen() -> None:
    """Of six steps in two stretches of three each can be told of two."""
    walk = walking()
    walk.places[60] = np.nan
    assert steps(walk) == (4, 4)


def test_lengths_that_vary_are_told_and_fixed_ones_are_not() -> None:
    """A forearm of 1 to 1.2 times its length varies by 18 % of the median from 5 to 95 %."""
    rigid = np.repeat(STANDING[None], N, axis=0)
    assert spread(rigid) == pytest.approx(0.0, abs=1e-9)
    elbow, wrist = JOINT_NAMES.index("l_elbow"), JOINT_NAMES.index("l_wrist")
    grows = 1 + np.linspace(0.0, 0.2, N)[:, None]
    rigid[:, wrist] = rigid[:, elbow] + grows * (rigid[:, wrist] - rigid[:, elbow])
    assert spread(rigid) == pytest.approx(100 * 0.18 / 1.1, rel=0.01)
    assert np.isnan(spread(np.full((N, 15, 3), np.nan)))
