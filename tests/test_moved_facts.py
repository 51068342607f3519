"""What a summary tells of cameras that were moved."""

import msgspec
from test_message_codec import BODY

from common.bus.messages import Body, ViewerNumber
from runtime.moved_facts import Moves, facts_of_moves, moved_facts, step


def body(at_s: float, *moved: ViewerNumber) -> Body:
    return msgspec.structs.replace(BODY, captured_s=at_s, moved=moved)


def test_a_run_whose_cameras_stood_still_tells_nothing() -> None:
    assert moved_facts([body(0.0), body(1.0)]) == {}


def test_each_move_is_told_with_its_camera_and_when_it_was_confirmed() -> None:
    bodies = [body(0.0), body(1.0, 2), body(2.0, 2), body(3.0), body(4.0, 1, 2), body(5.0, 1)]
    assert moved_facts(bodies) == {
        "moved_cameras": [
            {"camera": 2, "at_s": 1.0, "confirmed_s": 3.0},
            {"camera": 1, "at_s": 4.0, "confirmed_s": None},
            {"camera": 2, "at_s": 4.0, "confirmed_s": 5.0},
        ]
    }


def test_what_is_told_as_bodies_come_is_what_is_told_of_all() -> None:
    bodies = [body(0.0, 1), body(1.0, 1, 2), body(2.0), body(3.0, 1)]
    moves: Moves = ()
    for each in bodies:
        moves = step(moves, each)
    assert facts_of_moves(moves) == moved_facts(bodies)
