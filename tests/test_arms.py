"""Arm angles, held against arms drawn at known ones and the paper's ranges (section 3.3)."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posing import BODY, angle, laid_over, picture, posed

import viewer.paper.posed_model
from common.body.body import LIMBS, POSE_INDEX, Vector
from common.body.kinematics import segments
from common.config.part_settings import SearchSettings
from common.method import DEFAULT, PAPER, Method
from viewer.paper.arms import facade_arms, flank_arms, inward_limit_deg

PAPERS = SearchSettings()
FINE = SearchSettings(stop_deg=1)


def arm(side: str, outward_deg: float, elbow_deg: float) -> dict[str, float]:
    """An arm raised so far from hanging, bent outwards (+) or inwards (-), as its angles."""
    sign = 1.0 if side == "r" else -1.0
    return {
        f"{side}_shoulder_z": 180.0 - sign * outward_deg,
        f"{side}_shoulder_y": sign * math.copysign(90.0, elbow_deg),
        f"{side}_elbow_x": abs(elbow_deg),
    }


def ends(pose: Vector, limb: str) -> Vector:
    return np.asarray(segments(BODY, pose)[LIMBS.index(limb)])


def within_range(pose: Vector, side: str) -> bool:
    """Ranges of P30 and P31, the anatomical sign of flexion included."""
    z, y, elbow = (
        pose[POSE_INDEX[f"{side}_{name}"]] for name in ("shoulder_z", "shoulder_y", "elbow_x")
    )
    low, high = (0.0, 180.0) if side == "r" else (180.0, 360.0)
    outward = y == (90.0 if side == "r" else -90.0)
    most = 140.0 if outward else inward_limit_deg(side, z)
    return bool(low <= z <= high and abs(y) == 90.0 and 0.0 <= elbow <= most + 0.5)


@pytest.mark.parametrize(
    ("side", "shoulder_z_deg", "limit_deg"),
    [
        ("r", 170, 20),
        ("r", 140, 80),
        ("r", 110, 140),
        ("r", 30, 140),
        ("l", 190, 20),
        ("l", 220, 80),
        ("l", 250, 140),
        ("l", 330, 140),
    ],
)
def test_the_inward_limit_is_the_papers(side: str, shoulder_z_deg: float, limit_deg: float) -> None:
    """P31: th_a = 2 (180 - theta_Z) beyond 110, else 140; the left arm mirrored."""
    assert inward_limit_deg(side, shoulder_z_deg) == limit_deg


@pytest.mark.parametrize(("side", "at_deg"), [("r", 110.0), ("l", 250.0)])
def test_the_inward_limit_has_no_step(side: str, at_deg: float) -> None:
    """P31: continuous at 110 degrees, where both branches say 140."""
    around = [inward_limit_deg(side, at_deg + off) for off in (-1e-6, 0.0, 1e-6)]
    assert around == pytest.approx([140.0] * 3, abs=1e-5)


@given(st.floats(111.0, 179.0))
def test_at_the_inward_limit_the_wrist_is_on_the_vertical_through_the_shoulder(
    shoulder_z_deg: float,
) -> None:
    """P31, M6: for halves of equal length, and both signs of theta_Y."""
    body = BODY.copy()
    body[[19, 23]] = 0.17  # upper and lower right arm
    limit = inward_limit_deg("r", shoulder_z_deg)
    for y_deg, elbow_deg in ((90.0, -limit), (-90.0, limit)):
        pose = posed(r_shoulder_z=shoulder_z_deg, r_shoulder_y=y_deg, r_elbow_x=elbow_deg)
        limbs = segments(body, pose)
        shoulder, wrist = limbs[LIMBS.index("r_upper_arm"), 0], limbs[LIMBS.index("r_lower_arm"), 1]
        assert wrist[0] == pytest.approx(shoulder[0], abs=1e-12)


GRID = list(product([70.0, 95.0, 120.0, 150.0], [-60.0, -30.0, 0.0, 30.0, 60.0, 100.0]))


def off_deg(truth: Vector, found: Vector, limb: str) -> float:
    """Angle between a limb and what was found of it."""
    one, other = (np.diff(ends(pose, limb), axis=0)[0] for pose in (truth, found))
    cos = float(one @ other) / float(np.linalg.norm(one) * np.linalg.norm(other))
    return math.degrees(math.acos(min(1.0, cos)))


@pytest.mark.parametrize("side", ["r", "l"])
@pytest.mark.parametrize(("search", "worst", "mean"), [(FINE, 4.0, 2.0), (PAPERS, 6.0, 1.5)])
def test_a_grid_of_shoulders_and_elbows_is_found_again(
    side: str, search: SearchSettings, worst: float, mean: float
) -> None:
    """P30, P31: within 4 degrees and never beyond a range, from 4 degrees off at both joints.

    So it is with steps of a degree. With the printed stop of 4 the joint that is searched first
    takes on some of the other's error: up to 6.
    """
    errors = []
    for outward, elbow in GRID:
        truth = posed(**arm(side, outward, elbow))
        start = posed(**arm(side, outward + 4.0, elbow + math.copysign(4.0, elbow)))
        model = laid_over(picture(truth), start)
        for _ in range(2):
            model = facade_arms(model, search, wide=False, method=PAPER)
            assert within_range(model.pose, side)
        for limb in ("upper_arm", "lower_arm"):
            errors.append(off_deg(truth, model.pose, f"{side}_{limb}"))
    assert max(errors) <= worst + 1e-6
    assert np.mean(errors) <= mean


@pytest.mark.parametrize("side", ["r", "l"])
@pytest.mark.parametrize("outward_deg", [20.0, 60.0, 100.0, 160.0])
def test_a_straight_arm_is_found_wherever_it_was(side: str, outward_deg: float) -> None:
    """P30, `wide`: nothing is known of the angle."""
    model = laid_over(picture(posed(**arm(side, outward_deg, 0.0))), posed())
    found = facade_arms(model, PAPERS, wide=True, method=PAPER)
    off = angle(found, f"{side}_shoulder_z") - arm(side, outward_deg, 0.0)[f"{side}_shoulder_z"]
    assert abs(off) <= 4.0


@given(st.floats(0.0, 180.0), st.floats(-140.0, 140.0), st.sampled_from([-90.0, 90.0]))
def test_no_pose_is_ever_beyond_a_range(z_deg: float, elbow_deg: float, y_deg: float) -> None:
    """P30, P31: whatever the start, and whatever is seen."""
    start = posed(r_shoulder_z=z_deg, r_shoulder_y=y_deg, r_elbow_x=elbow_deg)
    seen = picture(posed(r_shoulder_z=140.0, l_shoulder_z=200.0, l_elbow_x=70.0))
    found = facade_arms(laid_over(seen, start), PAPERS, wide=False, method=PAPER)
    assert within_range(found.pose, "r")
    assert within_range(found.pose, "l")


def test_the_facade_leaves_theta_x_alone() -> None:
    """P30."""
    start = posed(r_shoulder_x=17.0, l_shoulder_x=-5.0)
    found = facade_arms(
        laid_over(picture(posed(r_shoulder_z=100.0)), start), PAPERS, wide=False, method=PAPER
    )
    assert angle(found, "r_shoulder_x") == 17.0
    assert angle(found, "l_shoulder_x") == -5.0


def test_the_facades_search_is_the_shoulder_then_the_elbow_right_then_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """P31, P41: windows of 64 degrees down to 4, and the elbow's range follows the shoulder."""
    calls = []

    def recorded(model, how, within):  # type: ignore[no-untyped-def]
        calls.append((how.at, *within[:3]))
        return viewer.paper.posed_model.searched(model, how, within)

    monkeypatch.setattr("viewer.paper.arms.searched", recorded)
    seen = picture(posed(r_shoulder_z=150.0, l_shoulder_z=210.0))
    found = facade_arms(
        laid_over(seen, posed(r_shoulder_z=150.0)), PAPERS, wide=False, method=PAPER
    )
    order = ["r_shoulder_z", "r_elbow_x", "l_shoulder_z", "l_elbow_x"]
    assert [call[0] for call in calls] == [POSE_INDEX[name] for name in order]
    assert {call[1:3] for call in calls} == {(64, 4)}
    th_a = 2 * (180.0 - angle(found, "r_shoulder_z"))
    assert [call[3] for call in calls[:2]] == [(0.0, 180.0), (-th_a, 140.0)]


@pytest.mark.parametrize("swing_deg", [-40.0, 25.0, 90.0, 150.0])
def test_a_common_swing_is_found_in_the_flank(swing_deg: float) -> None:
    """P32: one silhouette, both arms."""
    seen = picture(posed(r_shoulder_x=swing_deg, l_shoulder_x=swing_deg), viewer=2)
    start = posed(r_shoulder_x=swing_deg - 20.0, l_shoulder_x=swing_deg - 20.0)
    found = flank_arms(laid_over(seen, start, viewer=2), PAPERS, near=0, wide=False, method=PAPER)
    for side in "rl":
        assert angle(found, f"{side}_shoulder_x") == pytest.approx(swing_deg, abs=4.0)
    wide = flank_arms(laid_over(seen, posed(), viewer=2), PAPERS, near=0, wide=True, method=PAPER)
    assert angle(wide, "r_shoulder_x") == pytest.approx(swing_deg, abs=4.0)


def test_opposite_swings_are_told_apart_in_the_flank() -> None:
    """P32: one arm forward, one back, from 5 degrees off: beside the trunk a peak is narrow."""
    seen = picture(posed(r_shoulder_x=40.0, l_shoulder_x=-40.0), viewer=2)
    start = posed(r_shoulder_x=35.0, l_shoulder_x=-35.0)
    found = flank_arms(laid_over(seen, start, viewer=2), PAPERS, near=0, wide=False, method=PAPER)
    assert angle(found, "r_shoulder_x") == pytest.approx(40.0, abs=4.0)
    assert angle(found, "l_shoulder_x") == pytest.approx(-40.0, abs=4.0)


def test_a_tie_is_a_common_swing() -> None:
    """P32: an empty picture explains nothing."""
    nobody = np.zeros((120, 160), np.bool_)
    start = posed(r_shoulder_x=10.0, l_shoulder_x=40.0)
    found = flank_arms(laid_over(nobody, start, viewer=2), PAPERS, near=0, wide=False, method=PAPER)
    assert angle(found, "r_shoulder_x") == angle(found, "l_shoulder_x")


def test_the_flank_has_one_angle_an_arm() -> None:
    """P30: theta_Z, theta_Y and the elbow keep their values there."""
    start = posed(r_shoulder_z=170.0, r_elbow_x=30.0)
    seen = picture(posed(r_shoulder_x=40.0), viewer=2)
    found = flank_arms(laid_over(seen, start, viewer=2), PAPERS, near=0, wide=False, method=PAPER)
    changed = {name for name, i in POSE_INDEX.items() if found.pose[i] != start[i]}
    assert changed <= {"r_shoulder_x", "l_shoulder_x"}


def test_an_arm_is_followed_round_the_circle() -> None:
    """P30: the printed range is a whole turn, whose ends are one pose: where an arm points up."""
    model = laid_over(picture(posed(), viewer=2), posed(), viewer=2)
    for swing_deg in range(20, 361, 20):
        truth = posed(r_shoulder_x=float(swing_deg), l_shoulder_x=float(swing_deg))
        model = laid_over(picture(truth, viewer=2), model.pose, viewer=2)
        model = flank_arms(model, PAPERS, near=0, wide=False, method=PAPER)
        off = math.remainder(angle(model, "r_shoulder_x") - swing_deg, 360.0)
        assert abs(off) <= 8.0
        assert -180.0 < angle(model, "r_shoulder_x") <= 180.0


@pytest.mark.parametrize(("method", "stays"), [(DEFAULT, True), (PAPER, False)])
def test_a_hidden_arm_stays_but_as_printed_follows_every_pixel(method: Method, stays: bool) -> None:
    """P32: five pixels beside the trunk are no arm; the print takes the best score, whatever it
    gains."""
    seen, raised = (
        picture(posed(r_shoulder_x=x_deg, l_shoulder_x=x_deg), 2) for x_deg in (0.0, 8.0)
    )
    for y, x in np.argwhere(raised & ~seen)[:5]:
        seen[y, x] = True
    found = flank_arms(laid_over(seen, posed(), 2), PAPERS, near=0, wide=False, method=method)
    assert ([angle(found, f"{side}_shoulder_x") for side in "rl"] == [0.0, 0.0]) == stays


@pytest.mark.parametrize("side", ["r", "l"])
def test_an_arm_swung_up_forwards_still_leans_outwards_but_not_as_printed(side: str) -> None:
    """P30: at theta_X = 180 the arm points up, and outwards is beyond theta_Z = 180, where the
    printed range ends."""
    outward = 25.0 if side == "r" else -25.0
    name = f"{side}_shoulder_z"
    truth = posed(**{f"{side}_shoulder_x": 180.0, name: 180.0 + outward})
    assert (ends(truth, f"{side}_upper_arm")[1][0] < ends(truth, f"{side}_upper_arm")[0][0]) == (
        side == "r"
    )
    start = posed(**{f"{side}_shoulder_x": 180.0, name: 180.0 + outward / 2})
    model = laid_over(picture(truth), start)
    found = facade_arms(model, PAPERS, wide=False, method=DEFAULT)
    assert angle(found, name) == pytest.approx(180.0 + outward, abs=4.0)
    printed = angle(facade_arms(model, PAPERS, wide=False, method=PAPER), name)
    assert (printed <= 180.0) if side == "r" else (printed >= 180.0)


def test_matches_of_the_flanks_arms_are_counted_once() -> None:
    """The start, two searches apart, and the common swing with its own start."""
    seen = picture(posed(r_shoulder_x=40.0, l_shoulder_x=-20.0), viewer=2)
    counts = []
    for before in (0, 1000):
        model = laid_over(seen, posed(), 2)._replace(matches=before)
        found = flank_arms(model, PAPERS, near=1, wide=False, method=PAPER)
        counts.append(found.matches - before)
    assert counts[0] == counts[1]
    assert 1 + 2 * 6 + 1 + 6 <= counts[0] <= 1 + 2 * 9 + 1 + 9
