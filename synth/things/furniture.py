"""Furniture before people in pictures, and what they push or carry: drawn where they stand."""

from collections.abc import Callable
from typing import Final

import numpy as np

from synth.things.shade import Place, Shade, block, disc, fill, line


def _desk(place: Place, rng: np.random.Generator) -> Shade:
    """Open below or closed, with a screen on it or without."""
    shade, size = place.blank(), place.stature
    x, y = place.middle("pelvis") + size * rng.normal(0.0, (0.2, 0.1))
    left, right = x - size * rng.uniform(0.2, 0.7), x + size * rng.uniform(0.2, 0.7)
    floor, thick = max(place.floor(), y + 0.2 * size), size * rng.uniform(0.02, 0.05)
    if rng.random() < 0.5:
        block(shade, (left, y), (right, floor), float(rng.uniform(0.5, 0.9)))
    for at in (left, right - thick):
        block(shade, (at, y), (at + thick, floor), 0.6)
    block(shade, (left, y), (right, y + thick), 1.0)
    if rng.random() < 0.4:
        at, wide = rng.uniform(left, right), size * rng.uniform(0.1, 0.2)
        block(shade, (at - wide, y - 0.8 * wide), (at + wide, y), 0.3)
    return shade


def _chair(place: Place, rng: np.random.Generator) -> Shade:
    """Its back before the person, of slats or whole, and its legs."""
    shade, size = place.blank(), place.stature
    x, y = place.middle("pelvis") + size * rng.normal(0.0, (0.08, 0.06))
    half, high = size * rng.uniform(0.09, 0.17), size * rng.uniform(0.1, 0.3)
    seat, floor = y + size * rng.uniform(0.0, 0.1), max(place.floor(), y + 0.2 * size)
    step = 1.0 if rng.random() < 0.6 else 0.3
    for part in np.arange(0.0, 1.0, step):
        top = seat - high * (1.0 - part)
        block(shade, (x - half, top), (x + half, top + high * min(step, 0.7)), 0.8)
    block(shade, (x - half, seat), (x + half, seat + 0.03 * size), 1.0)
    for at in (-half, half, -0.6 * half, 0.6 * half):
        line(shade, [np.array([x + at, seat - high]), np.array([x + at, floor])], 0.02 * size, 0.5)
    return shade


def _wheelchair(place: Place, rng: np.random.Generator) -> Shade:
    """Pushed, with a passenger or without, or sat in; from a side, or from front or back."""
    shade, size = place.blank(), place.stature
    x, y = place.middle("pelvis") + size * rng.normal(0.0, (0.12, 0.04))
    radius, floor = size * rng.uniform(0.14, 0.2), max(place.floor(), y + 0.15 * size)
    narrow, apart = rng.uniform(0.08, 1.0) * radius, size * rng.uniform(0.1, 0.16)
    if rng.random() < 0.7:
        block(shade, (x - apart, floor - 2.2 * radius), (x + apart, floor - radius), 0.5)
    if rng.random() < 0.4:
        disc(shade, np.array([x, floor - 2.2 * radius]), (0.8 * apart, 1.2 * radius))
        disc(shade, np.array([x, floor - 3.8 * radius]), (0.05 * size, 0.065 * size))
    for at in (x - apart, x + apart):
        hub = np.array([at, floor - radius], np.float32)
        disc(shade, hub, (narrow, radius), rng.uniform(0.012, 0.04) * size)
        for turn in np.arange(6) * np.pi / 3:
            rim = hub + np.array([narrow * np.cos(turn), radius * np.sin(turn)])
            line(shade, [hub, rim], 1.0, 0.9)
        line(shade, [hub, hub - np.array([0.0, 1.9 * radius])], 0.02 * size, 0.4)
    return shade


def _box(place: Place, rng: np.random.Generator) -> Shade:
    """Between the hands, or on the floor."""
    shade, size = place.blank(), place.stature
    wide, high = size * rng.uniform(0.08, 0.3, 2)
    x, y = place.middle("l_wrist", "r_wrist") + size * rng.normal(0.0, 0.05, 2)
    if rng.random() < 0.5:
        x, y = x + size * rng.normal(0.0, 0.15), place.floor() - high
    block(shade, (x - wide, y - high), (x + wide, y + high), 0.8)
    back, up = rng.uniform(-0.5, 0.5) * wide, rng.uniform(0.1, 0.4) * high
    top = y - high
    lid = [
        [x - wide, top],
        [x + wide, top],
        [x + wide + back, top - up],
        [x - wide + back, top - up],
    ]
    fill(shade, np.array(lid), 1.0)
    return shade


def _umbrella(place: Place, rng: np.random.Generator) -> Shade:
    """Over the head and before it, or held to a side, with its shaft in a hand."""
    shade, size = place.blank(), place.stature
    rim = place.middle("head_top") + size * rng.normal((0.0, 0.06), (0.15, 0.08))
    wide, high = size * rng.uniform(0.25, 0.5), size * rng.uniform(0.12, 0.3)
    turns = np.linspace(np.pi, 2 * np.pi, 17)
    dome = rim + np.stack([wide * np.cos(turns), high * np.sin(turns)], 1)
    line(shade, [rim, place.middle("l_wrist" if rng.random() < 0.5 else "r_wrist")], 1.0, 0.4)
    for at in range(0, 16, 4):
        fill(shade, np.array([rim - (0, high), *dome[at : at + 5]]), float(rng.uniform(0.7, 1.0)))
    return shade


THINGS: Final[dict[str, Callable[[Place, np.random.Generator], Shade]]] = {
    "desk": _desk,
    "chair": _chair,
    "wheelchair": _wheelchair,
    "box": _box,
    "umbrella": _umbrella,
}
MOVED: Final = ("wheelchair", "box", "umbrella")
"""What people push or carry."""
