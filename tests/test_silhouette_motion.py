"""Whether a silhouette shows motion: worked by hand, on rectangles."""

import math

import pytest
from staging import NOBODY, report

from calibration.gate.silhouette_motion import State, init, moves, step
from common.bus.instant import Instant
from common.bus.messages import View, ViewerNumber
from common.raster.similarity import Mask

RATE_HZ = 15.0


def block(left: int, wide: int = 20) -> Mask:
    mask = NOBODY.copy()
    mask[20:100, left : left + wide] = True
    return mask


def after(first: list[Mask], second: list[Mask], rate_hz: float = RATE_HZ) -> State:
    state = init(2)
    for n, masks in enumerate(zip(first, second, strict=True)):
        state = step(
            state, Instant((told(1, masks[0], n / rate_hz), told(2, masks[1], n / rate_hz)))
        )
    return state


def told(viewer: ViewerNumber, mask: Mask, captured_s: float) -> View:
    return report(viewer, mask, captured_s=captured_s, area_px=int(mask.sum()))


@pytest.mark.parametrize(("shift_px", "moved"), [(0, False), (1, False), (2, True), (9, True)])
def test_a_shift_by_a_tenth_of_the_breadth_is_motion(shift_px: int, moved: bool) -> None:
    """Of 20 columns 2 are lost and 2 are new: 0.2 of the area; of one, 0.1."""
    still = [block(40)] * 9
    state = after(still, [block(40)] * 8 + [block(40 + shift_px)])
    assert moves(state) == (False, moved)


@pytest.mark.parametrize("rate_hz", [5.0, 15.0, 60.0])
def test_what_moved_longer_ago_than_half_a_second_is_over(rate_hz: float) -> None:
    later = [block(80)] * (round(rate_hz) + 1)
    assert moves(after([block(40), *later], [block(80), *later], rate_hz)) == (False, False)
    short = [block(80)] * math.ceil(rate_hz / 2)
    assert moves(after([block(40), *short], [block(80), *short], rate_hz)) == (True, False)


def test_less_than_half_a_second_and_an_empty_view_tell_nothing() -> None:
    assert moves(after([block(40), block(80)], [block(40), block(80)])) == (False, False)
    walked = [block(40 + n) for n in range(9)]
    assert moves(after([*walked, NOBODY], [*walked, block(60)])) == (False, True)


def test_a_view_that_says_nothing_keeps_what_it_showed() -> None:
    walked = [block(40 + n) for n in range(9)]
    state = after(walked, walked)
    assert step(state, Instant((None, told(2, block(48), 9 / RATE_HZ))))[0] == state[0]
    assert moves(state) == (True, True)


@pytest.mark.parametrize(("changed_px", "moved"), [(240, False), (241, True)])
def test_motion_is_more_than_fifteen_hundredths_of_the_area(changed_px: int, moved: bool) -> None:
    """Of 1600 pixels 240."""
    other = block(40)
    spare = NOBODY.copy()
    spare[20:100, 70:74] = True
    rows, columns = spare.nonzero()
    other[rows[:changed_px], columns[:changed_px]] = True
    still = [block(40)] * 8
    state = step(
        after(still, still),
        Instant(
            (
                report(1, other, captured_s=8 / RATE_HZ, area_px=1600),
                told(2, block(40), 8 / RATE_HZ),
            )
        ),
    )
    assert moves(state) == (moved, False)
