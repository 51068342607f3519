"""The evaluation, held against the paper's table 2 and the interval that belongs to it."""

import numpy as np
import pytest
from acting import perform

from recognizer.evaluation import (
    Outcome,
    Recording,
    confusion,
    folds,
    recognise,
    table,
    wilson,
)
from recognizer.postures import POSTURES

NAMES = tuple(POSTURES)
PRINTED = (22, 21, 23, 21, 24, 20, 23, 24, 22, 22, 23, 24, 21, 22, 20)
"""Table 2: correct recognitions of 24."""


def papers_outcomes() -> list[Outcome]:
    """Table 2 as outcomes; what was mistaken is not printed, so let it be unnamed."""
    return [
        Outcome(posture, posture if i < correct else "")
        for posture, correct in zip(NAMES, PRINTED, strict=True)
        for i in range(24)
    ]


def recordings(performers: tuple[str, ...]) -> list[Recording]:
    return [
        Recording(performer, posture, perform(posture, i))
        for i, performer in enumerate(performers)
        for posture in NAMES
    ]


def test_the_papers_table_gives_332_of_360_and_its_interval() -> None:
    """P59: 92.2 %, 89.0 to 94.6 %."""
    text = table(confusion(papers_outcomes(), NAMES), NAMES)
    assert "332/360 = 92.2% (95 % interval 89.0% to 94.6%)" in text.splitlines()[-1]


def test_each_line_of_the_table_is_the_papers() -> None:
    """P59: correct of 24 for each posture; the worst 20 of 24 = 83.3 %."""
    counts = confusion(papers_outcomes(), NAMES)
    assert tuple(np.diag(counts).tolist()) == PRINTED
    lines = table(counts, NAMES).splitlines()[1:-1]
    for line, posture, correct in zip(lines, NAMES, PRINTED, strict=True):
        assert line.startswith(posture)
        assert f"{correct}/24" in line
    assert min(np.diag(counts) / counts.sum(axis=1)) == pytest.approx(0.833, abs=5e-4)


@pytest.mark.parametrize(
    ("correct", "tested", "low", "high"),
    [(332, 360, 0.890, 0.946), (0, 10, 0.0, 0.278), (10, 10, 0.722, 1.0), (5, 10, 0.237, 0.763)],
)
def test_wilson_intervals_are_the_known_ones(
    correct: int, tested: int, low: float, high: float
) -> None:
    """P59, and values of the interval that statistics texts print for tens."""
    assert wilson(correct, tested) == pytest.approx((low, high), abs=5e-4)


def test_nothing_tested_tells_nothing() -> None:
    assert wilson(0, 0) == (0.0, 1.0)
    assert "0/0" in table(confusion([], NAMES), NAMES)


def test_confusion_counts_truth_by_row_and_the_unnamed_last() -> None:
    outcomes = [Outcome("a", "a"), Outcome("a", "b"), Outcome("b", ""), Outcome("b", "elsewhere")]
    assert confusion(outcomes, ("a", "b")).tolist() == [[1, 1, 0], [0, 0, 2]]
    assert "b 1" in table(confusion(outcomes, ("a", "b")), ("a", "b")).splitlines()[1]


def test_nobody_is_tested_who_was_learnt_from() -> None:
    people = recordings(("ann", "bob"))
    with pytest.raises(ValueError, match="bob: in training and in test"):
        recognise(people, people[15:])


def test_leaving_one_out_never_learns_from_the_one_tested() -> None:
    """Two people who call squats and kicks by each other's name: each is named by the other."""
    swapped = {"squat": "kick_left_side", "kick_left_side": "squat"}
    first, second = recordings(("ann",)), recordings(("bob",))
    crossed = [one._replace(posture=swapped.get(one.posture, one.posture)) for one in second]
    outcomes = [one for fold in folds([*first, *crossed]) for one in recognise(*fold)]
    assert len(outcomes) == 30
    for one in outcomes:
        if one.truth in swapped:
            assert one.named == swapped[one.truth]
