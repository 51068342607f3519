"""What the integrator remembers from one instant to the next."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.gate import moved_cameras, rig_agreement, silhouette_motion
from calibration.gate.moved_cameras import MovedCameras
from common.body.body import ANGLE_NAMES, Vector
from common.body.observation import Facing
from common.bus.messages import ScaleSource
from common.config.settings import Settings
from common.method import Method
from common.rig.camera import Rig
from common.rig.upright import Uprights
from integrator.frame_numbers import FrameTimes
from integrator.landmarks import landmark_fusion
from integrator.opening_posture import Opening
from integrator.pose import smoothing
from integrator.proposal.pose_proposal import Memory
from integrator.rig.best_pair import Places
from integrator.single.single_view import Alone


class Posed(NamedTuple):
    """The pose of an instant, and what is known with it."""

    pose: Vector
    """(25,) of POSE_NAMES, not smoothed."""
    facing: tuple[Facing, ...]
    joints_m: NDArray[np.float64] | None = None
    """(15, 3) world, JOINT_NAMES; None: where the cylinders of the smooth pose end."""
    confidence: Vector | None = None
    """(15,) how probably each joint is less than 50 mm off; None: as well as the body fits."""
    memory: Memory | None = None
    """Of the network that proposed it."""
    landmarks: landmark_fusion.Memory | None = None
    """What is remembered of the views' landmarks."""
    alone: Alone | None = None
    """Where one view alone shows the body."""


class State(NamedTuple):
    """Everything, as one value."""

    settings: Settings
    method: Method
    rig: Rig | None
    """None until somebody is seen, where no calibration is given."""
    scale_source: ScaleSource
    proposes: bool
    """The network proposes poses; otherwise the viewers search for angles."""
    alone: bool
    """One viewer is all that the run has."""
    smooth: smoothing.State
    opening: Opening = Opening()
    found: Posed | None = None
    """Of the instant before; None while nobody is there."""
    facing: tuple[Facing, ...] = ("facade", "flank")
    frames: tuple[int, ...] = (-1, -1)
    """The last frame that was heard of each viewer, in the order of the rig's cameras."""
    last_s: float | None = None
    number: int = -1
    """Of the instant: the frame of camera 1 that was taken then."""
    numbered: int = -1
    """The last number that an instant had."""
    times: FrameTimes | None = None
    """When camera 1 takes its frames; None where it is no part of the run."""
    pair: Places | None = None
    """The two views that showed the person best; None until somebody was seen."""
    agreement: rig_agreement.State = rig_agreement.State()
    calibration: int = 0
    """How often the rig was changed: places before and after do not compare."""
    doubted: int = 0
    """For how many frames the body has not been believed."""
    ever_confirmed: bool = False
    """Whether it was believed since somebody came."""
    uprights: Uprights = (None, None)
    """How each view's picture comes from its file's, as it last told."""
    stands: MovedCameras = MovedCameras()
    """How the cameras stand, against how they stood when the rig was told."""
    motion: silhouette_motion.State = silhouette_motion.init(2)
    """The silhouettes of the last half second."""

    @property
    def pose(self) -> Vector | None:
        """(25,) the pose of the instant before; None while nobody is there."""
        return None if self.found is None else self.found.pose


class Start(NamedTuple):
    """What else is known before the first frame."""

    alone: bool = False
    """One viewer is all that the run has."""
    source: ScaleSource | None = None
    """Where the rig is from; None: it is calibrated, if there is one."""
    opening: Opening = Opening()
    """What is known of the body."""
    times: FrameTimes | None = None
    """When camera 1 takes its frames."""
    by_person: bool = False
    """A rig that is assumed is only the first guess: the person will tell it."""
    uprights: Uprights = ()
    """How the views' pictures come from their files', before any reports; empty: as they are."""


def init(
    rig: Rig | None, period_s: float, settings: Settings, method: Method, start: Start = Start()
) -> State:
    """An integrator that has heard nothing.

    Args:
        rig: The viewers' cameras, for the working size; None: a rig of the paper's kind, of two,
            is assumed when a person is seen.
        period_s: Time between frames.
        settings: Of the run.
        method: What is done beyond the print.
        start: What else is known.
    """
    source = start.source or ("assumed" if rig is None else "calibrated")
    proposes = method.proposals and (start.alone or start.by_person or source != "assumed")
    smooth = smoothing.init(len(ANGLE_NAMES), period_s)
    known = (rig, source, proposes, start.alone)
    state = State(settings, method, *known, smooth, start.opening, times=start.times)
    cameras = 2 if rig is None else len(rig.cameras)
    return state._replace(
        facing=facing_at_start(cameras),
        frames=(-1,) * cameras,
        uprights=start.uprights or (None,) * cameras,
        stands=moved_cameras.init(cameras),
        motion=silhouette_motion.init(cameras),
    )


def facing_at_start(cameras: int) -> tuple[Facing, ...]:
    """What each view is held to see before anything is known: the first alone the facade (P47)."""
    first: Facing = "facade"
    other: Facing = "flank"
    return (first, *(other,) * (cameras - 1))
