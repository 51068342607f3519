"""Who took left for right, held against made-up instants of which it is known."""

import numpy as np

from integrator.landmarks.left_right_swap import (
    ANEW,
    BOTH_ASIDE,
    PART,
    PART_ASIDE,
    TRUST,
    Exchanged,
    step,
)

FACADE_AND_FLANK = (0.0, 1.0)
SURE = (0.001, 0.001)
"""Hardly either view took front for back."""
NOTHING = np.zeros((2, 2))


def says(first: int, second: int, by: float) -> np.ndarray:
    """Log probability in favour of one way in which the two views exchanged sides."""
    said = NOTHING.copy()
    said[first, second] = by
    return said


def test_nobody_is_taken_to_exchange_anything_unless_something_says_so() -> None:
    probable, decided = step(None, NOTHING, NOTHING, FACADE_AND_FLANK, SURE)
    assert decided == Exchanged((0, 0), (0, 0))
    assert np.isclose(probable.sum(), 1.0)


def test_legs_that_fit_only_exchanged_are_exchanged_and_the_arms_are_not() -> None:
    _, decided = step(None, says(0, 0, 10.0), says(0, 1, 10.0), FACADE_AND_FLANK, SURE)
    assert decided == Exchanged((0, 0), (0, 1))


def test_an_exchange_lasts_over_an_instant_that_tells_nothing() -> None:
    before, _ = step(None, NOTHING, says(0, 1, 20.0), FACADE_AND_FLANK, SURE)
    after, decided = step(before, NOTHING, NOTHING, FACADE_AND_FLANK, SURE)
    assert decided.legs == (0, 1)
    for _ in range(30):
        after, decided = step(after, NOTHING, NOTHING, FACADE_AND_FLANK, SURE)
    assert decided == Exchanged((0, 0), (0, 0))


def test_a_profile_exchanges_arms_or_legs_alone_more_often_than_a_front() -> None:
    probable, _ = step(None, NOTHING, NOTHING, FACADE_AND_FLANK, SURE)
    assert probable[:, 0, :, 1].sum() > probable[0, :, 1, :].sum()


def test_a_front_is_exchanged_as_a_whole_as_often_as_it_is_taken_for_a_back() -> None:
    probable, _ = step(None, NOTHING, NOTHING, FACADE_AND_FLANK, (0.3, 0.001))
    assert np.isclose(probable[1, :, 1, :].sum(), 0.3)


def test_what_a_sure_front_is_told_to_exchange_an_unsure_one_does() -> None:
    """The same words, of a view that may well have taken front for back and of one that did not."""
    said = says(1, 0, 3.0)
    _, unsure = step(None, said, said, FACADE_AND_FLANK, (0.3, 0.001))
    _, sure = step(None, said, said, FACADE_AND_FLANK, SURE)
    assert unsure == Exchanged((1, 0), (1, 0))
    assert sure == Exchanged((0, 0), (0, 0))


def test_arms_that_fit_exchanged_stay_where_the_faces_deny_it_for_those_arms_alone() -> None:
    """The facings speak of arms and legs together: arms of view 2, legs of none."""
    arms = says(0, 1, 8.0)
    _, decided = step(None, arms, NOTHING, FACADE_AND_FLANK, SURE)
    assert decided == Exchanged((0, 1), (0, 0))
    faced = np.zeros((2, 2, 2, 2))
    faced[0, 1, 0, 0] = -8.0
    _, decided = step(None, arms, says(0, 0, 8.0), FACADE_AND_FLANK, SURE, faced)
    assert decided == Exchanged((0, 0), (0, 0))


def test_an_instant_is_one_step_of_a_model_of_sixteen_states() -> None:
    """Each state by itself; before it, either view's sides are drawn anew now and then."""
    rng = np.random.default_rng(0)
    before = rng.dirichlet(np.ones(16)).reshape(2, 2, 2, 2)
    aside, confused = (0.3, 0.8), (0.2, 0.1)
    arms, legs = rng.normal(size=(2, 2, 2))

    def usual(view: int, arm: int, leg: int) -> float:
        share = aside[view]
        part = (1 - share) * PART + share * PART_ASIDE
        both = (1 - share) * confused[view] + share * BOTH_ASIDE
        return {(0, 0): 1 - both - 2 * part, (1, 1): both}.get((arm, leg), part)

    def drawn(known: np.ndarray, view: int) -> np.ndarray:
        new = np.empty_like(known)
        for state in np.ndindex(2, 2, 2, 2):
            kept = state[1 - view], state[3 - view]
            same = [o for o in np.ndindex(2, 2, 2, 2) if (o[1 - view], o[3 - view]) == kept]
            own = usual(view, state[view], state[2 + view])
            new[state] = (1 - ANEW) * known[state] + ANEW * own * sum(known[o] for o in same)
        return new

    for known, expected in (
        (before, drawn(drawn(before, 0), 1)),
        (None, np.array([usual(0, a, c) * usual(1, b, d) for a, b, c, d in np.ndindex(2, 2, 2, 2)])
         .reshape(2, 2, 2, 2)),
    ):  # fmt: skip
        for a, b, c, d in np.ndindex(2, 2, 2, 2):
            expected[a, b, c, d] *= np.exp(TRUST * (arms[a, b] + legs[c, d]))
        found, decided = step(known, arms, legs, aside, confused)
        assert np.allclose(found, expected / expected.sum(), atol=1e-12)
        a, b, c, d = np.unravel_index(expected.argmax(), expected.shape)
        assert decided == Exchanged((int(a), int(b)), (int(c), int(d)))
