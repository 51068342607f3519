"""What one view alone shows of a body at an instant, and the body that it may be."""

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Bdp, Vector, rest_pose
from common.body.observation import Observation
from common.body.proportions import body_vector, stature
from common.body.stick_body import Stickman
from common.bus.instant import TwoSeen
from common.bus.messages import Lifting, ViewerNumber
from common.method import Method
from common.notes.notes import Orientation
from common.rig.camera import Camera, Rig
from integrator.pose import joint_limits
from integrator.pose.inverse_kinematics import PLACES, pose_of

TWELVE: Final = [JOINT_NAMES.index(name) for name in PLACES]


class Annotations(NamedTuple):
    """What the user says of a frame (T21, T22)."""

    orientation: Orientation | None = None
    depth: Mapping[str, str] = {}
    """LIMBS name to toward or away."""
    joints_px: Mapping[str, tuple[float, float]] = {}
    """JOINT_NAMES name to its place in the working picture, sides the person's own."""


class Sight(NamedTuple):
    """A person as one camera sees them, and what that is held against."""

    method: Method
    place: int
    """0 or 1: of its camera in the rig."""
    rig: Rig
    """Two cameras, at the working size: the other one tells the network its axes."""
    person: Observation
    """As without distortion, but its stick body, which is as the picture has it."""
    man: Stickman
    """Proportions of the stick body."""
    bdp: Bdp
    before: Vector | None
    """(25,) pose of the frame before; None at the first."""
    dt_s: float
    annotations: Annotations
    number: ViewerNumber = 1
    """Of its camera in the run's rig."""

    @property
    def camera(self) -> Camera:
        """That took the picture."""
        return self.rig.cameras[self.place]

    @property
    def seen(self) -> TwoSeen:
        """The person in the place of their camera; the only camera of a rig is its first, which
        proposals look at from the front."""
        first, second = self.rig.cameras
        return (self.person, None) if self.place == 0 or first == second else (None, self.person)

    @property
    def stature_m(self) -> float:
        """Of the person."""
        return stature(self.bdp)


class Hypothesis(NamedTuple):
    """A body that one silhouette may show."""

    joints_m: NDArray[np.float64]
    """(15, 3) world."""
    pose: Vector
    """(25,)"""
    score: float
    """S of its parts in the picture."""
    confidence: Vector
    """(15,)"""
    lifting: Lifting


def posed(sight: Sight, joints_m: NDArray[np.float64]) -> tuple[Vector, NDArray[np.float64]]:
    """The pose of joints (15, 3), and the joints, within limits unless the user placed them.

    The print has limits in the picture's plane alone.
    """
    before = rest_pose() if sight.before is None else sight.before
    body = body_vector(sight.bdp)
    pose: Vector = pose_of(joints_m[TWELVE], body, before)
    if not sight.method.joint_limits or sight.annotations.joints_px:
        return pose, joints_m
    return joint_limits.within(body, pose, before, joints_m)
