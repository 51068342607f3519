"""The body in the median picture of a clip: of a person who hides the same place in most frames."""

from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np

from common.body.body import Vector
from common.raster.similarity import Mask
from viewer.background.image_stack import Floats
from viewer.background.occluded_background import MOST_HIDDEN
from viewer.room.room_people import Look

BEYOND: Final = (-0.03, -0.015, 0.0, 0.015, 0.03, 0.05)
"""Distances beyond the bodies of landmarks at which votes are taken, statures: a pixel deep inside
a body has all votes, one at its contour half."""
NEAR: Final = 0.15
"""Distance from the bodies of landmarks within which colours are compared, statures."""
SOMETIMES: Final = 0.2
"""Share of the frames whose bodies a pixel must be near to for that."""
ROUNDS: Final = 5
COUNTS: Final = 0.7
"""Weight of what a pixel's colour says: neighbouring pixels say nearly the same."""
SHADES: Final = 8
"""Number of steps of each of three colours."""
UNSEEN: Final = 1e-4
"""Share of all pixels that every colour is given besides those that have it."""
SURELY: Final = 0.02
"""Least probability of either answer of a vote."""
SMOOTH_SHARE: Final = 1 / 12
"""Distance up to which a pixel's neighbours of its own colour are compared, as a share of the
picture's height, where colours vary by more than ALIKE."""
ALIKE: Final = 3e-5
"""Variance of colours, of which white has 1, up to which all neighbours are compared."""


def standing(centre: Floats, looks: Sequence[Look]) -> Mask:
    """(H, W) whom the median picture shows; nothing where no person stays, or hides too much of it.

    Landmarks of single frames are off, each in its own way; what most of them have is the body's.
    From these votes, which colours are the body's and which the background's is learnt, and applied
    to each pixel with its neighbours, as far as they are of its colour; and again from what that
    gives.

    Args:
        centre: (H, W, 3) the median of the pictures.
        looks: Who is in each of the pictures.

    Source: He, Sun, Tang 2010 (guided filter), for neighbours.
    """
    prior = np.mean([_votes(looks, centre.shape, beyond) for beyond in BEYOND], axis=0)
    near = _votes(looks, centre.shape, NEAR) > SOMETIMES
    if not near.any():
        return near
    rows, columns = (slice(at.min(), at.max() + 1) for at in np.nonzero(near))
    window = (rows, columns)
    picture = np.clip(centre[window], 0, 255)
    reach = max(1, round(SMOOTH_SHARE * len(centre)))
    prior, around = prior[window].clip(SURELY, 1 - SURELY), near[window]
    body = prior
    for _ in range(ROUNDS):
        odds = np.log(prior / (1 - prior)) + COUNTS * _colours(picture, body, around)
        body = _smooth(picture / 255, 1 / (1 + np.exp(-odds)), reach).clip(0, 1) * around
    found = np.zeros(centre.shape[:2], np.bool_)
    found[window] = body > 0.5
    return found & (found.mean() <= MOST_HIDDEN)


def _votes(looks: Sequence[Look], shape: tuple[int, ...], beyond: float) -> Floats:
    """(H, W) share of the looks, the surest most, that have a person there."""
    sure = np.array([np.mean(look.landmarks.confidence) ** 2 for look in looks])
    votes = np.zeros(shape[:2], np.float32)
    for share, look in zip(sure / sure.sum(), looks, strict=True):
        votes += share.astype(np.float32) * look.region(shape, beyond)
    return votes


def _colours(picture: Floats, body: Vector, near: Mask) -> Vector:
    """(h, w) log of how much likelier a pixel's colour is a body's than the room's beside it."""
    steps = (picture * (SHADES / 256)).astype(np.int64)
    shade = (steps[..., 0] * SHADES + steps[..., 1]) * SHADES + steps[..., 2]
    own, other = (_known(shade[near], share[near]) for share in (body, 1 - body))
    found: Vector = np.log((own + UNSEEN) / (other + UNSEEN))[shade]
    return found


def _known(shades: np.ndarray, share: Vector) -> Vector:
    """(SHADES^3,) how often each colour is seen; its neighbours are a little alike."""
    counts: Vector = np.bincount(shades, share, SHADES**3).astype(np.float64)
    counts = counts.reshape(SHADES, SHADES, SHADES)
    for axis in range(3):
        aside = np.pad(np.moveaxis(counts, axis, 0), ((1, 1), (0, 0), (0, 0)))
        counts = np.moveaxis(aside[1:-1] / 2 + aside[:-2] / 4 + aside[2:] / 4, 0, axis)
    return counts.ravel() / max(float(counts.sum()), 1.0)


def _smooth(guide: Vector, values: Vector, reach: int) -> Floats:
    """Values (h, w) as a linear function of the colours of a guide (h, w, 3), near each pixel."""
    size = (2 * reach + 1, 2 * reach + 1)

    def mean(of: np.ndarray) -> np.ndarray:
        return np.asarray(cv2.blur(of, size))

    seen, own = guide.astype(np.float32), values.astype(np.float32)
    colour, value = mean(seen), mean(own)
    covariance = mean(seen * own[..., None]) - colour * value[..., None]
    spread = np.empty((*own.shape, 3, 3), np.float32)
    for i in range(3):
        spread[..., i] = mean(seen * seen[..., i : i + 1]) - colour * colour[..., i : i + 1]
    spread += ALIKE * np.eye(3, dtype=np.float32)
    slope = np.linalg.solve(spread, covariance[..., None])[..., 0]
    offset = value - (slope * colour).sum(axis=2)
    found: Floats = (mean(slope) * seen).sum(axis=2) + mean(offset)
    return found
