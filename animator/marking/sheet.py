"""JSON messages between the marking page and a browser: points, and the resulting calibration."""

import math
from typing import Any, Final, Literal

import msgspec

from common.body.observation import Pixel

Size = tuple[int, int]
"""Width and height, pixels."""
MOST_MARKS: Final = 60
"""Largest number of points in a picture."""
MOST_SAID_BYTES: Final = 30_000
"""Upper bound of a sheet's size, bytes."""
FARTHEST_M: Final = 1000.0
"""Largest distance in a room, metres."""

Kind = Literal["pole", "floor", "wall"]


class SheetError(ValueError):
    """A sheet that our page cannot send: the text says where."""


class Mark(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One point to be clicked in each picture."""

    kind: Kind
    """The top of a pole, or a point of the marker on the floor or on the wall."""
    px: tuple[Pixel | None, Pixel | None] = (None, None)
    """Pixels in the pictures of camera 1 and 2; the centre of the top-left pixel is (0.5, 0.5)."""
    at_m: tuple[float, float] | None = None
    """Position of a pole, x and z, metres."""


class Sheet(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All clicked points, and the numbers typed beside them."""

    marks: tuple[Mark, ...]
    numbers: dict[str, float | None]
    """Values measured by other means; None: not given."""


class Marked(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="marked"):
    """A browser's new sheet."""

    sheet: Sheet
    by: str
    """Id of the browser."""
    count: int
    """Number of its sheet."""


class Save(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="save"):
    """A browser's request to write the calibration."""


class Number(msgspec.Struct, frozen=True):
    """A number that the page asks for beside the points."""

    key: str
    label: str
    unit: str
    needed: bool


class Pictures(msgspec.Struct, frozen=True):
    """One camera's pictures, by their addresses on the page."""

    number: int
    name: str
    stills: tuple[str, ...]
    """Addresses, in the video's order; for a live camera one, whose picture is always new."""
    frames: tuple[int, ...]
    """The frame of the video of each still."""
    runs: bool


class Hello(msgspec.Struct, frozen=True, tag="hello", tag_field="kind"):
    """The first message to a browser: what it needs to draw."""

    title: str
    run: int
    """Id of this process: with another one a page starts afresh."""
    method: str
    size: Size
    """Size of every picture."""
    pictures: tuple[Pictures, ...]
    numbers: tuple[Number, ...]
    hints: dict[str, tuple[str, str]]
    """For each kind of mark what to click, in camera 1 and 2."""
    writes: str
    """The file that "save" writes; "": there is none."""
    most_marks: int = MOST_MARKS


class Seen(msgspec.Struct, frozen=True):
    """Results from the points of one camera."""

    known: bool
    text: str
    """What is still missing, where they are unknown."""
    facts: tuple[tuple[str, str], ...] = ()
    off_px: tuple[float | None, ...] = ()
    """Distance of each mark from its place by the result."""
    expected_px: tuple[Pixel | None, ...] = ()
    """That place."""
    lines_px: tuple[tuple[Pixel, Pixel], ...] = ()
    """Drawing of the result: poles from foot to top, or the two markers."""


class Plan(msgspec.Struct, frozen=True):
    """The room from above, metres."""

    cameras: tuple[tuple[float, float, float, float], ...]
    """x, z, bearing (0: along +x, 90: along +z) and angle of view, degrees."""
    marks: tuple[tuple[float, float, int], ...] = ()
    """x, z, and index of the mark."""


class Solved(msgspec.Struct, frozen=True):
    """The result of a sheet."""

    cameras: tuple[Seen, ...]
    names: tuple[str, ...]
    """Names of the marks."""
    plan: Plan | None = None
    worst: str = ""
    """Name of the point to check first."""
    worst_at: tuple[int, int] | None = None
    """Its camera (0 or 1) and mark."""
    whole: bool = False
    """Whether there are enough points for a result of all cameras."""


class Shown(msgspec.Struct, frozen=True, tag="shown", tag_field="kind"):
    """A sheet and its result."""

    sheet: Sheet
    by: str
    count: int
    solved: Solved
    kept: str
    """Where the points are, or why there are none."""
    well: bool


def refuse_sheet(sheet: Sheet, hello: Hello) -> None:
    """Refuse a sheet that no click on this page gives.

    Raises:
        SheetError: At the first fault.
    """
    if len(sheet.marks) > hello.most_marks:
        raise SheetError(f"there are more than {hello.most_marks} points: take some away")
    for n, mark in enumerate(sheet.marks):
        if mark.kind not in hello.hints or (mark.kind == "pole") != (mark.at_m is not None):
            raise SheetError(f"point {n + 1} is none of this page's: load it anew")
        for at in [at for at in mark.px if at is not None]:
            if not all(0.0 <= value <= most for value, most in zip(at, hello.size, strict=True)):
                raise SheetError(f"point {n + 1} is outside the picture: {at[0]:g}, {at[1]:g}")
        if not all(abs(value) <= FARTHEST_M for value in mark.at_m or ()):
            raise SheetError(f"pole {n + 1} is farther than {FARTHEST_M:g} m off: say metres")
    labels = {number.key: number.label for number in hello.numbers}
    for key, value in sheet.numbers.items():
        if key not in labels:
            raise SheetError(f"{key} is not asked for on this page: load it anew")
        if value is not None and not (math.isfinite(value) and value > 0):
            raise SheetError(f"{labels[key]}: must be a positive number, got {value:g}")


def heard(said: bytes) -> Marked | Save:
    """A browser's message, checked.

    Raises:
        SheetError: When it is no message of our page.
    """
    kinds: Any = Marked | Save
    try:
        wish: Marked | Save = msgspec.json.decode(said, type=kinds)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise SheetError(f"the page said what it cannot mean ({error}): load it anew") from error
    return wish
