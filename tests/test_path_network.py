"""The network of postures, frame by frame, held against plain numpy and paths followed by hand."""

import numpy as np
import pytest
from scipy.stats import norm

from recognizer.path_network import (
    CAP_LIMB,
    CAP_TRAVEL,
    CHANGE,
    COUNT,
    ENTER,
    EXIT,
    FILLER,
    LAST,
    LOOSENESS,
    MOVING,
    ONSET,
    PHASE,
    REST_CAP,
    SCALE,
    SLOWNESS,
    STILL,
    STILL_LOSS,
    PathNetwork,
    advance,
    emissions,
)
from recognizer.postures import Card, DensityModel

Array = np.ndarray
STANDING, OTHER = 4, 5
"""Of two postures of two states: what comes after their four states."""


def densities(seed: int = 0) -> tuple[Array, Array, Array, Array]:
    """Means and variances of two postures of three states, and of standing."""
    rng = np.random.default_rng(seed)
    variance, rest_variance = rng.uniform(0.05, 0.3, (2, 3, 27)), rng.uniform(0.05, 0.3, 27)
    return rng.normal(0.0, 0.5, (2, 3, 27)), variance, rng.normal(0.0, 0.5, 27), rest_variance


def expected_emissions(seen: Array, speed: float, given: tuple[Array, ...]) -> Array:
    mean, variance, rest, rest_variance = given
    caps = np.repeat([CAP_LIMB, CAP_TRAVEL], [24, 3])
    wide = np.minimum(np.square(seen - mean) / (LOOSENESS * variance), caps)
    level = np.log(2 * np.pi * LOOSENESS * variance)
    states = -0.5 * SCALE * (wide + level).sum(axis=2).ravel()
    away = (np.square(seen - rest) / rest_variance)[:24].sum()
    still, moving = norm(0, STILL).logpdf(speed), norm(0, MOVING).logpdf(speed)
    standing = states.max() - 0.5 * SCALE * max(0.0, away - REST_CAP * 24)
    standing += max(SLOWNESS * (still - moving), STILL_LOSS)
    return np.array([*states, standing, SCALE * FILLER])


@pytest.mark.parametrize("apart", [0.1, 1.0, 4.0])
@pytest.mark.parametrize("speed", [0.0, 0.3, 5.0])
def test_emissions_are_capped_normal_densities(apart: float, speed: float) -> None:
    given = densities()
    seen = given[2] + apart * np.random.default_rng(1).normal(size=27)
    found = emissions(seen, speed, *given)
    assert found == pytest.approx(expected_emissions(seen, speed, given), rel=1e-12)


def test_a_pose_near_that_of_standing_is_not_less_like_it_for_small_deviations() -> None:
    mean, variance, rest, rest_variance = densities()
    mean[0, 0] = rest
    near = np.sqrt(0.9 * REST_CAP * rest_variance)
    near[-3:] = 0.0
    at, beside = (emissions(rest + way, 0.1, mean, variance, rest, rest_variance)
                  for way in (0.0 * near, near))  # fmt: skip
    assert at[-2] - at[:-2].max() == pytest.approx(beside[-2] - beside[:-2].max())


class Paths:
    """A network whose score, record and history are set by hand."""

    def __init__(self, *score: float) -> None:
        self.score = np.array(score)
        self.record = np.array([[10 * state, state, state % 2] for state in range(6)])
        self.over = np.array([[100 + state, 1, 0, 110 + state] for state in range(6)])
        self.transition = np.log(np.array([[[0.9, 0.1], [0.2, 0.8]], [[0.7, 0.3], [0.4, 0.6]]]))
        self.side = np.zeros((2, 2), np.int64)

    def advanced(self, frame: int = 50, may_begin: bool = True) -> tuple[Array, Array, Array]:
        score, record, over = advance(
            self.score, self.record, self.over, np.zeros(6), self.transition, self.side, frame,
            may_begin,
        )  # fmt: skip
        return score, record, over


def test_a_path_that_stays_in_its_posture_takes_its_record_along() -> None:
    now = Paths(-90.0, 0.0, -90.0, -90.0, -90.0, -95.0)
    score, record, over = now.advanced()
    assert score[:2] == pytest.approx([np.log(0.2 / 0.8), 0.0])
    assert record[0].tolist() == record[1].tolist() == now.record[1].tolist()
    assert over[0].tolist() == over[1].tolist() == now.over[1].tolist()


@pytest.mark.parametrize(
    ("standing", "other", "source"),
    [(0.0, -1.0, STANDING), (-1.0, 0.0, OTHER), (0.0, 0.0, STANDING)],
    ids=["from standing", "from something unknown", "as likely: from standing"],
)
def test_a_posture_begins_where_the_likelier_of_standing_and_the_unknown_was(
    standing: float, other: float, source: int
) -> None:
    now = Paths(-90.0, -90.0, -90.0, -90.0, standing, other)
    score, record, over = now.advanced(frame=50)
    for state in range(4):
        assert score[state] == pytest.approx(-ENTER)
        assert record[state].tolist() == [50, 0, 0]
        assert over[state].tolist() == now.over[source].tolist()


def test_nothing_begins_before_it_may() -> None:
    score, _, _ = Paths(*[-np.inf] * 4, 0.0, -np.inf).advanced(may_begin=False)
    assert np.isneginf(score[:4]).all()
    assert score[STANDING] == 0.0


def test_a_repetition_counts_at_the_far_end_once_until_the_near_end_is_met() -> None:
    now = Paths(0.0, *[-90.0] * 5)
    now.side[0] = 1, -1
    now.record[0] = 3, 5, 0
    _, first, _ = now.advanced()
    assert (first[0, COUNT], first[0, PHASE], first[0, ONSET]) == (6, 1, 3)
    now.record[0] = 3, 5, 1
    _, again, _ = now.advanced()
    assert (again[0, COUNT], again[0, PHASE]) == (5, 1)
    assert (again[1, COUNT], again[1, PHASE]) == (5, 0), "the near end"


@pytest.mark.parametrize("state", [STANDING, OTHER])
def test_standing_and_the_unknown_come_from_themselves_each_other_or_a_posture(state: int) -> None:
    beside = STANDING + OTHER - state

    def reached(own: float, others: float, posture: float) -> tuple[float, list[int], Paths]:
        now = Paths(-90.0, posture, -91.0, -92.0, 0.0, 0.0)
        now.score[state], now.score[beside] = own, others
        now.transition[:] = -100.0
        score, _, over = now.advanced(frame=50)
        first = score[state] - score[beside]
        return float(first), over[state].tolist(), now

    gap, over, now = reached(0.0, 0.0, -90.0)
    assert gap == 0.0
    assert over == now.over[state].tolist()
    gap, over, now = reached(-CHANGE - 1.0, 0.0, -90.0)
    assert gap == pytest.approx(-CHANGE)
    assert over == now.over[beside].tolist()
    gap, over, now = reached(-EXIT - 1.0, -EXIT - 1.0, 0.0)
    assert gap == 0.0
    assert over == [*now.record[1].tolist(), 49], "a performance that is over, its last frame"
    assert len(over) == LAST + 1


def test_the_best_path_has_score_nought() -> None:
    score, _, _ = Paths(-7.0, -8.0, -9.0, -10.0, -11.0, -12.0).advanced()
    assert score.max() == 0.0


def network(*places: float, transition: Array | None = None) -> PathNetwork:
    """Of one posture whose states lie so far from standing, along one entry."""
    states = len(places)
    mean = np.zeros((1, states, 27))
    mean[0, :, 4] = places
    even = np.full((1, states, states), 1 / states)
    return PathNetwork(
        DensityModel(
            names=("wave",),
            start=np.full((1, states), 1 / states),
            transition=even if transition is None else transition,
            card=Card(recognizer="default", topology="ergodic", seed=0, sequences={"wave": 1},
                      frames=9, performers=()),
            mean=mean,
            variance=np.ones_like(mean),
            rest_mean=np.zeros(27),
            rest_variance=np.ones(27),
            fit=np.zeros(1),
        )
    )  # fmt: skip


def test_far_and_near_ends_are_the_outer_quarters_of_the_way() -> None:
    made = network(0.0, 0.2, 0.3, 0.7, 0.8, 1.0)
    assert made.away[0] == pytest.approx([0.0, 0.2, 0.3, 0.7, 0.8, 1.0])
    assert made.far.tolist() == [[False, False, False, False, True, True]]
    assert made.side.tolist() == [[-1, -1, 0, 0, 1, 1]]


def test_a_repetition_that_never_stands_goes_from_the_state_that_is_farthest_from_the_top() -> None:
    assert network(2.0, 2.2, 2.5, 2.8, 3.0).side.tolist() == [[-1, -1, 0, 1, 1]]


def test_a_state_that_is_hardly_ever_entered_marks_nothing() -> None:
    stays = np.array([[[0.49, 0.49, 0.02], [0.49, 0.49, 0.02], [0.49, 0.49, 0.02]]])
    made = network(0.1, 1.0, 9.0, transition=stays)
    assert made.share[0] == pytest.approx([0.49, 0.49, 0.02])
    assert made.away[0] == pytest.approx([0.1, 1.0, 0.0])
    assert made.side.tolist() == [[-1, 1, 0]]
