"""The evaluation, held against the paper's table 2 and the interval that belongs to it."""

from typing import Any

import numpy as np
import pytest
from acting import perform

from lab.posture_models import evaluation
from lab.posture_models.evaluation import (
    Outcome,
    Recording,
    confusion,
    folds,
    named_by,
    recognise,
    table,
    wilson,
)
from lab.posture_models.learning import Sizes, train
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


def test_the_table_says_of_each_posture_what_it_was_mistaken_for() -> None:
    """The first by chance has as many rights as the second has mistakes; a user's own has no
    movement."""
    names = ("squat", "kick_left_side", "my own bow")
    counts = np.array([[10, 2, 0, 1], [0, 3, 0, 0], [4, 0, 5, 0]])
    low, high = wilson(18, 25)
    assert table(counts, names).splitlines() == [
        "posture         movement     correct  mistaken for",
        f"squat           {POSTURES['squat']:11}   10/13   kick_left_side 2, nothing 1",
        f"kick_left_side  {POSTURES['kick_left_side']:11}    3/3",
        "my own bow                     5/9    squat 4",
        f"all: 18/25 = 72.0% (95 % interval {low:.1%} to {high:.1%})",
    ]


def test_margin_and_fit_are_of_a_frame_and_of_the_best_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Five frames of which one has no pose: scores are shared among four."""
    model = train({name: [perform(name, 0)] * 3 for name in ("squat", "kick_left_side")})
    monkeypatch.setattr(
        evaluation, "scored", lambda *_: {"squat": -8.0, "kick_left_side": -4.0, "bow": -20.0}
    )
    rows = perform("squat", 1)[:5].copy()
    rows[2] = np.nan
    own, theirs = (Recording("ann", name, rows, "clip") for name in ("squat", "wave"))
    (one, other) = named_by(model, [own, theirs])
    assert one == Outcome("squat", "kick_left_side", "ann", "clip", -1.0, -1.0, -1.0, True)
    assert other[:4] == ("wave", "kick_left_side", "ann", "clip")
    assert np.isnan(other.margin)
    assert (other.fit, other.fit_of_others, other.known) == (-1.0, -1.0, False)
    empty = own._replace(rows=np.full((3, 20), np.nan))
    (nothing,) = named_by(model, [empty])
    assert (nothing.named, nothing.known) == ("", True)
    assert np.isnan([nothing.margin, nothing.fit, nothing.fit_of_others]).all()


def test_who_is_learnt_from_is_on_the_models_card_and_in_no_test(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    noted = []

    def training(sequences: object, *given: object) -> str:
        noted.append((sequences, *given))
        return "model"

    monkeypatch.setattr(evaluation, "train", training)
    monkeypatch.setattr(evaluation, "named_by", lambda model, tested: (model, tested))
    rows = [np.full((2, 20), n) for n in range(3)]
    learnt = [
        Recording("eve", "squat", rows[0]),
        Recording("bob", "wave", rows[1]),
        Recording("bob", "squat", rows[2]),
    ]
    tested = [Recording("ann", "squat", rows[0])]
    sizes = Sizes(3, 16)
    named: Any = recognise(learnt, tested, "paper", "left-right", 7, sizes)
    assert named == ("model", tested)
    ((sequences, *given),) = noted
    assert sequences == {"squat": [rows[0], rows[2]], "wave": [rows[1]]}
    assert given == ["paper", "left-right", 7, ["bob", "eve"], sizes]
