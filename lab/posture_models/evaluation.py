"""Recognition of unseen people's postures: table 2 of the paper, with intervals."""

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
    """Its clip or run."""


class Outcome(NamedTuple):
    """The result for a recording."""

    truth: str
    named: str
    performer: str = ""
    clip: str = ""
    margin: float = math.nan
    """Mean log-likelihood per frame of the truth minus that of the best other posture; negative
    for a mistake, NaN where the truth has no model."""
    fit: float = math.nan
    """Mean log-likelihood per frame of the recognised posture."""
    fit_of_others: float = math.nan
    """That of the best posture other than the truth: the result if the truth had not been
    trained."""
    known: bool = True
    """The truth has a model."""


Fold = tuple[list[Recording], list[Recording]]
"""Performers for training, and for testing."""


def recognise(
    learnt_from: Sequence[Recording],
    tested_on: Sequence[Recording],
    recognizer: Recognizer = "default",
    topology: Topology = "ergodic",
    seed: int = 0,
    sizes: Sizes = Sizes(),
) -> list[Outcome]:
    """Train on some people and recognise others.

    Raises:
        LearningError: When a performer is in both sets.
    """
    performers = sorted({recording.performer for recording in learnt_from})
    sequences: dict[str, list[Rows]] = {}
    for recording in learnt_from:
        sequences.setdefault(recording.posture, []).append(recording.rows)
    refuse_who_was_learnt_from(performers, tested_on)
    model = train(sequences, recognizer, topology, seed, performers, sizes)
    return named_by(model, tested_on)


def refuse_who_was_learnt_from(performers: Sequence[str], tested_on: Sequence[Recording]) -> None:
    """Refuse to test on people in the training data.

    Raises:
        LearningError: When one is in both.
    """
    both = sorted({recording.performer for recording in tested_on} & set(performers))
    if both:
        raise LearningError(f"{', '.join(both)}: in training and in test; split by performer")


def named_by(model: PostureModel, tested_on: Sequence[Recording]) -> list[Outcome]:
    """A model's result for each recording (P58)."""
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
    """Leave-one-out: each performer tested with a model of all others."""
    for performer in sorted({recording.performer for recording in recordings}):
        yield (
            [one for one in recordings if one.performer != performer],
            [one for one in recordings if one.performer == performer],
        )


def confusion(outcomes: Collection[Outcome], names: Sequence[str]) -> NDArray[np.int64]:
    """Count of each posture (row) recognised as each (column), shape (p, p + 1).

    The last column counts recordings without a name, or with one that is not evaluated.
    """
    counts = np.zeros((len(names), len(names) + 1), np.int64)
    column = {posture: i for i, posture in enumerate(names)}
    for outcome in outcomes:
        counts[column[outcome.truth], column.get(outcome.named, len(names))] += 1
    return counts


def wilson(correct: int, tested: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a share; (0, 1) without tests."""
    if tested == 0:
        return 0.0, 1.0
    share, z2 = correct / tested, Z_95**2
    centre = share + z2 / (2 * tested)
    reach = Z_95 * math.sqrt(share * (1 - share) / tested + z2 / (4 * tested**2))
    return (centre - reach) / (1 + z2 / tested), (centre + reach) / (1 + z2 / tested)


def table(counts: NDArray[np.int64], names: Sequence[str]) -> str:
    """Table 2 as text: correct of tested for each posture, its confusions, the total.

    Args:
        counts: (p, p + 1), from `confusion`.

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
