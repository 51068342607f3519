"""Pixel statistics of a stack of pictures: mean, median, spread of colours, motion."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.compiled import compiled
from common.video.pictures import Image

Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]

LUMA: Final = np.array([0.114, 0.587, 0.299], np.float32)
"""Shares of blue, green and red in brightness (ITU-R BT.601)."""
CHANGES: Final = np.float32(12.0)
"""Change of brightness, grey levels, that exceeds noise before there is a model."""


class Overlaid(NamedTuple):
    """Statistics of one or more pictures under one light, pixel by pixel."""

    mean: Floats
    """(H, W, 3) grey levels."""
    median: Floats
    """(H, W, 3)."""
    squares: Floats
    """(H, W, 2) sums of squared deviations from the mean, of brightness and of colour; 0 for one
    picture."""
    moving: NDArray[np.bool_]
    """(n, H, W) where a picture's brightness differs from the median's."""


def median(pictures: Sequence[Image] | Floats) -> Floats:
    """The median of one or more pictures, (H, W, 3)."""
    return _median(np.stack([*pictures]))


@compiled
def overlaid(frames: NDArray[np.uint8], lights: Floats) -> Overlaid:
    """Statistics of a stack of pictures.

    It works row by row, so that intermediate values stay in the cache: whole pictures take five
    times as long.

    Args:
        frames: (n, H, W, 3).
        lights: (n, 3) each picture's light over the wanted light.
    """
    count, height, width = frames.shape[:3]
    found = Overlaid(
        np.empty((height, width, 3), np.float32),
        np.empty((height, width, 3), np.float32),
        np.empty((height, width, 2), np.float32),
        np.empty((count, height, width), np.bool_),
    )
    even = np.empty((count, 3 * width), np.float32)
    gains = np.empty_like(even)
    for k in range(count):
        for j in range(3 * width):
            gains[k, j] = lights[k, j % 3]
    for y in range(height):
        for k in range(count):
            given, own, gain = frames[k, y].reshape(-1), even[k], gains[k]
            for j in range(3 * width):
                own[j] = np.float32(given[j]) / gain[j]
        _middle(even.copy(), found.median[y].reshape(-1))
        for k in range(count):
            _set_moving(even[k], found.median[y].reshape(-1), found.moving[k, y])
        _set_mean(even, found.mean[y].reshape(-1))
        _set_squares(even, found.mean[y].reshape(-1), found.squares[y])
    return found


@compiled
def squares(deviations: Floats) -> Floats:
    """Sums over (n, H, W, 3) of squared deviations of brightness and of colour, (H, W, 2)."""
    count, height, width = deviations.shape[:3]
    out, none = np.empty((height, width, 2), np.float32), np.zeros(3 * width, np.float32)
    for y in range(height):
        _set_squares(deviations[:, y].copy().reshape(count, -1), none, out[y])
    return out


@compiled
def _median(pictures: Bytes | Floats) -> Floats:
    """The median of pictures (n, H, W, 3)."""
    found = np.empty(pictures.shape[1:], np.float32)
    for y in range(len(found)):
        _middle(pictures[:, y].copy().reshape(len(pictures), -1), found[y].reshape(-1))
    return found


@compiled
def _middle(ranked: Bytes | Floats, out: Floats) -> None:
    """The medians of columns (n, m), which are reordered in place.

    Whole rows are exchanged until the middle ones are in place: sorting the few values of each
    column separately takes twenty times as long.
    """
    lower, upper = (len(ranked) - 1) // 2, len(ranked) // 2
    for last in range(len(ranked) - 1, max(lower, 1) - 1, -1):
        for i in range(last):
            _change_places(ranked[i], ranked[i + 1])
    one, other = ranked[lower], ranked[upper]
    for j in range(len(out)):
        out[j] = (np.float32(one[j]) + np.float32(other[j])) / np.float32(2)


@compiled
def _change_places(one: Bytes | Floats, other: Bytes | Floats) -> None:
    for j in range(len(one)):
        a, b = one[j], other[j]
        less = a < b
        one[j] = a if less else b
        other[j] = b if less else a


@compiled
def _set_mean(even: Floats, out: Floats) -> None:
    """The mean of every column of (n, m)."""
    out[:] = even[0]
    for k in range(1, len(even)):
        own = even[k]
        for j in range(len(out)):
            out[j] += own[j]
    for j in range(len(out)):
        out[j] /= np.float32(len(even))


@compiled
def _set_squares(even: Floats, mean: Floats, out: Floats) -> None:
    """Sums over pixels' columns (n, 3 W) of squared brightness and squared colour, (W, 2)."""
    out[:] = 0
    for k in range(len(even)):
        for x in range(len(out)):
            b, g, r = even[k, 3 * x], even[k, 3 * x + 1], even[k, 3 * x + 2]
            b, g, r = b - mean[3 * x], g - mean[3 * x + 1], r - mean[3 * x + 2]
            luma = LUMA[0] * b + LUMA[1] * g + LUMA[2] * r
            b, g, r = b - luma, g - luma, r - luma
            out[x, 0] += luma * luma
            # colour has two degrees of freedom: the third is brightness
            out[x, 1] += (b * b + g * g + r * r) * np.float32(0.5)


@compiled
def _set_moving(even: Floats, middle: Floats, out: NDArray[np.bool_]) -> None:
    """Where the brightness of a row of pixels (3 W,) differs from that of another."""
    for x in range(len(out)):
        b, g = even[3 * x] - middle[3 * x], even[3 * x + 1] - middle[3 * x + 1]
        r = even[3 * x + 2] - middle[3 * x + 2]
        out[x] = abs(LUMA[0] * b + LUMA[1] * g + LUMA[2] * r) > CHANGES
