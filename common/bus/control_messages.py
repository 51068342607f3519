"""Messages about processes and the run itself."""

from typing import Annotated, Literal

import msgspec

from common.bus.messages import Message, Point, ScaleSource, ViewerNumber
from common.rig.camera import Rig


class Pulse(Message, frozen=True, kw_only=True):
    """The state of a process, published once a second and at its end."""

    process: str
    state: Literal["starting", "ready", "running", "ended", "restarting", "given up"]
    detail: str = ""
    frames: int = 0
    fps: float = 0.0
    deadline_misses: int = 0
    dropped: int = 0
    guide_misses: int = 0
    hurried: int = 0
    """Number of late frames that a viewer reported with the silhouette alone."""
    in_turn: int = 0
    """Number of frames in which a viewer looked at some people only, as the run was late."""
    malformed: int = 0
    foreign: int = 0
    """Number of messages that were dropped because they came from another run."""
    late: int = 0
    latency_p50_ms: float = 0.0
    latency_p99_ms: float = 0.0
    memory_mb: float = 0.0


class TurnedBack(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A camera that contradicted all others as calibrated."""

    camera: ViewerNumber
    turn: Point
    """Rotation vector of the scene in its axes, radians, from the calibration to where it looks."""
    apart_m: float
    """Gap between its sight lines and the others' as calibrated, metres."""
    then_m: float
    """The same once it is turned."""


class Cameras(Message, frozen=True, kw_only=True):
    """The rig that a run uses, published once it is known and again at each change."""

    rig: Rig
    scale_source: ScaleSource
    calibration: int = 0
    """Number of changes so far: bodies computed with this rig carry the same number."""
    late_s: float = 0.0
    """Seconds by which the times of view 2 are set back."""
    odd: TurnedBack | None = None
    """The camera that this rig has turned back; None: none."""


class Ended(Message, frozen=True, kw_only=True):
    """A viewer's clip has ended or failed."""

    viewer: ViewerNumber
    frames: int
    why: str = ""
    """The fault; "" where the clip ended normally or was stopped."""


class ClockQuestion(Message, frozen=True, kw_only=True):
    """A question: the room's clock, and for a viewer also whether it may begin."""

    viewer: ViewerNumber | None = None
    """The viewer that asks; None: a process that the run does not wait for."""
    ready: bool = False
    """The viewer is ready to begin."""


class ClockAnswer(Message, frozen=True, kw_only=True):
    """The room's clock when the answer was sent, and the run's start if it is fixed."""

    now_s: float
    start_s: float | None = None


Wish = Literal[
    "start", "stop", "record", "end_record", "save", "measure", "background", "front", "back"
]
"""What a user at the page may ask of a run."""


class Command(Message, frozen=True, kw_only=True):
    """A user's command from the page; each process that can carry it out does so and answers."""

    what: Wish


class Answer(Message, frozen=True, kw_only=True):
    """The outcome of a command, from each process that took part."""

    what: Wish
    well: bool
    text: Annotated[str, msgspec.Meta(max_length=400)]
    """One sentence for the user."""
