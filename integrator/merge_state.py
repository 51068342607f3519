"""The integrator's state from one instant to the next."""

from typing import NamedTuple

from calibration.gate import moved_cameras, rig_agreement, silhouette_motion
from calibration.gate.moved_cameras import MovedCameras
from common.body.observation import Facing
from common.bus.messages import ScaleSource
from common.config.settings import Settings
from common.method import Method
from common.rig.camera import Rig
from common.rig.upright import Uprights
from integrator.frame_numbers import FrameTimes
from integrator.measuring.known_body import Opening, Unknown
from integrator.person import Person, Waiting
from integrator.rig import same_person
from integrator.rig.best_pair import Places


class State(NamedTuple):
    """The whole state."""

    settings: Settings
    method: Method
    rig: Rig | None
    """None until a person is seen, where no calibration is given."""
    scale_source: ScaleSource
    proposes: bool
    """The network proposes poses; otherwise the viewers search for angles."""
    alone: bool
    """The run has a single viewer."""
    period_s: float
    """Time between frames."""
    person: Person = Waiting()
    """The person who has been followed since the instant before, or none."""
    facing: tuple[Facing, ...] = ("facade", "flank")
    frames: tuple[int, ...] = (-1, -1)
    """The last frame received from each viewer, in the order of the rig's cameras."""
    last_s: float | None = None
    number: int = -1
    """Number of the instant: the frame of camera 1 that was taken then."""
    numbered: int = -1
    """The last number of an instant."""
    times: FrameTimes | None = None
    """When camera 1 takes its frames; None where it is no part of the run."""
    same: same_person.State = same_person.State()
    """Which of each view's people the person is."""
    pair: Places | None = None
    """The two views that showed the person best; None until a person was seen."""
    agreement: rig_agreement.State = rig_agreement.State()
    calibration: int = 0
    """Number of changes of the rig: places before and after a change do not compare."""
    uprights: Uprights = (None, None)
    """How each view's picture comes from its file's, by its last report."""
    stands: MovedCameras = MovedCameras()
    """Shifts of the cameras' pictures, now and when the rig was computed."""
    motion: silhouette_motion.State = silhouette_motion.init(2)
    """The silhouettes of the last half second."""


class Start(NamedTuple):
    """Further knowledge before the first frame."""

    alone: bool = False
    """The run has a single viewer."""
    source: ScaleSource | None = None
    """Source of the rig; None: it is calibrated, if there is one."""
    opening: Opening = Unknown()
    """The body, as far as known."""
    times: FrameTimes | None = None
    """When camera 1 takes its frames."""
    by_person: bool = False
    """The rig is assumed, and will be replaced by one from the person."""
    uprights: Uprights = ()
    """How the views' pictures come from their files', before any reports; empty: directly."""


def init(
    rig: Rig | None, period_s: float, settings: Settings, method: Method, start: Start = Start()
) -> State:
    """An integrator before any report.

    Args:
        rig: The viewers' cameras, for the working size; None: a rig of the paper's kind, of two,
            is assumed when a person is seen.
        period_s: Time between frames.
        settings: The run's settings.
        method: The departures from the print.
        start: Further knowledge.
    """
    source = start.source or ("assumed" if rig is None else "calibrated")
    proposes = method.proposals and (start.alone or start.by_person or source != "assumed")
    known = (rig, source, proposes, start.alone)
    person = Waiting(start.opening)
    state = State(settings, method, *known, period_s, person, times=start.times)
    cameras = 2 if rig is None else len(rig.cameras)
    return state._replace(
        facing=facing_at_start(cameras),
        frames=(-1,) * cameras,
        uprights=start.uprights or (None,) * cameras,
        stands=moved_cameras.init(cameras),
        motion=silhouette_motion.init(cameras),
    )


def facing_at_start(cameras: int) -> tuple[Facing, ...]:
    """Facings of the views before any evidence: the first alone sees the facade (P47)."""
    first: Facing = "facade"
    other: Facing = "flank"
    return (first, *(other,) * (cameras - 1))
