"""The person followed by a run: their observations at an instant, and their state between
instants."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.body.kinematics import joints
from common.body.observation import Facing
from common.body.proportions import body_vector
from common.bus.instant import Instant, Seen
from common.rig.camera import Rig
from integrator.landmarks import landmark_fusion
from integrator.measuring.known_body import Known, Opening, Phase, Unknown
from integrator.pose import smoothing
from integrator.proposal.pose_proposal import Memory
from integrator.rig.best_pair import Places, Two, two_of
from integrator.single.sight import Annotations
from integrator.single.single_view import Alone


class Sighting(NamedTuple):
    """An instant in which a person is seen, with its rig."""

    instant: Instant
    """The views received."""
    filed_rig: Rig
    """The cameras that took its pictures."""
    rig: Rig
    """The same cameras without distortion."""
    seen: Seen
    """The person in each view, without distortion; one view at least shows them."""
    pair: Places
    """The two views that show the person best."""
    dt_s: float
    """Time since the instant before; 0 where no person was followed then."""
    annotations: Annotations = Annotations()

    @property
    def two(self) -> Two:
        """The pair, for methods that take two views."""
        return two_of(self.rig, self.seen, self.pair)


class Posed(NamedTuple):
    """The pose of an instant, and its by-products."""

    pose: Vector
    """(25,) of POSE_NAMES, not smoothed."""
    facing: tuple[Facing, ...]
    joints_m: NDArray[np.float64] | None = None
    """(15, 3) world, JOINT_NAMES; None: where the cylinders of the smooth pose end."""
    confidence: Vector | None = None
    """(15,) probability that each joint is less than 50 mm off; None: from the body's fit."""
    memory: Memory | None = None
    """Memory of the network that proposed it."""
    landmarks: landmark_fusion.Memory | None = None
    """Memory of the views' landmarks."""
    alone: Alone | None = None
    """Set where one view alone shows the body."""


class Waiting(Phase, frozen=True, tag=True):
    """No person is followed; the body's measurements are kept."""

    body: Opening = Unknown()
    ever_confirmed: bool = False
    """A change of the rig restarted the search for a person who was believed before."""

    @property
    def found(self) -> None:
        """No pose."""

    @property
    def pose(self) -> None:
        """No pose."""

    def expected_m(self, lost: int) -> None:
        """No place."""


class Following(Phase, frozen=True, tag=True):
    """A person who is followed, in the state of the last instant."""

    body: Known
    found: Posed
    smooth: smoothing.State
    doubted: int = 0
    """Number of frames in a row in which they were not believed."""
    ever_confirmed: bool = False
    """Whether they were ever believed."""

    @property
    def pose(self) -> Vector:
        """(25,) the pose of the last instant."""
        return self.found.pose

    def expected_m(self, lost: int) -> Vector | None:
        """Place of the person, (3,) world; None where they are lost, after so many instants."""
        return self.pose[:3] if self.doubted < lost else None

    def places_m(self, pose: Vector) -> NDArray[np.float64]:
        """The joints (15, 3) of the last instant, world: as found, or else from a pose."""
        if self.found.joints_m is not None:
            return self.found.joints_m
        return np.asarray(joints(body_vector(self.body.bdp), pose))


Person = Waiting | Following
