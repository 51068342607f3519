"""What browsers say to the start page: wishes as JSON, and files in pieces."""

import struct
from typing import Annotated, Final, Literal

import msgspec

CHUNK_BYTES: Final = 1 << 20
"""Largest piece of a file in one message, bytes."""
CHUNK_HEAD: Final = struct.Struct("<BIQ")
"""Head of a piece: 0, which no JSON begins with, the file's number, and where the piece begins."""
MOST_SAID_BYTES: Final = CHUNK_BYTES + CHUNK_HEAD.size
"""Upper bound of a browser's message, bytes."""
MOST_TEXT_BYTES: Final = 10_000
"""Upper bound of one that is no piece of a file, bytes."""

MOST_FILE_BYTES: Final = 1 << 62
"""Upper bound of what a browser may say of a file's size, bytes."""

Task = Literal["single", "track", "person", "board", "poles", "markers", "import"]
"""A job for the dropped files."""


class WishError(ValueError):
    """A message that is none of the page's; the text says why."""


class Wish(
    msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag=str.lower
):
    """What a browser asks for."""


class Begin(Wish, frozen=True):
    """A file will be sent, piece by piece."""

    file: int
    """A number of the browser's choice."""
    name: str
    bytes: Annotated[int, msgspec.Meta(le=MOST_FILE_BYTES)]


class Drop(Wish, frozen=True):
    """A file, or all of them, shall be forgotten."""

    file: int | None = None


class Raise(Wish, frozen=True):
    """A file shall stand one place earlier: cameras are numbered in this order."""

    file: int


class Work(Wish, frozen=True):
    """The dropped files shall be worked on."""

    task: Task
    name: str = ""
    """Name of the run or calibration; "": the files'."""
    calibration: str = ""
    """One of the list; "": none, the person tells where the cameras are."""
    offset_s: float | None = None
    """Delay of camera 2, seconds; None: estimated."""
    everyone: bool = False
    """Follow everyone, each with a number."""
    stature_m: float = 1.75
    square_mm: float | None = None
    """Side of a board's square, as measured; None: as printed."""


class Board(Wish, frozen=True):
    """The calibration board shall be written as a file to print."""

    paper: Literal["a4", "a3"] = "a3"


class Demo(Wish, frozen=True):
    """A made-up person shall be tracked live."""


class Cancel(Wish, frozen=True):
    """A job shall end."""

    job: int


class Again(Wish, frozen=True):
    """The videos of a job that failed or was cancelled shall be in the tray again."""

    job: int


class Open(Wish, frozen=True):
    """A page of a run shall be opened."""

    run: str
    page: Literal["replay", "retouch"]


class Export(Wish, frozen=True):
    """A run shall be written as a file for other programs."""

    run: str
    to: str
    """A format of the list."""


class Report(Wish, frozen=True):
    """A run shall be made into a page to look at."""

    run: str


class Compare(Wish, frozen=True):
    """Two runs shall be compared."""

    run: str
    other: str


class Delete(Wish, frozen=True):
    """A run, calibration or recording shall be deleted; the browser has asked its user."""

    what: Literal["run", "calibration", "recording"]
    name: str


class Look(Wish, frozen=True):
    """The cameras of this machine shall be opened, or closed."""

    on: bool


class Watch(Wish, frozen=True):
    """The calibration board shall be looked for in these cameras."""

    cameras: tuple[str, ...]
    """In the order of their numbers; none: no longer."""


class Watched(Wish, frozen=True):
    """The cameras shall be calibrated by what the board showed them."""

    square_mm: float | None = None
    """Side of a square, as measured; None: as printed."""


class Live(Wish, frozen=True):
    """Track live, by these cameras."""

    cameras: tuple[str, ...]
    calibration: str = ""
    pictures: bool = False
    """The live page may show small pictures."""


class Record(Wish, frozen=True):
    """A clip shall be recorded by these cameras."""

    cameras: tuple[str, ...]
    """In the order of their numbers."""
    seconds: float
    name: str = ""
    """Name of the clip; "": the present time."""


class Take(Wish, frozen=True):
    """The videos of a recording shall be in the tray."""

    name: str


AnyWish = (Begin | Drop | Raise | Work | Board | Demo | Cancel | Open | Again) | (
    Export | Report | Compare | Delete | Look | Watch | Watched | Live | Record | Take
)


class Chunk(msgspec.Struct, frozen=True):
    """A piece of a file."""

    file: int
    start: int
    """Where it begins, bytes."""
    content: memoryview


def heard(said: bytes) -> AnyWish | Chunk:
    """A browser's message.

    Raises:
        WishError: When it is none of the page's.
    """
    if said[:1] == b"\0" and len(said) >= CHUNK_HEAD.size:
        _, file, start = CHUNK_HEAD.unpack_from(said)
        return Chunk(file, start, memoryview(said)[CHUNK_HEAD.size :])
    if len(said) > MOST_TEXT_BYTES:
        raise WishError(f"a message of {len(said)} bytes: {MOST_TEXT_BYTES} at most")
    try:
        wish: AnyWish = msgspec.json.decode(said, type=AnyWish)
    except (msgspec.DecodeError, RecursionError) as error:
        raise WishError(f"not a message of this page: {error}") from error
    return wish
