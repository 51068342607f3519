"""Where pictures mark a joint beside its centre, by the pose: marks moved to the centres.

A shoulder's mark stays on the silhouette's edge while the joint sinks with a hanging arm; a hip's
is below it, a knee's the kneecap, an ankle's the outer ankle. A bent limb is seen straighter than
it is.
"""

import math
from typing import Final

import numpy as np

from common.body.body import Floats, Vector
from common.compiled import compiled
from integrator.landmarks.landmark_fusion import Memory
from integrator.landmarks.landmark_rays import Rays
from integrator.pose.inverse_kinematics import trunk_of
from integrator.proposal.network_weights import JOINTS

SHOULDER_UP: Final = (0.004, 0.0145)
"""Height of a shoulder's mark above the joint's centre with a level upper arm, and what it has more
where the arm hangs (less where it points up). These and all offsets below are in statures; read
from 4 performers and synthetic people (docs/measurements.md)."""
SHOULDER_BACK: Final = 0.006
HIP_BELOW, HIP_RISES = 0.008, 0.013
"""Height of a hip's mark below the joint's centre where the thigh hangs, and its rise where it
points to the front: people mark the crease."""
KNEE_FRONT: Final = 0.005
"""Offset of a straight knee's mark to the front; a right angle has none."""
KNEE_OUT, ANKLE_OUT = 0.005, 0.005
"""Offsets from the body's middle outwards."""
ELBOW_INSIDE, KNEE_INSIDE = 0.03, 0.03
"""Offset of the mark of a limb that is folded up to the inside of the bend: it grows with the
squared sine of half the bend."""
PROPOSED_INSIDE: Final = (0.06, 0.03)
"""The same of elbows and knees that silhouettes propose: hands before the trunk are not in them."""

_SHOULDERS: Final = JOINTS.index("l_shoulder")
_ELBOWS: Final = JOINTS.index("l_elbow")
_WRISTS: Final = JOINTS.index("l_wrist")
_HIPS: Final = JOINTS.index("l_hip")
_KNEES: Final = JOINTS.index("l_knee")
_ANKLES: Final = JOINTS.index("l_ankle")


def centred(
    before: Memory | None, proposed_m: Floats, rays: Rays, stature_m: float
) -> tuple[Floats, Rays]:
    """The proposed joints (12, 3), and rays, without their offsets from the joints' centres.

    Args:
        before: The fusion's memory: the pose of the instant before decides the offsets, at the
            first instant the proposed one.
        proposed_m: (12, 3) world, of JOINTS.
        rays: Rays of the views' landmarks.
        stature_m: The person's stature.
    """
    pose_m = proposed_m if before is None else before.joints_m
    beside_m = stature_m * bent(pose_m, *PROPOSED_INSIDE)
    marked_m = stature_m * marks(pose_m)
    away_m = np.linalg.norm(proposed_m - rays.centres_m[:, None], axis=2)[..., None]
    return proposed_m - beside_m, rays._replace(
        directions=_through(rays.directions, away_m, marked_m),
        others=_through(rays.others, away_m, marked_m),
    )


def _through(directions: Floats, away_m: Floats, marked_m: Floats) -> Floats:
    """Directions (V, 12, 3) of marks, moved to the joints' centres at their distances (V, 12, 1).

    A direction of zeros, where a view shows nothing, stays.
    """
    known = np.abs(directions).sum(axis=2, keepdims=True) > 0.0
    moved = directions * away_m - marked_m
    long = np.linalg.norm(moved, axis=2, keepdims=True)
    return np.where(known, moved / np.maximum(long, 1e-9), directions)


@compiled
def marks(joints_m: Floats) -> Floats:
    """Offsets (12, 3) of the marks of landmarks from the joints' centres, statures."""
    beside = bent(joints_m, ELBOW_INSIDE, KNEE_INSIDE)
    trunk = trunk_of(joints_m)
    up, front = trunk[:, 1], trunk[:, 2]
    for side in range(2):
        arm = _unit(joints_m[_ELBOWS + side] - joints_m[_SHOULDERS + side])
        raised = (arm * up).sum()
        beside[_SHOULDERS + side] += (SHOULDER_UP[0] - SHOULDER_UP[1] * raised) * up
        beside[_SHOULDERS + side] -= SHOULDER_BACK * front
        _mark_leg(joints_m, trunk, side, beside)
    return beside


@compiled
def _mark_leg(joints_m: Floats, trunk: Floats, side: int, beside: Floats) -> None:
    """Add the offsets of a leg's marks, but for its bend's.

    Args:
        joints_m: (12, 3) the joints.
        trunk: (3, 3) columns: left, up, front.
        side: 0: left, 1: right.
        beside: (12, 3) the offsets so far.
    """
    up, front = trunk[:, 1], trunk[:, 2]
    hip, knee, ankle = joints_m[_HIPS + side], joints_m[_KNEES + side], joints_m[_ANKLES + side]
    thigh, shank = _unit(knee - hip), _unit(ankle - knee)
    beside[_HIPS + side] += (HIP_RISES * max(0.0, (thigh * front).sum()) - HIP_BELOW) * up
    along = _unit(thigh + shank)
    before = _unit(front - (front * along).sum() * along)
    out = trunk[:, 0] - (trunk[:, 0] * along).sum() * along
    out = (1.0 - 2.0 * side) * _unit(out - (out * before).sum() * before)
    straight = max(0.0, 1.0 - math.sqrt(((thigh - shank) ** 2).sum()))
    beside[_KNEES + side] += KNEE_FRONT * straight * before + KNEE_OUT * out
    beside[_ANKLES + side] += ANKLE_OUT * out


@compiled
def bent(joints_m: Floats, elbow: float, knee: float) -> Floats:
    """Offsets (12, 3) of elbows and knees to the inside of their bends, statures.

    Args:
        joints_m: (12, 3) the joints.
        elbow, knee: What they are where the limb is folded up.
    """
    beside = np.zeros((len(joints_m), 3))
    for side in range(2):
        beside[_ELBOWS + side] = elbow * _inside(
            joints_m[_SHOULDERS + side], joints_m[_ELBOWS + side], joints_m[_WRISTS + side]
        )
        beside[_KNEES + side] = knee * _inside(
            joints_m[_HIPS + side], joints_m[_KNEES + side], joints_m[_ANKLES + side]
        )
    return beside


@compiled
def _inside(start: Vector, middle: Vector, end: Vector) -> Floats:
    """Direction into the bend of a limb, as long as the squared sine of half the bend."""
    into = _unit(end - middle) - _unit(middle - start)
    return into * math.sqrt((into**2).sum()) / 4.0


@compiled
def _unit(arrow: Vector) -> Floats:
    return arrow / max(math.sqrt((arrow**2).sum()), 1e-9)
