"""What processes tell each other of themselves and of the run."""

from typing import Annotated, Literal

import msgspec

from common.bus.messages import Message, ScaleSource, ViewerNumber
from common.rig.camera import Rig


class Pulse(Message, frozen=True, kw_only=True):
    """How a process is doing, once a second and at its end."""

    process: str
    state: Literal["starting", "ready", "running", "ended", "restarting", "given up"]
    detail: str = ""
    frames: int = 0
    fps: float = 0.0
    deadline_misses: int = 0
    dropped: int = 0
    guide_misses: int = 0
    hurried: int = 0
    """Frames that came so late that a viewer told their outline alone."""
    malformed: int = 0
    foreign: int = 0
    """Messages that were dropped since they were not of this run."""
    late: int = 0
    latency_p50_ms: float = 0.0
    latency_p99_ms: float = 0.0
    memory_mb: float = 0.0


class Cameras(Message, frozen=True, kw_only=True):
    """The rig that a run uses, once it is known, and again when it is changed."""

    rig: Rig
    scale_source: ScaleSource
    calibration: int = 0
    """How often it was changed: that of each body that is told by it."""
    late_s: float = 0.0
    """By how much the times of view 2 are set back."""


class Ended(Message, frozen=True, kw_only=True):
    """A viewer's clip is over, or broke."""

    viewer: ViewerNumber
    frames: int
    why: str = ""
    """What broke; "" where it came to its end or was stopped."""


class ClockQuestion(Message, frozen=True, kw_only=True):
    """Somebody asks what the room's clock says; a viewer, whether it may begin too."""

    viewer: ViewerNumber | None = None
    """Who asks; None: somebody for whom no run waits."""
    ready: bool = False
    """That viewer can begin."""


class ClockAnswer(Message, frozen=True, kw_only=True):
    """The room's clock at the moment of the answer, and the start if it is fixed."""

    now_s: float
    start_s: float | None = None


Wish = Literal[
    "start", "stop", "record", "end_record", "save", "measure", "background", "front", "back"
]
"""What a person at the page may ask of a run."""


class Command(Message, frozen=True, kw_only=True):
    """The person at the page wants something; whoever can do it does, and answers."""

    what: Wish


class Answer(Message, frozen=True, kw_only=True):
    """What became of a command; each process that took part says so."""

    what: Wish
    well: bool
    text: Annotated[str, msgspec.Meta(max_length=400)]
    """For the person, one sentence."""
