"""The search, held against the numbers that the paper prints (section 3.5)."""

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from posing import BODY, SIZE, laid_over, picture, posed, view

from common.body.body import LIMITS_DEG, POSE_INDEX
from common.body.kinematics import ARM_LIMBS
from common.raster.kernel import draw_body
from common.raster.similarity import similarity
from viewer.paper.posed_model import turn
from viewer.paper.tritree import Found, narrowed, search, tritree, window

ARM, LEG, STOP = 64, 32, 4
WIDTHS = pytest.mark.parametrize("width_deg", [ARM, LEG], ids=["arm", "leg"])

Score = Callable[[float], float]


def peak_at(target_deg: float) -> Score:
    return lambda angle_deg: -abs(angle_deg - target_deg)


def bell(target_deg: float, left_deg: float, right_deg: float) -> Score:
    """A peak with a standard deviation of its own on either side."""

    def score(angle_deg: float) -> float:
        spread = left_deg if angle_deg < target_deg else right_deg
        return float(np.exp(-(((angle_deg - target_deg) / spread) ** 2) / 2))

    return score


def full(score: Score, width_deg: int) -> float:
    """The exhaustive search that the paper compares with: every grid point of the window."""
    return max(range(0, width_deg + 1, STOP), key=score)


def searched_with(score: Score, width_deg: int) -> tuple[Found, list[float]]:
    """What a search found, and the angles that it asked for."""
    tried: list[float] = []

    def asked(angle_deg: float) -> float:
        tried.append(angle_deg)
        return score(angle_deg)

    return tritree(asked, (0, width_deg), STOP), tried


def matches_of_path(winners: tuple[int, ...], width_deg: int) -> int:
    """Matches of a search whose rounds are won by left (0), middle (1) or right (2) at will."""
    low, high, probes, matches = 0, width_deg, [np.nan] * 3, 0
    for winner in winners:
        matches += int(np.isnan(probes).sum())
        scores = [0.0, 0.0, 0.0]
        scores[winner] = 1.0
        low, high, *probes = narrowed(low, high, *scores)
    assert high - low == STOP
    return matches


@pytest.mark.parametrize(
    ("width_deg", "rounds", "paths", "least", "mean", "most"),
    [(ARM, 4, 81, 6, 7.0, 9), (LEG, 3, 27, 5, 17 / 3, 7)],
    ids=["arm", "leg"],
)
def test_every_path_costs_what_equation_2_says(
    width_deg: int, rounds: int, paths: int, least: int, mean: float, most: int
) -> None:
    """P36-P40, M1: the mean of the arm is 7; the print's 6 is its least."""
    costs = [matches_of_path(path, width_deg) for path in product((0, 1, 2), repeat=rounds)]
    assert len(costs) == paths
    assert (min(costs), max(costs)) == (least, most)
    assert np.mean(costs) == pytest.approx(mean)
    assert np.mean(costs) == pytest.approx(3 + 4 / 3 * (np.log2(width_deg / STOP) - 1))  # eq. (2)


@pytest.mark.parametrize(("width_deg", "mean"), [(ARM, 7.5), (LEG, 6.0)], ids=["arm", "leg"])
def test_a_uniform_target_costs_half_a_match_more_than_printed(width_deg: int, mean: float) -> None:
    """M15: the middle wins half of the time, not a third."""
    targets = np.random.default_rng(1).uniform(0.0, width_deg, 4000)
    costs = [tritree(peak_at(target), (0, width_deg), STOP).matches for target in targets]
    assert np.mean(costs) == pytest.approx(mean, abs=0.04)


@pytest.mark.parametrize(
    ("width_deg", "worst", "exhaustive"), [(ARM, 9, 17), (LEG, 7, 9)], ids=["arm", "leg"]
)
def test_worst_cost_is_about_half_of_the_full_search(
    width_deg: int, worst: int, exhaustive: int
) -> None:
    """P40; between them the searches for all targets meet exactly the full search's angles."""
    met: set[float] = set()
    costs = []
    for target in np.linspace(0.0, width_deg, 1001).tolist():
        found, tried = searched_with(peak_at(target), width_deg)
        assert len(set(tried)) == len(tried) == found.matches
        costs.append(found.matches)
        met.update(tried)
    assert max(costs) == worst
    assert len(met) == exhaustive
    assert np.diff(sorted(met)) == pytest.approx(STOP)


@pytest.mark.parametrize(
    ("previous_deg", "bounds_deg"),
    [(172.0, (116, 180)), (100.0, (68, 132)), (3.0, (0, 64)), (99.6, (68, 132))],
    ids=["pushed inside the limit", "left alone", "pushed up", "on whole degrees"],
)
def test_search_window_is_the_papers(previous_deg: float, bounds_deg: tuple[int, int]) -> None:
    """P38."""
    assert window(previous_deg, ARM, 0.0, 180.0) == bounds_deg


@given(
    st.sampled_from(sorted(LIMITS_DEG)),
    st.floats(-400.0, 400.0),
    st.sampled_from([ARM, LEG]),
    st.floats(-400.0, 400.0),
)
def test_every_probe_is_inside_the_joints_range(
    joint: str, previous_deg: float, width_deg: int, target_deg: float
) -> None:
    """P38, P39: wherever the joint was, and wherever the best match lies."""
    low, high = LIMITS_DEG[joint]
    bounds = window(previous_deg, width_deg, low, high)
    assert bounds[1] - bounds[0] == width_deg

    def score(angle_deg: float) -> float:
        assert low <= angle_deg <= high
        assert angle_deg == round(angle_deg)
        return -abs(angle_deg - target_deg)

    tritree(score, bounds, STOP)


def test_the_regions_are_the_papers() -> None:
    """P36, M13: the left winner takes the left half; what it knows already is not matched again."""
    nan = np.nan
    assert narrowed(0, 64, 3.0, 2.0, 1.0) == pytest.approx((0, 32, 3.0, nan, 2.0), nan_ok=True)
    assert narrowed(0, 64, 2.0, 3.0, 1.0) == pytest.approx((16, 48, nan, 3.0, nan), nan_ok=True)
    assert narrowed(0, 64, 1.0, 2.0, 3.0) == pytest.approx((32, 64, 2.0, nan, 3.0), nan_ok=True)


def test_ties_go_to_the_middle_then_to_the_left() -> None:
    """P36: deterministic, and the middle is the angle of the frame before."""
    assert tritree(lambda _: 0.5, (68, 132), STOP) == Found(100.0, 0.5, 9)
    assert narrowed(0, 64, 1.0, 1.0, 0.0)[:2] == (16, 48)
    assert narrowed(0, 64, 1.0, 0.0, 1.0)[:2] == (0, 32)


@pytest.mark.parametrize("first", [0, 1, 3], ids=["at once", "at an end", "in the second round"])
def test_a_score_that_is_no_number_ends_the_search_with_its_angle(first: int) -> None:
    """M14: it was asked for without end, as what is not a number counts as not yet matched."""
    asked: list[float] = []

    def score(angle_deg: float) -> float:
        asked.append(angle_deg)
        assert len(asked) < 20
        return 0.5 if len(asked) <= first else float("nan")

    with pytest.raises(ValueError, match=r"^the score of [0-9]+ degrees") as raised:
        tritree(score, (68, 132), STOP)
    assert len(asked) == first + 1
    assert f"of {asked[-1]:g} degrees" in str(raised.value)


@given(st.integers(0, 2**32 - 1), st.sampled_from([ARM, LEG]))
def test_the_search_ends_with_the_best_that_it_met(seed: int, width_deg: int) -> None:
    """M14: no score, however wild, keeps it from ending."""
    random = np.random.default_rng(seed)
    scores = {a: float(random.random()) for a in range(0, width_deg + 1, STOP)}
    found, tried = searched_with(lambda angle_deg: scores[int(angle_deg)], width_deg)
    assert found.score == max(scores[int(a)] for a in tried)
    assert scores[int(found.angle_deg)] == found.score


@WIDTHS
def test_wide_symmetric_peaks_are_found_as_by_the_full_search(width_deg: int) -> None:
    """P41: peaks at least 20 degrees wide; four degrees of grid are one degree of mean error."""
    targets = np.random.default_rng(2).uniform(0, width_deg, 1000)
    found = [tritree(bell(t, 20.0, 20.0), (0, width_deg), STOP).angle_deg for t in targets]
    exhaustive = [full(bell(t, 20.0, 20.0), width_deg) for t in targets]
    errors = np.abs(np.array(found) - targets)
    assert errors == pytest.approx(np.abs(np.array(exhaustive) - targets))
    assert errors.mean() == pytest.approx(1.0, abs=0.05)
    assert errors.max() <= 2.0


def share_off(found: list[float], targets: np.ndarray) -> float:
    return float(np.mean(np.abs(np.array(found) - targets) > STOP))


def test_skewed_peaks_are_missed_in_one_case_of_ten() -> None:
    """P41: four times as steep on one side than on the other; the full search misses none."""
    random = np.random.default_rng(3)
    targets = random.uniform(0, ARM, 2000)
    scores = [bell(target, *random.permutation([10.0, 40.0])) for target in targets]
    found = [tritree(score, (0, ARM), STOP).angle_deg for score in scores]
    assert share_off(found, targets) == pytest.approx(0.11, abs=0.02)
    assert np.abs(np.array(found) - targets).max() < 12.0
    assert share_off([full(score, ARM) for score in scores], targets) == 0.0


def test_narrow_peaks_in_clutter_are_wrong_in_one_case_of_nine_and_then_by_far() -> None:
    """P41: a peak of 6 degrees falls between the first probes, where clutter decides."""
    random = np.random.default_rng(4)
    targets = random.uniform(0, ARM, 2000)

    def in_clutter(target: float) -> Score:
        clutter, peak = random.normal(0, 0.12, ARM + 1), bell(target, 6.0, 6.0)
        return lambda angle_deg: peak(angle_deg) + clutter[int(angle_deg)]

    scores = [in_clutter(target) for target in targets]
    found = [tritree(score, (0, ARM), STOP).angle_deg for score in scores]
    assert share_off(found, targets) == pytest.approx(0.11, abs=0.03)
    assert 45.0 < np.abs(np.array(found) - targets).max() < 60.0
    assert share_off([full(score, ARM) for score in scores], targets) < 0.04


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.0, 180.0), st.floats(0.0, 180.0), st.floats(0.0, 140.0), st.integers(0, 2**32 - 1)
)
def test_the_compiled_search_is_the_plain_one(
    true_deg: float, before_deg: float, elbow_deg: float, seed: int
) -> None:
    """P9, P36: limbs counted over a drawn rest score as the whole model does, to 1e-12."""
    noise = np.random.default_rng(seed).random(SIZE[::-1]) < 0.02
    seen = picture(posed(r_shoulder_z=true_deg, r_elbow_x=elbow_deg, l_hip_z=190.0)) ^ noise
    pose = posed(r_shoulder_z=before_deg, r_elbow_x=elbow_deg / 2)
    model = laid_over(seen, pose)
    how = turn(ARM_LIMBS[0], r_shoulder_z=1.0)
    bounds = window(before_deg, ARM, 0.0, 180.0)

    def score(angle_deg: float) -> float:
        trial = pose.copy()
        trial[POSE_INDEX["r_shoulder_z"]] = angle_deg
        return similarity(seen, draw_body(BODY, trial, view(1), SIZE))

    plain = tritree(score, bounds, STOP)
    compiled = search(
        model.seen,
        model.seen_px,
        model.width,
        BODY,
        pose,
        model.view,
        how.step,
        how.moving,
        *bounds,
        STOP,
    )
    assert compiled[1] == pytest.approx(plain.score, abs=1e-12)
    assert (compiled[0], compiled[2]) == (plain.angle_deg, plain.matches)


def test_coupled_angles_turn_together() -> None:
    """P34: the knee bends twice as far as the hip, the other way."""
    seen = picture(posed(r_hip_x=40.0, r_knee_x=-80.0), viewer=2)
    how = turn((2, 4), r_hip_x=1.0, r_knee_x=-2.0)
    model = laid_over(seen, posed(r_knee_x=33.0), viewer=2)
    angle, value, _ = search(
        model.seen, model.seen_px, model.width, BODY, model.pose, model.view, how.step,
        how.moving, 28, 60, STOP,
    )  # fmt: skip
    assert angle == pytest.approx(40.0, abs=2.0)
    assert value == pytest.approx(1.0, abs=1e-12)
    assert model.pose[POSE_INDEX["r_knee_x"]] == 33.0
