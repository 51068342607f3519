"""Twists of upper arms and thighs: elbow and knee bend about a single axis."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from common.body.body import Vector

STRAIGHT_DEG: Final = 20.0
"""Bend of a limb, degrees, below which it does not determine its own twist: joints that are 1 cm
off turn its plane by 5 degrees and more."""
SHOWN: Final = math.sin(math.radians(STRAIGHT_DEG))
CALM_S: Final = 0.15
"""Time before and after over which a limb that is half as bent counts."""
REST: Final = 1e-3
"""Weight of the twist at rest, relative to 1 for that of a limb that is bent by 14 degrees."""
EXACT: Final = 1e-9
"""Remaining doubt where a limb is bent by STRAIGHT_DEG or more."""
SHORTEST_S: Final = 1e-3
"""Smallest time between two frames, by the resolution of cameras' clocks."""


class Hinge(NamedTuple):
    """The joint between an upper and a lower limb, in the axes of the upper one at rest."""

    along: Vector
    """(3,) direction of both limbs."""
    ahead: Vector
    """(3,) direction in which the lower one bends; the hinge's axis is `along` x `ahead`."""

    @property
    def axes(self) -> NDArray[np.float64]:
        """(3, 3) as columns: along the limb, ahead, the hinge's axis."""
        return np.stack([self.along, self.ahead, np.cross(self.along, self.ahead)], axis=1)


_X, _Y, _Z = np.eye(3)
HINGES: Final = {
    "LeftArm": Hinge(_X, _Z),
    "RightArm": Hinge(-_X, _Z),
    "LeftUpLeg": Hinge(-_Y, -_Z),
    "RightUpLeg": Hinge(-_Y, -_Z),
}
"""By the upper bone's name: elbows bend forwards, knees backwards."""
AXES: Final = np.stack([hinge.axes for hinge in HINGES.values()])


class Before(NamedTuple):
    """The last twists."""

    twists: Vector
    """(limbs,) radians."""
    time_s: float


def limb_twists(
    bends: NDArray[np.complex128], time_s: Vector, before: Before | None = None
) -> Vector:
    """Twist of each upper limb about its own axis, radians, without jumps.

    A bent limb determines it: from STRAIGHT_DEG on its hinge's axis is met exactly. For a
    straighter limb the twist is the one that changes least over time: least squares, each frame
    weighted by its evidence. The lower part then deviates from the hinge's plane, by less than it
    is bent. Twists are averaged as directions, which takes the shorter way.

    Args:
        bends: (limbs, n) of each frame, from `bends_of`.
        time_s: (n,) capture times, increasing.
        before: The frame before the first; None: there is none.

    Returns:
        (limbs, n)
    """
    earlier = np.zeros(len(bends)) if before is None else np.exp(1j * before.twists)
    bends = np.column_stack([earlier, bends])
    time_s = np.append(-np.inf if before is None else before.time_s, time_s)
    share = np.minimum(1.0, np.abs(bends) / SHOWN) ** 2
    weights = share / (1.0 - share + EXACT)
    shown = weights * np.exp(1j * np.angle(bends)) + REST
    stiff = (CALM_S / np.maximum(np.diff(time_s), SHORTEST_S)) ** 2
    twists = [np.angle(_least_changing(*each, stiff)) for each in zip(weights, shown, strict=True)]
    return np.stack(twists)[:, 1:]


def _least_changing(
    weights: Vector, shown: NDArray[np.complex128], stiff: Vector
) -> NDArray[np.complex128]:
    """(n,) numbers u with the least sum of weights |u - shown / weights|^2 and of stiff |du|^2."""
    bands = np.zeros((2, len(weights)))
    bands[1] = weights + REST
    bands[1, :-1] += stiff
    bands[1, 1:] += stiff
    bands[0, 1:] = -stiff
    found: NDArray[np.complex128] = solveh_banded(bands, shown)
    return found


def bends_of(axes: NDArray[np.float64], lower: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Bend of limbs as complex numbers: the sine of the bend, with the twist as its phase.

    Args:
        axes: (limbs, 3, 3) of the hinges, of AXES.
        lower: (limbs, n, 3) directions of the lower limbs, in the axes of upper ones without a
            twist.
    """
    aside = lower @ axes / np.maximum(np.linalg.norm(lower, axis=-1, keepdims=True), 1e-9)
    bends: NDArray[np.complex128] = aside[..., 1] + 1j * aside[..., 2]
    return bends


def twist_axes(axes: NDArray[np.float64], twists: Vector) -> NDArray[np.float64]:
    """Turns about the limbs' own axes as matrices, (limbs, n, 3, 3), for (limbs, n) radians."""
    turns = np.zeros((*twists.shape, 3, 3))
    turns[..., 0, 0] = 1.0
    turns[..., 1, 1] = turns[..., 2, 2] = np.cos(twists)
    turns[..., 2, 1] = np.sin(twists)
    turns[..., 1, 2] = -turns[..., 2, 1]
    own = axes[:, None]
    found: NDArray[np.float64] = own @ turns @ own.swapaxes(-1, -2)
    return found
