"""Faults of a camera's whole picture: frozen, black, white or covered."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.bus.messages import CameraFault
from common.compiled import compiled
from common.video.pictures import Image
from viewer import frozen_picture
from viewer.background.background import DARK, Background

STRIDE: Final = 4
"""Stride of the rows and columns whose brightness is sampled, pixels."""
PLAIN: Final = 16.0
"""Grey levels between the darkest and the brightest tenth of a picture, below which it shows no
background at all."""
VARIED: Final = 2 * PLAIN
"""Grey levels between those tenths below which a picture is plain, where the background itself is
not plain."""
BLACK: Final = 60.0
WHITE: Final = 195.0
"""Grey levels: below, a plain picture is called black; above, saturated."""


class State(NamedTuple):
    """What pictures are compared with."""

    background: NDArray[np.float32]
    """Grey levels of the background, every STRIDE pixels."""
    frozen: frozen_picture.State = frozen_picture.State()


def init(background: Background) -> State:
    """The state before any picture but the background."""
    return State(_grey(background.centre))


def step(
    state: State, picture: Image, captured_s: float, moving_since_s: float | None = None
) -> tuple[State, CameraFault]:
    """Process a picture (H, W, 3) and its time; the fault that makes it useless, or "".

    Args:
        state: After the pictures before.
        picture: (H, W, 3)
        captured_s: Capture time.
        moving_since_s: As for `frozen_picture.step`.
    """
    frozen, is_frozen = frozen_picture.step(state.frozen, picture, captured_s, moving_since_s)
    state = state._replace(frozen=frozen)
    return state, "frozen" if is_frozen else _blank(state.background, picture)


def _blank(background: NDArray[np.float32], picture: Image) -> CameraFault:
    """The fault of a plain picture. In front of a plain wall it is that wall under another
    light, while there is enough light to see a person."""
    if _contrast_of(picture) > PLAIN:
        return ""
    grey = _grey(picture)
    middle = float(np.median(grey))
    if _contrast(background) < VARIED and middle >= DARK * np.median(background):
        return ""
    if middle < BLACK:
        return "black"
    return "saturated" if middle > WHITE else "covered"


def _contrast(grey: NDArray[np.float32]) -> float:
    """Grey levels between the darkest and the brightest tenth."""
    tenth = grey.size // 10
    ranked = np.partition(grey, (tenth, grey.size - 1 - tenth), axis=None)
    return float(ranked[-1 - tenth] - ranked[tenth])


@compiled
def _contrast_of(picture: Image) -> float:
    """The same for a picture; the quantiles of its brightness come from a histogram of bytes,
    without sorting."""
    counts = np.zeros(3 * 255 + 1, np.int64)
    for i in range(0, picture.shape[0], STRIDE):
        for j in range(0, picture.shape[1], STRIDE):
            pixel = picture[i, j]
            counts[int(pixel[0]) + int(pixel[1]) + int(pixel[2])] += 1
    tenth = counts.sum() // 10
    low, passed = 0, counts[0]
    while passed <= tenth:
        low += 1
        passed += counts[low]
    high, passed = len(counts) - 1, counts[-1]
    while passed <= tenth:
        high -= 1
        passed += counts[high]
    return (high - low) / 3


@compiled
def _grey(picture: NDArray[np.float32] | Image) -> NDArray[np.float32]:
    height, width = picture.shape[:2]
    rows, columns = (height + STRIDE - 1) // STRIDE, (width + STRIDE - 1) // STRIDE
    grey = np.empty((rows, columns), np.float32)
    for i in range(rows):
        for j in range(columns):
            pixel = picture[i * STRIDE, j * STRIDE]
            total = np.float32(pixel[0]) + np.float32(pixel[1]) + np.float32(pixel[2])
            grey[i, j] = total / np.float32(3)
    return grey
