"""The contour method, held against curves and legs whose truth is drawn (T14-T17)."""

import numpy as np
import pytest

from common.body.stick_body import ANGLE, THESIS, standing
from common.method import DEFAULT, METHODS, Method
from common.raster.stick_raster import draw_stick
from viewer.stick.contour import (
    Curve,
    arm_angles,
    arm_curve,
    elbow_corner,
    knees_crossed,
    line_angle_deg,
    lower_leg_curves,
    outer_runs,
    steady_corner,
    turn_deg,
)

THESIS_AS_PRINTED = METHODS["thesis"]


def bent(bend_deg: float, seed: int, noise_px: float = 0.5, points: int = 28) -> Curve:
    """An arm that hangs and bends in its middle, with noise across it."""
    half = points // 2
    upper = np.stack([np.zeros(half), np.arange(half)], axis=1)
    along = np.array([np.sin(np.radians(bend_deg)), np.cos(np.radians(bend_deg))])
    lower = upper[-1] + np.arange(1, points - half + 1)[:, None] * along
    noise = np.random.default_rng(seed).normal(0.0, noise_px, (points, 2))
    return np.concatenate([upper, lower]) + noise


def printed_corner(curve: Curve) -> int:
    """Algorithm 4 by its printed lines, both ends guarded and angles on the circle (M21)."""
    candidates = []
    for i in range(4, len(curve) - 4):
        angles = []
        for part in (curve[: i + 1], curve[i:]):
            _, _, axes = np.linalg.svd(part - part.mean(axis=0))
            along = axes[0] if axes[0] @ (part[-1] - part[0]) >= 0.0 else -axes[0]
            angles.append(float(np.degrees(np.arctan2(-along[1], along[0]))))
        difference = abs((angles[0] - angles[1] + 180.0) % 360.0 - 180.0)
        if difference > 10.0:
            candidates.append((difference, -i))
    return -max(candidates)[1] if candidates else -1


@pytest.mark.parametrize("bend_deg", [0.0, 8.0, 11.0, 20.0, 60.0])
def test_the_elbow_is_where_algorithm_4_prints_it(bend_deg: float) -> None:
    """T16: more than 10 degrees, and of the corners that with the largest difference."""
    curves = [bent(bend_deg, seed) for seed in range(40)]
    assert [elbow_corner(curve) for curve in curves] == [printed_corner(curve) for curve in curves]


@pytest.mark.parametrize("bend_deg", [10.5, 12.0])
def test_arms_that_bend_a_little_have_elbows_in_print_and_few_steady_ones(bend_deg: float) -> None:
    """T16: the print takes 10 degrees, a steady elbow 15."""
    printed, steady = (
        sum(corner(bent(bend_deg, seed)) >= 0 for seed in range(100))
        for corner in (elbow_corner, steady_corner)
    )
    assert printed >= 90
    assert steady <= 40


@pytest.mark.parametrize(("method", "straight"), [(DEFAULT, True), (THESIS_AS_PRINTED, False)])
def test_the_thesis_mode_takes_the_printed_elbow(method: Method, straight: bool) -> None:
    """T16: a bend of 13 degrees, without noise."""
    assert (arm_angles(bent(13.0, 0, noise_px=0.0), method).corner == -1) == straight


def test_a_straight_arm_has_no_steady_elbow() -> None:
    """M21: as printed 99 of 100 have one."""
    assert [steady_corner(bent(0.0, seed)) for seed in range(100)].count(-1) >= 99


@pytest.mark.parametrize("bend_deg", [30.0, 60.0, 90.0])
def test_a_bent_arm_has_its_steady_elbow_where_it_bends(bend_deg: float) -> None:
    """T16: point 14 of 28, where the printed rule gives 17 to 20, 9 off."""
    found = np.array([steady_corner(bent(bend_deg, seed)) for seed in range(60)])
    assert np.all(found > 0)
    assert abs(found.mean() - 13.5) < 1.0
    assert found.std() < 2.0


def test_a_straight_arm_has_one_angle_and_a_bent_one_two() -> None:
    """T15, algorithm 3."""
    straight = arm_angles(bent(0.0, 1, noise_px=0.0), THESIS_AS_PRINTED)
    assert straight.corner == -1
    assert straight.upper == straight.lower == pytest.approx(270.0)
    both = arm_angles(bent(60.0, 1, noise_px=0.0), THESIS_AS_PRINTED)
    assert both.upper == pytest.approx(270.0, abs=2.0)
    assert both.lower == pytest.approx(330.0, abs=2.0)


@pytest.mark.parametrize("angle_deg", [0.0, 45.0, 90.0, 200.0, 270.0, 359.0])
def test_a_line_leads_from_its_first_point_to_its_last(angle_deg: float) -> None:
    along = np.array([np.cos(np.radians(angle_deg)), -np.sin(np.radians(angle_deg))])
    curve = np.arange(9.0)[:, None] * along
    assert turn_deg(line_angle_deg(curve), angle_deg) < 1e-6


def test_directions_differ_by_no_more_than_half_a_turn() -> None:
    """M21: 359 and 1 degrees are 2 apart."""
    assert turn_deg(359.0, 1.0) == pytest.approx(2.0)
    assert turn_deg(90.0, 270.0) == pytest.approx(180.0)


def test_a_scan_line_has_a_run_for_each_piece() -> None:
    rows = np.array([[1, 1, 0, 0, 1, 0, 1], [0, 0, 1, 1, 1, 0, 0], [0] * 7, [1] * 7], np.bool_)
    assert outer_runs(rows).tolist() == [
        *([3, 0, 2, 6, 7], [1, 2, 5, 2, 5]),
        *([0, 0, 0, 0, 0], [1, 0, 7, 0, 7]),
    ]


@pytest.mark.parametrize("seed", range(5))
def test_a_line_is_that_of_least_squared_distances(seed: int) -> None:
    """T14, against the singular vectors of the centred curve."""
    curve = bent(20.0, seed, noise_px=3.0)
    _, _, axes = np.linalg.svd(curve - curve.mean(axis=0))
    along_deg = np.degrees(np.arctan2(-axes[0, 1], axes[0, 0]))
    assert min(turn_deg(line_angle_deg(curve), along_deg + half) for half in (0.0, 180.0)) < 1e-9


@pytest.mark.parametrize(
    ("merged", "crossed"),
    [
        ([True, True, False, False], True),
        ([False, False, False], False),
        ([True, True, True], False),
        ([False, True, False], False),
        ([True, False, True, False], False),
        ([], False),
    ],
    ids=["one then two", "two", "one", "two, one, two", "bridged", "nothing"],
)
def test_legs_cross_where_one_run_becomes_two(merged: list[bool], crossed: bool) -> None:
    """T17, algorithm 5 as printed, with what it misses."""
    assert knees_crossed(merged) is crossed


def test_curves_of_drawn_limbs_have_the_angles_that_were_drawn() -> None:
    """T14: the middles of arms, cut where the trunk begins, and of lower legs."""
    pose = standing(100.0, 120.0, 180.0)
    pose[ANGLE + 6], pose[ANGLE + 8] = 235.0, 235.0
    pose[ANGLE + 4], pose[ANGLE + 5] = 262.0, 281.0
    mask = draw_stick(THESIS, pose, (220, 240))
    curve = arm_curve(mask, (79, 121, 72), 62, 0)
    found = arm_angles(curve, DEFAULT)
    assert found.corner == -1
    assert found.upper == pytest.approx(235.0, abs=6.0)
    left, right, merged = lower_leg_curves(mask, 175, 215)
    assert line_angle_deg(left) == pytest.approx(262.0, abs=2.0)
    assert line_angle_deg(right) == pytest.approx(281.0, abs=2.0)
    assert not any(merged[3:])


def test_a_raised_arm_is_read_from_the_shoulder_on() -> None:
    """T14: curves run from the trunk outwards."""
    pose = standing(100.0, 120.0, 180.0)
    pose[ANGLE + 7] = pose[ANGLE + 9] = 60.0
    mask = draw_stick(THESIS, pose, (220, 240))
    found = arm_angles(arm_curve(mask, (79, 121, 72), 62, 1), DEFAULT)
    assert found.lower == pytest.approx(60.0, abs=6.0)
