"""Whose turn it is to be looked at, while a run of several people is late."""

import pytest
from staging import RIG

from common.config.settings import Settings
from common.method import DEFAULT
from integrator import merge_state
from integrator.people import look_turns
from integrator.people.known_life import NO_TRACK, Life
from integrator.people.recognition import born

PERIOD_S = 1 / 15
ROOM = merge_state.init(RIG, PERIOD_S, Settings(people="all"), DEFAULT)
EARLY_S, LATE_S = 0.7 * PERIOD_S, 0.8 * PERIOD_S


def lives(*tracks: tuple[int, ...]) -> list[Life]:
    return [born(ROOM, 1 + n, each, 0.0) for n, each in enumerate(tracks)]


def dues(late_s: list[float], people: list[Life]) -> list[tuple[int | None, ...]]:
    state, found = look_turns.State(), []
    for each in late_s:
        state, due = look_turns.step(state, each, PERIOD_S, people)
        found.append(due)
    return found


def test_people_take_turns_for_a_second_after_a_late_instant_and_not_without() -> None:
    two = lives((4, 7), (5, 8))
    assert not any(dues([EARLY_S] * 20, two))
    found = dues([LATE_S, *[EARLY_S] * 19], two)
    assert [bool(due) for due in found] == [True] * 15 + [False] * 5


def test_each_view_looks_at_another_person_and_at_the_other_one_next() -> None:
    found = dues([LATE_S] * 4, lives((4, 7), (5, 8)))
    assert found == [(5, 7), (4, 8)] * 2


def test_three_people_in_two_views_are_each_looked_at_in_two_of_three_instants() -> None:
    found = dues([LATE_S] * 6, lives((0, 0), (1, 1), (2, 2)))
    for person in range(3):
        assert sum(person in due for due in found) == 4


@pytest.mark.parametrize(
    ("people", "due"),
    [(((4, 7),), ()), (((4, 7), (5, NO_TRACK)), (5, None)), ((), ())],
    ids=["one person", "one in a view", "no person"],
)
def test_where_a_view_shows_one_person_at_most_they_are_looked_at(
    people: tuple[tuple[int, ...], ...], due: tuple[int | None, ...]
) -> None:
    assert dues([LATE_S], lives(*people)) == [due]
