"""Fifteen hidden Markov models in parallel: the likeliest posture of a motion."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from recognizer.codebook import Codebook, symbols
from recognizer.features import BEARING_NAMES, FEATURE_NAMES, Rows, bearings, features, with_pose
from recognizer.forward import forward

Array = NDArray[np.float64]
Topology = Literal["left-right", "ergodic"]
Recognizer = Literal["default", "paper"]

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
"""The postures, and the paper's movement to which each belongs. The five movements are the
paper's; the list of postures is ours, because the paper's was lost with figure 16 (P56)."""

STATES: Final = 5
"""Hidden states of each model (section 5.1)."""


LEAST_FIT: Final[dict[Recognizer, float]] = {"default": 23.0, "paper": -3.2}
"""Mean log-likelihood of a motion's frames below which it is no known posture. Of 420 held-out
synthetic performances 2 % lie below; of the same ones, judged by models trained without their
posture, 77 % and 35 %: the others have a similar posture."""

PER_POSTURE: Final = ("start", "transition", "emission", "mean", "variance", "fit")
"""Arrays of a model with a row for each posture; the others are common to all."""


class Card(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Provenance of a model, stored in its file."""

    recognizer: Recognizer
    topology: Topology
    seed: int
    sequences: dict[str, int]
    """Number of training sequences of each posture."""
    frames: int
    performers: tuple[str, ...] = ()
    """People in the training data: their recognition does not count as a test."""


@dataclass(frozen=True, eq=False)
class PostureModel(ABC):
    """The models of all postures; p postures, in the order of `names`."""

    names: tuple[str, ...]
    start: Array  # (p, STATES)
    transition: Array  # (p, STATES, STATES): from, to
    card: Card

    @abstractmethod
    def log_emission(self, seen: Rows) -> Array:
        """log of the probability or density of each of these rows, all with a pose, in each
        state: (n, p, STATES)."""


@dataclass(frozen=True, eq=False)
class SymbolModel(PostureModel):
    """The paper's model: ten angles of a frame are one of 64 symbols (P57)."""

    FEATURES = FEATURE_NAMES

    codebook: Codebook
    emission: Array  # (p, STATES, SYMBOLS), nowhere zero

    def log_emission(self, seen: Rows) -> Array:
        """Symbols of the nearest codewords."""
        observed = symbols(self.codebook, features(seen))
        return self._log_emission[observed]

    @cached_property
    def _log_emission(self) -> Array:
        return np.log(self.emission).transpose(2, 0, 1)


@dataclass(frozen=True, eq=False)
class DensityModel(PostureModel):
    """The better model: each state is a normal density of all limbs' directions and the travel."""

    FEATURES = BEARING_NAMES

    mean: Array  # (p, STATES, 27)
    variance: Array  # (p, STATES, 27), positive
    rest_mean: Array  # (27,), mean of standing people
    rest_variance: Array  # (27,), positive
    fit: Array  # (p,), mean log density of a frame in the median training performance

    def log_emission(self, seen: Rows) -> Array:
        """Log densities of independent normal entries; the square is expanded into two matrix
        products."""
        shown = bearings(seen)
        by_square, by_entry, level = self._products
        logs = np.square(shown) @ by_square + shown @ by_entry + level
        return logs.reshape(len(seen), *self.mean.shape[:2])

    @cached_property
    def _products(self) -> tuple[Array, Array, Array]:
        """Factors of squares and entries, (27, p STATES), and the constant."""
        entries = self.mean.shape[2]
        weight = 1.0 / self.variance.reshape(-1, entries)
        pull = self.mean.reshape(-1, entries) * weight
        level = (np.square(pull) / weight - np.log(weight)).sum(axis=1)
        return -0.5 * weight.T, pull.T, -0.5 * (level + entries * np.log(2 * np.pi))


def joined(known: PostureModel, new: PostureModel) -> PostureModel:
    """Both models in one; where both have a posture, the new one's replaces the known one's.

    The common arrays come from `known`.
    """
    names = tuple(dict.fromkeys((*known.names, *new.names)))
    own = [name for name in vars(new) if name in PER_POSTURE]
    place = {name: i for i, name in enumerate((*known.names, *new.names))}
    rows = [place[name] for name in names]
    arrays = {
        name: np.concatenate([getattr(known, name), getattr(new, name)])[rows] for name in own
    }
    old = known.card
    card = msgspec.structs.replace(
        old,
        sequences={name: (old.sequences | new.card.sequences)[name] for name in names},
        frames=old.frames + new.card.frames,
        performers=tuple(sorted({*old.performers, *new.card.performers})),
    )
    return replace(known, names=names, card=card, **arrays)


def scored(model: PostureModel, seen: Rows) -> dict[str, float]:
    """log P(O | posture) of each posture for rows (n, 20) that all have a pose.

    Always finite. Without rows each is log 1 = 0.

    Source: Huang & Chung 2004, section 5.2 (P58).
    """
    totals = forward(model.start, model.transition, model.log_emission(seen))
    return dict(zip(model.names, totals.tolist(), strict=True))


def log_likelihoods(model: PostureModel, given: Rows) -> dict[str, float]:
    """The same for any rows: frames without a pose are left out."""
    return scored(model, with_pose(given))


def name(model: PostureModel, given: Rows) -> str:
    """The likeliest posture; ties go to the earlier one in the model; "" without any pose."""
    if not len(with_pose(given)):
        return ""
    return likeliest(log_likelihoods(model, given))


def likeliest(scores: Mapping[str, float]) -> str:
    """The posture of the highest log-likelihood (P58)."""
    return max(scores, key=scores.__getitem__)
