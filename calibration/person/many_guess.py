"""A rig of any number of cameras as a vector for the fit, and any two of them as a pair's."""

import math
from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np

from calibration.tracks.rig_guess import BODY, LATE, Pinhole, guess_of, rotation
from common.body.body import Vector
from common.rig.camera import Rig

OF_A_CAMERA: Final = ("log_focal", "yaw", "pitch", "roll", "x", "height", "z")
"""The numbers of each camera: angles in radians, lengths in metres. Camera 1 has yaw, x and z 0."""
EACH: Final = len(OF_A_CAMERA)
FIXED: Final = [OF_A_CAMERA.index(name) for name in ("yaw", "x", "z")]
_FOCAL, _YAW, _PITCH, _ROLL, _X, _HEIGHT, _Z = range(EACH)
BODY_LENGTHS: Final = BODY.stop - BODY.start

Pair = tuple[int, int]
"""Two cameras, by their places in the rig, from 0."""
Rigs = Mapping[Pair, tuple[Rig, tuple[float, ...]]]
"""Of each pair its cameras, and the second one's delay in each clip."""


class Layout(NamedTuple):
    """The parts of a vector: all cameras, the person's lengths, and the delays of the cameras after
    the first in each clip."""

    cameras: int
    clips: int

    @property
    def body(self) -> slice:
        """The logarithms of the person's lengths, metres."""
        return slice(EACH * self.cameras, EACH * self.cameras + BODY_LENGTHS)

    @property
    def size(self) -> int:
        """Number of values."""
        return self.body.stop + (self.cameras - 1) * self.clips

    def late(self, guess: Vector) -> Vector:
        """(clips, cameras) delays against camera 1, seconds."""
        own = guess[self.body.stop :].reshape(self.clips, self.cameras - 1)
        return np.pad(own, ((0, 0), (1, 0)))


def pair_guess(layout: Layout, guess: Vector, pair: Pair) -> Vector:
    """Two of the cameras as a vector of `rig_guess.py`, in a world of their own."""
    one, other = (guess[EACH * n : EACH * (n + 1)] for n in pair)
    base = other[[_X, _HEIGHT, _Z]] - one[[_X, _HEIGHT, _Z]]
    cosine, sine = math.cos(one[_YAW]), math.sin(one[_YAW])
    late = layout.late(guess)
    return np.array(
        [
            *(one[_FOCAL], other[_FOCAL]),
            *(one[_PITCH], one[_ROLL], one[_HEIGHT]),
            *(other[_YAW] - one[_YAW], other[_PITCH], other[_ROLL]),
            cosine * base[0] - sine * base[2],
            other[_HEIGHT],
            sine * base[0] + cosine * base[2],
            *guess[layout.body],
            *(late[:, pair[1]] - late[:, pair[0]]),
        ]
    )


def pinholes_of(layout: Layout, guess: Vector) -> tuple[Pinhole, ...]:
    """All cameras of a vector."""
    rows = guess[: EACH * layout.cameras].reshape(-1, EACH)
    return tuple(
        Pinhole(
            math.exp(row[_FOCAL]),
            rotation(*row[[_YAW, _PITCH, _ROLL]].tolist()),
            row[[_X, _HEIGHT, _Z]].copy(),
        )
        for row in rows
    )


def chained(layout: Layout, tree: list[Pair], rigs: Rigs, body: Vector) -> Vector:
    """A vector from rigs of pairs: their worlds have one floor and one vertical already.

    Args:
        layout: Of the vector.
        tree: Pairs that lead from camera 1 to every other: the first of each is known before.
        rigs: Of each pair.
        body: Logarithms of the person's lengths.
    """
    rows = np.zeros((layout.cameras, EACH))
    late = np.zeros((layout.clips, layout.cameras))
    for one, other in tree:
        own = _two(rigs, (one, other))
        cosine, sine = math.cos(rows[one, _YAW]), math.sin(rows[one, _YAW])
        yaw, x, z = own[5], own[8], own[10]
        rows[other, _YAW] = rows[one, _YAW] + yaw
        rows[other, _X] = rows[one, _X] + cosine * x + sine * z
        rows[other, _Z] = rows[one, _Z] - sine * x + cosine * z
        late[:, other] = late[:, one] + own[LATE:]
    rows[:, [_FOCAL, _PITCH, _ROLL, _HEIGHT]] = _means(layout, rigs)
    return np.concatenate([rows.ravel(), body, late[:, 1:].ravel()])


def _two(rigs: Rigs, pair: Pair) -> Vector:
    """A pair's vector, in either order, without the body."""
    one, other = pair
    rig, late_s = rigs[(min(pair), max(pair))]
    cameras = rig.cameras if one < other else rig.cameras[::-1]
    own = guess_of(Rig(rig.width, rig.height, tuple(cameras)))
    late = np.array(late_s) * (1.0 if one < other else -1.0)
    return np.concatenate([own, np.zeros(BODY_LENGTHS), late])


def _means(layout: Layout, rigs: Rigs) -> Vector:
    """(cameras, 4) focal length, pitch, roll and height, by all pairs of each camera."""
    own: list[list[Vector]] = [[] for _ in range(layout.cameras)]
    for (one, other), (rig, _) in rigs.items():
        told = guess_of(rig)
        own[one].append(told[[0, 2, 3, 4]])
        own[other].append(told[[1, 6, 7, 9]])
    return np.array([np.median(each, axis=0) for each in own])
