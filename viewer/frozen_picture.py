"""Is a picture the camera's memory? The same bit for bit, or but for what a codec makes of it."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.compiled import compiled
from common.video.pictures import Image

FROZEN_AFTER: Final = 2
"""Repeats that may be no fault: files made for a faster rate hold each picture two or three times,
and no recorded clip that was looked at held one more than twice."""
FROZEN_S: Final = FROZEN_AFTER / 15
"""How long that takes at the paper's rate (P1): faster files hold pictures more often."""
CELL: Final = 16
"""Side, pixels, of the cells in which changes are looked for."""
NOISY: Final = 0.9
"""Share of the cells that a sensor's noise has reached sooner or later; a rendered picture changes
where something moves, and is rightly the same while nothing does."""
BLOCKS: Final = 40
"""Blocks along the longer side of a picture whose means are held against each other."""
CODEC: Final = 8.0
"""Grey levels by which codecs change a block of a picture that is repeated: 6 at most by H.264,
H.265 and VP9, 10 where an MPEG-4 key frame comes. A person who moves changes one by 14 or more."""


class State(NamedTuple):
    """The picture before, and since when it is the same."""

    last: Image | None = None
    repeats: int = 0
    """For how many frames it has been the same, bit for bit; `since_s`: since when."""
    since_s: float = 0.0
    reached: NDArray[np.bool_] | None = None
    """Cells in which anything has changed since the beginning."""
    blocks: NDArray[np.float32] | None = None
    """Means of the first picture since which no block has changed by more than CODEC."""
    still_since_s: float = 0.0
    contradicted: bool = False
    """The person moved since then, as the other view shows."""


def step(
    state: State, picture: Image, captured_s: float, moving_since_s: float | None
) -> tuple[State, bool]:
    """One picture more, and whether it is frozen.

    A sensor's noise makes every picture of its own. So one of a noisy source that is the same, bit
    for bit, for more than FROZEN_AFTER frames and FROZEN_S is the camera's memory and not the
    scene. Any picture that stays the same but for a codec's changes is, while the person in it
    moves in the other view.

    Args:
        state: Of the pictures before.
        picture: (H, W, 3)
        captured_s: When it was taken.
        moving_since_s: The person, whom this view sees, has moved in the other since then; None:
            that is not known.
    """
    state = _compared(_repeated(state, picture, captured_s), picture, captured_s)
    if moving_since_s is not None and moving_since_s > state.still_since_s:
        state = state._replace(contradicted=True)
    held = state.repeats > FROZEN_AFTER and captured_s - state.since_s > FROZEN_S
    return state, state.contradicted or (held and _is_noisy(state))


def _repeated(state: State, picture: Image, captured_s: float) -> State:
    """The state with how often a picture came again, bit for bit, or where it changed."""
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
    """The state with since when no block of the picture has changed."""
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
    """Whether pictures of one size are the same; the first pixels show when they are not."""
    for y in range(one.shape[0]):
        for x in range(one.shape[1]):
            for c in range(3):
                if one[y, x, c] != other[y, x, c]:
                    return False
    return True


@compiled
def _with_changes(one: Image, other: Image, before: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells in which two pictures differ, or did before."""
    reached = before.copy()
    for y in range(one.shape[0]):
        for x in range(one.shape[1]):
            if not reached[y // CELL, x // CELL]:
                for c in range(3):
                    if one[y, x, c] != other[y, x, c]:
                        reached[y // CELL, x // CELL] = True
    return reached
