"""JSON messages between the page's process and a browser."""

from collections.abc import Sequence
from typing import Final, Literal

import msgspec

from animator.scene import LEFT, PEOPLE, RIGHT, TRUNK, Colour
from common.body.body import ANGLE_NAMES, JOINT_NAMES, LIMBS
from common.body.extremities import ALL_JOINT_NAMES, EXTREMITY_LINES
from common.body.kinematics import HEAD
from common.bus.control_messages import Pulse
from common.bus.messages import MOST_VIEWS, Performance, Status
from common.npz_file import Facts

CYLINDERS: Final = [i for i in range(len(LIMBS)) if i != HEAD]
"""Indices of the limbs that are drawn as cylinders; the head is round."""

Numbers = list[float]


class ShownFit(msgspec.Struct, frozen=True, kw_only=True):
    """A person's body in one camera's view, in pixels of its working picture."""

    limbs: list[Numbers]
    """Contours of the fitted body, LIMBS order; one behind the camera has none."""
    joints: Numbers
    """ALL_JOINT_NAMES, or the first 15: x, y, x, y ...; empty where there is no pose."""
    score: float
    sees: str
    """The side of the body that it sees: facade or flank."""
    advice: str
    """What the person can do to be seen better by it or measured; "" where there is nothing."""


class ShownView(ShownFit, frozen=True, kw_only=True):
    """One camera's view, with the body of the frame's own person."""

    size: tuple[int, int]
    outline: list[Numbers]
    """Contours of the silhouette, each x, y, x, y and so on, pixels."""
    fault: str
    """The fault of its picture; "" where there is none."""
    jpeg: bytes
    """The picture, where one may be shown."""


class ShownPosture(msgspec.Struct, frozen=True):
    """The recognised posture."""

    name: str
    """Name of the posture in progress, else of the last one performed."""
    doing: str
    """"" while none is in progress."""
    times: int
    rivals: list[tuple[str, float]]
    """The likeliest names and their probabilities, best first."""


class ShownEvent(Performance, frozen=True, kw_only=True):
    """A performance that has ended."""

    person: int
    """Whose it is, as in `ShownPerson`."""


class ShownPerson(msgspec.Struct, frozen=True, kw_only=True):
    """A person at an instant."""

    person: int
    """Their number; 0: of a run that follows one person, or no person."""
    status: Status
    words: str
    from_views: str
    confidence: Numbers
    """Confidence of the joints in the views."""
    solids: list[Numbers]
    """Cylinders, then balls and ellipsoids: place (3), turn (w, x, y, z), size (3), colour (3)
    each."""
    angles: Numbers
    """ANGLE_NAMES order, degrees; empty where there is no pose."""
    views: Sequence[ShownFit | None]
    posture: ShownPosture | None


class ShownFrame(ShownPerson, frozen=True, kw_only=True, tag="frame", tag_field="kind"):
    """An instant of the run, with its person; of several, that of the lowest number."""

    number: int
    """Number of frames shown so far: a late browser may receive one twice."""
    frame: int
    time_s: float
    trust: str
    """Doubt about the cameras; "" while there is none."""
    views: Sequence[ShownView | None]
    others: list[ShownPerson]
    """All other people, by number."""
    events: tuple[ShownEvent, ...]
    """Performances that have ended since the instant before."""


class ShownHealth(msgspec.Struct, frozen=True, tag="health", tag_field="kind"):
    """How the processes are doing."""

    pulses: list[Pulse]


class ShownRoom(msgspec.Struct, frozen=True, tag="room", tag_field="kind"):
    """The cameras' places."""

    middle: Numbers
    spectator: Numbers
    cameras: list[list[Numbers]]
    """For each its centre and the four corners of its picture, at a depth of one metre."""


CAMERAS: Final = tuple(f"camera {n}" for n in range(1, MOST_VIEWS + 1))
"""What the page calls cameras without names of their own."""


class Greeting(msgspec.Struct, frozen=True, tag="hello", tag_field="kind"):
    """The first message to a browser: what it needs to draw."""

    title: str
    run: int
    """Id of the run and process: with another one a page starts afresh."""
    commands: bool
    """Whether any process carries out the user's commands."""
    cameras: tuple[str, ...] = CAMERAS
    """What the page calls each camera, by its number."""
    angles: tuple[str, ...] = ANGLE_NAMES
    joints: tuple[str, ...] = ALL_JOINT_NAMES
    large: int = len(JOINT_NAMES)
    """Number of joints that are drawn large, from the first on."""
    strokes: tuple[tuple[int, int], ...] = EXTREMITY_LINES
    """Hands and feet in the views, between joints."""
    limbs: tuple[str, ...] = LIMBS
    colours: dict[str, Colour] = msgspec.field(
        default_factory=lambda: {"left": LEFT, "right": RIGHT, "trunk": TRUNK}
    )
    people: tuple[Colour, ...] = PEOPLE
    """Colours of the people of a run that follows several, the first person's first."""
    cylinders: int = len(CYLINDERS)


class Told(msgspec.Struct, frozen=True, tag="told", tag_field="kind"):
    """The outcome of a command."""

    what: str
    well: bool
    text: str


class Over(msgspec.Struct, frozen=True, tag="over", tag_field="kind"):
    """The run is over."""

    facts: Facts


class Asked(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A user's command at the page."""

    what: Literal["stop", "record", "end_record", "save", "measure", "background", "front", "back"]
