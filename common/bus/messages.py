"""All messages on the bus."""

from typing import Annotated, Final, Literal

import msgspec

from common.body.body import Bdp
from common.body.observation import Facing, Observation, Pixel
from common.rig.upright import Shift, Upright

PROTOCOL: Final = 12

MOST_VIEWS: Final = 8
"""Upper bound of the number of cameras in a rig."""
MOST_PEOPLE: Final = 5
"""Upper bound of the number of people in a scene, and of those whom a run follows."""
ViewerNumber = Annotated[int, msgspec.Meta(ge=1, le=MOST_VIEWS)]
"""Index of a camera in the rig's order, from 1."""
Status = Literal["empty", "measuring", "tracking", "predicted", "lost"]
Views = Annotated[str, msgspec.Meta(pattern=r"^(both|none|[1-8](\+[1-8])*)$")]
"""Which views show the person: "both" of two cameras, of more their numbers as "1+3"."""
ScaleSource = Literal["calibrated", "person", "assumed"]
"""Where a rig comes from: a file, the person who moves before it, or an assumption."""
CameraFault = Literal["", "frozen", "black", "saturated", "covered"]
MOTION_S: Final = 0.5
"""Window in which a guide looks for motion, seconds."""
Point = tuple[float, float, float]


def place_in_rig(number: ViewerNumber) -> int:
    """Place, from 0, of a viewer's camera in what is ordered as the rig's cameras are."""
    return number - 1


class Message(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Base of all messages."""

    protocol: int = PROTOCOL


class Moment(Message, frozen=True, kw_only=True):
    """A message about a frame."""

    frame: int
    captured_s: float
    """Capture time: seconds since the clip began, or by the room's clock for a camera."""
    clock_s: float
    """The same moment by the room's clock (the integrator host's monotonic clock), for latency."""


class View(Moment, frozen=True, kw_only=True):
    """One viewer's result for one frame."""

    viewer: ViewerNumber
    width: int
    height: int
    """Size of the working picture, pixels."""
    people: tuple[Observation, ...] = ()
    """The people seen; () where there is none."""
    blobs: int = 0
    """Number of regions that were large enough to be a person (P4)."""
    next_s: float | None = None
    """Earliest `captured_s` of the next frame; None for a camera, which cannot know it."""
    fault: CameraFault = ""
    """Fault of the picture; no person is reported then."""
    shift: Shift | None = None
    """How the camera was moved since the start; None: it was not."""
    upright: Upright | None = None
    """How the working picture, to which all pixels here refer, comes from the file's; None:
    directly."""

    @property
    def person(self) -> Observation | None:
        """The person who is followed; None where no person is seen."""
        return self.people[0] if self.people else None


class Guide(Moment, frozen=True, kw_only=True):
    """The integrator's prediction for the viewers' next frame."""

    frames: tuple[int, ...]
    """The last frame received from each viewer; -1: none. All fields by camera are in the order
    of the rig's cameras."""
    status: Status = "empty"
    bdp: Bdp | None = None
    """Universal BDPs, metres; None until a person was seen."""
    measured: bool = False
    """True once they come from the opening posture, False while they are a prior."""
    facing: tuple[Facing, ...] = ("facade", "flank")
    scale_px_per_m: tuple[float, ...] = (0.0, 0.0)
    """Pixels per metre at the body in each picture: reference scale times r_t,n (section 4.2); 0
    where the body is behind the camera."""
    root_px: tuple[Pixel, ...] = ((0.0, 0.0), (0.0, 0.0))
    """Predicted place of the navel in each picture."""
    rest_row_px: tuple[float, ...] = (0.0, 0.0)
    """Row of each picture where the navel would be if the person stood upright there (P33)."""
    pose: tuple[float, ...] = ()
    """Predicted pose, POSE_NAMES order, metres and degrees."""
    stick: bool = False
    """The viewer shall fit a stick body: one view is left, and its proposal fits badly."""
    proposes: bool = False
    """The integrator reads the pose off the silhouettes: viewers need not search for angles."""
    moves: tuple[bool, ...] = (False, False)
    """For each view, whether its silhouette has changed within the last MOTION_S as a moving
    person's does. A view without change while another has some shows a frozen picture."""
    due: tuple[int | None, ...] = ()
    """For each view, the viewer's own number of the person whose turn it is, as the run is late:
    the others' landmarks are carried on. None, or empty: everyone is looked at."""


class Lifting(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Decisions of a single view about what it cannot measure (T21, T22)."""

    orientation: str
    """One of `common.notes.notes.ORIENTATIONS`."""
    orientation_confidence: float
    """In [0, 1]; 1 where the user said so."""
    depth_confidence: tuple[float, ...]
    """LIMBS order, in [0, 1]: confidence in the sign of each segment's depth."""
    depth_error_deg: tuple[float, ...] = ()
    """LIMBS order: change of a segment's angle out of the picture with a pixel of its length
    (T19); empty where the pose was not lifted from segments."""


class Agreement(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Agreement of the views under the run's rig, over the last seconds."""

    apart_mm: float
    """Distance between the views' places of the joints, errors that vary left out."""
    soles_mm: float
    """Height of the feet above the floor while both stand on it."""
    facing_deg: float
    """Difference between the views' headings of the person in the world."""
    motion_mm: float
    """Difference between the views' motion of the joints: the varying part of their distance."""
    believed: float
    """Factor on the joints' confidence: 1 for a believable rig."""


class Body(Moment, frozen=True, kw_only=True):
    """One person's body in one frame: the universal BAPs and the joints they give."""

    status: Status
    views: Views
    person: int = 0
    """Constant as long as it is the same person."""
    joints_m: tuple[Point, ...] = ()
    """JOINT_NAMES order, world; empty where there is no pose."""
    joints_px: tuple[tuple[Pixel, ...], ...] = ()
    """The same joints in each camera's picture."""
    pose: tuple[float, ...] = ()
    """POSE_NAMES order; the angles are smoothed."""
    angles_raw_deg: tuple[float, ...] = ()
    """ANGLE_NAMES order, before smoothing."""
    confidence: tuple[float, ...] = ()
    """JOINT_NAMES order, in [0, 1]."""
    extremities_m: tuple[Point, ...] = ()
    """Nose, heels, toes, knuckles: EXTREMITY_NAMES order, world; empty where there is no pose."""
    extremities_px: tuple[tuple[Pixel, ...], ...] = ()
    """The same in each camera's picture."""
    extremities_confidence: tuple[float, ...] = ()
    """EXTREMITY_NAMES order, in [0, 1]; 0: not measured, derived from the joints."""
    seen: tuple[bool, ...] = (False, False)
    """Whether each camera shows the person."""
    score: tuple[float, ...] = (0.0, 0.0)
    """S of the pose in each camera's picture; 0 where the camera sees no person."""
    facing: tuple[Facing, ...] = ("facade", "flank")
    bdp: Bdp | None = None
    matches: int = 0
    lifting: Lifting | None = None
    """Set where one view alone shows the body."""
    scale_source: ScaleSource = "assumed"
    """Source of the rig that the body was computed with."""
    calibration: int = 0
    """Number of changes of that rig so far: places before and after a change do not compare."""
    agreement: Agreement | None = None
    """None where one view alone shows the body, and until enough was seen."""
    moved: tuple[ViewerNumber, ...] = ()
    """Cameras that were moved and whose new place the person has not confirmed yet."""
    made_of: tuple[int, ...] = (-1, -1)
    """The frame of each viewer's report that the body is made of; -1: none of that viewer."""
    advice: tuple[str, ...] = ()
    """For each camera, what this person can do to be seen better or to be measured; "" where there
    is nothing. Empty: nothing for any."""


class Performance(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One performance of a posture, from standing to standing."""

    name: str
    onset: int
    """Its first frame; `end` is its last."""
    end: int
    onset_s: float
    """Capture times of both frames, as `captured_s`."""
    end_s: float
    posterior: float
    """Probability of this posture among all, in [0, 1]."""
    times: int = 0
    """Number of repetitions: strides, kicks, circles."""


class Posture(Moment, frozen=True, kw_only=True):
    """The posture of one frame."""

    person: int = 0
    """The number of whose posture it is, as in their bodies."""
    name: str
    """One of the model's posture names, or "" while it cannot be decided."""
    log_likelihoods: dict[str, float] = {}
    """log P(window | model) of each posture."""
    segment: tuple[int, int] = (0, 0)
    """First and last frame of the judged window."""
    doing: str = ""
    """The posture in progress; "" while the person stands or does something unknown. A model
    without standing (the paper's) gives `name`."""
    times: int = 0
    """Number of repetitions so far."""
    event: Performance | None = None
    """A performance that has ended, or was cut off by the end of the run. If its onset equals
    that of the event before, it continues that performance after a pause and replaces it."""


class Picture(Moment, frozen=True, kw_only=True):
    """A small picture for the page; published only where the settings say so."""

    viewer: ViewerNumber
    jpeg: bytes
