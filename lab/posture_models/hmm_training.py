"""Baum-Welch for one posture of either recogniser, and what keeps few data from narrowing it."""

import logging
from collections.abc import Iterator, Sequence, Sized
from contextlib import contextmanager
from typing import Final

import numpy as np
from numpy.typing import NDArray

from recognizer.codebook import Codebook, LearningError, Symbols
from recognizer.postures import STATES, Array, Topology

NEIGHBOUR_WIDTH: Final = 0.25
"""Distance between codewords at which a symbol still vouches for another: an arm turned by 14
degrees, a thigh by 5. What a handful of people showed must cover what the next one will show. Of
420 held-out synthetic performances, 0.15, 0.2 and 0.25 named 371, 372 and 374."""

EMISSION_FLOOR: Final = 1e-4
"""No symbol is impossible: one that training never saw must not refuse a posture (P57)."""

TRANSITION_FLOOR: Final = 1e-3
"""No allowed transition is impossible, and a state that training never left keeps a way on."""

ROUNDS: Final = 30
"""Most rounds of Baum-Welch: on the clips of two performers it converged in 12 to 30."""

DENSITY_ROUNDS: Final = 20
"""Most rounds of Baum-Welch for models of densities."""

MEAN_WEIGHT: Final = 1e-3
"""Frames' worth of the overall mean in each state's: one that training never entered has a mean."""

VARIANCE_FLOOR: Final = 0.01
"""Of a direction: 6 degrees, what the tracker errs by; no state shall know a person better. 0.005
and 0.01 named 415 and 417 of 420 held-out synthetic performances, 0.05 only 411."""


def allowed(topology: Topology, states: int) -> NDArray[np.bool_]:
    """Which state may follow which: (from, to).

    Postures repeat and windows begin anywhere in them, so any state may follow any: chosen on four
    synthetic performers outside training (52 of 60 right against 47, tracked in `default` mode; 49
    against 45 in `paper` mode).
    """
    if topology == "ergodic":
        return np.ones((states, states), np.bool_)
    return np.eye(states, dtype=np.bool_) | np.eye(states, k=1, dtype=np.bool_)


def start(topology: Topology, states: int) -> Array:
    """Where a sequence begins, (states,); not trained, few sequences would only make it narrow."""
    return np.full(states, 1 / states) if topology == "ergodic" else np.eye(states)[0]


def train_densities(
    given: list[Array], topology: Topology, seed: int, states: int = STATES
) -> tuple[Array, Array, Array]:
    """Transition (states, states), mean and variance (states, 27) of one posture.

    Baum-Welch starts from a cluster of frames for each state or, where states follow each other,
    from each sequence cut into as many stretches.

    Raises:
        LearningError: When there are fewer different vectors than states.
    """
    from hmmlearn.hmm import GaussianHMM

    shown, may = np.concatenate(given), allowed(topology, states)
    if len(np.unique(shown, axis=0)) < states:
        raise LearningError(f"fewer than {states} different poses in a posture: give more clips")
    state = _clusters(shown, seed, states) if topology == "ergodic" else _stretch(given, states)
    hmm = GaussianHMM(
        states,
        "diag",
        init_params="",
        params="mct",
        n_iter=DENSITY_ROUNDS,
        tol=1.0,
        means_prior=shown.mean(axis=0),
        means_weight=MEAN_WEIGHT,
    )
    hmm.startprob_ = start(topology, states)
    hmm.transmat_ = _rows(np.where(may, 0.05, 0.0) + 0.75 * np.eye(states))
    hmm.means_ = np.stack([shown[state == i].mean(axis=0) for i in range(states)])
    hmm.covars_ = np.stack([shown[state == i].var(axis=0) for i in range(states)]) + VARIANCE_FLOOR
    with _silent("hmmlearn.base"):
        hmm.fit(shown, [len(one) for one in given])
    variance = np.maximum(np.diagonal(hmm.covars_, axis1=1, axis2=2), VARIANCE_FLOOR)
    return _open(hmm.transmat_, may), hmm.means_, variance


def _clusters(shown: Array, seed: int, states: int) -> NDArray[np.int64]:
    """Which of the clusters each vector belongs to."""
    from sklearn.cluster import KMeans
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1):
        found = KMeans(states, n_init=1, random_state=seed).fit(shown)
    return np.asarray(found.labels_, np.int64)


def _stretch(given: Sequence[Sized], states: int) -> NDArray[np.int64]:
    """Which of equal stretches of its sequence each entry of all sequences stands in."""
    return np.concatenate([np.arange(len(one)) * states // len(one) for one in given])


def nearness(codebook: Codebook) -> Array:
    """How much of a symbol's probability each other symbol gets; rows sum to 1."""
    apart = np.linalg.norm(codebook[:, np.newaxis] - codebook, axis=2)
    near = np.exp(-np.square(apart / NEIGHBOUR_WIDTH) / 2)
    return near / near.sum(axis=1, keepdims=True)


def train_symbols(
    given: list[Symbols], near: Array, topology: Topology, states: int = STATES
) -> tuple[Array, Array]:
    """Transition (states, states) and emission (states, symbols) of one posture.

    Baum-Welch starts from each sequence cut into equal stretches, one a state.

    Args:
        near: What `nearness` gave, (symbols, symbols).
    """
    from hmmlearn.hmm import CategoricalHMM

    may = allowed(topology, states)
    hmm = CategoricalHMM(states, n_features=len(near), init_params="", params="te", n_iter=ROUNDS)
    hmm.startprob_ = start(topology, states)
    hmm.transmat_ = _rows(may.astype(np.float64))
    hmm.emissionprob_ = _smooth(_shown_by(given, states, len(near)), near)
    with _silent("hmmlearn.base"):
        hmm.fit(np.concatenate(given)[:, np.newaxis], [len(sequence) for sequence in given])
    return _open(hmm.transmat_, may), _smooth(hmm.emissionprob_, near)


def _open(transition: Array, may: NDArray[np.bool_]) -> Array:
    """Transitions of which every allowed one is possible."""
    return _rows(np.where(may, np.maximum(transition, TRANSITION_FLOOR), 0.0))


def _shown_by(given: list[Symbols], states: int, count: int) -> Array:
    """How often each stretch of the sequences shows each symbol, (states, symbols), rows sum to
    1."""
    counts = np.zeros((states, count))
    np.add.at(counts, (_stretch(given, states), np.concatenate(given)), 1.0)
    return _rows(counts)


def _smooth(emission: Array, near: Array) -> Array:
    """Emissions that neighbours share, none below the floor, rows that sum to 1."""
    return _rows(np.maximum(emission @ near, EMISSION_FLOOR))


def _rows(weights: Array) -> Array:
    return weights / weights.sum(axis=1, keepdims=True)


@contextmanager
def _silent(logger: str) -> Iterator[None]:
    """Without hmmlearn's warning of few data: the floors and neighbours are our answer to it."""
    given = logging.getLogger(logger)
    before, given.disabled = given.disabled, True
    try:
        yield
    finally:
        given.disabled = before
