"""Baum-Welch's surroundings: where it begins, and what keeps few data from narrowing it."""

import logging

import numpy as np
import pytest

from lab.posture_models.hmm_training import (
    EMISSION_FLOOR,
    NEIGHBOUR_WIDTH,
    TRANSITION_FLOOR,
    VARIANCE_FLOOR,
    _open,
    _shown_by,
    _silent,
    _smooth,
    _stretch,
    allowed,
    nearness,
    start,
    train_densities,
    train_symbols,
)
from recognizer.codebook import LearningError


def test_states_follow_each_other_or_any() -> None:
    assert allowed("ergodic", 3).all()
    assert allowed("left-right", 3).tolist() == [
        [True, True, False],
        [False, True, True],
        [False, False, True],
    ]
    assert start("ergodic", 4).tolist() == [0.25] * 4
    assert start("left-right", 3).tolist() == [1.0, 0.0, 0.0]


def test_no_allowed_transition_is_impossible_and_no_other_is_possible() -> None:
    may = allowed("left-right", 3)
    found = _open(np.array([[1.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.3, 0.3, 0.4]]), may)
    assert found.sum(axis=1) == pytest.approx([1.0] * 3)
    assert found[0, 1] == pytest.approx(TRANSITION_FLOOR / (1.0 + TRANSITION_FLOOR))
    assert found[~may].tolist() == [0.0] * 4
    assert found[2, 2] == 1.0


def test_a_symbol_vouches_for_its_neighbours_by_how_near_they_are() -> None:
    book = np.array([[0.0, 0.0], [NEIGHBOUR_WIDTH, 0.0], [9.0, 0.0]])
    near = nearness(book)
    share = np.exp(-0.5)
    assert near[0] == pytest.approx([1 / (1 + share), share / (1 + share), 0.0])
    smooth = _smooth(np.array([[1.0, 0.0, 0.0]]), near)
    rest = np.array([near[0, 0], near[0, 1], EMISSION_FLOOR])
    assert smooth[0] == pytest.approx(rest / rest.sum())


def test_each_sequence_is_cut_into_equal_stretches_one_a_state() -> None:
    given = [np.array([0, 0, 1, 1]), np.array([2, 2, 2, 0, 0, 0])]
    assert _stretch(given, 2).tolist() == [0, 0, 1, 1, 0, 0, 0, 1, 1, 1]
    shown = _shown_by(given, 2, 3)
    assert shown == pytest.approx(np.array([[2 / 5, 0, 3 / 5], [3 / 5, 2 / 5, 0]]))


def hopping(topology: str) -> list[np.ndarray]:
    """Sequences of two places, three frames at each."""
    rng = np.random.default_rng(1)
    places = np.repeat([[0.0, 0.0], [1.0, 2.0]], 3, axis=0)
    times = 1 if topology == "left-right" else 4
    return [np.tile(places, (times, 1)) + rng.normal(0.0, 0.02, (6 * times, 2)) for _ in range(5)]


@pytest.mark.parametrize("topology", ["ergodic", "left-right"])
def test_densities_of_two_places_stand_at_both_and_hop_once_in_three_frames(topology: str) -> None:
    transition, mean, variance = train_densities(hopping(topology), topology, 0, states=2)  # type: ignore[arg-type]
    order = mean[:, 0].argsort()
    assert mean[order] == pytest.approx(np.array([[0.0, 0.0], [1.0, 2.0]]), abs=0.03)
    assert (variance >= VARIANCE_FLOOR).all()
    assert variance == pytest.approx(np.full((2, 2), VARIANCE_FLOOR), rel=0.5)
    stays = transition[order, order]
    if topology == "ergodic":
        assert stays == pytest.approx([2 / 3, 0.72], abs=0.05)
    else:
        assert stays == pytest.approx([2 / 3, 1.0], abs=0.01)
        assert transition[1, 0] == 0.0
    again = train_densities(hopping(topology), topology, 0, states=2)  # type: ignore[arg-type]
    assert np.array_equal(again[1], mean)


def test_fewer_poses_than_states_are_refused() -> None:
    still = [np.tile([[1.0, 2.0]], (9, 1)), np.tile([[3.0, 4.0]], (9, 1))]
    with pytest.raises(LearningError, match="fewer than 3 different poses"):
        train_densities(still, "ergodic", 0, states=3)
    assert train_densities(still, "left-right", 0, states=2)[1].shape == (2, 2)


def test_symbols_of_two_stretches_are_those_of_both_states() -> None:
    given = [np.array([0, 0, 0, 1, 1, 1])] * 4
    transition, emission = train_symbols(given, np.eye(3), "left-right", states=2)
    assert emission[0].argmax() == 0
    assert emission[1].argmax() == 1
    assert emission.min() == pytest.approx(EMISSION_FLOOR, rel=0.01)
    assert transition[0] == pytest.approx([2 / 3, 1 / 3], abs=0.01)
    assert transition[1] == pytest.approx([0.0, 1.0])


@pytest.mark.parametrize("before", [True, False])
def test_what_was_silenced_speaks_again_as_before(before: bool) -> None:
    logger = logging.getLogger("a library")
    logger.disabled = before
    with _silent("a library"):
        assert logger.disabled
    assert logger.disabled == before
