"""Features of pixels around a first guess's contour that distinguish body and background."""

from functools import lru_cache
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from common.compiled import KERNEL
from common.video.pictures import Image
from viewer.background.background import BackgroundModel
from viewer.background.image_stack import Bytes, Floats
from viewer.silhouette.alpha_matte import FACTS, SHARES, matte, sides_of

ROWS: Final = 240
"""Of a taller picture every other pixel, or every third, is a neighbour, so that as much is seen
of the body around a pixel."""
SIDE_SHARE: Final = 1 / 60
"""How far around a pixel body and background are asked for colours, of the picture's height."""
COUNTED: Final = (3, 7)
"""How far the neighbourhoods reach whose share of body is a feature."""
NEAR_SHARE: Final = 1 / 120
"""How far from the guess's contour pixels are looked at, of the picture's height."""
CROSS: Final = np.array(
    [(i, j) for i in range(-2, 3) for j in range(-2, 3) if abs(i) + abs(j) <= 2], np.int64
)
"""Neighbours whose alpha is a feature."""
FEATURES: Final = SHARES * len(CROSS) + len(COUNTED) + FACTS
"""What the network sees of a pixel."""


def features_of(
    frame: Image, model: BackgroundModel, mask: Bytes, doubt: Bytes
) -> tuple[NDArray[np.int32], Floats]:
    """The pixels to look at again, and what is known of them.

    Args:
        frame: (H, W, 3).
        model: What it is held against.
        mask: (H, W) 1 where the body is guessed.
        doubt: (H, W) 1 where the guess was not sure.

    Returns:
        Row and column (n, 2) of the pixels, and their features (n, FEATURES).
    """
    if not mask.any():
        return np.empty((0, 2), np.int32), np.empty((0, FEATURES), np.float32)
    rows = frame.shape[0]
    stride, near = max(1, round(rows / ROWS)), max(1, round(NEAR_SHARE * rows))
    left, top, right, bottom = _window(cv2.bitwise_or(mask, doubt), near + 2 * stride)
    window = slice(top, bottom), slice(left, right)
    own = mask[window].copy()
    band = cv2.morphologyEx(own, cv2.MORPH_GRADIENT, _square(near)) | doubt[window]
    reach = cv2.dilate(band, _square(2 * stride)) + band
    sides = sides_of(frame, model, counts_3x3(own), (top, left))
    size = (2 * round(SIDE_SHARE * rows) + 1,) * 2
    means = cv2.boxFilter(sides, cv2.CV_32F, size, borderType=cv2.BORDER_REPLICATE)
    shares, places, facts = matte(frame, model, means, reach, (top, left))
    own *= np.uint8(255)
    around, wide = (_mean(own, 2 * far * stride + 1) for far in COUNTED)
    features = _gathered(places, shares, facts, around, wide, stride, (top, left))
    return places, features


@lru_cache(maxsize=8)
def _square(far: int) -> Bytes:
    return np.ones((2 * far + 1,) * 2, np.uint8)


def counts_3x3(mask: Bytes) -> Bytes:
    """How many pixels of every 3x3 neighbourhood are in the mask."""
    border = cv2.BORDER_REPLICATE
    return np.asarray(cv2.boxFilter(mask, -1, (3, 3), normalize=False, borderType=border))


def _window(mask: Bytes, margin: int) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of what is around the mask."""
    left, top, width, height = cv2.boundingRect(mask)
    right, bottom = left + width + margin, top + height + margin
    return (
        max(left - margin, 0),
        max(top - margin, 0),
        min(right, mask.shape[1]),
        min(bottom, mask.shape[0]),
    )


def _mean(shares: Bytes, size: int) -> Bytes:
    return np.asarray(cv2.blur(shares, (size, size), borderType=cv2.BORDER_REPLICATE))


@KERNEL
def _gathered(
    places: NDArray[np.int32],
    shares: Floats,
    facts: Floats,
    around: Bytes,
    wide: Bytes,
    stride: int,
    corner: tuple[int, int],
) -> Floats:
    """The features (n, FEATURES); moves places from the window to the frame, whose corner it is."""
    height, width = wide.shape
    out = np.empty((len(places), FEATURES), np.float32)
    unit = np.float32(1 / 255)
    for n in range(len(places)):
        y, x, at, k = places[n, 0], places[n, 1], out[n], 0
        for m in range(len(CROSS)):
            v = min(max(y + CROSS[m, 0] * stride, 0), height - 1)
            u = min(max(x + CROSS[m, 1] * stride, 0), width - 1)
            for s in range(SHARES):
                at[k + s] = shares[v, u, s]
            k += SHARES
        at[k], at[k + 1] = unit * np.float32(around[y, x]), unit * np.float32(wide[y, x])
        for s in range(FACTS):
            at[k + 2 + s] = facts[n, s]
        places[n, 0], places[n, 1] = y + corner[0], x + corner[1]
    return out
