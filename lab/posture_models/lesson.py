"""A posture from a few takes: whether they agree, and which posture it resembles."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from lab.posture_models.learning import extended
from recognizer.codebook import LearningError
from recognizer.features import Rows, with_pose
from recognizer.postures import STATES, PostureModel, scored

LEAST_TAKES: Final = 3
"""Fewest takes: fewer do not show how takes of one posture differ."""


class Take(NamedTuple):
    """One take, judged by a model trained on the others and not on this one."""

    margin: float
    """Log-likelihood per frame of the taught posture minus that of the likeliest other; below 0
    the take is mistaken."""
    rival: str
    """The likeliest of the other postures."""


class Lesson(NamedTuple):
    """The result of teaching."""

    model: PostureModel
    """Has the taught posture too; the others are unchanged."""
    takes: tuple[Take, ...]

    @property
    def mistaken(self) -> tuple[int, ...]:
        """Takes that a model of the others does not recognise."""
        return tuple(i for i, take in enumerate(self.takes) if take.margin <= 0.0)


def taught(
    known: PostureModel, posture: str, takes: Sequence[Rows], performers: Sequence[str] = ()
) -> Lesson:
    """A model with one more posture, or with one of its own retrained from these takes alone.

    Args:
        known: The model to extend.
        posture: The name; of an existing one only the index is kept.
        takes: (n, 20) of each performance.
        performers: Their performers, for the model card.

    Raises:
        LearningError: When there are too few takes, or one shows too little, or a model of the
            others fails to recognise most takes.
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
