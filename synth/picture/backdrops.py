"""Backgrounds of people in pictures: rooms, and abstract heaps of shapes."""

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.picture.random_rig import random_rig
from synth.picture.synth_room import furnished

Backdrop = NDArray[np.uint8]

SIDE_PX: Final = 170
"""Side of a backdrop: pictures are cut out of it."""
ROOM_SHARE: Final = 0.25
SHAPES: Final = (4, 70)
SIZES: Final = (0.03, 0.9)
"""Radii of the shapes, in sides: their frequency falls as their area grows (Lee et al. 2001)."""
GREY_SHARE: Final = 0.4


def backdrop(seed: int) -> Backdrop:
    """(SIDE_PX, SIDE_PX, 3) blue, green, red; each seed is one backdrop."""
    rng = np.random.default_rng([seed, 80])
    return _of_a_room(rng) if rng.random() < ROOM_SHARE else _heaped(rng)


def _of_a_room(rng: np.random.Generator) -> Backdrop:
    """A part of an empty room."""
    seen = furnished(int(rng.integers(1 << 30)), random_rig(rng, 0.4, (2.3, 5.6)))
    picture = seen.pictures[int(rng.integers(2))]
    side = int(min(picture.shape[:2]) * rng.uniform(0.4, 1.0))
    top, left = (int(rng.integers(size - side + 1)) for size in picture.shape[:2])
    cut = picture[top : top + side, left : left + side]
    return np.asarray(cv2.resize(cut, (SIDE_PX, SIDE_PX)).clip(0, 255), np.uint8)


def _heaped(rng: np.random.Generator) -> Backdrop:
    """Overlapping shapes, each with its own grain: a scene without meaning."""
    picture = np.empty((SIDE_PX, SIDE_PX, 3), np.float32)
    picture[:] = _tint(rng)
    slope = rng.normal(0.0, 60.0, 2)
    across = np.linspace(-0.5, 0.5, SIDE_PX, dtype=np.float32)
    picture += (slope[0] * across[:, None] + slope[1] * across)[..., None].astype(np.float32)
    for _ in range(int(np.exp(rng.uniform(*np.log(SHAPES))))):
        _lay(picture, rng)
    coarse = rng.normal(0.0, rng.uniform(0.0, 25.0), (12, 12)).astype(np.float32)
    picture += cv2.resize(coarse, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_CUBIC)[..., None]
    return np.asarray(picture.clip(0, 255), np.uint8)


def _lay(picture: NDArray[np.float32], rng: np.random.Generator) -> None:
    """Add one shape."""
    mask = np.zeros((SIDE_PX, SIDE_PX), np.uint8)
    low, high = SIZES
    radius = SIDE_PX * low / max(rng.random(), low / high) ** 0.7
    middle = rng.uniform(0, SIDE_PX, 2)
    kind = int(rng.integers(3))
    if kind == 0:
        size = (max(1, int(radius)), max(1, int(radius * rng.uniform(0.15, 1.0))))
        at = (int(middle[0]), int(middle[1]))
        cv2.ellipse(mask, at, size, float(rng.uniform(0, 180)), 0, 360, 1, -1)
    else:
        corners = 4 if kind == 1 else int(rng.integers(3, 8))
        turn = np.sort(rng.uniform(0, 2 * np.pi, corners)) if kind == 2 else _box(rng)
        reach = radius * (rng.uniform(0.4, 1.0, (corners, 1)) if kind == 2 else 1.0)
        points = middle + reach * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        cv2.fillPoly(mask, [np.rint(points).astype(np.int32)], 1)
    left, top, wide, high = cv2.boundingRect(mask)
    here = slice(top, top + high), slice(left, left + wide)
    drawn = _grain((high, wide), rng) + _tint(rng)
    picture[here] = np.where(mask[here][..., None] > 0, drawn, picture[here])


def _box(rng: np.random.Generator) -> NDArray[np.float64]:
    """Directions of a rectangle's corners, mostly upright."""
    half = rng.uniform(0.1, 1.47)
    tilt = rng.normal(0.0, 0.4) if rng.random() < 0.4 else 0.0
    return tilt + np.array([half, np.pi - half, np.pi + half, -half])


def _grain(shape: tuple[int, int], rng: np.random.Generator) -> NDArray[np.float32]:
    """(h, w, 1) stripes, spots or nothing."""
    kind, size = int(rng.integers(4)), rng.uniform(5.0, 45.0)
    high, wide = shape
    if kind == 0:
        turn, pitch = rng.choice([0.0, np.pi / 2, rng.uniform(0, np.pi)]), rng.uniform(3, 24)
        right, down = (np.array([np.cos(turn), np.sin(turn)]) * 2 * np.pi / pitch).tolist()
        along = down * np.arange(high)[:, None] + right * np.arange(wide)
        return np.asarray(size * np.sin(along)[..., None], np.float32)
    if kind == 1 and min(shape) > 0:
        few = int(rng.integers(8, 80))
        spots = rng.normal(0.0, size, (few, few)).astype(np.float32)
        return np.asarray(cv2.resize(spots, (wide, high))[..., None], np.float32)
    return np.zeros((high, wide, 1), np.float32)


def _tint(rng: np.random.Generator) -> NDArray[np.float32]:
    strength = 0.1 if rng.random() < GREY_SHARE else 0.6
    return np.asarray(rng.uniform(10, 245) * (1.0 - strength * rng.random(3)), np.float32)
