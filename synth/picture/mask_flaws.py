"""Flaws of silhouettes that are segmented from a video."""

from typing import Final, Literal, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

SHADOW_SHARE, THICK_SHARE, THIN_SHARE, ROUND_SHARE = 0.5, 0.3, 0.1, 0.15
"""Shares of a camera's silhouettes that keep a shadow at the feet, are a pixel too thick or too
thin in places, or have their thin parts rounded off."""
HOLE_SHARE: Final = 0.3
"""Share of the cameras whose silhouettes lack pieces for a while."""


class Flaw(NamedTuple):
    """Flaws of one camera's silhouettes, constant through a performance."""

    kind: Literal["thick", "thin", "round", "none"]
    kernel: tuple[int, int]
    shadow: tuple[float, float, float, float] | None
    """The shadow at the feet: its place between them, depth, width, height, in heights."""
    holes: NDArray[np.bool_]
    """(n,) whether a piece is missing."""
    hole: tuple[float, float, float, float]
    """Its place (right, down) and half sizes, as shares of the silhouette's box."""


def flaw(n: int, rng: np.random.Generator) -> Flaw:
    """Flaws of one camera, constant through a performance of `n` instants."""
    shares = (THICK_SHARE, THIN_SHARE, ROUND_SHARE)
    at = int(np.searchsorted(np.cumsum(shares), rng.random()))
    kinds: tuple[Literal["thick", "thin", "round", "none"], ...]
    kinds = ("thick", "thin", "round", "none")
    shadow = None
    if rng.random() < SHADOW_SHARE:
        shadow = (rng.random(), *rng.uniform((0.0, 0.03, 0.005), (0.02, 0.14, 0.02)))
    holes = np.zeros(n, np.bool_)
    if rng.random() < HOLE_SHARE:
        start = int(rng.integers(n))
        holes[start : start + int(rng.integers(2, 12))] = True
    hole = (rng.random(), rng.random(), *rng.uniform(0.02, 0.08, 2))
    return Flaw(kinds[at], (int(rng.integers(1, 3)), int(rng.integers(1, 3))), shadow, holes, hole)


def spoilt(mask: NDArray[np.uint8], flaw: Flaw, i: int) -> NDArray[np.uint8]:
    """A silhouette with the flaws of a segmented one: with a shadow, too thick, too thin."""
    if not mask.any():
        return mask
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    tall, wide = int(rows[-1] - rows[0]), int(columns[-1] - columns[0])
    if flaw.shadow is not None:
        share, low, across, high = flaw.shadow
        feet = np.flatnonzero(mask[rows[-1] - tall // 40])
        at = (
            (int(feet[int(share * (len(feet) - 1))]), int(rows[-1] - low * tall))
            if len(feet)
            else (0, 0)
        )
        size = (int(across * tall), int(high * tall))
        mask = np.asarray(cv2.ellipse(mask.copy(), at, size, 0, 0, 360, 1, -1), np.uint8)
    if flaw.holes[i]:
        right, down, half_wide, half_tall = flaw.hole
        at = (int(columns[0] + right * wide), int(rows[0] + down * tall))
        size = (int(half_wide * tall), int(half_tall * tall))
        mask = np.asarray(cv2.ellipse(mask.copy(), at, size, 0, 0, 360, 0, -1), np.uint8)
    kernel = np.ones(flaw.kernel, np.uint8)
    if flaw.kind == "thick":
        return np.asarray(cv2.dilate(mask, kernel), np.uint8)
    if flaw.kind == "thin":
        return np.asarray(cv2.erode(mask, kernel), np.uint8)
    if flaw.kind == "round":
        return np.asarray(cv2.medianBlur(mask, 3), np.uint8)
    return mask
