"""What the start page says to browsers: its sections."""

from typing import Literal

import msgspec

from animator.start.wishes import Task

State = Literal["waiting", "running", "done", "failed", "cancelled"]


class Section(msgspec.Struct, frozen=True, tag_field="kind", tag=str.lower):
    """A part of the page, as it is now."""


class Hello(Section, frozen=True):
    """What never changes while the page is open."""

    runs: str
    """The folder of the runs."""
    formats: tuple[str, ...]
    most_files: int
    most_bytes: int
    """Of one file."""


class ShownFile(msgspec.Struct, frozen=True):
    """A dropped file."""

    file: int
    name: str
    bytes: int
    got: int
    """Bytes that have come."""
    facts: str = ""
    """Length, rate, size and shape of a video; "" while it is not known."""
    fault: str = ""
    kind: Literal["video", "calibration", ""] = ""


class Tray(Section, frozen=True):
    """The dropped files, in the order of the cameras."""

    files: list[ShownFile]
    tasks: tuple[Task, ...]
    """What can be done with them now."""
    says: str
    """What they are together, or what is wrong with them."""
    name: str
    """Proposed name of the run."""


class Got(msgspec.Struct, frozen=True, tag_field="kind", tag="got"):
    """So much of a file has come: the next piece begins there."""

    file: int
    bytes: int


class ShownJob(msgspec.Struct, frozen=True):
    """A command that the page runs."""

    job: int
    title: str
    command: str
    """As a user would type it."""
    state: State
    share: float
    """Done, in [0, 1]."""
    doing: str
    """What it is doing, and how far it is."""
    lines: tuple[str, ...]
    """The last lines that it printed."""
    told: str
    """Its result, or its error with the cure."""
    run: str = ""
    """The run that it writes."""
    address: str = ""
    """Its own page."""
    bus: str = ""
    """Where programs hear its poses."""
    made: str = ""
    """Address of the file that it made."""
    again: bool = False
    """Whether its videos can be had in the tray again."""


class Jobs(Section, frozen=True):
    """Newest last."""

    jobs: list[ShownJob]


class ShownRun(msgspec.Struct, frozen=True):
    """A run folder."""

    name: str
    picture: str
    """Address of its picture; "": none yet."""
    when: str
    what: str
    frames: int
    believed: float | None
    """Share of the frames with a person in which the body is believed."""
    notes: tuple[str, ...]
    """Its warnings and advice."""
    files: tuple[tuple[str, str, int], ...]
    """Files to download: address, name, bytes."""
    replay: str
    """"": it can be replayed; else why not."""
    retouch: str
    """"": it can be retouched; else why not."""


class Runs(Section, frozen=True):
    """Newest first."""

    runs: list[ShownRun]
    left_out: int
    """Number of older ones that are not shown."""


class ShownCamera(msgspec.Struct, frozen=True):
    """A camera of this machine, or a file that plays as one."""

    camera: str
    """Its id in wishes and addresses."""
    name: str
    where: str
    """Bus path, which tells identical ones apart."""
    facts: str
    """Resolution and rate, once it is open."""
    fault: str
    picture: str
    """Address of its newest picture; "": none."""


class Cameras(Section, frozen=True):
    """The cameras of this machine."""

    on: bool
    cameras: list[ShownCamera]
    says: str
    """What to do where there are none."""
    watching: bool = False
    """Whether the calibration board is looked for."""
    board: tuple[str, ...] = ()
    """What it showed so far, and what is still needed."""


class ShownRecording(msgspec.Struct, frozen=True):
    """A clip that the page's cameras recorded."""

    name: str
    when: str
    says: str
    """Number of cameras, and length."""


class Recordings(Section, frozen=True):
    """Newest first."""

    recordings: list[ShownRecording]


class ShownCalibration(msgspec.Struct, frozen=True):
    """A kept calibration."""

    name: str
    when: str
    cameras: int
    told: str
    """What its command printed."""
    address: str


class Calibrations(Section, frozen=True):
    """Newest first."""

    calibrations: list[ShownCalibration]
    board: str
    """Address of the board to print; "": not made yet."""
