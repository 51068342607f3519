"""The thesis's stages, each held against drawn bodies that it alone can find (T11-T18)."""

import numpy as np
import pytest
from stick_posing import STATURE_PX, drawn, stick_pose

from common.body.body import LIMBS, Vector
from common.body.stick_body import ANGLE, THESIS, X
from common.method import METHODS
from viewer.paper.tritree import Found
from viewer.stick import thesis_fit
from viewer.stick.stick_fit import Stick, fit
from viewer.stick.thesis_fit import fit_thesis

ARMS_OUT = {
    **{"r_upper_arm": 225.0, "r_lower_arm": 225.0},
    **{"l_upper_arm": 315.0, "l_lower_arm": 315.0},
}
APART = {
    **{"r_upper_leg": 255.0, "r_lower_leg": 255.0},
    **{"l_upper_leg": 285.0, "l_lower_leg": 285.0},
}


def found(pose: Vector) -> Stick:
    """What the thesis's stages make of a drawn body."""
    return fit(drawn(pose, THESIS), None, STATURE_PX, METHODS["thesis"])


def angle_deg(pose: Vector, limb: str) -> float:
    return float(pose[ANGLE + LIMBS.index(limb)])


@pytest.mark.parametrize(
    ("turned_deg", "limbs", "within_deg"),
    [
        ({"head": 110.0}, ("head",), 5.0),
        ({"head": 72.0}, ("head",), 5.0),
        ({"torso": 100.0, "head": 100.0}, ("torso", "head"), 6.0),
        ({"torso": 78.0, "head": 78.0}, ("torso", "head"), 8.0),
        (
            {
                "r_upper_leg": 250.0,
                "r_lower_leg": 265.0,
                "l_upper_leg": 290.0,
                "l_lower_leg": 275.0,
            },
            ("r_upper_leg", "l_upper_leg"),
            2.0,
        ),
        (APART, ("r_upper_leg", "l_upper_leg"), 2.0),
    ],
    ids=["head left", "head right", "trunk left", "trunk right", "knees bent", "legs apart"],
)
def test_algorithm_1_turns_trunk_head_and_upper_legs(
    turned_deg: dict[str, float], limbs: tuple[str, ...], within_deg: float
) -> None:
    """T11, T12: 10 to 20 degrees from a standing body, which is what is left without it."""
    pose = stick_pose(ARMS_OUT | turned_deg)
    stick = found(pose)
    for limb in limbs:
        assert angle_deg(stick.pose, limb) == pytest.approx(angle_deg(pose, limb), abs=within_deg)


@pytest.mark.parametrize(
    ("turned_deg", "limbs", "within_deg"),
    [
        ({}, ("r_upper_arm", "l_upper_arm"), 5.0),
        ({"r_lower_arm": 190.0, "l_lower_arm": 340.0}, ("r_lower_arm", "l_lower_arm"), 15.0),
        (APART, ("r_lower_leg", "l_lower_leg"), 4.0),
        ({"r_lower_leg": 255.0, "l_lower_leg": 288.0}, ("r_lower_leg", "l_lower_leg"), 5.0),
    ],
    ids=["arms out", "elbows", "legs apart", "one knee more than the other"],
)
def test_algorithm_2_reads_arms_and_lower_legs_off_the_contour(
    turned_deg: dict[str, float], limbs: tuple[str, ...], within_deg: float
) -> None:
    """T11, T14: 15 to 80 degrees from a standing body, which is what is left without it."""
    pose = stick_pose(ARMS_OUT | turned_deg)
    stick = found(pose)
    for limb in limbs:
        assert angle_deg(stick.pose, limb) == pytest.approx(angle_deg(pose, limb), abs=within_deg)


@pytest.mark.parametrize("ratio", [0.4, 0.6, 0.8, 1.0])
def test_algorithm_6_shortens_lower_legs(ratio: float) -> None:
    """T11, T18: within 4 hundredths; without it every segment is in the plane."""
    short = {"r_lower_leg": ratio, "l_lower_leg": ratio}
    stick = found(stick_pose(ARMS_OUT | APART, short))
    ratios = stick.ratios[[LIMBS.index(limb) for limb in short]]
    assert ratios == pytest.approx([ratio, ratio], abs=0.04)


@pytest.mark.parametrize("out", [("r_upper_arm", "r_lower_arm"), ("l_upper_arm", "l_lower_arm")])
@pytest.mark.parametrize("raised_deg", [0.0, 25.0])
def test_one_arm_that_is_stretched_out_does_not_move_the_trunk(
    out: tuple[str, ...], raised_deg: float
) -> None:
    """T11: within two pixels, where the middle of the whole silhouette is 27 off."""
    outwards_deg = 180.0 - raised_deg if out[0].startswith("r") else raised_deg
    pose = stick_pose(dict.fromkeys(out, outwards_deg))
    columns = np.flatnonzero(drawn(pose, THESIS).any(axis=0))
    assert abs((columns[0] + columns[-1] + 1) / 2 - pose[X]) > 20.0
    assert found(pose).pose[X] == pytest.approx(pose[X], abs=2.0)


def test_every_match_of_the_stages_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """T11: trunk, neck and both hips are turned, ten limbs are shortened."""
    monkeypatch.setattr(thesis_fit, "angle_found", lambda *_: Found(90.0, 0.5, 100))
    monkeypatch.setattr(thesis_fit, "ratio_found", lambda *_: Found(0.7, 0.5, 1))
    found = fit_thesis(drawn(stick_pose({}), THESIS), STATURE_PX, METHODS["thesis"])
    assert found.evaluations == 4 * 100 + 10


@pytest.mark.parametrize(
    ("right", "left", "legs", "hidden"),
    [
        (False, True, True, ("r_upper_arm", "r_lower_arm")),
        (True, False, True, ("l_upper_arm", "l_lower_arm")),
        (True, True, False, ("r_lower_leg", "l_lower_leg")),
    ],
)
def test_what_has_no_curve_is_hidden(
    monkeypatch: pytest.MonkeyPatch, right: bool, left: bool, legs: bool, hidden: tuple[str, ...]
) -> None:
    """T26: an arm with both its halves; both lower legs at once."""
    monkeypatch.setattr(thesis_fit, "_arm", lambda _fit, _mask, side: (right, left)[side])
    monkeypatch.setattr(thesis_fit, "_lower_legs", lambda *_: legs)
    found = fit_thesis(drawn(stick_pose({}), THESIS), STATURE_PX, METHODS["thesis"])
    assert {limb for limb, is_so in zip(LIMBS, found.hidden, strict=True) if is_so} == set(hidden)


@pytest.mark.parametrize("crossed", [False, True])
def test_crossed_lower_legs_change_places(monkeypatch: pytest.MonkeyPatch, crossed: bool) -> None:
    """T17: the curve on the left of the picture is then the other leg's."""
    monkeypatch.setattr(thesis_fit, "knees_crossed", lambda _: crossed)
    pose = stick_pose(APART | {"r_lower_leg": 262.0, "l_lower_leg": 276.0})
    stick = found(pose)
    legs = [angle_deg(stick.pose, f"{side}_lower_leg") for side in ("lr" if crossed else "rl")]
    assert legs == pytest.approx([262.0, 276.0], abs=4.0)


def test_stages_come_in_the_order_of_the_print(monkeypatch: pytest.MonkeyPatch) -> None:
    """T11: trunk with head, head; then of each side the leg is turned, leg and arm shortened."""
    done: list[tuple[int, ...]] = []
    monkeypatch.setattr(thesis_fit, "_turned", lambda _fit, limbs, _limits: done.append(limbs))
    monkeypatch.setattr(thesis_fit, "_shortened", lambda _fit, limb: done.append((limb,)))
    fit_thesis(drawn(stick_pose({}), THESIS), STATURE_PX, METHODS["thesis"])
    upright = [(0, 1), (0,), (1,), (1,)]
    right, left = [(2, 4), (2,), (4,), (6,), (8,)], [(3, 5), (3,), (5,), (7,), (9,)]
    assert done == upright + right + left
