"""Falls: a person stands and moves, falls in some direction, lies and moves, and gets up again."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from common.body.body import Vector
from synth.motion.footing import Posed
from synth.motion.moves import smooth
from synth.person.skeleton import ANGLES, JOINTS

FALL_S: Final = 17.0
"""Length of the motion."""
FALLS_S: Final = (5.0, 5.8)
"""When the fall begins, and when the body lies."""
RISES_S: Final = (13.0, 15.0)
"""When it begins to get up, and when it stands."""
LYING_DEG: Final = (78.0, 95.0)
"""Tilt of the body then."""
STILLER: Final = 0.3
"""Factor on free motion in the limbs of a lying person, the trunk's turning apart."""
FLESH_M: Final = 0.09
"""Height of a lying body's lowest joint above the floor, metres."""
CARRIES: Final = [
    i for i, name in enumerate(JOINTS) if name[2:] not in ("elbow", "wrist", "knuckle")
]
"""Joints that a body lies on; arms yield."""
_TURN: Final = ANGLES.index("root_yaw")
"""Index of the angle by which a lying person rolls over."""


def lain(
    angles_deg: NDArray[np.float64], stance: NDArray[np.float64], t: Vector
) -> NDArray[np.float64]:
    """Joint angles (n, 27) of free motion, reduced where the body lies.

    Args:
        angles_deg: (n, 27) of free motion.
        stance: (n, 27) of a person who only stands.
        t: (n,) seconds since the motion began.
    """
    share = 1.0 - (1.0 - STILLER) * tipped(t)[:, None]
    found: NDArray[np.float64] = stance + share * (angles_deg - stance)
    found[:, _TURN] = angles_deg[:, _TURN]
    return found


def tipped(t: Vector) -> Vector:
    """Tilt of the body, (n,): 0 upright, 1 lying."""
    found: Vector = _eased(t, FALLS_S) * (1.0 - _eased(t, RISES_S))
    return found


def _eased(t: Vector, between_s: tuple[float, float]) -> Vector:
    first, last = between_s
    return smooth((t - first) / (last - first))


class Fall(NamedTuple):
    """Parameters of a fall."""

    time_s: Vector
    """(n,) seconds of the frames since the motion began."""
    heading: float
    """Horizontal axis of the tilt, radians: any direction."""
    far_deg: float
    """Tilt of the lying body."""


def fall(time_s: Vector, rng: np.random.Generator) -> Fall:
    """A random fall."""
    return Fall(time_s, rng.uniform(0.0, 2.0 * np.pi), rng.uniform(*LYING_DEG))


def fallen(body: Posed, how: Fall) -> Posed:
    """A moving body, tilted around the place where it stands, on the floor.

    A lying body stays in place: its middle is where the feet were.
    """
    over = tipped(how.time_s)
    axis = np.array([np.cos(how.heading), 0.0, np.sin(how.heading)])
    turns = Rotation.from_rotvec(np.outer(over, how.far_deg * axis), degrees=True).as_matrix()
    foot = body.joints_m[:, 0] * [1.0, 0.0, 1.0]
    joints_m = np.einsum("nij,nkj->nki", turns, body.joints_m - foot[:, None]) + foot[:, None]
    bones = body.bones.copy()
    bones[..., :3] = np.einsum("nij,nbjk->nbik", turns, body.bones[..., :3])
    bones[..., 3] = (
        np.einsum("nij,nbj->nbi", turns, body.bones[..., 3] - foot[:, None]) + foot[:, None]
    )
    lowest_m, stood_m = (whole[:, CARRIES, 1].min(axis=1) for whole in (joints_m, body.joints_m))
    moved = over[:, None] * (foot - joints_m.mean(axis=1))
    moved[:, 1] = stood_m + over * (FLESH_M - stood_m) - lowest_m
    joints_m += moved[:, None]
    bones[..., 3] += moved[:, None]
    return Posed(joints_m, bones)
