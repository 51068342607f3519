"""One view of a body at an instant, and candidate bodies for it."""

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
    """The user's inputs for a frame (T21, T22)."""

    orientation: Orientation | None = None
    depth: Mapping[str, str] = {}
    """LIMBS name to toward or away."""
    joints_px: Mapping[str, tuple[float, float]] = {}
    """JOINT_NAMES name to its place in the working picture, sides the person's own."""


class Sight(NamedTuple):
    """One camera's view of a person, and its context."""

    method: Method
    place: int
    """0 or 1: index of its camera in the rig."""
    rig: Rig
    """Two cameras, at the working size: the other one defines the network's axes."""
    person: Observation
    """Without distortion, except for its stick body, which is as in the picture."""
    man: Stickman
    """Proportions of the stick body."""
    bdp: Bdp
    before: Vector | None
    """(25,) pose of the frame before; None at the first."""
    dt_s: float
    annotations: Annotations
    number: ViewerNumber = 1
    """Index of its camera in the run's rig."""
    on_floor: bool = False
    """Whether the rig's floor is known, and the person may be hidden by others: the size of a whole
    silhouette tells the depth of who is alone better than feet, which walk."""

    @property
    def camera(self) -> Camera:
        """The camera of the picture."""
        return self.rig.cameras[self.place]

    @property
    def seen(self) -> TwoSeen:
        """The person at the index of their camera; the only camera of a rig counts as its first,
        and proposals see its person from the front."""
        return (self.person, None) if self.place == 0 or self.is_only else (None, self.person)

    @property
    def is_only(self) -> bool:
        """Whether the rig has no other camera."""
        first, second = self.rig.cameras
        return first == second

    @property
    def stature_m(self) -> float:
        """Stature of the person."""
        return stature(self.bdp)


class Hypothesis(NamedTuple):
    """A candidate body for one silhouette."""

    joints_m: NDArray[np.float64]
    """(15, 3) world."""
    pose: Vector
    """(25,) pose."""
    score: float
    """S of its parts in the picture."""
    confidence: Vector
    """(15,) confidence."""
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
