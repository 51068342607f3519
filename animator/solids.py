"""Unit solids for drawing a body: a cylinder with soft rims, and a ball."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

SECTORS: Final = 24
"""Number of sides of a round shape: no corner is visible at the page's size."""
RIM: Final = 0.12
"""Share of a cylinder's radius and height that rounds each of its rims."""


class Mesh(NamedTuple):
    """Triangles of a unit shape."""

    vertices: Vector
    """(n, 3)."""
    faces: NDArray[np.uint32]
    """(m, 3), counter-clockwise seen from outside."""


def unit_cylinder() -> Mesh:
    """A cylinder of radius 1 from (0, 0, 0) to (0, 1, 0), its rims rounded by RIM."""
    quarter = np.radians([0.0, 30.0, 60.0, 90.0])
    radii = 1.0 - RIM * (1.0 - np.sin(quarter))
    heights = RIM * (1.0 - np.cos(quarter))
    return _turned_on_a_lathe(
        np.concatenate([[0.0], radii, radii[::-1], [0.0]]),
        np.concatenate([[0.0], heights, 1.0 - heights[::-1], [1.0]]),
    )


def unit_ball() -> Mesh:
    """A ball of radius 1 around the origin."""
    angles = np.linspace(0.0, math.pi, SECTORS // 2 + 1)
    radii = np.sin(angles)
    radii[[0, -1]] = 0.0
    return _turned_on_a_lathe(radii, -np.cos(angles))


def _turned_on_a_lathe(radii: Vector, heights: Vector) -> Mesh:
    """The surface of revolution of a profile about the y axis; the profile begins and ends on
    that axis."""
    turn = np.linspace(0.0, 2.0 * math.pi, SECTORS, endpoint=False)
    rings = [
        np.stack([r * np.cos(turn), np.full(SECTORS, y), r * np.sin(turn)], axis=1)
        for r, y in zip(radii, heights, strict=True)
    ]
    at = np.arange(SECTORS)
    here, after = at, (at + 1) % SECTORS
    faces = [
        ring * SECTORS + np.stack(corners, axis=1)
        for ring in range(len(rings) - 1)
        for corners in (
            (here, here + SECTORS, after + SECTORS),
            (here, after + SECTORS, after),
        )
    ]
    return Mesh(np.concatenate(rings), np.concatenate(faces).astype(np.uint32))
