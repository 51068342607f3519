"""How well postures of unseen people are named: table 2 of the paper, with intervals."""

import math
from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lab.posture_models.learning import Sizes, train
from recognizer.codebook import LearningError
from recognizer.features import Rows, with_pose
from recognizer.postures import (
    POSTURES,
    PostureModel,
    Recognizer,
    Topology,
    likeliest,
    scored,
)

Z_95 = 1.959964
"""Standard normal quantile of a two-sided interval of 95 %."""


class Recording(NamedTuple):
    """One performance of one posture."""

    performer: str
    posture: str
    rows: Rows
    clip: str = ""
    """Where it comes from."""


class Outcome(NamedTuple):
    """What a recording was taken for."""

    truth: str
    named: str
    performer: str = ""
    clip: str = ""
    margin: float = math.nan
    """By how much a frame's log-likelihood of the truth is above that of the best other posture,
    on average; negative where it was mistaken, NaN where the truth has no model."""
    fit: float = math.nan
    """Log-likelihood of a frame of what was named, on average."""
    fit_of_others: float = math.nan
    """Fit of the best posture but the truth: what would be named had it not been learnt."""
    known: bool = True
    """The truth has a model."""


Fold = tuple[list[Recording], list[Recording]]
"""Whom to learn from, and whom to name."""


def recognise(
    learnt_from: Sequence[Recording],
    tested_on: Sequence[Recording],
    recognizer: Recognizer = "default",
    topology: Topology = "ergodic",
    seed: int = 0,
    sizes: Sizes = Sizes(),
) -> list[Outcome]:
    """Train on some people and name what others do.

    Raises:
        LearningError: When a performer is in both sets: that would measure memory.
    """
    performers = sorted({recording.performer for recording in learnt_from})
    sequences: dict[str, list[Rows]] = {}
    for recording in learnt_from:
        sequences.setdefault(recording.posture, []).append(recording.rows)
    refuse_who_was_learnt_from(performers, tested_on)
    model = train(sequences, recognizer, topology, seed, performers, sizes)
    return named_by(model, tested_on)


def refuse_who_was_learnt_from(performers: Sequence[str], tested_on: Sequence[Recording]) -> None:
    """People seen in training are not tested.

    Raises:
        LearningError: When one is.
    """
    both = sorted({recording.performer for recording in tested_on} & set(performers))
    if both:
        raise LearningError(f"{', '.join(both)}: in training and in test; split by performer")


def named_by(model: PostureModel, tested_on: Sequence[Recording]) -> list[Outcome]:
    """What a model takes each recording for (P58)."""
    return [_outcome(model, one) for one in tested_on]


def _outcome(model: PostureModel, one: Recording) -> Outcome:
    seen, known = with_pose(one.rows), one.posture in model.names
    named, margin, fit, other = "", math.nan, math.nan, math.nan
    if len(seen):
        fits = {name: score / len(seen) for name, score in scored(model, seen).items()}
        named = likeliest(fits)
        fit, own = fits[named], fits.pop(one.posture, math.nan)
        other = max(fits.values(), default=math.nan)
        margin = own - other
    return Outcome(one.posture, named, one.performer, one.clip, margin, fit, other, known)


def folds(recordings: Sequence[Recording]) -> Iterator[Fold]:
    """Each performer to be named by a model of all others."""
    for performer in sorted({recording.performer for recording in recordings}):
        yield (
            [one for one in recordings if one.performer != performer],
            [one for one in recordings if one.performer == performer],
        )


def confusion(outcomes: Collection[Outcome], names: Sequence[str]) -> NDArray[np.int64]:
    """How often each posture (row) was taken for each (column), shape (p, p + 1).

    The last column counts those that got no name, or one that is not asked for.
    """
    counts = np.zeros((len(names), len(names) + 1), np.int64)
    column = {posture: i for i, posture in enumerate(names)}
    for outcome in outcomes:
        counts[column[outcome.truth], column.get(outcome.named, len(names))] += 1
    return counts


def wilson(correct: int, tested: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a share; (0, 1) where nothing was tested."""
    if tested == 0:
        return 0.0, 1.0
    share, z2 = correct / tested, Z_95**2
    centre = share + z2 / (2 * tested)
    reach = Z_95 * math.sqrt(share * (1 - share) / tested + z2 / (4 * tested**2))
    return (centre - reach) / (1 + z2 / tested), (centre + reach) / (1 + z2 / tested)


def table(counts: NDArray[np.int64], names: Sequence[str]) -> str:
    """Table 2 as text: correct of tested for each posture, what it was mistaken for, the total.

    Args:
        counts: (p, p + 1), what `confusion` gives.

    Source: Huang & Chung 2004, table 2 (P59).
    """
    width = max(len(posture) for posture in (*names, "posture"))
    lines = [f"{'posture':{width}}  {'movement':11}  correct  mistaken for"]
    for row, posture in enumerate(names):
        result = f"{counts[row, row]:3d}/{counts[row].sum():<3d}"
        movement = POSTURES.get(posture, "")
        mistaken = ", ".join(_mistaken(counts[row], row, names))
        lines.append(f"{posture:{width}}  {movement:11}  {result}  {mistaken}".rstrip())
    correct, tested = int(np.trace(counts)), int(counts.sum())
    low, high = wilson(correct, tested)
    share = correct / tested if tested else 0.0
    total = f"{correct}/{tested} = {share:.1%} (95 % interval {low:.1%} to {high:.1%})"
    return "\n".join([*lines, f"all: {total}"])


def _mistaken(row: NDArray[np.int64], own: int, names: Sequence[str]) -> Iterator[str]:
    for column, count in enumerate(row.tolist()):
        if count and column != own:
            yield f"{names[column] if column < len(names) else 'nothing'} {count}"
