"""What cameras saw of a board so far: poses, parts of the picture, and what is still needed."""

import numpy as np
import pytest

from calibration.board.board_progress import (
    ALONE,
    MIRRORED,
    SHARED,
    BoardProgress,
    Sight,
    init,
    is_enough,
    missing_parts,
    step,
    words_of,
)
from common.body.body import Vector

SIZE = (640, 480)
NONE = Sight(None)


def at(x: float, y: float, side_px: float = 160.0) -> Sight:
    """A board of 4 x 3 corners with its upper left one there."""
    across, down = np.meshgrid(np.linspace(0, side_px, 4), np.linspace(0, side_px * 0.75, 3))
    px: Vector = np.column_stack([across.ravel() + x, down.ravel() + y])
    return Sight(px)


def held(state: BoardProgress, time_s: float, *sights: Sight) -> BoardProgress:
    """Half a second, five pictures."""
    for n in range(6):
        state = step(state, time_s + n / 10, sights)
    return state


def test_a_board_that_rests_counts_once_and_one_that_moves_not_at_all() -> None:
    state = held(held(init([SIZE]), 0.0, at(10, 10)), 0.6, at(10, 10))
    assert state.cameras[0].poses == 1
    for n in range(20):
        state = step(state, 2.0 + n / 10, [at(10 + 20 * n, 100)])
    assert state.cameras[0].poses == 1
    assert held(state, 9.0, at(300, 200)).cameras[0].poses == 2


def test_a_pose_is_shared_where_two_cameras_see_the_board_at_rest_together() -> None:
    state = held(init([SIZE, SIZE]), 0.0, at(10, 10), NONE)
    state = held(state, 1.0, NONE, at(10, 10))
    assert [seen.shared for seen in state.cameras] == [0, 0]
    state = held(held(state, 2.0, at(200, 10), NONE), 3.0, at(200, 10), at(90, 90))
    assert [seen.shared for seen in state.cameras] == [1, 1]
    assert [seen.poses for seen in state.cameras] == [2, 2]
    state = held(state, 4.0, at(200, 10), at(90, 90))
    assert [seen.shared for seen in state.cameras] == [1, 1], "once each"


def test_the_parts_that_are_missing_are_named() -> None:
    state = init([SIZE])
    for row in range(3):
        for column in range(3):
            if (row, column) not in ((0, 2), (1, 1)):
                state = held(state, 9.0 * row + 3 * column, at(213 * column, 160 * row, 213))
    assert missing_parts(state.cameras[0]) == ["upper right", "in the middle"]
    assert "hold it upper right, in the middle" in words_of(state, ["cam1"])[0]


def test_what_is_enough_is_said_and_what_to_do_last() -> None:
    state = init([SIZE, SIZE])
    places = [(column, row) for row in (0, 160, 320) for column in (0, 213, 426)]
    for n in range(ALONE):
        x, y = places[n % len(places)]
        both = n < SHARED
        state = held(state, 2.0 * n, at(x, y, 213), at(x, y, 213) if both else NONE)
        assert not is_enough(state)
    assert words_of(state, ["one", "two"])[0].endswith("Enough.")
    assert f"{ALONE - SHARED} more, held still" in words_of(state, ["one", "two"])[1]
    for n in range(ALONE - SHARED):
        state = held(state, 100.0 + 2.0 * n, NONE, at(*places[n % len(places)], 213))
    assert is_enough(state)
    assert "on the floor" in words_of(state, ["one", "two"])[-1]


@pytest.mark.parametrize("times", [MIRRORED - 1, MIRRORED])
def test_a_mirrored_picture_is_named_with_its_cure(times: int) -> None:
    state = init([SIZE])
    for n in range(times):
        state = step(state, float(n), [Sight(None, in_mirror=True)])
    assert ("mirrored" in words_of(state, ["cam1"])[0]) == (times == MIRRORED)
