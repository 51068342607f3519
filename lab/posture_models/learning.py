"""Training of both recognisers' models from sequences of rows."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from lab.posture_models.hmm_training import nearness, start, train_densities, train_symbols
from recognizer.codebook import SYMBOLS, Codebook, LearningError, fit, symbols
from recognizer.features import Rows, bearings, features, with_pose
from recognizer.filler import fit_of, standing
from recognizer.postures import (
    STATES,
    Card,
    DensityModel,
    PostureModel,
    Recognizer,
    SymbolModel,
    Topology,
    joined,
)


class Sizes(NamedTuple):
    """Sizes of models."""

    states: int = STATES
    """Number of states of each model; a file stores only models with the paper's five."""
    symbols: int = SYMBOLS
    """Number of symbols of the codebook; a file stores only the paper's 64."""


def train(
    sequences: Mapping[str, Sequence[Rows]],
    recognizer: Recognizer = "default",
    topology: Topology = "ergodic",
    seed: int = 0,
    performers: Sequence[str] = (),
    sizes: Sizes = Sizes(),
) -> PostureModel:
    """A model of each posture, from sequences (n, 20) of people who perform it.

    Frames without a pose are left out, and so is a sequence with fewer than five others. The same
    sequences and seed give the same model, bit for bit.

    Args:
        sequences: By posture; the model keeps the order of the names.
        recognizer: Kind of model.
        topology: Left-right with self loops as usual for motions with a beginning; ergodic for
            those that may begin anywhere.
        seed: Seed of the first clusters.
        performers: Performers of the sequences, for the model card.
        sizes: Sizes of the models.

    Raises:
        LearningError: When a posture has no usable sequence, or all poses together are too few.

    Source: Huang & Chung 2004, section 5.1 (P57).
    """
    seen = _seen(sequences)
    card = _card(seen, recognizer, topology, seed, performers)
    shown = list(seen.values())
    if recognizer == "default":
        return _density_model(shown, card, sizes.states)
    poses = [features(one) for given in shown for one in given]
    return _symbol_model(shown, card, sizes.states, fit(np.concatenate(poses), seed, sizes.symbols))


def extended(
    known: PostureModel, sequences: Mapping[str, Sequence[Rows]], performers: Sequence[str] = ()
) -> PostureModel:
    """A model with more postures, or with some retrained; its others are unchanged.

    The paper's model keeps its codebook: poses unlike its training data share a symbol with others,
    so it learns them less well than the default model.

    Args:
        known: The model to extend; its codebook, topology and seed are used again.
        sequences: By posture: three performances are enough.
        performers: Performers of the sequences, for the model card.

    Raises:
        LearningError: When a posture has no usable sequence, or too few different poses.
    """
    seen = _seen(sequences)
    old = known.card
    card = _card(seen, old.recognizer, old.topology, old.seed, performers)
    shown = list(seen.values())
    if isinstance(known, SymbolModel):
        return joined(known, _symbol_model(shown, card, STATES, known.codebook))
    return joined(known, _density_model(shown, card, STATES))


def _seen(sequences: Mapping[str, Sequence[Rows]]) -> dict[str, list[Rows]]:
    return {name: _usable(name, given) for name, given in sequences.items()}


def _card(
    seen: Mapping[str, Sequence[Rows]],
    recognizer: Recognizer,
    topology: Topology,
    seed: int,
    performers: Sequence[str],
) -> Card:
    return Card(
        recognizer=recognizer,
        topology=topology,
        seed=seed,
        sequences={name: len(given) for name, given in seen.items()},
        frames=sum(len(one) for given in seen.values() for one in given),
        performers=tuple(performers),
    )


def _usable(posture: str, given: Sequence[Rows]) -> list[Rows]:
    seen = [with_pose(one) for one in given]
    usable = [one for one in seen if len(one) >= STATES]
    if not usable:
        raise LearningError(
            f"{posture}: none of {len(given)} sequences has {STATES} frames with a pose;"
            " give clips in which the person was tracked"
        )
    return usable


def _symbol_model(
    seen: list[list[Rows]], card: Card, states: int, codebook: Codebook
) -> SymbolModel:
    """Per sequence, posture by posture, in the order of the card."""
    shown = [[features(one) for one in given] for given in seen]
    near = nearness(codebook)
    models = [
        train_symbols([symbols(codebook, one) for one in given], near, card.topology, states)
        for given in shown
    ]
    transition, emission = (np.stack(part) for part in zip(*models, strict=True))
    return SymbolModel(
        names=tuple(card.sequences),
        start=np.tile(start(card.topology, states), (len(seen), 1)),
        transition=transition,
        card=card,
        codebook=codebook,
        emission=emission,
    )


def _density_model(seen: list[list[Rows]], card: Card, states: int) -> DensityModel:
    """Per sequence, posture by posture, in the order of the card."""
    shown = [[bearings(one) for one in given] for given in seen]
    models = [train_densities(given, card.topology, card.seed, states) for given in shown]
    transition, mean, variance = (np.stack(part) for part in zip(*models, strict=True))
    rest_mean, rest_variance = standing(shown)
    fits = [fit_of(*of) for of in zip(shown, mean, variance, strict=True)]
    return DensityModel(
        names=tuple(card.sequences),
        start=np.tile(start(card.topology, states), (len(seen), 1)),
        transition=transition,
        card=card,
        mean=mean,
        variance=variance,
        rest_mean=rest_mean,
        rest_variance=rest_variance,
        fit=np.array(fits),
    )
