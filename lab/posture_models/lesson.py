"""A posture from a few takes of it: whether they agree, and what it may be mistaken for."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from lab.posture_models.learning import extended
from recognizer.codebook import LearningError
from recognizer.features import Rows, with_pose
from recognizer.postures import STATES, PostureModel, scored

LEAST_TAKES: Final = 3
"""With fewer nothing can be told of how takes of one posture differ."""


class Take(NamedTuple):
    """One performance, judged by a model that learnt the others and not this one."""

    margin: float
    """How much likelier a frame is of the taught posture than of the likeliest other, log; below
    0 the take is mistaken."""
    rival: str
    """The likeliest of the others."""


class Lesson(NamedTuple):
    """What came of teaching."""

    model: PostureModel
    """Knows the taught posture too; the others are as they were."""
    takes: tuple[Take, ...]

    @property
    def mistaken(self) -> tuple[int, ...]:
        """Takes that a model of the others does not know again."""
        return tuple(i for i, take in enumerate(self.takes) if take.margin <= 0.0)


def taught(
    known: PostureModel, posture: str, takes: Sequence[Rows], performers: Sequence[str] = ()
) -> Lesson:
    """A model that knows one posture more, or one of its own by these takes alone.

    Args:
        known: What it is added to.
        posture: The name; of one that is known nothing is kept but its place.
        takes: (n, 20) of each performance.
        performers: Whose they are, for the card.

    Raises:
        LearningError: When there are too few takes, or one shows too little, or most takes are
            not known again by what the others teach.
    """
    if len(takes) < LEAST_TAKES:
        raise LearningError(
            f"{len(takes)} of {LEAST_TAKES} takes of {posture}: record at least {LEAST_TAKES}, "
            "the same motion each time"
        )
    for i, rows in enumerate(takes):
        if len(with_pose(rows)) < STATES:
            raise LearningError(
                f"take {i + 1} has fewer than {STATES} frames of motion in which the person was"
                " tracked: record it again"
            )
    judged = tuple(_judged(known, posture, takes, i) for i in range(len(takes)))
    lesson = Lesson(extended(known, {posture: takes}, performers), judged)
    if 2 * len(lesson.mistaken) > len(takes):
        rivals = ", ".join(sorted({judged[i].rival for i in lesson.mistaken}))
        raise LearningError(
            f"takes {_numbers(lesson.mistaken)} of {len(takes)} are not known again by the others:"
            f" they are likelier {rivals}; record the same motion each time, or another posture"
        )
    return lesson


def _judged(known: PostureModel, posture: str, takes: Sequence[Rows], i: int) -> Take:
    others = [rows for k, rows in enumerate(takes) if k != i]
    seen = with_pose(takes[i])
    scores = scored(extended(known, {posture: others}), seen)
    own = scores.pop(posture)
    rival = max(scores, key=scores.__getitem__)
    return Take((own - scores[rival]) / len(seen), rival)


def _numbers(takes: Sequence[int]) -> str:
    return ", ".join(str(i + 1) for i in takes)
