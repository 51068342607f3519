"""How upper arms and thighs are twisted: elbow and knee bend about one axis of theirs alone."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

STRAIGHT_DEG: Final = 16.0
"""A limb that is bent less does not show by itself how it is twisted: joints that are 1 cm off
turn its plane by 5 degrees and more."""
SHOWN: Final = math.sin(math.radians(STRAIGHT_DEG))


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


def limb_twists(bends: NDArray[np.complex128], before: Vector | None = None) -> Vector:
    """About its own axis, how far each upper limb is turned, radians, without jumps.

    A limb that is bent shows it: by STRAIGHT_DEG and more its hinge's axis is met exactly. The
    straighter it is the more the frames around it count that are bent, between which the twist goes
    the shorter way. Its lower part is then beside the hinge's plane, by less than it is bent.

    Args:
        bends: (limbs, n) of each frame, `bends_of`.
        before: (limbs,) twists of the frame before the first; None: there is none.

    Returns:
        (limbs, n); 0, as at rest, of a limb that is never bent.
    """
    held = np.stack(
        [_held(own, None if before is None else before[i]) for i, own in enumerate(bends)]
    )
    share = np.minimum(1.0, np.abs(bends) / SHOWN) ** 2
    mixed = share * np.exp(1j * np.angle(bends)) + (1.0 - share) * np.exp(1j * held)
    twists: Vector = np.angle(mixed)
    return twists


def _held(bends: NDArray[np.complex128], before: float | None) -> Vector:
    """What the bent frames around each frame tell of it, (n,)."""
    rows = np.flatnonzero(np.abs(bends) >= SHOWN)
    shown = np.angle(bends[rows])
    if before is not None:
        rows, shown = np.append(-1, rows), np.append(before, shown)
    if not len(rows):
        return np.zeros(len(bends))
    held: Vector = np.interp(np.arange(len(bends)), rows, np.unwrap(shown))
    return held


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
