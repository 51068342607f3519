"""The stick body's proportions and joints, held against the printed tables and by hand (T3-T5)."""

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.body.stick_body import (
    ADULT,
    ANGLE,
    BREADTH,
    RATIO,
    THESIS,
    joints_px,
    pose_of,
    standing,
)

AT = {name: i for i, name in enumerate(JOINT_NAMES)}


def test_the_thesis_body_has_the_lengths_and_widths_of_its_tables() -> None:
    """T4, T5, M18."""
    lengths = THESIS.lengths[:10] * 175.0
    assert lengths == pytest.approx([52, 25, 46, 46, 52, 52, 25, 25, 35, 35])
    assert 2 * THESIS.parts[:, 3] * 175.0 == pytest.approx([40, 20, 20, 20, 20, 20, *[10] * 4])


@pytest.mark.parametrize("man", [THESIS, ADULT], ids=["thesis", "adult"])
def test_a_standing_body_is_a_stature_tall(man: object) -> None:
    """T4: head, torso and legs add up; of the adult's the ankle is 0.044 above the floor."""
    assert isinstance(man, type(ADULT))
    joints = joints_px(man, standing(0.0, 0.0, 175.0))
    below = 0.0 if man is THESIS else 0.044 * 175.0
    tall = joints[AT["l_ankle"], 1] - joints[AT["head_top"], 1] + below
    assert tall == pytest.approx(175.0, rel=0.01)


def test_r_is_on_the_left_of_the_picture() -> None:
    """T10."""
    joints = joints_px(ADULT, standing(50.0, 50.0, 100.0))
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle"):
        assert joints[AT[f"r_{name}"], 0] < 50.0 < joints[AT[f"l_{name}"], 0]


def test_an_arm_follows_its_angles_and_ratios() -> None:
    pose = standing(0.0, 0.0, 100.0)
    pose[ANGLE + 7], pose[ANGLE + 9], pose[RATIO + 9] = 0.0, 90.0, 0.5
    joints = joints_px(ADULT, pose)
    shoulder, elbow, wrist = (joints[AT[f"l_{n}"]] for n in ("shoulder", "elbow", "wrist"))
    assert elbow - shoulder == pytest.approx([15.7, 0.0])
    assert wrist - elbow == pytest.approx([0.0, -7.0], abs=1e-9)


def test_a_trunk_in_profile_has_its_hips_together() -> None:
    pose = standing(0.0, 0.0, 100.0)
    pose[BREADTH] = 0.0
    joints = joints_px(ADULT, pose)
    assert np.allclose(joints[AT["l_hip"]], joints[AT["r_hip"]])


@pytest.mark.parametrize("man", [THESIS, ADULT], ids=["thesis", "adult"])
def test_joints_lead_back_to_the_pose_that_has_them(man: object) -> None:
    """The stick body of a frame that is found otherwise: drawn from its joints (T10, T18)."""
    assert isinstance(man, type(ADULT))
    pose = standing(50.0, 60.0, 100.0)
    pose[BREADTH] = 0.7
    pose[ANGLE + 7], pose[ANGLE + 9], pose[RATIO + 9] = 10.0, 80.0, 0.5
    assert pose_of(man, joints_px(man, pose), 100.0) == pytest.approx(pose)


def test_a_body_that_leans_has_its_parts_along_and_across_its_trunk() -> None:
    """By complex numbers, rows down: e^(-ia) is the direction of an angle a."""

    def turn(deg: float) -> complex:
        return complex(np.exp(-1j * np.radians(deg)))

    rng = np.random.default_rng(3)
    pose = np.ones(25)
    pose[[0, 1, 2, 3]] = 50.0, 80.0, 120.0, 0.6
    pose[ANGLE:RATIO], pose[RATIO : RATIO + 10] = rng.uniform(0, 360, 10), rng.uniform(0.3, 1, 10)
    size, lengths = 120.0, ADULT.lengths
    trunk, across = turn(pose[ANGLE]), turn(pose[ANGLE] - 90.0)
    pelvis = 50.0 + 80.0j
    reach = [lengths[i] * size * pose[RATIO + i] * turn(pose[ANGLE + i]) for i in range(10)]
    neck = pelvis + reach[0]
    due = {"pelvis": pelvis, "neck": neck, "head_top": neck + reach[1]}
    base = neck - lengths[11] * size * pose[RATIO] * trunk
    for side, sign, k in (("r", -1.0, 0), ("l", 1.0, 1)):
        shoulder = base + sign * lengths[10] * size * 0.6 * across
        hip = pelvis + sign * lengths[12] * size * 0.6 * across
        due |= {f"{side}_shoulder": shoulder, f"{side}_hip": hip}
        due |= {f"{side}_elbow": shoulder + reach[6 + k], f"{side}_knee": hip + reach[2 + k]}
        due[f"{side}_wrist"] = due[f"{side}_elbow"] + reach[8 + k]
        due[f"{side}_ankle"] = due[f"{side}_knee"] + reach[4 + k]
    found = joints_px(ADULT, pose)
    for name, at in AT.items():
        assert found[at] == pytest.approx([due[name].real, due[name].imag]), name


def test_a_limb_that_is_longer_than_it_can_be_shows_all_of_its_length() -> None:
    pose = standing(50.0, 60.0, 100.0)
    joints = joints_px(ADULT, pose)
    joints[AT["l_wrist"]] += [0.0, 9.0]
    joints[[AT["l_shoulder"], AT["r_shoulder"]]] += [[30.0, 0.0], [-30.0, 0.0]]
    found = pose_of(ADULT, joints, 100.0)
    assert (found[RATIO + 9], found[BREADTH]) == (1.0, 1.0)
    joints[[AT["l_shoulder"], AT["r_shoulder"]]] = [[53.0, 40.0], [50.0, 44.0]]
    assert pose_of(ADULT, joints, 100.0)[BREADTH] == pytest.approx(5.0 / (2 * 9.8))
