"""Knees that one view has the wrong way, held against bodies that stand as people can."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from staging import PERSON, RIG, observation, silhouettes, standing

from common.body.body import JOINT_NAMES, LIMBS
from common.body.kinematics import joints
from common.body.proportions import body_vector
from common.body.stick_body import ADULT
from common.method import DEFAULT
from common.rig.camera import project
from integrator.single import bent_limbs, reflection
from integrator.single.sight import Annotations, Sight

CAMERA = RIG.cameras[0]
SIGHT = Sight(
    DEFAULT,
    0,
    RIG,
    observation(silhouettes(standing())[0]),
    ADULT,
    PERSON,
    None,
    0.0,
    Annotations(),
)
SHANKS = [LIMBS.index(f"{side}_lower_leg") for side in "rl"]
KNEES, ANKLES = (
    [JOINT_NAMES.index(f"{side}_{part}") for side in "rl"] for part in ("knee", "ankle")
)


def bowed(knee_deg: float) -> np.ndarray:
    """Somebody who faces the camera, thighs a little raised, shanks behind the knees."""
    pose = standing(r_hip_x=15.0, l_hip_x=15.0, r_knee_x=-knee_deg, l_knee_x=-knee_deg)
    return np.asarray(joints(body_vector(PERSON), pose))


@given(st.floats(0.0, 100.0))
def test_knees_that_bend_backwards_are_left(knee_deg: float) -> None:
    true_m = bowed(knee_deg)
    assert np.array_equal(bent_limbs.bent(SIGHT, true_m), true_m)


@pytest.mark.parametrize("knee_deg", [50.0, 70.0, 90.0])
def test_knees_that_bend_forwards_are_mirrored_back(knee_deg: float) -> None:
    true_m = bowed(knee_deg)
    wrong_m = true_m
    for shank in SHANKS:
        wrong_m = reflection.mirrored(CAMERA, wrong_m, shank)
    assert np.linalg.norm((wrong_m - true_m)[ANKLES], axis=1).min() > 0.2
    found_m = bent_limbs.bent(SIGHT, wrong_m)
    assert np.linalg.norm(found_m - true_m, axis=1).max() < 1e-6


def test_a_mirrored_limb_is_seen_in_the_same_place_as_far_on_the_other_side() -> None:
    true_m = bowed(70.0)
    other_m = reflection.mirrored(CAMERA, true_m, SHANKS[0])
    assert project(CAMERA, other_m) == pytest.approx(project(CAMERA, true_m))
    deep = np.array(CAMERA.R)[2]
    lean_m = deep @ (true_m[ANKLES[0]] - true_m[KNEES[0]])
    assert deep @ (other_m[ANKLES[0]] - other_m[KNEES[0]]) == pytest.approx(-lean_m)
    assert np.delete(other_m - true_m, ANKLES[0], 0) == pytest.approx(0.0, abs=1e-9)
