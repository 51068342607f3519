"""The retouching page's player: row by row, to the end or until it is stopped."""

import time

import pytest
from waiting import until

from animator.retouching.player import ROWS_HZ, Player


def test_it_plays_to_the_end_at_its_rate_and_stops_there() -> None:
    rows = iter(range(3))
    player = Player(lambda: next(rows, None) is not None)
    begun_s = time.monotonic()
    player.toggle()
    assert player.playing
    assert until(lambda: not player.playing)
    took_s = time.monotonic() - begun_s
    assert 4 / ROWS_HZ <= took_s < 16 / ROWS_HZ
    assert ROWS_HZ == 15.0, "the rate that the page plays a run at"
    assert next(rows, None) is None


def test_it_stops_where_it_is_asked_to_and_plays_on() -> None:
    shown: list[float] = []

    def advance() -> bool:
        shown.append(time.monotonic())
        return True

    player = Player(advance)
    player.toggle()
    assert until(lambda: len(shown) > 1)
    player.toggle()
    assert not player.playing
    time.sleep(2 / ROWS_HZ)
    count = len(shown)
    time.sleep(3 / ROWS_HZ)
    assert len(shown) == count
    player.toggle()
    assert until(lambda: len(shown) > count)
    player.stop()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_row_that_cannot_be_shown_ends_it_and_it_can_play_again() -> None:
    shown: list[int] = []

    def advance() -> bool:
        shown.append(len(shown))
        if len(shown) == 1:
            raise RuntimeError("no such row")
        return True

    player = Player(advance)
    player.toggle()
    assert until(lambda: not player.playing)
    player.toggle()
    assert until(lambda: len(shown) > 2)
    player.stop()
