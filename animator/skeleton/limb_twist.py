"""How upper arms and thighs are twisted: elbow and knee bend about one axis of theirs alone."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from common.body.body import Vector

STRAIGHT_DEG: Final = 20.0
"""A limb that is bent less does not show by itself how it is twisted: joints that are 1 cm off
turn its plane by 5 degrees and more."""
SHOWN: Final = math.sin(math.radians(STRAIGHT_DEG))
CALM_S: Final = 0.15
"""About so long before and after counts what a limb shows that is half as bent."""
REST: Final = 1e-3
"""What speaks for the twist at rest, beside 1 for that of a limb that is bent by 14 degrees."""
EXACT: Final = 1e-9
"""What is left of doubt where a limb is bent by STRAIGHT_DEG or more."""
SHORTEST_S: Final = 1e-3
"""From one frame to the next, by the least that clocks of cameras tell."""


class Hinge(NamedTuple):
    """The joint between an upper and a lower limb, in the axes of the upper one at rest."""

    along: Vector
    """(3,) where both limbs point."""
    ahead: Vector
    """(3,) where the lower one goes as it bends; the hinge's axis is `along` x `ahead`."""

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
    """How limbs were twisted last."""

    twists: Vector
    """(limbs,) radians."""
    time_s: float


def limb_twists(
    bends: NDArray[np.complex128], time_s: Vector, before: Before | None = None
) -> Vector:
    """About its own axis, how far each upper limb is turned, radians, without jumps.

    A limb that is bent shows it: by STRAIGHT_DEG and more its hinge's axis is met exactly. Of one
    that is straighter the twist is that which changes least over time, by least squares, in which
    every frame weighs what it shows; its lower part is then beside the hinge's plane, by less than
    it is bent. Twists are added up as directions, so that the shorter way is gone.

    Args:
        bends: (limbs, n) of each frame, `bends_of`.
        time_s: (n,) when they were taken, increasing.
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
    """How far limbs are bent and which way: sine of the bend, and as its phase the twist.

    Args:
        axes: (limbs, 3, 3) of the hinges, of AXES.
        lower: (limbs, n, 3) where the lower limbs point, in the axes of upper ones without a twist.
    """
    aside = lower @ axes / np.maximum(np.linalg.norm(lower, axis=-1, keepdims=True), 1e-9)
    bends: NDArray[np.complex128] = aside[..., 1] + 1j * aside[..., 2]
    return bends


def twist_axes(axes: NDArray[np.float64], twists: Vector) -> NDArray[np.float64]:
    """Turns about the limbs themselves as matrices, (limbs, n, 3, 3), of (limbs, n) radians."""
    turns = np.zeros((*twists.shape, 3, 3))
    turns[..., 0, 0] = 1.0
    turns[..., 1, 1] = turns[..., 2, 2] = np.cos(twists)
    turns[..., 2, 1] = np.sin(twists)
    turns[..., 1, 2] = -turns[..., 2, 1]
    own = axes[:, None]
    found: NDArray[np.float64] = own @ turns @ own.swapaxes(-1, -2)
    return found
