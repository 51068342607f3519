"""Which frames of a late viewer are in a hurry."""

from itertools import groupby

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.body.observation import Box, Landmarks, Observation
from common.bus.messages import View
from viewer.captured_frame import CapturedFrame
from viewer.load_shedding import LASTS_S, LATE, LoadShedder

PERIOD_S = 1 / 15
FRAME = CapturedFrame(0, 0.0, 0.0, np.zeros((2, 2, 3), np.uint8))


def hurried(late_s: list[float]) -> list[bool]:
    """Of frames that are so late."""
    shedder = LoadShedder(PERIOD_S, 1)
    return [shedder.of_frame(FRAME, late).hurried for late in late_s]


def test_who_is_in_time_looks_at_every_frame() -> None:
    assert not any(hurried([0.0, 0.002, 0.9 * LATE * PERIOD_S] * 20))


def test_a_late_frame_and_those_of_the_third_of_a_second_from_it_on_are_in_a_hurry() -> None:
    told = hurried([0.0, 0.03, *[0.0] * 8])
    assert told == [False, *[True] * 5, *[False] * 4]
    assert pytest.approx(1 / 3) == LASTS_S


def test_who_is_always_late_looks_at_every_sixth() -> None:
    told = hurried([0.2] * 60)
    assert [at for at, is_hurried in enumerate(told) if not is_hurried] == list(range(5, 60, 6))


@given(st.lists(st.floats(0.0, 0.2), max_size=100))
def test_never_more_than_five_looks_in_a_row_are_left_out_nor_one_without_a_late_frame(
    late_s: list[float],
) -> None:
    told = hurried(late_s)
    assert all(len([*own]) <= 5 for is_hurried, own in groupby(told) if is_hurried)
    is_late = [late > LATE * PERIOD_S for late in late_s]
    near = [any(is_late[max(0, at - 4) : at + 1]) for at in range(len(told))]
    assert all(due for is_hurried, due in zip(told, near, strict=True) if is_hurried)


def test_a_frame_in_a_hurry_is_the_same_picture_of_the_same_moment() -> None:
    kept = LoadShedder(PERIOD_S, 1).of_frame(FRAME, 1.0)
    assert (kept.index, kept.captured_s, kept.clock_s) == (0, 0.0, 0.0)
    assert kept.picture is FRAME.picture


def test_at_the_end_it_is_told_how_many_were_and_what_to_do_but_not_of_a_few() -> None:
    shedder = LoadShedder(PERIOD_S, 1)
    for late_s in (0.1, *[0.0] * 4):
        shedder.of_frame(FRAME, late_s)
    assert shedder.frames == 5
    assert shedder.odd(250) == ()
    (odd,) = shedder.odd(100)
    assert odd.startswith("5 of 100 frames came too late")
    assert "fewer rooms" in odd


@pytest.mark.parametrize(("frames", "told"), [(250, False), (249, True)])
def test_two_in_a_hundred_frames_may_be_hurried_without_a_word(frames: int, told: bool) -> None:
    shedder = LoadShedder(PERIOD_S, 1)
    shedder.frames = 5
    assert bool(shedder.odd(frames)) == told
    assert shedder.odd(40)[0].startswith(
        "5 of 40 frames came too late to be looked into, only their"
    )


@pytest.mark.parametrize(("period_s", "lasts"), [(1 / 30, 10), (1 / 4, 1), (1.0, 1)])
def test_a_hurry_lasts_a_third_of_a_second_at_any_rate(period_s: float, lasts: int) -> None:
    shedder = LoadShedder(period_s, 1)
    told = [shedder.of_frame(FRAME, late_s).hurried for late_s in (0.2 * period_s, *[0.0] * 15)]
    assert told == [True] * lasts + [False] * (16 - lasts)


def test_where_everyone_is_followed_a_viewer_keeps_its_landmarks_for_half_a_period() -> None:
    """Three viewers at once wait for each other; without landmarks they lose the second person."""
    shedder = LoadShedder(PERIOD_S, "all")
    assert not shedder.of_frame(FRAME, 0.45 * PERIOD_S).hurried
    assert shedder.of_frame(FRAME, 0.55 * PERIOD_S).hurried


def test_frames_in_which_people_were_looked_at_in_turn_are_counted_and_told() -> None:
    shedder = LoadShedder(PERIOD_S, "all")
    for people in ((of_track(0), of_track(1)), (of_track(0, carried=True), of_track(1)), ()):
        shedder.reported(report_of(people))
    assert shedder.in_turn == 1
    assert shedder.odd(50) == ()
    (odd,) = shedder.odd(49)
    assert odd.startswith("1 of 49 frames came late: people were looked at in turn")


def test_a_late_frame_with_a_look_at_anyone_is_not_counted_as_without_landmarks() -> None:
    shedder, seen = LoadShedder(PERIOD_S, "all"), Landmarks(((0.0, 0.0),) * 15, (0.9,) * 15)
    looked_at = msgspec.structs.replace(of_track(1), landmarks=seen)
    carried = msgspec.structs.replace(of_track(0, carried=True), landmarks=seen)
    for people in ((carried, looked_at), (of_track(0),), (looked_at,)):
        assert shedder.of_frame(FRAME, 2.0 * PERIOD_S).hurried
        shedder.reported(report_of(people))
    assert (shedder.frames, shedder.in_turn) == (1, 1)
    assert not [shedder.of_frame(FRAME, 0.0) for _ in range(5)][-1].hurried
    shedder.reported(report_of((of_track(0, carried=True), of_track(1))))
    assert (shedder.frames, shedder.in_turn) == (4, 2), "the integrator asked for that one"


def report_of(people: tuple[Observation, ...]) -> View:
    return View(frame=0, captured_s=0.0, clock_s=0.0, viewer=1, width=40, height=30, people=people)


def of_track(number: int, carried: bool = False) -> Observation:
    return Observation(
        track=number,
        width=40,
        height=30,
        silhouette=b"",
        box=Box(1, 1, 8, 8),
        area_px=64,
        carried=carried,
    )
