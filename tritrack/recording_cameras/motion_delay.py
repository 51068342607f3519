"""How late one camera shows what another shows, by how much their pictures change."""

from typing import Final

import cv2
import numpy as np

from common.body.body import Vector
from common.video.pictures import Image

SMALL: Final = (64, 48)
"""Size, pixels, at which two pictures are compared."""
STEP_S: Final = 0.005
"""Step of the delays that are tried, seconds."""
MOST_S: Final = 0.5
"""Largest delay that is tried, seconds: cables and exposures take less."""
SLOW_S: Final = 1.0
"""Changes slower than this are light, not motion."""
ALIKE: Final = 0.6
"""Least correlation of two cameras that see the same motion."""
BESIDE_S: Final = 0.15
"""Width of a peak: beyond it another peak is another answer."""
ALSO_ALIKE: Final = 0.85
"""Share of the best correlation at which a second answer makes it ambiguous: a gait's period."""
LEAST_S: Final = 3.0
"""Length of motion that is needed, seconds."""


def small_of(picture: Image) -> Image:
    """A picture as it is compared: grey, of SMALL."""
    return cv2.resize(
        cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), SMALL, interpolation=cv2.INTER_AREA
    )


def change(before: Image | None, now: Image) -> float:
    """Mean difference of two small pictures, 0 to 255; 0 without a picture before."""
    return 0.0 if before is None else float(cv2.absdiff(before, now).mean())


def delay_s(first: tuple[Vector, Vector], second: tuple[Vector, Vector]) -> float | None:
    """Seconds by which the second camera shows the same motion later; None where that is unsure.

    Args:
        first: (n,) times, seconds, and (n,) changes of the first camera.
        second: Likewise, on the same clock.
    """
    begin = max(first[0][0], second[0][0]) + MOST_S
    end = min(first[0][-1], second[0][-1]) - MOST_S
    if end - begin < LEAST_S:
        return None
    at = np.arange(begin, end, STEP_S)
    delays = np.arange(-MOST_S, MOST_S + STEP_S / 2, STEP_S)
    still = _quick(np.interp(at, *first))
    found = np.array([_alike(still, _quick(np.interp(at + late, *second))) for late in delays])
    best = int(found.argmax())
    others = found[np.abs(delays - delays[best]) > BESIDE_S]
    if found[best] < ALIKE or others.max(initial=-1.0) > ALSO_ALIKE * found[best]:
        return None
    return float(delays[best])


def _quick(change: Vector) -> Vector:
    """What changes within SLOW_S."""
    width = round(SLOW_S / STEP_S)
    mean = np.convolve(change, np.ones(width) / width, mode="same")
    quick: Vector = change - mean
    return quick


def _alike(one: Vector, other: Vector) -> float:
    long = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) / long if long > 0.0 else 0.0
