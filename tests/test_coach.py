"""Teaching live: who stands is counted in, and a take is from the first movement to the last."""

from typing import Any

import numpy as np
import pytest

from lab.training.coach import (
    AGAIN_LOST,
    AGAIN_SHORT,
    AGAIN_STILL,
    LONGEST_S,
    Look,
    Said,
    State,
    step,
)

RATE_HZ = 15.0
STILL = np.zeros((15, 3))


def looks(*parts: tuple[str, float], begin_s: float = 0.0) -> list[Look]:
    """Somebody who stands, waves (an arm 0.6 m up and down in a second), holds it up or is gone."""
    found: list[Look] = []
    for what, lasts_s in parts:
        for _ in range(round(lasts_s * RATE_HZ)):
            time_s = begin_s + len(found) / RATE_HZ
            joints_m = STILL.copy()
            if what == "waves":
                joints_m[5, 1] = 0.3 * np.sin(2 * np.pi * time_s)
            if what == "holds":
                joints_m[5, 1] = 0.6
            row = np.full(20, float(len(found)))
            found.append(Look(time_s, row, None if what == "gone" else joints_m))
    return found


def coached(*parts: tuple[str, float], count_s: float = 3.0) -> list[tuple[float, Said]]:
    """When what was said."""
    state, told = State("star_jump", count_s), []
    for look in looks(*parts):
        state, said = step(state, look)
        if said.word:
            told.append((look.time_s, said))
    return told


def words(*parts: tuple[str, float], count_s: float = 3.0) -> list[str]:
    return [said.word for _, said in coached(*parts, count_s=count_s)]


def test_who_stands_is_counted_in_by_seconds() -> None:
    told = coached(("stands", 6.0))
    assert [said.word for _, said in told] == [
        *("3", "2", "1"),
        "now: star_jump, once, then stand still",
    ]
    times = [time_s for time_s, _ in told]
    assert np.diff(times) == pytest.approx(1.0, abs=0.1)
    assert times[0] < 1.0


def test_a_take_is_what_is_moved_between_standing_and_standing() -> None:
    told = coached(("stands", 5.0), ("waves", 2.0), ("stands", 2.0))
    (take,) = (said.take for _, said in told if said.take is not None)
    frames = take[:, 0]
    assert frames[0] == pytest.approx(75, abs=8)
    assert frames[-1] == pytest.approx(105, abs=8)
    assert (np.diff(frames) == 1).all()


def test_who_holds_an_arm_up_is_in_the_middle_of_a_take() -> None:
    told = coached(("stands", 5.0), ("holds", 1.5), ("stands", 2.0))
    (take,) = (said.take for _, said in told if said.take is not None)
    assert take[-1, 0] == pytest.approx(98, abs=8)


def test_who_goes_on_standing_otherwise_has_ended() -> None:
    assert "thank you" in words(("stands", 5.0), ("waves", 1.0), ("holds", 4.0))


def test_three_performances_are_three_takes() -> None:
    once = (("stands", 5.0), ("waves", 1.5))
    told = coached(*once, *once, *once, ("stands", 2.0))
    assert sum(said.take is not None for _, said in told) == 3


def test_who_moves_while_nobody_counts_is_not_taken() -> None:
    assert words(("waves", 8.0)) == []


def test_nobody_is_counted_in() -> None:
    assert words(("gone", 8.0)) == []


def test_a_twitch_is_no_take() -> None:
    assert words(("stands", 5.0), ("waves", 0.2), ("stands", 1.5))[4] == AGAIN_SHORT


def test_who_is_lost_in_a_take_does_it_again() -> None:
    told = words(("stands", 5.0), ("waves", 1.0), ("gone", 0.5), ("stands", 6.0))
    assert told[4:] == [AGAIN_LOST, "3", "2", "1", "now: star_jump, once, then stand still"]


def test_who_does_nothing_is_asked_once_more() -> None:
    assert words(("stands", 4.5 + LONGEST_S))[4] == AGAIN_STILL


def test_a_motion_without_an_end_is_cut() -> None:
    told = coached(("stands", 5.0), ("waves", LONGEST_S + 3.0))
    (take,) = (said.take for _, said in told if said.take is not None)
    assert len(take) / RATE_HZ == pytest.approx(LONGEST_S, abs=1.0)


def test_without_counting_it_begins_at_once() -> None:
    assert words(("stands", 2.0), count_s=0.0) == ["now: star_jump, once, then stand still"]


def look(time_s: float, aside_m: float = 0.0, moved_m: float = 0.0) -> Look:
    """A body that stands so far aside, its last joint so much farther."""
    joints_m = np.full((15, 3), aside_m)
    joints_m[14, 1] += moved_m
    return Look(time_s, np.full(20, time_s), joints_m)


def state_of(doing: str, **parts: Any) -> State:
    return State("bow", 3.0)._replace(doing=doing, **parts)


@pytest.mark.parametrize(("moved_m", "still"), [(0.119, True), (0.121, False)])
def test_a_joint_that_comes_twelve_centimetres_far_moves(moved_m: float, still: bool) -> None:
    """Within the last 0.4 s: what was before that does not count."""
    state = state_of("waiting", seen=(look(0.9, 5.0), look(1.0)), still_s=0.5)
    after, _ = step(state, look(1.35, moved_m=moved_m))
    assert after.still_s == (0.5 if still else None)
    assert [one.time_s for one in after.seen] == [1.0, 1.35]


def test_standing_begins_with_the_first_look_in_which_nothing_moves() -> None:
    state = state_of("waiting", seen=(look(0.5, 5.0), look(1.0), look(1.2)))
    assert step(state, look(1.35))[0].still_s == 1.0
    alone = state_of("waiting", seen=(look(0.5),))
    assert step(alone, look(1.35))[0].still_s is None, "one look tells nothing"


@pytest.mark.parametrize(("time_s", "doing"), [(1.49, "waiting"), (1.5, "counting")])
def test_half_a_second_of_standing_is_counted_from(time_s: float, doing: str) -> None:
    state = state_of("waiting", seen=(look(1.3),), still_s=1.0)
    after, said = step(state, look(time_s))
    assert (after.doing, said.word) == (doing, "3" if doing == "counting" else "")


def test_numbers_are_counted_once_each_and_then_it_is_time() -> None:
    state = state_of("counting", since_s=1.0, seen=(look(0.9),), still_s=0.5)
    words = []
    for time_s in (1.0, 1.5, 2.0, 2.9, 3.0, 3.9, 4.0):
        state, said = step(state, look(time_s))
        words.append(said.word)
    assert words == ["3", "", "2", "", "1", "", "now: bow, once, then stand still"]
    assert (state.doing, state.since_s, state.told) == ("ready", 4.0, 0)


@pytest.mark.parametrize(("time_s", "word"), [(14.0, ""), (14.1, "nothing moved: once more")])
def test_nobody_is_waited_for_longer_than_twelve_seconds(time_s: float, word: str) -> None:
    state = state_of("ready", since_s=2.0, seen=(look(time_s - 0.1),), still_s=1.0)
    after, said = step(state, look(time_s))
    assert (said.word, after.doing) == (word, "waiting" if word else "ready")


def moving(still_s: float | None, since_s: float = 2.0) -> State:
    """A take from 2 s on; before it the person stood at the middle."""
    seen = (look(1.9), look(2.0), look(3.0, 1.0), look(4.0, 2.0), look(4.3, 2.0))
    return state_of("moving", since_s=since_s, seen=seen, still_s=still_s)


@pytest.mark.parametrize(
    ("moved_m", "still_s", "ends"),
    [
        (0.24, 4.1, True),
        (0.24, 4.3, False),
        (0.26, 4.1, False),
        (0.26, 2.61, False),
        (0.26, 2.59, True),
    ],
    ids=["home", "home, too shortly", "elsewhere", "nearly two seconds", "two seconds"],
)
def test_a_take_ends_at_home_after_half_a_second_and_elsewhere_after_two(
    moved_m: float, still_s: float, ends: bool
) -> None:
    """It is looked at 4.6 s; home is a quarter of a metre about, beside the pelvis."""
    state = moving(still_s)
    seen = (*state.seen[:-1], look(4.3, 2.0, moved_m))
    after, said = step(state._replace(seen=seen), look(4.6, 2.0, moved_m))
    assert (said.take is not None or said.word != "") == ends
    assert after.doing == ("waiting" if ends else "moving")


def test_a_take_holds_all_rows_until_its_last_movement_and_is_not_too_short() -> None:
    _, said = step(moving(4.0), look(4.6, 2.0))
    assert said.take is not None
    assert said.take[:, 0].tolist() == [1.9, 2.0, 3.0, 4.0]
    assert said.word == "thank you"
    for since_s, short in ((3.29, False), (3.31, True)):
        _, said = step(moving(4.0, since_s), look(4.6, 2.0))
        assert (said.word == "that was too short: once more") == short
        assert (said.take is None) == short


@pytest.mark.parametrize(("time_s", "cut"), [(14.0, False), (14.1, True)])
def test_a_take_that_does_not_end_is_cut_after_twelve_seconds(time_s: float, cut: bool) -> None:
    after, said = step(moving(None), look(time_s, 9.0))
    assert (said.take is not None) == cut
    if said.take is not None:
        assert said.take[-1, 0] == time_s
        assert [one.time_s for one in after.seen] == [time_s]


@pytest.mark.parametrize("doing", ["waiting", "counting", "ready", "moving"])
def test_who_is_lost_begins_anew_and_is_told_so_unless_nothing_had_begun(doing: str) -> None:
    state = state_of(doing, since_s=2.0, seen=(look(2.0),), still_s=1.0, told=2)
    after, said = step(state, Look(3.0, np.zeros(20), None))
    assert said.word == ("" if doing == "waiting" else "you were lost from sight: once more")
    assert (after.doing, after.since_s, after.still_s, after.seen, after.told) == (
        "waiting",
        3.0,
        None,
        (),
        0,
    )
