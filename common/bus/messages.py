"""Everything that is ever said on the bus."""

from typing import Annotated, Final, Literal

import msgspec

from common.body.body import Bdp
from common.body.observation import Facing, Observation, Pixel
from common.rig.upright import Shift, Upright

PROTOCOL: Final = 12

MOST_VIEWS: Final = 8
"""Cameras of a rig."""
ViewerNumber = Annotated[int, msgspec.Meta(ge=1, le=MOST_VIEWS)]
"""A camera's place in the rig's order, the first is 1: never a place in a pair."""
Status = Literal["empty", "measuring", "tracking", "predicted", "lost"]
Views = Annotated[str, msgspec.Meta(pattern=r"^(both|none|[1-8](\+[1-8])*)$")]
"""Which views show the person: of two cameras "both", of more their numbers, as "1+3"."""
ScaleSource = Literal["calibrated", "person", "assumed"]
"""Where a rig is from: a file, the person who moves before it, or nowhere."""
CameraFault = Literal["", "frozen", "black", "saturated", "covered"]
MOTION_S: Final = 0.5
"""How far back a guide looks for motion, seconds."""
Point = tuple[float, float, float]


class Message(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What all messages carry."""

    protocol: int = PROTOCOL


class Moment(Message, frozen=True, kw_only=True):
    """A message that speaks of a frame."""

    frame: int
    captured_s: float
    """When it was taken: seconds since the clip began, or by the room's clock for a camera."""
    clock_s: float
    """The same moment by the room's clock (the integrator host's monotonic clock): for latency."""


class View(Moment, frozen=True, kw_only=True):
    """What one viewer made of one frame."""

    viewer: ViewerNumber
    width: int
    height: int
    """Of the picture that was worked on, pixels."""
    people: tuple[Observation, ...] = ()
    """Who is seen; () where no person is."""
    blobs: int = 0
    """How many regions were large enough to be a person (P4)."""
    next_s: float | None = None
    """`captured_s` of the next frame at the earliest; None for a camera, which does not know."""
    fault: CameraFault = ""
    """What is wrong with the picture; no person is seen in it then."""
    shift: Shift | None = None
    """How the camera was moved since the start; None: it stands as it stood."""
    upright: Upright | None = None
    """How the picture that all pixels here are of comes from the file's; None: it is that."""

    @property
    def person(self) -> Observation | None:
        """The person who is followed; None where no person is seen."""
        return self.people[0] if self.people else None


class Guide(Moment, frozen=True, kw_only=True):
    """What the integrator tells the viewers for their next frame."""

    frames: tuple[int, ...]
    """The last frame of each viewer that it has heard of; -1: none. This and all else by camera is
    in the order of the rig's cameras."""
    status: Status = "empty"
    bdp: Bdp | None = None
    """Universal BDPs, metres; None until somebody was seen."""
    measured: bool = False
    """True once they come from the opening posture, False while they are a prior."""
    facing: tuple[Facing, ...] = ("facade", "flank")
    scale_px_per_m: tuple[float, ...] = (0.0, 0.0)
    """Size of a metre at the body in each picture: reference scale times r_t,n (section 4.2); 0
    where a camera has the body behind it."""
    root_px: tuple[Pixel, ...] = ((0.0, 0.0), (0.0, 0.0))
    """Where to expect the navel in each picture."""
    rest_row_px: tuple[float, ...] = (0.0, 0.0)
    """Row of each picture where the navel would be if the person stood upright there (P33)."""
    pose: tuple[float, ...] = ()
    """Predicted pose, POSE_NAMES order, metres and degrees."""
    stick: bool = False
    """A stick body is asked for: one view is left, and what it proposes does not fit."""
    proposes: bool = False
    """The integrator reads the pose off the silhouettes: angles are not to be searched for."""
    moves: tuple[bool, ...] = (False, False)
    """Whether each view's silhouette has changed within the last MOTION_S as a person's who moves:
    a picture of another that has not is no picture of now."""


class Lifting(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What one view alone cannot measure and was decided by itself (T21, T22)."""

    orientation: str
    """One of `common.notes.notes.ORIENTATIONS`."""
    orientation_confidence: float
    """In [0, 1]; 1 where the user said so."""
    depth_confidence: tuple[float, ...]
    """LIMBS order, in [0, 1]: of the sign of each segment's depth."""
    depth_error_deg: tuple[float, ...] = ()
    """LIMBS order: how far a segment's angle out of the picture changes with a pixel of its length
    (T19); empty where the pose was not lifted from its segments."""


class Agreement(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How well both views agree by the run's rig, over the last seconds."""

    apart_mm: float
    """How far they place the joints from each other, errors that change left out."""
    soles_mm: float
    """Height of the feet above the floor while both stand on it."""
    facing_deg: float
    """How far they disagree which way in the room the person faces."""
    motion_mm: float
    """How far they disagree how the joints move: what changes in how far apart they are placed."""
    believed: float
    """By what the joints' confidence is multiplied: 1 of a rig that is believable."""


class Body(Moment, frozen=True, kw_only=True):
    """One body: the universal BAPs and the joints they give."""

    status: Status
    views: Views
    person: int = 0
    """The same number as long as it is the same person."""
    joints_m: tuple[Point, ...] = ()
    """JOINT_NAMES order, world; empty where there is no pose."""
    joints_px: tuple[tuple[Pixel, ...], ...] = ()
    """The same joints in the picture of each camera."""
    pose: tuple[float, ...] = ()
    """POSE_NAMES order; the angles are the smooth ones."""
    angles_raw_deg: tuple[float, ...] = ()
    """ANGLE_NAMES order, before smoothing."""
    confidence: tuple[float, ...] = ()
    """JOINT_NAMES order, in [0, 1]."""
    extremities_m: tuple[Point, ...] = ()
    """Nose, heels, toes, knuckles: EXTREMITY_NAMES order, world; empty where there is no pose."""
    extremities_px: tuple[tuple[Pixel, ...], ...] = ()
    """The same in the picture of each camera."""
    extremities_confidence: tuple[float, ...] = ()
    """EXTREMITY_NAMES order, in [0, 1]; 0: not measured, it follows from the joints."""
    seen: tuple[bool, ...] = (False, False)
    """Whether each camera shows the person."""
    score: tuple[float, ...] = (0.0, 0.0)
    """S of the pose in the picture of each camera; 0 where it sees no person."""
    facing: tuple[Facing, ...] = ("facade", "flank")
    bdp: Bdp | None = None
    matches: int = 0
    lifting: Lifting | None = None
    """Where one view alone shows the body."""
    scale_source: ScaleSource = "assumed"
    """Where the rig is from that the body is told by."""
    calibration: int = 0
    """How often that rig was changed in the run: places before and after do not compare."""
    agreement: Agreement | None = None
    """None where one view alone shows the body, and until enough was seen."""
    moved: tuple[ViewerNumber, ...] = ()
    """Cameras that were moved, and whose new place the person has not confirmed yet."""
    made_of: tuple[int, ...] = (-1, -1)
    """Frames of each viewer's report that it is made of; -1: none of that viewer."""


class Performance(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One performance of a posture, from standing to standing."""

    name: str
    onset: int
    """Its first frame; `end` is its last."""
    end: int
    onset_s: float
    """When these were taken, as `captured_s`."""
    end_s: float
    posterior: float
    """Of this posture among all, in [0, 1]."""
    times: int = 0
    """How often its course was gone through: strides, kicks, circles."""


class Posture(Moment, frozen=True, kw_only=True):
    """What the body is doing."""

    name: str
    """One of the model's posture names, or "" while nothing can be said."""
    log_likelihoods: dict[str, float] = {}
    """log P(window | model) of each posture."""
    segment: tuple[int, int] = (0, 0)
    """First and last frame of the window that was judged."""
    doing: str = ""
    """The posture that is under way; "" while standing or doing something unknown. By a model that
    knows no standing (the paper's) it is `name`."""
    times: int = 0
    """How often its course was gone through so far."""
    event: Performance | None = None
    """A performance that is over, or cut off by the end of the run. One of the same onset as the
    event before is that performance gone on after a pause, and takes its place."""


class Picture(Moment, frozen=True, kw_only=True):
    """A small picture for the page; published only where the settings say so."""

    viewer: ViewerNumber
    jpeg: bytes
