"""Limbs of constant length, held against joints whose distances are known."""

import numpy as np
import pytest

from integrator.landmarks.limb_springs import (
    ENDS,
    ROUNDS,
    SPRING_M,
    UNLIKE,
    USUAL,
    lengths_m,
    sprung,
)
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


def symmetric(packed: np.ndarray) -> np.ndarray:
    """(n, 3, 3) of (n, 6) xx, xy, xz, yy, yz, zz."""
    return np.asarray(packed[:, [[0, 1, 2], [1, 3, 4], [2, 4, 5]]])


def expected_sprung(
    joints_m: np.ndarray, precisions: np.ndarray, known_m: np.ndarray
) -> np.ndarray:
    """Gauss-Newton by whole matrices: residuals of places, whitened, and of lengths."""
    n, found = len(joints_m), joints_m.copy()
    white = np.linalg.cholesky(symmetric(precisions)).transpose(0, 2, 1)
    for _ in range(ROUNDS):
        rows, left = [], []
        for joint in range(n):
            block = np.zeros((3, 3 * n))
            block[:, 3 * joint : 3 * joint + 3] = white[joint]
            rows.append(block)
            left.append(white[joint] @ (found[joint] - joints_m[joint]))
        for (near, far), long_m in zip(ENDS, known_m, strict=True):
            way, block = found[near] - found[far], np.zeros((1, 3 * n))
            block[0, 3 * near : 3 * near + 3] = way / np.linalg.norm(way) / SPRING_M
            block[0, 3 * far : 3 * far + 3] = -way / np.linalg.norm(way) / SPRING_M
            rows.append(block)
            left.append(np.array([(np.linalg.norm(way) - long_m) / SPRING_M]))
        step = np.linalg.lstsq(np.concatenate(rows), -np.concatenate(left), rcond=None)[0]
        found = found + step.reshape(n, 3)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_springs_are_two_steps_of_gauss_and_newton(seed: int) -> None:
    rng = np.random.default_rng(seed)
    joints_m = standing() + rng.normal(0.0, 0.05, (len(JOINTS), 3))
    loose = rng.normal(0.0, 20.0, (len(JOINTS), 3, 3)) + 30.0 * np.eye(3)
    packed = (loose @ loose.transpose(0, 2, 1))[:, [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]
    known_m = lengths_m(None, standing(), STATURE_M)
    found = sprung(joints_m, packed, known_m)
    assert found == pytest.approx(expected_sprung(joints_m, packed, known_m), abs=1e-6)
    assert np.abs(found - joints_m).max() > 0.01


def test_both_sides_take_the_mean_of_their_lengths_and_each_girdle_its_own() -> None:
    joints_m = standing()
    joints_m[AT["l_wrist"], 1] -= 0.04
    known_m = lengths_m(None, joints_m, STATURE_M)
    of = {tuple(JOINTS[i] for i in ends): long for ends, long in zip(ENDS, known_m, strict=True)}
    assert of["l_elbow", "l_wrist"] == of["r_elbow", "r_wrist"] == pytest.approx(0.27)
    assert of["l_shoulder", "r_shoulder"] == pytest.approx(0.4)


def test_a_length_that_nobody_has_is_taken_to_the_limit_on_either_side() -> None:
    usual_m = STATURE_M * USUAL
    assert lengths_m(None, 9.0 * standing(), STATURE_M) == pytest.approx(usual_m * UNLIKE)
    assert lengths_m(None, 0.1 * standing(), STATURE_M) == pytest.approx(usual_m / UNLIKE)
