"""Where feet, hands and nose are by the body alone: square, flat, and of the published lengths."""

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.body.extremities import ALL_JOINT_NAMES, EXTREMITY_NAMES, _flat, extremities

STANDING = {
    "pelvis": (0.0, 0.93, 0.0),
    "neck": (0.0, 1.45, 0.0),
    "head_top": (0.0, 1.75, 0.0),
    **{
        f"{side}_{joint}": (sign * x, y, 0.0)
        for side, sign in (("l", 1.0), ("r", -1.0))
        for joint, x, y in (
            ("shoulder", 0.18, 1.4),
            ("elbow", 0.2, 1.1),
            ("wrist", 0.2, 0.85),
            ("hip", 0.1, 0.93),
            ("knee", 0.1, 0.5),
            ("ankle", 0.1, 0.039 * 1.75),
        )
    },
}


def standing(**moved: tuple[float, float, float]) -> np.ndarray:
    """Somebody of 1.75 m who faces +z, joints moved."""
    return np.array([{**STANDING, **moved}[name] for name in JOINT_NAMES])


def places(joints_m: np.ndarray) -> dict[str, np.ndarray]:
    return dict(zip(EXTREMITY_NAMES, extremities(joints_m, 1.75), strict=True))


def test_who_stands_has_flat_feet_of_a_foots_length_toes_ahead() -> None:
    found = places(standing())
    for side in "lr":
        heel, toe = found[f"{side}_heel"], found[f"{side}_toe"]
        assert heel[1] == pytest.approx(toe[1], abs=1e-9)
        assert 0.0 < toe[1] < 0.03
        assert np.linalg.norm(toe - heel) == pytest.approx(0.152 * 1.75)
        assert toe[2] > 0.15
        assert heel[2] < -0.05
    assert found["l_toe"][0] > 0.1  # a little out
    assert found["r_toe"][0] < -0.1


def test_the_nose_is_ahead_of_the_head_between_eyes_and_chin() -> None:
    nose = places(standing())["nose"]
    assert nose[0] == pytest.approx(0.0)
    assert 0.870 * 1.75 < nose[1] < 0.936 * 1.75
    assert 0.09 < nose[2] < 0.14


def test_a_hand_goes_on_along_its_forearm() -> None:
    knuckle = places(standing(l_elbow=(0.2, 1.1, 0.0), l_wrist=(0.2, 1.1, 0.25)))["l_knuckle"]
    assert knuckle == pytest.approx([0.2, 1.1, 0.25 + 0.047 * 1.75])


def test_a_leg_kicked_level_has_its_toes_up() -> None:
    found = places(standing(r_knee=(-0.1, 0.93, 0.43), r_ankle=(-0.1, 0.93, 0.86)))
    up = found["r_toe"] - found["r_heel"]
    assert up[1] / np.linalg.norm(up) > 0.98


@pytest.mark.parametrize("lean_deg", [-40.0, -20.0, 20.0, 40.0])
def test_a_shank_that_leans_over_a_standing_ankle_leaves_the_foot_flat(lean_deg: float) -> None:
    """As in a squat: toes do not go through the floor, nor heels."""
    lean = np.radians(lean_deg)
    ankle = np.array(STANDING["l_ankle"])
    knee = ankle + 0.43 * np.array([0.0, np.cos(lean), np.sin(lean)])
    found = places(standing(l_knee=tuple(knee.tolist())))
    assert found["l_heel"][1] == pytest.approx(found["l_toe"][1], abs=0.005)


def test_many_poses_at_once_are_each_as_alone_and_none_stays_none() -> None:
    poses = np.stack([standing(), standing(l_wrist=(0.5, 1.0, 0.1)), np.full((15, 3), np.nan)])
    many = extremities(poses, 1.75)
    assert many[1] == pytest.approx(extremities(poses[1], 1.75))
    assert np.isnan(many[2]).all()


def test_the_15_joints_come_first() -> None:
    assert ALL_JOINT_NAMES[:15] == JOINT_NAMES
    assert len(ALL_JOINT_NAMES) == 22


@pytest.mark.parametrize("ankle", [0.045, 0.06, 0.09])
@pytest.mark.parametrize("way_deg", [-70.0, 70.0])
def test_a_foot_that_would_pass_through_the_floor_stands_on_its_toe_or_its_heel(
    ankle: float, way_deg: float
) -> None:
    """By its triangle, in statures: 0.029 under the ankle, toe 0.11552 ahead, heel 0.03648 behind;
    what bears is 0.010 high."""
    way = np.radians(way_deg)
    ahead = np.array([0.6 * np.cos(way), np.sin(way), -0.8 * np.cos(way)])
    found = _flat(ahead, np.array(ankle))
    pitch = np.arcsin(found[1])
    assert found[[0, 2]] == pytest.approx(np.cos(pitch) * np.array([0.6, -0.8]))
    reach = 0.11552 if way_deg < 0 else -0.03648
    least = 0.03 if way_deg < 0 else 0.0
    height = ankle - 0.029 * np.cos(pitch) + reach * np.sin(pitch)
    if height > 0.010 + 1e-9:
        assert np.degrees(pitch) == pytest.approx(way_deg)  # it is not as low as that
    else:
        assert height == pytest.approx(0.010)
        assert abs(pitch) > least


def test_a_foot_that_is_high_enough_points_anywhere() -> None:
    for way_deg, ankle in ((-80.0, 0.2), (80.0, 0.2), (-5.0, 0.06), (5.0, 0.06), (0.0, 0.039)):
        ahead = np.array([0.0, np.sin(np.radians(way_deg)), np.cos(np.radians(way_deg))])
        assert _flat(ahead, np.array(ankle)) == pytest.approx(ahead)
    level = np.array([0.0, np.sin(-0.3), np.cos(-0.3)])
    assert _flat(level, np.array(0.03)) == pytest.approx([0.0, 0.0, 1.0])
