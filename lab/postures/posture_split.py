"""Splits into training and test people: models trained and tested on all cores."""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from typing import Final, NamedTuple

from rich.console import Console

from lab.posture_models.evaluation import (
    Fold,
    Outcome,
    Recording,
    folds,
    recognise,
    refuse_who_was_learnt_from,
)
from lab.posture_models.learning import Sizes
from lab.training.training import TrainingError
from recognizer.postures import Recognizer
from runtime.store.cores import made
from runtime.terminal import bar

EACH_IN_TURN: Final = "leave-one-performer-out"
"""The split in which each person is tested with a model of all others."""

SWEPT_SYMBOLS: Final = (16, 32, 64, 128, 256)
SWEPT_STATES: Final = (3, 4, 5, 6, 7, 8)
"""The paper's choice of 64 and 5 repeated: sizes of the codebook, and states of each model."""


class Job(NamedTuple):
    """One model to train and test."""

    group: str
    """Outcomes of the same group are counted together."""
    fold: Fold
    recognizer: Recognizer
    sizes: Sizes = Sizes()


def jobs_of(given: Sequence[Recording], split: str, kind: Recognizer) -> Iterator[Job]:
    """The jobs of the headline, and leave-one-performer-out within the test set.

    Args:
        given: Recordings of all people.
        split: EACH_IN_TURN, or performers to learn from and to test on: "anna,ben:cleo", "s1*:s2*".
        kind: Kind of model.

    Raises:
        TrainingError: When the split leaves no performer for training or for testing.
    """
    parts = parts_of(given, split)
    if parts is None:
        yield from (Job("headline", fold, kind) for fold in folds(given))
        return
    yield Job("headline", parts, kind)
    if len({one.performer for one in parts[1]}) > 1:
        yield from (Job("within test", fold, kind) for fold in folds(parts[1]))


def sweep_of(given: Sequence[Recording], split: str) -> Iterator[Job]:
    """The paper's recogniser in other sizes, on the headline's split.

    Raises:
        TrainingError: As `jobs_of`.
    """
    parts = parts_of(given, split)
    for fold in folds(given) if parts is None else [parts]:
        for symbols in SWEPT_SYMBOLS:
            for states in SWEPT_STATES:
                yield Job(swept(symbols, states), fold, "paper", Sizes(states, symbols))


def swept(symbols: int, states: int) -> str:
    """The group of a sweep's outcomes."""
    return f"{symbols} symbols, {states} states"


def parts_of(given: Sequence[Recording], split: str) -> Fold | None:
    """Performers for training and for testing; None where each is tested in turn.

    Raises:
        TrainingError: When no performer is left.
    """
    if split == EACH_IN_TURN:
        if len({one.performer for one in given}) < 2:
            raise TrainingError("one performer alone: none is left to learn from")
        return None
    learnt, colon, tested = split.partition(":")
    parts = _of(given, learnt), _of(given, tested)
    if not colon or not all(parts):
        raise TrainingError(
            f"the split {split!r} must be {EACH_IN_TURN} or name performers that are there, "
            f"to learn from and to test on, as in anna,ben:cleo"
        )
    return parts


def refuse_in_vain(given: Sequence[Recording], split: str) -> None:
    """Refuse, before the work, a split that would measure nothing.

    Args:
        given: Recordings of all people; their rows are not used.
        split: As for `jobs_of`.

    Raises:
        TrainingError: When it leaves no performer, or none with a posture that others are trained
        on.
        LearningError: When a performer is in training and in test.
    """
    parts = parts_of(given, split)
    for learnt, tested in folds(given) if parts is None else [parts]:
        refuse_who_was_learnt_from([one.performer for one in learnt], tested)
        if {one.posture for one in learnt} & {one.posture for one in tested}:
            return
    raise TrainingError(
        "none of the postures that are tested is shown by anybody who is learnt from: give clips "
        "of several performers who show the same postures"
    )


def judged(jobs: Sequence[Job], console: Console) -> dict[str, list[Outcome]]:
    """The outcomes of each group, in an order independent of the order of completion."""
    found: dict[str, list[Outcome]] = {job.group: [] for job in jobs}
    with bar(console) as progress:
        answers = progress.track(made(_answered, jobs), total=len(jobs), description="learning")
        for group, outcomes in answers:
            found[group] += outcomes
    return {group: sorted(outcomes, key=_place) for group, outcomes in found.items()}


def _answered(job: Job) -> tuple[str, list[Outcome]]:
    outcomes = recognise(*job.fold, job.recognizer, sizes=job.sizes)
    return job.group, outcomes


def _of(given: Sequence[Recording], people: str) -> list[Recording]:
    wanted = [pattern.strip() for pattern in people.split(",")]
    return [one for one in given if any(fnmatchcase(one.performer, name) for name in wanted)]


def _place(one: Outcome) -> tuple[str, str, str]:
    return one.performer, one.truth, one.clip
