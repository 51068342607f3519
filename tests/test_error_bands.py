"""Bands of joints and angles: a law of propagation, and that less sure is wider."""

import math

import numpy as np
import pytest
from moving import BODY

from animator.clinical.clinical_angles import NAMES
from animator.clinical.error_bands import (
    ANGLES,
    JOINTS,
    LAG_S,
    Reach,
    angle_bands_deg,
    angle_spreads_deg,
    joint_bands_mm,
    spreads_m,
)
from common.body.body import JOINT_NAMES, POSE_INDEX, rest_pose
from common.body.extremities import extremities
from common.body.joint_spread import FIRM_M, PLATT, confidence_of, spread_of
from common.body.kinematics import joints


def bent() -> np.ndarray:
    """Somebody with a bent knee and a bent elbow, (1, 22, 3)."""
    pose = rest_pose()
    pose[POSE_INDEX["r_knee_x"]], pose[POSE_INDEX["r_elbow_x"]] = -60.0, 60.0
    joints_m = joints(BODY, pose)
    return np.concatenate([joints_m, extremities(joints_m, 1.75)])[None]


def test_a_spread_and_its_confidence_tell_each_other() -> None:
    spread_m = np.array([0.012, 0.02, 0.04, 0.06])
    assert spread_of(confidence_of(spread_m)) == pytest.approx(spread_m)
    assert confidence_of(np.array([FIRM_M]))[0] == pytest.approx(1 / (1 + math.exp(-PLATT[0])))
    assert (np.diff(spread_of(np.array([1.0, 0.9, 0.5, 0.1, 0.0]))) >= 0).all()


def test_the_spread_of_a_knee_is_that_of_its_three_joints_over_its_bones() -> None:
    """By hand, of a hinge: s sqrt(1/a^2 + 1/b^2 + (1/a + 1/b)^2 - corrections of the bend).

    The angle between two bones a and b turns by 1/a for each metre of the hip across the thigh, by
    1/b for the ankle across the shank, and for the knee by the sum of both as vectors.
    """
    joints_m, s = bent(), 0.01
    hip, knee, ankle = (
        joints_m[0, JOINT_NAMES.index(f"r_{name}")] for name in ("hip", "knee", "ankle")
    )
    a, b = np.linalg.norm(knee - hip), np.linalg.norm(ankle - knee)
    cosine = (knee - hip) @ (ankle - knee) / (a * b)
    of_knee = 1 / a**2 + 1 / b**2 + 2 * cosine / (a * b)
    expected = math.degrees(s * math.sqrt(1 / a**2 + 1 / b**2 + of_knee))
    found = angle_spreads_deg(joints_m, np.full((1, 22), s))[0, NAMES.index("knee_angle_r")]
    assert found == pytest.approx(expected, rel=0.01)


def test_drawn_errors_lie_in_a_band_of_so_many_spreads() -> None:
    """A law: of angles whose joints are off by a normal error, 68 % lie within one spread."""
    rng, s = np.random.default_rng(2), 0.006
    joints_m = bent()
    off = rng.normal(0, s, (4000, 22, 3))
    from animator.clinical.clinical_angles import clinical_angles

    turned = clinical_angles(joints_m + off) - clinical_angles(joints_m)
    spread = angle_spreads_deg(joints_m, np.full((1, 22), s))[0]
    for name in (
        "knee_angle_r",
        "hip_flexion_r",
        "hip_adduction_l",
        "elbow_flex_r",
        "hip_rotation_r",
    ):
        at = NAMES.index(name)
        inside = np.mean(np.abs(turned[:, at]) < spread[at])
        assert inside == pytest.approx(0.683, abs=0.03), name


def test_a_body_that_moves_is_less_certain_by_what_it_moves_in_the_lag() -> None:
    """At 1.5 m/s, by hand; a gap in the run counts neither as rest nor as motion."""
    time_s = np.arange(40) / 20
    joints_m = np.zeros((40, 15, 3))
    joints_m[:, :, 0] = 1.5 * time_s[:, None]
    joints_m[30:33] = np.nan
    found = spreads_m(joints_m, np.ones((40, 15)), time_s)
    still = spreads_m(np.zeros((40, 15, 3)), np.ones((40, 15)), time_s)
    assert still == pytest.approx(np.full((40, 15), float(spread_of(np.ones(1))[0])))
    assert found[20] == pytest.approx(np.hypot(still[20], 1.5 * LAG_S))
    assert spreads_m(joints_m[:1], np.ones((1, 15)), time_s[:1]) == pytest.approx(still[:1])


def test_every_angle_and_joint_has_bands_and_less_sure_is_wider() -> None:
    joints_m = bent()
    sure, unsure = (angle_bands_deg(joints_m, np.full((1, 22), spread)) for spread in (0.01, 0.03))
    seen = np.isfinite(sure[0, :, 0])
    assert (sure[0, seen, 0] <= sure[0, seen, 1]).all()
    assert (sure[0, seen] <= unsure[0, seen] + 1e-9).all()
    near, far = (joint_bands_mm(np.full((1, 15), spread)) for spread in (0.01, 0.03))
    assert (near < far).all()
    assert (near[..., 0] < near[..., 1]).all()
    for reach in (*ANGLES.values(), *JOINTS.values()):
        assert isinstance(reach, Reach)
        assert min(reach) >= 0.0
