"""Limbs of constant length, held against joints whose distances are known."""

import numpy as np
import pytest

from integrator.landmarks.limb_springs import ENDS, lengths_m, sprung
from integrator.proposal.network_weights import JOINTS

AT = {name: i for i, name in enumerate(JOINTS)}
STATURE_M = 1.75
TIGHT = np.tile([1e4, 0.0, 0.0, 1e4, 0.0, 1e4], (len(JOINTS), 1))


def standing() -> np.ndarray:
    heights_m = {
        "shoulder": 1.4,
        "elbow": 1.1,
        "wrist": 0.85,
        "hip": 0.95,
        "knee": 0.5,
        "ankle": 0.08,
    }
    aside_m = {"shoulder": 0.2, "elbow": 0.2, "wrist": 0.2, "hip": 0.1, "knee": 0.1, "ankle": 0.1}
    sides = {"l": 1.0, "r": -1.0}
    return np.array(
        [[sides[name[0]] * aside_m[name[2:]], heights_m[name[2:]], 0.0] for name in JOINTS]
    )


def test_joints_whose_limbs_are_as_long_as_before_stay() -> None:
    joints_m = standing()
    assert sprung(joints_m, TIGHT, lengths_m(None, joints_m, STATURE_M)) == pytest.approx(joints_m)


def test_a_joint_that_is_loose_along_one_axis_moves_along_it_to_its_limb_s_length() -> None:
    """A wrist whose depth nobody saw comes back to where its forearm is as long as it was."""
    known_m = lengths_m(None, standing(), STATURE_M)
    joints_m, precisions = standing(), TIGHT.copy()
    joints_m[AT["l_wrist"], 2] += 0.25
    precisions[AT["l_wrist"], 5] = 10.0
    found = sprung(joints_m, precisions, known_m)
    forearm = np.linalg.norm(found[AT["l_wrist"]] - found[AT["l_elbow"]])
    before = np.linalg.norm(joints_m[AT["l_wrist"]] - joints_m[AT["l_elbow"]])
    assert before - 0.25 > 0.1
    assert forearm == pytest.approx(0.25, abs=0.02)
    assert found[AT["r_wrist"]] == pytest.approx(joints_m[AT["r_wrist"]], abs=0.005)


def test_lengths_are_learnt_slowly_and_are_the_same_on_both_sides() -> None:
    joints_m = standing()
    known_m = lengths_m(None, joints_m, STATURE_M)
    joints_m[AT["l_ankle"], 1] -= 0.2
    later_m = lengths_m(known_m, joints_m, STATURE_M)
    shins = [i for i, (near, _) in enumerate(ENDS) if JOINTS[near].endswith("knee")]
    assert later_m[shins[0]] == later_m[shins[1]]
    assert later_m[shins[0]] - known_m[shins[0]] == pytest.approx(0.05 * 0.1)


def test_what_one_camera_takes_for_longer_again_and_again_does_not_grow_beyond_anybody() -> None:
    """As in a film of minutes of somebody whose forearm pointed to the camera: it became
    kilometres long, and the body was lost for good."""
    loose = TIGHT.copy()
    loose[:, 5] = 1e-3  # of depth nothing is known
    known_m, nearer = lengths_m(None, standing(), STATURE_M), standing()
    nearer[AT["l_wrist"], 2] += 0.6
    nearer[AT["r_wrist"], 2] += 0.6
    for _ in range(5000):
        known_m = lengths_m(known_m, sprung(nearer, loose, known_m), STATURE_M)
    forearm = next(i for i, (near, _) in enumerate(ENDS) if JOINTS[near].endswith("elbow"))
    assert known_m[forearm] <= 1.3 * 0.145 * STATURE_M + 1e-9
