"""Leg angles, held against legs drawn at known ones (section 3.4)."""

import numpy as np
import pytest
from posing import BODY, SIZE, angle, laid_over, picture, posed

from common.body.body import LIMBS, POSE_INDEX, POSE_NAMES
from common.body.kinematics import segments
from common.body.proportions import body_vector, thesis_bdp
from common.config.part_settings import SearchSettings
from common.method import DEFAULT, PAPER, Method
from viewer.paper.legs import facade_legs, flank_legs, squats
from viewer.paper.posed_model import searched

PAPERS = SearchSettings()


def over_time(drops: list[float]) -> list[bool]:
    states, state = [], False
    for drop in drops:
        state = squats(state, drop)
        states.append(state)
    return states


def test_the_bob_of_walking_is_no_squat_and_a_tenth_of_the_height_is() -> None:
    """P33: 2-3 % of the height while walking; a 10 % squat starts and ends once."""
    bob = 0.03 * np.sin(np.linspace(0, 20, 100))
    assert not any(over_time(bob.tolist()))
    squat = over_time((0.10 * np.sin(np.linspace(0, np.pi, 40))).tolist())
    assert squat[20]
    assert np.abs(np.diff(np.array(squat, int))).sum() == 2


def test_squatting_has_a_hysteresis() -> None:
    """P33: begins beyond 4 % of the height, ends below 2.5 %."""
    assert (
        over_time([0.039, 0.041, 0.03, 0.026, 0.024, 0.03])
        == [False, True, True, True] + [False] * 2
    )


@pytest.mark.parametrize(
    ("right_deg", "left_deg"), [(180, 180), (160, 200), (130, 184), (172, 240)]
)
def test_standing_legs_are_found_in_the_facade(right_deg: float, left_deg: float) -> None:
    """P33: theta_Z of both hips alone, from 14 degrees off (the window reaches 16, P41)."""
    seen = picture(posed(r_hip_z=right_deg, l_hip_z=left_deg))
    start = posed(r_hip_z=right_deg - 14.0, l_hip_z=left_deg + 14.0)
    model = laid_over(seen, start)
    for _ in range(2):
        model = facade_legs(model, PAPERS, squatting=False)
    assert angle(model, "r_hip_z") == pytest.approx(right_deg, abs=4.0)
    assert angle(model, "l_hip_z") == pytest.approx(left_deg, abs=4.0)
    changed = {name for name, i in POSE_INDEX.items() if model.pose[i] != start[i]}
    assert changed <= {"r_hip_z", "l_hip_z"}


def squat(hip_deg: float) -> np.ndarray:
    return posed(r_hip_x=hip_deg, l_hip_x=hip_deg, r_knee_x=-2 * hip_deg, l_knee_x=-2 * hip_deg)


@pytest.mark.parametrize("hip_deg", range(25, 61, 5))
def test_squats_are_found_in_the_facade_with_the_feet_under_the_hips(hip_deg: float) -> None:
    """P34, C6: knee = -2 hip; one search a leg, from 12 degrees off.

    From 25 degrees on: below, the navel drops by less than 4 % and nobody squats (P33); of 10
    degrees the facade shows less than a pixel.
    """
    model = laid_over(picture(squat(hip_deg)), squat(hip_deg - 12.0))
    model = facade_legs(model, PAPERS, squatting=True)
    for side in "rl":
        assert angle(model, f"{side}_hip_x") == pytest.approx(hip_deg, abs=4.0)
        assert angle(model, f"{side}_knee_x") == -2 * angle(model, f"{side}_hip_x")
        limbs = segments(BODY, model.pose)
        hip = limbs[LIMBS.index(f"{side}_upper_leg"), 0]
        foot = limbs[LIMBS.index(f"{side}_lower_leg"), 1]
        assert abs(hip[2] - foot[2]) <= 0.04


@pytest.mark.parametrize(("hip_deg", "squatting"), [(10.0, False), (20.0, False), (25.0, True)])
def test_a_squat_begins_between_20_and_25_degrees(hip_deg: float, squatting: bool) -> None:
    """P33: where the thesis's legs drop the navel by 4 % of the stature."""
    feet = [segments(BODY, pose)[4, 1, 1] for pose in (posed(), squat(hip_deg))]
    assert squats(False, feet[1] - feet[0]) == squatting


@pytest.mark.parametrize("speed_deg", [2.0, 4.0, 6.0])
def test_a_squat_down_and_up_is_followed_in_the_flank(speed_deg: float) -> None:
    """P35, P52: hips and knees free, both legs in one silhouette, 0 to 60 degrees and back.

    Beyond the print, which has each leg alone: see below.
    """
    down = np.arange(0.0, 61.0, speed_deg)
    model, errors = laid_over(picture(squat(0.0), 2), squat(0.0), 2), []
    for hip_deg in [*down, *down[::-1]]:
        seen = picture(squat(hip_deg), 2)
        model = flank_legs(laid_over(seen, model.pose, 2), PAPERS, near=0, method=DEFAULT)
        errors += [abs(angle(model, f"{side}_hip_x") - hip_deg) for side in "rl"]
    assert np.mean(errors) <= 1.5
    assert np.mean(np.array(errors) > 4.0) <= 0.05


@pytest.mark.parametrize(("method", "both"), [(DEFAULT, 1), (PAPER, 0)])
def test_the_flank_searches_hip_and_knee_of_each_leg_and_beyond_the_print_one_squat(
    method: Method, both: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P35, P41: the near leg first; both legs as one squat is a departure."""
    calls: list[tuple[str, ...]] = []

    def recorded(model, how, within):  # type: ignore[no-untyped-def]
        calls.append(tuple(POSE_NAMES[at] for at, _ in how.parts))
        return searched(model, how, within)

    monkeypatch.setattr("viewer.paper.legs.searched", recorded)
    flank_legs(laid_over(picture(squat(8.0), 2), posed(), 2), PAPERS, near=1, method=method)
    assert calls[:4] == [(name,) for name in ("l_hip_x", "l_knee_x", "r_hip_x", "r_knee_x")]
    assert calls[4:] == [("r_hip_x", "r_knee_x", "l_hip_x", "l_knee_x")] * both


def leg_lifted(side: str, hip_deg: float) -> np.ndarray:
    return posed(**{f"{side}_hip_x": hip_deg, f"{side}_knee_x": -0.8 * hip_deg})


@pytest.mark.parametrize("lifted", ["r", "l"])
def test_a_lifted_leg_is_followed_in_the_flank_and_taken_for_the_near_one(lifted: str) -> None:
    """P35, P52: thigh up to 50 degrees forward, the knee bent, 2 degrees a frame.

    Both hips lie at one place of the flank's silhouette, which cannot tell the legs apart.
    """
    model = laid_over(picture(posed(), 2), posed(), 2)
    for hip_deg in np.arange(0.0, 51.0, 2.0):
        seen = picture(leg_lifted(lifted, hip_deg), 2)
        model = flank_legs(laid_over(seen, model.pose, 2), PAPERS, near=0, method=PAPER)
        assert angle(model, "r_hip_x") == pytest.approx(hip_deg, abs=4.0)
        assert angle(model, "r_knee_x") == pytest.approx(-0.8 * hip_deg, abs=8.0)
        assert angle(model, "l_hip_x") == pytest.approx(0.0, abs=4.0)


def test_knees_bend_one_way_in_the_flank() -> None:
    """P35: the range of the knee is [-150, 0], whatever is seen."""
    seen = picture(posed(r_hip_x=-30.0, r_knee_x=40.0), 2)
    model = laid_over(seen, posed(r_hip_x=-20.0), 2)
    for _ in range(3):
        model = flank_legs(model, PAPERS, near=0, method=PAPER)
        assert -150.0 <= angle(model, "r_knee_x") <= 0.0


def test_a_squat_ends_where_the_knee_ends() -> None:
    """P34, P35: hip at most 75, where knee = -150."""
    body = body_vector(thesis_bdp(1.0))
    model = laid_over(np.zeros(SIZE[::-1], np.bool_), squat(74.0), body=body)
    model = facade_legs(model, PAPERS, squatting=True)
    for side in "rl":
        assert 0.0 <= angle(model, f"{side}_hip_x") <= 75.0
        assert -150.0 <= angle(model, f"{side}_knee_x") <= 0.0


def test_a_leg_window_reaches_sixteen_degrees_a_frame() -> None:
    """P41, L1: a kick of 30 degrees within a frame is caught up with in two."""
    seen = picture(posed(r_hip_x=30.0), 2)
    once = flank_legs(laid_over(seen, posed(), 2), PAPERS, near=0, method=PAPER)
    assert angle(once, "r_hip_x") <= 16.0
    twice = flank_legs(once, PAPERS, near=0, method=PAPER)
    assert angle(twice, "r_hip_x") == pytest.approx(30.0, abs=4.0)


def test_matches_of_the_flanks_legs_are_counted_once() -> None:
    """Four searches apart and one together, on top of what was matched before."""
    seen = picture(posed(r_hip_x=20.0), 2)
    counts = []
    for before in (0, 1000):
        model = laid_over(seen, posed(), 2)._replace(matches=before)
        counts.append(flank_legs(model, PAPERS, near=1, method=DEFAULT).matches - before)
        apart = flank_legs(model, PAPERS, near=1, method=PAPER).matches - before
        assert 4 * 5 <= apart <= 4 * 7
        assert 5 <= counts[-1] - apart <= 7
    assert counts[0] == counts[1]
