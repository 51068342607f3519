"""Detection of frozen pictures: identical bit for bit, or except for a codec's changes."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.compiled import compiled
from common.video.pictures import Image

FROZEN_AFTER: Final = 2
"""Repeats that may be no fault: files made for a faster rate hold each picture two or three
times, and no examined clip held one more than twice."""
FROZEN_S: Final = FROZEN_AFTER / 15
"""Duration of these repeats at the paper's rate, seconds (P1): faster files hold pictures more
often."""
CELL: Final = 16
"""Side of the cells in which changes are counted, pixels."""
NOISY: Final = 0.9
"""Share of the cells that a sensor's noise changes sooner or later; a rendered picture changes
only where something moves, and is rightly constant while nothing does."""
BLOCKS: Final = 40
"""Number of blocks along the longer side of a picture whose means are compared."""
CODEC: Final = 8.0
"""Grey levels by which codecs change a block of a repeated picture: 6 at most by H.264, H.265
and VP9, 10 at an MPEG-4 key frame. A moving person changes one by 14 or more."""


class State(NamedTuple):
    """The previous picture, and how long it has been constant."""

    last: Image | None = None
    repeats: int = 0
    """Number of frames for which it has been the same, bit for bit; `since_s`: since when."""
    since_s: float = 0.0
    reached: NDArray[np.bool_] | None = None
    """Cells that have changed at least once."""
    blocks: NDArray[np.float32] | None = None
    """Block means of the first picture since which no block has changed by more than CODEC."""
    still_since_s: float = 0.0
    contradicted: bool = False
    """The person has moved since then, by the other view."""


def step(
    state: State, picture: Image, captured_s: float, moving_since_s: float | None
) -> tuple[State, bool]:
    """Process a picture; return whether it is frozen.

    A sensor's noise makes every picture different. So a picture of a noisy source that stays the
    same, bit for bit, for more than FROZEN_AFTER frames and FROZEN_S comes from the camera's
    memory. Any picture that stays the same except for a codec's changes counts as frozen too, while
    the person in it moves in the other view.

    Args:
        state: After the pictures before.
        picture: (H, W, 3)
        captured_s: Capture time.
        moving_since_s: Since this time the person in this view has moved in the other one; None:
            unknown.
    """
    state = _compared(_repeated(state, picture, captured_s), picture, captured_s)
    if moving_since_s is not None and moving_since_s > state.still_since_s:
        state = state._replace(contradicted=True)
    held = state.repeats > FROZEN_AFTER and captured_s - state.since_s > FROZEN_S
    return state, state.contradicted or (held and _is_noisy(state))


def _repeated(state: State, picture: Image, captured_s: float) -> State:
    """The state with the count of bit-identical repeats, or with the changed cells."""
    last, reached, (high, wide) = state.last, state.reached, picture.shape[:2]
    if last is None or reached is None or last.shape != picture.shape:
        nothing = np.zeros((-(-high // CELL), -(-wide // CELL)), np.bool_)
        return State(picture, since_s=captured_s, reached=nothing)
    if _same(picture, last):
        return state._replace(repeats=state.repeats + 1)
    if not _is_noisy(state):
        state = state._replace(reached=_with_changes(picture, last, reached))
    return state._replace(last=picture, repeats=0, since_s=captured_s)


def _is_noisy(state: State) -> bool:
    return state.reached is not None and float(state.reached.mean()) >= NOISY


def _compared(state: State, picture: Image, captured_s: float) -> State:
    """The state with the time since when no block has changed."""
    if state.blocks is not None and state.repeats:
        return state
    high, wide = picture.shape[:2]
    side = max(1.0, max(high, wide) / BLOCKS)
    size = max(1, round(wide / side)), max(1, round(high / side))
    blocks = cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    if state.blocks is not None and float(np.abs(blocks - state.blocks).max()) <= CODEC:
        return state
    return state._replace(blocks=blocks, still_since_s=captured_s, contradicted=False)


@compiled
def _same(one: Image, other: Image) -> bool:
    """Whether pictures of one size are identical; a difference mostly shows in the first pixels."""
    for y in range(one.shape[0]):
        for x in range(one.shape[1]):
            for c in range(3):
                if one[y, x, c] != other[y, x, c]:
                    return False
    return True


@compiled
def _with_changes(one: Image, other: Image, before: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells in which two pictures differ, or earlier ones did."""
    reached = before.copy()
    for y in range(one.shape[0]):
        for x in range(one.shape[1]):
            if not reached[y // CELL, x // CELL]:
                for c in range(3):
                    if one[y, x, c] != other[y, x, c]:
                        reached[y // CELL, x // CELL] = True
    return reached
