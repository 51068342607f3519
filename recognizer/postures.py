"""Fifteen five-state hidden Markov models: training them, and naming a posture by the likeliest."""

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Final, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from recognizer.codebook import SYMBOLS, Codebook, Symbols, fit, symbols
from recognizer.features import Angles, features, with_pose

Array = NDArray[np.float64]
Topology = Literal["left-right", "ergodic"]

POSTURES: Final = {
    "walk_in_place": "walking",
    "walk_sideways": "walking",
    "walk_toward": "walking",
    "walk_slow_bigswing": "walking",
    "raise_right_lateral": "arm_raising",
    "raise_left_lateral": "arm_raising",
    "raise_both_lateral": "arm_raising",
    "raise_both_forward_up": "arm_raising",
    "swing_right_circles": "arm_swing",
    "swing_both_backforth": "arm_swing",
    "swing_both_overhead_wave": "arm_swing",
    "squat": "squatting",
    "squat_arms_forward": "squatting",
    "kick_right_forward": "kicking",
    "kick_left_side": "kicking",
}
"""The postures, and to which of the paper's five movements each belongs. The movements are the
paper's; the list of postures is ours, for its own was lost with figure 16 (P56)."""

STATES: Final = 5
"""Hidden states of each model (section 5.1)."""

NEIGHBOUR_WIDTH: Final = 0.4
"""Distance in feature space at which a symbol still vouches for another: a limb turned by 23
degrees. What a handful of people showed must cover what the next one will show: sharing took the
errors from 47 to 30 in 360 (r01 against r04, true angles with 6 degrees of noise)."""

EMISSION_FLOOR: Final = 1e-4
"""No symbol is impossible: one that training never saw must not refuse a posture (P57)."""

TRANSITION_FLOOR: Final = 1e-3
"""No allowed transition is impossible, and a state that training never left keeps a way on."""

ROUNDS: Final = 30
"""Rounds of Baum-Welch at most; it settled in 12 to 30 on the clips of r01 and r04."""

ALLOWED: Final[dict[Topology, NDArray[np.bool_]]] = {
    "left-right": np.eye(STATES, dtype=np.bool_) | np.eye(STATES, k=1, dtype=np.bool_),
    "ergodic": np.ones((STATES, STATES), dtype=np.bool_),
}
"""Which state may follow which: (from, to). Postures repeat and windows begin anywhere in them, so
any state may follow any: chosen on four made-up performers outside training (52 of 60 right against
47, tracked in `default` mode; 49 against 45 in `paper` mode)."""

START: Final[dict[Topology, Array]] = {
    "left-right": np.eye(STATES)[0],
    "ergodic": np.full(STATES, 1 / STATES),
}
"""Where a sequence begins; not trained, few sequences would only make it narrow."""


class Card(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a model was made from: its file carries this along."""

    topology: Topology
    seed: int
    sequences: dict[str, int]
    """How many sequences of each posture were learnt from."""
    frames: int
    performers: tuple[str, ...] = ()
    """Who was seen in training: nobody whose recognition shall count."""


@dataclass(frozen=True, eq=False)
class PostureModel:
    """The models of all postures side by side; p postures, in the order of `names`."""

    names: tuple[str, ...]
    codebook: Codebook
    start: Array  # (p, STATES)
    transition: Array  # (p, STATES, STATES): from, to
    emission: Array  # (p, STATES, SYMBOLS), nowhere zero
    card: Card


def train(
    sequences: Mapping[str, Sequence[Angles]],
    topology: Topology = "ergodic",
    seed: int = 0,
    performers: Sequence[str] = (),
) -> PostureModel:
    """A model of each posture, from sequences (n, 17) of people who perform it.

    Frames without a pose are left out, and so is a sequence with fewer than five others. The same
    sequences and seed give the same model, bit for bit.

    Args:
        sequences: What was seen of each posture; the model keeps the order of the names.
        topology: Left-right with self loops as usual for motions with a beginning; ergodic for
            such that may begin anywhere.
        seed: Of the codebook's first guess.
        performers: Whose sequences these are, for the card.

    Raises:
        ValueError: When a posture has no usable sequence, or all poses together are too few.

    Source: Huang & Chung 2004, section 5.1 (P57).
    """
    seen = {name: _usable(name, given) for name, given in sequences.items()}
    codebook = fit(np.concatenate([f for given in seen.values() for f in given]), seed)
    near = _nearness(codebook)
    models = [
        _train_one([symbols(codebook, f) for f in given], near, topology) for given in seen.values()
    ]
    card = Card(
        topology=topology,
        seed=seed,
        sequences={name: len(given) for name, given in seen.items()},
        frames=sum(len(f) for given in seen.values() for f in given),
        performers=tuple(performers),
    )
    return PostureModel(
        names=tuple(seen),
        codebook=codebook,
        start=np.tile(START[topology], (len(seen), 1)),
        transition=np.stack([transition for transition, _ in models]),
        emission=np.stack([emission for _, emission in models]),
        card=card,
    )


def log_likelihoods(model: PostureModel, angles_deg: Angles) -> dict[str, float]:
    """log P(O | posture) of each posture for a stretch of frames (n, 17).

    Always finite. Without any pose there is no observation, and each is log 1 = 0.

    Source: Huang & Chung 2004, section 5.2 (P58).
    """
    observed = symbols(model.codebook, features(with_pose(angles_deg)))
    return dict(zip(model.names, forward(model, observed).tolist(), strict=True))


def name(model: PostureModel, angles_deg: Angles) -> str:
    """The likeliest posture, the earlier in the model where two tie; "" where no pose was seen."""
    if not len(with_pose(angles_deg)):
        return ""
    return likeliest(log_likelihoods(model, angles_deg))


def likeliest(scores: Mapping[str, float]) -> str:
    """The posture of the highest log-likelihood (P58)."""
    return max(scores, key=scores.__getitem__)


def forward(model: PostureModel, observed: Symbols) -> Array:
    """log P(observed | posture) of all postures at once, shape (p,): the forward algorithm.

    Each step is normalised to 1 and the logarithms of the norms are summed, so that a sequence of
    any length stays within floating point.
    """
    emitted = model.emission[:, :, observed].transpose(2, 0, 1)  # (n, p, STATES)
    total = np.zeros(len(model.names))
    state = model.start[:, np.newaxis, :]  # (p, 1, STATES)
    for at, emission in enumerate(emitted):
        arrived = state if at == 0 else state @ model.transition
        joint = arrived * emission[:, np.newaxis, :]
        norm = joint.sum(axis=2, keepdims=True)
        total += np.log(norm[:, 0, 0])
        state = joint / norm
    return total


def _usable(posture: str, given: Sequence[Angles]) -> list[Array]:
    seen = [features(with_pose(angles_deg)) for angles_deg in given]
    usable = [f for f in seen if len(f) >= STATES]
    if not usable:
        raise ValueError(
            f"{posture}: none of {len(given)} sequences has {STATES} frames with a pose;"
            " give clips in which the person was tracked"
        )
    return usable


def _nearness(codebook: Codebook) -> Array:
    """How much of a symbol's probability each other symbol gets; rows sum to 1."""
    apart = np.linalg.norm(codebook[:, np.newaxis] - codebook, axis=2)
    near = np.exp(-np.square(apart / NEIGHBOUR_WIDTH) / 2)
    return near / near.sum(axis=1, keepdims=True)


def _train_one(given: list[Symbols], near: Array, topology: Topology) -> tuple[Array, Array]:
    """Transition (STATES, STATES) and emission (STATES, SYMBOLS) of one posture.

    Baum-Welch starts from each sequence cut into five equal stretches, one a state.
    """
    from hmmlearn.hmm import CategoricalHMM

    hmm: Any = CategoricalHMM(
        STATES, n_features=SYMBOLS, init_params="", params="te", n_iter=ROUNDS
    )
    hmm.startprob_ = START[topology]
    hmm.transmat_ = _rows(ALLOWED[topology].astype(np.float64))
    hmm.emissionprob_ = _smooth(_stretches(given), near)
    with _silent("hmmlearn.base"):
        hmm.fit(np.concatenate(given)[:, np.newaxis], [len(sequence) for sequence in given])
    transition = np.where(ALLOWED[topology], np.maximum(hmm.transmat_, TRANSITION_FLOOR), 0.0)
    return _rows(transition), _smooth(hmm.emissionprob_, near)


def _stretches(given: list[Symbols]) -> Array:
    """How often each fifth of the sequences shows each symbol, (STATES, SYMBOLS), rows sum to 1."""
    counts = np.zeros((STATES, SYMBOLS))
    for sequence in given:
        states = np.arange(len(sequence)) * STATES // len(sequence)
        np.add.at(counts, (states, sequence), 1.0)
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
