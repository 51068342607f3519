"""What is said again: what no guide has heard of, when the integrator came back, and then alone."""

import msgspec

from common.bus.inbox import Alive
from common.bus.messages import View
from viewer.resend_buffer import HUB, MOST, ResendBuffer

WENT, CAME = Alive(HUB, alive=False), Alive(HUB, alive=True)


def report(frame: int) -> View:
    fields = {"viewer": 1, "width": 8, "height": 1}
    times = {"frame": frame, "captured_s": frame / 15, "clock_s": 0.0}
    return msgspec.convert({**fields, **times}, View)


def spoken(frames: int) -> ResendBuffer:
    one = ResendBuffer()
    for frame in range(frames):
        one.said(report(frame))
    return one


def again(one: ResendBuffer, heard: int, *alive: Alive) -> list[int]:
    return [each.frame for each in one.again(heard, alive)]


def test_what_was_not_heard_is_said_again_when_the_integrator_is_back() -> None:
    one = spoken(10)
    assert again(one, 5) == []
    assert again(one, 5, WENT) == []
    one.said(report(10))
    assert again(one, 5, Alive("viewer 2", alive=True)) == []
    assert again(one, 5, CAME) == [6, 7, 8, 9, 10]
    assert again(one, 5) == []


def test_an_integrator_that_comes_for_the_first_time_missed_nothing() -> None:
    assert again(spoken(3), -1, CAME) == []


def test_one_that_was_back_before_its_loss_was_told_missed_something_too() -> None:
    assert again(spoken(3), 0, WENT, CAME) == [1, 2]


def test_no_more_is_kept_than_a_new_start_takes() -> None:
    assert again(spoken(MOST + 9), -1, WENT, CAME) == list(range(9, MOST + 9))
