"""Cloth that hangs around hips and thighs: skirts, coats, long shirts."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.anny_people.anatomy import anatomy

RINGS, SIDES = 7, 28
SLAB_M: Final = 0.04
"""Half the height of the slice that a ring of cloth surrounds."""
NARROWER: Final = 0.97
"""Smallest width of a ring, over that of the one above: cloth falls."""
FOLLOW: Final = 0.85
"""Share of the thighs' motion that the lower edge of a long one follows."""
FOLLOW_FROM_M, FOLLOW_OVER_M = 0.05, 0.3
"""Depth below the upper edge at which that begins, and the length over which it grows."""
APART_M: Final = 0.1
"""Distance from the middle from which on a skirt follows one thigh alone, metres."""


class Tube(NamedTuple):
    """A surface open above and below, at rest."""

    vertices_m: NDArray[np.float64]
    faces: NDArray[np.int64]
    """(f, 3) seen from outside anticlockwise."""
    weights: NDArray[np.float64]
    """(v, bones)."""


def tube_about(inside_m: NDArray[np.float64], reach_m: tuple[float, float], room_m: float) -> Tube:
    """Cloth that is stretched around a body and falls from its widest place.

    Args:
        inside_m: (n, 3) points that it surrounds, at rest.
        reach_m: Heights of its upper and its lower edge.
        room_m: Its distance from them.
    """
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    ways = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    middle = inside_m[:, [0, 2]].mean(axis=0) * [0.0, 1.0]
    rings, widest = [], np.zeros(SIDES)
    for height in np.linspace(*reach_m, RINGS):
        near = inside_m[np.abs(inside_m[:, 1] - height) < SLAB_M][:, [0, 2]] - middle
        if len(near):
            widest = np.maximum(NARROWER * widest, (near @ ways.T).max(axis=0) + room_m)
        flat = middle + _radii(widest, ways)[:, None] * ways
        rings.append(np.insert(flat, 1, height, axis=1))
    vertices = np.concatenate(rings)
    return Tube(vertices, _faces(), _weights(vertices, reach_m[0]))


def _radii(widths: Vector, ways: NDArray[np.float64]) -> Vector:
    """Support function of a convex outline: its extent along each direction (n, 2), (n,)."""
    cosine = ways @ ways.T
    reach = np.where(cosine > 0.1, widths[None] / np.maximum(cosine, 0.1), np.inf)
    return np.asarray(reach.min(axis=1))


def _faces() -> NDArray[np.int64]:
    """Faces between the rings; the first one is the highest."""
    ring, side = np.divmod(np.arange((RINGS - 1) * SIDES), SIDES)
    a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
    c, d = a + SIDES, b + SIDES
    return np.concatenate([np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)])


def _weights(vertices: NDArray[np.float64], top_m: float) -> NDArray[np.float64]:
    """From the pelvis down cloth follows the thighs more and more, (v, bones)."""
    bones = anatomy().bones
    down = np.clip((top_m - FOLLOW_FROM_M - vertices[:, 1]) / FOLLOW_OVER_M, 0.0, 1.0)
    follow = FOLLOW * down * down * (3.0 - 2.0 * down)
    left = np.clip(0.5 + vertices[:, 0] / (2 * APART_M), 0.0, 1.0)
    weights = np.zeros((len(vertices), len(bones)))
    weights[:, bones.index("root")] = 1.0 - follow
    weights[:, bones.index("upperleg02.L")] = follow * left
    weights[:, bones.index("upperleg02.R")] = follow * (1.0 - left)
    return weights
