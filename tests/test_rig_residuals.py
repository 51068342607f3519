"""What makes a rig unlikely, held against persons set up by hand."""

import math

import numpy as np
import pytest

from integrator.selfcalibration import person_prior as prior
from integrator.selfcalibration.joint_tracks import JointTrack
from integrator.selfcalibration.rig_evidence import Known
from integrator.selfcalibration.rig_guess import BODY, PLACE
from integrator.selfcalibration.rig_residuals import (
    ALL_WAYS,
    BEHIND,
    UPRIGHT_DEG,
    Explained,
    data_misfits,
    facing_misfits,
    facing_off_deg,
    prior_misfits,
    softened,
    standing_misfits,
)
from integrator.selfcalibration.rig_starts import known_of
from integrator.selfcalibration.sight_lines import Meeting, Numbers


def standing(headings_deg: Numbers, lean_deg: float) -> Explained:
    """Who stands there leaning towards the world's x, whichever way they face."""
    points = np.zeros((len(headings_deg), 15, 3))
    points[:, prior.ANKLES, 1] = 0.05
    points[:, prior.NECK] = 0.05 * np.array([0.0, 1.0, 0.0])
    lean = math.radians(lean_deg)
    points[:, prior.NECK] += 1.4 * np.array([math.sin(lean), math.cos(lean), 0.0])
    turn = np.radians(headings_deg)
    across = np.stack([np.cos(turn), np.zeros(len(turn)), -np.sin(turn)], axis=1)
    for joint, side in zip(prior.SHOULDERS, (0.2, -0.2), strict=True):
        points[:, joint] += side * across
    seen = np.ones(points.shape[:2], bool)
    nothing = np.zeros(seen.shape)
    met = Meeting(points, np.zeros((3, *points.shape)), nothing[None], nothing, nothing, seen)
    return Explained(met, seen, nothing, seen, None)  # type: ignore[arg-type]


def test_who_faces_one_way_may_lean_by_a_habit() -> None:
    lean = standing_misfits(standing(np.zeros(40), 3.0), 1.75)[1]
    assert lean == pytest.approx([3.0 / UPRIGHT_DEG, 0.0], abs=1e-2)


def test_who_faces_all_ways_and_leans_one_way_shows_a_vertical_that_is_wrong() -> None:
    all_round = np.linspace(0.0, 351.0, 40)
    lean = standing_misfits(standing(all_round, 3.0), 1.75)[1]
    assert lean == pytest.approx([3.0 / (UPRIGHT_DEG * ALL_WAYS), 0.0], abs=1e-2)


def test_who_turns_to_and_fro_between_two_sides_is_between_both() -> None:
    lean = standing_misfits(standing(np.tile([-60.0, 60.0], 20), 3.0), 1.75)[1]
    assert lean[0] == pytest.approx(3.0 / (UPRIGHT_DEG * math.hypot(0.5, ALL_WAYS)), rel=1e-3)


def met_anywhere(n: int = 4) -> Explained:
    """Sight lines that meet, segments as long as they should be, before both cameras."""
    zeros, seen = np.zeros((n, 15)), np.ones((n, 15), bool)
    before = seen.copy()
    met = Meeting(
        np.zeros((n, 15, 3)),
        np.zeros((3, n, 15, 3)),
        np.zeros((3, n, 15)),
        zeros,
        zeros.copy(),
        before,
    )
    lengths = np.zeros((n, len(prior.ENDS)))
    return Explained(met, seen, lengths, np.ones(lengths.shape, bool), None)  # type: ignore[arg-type]


def test_a_far_miss_says_that_it_is_wrong_and_no_more() -> None:
    """Cauchy's loss: 2 ln(1 + r^2 / 2)."""
    soft = softened(np.array([0.01, -1.0, 100.0]))
    assert soft**2 == pytest.approx(2.0 * np.log(1.0 + np.array([0.01, 1.0, 100.0]) ** 2 / 2.0))
    assert np.sign(soft).tolist() == [1.0, -1.0, 1.0]


def test_landmarks_that_err_alike_count_by_their_share_and_what_is_unseen_by_a_sigma() -> None:
    one = met_anywhere()
    one.met.gap[0, 3] = 2.0
    one.met.before[1, 4] = False
    one.used[2, 5] = False
    one.lengths[3, 6] = -3.0
    one.lengths_used[3, 7] = False
    gaps, lengths = (part.reshape(4, -1) for part in data_misfits(one, 0.25))
    expected = np.zeros((4, 15))
    expected[0, 3], expected[1, 4], expected[2, 5] = softened(np.array([2.0, BEHIND, 1.0]))
    assert gaps == pytest.approx(0.5 * expected)
    expected = np.zeros(lengths.shape)
    expected[3, 6], expected[3, 7] = softened(np.array([-3.0, 1.0]))
    assert lengths == pytest.approx(0.5 * expected)


@pytest.mark.parametrize(("frames", "few"), [(3, 1.0), (24, 0.5)])
def test_the_lower_foot_stands_on_the_floor_in_six_frames_of_all(frames: int, few: float) -> None:
    one = standing(np.zeros(frames), 0.0)
    one.met.points_m[:, prior.ANKLES, 1] = [0.05 * 1.75 + 0.04, 0.5]
    above = standing_misfits(one, 1.75)[0]
    assert above == pytest.approx(few * softened(np.full(frames, 2.0)))
    one.used[0, prior.ANKLES[0]] = False
    assert standing_misfits(one, 1.75)[0][0] > above[0], "the other foot then"
    one.used[0, prior.ANKLES[1]] = False
    assert standing_misfits(one, 1.75)[0][0] == 0.0


def a_rig(yaw_deg: float = -90.0) -> tuple[Numbers, Known]:
    """What is believed of a rig, and that rig with camera 2 at a yaw."""
    known = known_of(320, 1.75, 1)
    guess = known.mean.copy()
    guess[PLACE["yaw_2"]] = math.radians(yaw_deg)
    high = float(np.exp(guess[BODY])[prior.UPRIGHT].sum())
    guess[BODY] += math.log(1.75 * prior.CROWN_SHARE / high)
    return guess, known


@pytest.mark.parametrize(
    ("name", "off", "sigmas"),
    [("height_1", 0.6, 1.0), ("log_focal_2", 0.3, 1.0), ("height_2", -1.2, -2.0)],
)
def test_what_is_believed_of_a_rig_is_told_in_sigmas(name: str, off: float, sigmas: float) -> None:
    guess, known = a_rig()
    before = prior_misfits(guess, known)[0]
    guess[PLACE[name]] += off
    after = prior_misfits(guess, known)[0]
    assert sorted((after - before)[np.abs(after - before) > 1e-9]) == pytest.approx([sigmas])


def test_what_is_mostly_so_is_softened_and_lenses_are_mostly_alike() -> None:
    guess, known = a_rig()
    assert prior_misfits(guess, known)[1] == pytest.approx(np.zeros(6))
    guess[PLACE["pitch_2"]] = math.radians(12.0)
    guess[PLACE["log_focal_1"]] += 0.6
    soft = prior_misfits(guess, known)[1]
    assert sorted(soft) == pytest.approx(sorted([*np.zeros(4), *softened(np.array([2.0, 2.0]))]))
    assert soft[-1] == pytest.approx(softened(np.array([2.0]))[0])


def test_the_person_is_as_tall_as_is_said_and_camera_2_on_the_left() -> None:
    """A hundredth of a logarithm is a sigma; to the right costs 2.45 of them."""
    stature, right = prior_misfits(*a_rig(-90.0))[2]
    assert stature == pytest.approx(0.0, abs=1e-9)
    assert right == pytest.approx(0.0, abs=1e-3)
    guess, known = a_rig(90.0)
    assert prior_misfits(guess, known)[2][1] == pytest.approx(2.45, abs=1e-3)
    guess, known = a_rig(0.0)
    guess[BODY] += 0.02
    stature, right = prior_misfits(guess, known)[2]
    assert stature == pytest.approx(2.0)
    assert right == pytest.approx(2.45 / 2)


@pytest.mark.parametrize(
    ("off_deg", "sure", "misfit"),
    [
        (0.0, 0.9, 0.0),
        (60.0, 0.9, 2.0 * math.sin(math.radians(30.0)) / math.radians(20.0)),
        (180.0, 0.85, 2.0 / math.radians(20.0)),
        (60.0, 0.725, 0.5 * 2.0 * math.sin(math.radians(30.0)) / math.radians(20.0)),
        (60.0, 0.6, 0.0),
    ],
)
def test_views_that_see_a_person_face_other_ways_disagree_as_surely_as_both_are(
    off_deg: float, sure: float, misfit: float
) -> None:
    """Camera 1 is before the person, camera 2 at the left: at 90 degrees to the right for it."""
    guess, _ = a_rig()
    guess[PLACE["x_2"]], guess[PLACE["z_2"]] = 3.0, -3.0
    one = met_anywhere(16)
    one.met.points_m[:, prior.PELVIS] = (0.0, 1.0, -3.0)
    first = facings(0.0, sure, 16)
    one = one._replace(second=facings(-90.0 + off_deg, min(1.0, sure + 0.1), 16))
    found = facing_misfits(guess, one, first)
    soft = softened(np.array([misfit if sure >= 0.85 else 2 * misfit]))[0]
    weight = math.sqrt(8.0 / 16) * (1.0 if sure >= 0.85 else (0.5 if sure > 0.7 else 0.0))
    assert np.abs(found) == pytest.approx(np.full(16, weight * soft), abs=1e-6)
    told = facing_off_deg(guess, one, first)
    assert told == pytest.approx(off_deg if sure > 0.85 else 0.0, abs=1e-6)


def facings(facing_deg: float, sure: float, n: int) -> JointTrack:
    zeros = np.zeros((n, 15))
    return JointTrack(
        np.arange(n) / 15,
        np.zeros((n, 15, 2)),
        zeros,
        np.full(n, facing_deg),
        np.full(n, sure),
    )


def test_of_few_moments_nothing_is_told_of_facings() -> None:
    guess, _ = a_rig()
    one = met_anywhere(11)._replace(second=facings(120.0, 0.95, 11))
    assert facing_off_deg(guess, one, facings(0.0, 0.95, 11)) == 0.0
