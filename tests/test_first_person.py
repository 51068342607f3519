"""One body of each instant: the first person's who is in sight."""

from common.bus.messages import Body, Status
from runtime.bridges.first_person import of_first


def a_body(instant: int, person: int, status: Status) -> Body:
    return Body(
        frame=instant,
        captured_s=instant / 15,
        clock_s=instant / 15,
        status=status,
        views="none",
        person=person,
    )


def taken(*bodies: tuple[int, int, Status]) -> list[tuple[int, int]]:
    return [(body.frame, body.person) for body in of_first(a_body(*told) for told in bodies)]


def test_of_each_instant_the_lowest_number_in_sight_is_taken() -> None:
    assert taken(
        (0, 1, "tracking"),
        (0, 2, "tracking"),
        (1, 1, "lost"),
        (1, 2, "predicted"),
        (1, 3, "tracking"),
        (2, 1, "measuring"),
        (2, 2, "tracking"),
    ) == [(0, 1), (1, 2), (2, 1)]


def test_an_instant_in_which_all_are_lost_has_none() -> None:
    assert taken((0, 1, "lost"), (0, 2, "lost"), (1, 2, "tracking")) == [(1, 2)]


def test_every_body_of_a_run_that_follows_one_person_is_taken() -> None:
    told: list[tuple[int, int, Status]] = [(0, 0, "empty"), (1, 0, "tracking"), (2, 0, "lost")]
    assert taken(*told, *told) == [(frame, 0) for frame in (0, 1, 2, 0, 1, 2)]
