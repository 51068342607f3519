"""Limbs of known lengths, held against arms whose depth or place is known to be wrong."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from common.body.body import JOINT_NAMES
from integrator.single.rigid_limbs import DEPTH_TIMES, with_lengths

CAMERA = np.array([0.0, 1.2, 4.0])
SHOULDER, ELBOW, WRIST = (JOINT_NAMES.index(f"l_{name}") for name in ("shoulder", "elbow", "wrist"))


def standing() -> np.ndarray:
    """One body (1, 15, 3) whose left arm is stretched out beside it."""
    joints = np.zeros((1, len(JOINT_NAMES), 3))
    joints[0, :, 1] = np.linspace(0.1, 1.7, len(JOINT_NAMES))
    joints[0, [SHOULDER, ELBOW, WRIST]] = [[0.2, 1.4, 0.0], [0.5, 1.4, 0.0], [0.75, 1.4, 0.0]]
    return joints


def test_joints_that_have_their_lengths_stay() -> None:
    assert np.allclose(with_lengths(standing(), standing(), CAMERA), standing(), atol=1e-6)


def test_a_limb_that_is_too_long_in_depth_gives_way_in_depth() -> None:
    found = standing()
    found[0, ELBOW, 2], found[0, WRIST, 2] = 0.25, 0.25
    sight = (found[0, ELBOW] - CAMERA) / np.linalg.norm(found[0, ELBOW] - CAMERA)
    made = with_lengths(found, standing(), CAMERA)
    aimed = found[0, ELBOW] - found[0, SHOULDER]
    aimed = found[0, SHOULDER] + aimed * 0.3 / np.linalg.norm(aimed)

    def beside(place: np.ndarray) -> float:
        away = place - found[0, ELBOW]
        return float(np.linalg.norm(away - (away @ sight) * sight))

    assert beside(made[0, ELBOW]) < 0.75 * beside(aimed)


@given(st.lists(st.floats(-0.3, 0.3), min_size=6, max_size=6))
def test_limbs_have_their_lengths_wherever_they_were_found(off: list[float]) -> None:
    found = standing()
    found[0, [ELBOW, WRIST]] += np.reshape(off, (2, 3))
    made = with_lengths(found, standing(), CAMERA)
    lengths = np.linalg.norm(np.diff(made[0, [SHOULDER, ELBOW, WRIST]], axis=0), axis=1)
    assert np.allclose(lengths, [0.3, 0.25])


def test_a_limb_whose_ends_were_found_at_one_place_has_its_length_too() -> None:
    found = standing()
    found[0, [ELBOW, WRIST]] = found[0, SHOULDER]
    made = with_lengths(found, standing(), CAMERA)
    assert np.isclose(np.linalg.norm(made[0, ELBOW] - made[0, SHOULDER]), 0.3)


def test_an_arm_whose_ends_were_found_at_one_place_points_where_the_rigid_one_does() -> None:
    found = standing()
    found[0, ELBOW] = found[0, SHOULDER]
    made = with_lengths(found, standing(), CAMERA)
    assert (made[0, ELBOW] - made[0, SHOULDER]) @ [1.0, 0.0, 0.0] > 0.0, "to the same side"


@given(st.integers(0, 1000))
def test_a_limb_is_the_likeliest_of_its_length(seed: int) -> None:
    """No other of that length is nearer to what was found, weighed twice as loosely in depth."""
    rng = np.random.default_rng(seed)
    found = standing()
    found[0, [ELBOW, WRIST]] += rng.normal(0.0, 0.1, (2, 3))
    made = with_lengths(found, standing(), CAMERA)[0]
    for near, far in ((SHOULDER, ELBOW), (ELBOW, WRIST)):
        sight = (found[0, far] - CAMERA) / np.linalg.norm(found[0, far] - CAMERA)
        length = np.linalg.norm(made[far] - made[near])

        def apart(place: np.ndarray, far: int = far, sight: np.ndarray = sight) -> float:
            away = place - found[0, far]
            deep = away @ sight
            return float(away @ away - deep**2 + (deep / DEPTH_TIMES) ** 2)

        for _ in range(20):
            turned = made[far] - made[near] + rng.normal(0.0, 0.03, 3)
            other = made[near] + turned * length / np.linalg.norm(turned)
            assert apart(made[far]) <= apart(other) + 1e-9


def test_at_the_likeliest_place_both_misfits_pull_along_the_limb_alike() -> None:
    """Lagrange: across the sight the gap is k times the limb, along it 4 k times: a joint is twice
    as uncertain there."""
    found = standing()
    found[0, ELBOW] = (0.45, 1.55, 0.3)
    made = with_lengths(found, standing(), CAMERA)[0]
    sight = (found[0, ELBOW] - CAMERA) / np.linalg.norm(found[0, ELBOW] - CAMERA)
    limb, gap = made[ELBOW] - made[SHOULDER], found[0, ELBOW] - made[ELBOW]
    k = (gap @ sight) / (limb @ sight) / 4.0
    across = limb - (limb @ sight) * sight
    assert np.allclose(gap - (gap @ sight) * sight, k * across, atol=1e-6)
    assert abs(k) > 0.01
