"""What the page's process and a browser tell each other, as JSON."""

from typing import Final, Literal

import msgspec

from animator.scene import LEFT, RIGHT, TRUNK, Colour
from common.body.body import ANGLE_NAMES, JOINT_NAMES, LIMBS
from common.body.extremities import ALL_JOINT_NAMES, EXTREMITY_LINES
from common.body.kinematics import HEAD
from common.bus.control_messages import Pulse
from common.bus.messages import Performance, Status
from common.npz_file import Facts

CYLINDERS: Final = [i for i in range(len(LIMBS)) if i != HEAD]
"""The limbs that are drawn as cylinders; the head is round."""

Numbers = list[float]


class ShownView(msgspec.Struct, frozen=True):
    """What one camera sees, in pixels of its working picture."""

    size: tuple[int, int]
    outline: list[Numbers]
    """The silhouette's contours, each x, y, x, y and so on, pixels."""
    limbs: list[Numbers]
    """The fitted body's, LIMBS order; one that is not before the camera has none."""
    joints: Numbers
    """Of ALL_JOINT_NAMES, or the first 15: x, y, x, y ...; empty where there is no pose."""
    score: float
    sees: str
    """Which side of the body."""
    hint: str
    """What the person could do about it."""
    jpeg: bytes
    """The picture, where one may be shown."""


class ShownPosture(msgspec.Struct, frozen=True):
    """What the body is doing."""

    name: str
    """Name of the posture under way, else of the last one performed."""
    doing: str
    """"" while nothing is under way."""
    times: int
    rivals: list[tuple[str, float]]
    """The likeliest names and their probabilities, best first."""


class ShownFrame(msgspec.Struct, frozen=True, tag="frame", tag_field="kind"):
    """An instant of the run."""

    number: int
    """Counts what was shown: a browser that comes late may be told one twice."""
    frame: int
    time_s: float
    status: Status
    words: str
    trust: str
    """How far the cameras are to be believed; "" while nothing tells."""
    from_views: str
    confidence: Numbers
    """Of the joints of the views."""
    solids: list[Numbers]
    """Cylinders, then balls and eggs: place (3), turn (w, x, y, z), size (3), colour (3) each."""
    angles: Numbers
    """ANGLE_NAMES order, degrees; empty where there is no pose."""
    views: list[ShownView | None]
    posture: ShownPosture | None
    events: tuple[Performance, ...]
    """Performances that are over since the instant before."""


class ShownHealth(msgspec.Struct, frozen=True, tag="health", tag_field="kind"):
    """How the processes are doing."""

    pulses: list[Pulse]


class ShownRoom(msgspec.Struct, frozen=True, tag="room", tag_field="kind"):
    """Where the cameras stand."""

    middle: Numbers
    spectator: Numbers
    cameras: list[list[Numbers]]
    """Of each its eye and the four corners of its picture, a metre before it."""


class Greeting(msgspec.Struct, frozen=True, tag="hello", tag_field="kind"):
    """What a browser must know before it can draw."""

    title: str
    run: int
    """Another one is another run, or another process of this one: a page begins afresh."""
    commands: bool
    """Whether anything hears what the user asks for."""
    angles: tuple[str, ...] = ANGLE_NAMES
    joints: tuple[str, ...] = ALL_JOINT_NAMES
    large: int = len(JOINT_NAMES)
    """Number of the joints that are drawn large, from the first on."""
    strokes: tuple[tuple[int, int], ...] = EXTREMITY_LINES
    """Hands and feet in the views, between joints."""
    limbs: tuple[str, ...] = LIMBS
    colours: dict[str, Colour] = msgspec.field(
        default_factory=lambda: {"left": LEFT, "right": RIGHT, "trunk": TRUNK}
    )
    cylinders: int = len(CYLINDERS)


class Told(msgspec.Struct, frozen=True, tag="told", tag_field="kind"):
    """What became of a wish."""

    what: str
    well: bool
    text: str


class Over(msgspec.Struct, frozen=True, tag="over", tag_field="kind"):
    """The run is over."""

    facts: Facts


class Asked(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What the person at the page asks for."""

    what: Literal["stop", "record", "end_record", "save", "measure", "background", "front", "back"]
