"""Pseudo-random numbers by place, from which textures are made."""

import numpy as np

from common.body.body import Vector


def scattered(a: Vector, b: Vector, salt: float) -> Vector:
    """A pseudo-random number in [0, 1] from whole numbers."""
    wild = np.sin(np.floor(a) * 12.9898 + np.floor(b) * 78.233 + salt) * 43758.5453
    found: Vector = wild - np.floor(wild)
    return found


def clouds(a: Vector, b: Vector, salt: float) -> Vector:
    """Smooth noise from 0 to 1 with features of size 1."""
    i, j = np.floor(a), np.floor(b)
    x, y = a - i, b - j
    x, y = x * x * (3 - 2 * x), y * y * (3 - 2 * y)
    top = scattered(i, j, salt) * (1 - x) + scattered(i + 1, j, salt) * x
    low = scattered(i, j + 1, salt) * (1 - x) + scattered(i + 1, j + 1, salt) * x
    found: Vector = top * (1 - y) + low * y
    return found
