"""Scaled orthography, held against bodies projected by hand (T19-T22)."""

import numpy as np
import pytest
from stick_posing import STATURE_PX, stick_pose

from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS
from common.body.stick_body import (
    ADULT,
    HALF_HIPS,
    HALF_SHOULDERS,
    SHOULDERS_BELOW,
    joints_px,
)
from integrator.single.lifting import (
    StickPicture,
    _before_m,
    depths_m,
    lift,
    tilt_errors_deg,
    yaw_of,
)

LENGTHS_M = ADULT.lengths * 1.75
PX_PER_M = STATURE_PX / 1.75
AT = {name: i for i, name in enumerate(JOINT_NAMES)}


def test_depth_is_the_printed_root() -> None:
    """T19, eq. 2.2: 3, 4, 5."""
    assert depths_m(np.array([5.0]), np.array([300.0]), 100.0) == pytest.approx([4.0])


def test_a_segment_seen_too_long_has_no_depth() -> None:
    """M22: the radicand is not below 0."""
    assert depths_m(np.array([1.0]), np.array([150.0]), 100.0) == pytest.approx([0.0])


def test_depth_is_that_of_the_ratio() -> None:
    """T19: l sqrt(1 - r^2)."""
    ratios = np.linspace(0.0, 1.0, 11)
    depth = depths_m(np.full(11, 0.4), ratios * 0.4 * 90.0, 90.0)
    assert depth == pytest.approx(0.4 * np.sqrt(1 - ratios**2))


def test_a_pixel_matters_most_in_the_plane() -> None:
    """T19: 15 degrees for 30 px in the plane, 3 at 45 degrees."""
    lengths = np.array([0.3, 0.3])
    errors = tilt_errors_deg(lengths, np.array([30.0, 30.0 * np.sqrt(0.5)]), 100.0)
    assert errors[0] == pytest.approx(14.8, abs=0.5)
    assert errors[1] == pytest.approx(3.0, abs=0.5)


@pytest.mark.parametrize(
    ("orientation", "yaw_deg"),
    [
        ("forward_right", 60.0),
        ("forward_left", -60.0),
        ("backward_right", 120.0),
        ("backward_left", -120.0),
        ("right", 90.0),
        ("left", -90.0),
    ],
)
def test_six_orientations_and_half_a_breadth_make_six_yaws(
    orientation: str, yaw_deg: float
) -> None:
    """T22."""
    assert yaw_of(orientation, 0.5) == pytest.approx(yaw_deg)  # type: ignore[arg-type]


def test_every_segment_has_its_length_in_space() -> None:
    """T19, T20: whatever the pose, the signs and the orientation."""
    rng = np.random.default_rng(4)
    for _ in range(30):
        pose = stick_pose({})
        pose[4:14] += rng.uniform(-60, 60, 10)
        pose[14:24] = rng.uniform(0.1, 1.0, 10)
        signs = rng.choice([-1.0, 1.0], 10)
        lifted = lift(
            StickPicture(joints_px(ADULT, pose), 1.0, LENGTHS_M, PX_PER_M), signs, "forward_left"
        )
        along = lifted.joints_m[LIMB_ENDS[:, 1]] - lifted.joints_m[LIMB_ENDS[:, 0]]
        assert np.linalg.norm(along, axis=1) == pytest.approx(LENGTHS_M[:10])
        assert np.sign(lifted.tilt_deg) == pytest.approx(signs)


def test_the_lifted_body_is_projected_where_it_was_seen() -> None:
    """T19, eq. 2.1."""
    pose = stick_pose({"r_upper_arm": 200.0}, {"l_upper_leg": 0.6})
    seen = joints_px(ADULT, pose)
    lifted = lift(StickPicture(seen, 1.0, LENGTHS_M, PX_PER_M), np.ones(10), "forward_right")
    assert lifted.joints_m[:, :2] * PX_PER_M * [1, -1] == pytest.approx(seen)


def test_seen_from_behind_left_is_left() -> None:
    """3.1.5: the orientation tells the left leg from the right."""
    seen = joints_px(ADULT, stick_pose({"r_upper_arm": 180.0, "r_lower_arm": 180.0}))
    before = lift(StickPicture(seen, 1.0, LENGTHS_M, PX_PER_M), np.ones(10), "forward_right")
    behind = lift(StickPicture(seen, 1.0, LENGTHS_M, PX_PER_M), np.ones(10), "backward_right")
    assert before.joints_m[AT["r_wrist"], 0] == behind.joints_m[AT["l_wrist"], 0]


def test_who_faces_the_right_has_the_left_shoulder_away_from_the_camera() -> None:
    """T22: the shoulders lie across the way that is faced."""
    seen = joints_px(ADULT, stick_pose({}))
    lifted = lift(StickPicture(seen, 0.0, LENGTHS_M, PX_PER_M), np.ones(10), "right")
    left, right = (lifted.joints_m[AT[f"{side}_shoulder"], 2] for side in "lr")
    assert right - left == pytest.approx(2 * LENGTHS_M[10])
    assert lifted.yaw_deg == 90.0


def test_all_ten_limbs_lie_between_joints() -> None:
    assert LIMB_ENDS.shape == (len(LIMBS), 2)
    assert [JOINT_NAMES[i] for i in LIMB_ENDS[LIMBS.index("l_lower_leg")]] == ["l_knee", "l_ankle"]


def test_joints_are_before_the_pelvis_by_the_sum_of_what_leads_to_them() -> None:
    """Shoulders and hips aside by the yaw, the rest segment by segment; to the left at -90."""
    rng = np.random.default_rng(4)
    depth_m, yaw_deg = rng.uniform(-0.2, 0.2, 10), 35.0
    found = _before_m(LENGTHS_M, depth_m, yaw_deg)
    of = dict(zip(LIMBS, depth_m, strict=True))
    sine = np.sin(np.radians(yaw_deg))
    assert found[AT["pelvis"]] == 0.0
    assert found[AT["neck"]] == pytest.approx(of["torso"])
    assert found[AT["head_top"]] == pytest.approx(of["torso"] + of["head"])
    share = 1.0 - LENGTHS_M[SHOULDERS_BELOW] / LENGTHS_M[LIMBS.index("torso")]
    for side, sign in (("l", -1.0), ("r", 1.0)):
        shoulder = of["torso"] * share + sign * LENGTHS_M[HALF_SHOULDERS] * sine
        hip = sign * LENGTHS_M[HALF_HIPS] * sine
        arm = of[f"{side}_upper_arm"], of[f"{side}_lower_arm"]
        leg = of[f"{side}_upper_leg"], of[f"{side}_lower_leg"]
        expected = {
            "shoulder": shoulder, "elbow": shoulder + arm[0], "wrist": shoulder + sum(arm),
            "hip": hip, "knee": hip + leg[0], "ankle": hip + sum(leg),
        }  # fmt: skip
        for name, before_m in expected.items():
            assert found[AT[f"{side}_{name}"]] == pytest.approx(before_m), name
