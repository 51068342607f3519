"""Baum-Welch for one posture of either recogniser, with regularisation for few data."""

import logging
from collections.abc import Iterator, Sequence, Sized
from contextlib import contextmanager
from typing import Final

import numpy as np
from numpy.typing import NDArray

from recognizer.codebook import Codebook, LearningError, Symbols
from recognizer.postures import STATES, Array, Topology

NEIGHBOUR_WIDTH: Final = 0.25
"""Distance between codewords at which probability is still shared: an arm turned by 14 degrees,
a thigh by 5. The training data come from few people and must cover others. Of 420 held-out
synthetic performances, 0.15, 0.2 and 0.25 recognised 371, 372 and 374."""

EMISSION_FLOOR: Final = 1e-4
"""Lower bound of a symbol's probability: one that training never saw must not exclude a posture
(P57)."""

TRANSITION_FLOOR: Final = 1e-3
"""Lower bound of an allowed transition's probability; so a state that training never left can be
left."""

ROUNDS: Final = 30
"""Largest number of Baum-Welch rounds: on the clips of two performers it converged in 12 to 30."""

DENSITY_ROUNDS: Final = 20
"""Largest number of Baum-Welch rounds for models of densities."""

MEAN_WEIGHT: Final = 1e-3
"""Weight of the overall mean in each state's, frames: a state that training never entered gets a
mean."""

VARIANCE_FLOOR: Final = 0.01
"""Lower bound of a direction's variance: 6 degrees, the tracker's error; no state shall fit a
person more closely. 0.005 and 0.01 recognised 415 and 417 of 420 held-out synthetic
performances, 0.05 only 411."""


def allowed(topology: Topology, states: int) -> NDArray[np.bool_]:
    """Allowed transitions: (from, to).

    Postures repeat and windows begin anywhere in them, so all transitions are allowed: chosen on
    four synthetic performers outside training (52 of 60 right against 47, tracked in `default`
    mode; 49 against 45 in `paper` mode).
    """
    if topology == "ergodic":
        return np.ones((states, states), np.bool_)
    return np.eye(states, dtype=np.bool_) | np.eye(states, k=1, dtype=np.bool_)


def start(topology: Topology, states: int) -> Array:
    """Initial probabilities, (states,); not trained, as few sequences would make them too
    narrow."""
    return np.full(states, 1 / states) if topology == "ergodic" else np.eye(states)[0]


def train_densities(
    given: list[Array], topology: Topology, seed: int, states: int = STATES
) -> tuple[Array, Array, Array]:
    """Transition (states, states), mean and variance (states, 27) of one posture.

    Baum-Welch starts from a cluster of frames for each state or, with left-right transitions, from
    each sequence cut into as many stretches.

    Raises:
        LearningError: When there are fewer distinct vectors than states.
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
    """Index of each vector's cluster."""
    from sklearn.cluster import KMeans
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1):
        found = KMeans(states, n_init=1, random_state=seed).fit(shown)
    return np.asarray(found.labels_, np.int64)


def _stretch(given: Sequence[Sized], states: int) -> NDArray[np.int64]:
    """For all sequences, the index of each entry's stretch, of equal ones."""
    return np.concatenate([np.arange(len(one)) * states // len(one) for one in given])


def nearness(codebook: Codebook) -> Array:
    """Share of a symbol's probability that each other symbol gets; rows sum to 1."""
    apart = np.linalg.norm(codebook[:, np.newaxis] - codebook, axis=2)
    near = np.exp(-np.square(apart / NEIGHBOUR_WIDTH) / 2)
    return near / near.sum(axis=1, keepdims=True)


def train_symbols(
    given: list[Symbols], near: Array, topology: Topology, states: int = STATES
) -> tuple[Array, Array]:
    """Transition (states, states) and emission (states, symbols) of one posture.

    Baum-Welch starts from each sequence cut into equal stretches, one per state.

    Args:
        near: From `nearness`, (symbols, symbols).
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
    """Transitions with every allowed one possible."""
    return _rows(np.where(may, np.maximum(transition, TRANSITION_FLOOR), 0.0))


def _shown_by(given: list[Symbols], states: int, count: int) -> Array:
    """Frequency of each symbol in each stretch of the sequences, (states, symbols), rows sum to
    1."""
    counts = np.zeros((states, count))
    np.add.at(counts, (_stretch(given, states), np.concatenate(given)), 1.0)
    return _rows(counts)


def _smooth(emission: Array, near: Array) -> Array:
    """Emissions smoothed over neighbours, none below the lower bound, rows sum to 1."""
    return _rows(np.maximum(emission @ near, EMISSION_FLOOR))


def _rows(weights: Array) -> Array:
    return weights / weights.sum(axis=1, keepdims=True)


@contextmanager
def _silent(logger: str) -> Iterator[None]:
    """Without hmmlearn's warning of few data, which the regularisation addresses."""
    given = logging.getLogger(logger)
    before, given.disabled = given.disabled, True
    try:
        yield
    finally:
        given.disabled = before
