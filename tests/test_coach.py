"""Teaching live: who stands is counted in, and a take is from the first movement to the last."""

import numpy as np
import pytest

from tritrack.training.coach import (
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
