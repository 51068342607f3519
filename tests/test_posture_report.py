"""What a report says of known outcomes, worked by hand."""

import math

from lab.posture_models.evaluation import Outcome
from lab.postures.posture_report import WORST, postures_of, result_of, worst_of


def outcome(truth: str, named: str, margin: float, performer: str = "ann") -> Outcome:
    return Outcome(truth, named, performer, f"clips/{performer}_{truth}", margin, 30.0, 20.0)


OUTCOMES = [
    outcome("squat", "squat", 4.0),
    outcome("squat", "bow", -2.0, "bob"),
    outcome("bow", "bow", 1.0),
    outcome("walk_in_place", "walk_in_place", 9.0, "bob"),
]


def test_shares_are_told_by_posture_performer_and_movement() -> None:
    """P59: Wilson's interval of 3 of 4 is 30.1 to 95.4 %."""
    told = result_of(OUTCOMES, 25.0)
    assert (told["all"]["correct"], told["all"]["tested"]) == (3, 4)
    assert [round(end, 3) for end in told["all"]["interval_95"]] == [0.301, 0.954]
    counts = {name: (one["correct"], one["tested"]) for name, one in told["performers"].items()}
    assert counts == {"ann": (2, 2), "bob": (1, 2)}
    assert set(told["movements"]) == {"walking", "squatting", "other"}
    assert list(told["postures"]) == ["walk_in_place", "squat", "bow"]
    assert told["margins"]["lowest"] == -2.0
    assert told["margins"]["median"] == 2.5


def test_the_worst_are_the_mistaken_and_then_the_narrowest() -> None:
    assert [one.margin for one in worst_of(OUTCOMES)] == [-2.0, 1.0, 4.0, 9.0]
    assert len(worst_of(OUTCOMES * WORST)) == WORST
    assert worst_of([Outcome("squat", "")]) == []


def test_what_was_not_taught_is_counted_for_rejection_alone() -> None:
    """A known squat fits by 30, what it would be called else by 20; the limit lies between."""
    stranger = Outcome("jump", "squat", "cas", "", math.nan, 10.0, 10.0, known=False)
    told = result_of([*OUTCOMES, stranger], 25.0)
    assert told["all"]["tested"] == 4
    assert told["rejection"]["known"] == {"tested": 4, "no_name": 0}
    assert told["rejection"]["unknown"]["jump"] == {"tested": 1, "no_name": 1}
    assert told["rejection"]["unknown"]["squat"] == {"tested": 2, "no_name": 2}


def test_own_postures_follow_the_papers() -> None:
    assert postures_of(OUTCOMES) == ["walk_in_place", "squat", "bow"]
