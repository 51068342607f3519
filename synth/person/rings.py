"""Lofted tubes: rings of elliptic section along a limb, and the surface between them."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.person.skeleton import BONE_INDEX

MATERIALS: Final = ("skin", "hair", "shirt", "trousers", "shoes", "dark", "lips")
MATERIAL: Final = {name: i for i, name in enumerate(MATERIALS)}
"""Materials of faces: they determine colour and pattern."""

SIDES: Final = 16
"""Number of corners of a ring."""


class Ring(NamedTuple):
    """One section of a tube, in the resting body."""

    centre: tuple[float, float, float]
    half_x: float
    half_z: float
    bones: tuple[str, str]
    share: float
    """Weight of the second bone."""
    material: str
    """Material of the band from here to the next ring."""
    square: float = 2.0
    """Exponent of the superellipse: 2 round, larger is squarer."""


Loft = tuple[NDArray[np.float64], NDArray[np.int64], Vector, NDArray[np.int64], NDArray[np.int64]]


def lofted(rings: list[Ring], along: str) -> Loft:
    """Vertices, bones, weights, faces and materials of a closed tube."""
    around = 2 * np.pi * np.arange(SIDES) / SIDES
    cos, sin = np.cos(around), np.sin(around)
    if along == "z":
        sin = -sin
    corners = []
    for ring in rings:
        power = 2.0 / ring.square
        wide = ring.half_x * np.sign(cos) * np.abs(cos) ** power
        deep = ring.half_z * np.sign(sin) * np.abs(sin) ** power
        flat = np.zeros(SIDES)
        offset = (wide, flat, deep) if along == "y" else (wide, deep, flat)
        corners.append(np.array(ring.centre) + np.stack(offset, axis=1))
    ends = [np.array(rings[0].centre), np.array(rings[-1].centre)]
    vertices = np.concatenate([*corners, np.stack(ends)])
    hung = [*np.repeat(np.arange(len(rings)), SIDES).tolist(), 0, len(rings) - 1]
    index = [[BONE_INDEX[name] for name in rings[i].bones] for i in hung]
    shares = np.array([rings[i].share for i in hung])
    faces, bands = _faces(len(rings), descending=rings[0].centre[1] > rings[-1].centre[1])
    material = np.array([MATERIAL[rings[band].material] for band in bands])
    return vertices, np.array(index), shares, faces, material


def _faces(count: int, descending: bool) -> tuple[NDArray[np.int64], list[int]]:
    """Faces between `count` rings and over both ends, and the index of each one's ring."""
    faces, bands = [], []
    for i in range(count - 1):
        for k in range(SIDES):
            a, b = i * SIDES + k, i * SIDES + (k + 1) % SIDES
            faces += [(a, a + SIDES, b), (b, a + SIDES, b + SIDES)]
            bands += [i, i]
    bottom, top = count * SIDES, count * SIDES + 1
    for k in range(SIDES):
        after, last = (k + 1) % SIDES, (count - 1) * SIDES
        faces += [(bottom, k, after), (top, last + after, last + k)]
        bands += [0, count - 1]
    found = np.array(faces)
    return (found[:, ::-1] if descending else found), bands
