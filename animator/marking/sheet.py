"""What the marking page and a browser tell each other, as JSON: points, and what they give."""

import math
from typing import Any, Final, Literal

import msgspec

from common.body.observation import Pixel

Size = tuple[int, int]
"""Width and height, pixels."""
MOST_MARKS: Final = 60
"""Points in each picture: far more than anyone clicks."""
MOST_SAID_BYTES: Final = 30_000
"""A sheet of so many points, and some."""
FARTHEST_M: Final = 1000.0
"""No room is larger."""

Kind = Literal["pole", "floor", "wall"]


class SheetError(ValueError):
    """A sheet that the page cannot mean: the text says where."""


class Mark(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One point to be clicked in each picture."""

    kind: Kind
    """The top of a pole, or a point of the marker on the floor or on the wall."""
    px: tuple[Pixel | None, Pixel | None] = (None, None)
    """In the pictures of camera 1 and 2; the centre of the top-left pixel is (0.5, 0.5)."""
    at_m: tuple[float, float] | None = None
    """Where a pole stands, x and z."""


class Sheet(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All that was clicked, and the numbers beside."""

    marks: tuple[Mark, ...]
    numbers: dict[str, float | None]
    """What was measured by other means; None: not said."""


class Marked(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="marked"):
    """A browser has another sheet."""

    sheet: Sheet
    by: str
    """Which browser, by a word of its own."""
    count: int
    """Which of its sheets."""


class Save(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="save"):
    """A browser wants the calibration to be written."""


class Number(msgspec.Struct, frozen=True):
    """A number that is asked for beside the points."""

    key: str
    label: str
    unit: str
    needed: bool


class Pictures(msgspec.Struct, frozen=True):
    """One camera's pictures, by their addresses on the page."""

    number: int
    name: str
    stills: tuple[str, ...]
    """Addresses, in the video's order; of a camera that runs one, whose picture is always new."""
    frames: tuple[int, ...]
    """Which frame of the video each still is."""
    runs: bool


class Hello(msgspec.Struct, frozen=True, tag="hello", tag_field="kind"):
    """What a browser must know before it can draw."""

    title: str
    run: int
    """Another one is another process: a page begins afresh."""
    method: str
    size: Size
    """Of every picture."""
    pictures: tuple[Pictures, ...]
    numbers: tuple[Number, ...]
    hints: dict[str, tuple[str, str]]
    """Of each kind of mark what to click, in camera 1 and 2."""
    writes: str
    """The file that "save" writes; "": there is none."""
    most_marks: int = MOST_MARKS


class Seen(msgspec.Struct, frozen=True):
    """What the points tell of one camera."""

    known: bool
    text: str
    """What is still missing, where it is not known."""
    facts: tuple[tuple[str, str], ...] = ()
    off_px: tuple[float | None, ...] = ()
    """How far each mark is from where the result has it."""
    expected_px: tuple[Pixel | None, ...] = ()
    """Where that is."""
    lines_px: tuple[tuple[Pixel, Pixel], ...] = ()
    """What is drawn of the result: poles from foot to top, or the two markers."""


class Plan(msgspec.Struct, frozen=True):
    """The room from above, metres."""

    cameras: tuple[tuple[float, float, float, float], ...]
    """x, z, bearing (0: along +x, 90: along +z) and width of view, degrees."""
    marks: tuple[tuple[float, float, int], ...] = ()
    """x, z, and which mark."""


class Solved(msgspec.Struct, frozen=True):
    """What a sheet gives."""

    cameras: tuple[Seen, ...]
    names: tuple[str, ...]
    """Of the marks."""
    plan: Plan | None = None
    worst: str = ""
    """The point to look at first, by name."""
    worst_at: tuple[int, int] | None = None
    """Its camera (0 or 1) and mark."""
    whole: bool = False
    """Whether there is enough for a result of all cameras."""


class Shown(msgspec.Struct, frozen=True, tag="shown", tag_field="kind"):
    """A sheet and what it gives."""

    sheet: Sheet
    by: str
    count: int
    solved: Solved
    kept: str
    """Where the points are, or why they are not."""
    well: bool


class Told(msgspec.Struct, frozen=True, tag="told", tag_field="kind"):
    """What became of a wish."""

    text: str
    well: bool


def refuse_sheet(sheet: Sheet, hello: Hello) -> None:
    """Refuse what no click on this page gives.

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
    """What a browser said.

    Raises:
        SheetError: When no page of ours says so.
    """
    kinds: Any = Marked | Save
    try:
        wish: Marked | Save = msgspec.json.decode(said, type=kinds)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise SheetError(f"the page said what it cannot mean ({error}): load it anew") from error
    return wish
