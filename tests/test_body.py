"""The body's tables, held against the counts and lengths that both documents print."""

import math

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.body.body import (
    ANGLE_NAMES,
    ANGLES_IN_POSE,
    DOF_NAMES,
    FIXED_ANGLES,
    JOINT_AXES,
    LIMBS,
    LIMITS_DEG,
    POSE_NAMES,
    REST_DEG,
    Bdp,
    Elliptic,
    Round,
    body_of_lengths,
    lean_deg,
    rest_pose,
    wrapped_deg,
)
from common.body.proportions import body_vector, stature, thesis_bdp

lengths_26 = st.lists(st.floats(1e-3, 1e3), min_size=26, max_size=26)


def test_ten_cylinders_have_26_numbers() -> None:
    """P5, table 1: six elliptic ones with three, four round ones with two."""
    bdp = thesis_bdp(1.75)
    kinds = [type(getattr(bdp, name)) for name in LIMBS]
    assert Bdp.__struct_fields__ == LIMBS
    assert (kinds.count(Elliptic), kinds.count(Round)) == (6, 4)
    assert kinds[6:] == [Round] * 4
    assert len(bdp.lengths()) == 6 * 3 + 4 * 2 == 26


def test_ten_joints_have_22_degrees_of_freedom_and_17_angles_are_estimated() -> None:
    """P6, P7, M17: six spherical and four flexion joints, three for the place; the head's three
    angles and two of the trunk stay fixed (P22)."""
    assert sorted(len(axes) for axes in JOINT_AXES.values()) == [1] * 4 + [3] * 6
    assert len(DOF_NAMES) == 3 * 6 + 4 == 22
    assert len(POSE_NAMES) == 25
    assert len(FIXED_ANGLES) == 5
    assert len(ANGLE_NAMES) == 25 - 3 - 3 - 2 == 17
    parts = [name.rsplit("_", 1)[0].split("_")[-1] for name in ANGLE_NAMES]
    counts = {part: parts.count(part) for part in parts}
    assert counts == {"torso": 1, "shoulder": 6, "elbow": 2, "hip": 6, "knee": 2}
    assert tuple(POSE_NAMES[at] for at in ANGLES_IN_POSE) == ANGLE_NAMES


def test_neck_and_waist_bend_by_what_the_thesis_allows() -> None:
    """T6 by C7: 45..135 of the thesis, whose angles are the paper's plus 90."""
    for name in ("neck_z", "torso_z"):
        assert tuple(limit + 90.0 for limit in LIMITS_DEG[name]) == (45.0, 135.0)


def test_limits_are_the_papers_and_the_standing_body_is_within_them() -> None:
    """P30: theta_Z of the right shoulder 0..180, of the left 180..360; C3: legs at 180."""
    assert LIMITS_DEG["r_shoulder_z"] == (0.0, 180.0)
    assert LIMITS_DEG["l_shoulder_z"] == (180.0, 360.0)
    pose = dict(zip(POSE_NAMES, rest_pose().tolist(), strict=True))
    for name, (low, high) in LIMITS_DEG.items():
        assert low <= pose[name] <= high, name
    assert (pose["r_hip_z"], pose["l_hip_z"]) == (180.0, 180.0)
    assert {name for name, angle in pose.items() if angle} == set(REST_DEG)


@pytest.mark.parametrize("wrong", [0.0, -0.1, math.nan, math.inf])
def test_a_length_that_is_none_is_refused_with_its_name(wrong: float) -> None:
    """P5: in code and on arrival."""
    with pytest.raises(ValueError, match="short_radius must be a positive length"):
        Elliptic(1.0, wrong, 1.0)
    with pytest.raises(ValueError, match="radius must be a positive length"):
        Round(wrong, 1.0)
    told = msgspec.to_builtins(thesis_bdp(1.75))
    told["r_upper_arm"]["height"] = wrong
    with pytest.raises(msgspec.ValidationError, match=r"r_upper_arm"):
        msgspec.convert(told, Bdp)


def test_a_body_with_a_part_too_few_or_too_many_is_refused() -> None:
    """P5: a BDP message rejects others."""
    told = msgspec.to_builtins(thesis_bdp(1.75))
    for wrong in (
        {name: told[name] for name in LIMBS[1:]},
        told | {"tail": told["head"]},
        told | {"head": told["r_upper_arm"]},
    ):
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert(wrong, Bdp)


@given(lengths_26)
def test_26_numbers_make_a_body_and_come_back_in_order(lengths: list[float]) -> None:
    bdp = body_of_lengths(lengths)
    assert bdp.lengths() == lengths
    assert (bdp.torso.height, bdp.head.long_radius) == (lengths[2], lengths[3])
    assert (bdp.r_upper_arm.radius, bdp.l_lower_arm.height) == (lengths[18], lengths[25])


@given(lengths_26, st.floats(0.01, 100.0))
def test_a_scaled_body_is_similar(lengths: list[float], factor: float) -> None:
    bdp = body_of_lengths(lengths)
    scaled = bdp.scaled(factor)
    assert scaled.lengths() == pytest.approx([length * factor for length in lengths])
    assert stature(scaled) == pytest.approx(stature(bdp) * factor)
    assert body_vector(scaled) == pytest.approx(body_vector(bdp) * factor)


@given(st.floats(-1e4, 1e4), st.integers(-5, 5))
def test_a_wrapped_angle_is_the_same_direction_in_one_turn(angle: float, turns: int) -> None:
    wrapped = wrapped_deg(angle + 360.0 * turns)
    assert -180.0 < wrapped <= 180.0
    there, here = np.deg2rad([angle, wrapped])
    assert math.cos(there) == pytest.approx(math.cos(here), abs=1e-9)
    assert math.sin(there) == pytest.approx(math.sin(here), abs=1e-9)


def test_half_a_turn_is_180_from_both_sides() -> None:
    assert [wrapped_deg(angle) for angle in (180.0, -180.0, 540.0)] == [180.0] * 3


@pytest.mark.parametrize(
    ("right", "down", "deg"),
    [
        (0.0, -5.0, 0.0),
        (29.0, -52.0, 0.0),  # 29.1
        (30.0, -51.0, 30.466),
        (-30.0, -51.0, -30.466),
        (4.0, 0.0, 90.0),
        (-4.0, 3.0, -126.870),
        (0.0, 2.0, 180.0),
        (0.0, 0.0, 0.0),
        (0.0, -0.0, 0.0),
    ],
)
def test_a_trunk_leans_clockwise_by_its_angle_from_30_degrees_on(
    right: float, down: float, deg: float
) -> None:
    """Rows grow down: upright is a neck above its pelvis."""
    assert lean_deg(right, down) == pytest.approx(deg, abs=1e-3)
