"""Which command follows from which files: plans of jobs, without a file or a process touched."""

import re
import shlex
from collections.abc import Collection, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Final, Literal, NamedTuple

from animator.start.wishes import Compare, Export, Open, Report, Task, Work
from common.bus.messages import MOST_VIEWS
from runtime.live.free_ports import free_port
from runtime.store.run_exports import OWN_NAMES

CLIPS: Final = ".clips"
"""Folder of the runs' own videos, hidden so that `runs/*/` matches runs alone."""
CALIBRATIONS: Final = ".calibrations"
MOST_NAME: Final = 60
"""Characters allowed in the name of a run."""
NAME: Final = re.compile(rf"[A-Za-z0-9][A-Za-z0-9_-]{{0,{MOST_NAME - 1}}}", re.ASCII)
NUMBERED: Final = re.compile(r"(cam(era)?|view)?[\W_]*\d+", re.IGNORECASE)
"""A file's name that tells a camera's number alone."""
SIZE: Final = ("--size", "320x240")
"""The working size of `tritrack single`; that of `tritrack track` is half of it."""
MARKED_VIEWS: Final = 2
"""Cameras that poles and markers are for."""
RECORDED_S: Final = (1.0, 1200.0)
STATURE_M: Final = (0.5, 2.6)
SQUARE_MM: Final = (1.0, 1000.0)
OFFSET_S: Final = (-3600.0, 3600.0)
"""Bounds that the commands have."""

Kind = Literal["work", "page"]


class PlanError(ValueError):
    """A job that cannot be: the text says why and what to do."""


class Plan(NamedTuple):
    """A command and what it needs before it."""

    title: str
    arguments: tuple[str, ...]
    """After `tritrack`."""
    placed: tuple[tuple[Path, Path], ...] = ()
    """Files to copy or link first: from, to."""
    run: str = ""
    """Name of the run that it writes."""
    report: Path | None = None
    """File that keeps what it prints."""
    kind: Kind = "work"
    """A page stays open until it is ended, a work ends by itself."""
    frames: int = 0
    """Of the video; 0: not known."""
    makes: Path | None = None
    """A file of a run that it writes, to look at or to download."""
    needs: tuple[Path, ...] = ()
    """Files that it reads beside those that its command names."""
    times_s: tuple[tuple[float, ...], ...] = ()
    """When the frames of each video of `placed` were taken, on one clock; (): not known."""
    records: Path | None = None
    """Folder of the clip that it records."""

    @property
    def videos(self) -> tuple[tuple[Path, Path], ...]:
        """Of `placed`, those that a run has of its own."""
        return tuple(each for each in self.placed if self.run and each[1].suffix != ".json")

    @property
    def command(self) -> str:
        """As a user would type it."""
        return f"tritrack {shlex.join(self.arguments)}"


class Dropped(NamedTuple):
    """A dropped file that came whole."""

    path: Path
    frames: int = 0
    times_s: tuple[float, ...] = ()
    """When its frames were taken, on the clock of its recording; (): not known."""
    recording: str = ""
    """Files of one recording share a clock."""


class Known(NamedTuple):
    """What is there before a plan."""

    runs: Path
    """The folder of the runs."""
    names: frozenset[str] = frozenset()
    """Of runs, calibrations and planned ones."""
    calibrations: frozenset[str] = frozenset()
    records: bool = False
    """Whether runs of several cameras can be recorded."""


def tasks_of(videos: int, calibrations: int) -> tuple[Task, ...]:
    """What can be done with so many videos and calibration files of other programs."""
    if calibrations:
        return ("import",) if calibrations == 1 and not videos else ()
    if videos == 1:
        return ("single",)
    marked: tuple[Task, ...] = ("poles", "markers") if videos == MARKED_VIEWS else ()
    return ("track", "person", "board", *marked) if 2 <= videos <= MOST_VIEWS else ()


def plain_name(text: str) -> str:
    """A name for a run, of any text: letters, digits, _ and -."""
    plain = re.sub(r"[^A-Za-z0-9_-]+", "_", text).strip("_-")[:MOST_NAME]
    return plain or "video"


def name_of_files(stems: Sequence[str]) -> str:
    """A name for files together: what their names begin with, else the first one's."""
    first = stems[0] if stems else ""
    ends = zip(min(stems, default=""), max(stems, default=""), strict=False)
    shared = "".join(one for one, other in takewhile(lambda pair: pair[0] == pair[1], ends))
    common = plain_name(re.sub(r"(cam(era)?|view)?[\W_]*$", "", shared, flags=re.I))
    if len(stems) == 1 or (common == "video" and not NUMBERED.fullmatch(first)):
        return plain_name(first)
    return "clip" if common == "video" else common


def free_name(name: str, taken: Collection[str]) -> str:
    """The name, with a number where it is taken: walk, walk_2, walk_3."""
    number = 2
    free = name
    while free in taken:
        free = f"{name[: MOST_NAME - 5]}_{number}"
        number += 1
    return free


def planned(wish: Work, files: Sequence[Dropped], known: Known) -> Plan:
    """The plan for dropped files.

    Args:
        wish: The user's choice.
        files: In the order of the cameras.
        known: What is there.

    Raises:
        PlanError: When a name, number or calibration is invalid.
    """
    refuse_numbers(wish)
    refuse_name(wish.name)
    if wish.calibration and wish.calibration not in known.calibrations:
        raise PlanError(f"there is no calibration {wish.calibration!r}: choose one of the list")
    proposed = wish.name or name_of_files([file.path.stem for file in files])
    name = free_name(proposed, known.names)
    if wish.task in ("person", "board", "import"):
        return _calibrating(wish, files, known.runs, name)
    if wish.task in ("poles", "markers"):
        return _marking(wish, files, known.runs, name)
    return _tracking(wish, files, known, name)


def refuse_name(name: str) -> None:
    """Refuse a name that no run can have; "" is proposed by the page.

    Raises:
        PlanError: When it has other signs, or too many.
    """
    if name and not NAME.fullmatch(name):
        raise PlanError(
            f"the name {name!r} has other signs than letters, digits, _ and -, or is longer "
            f"than {MOST_NAME}: change it"
        )


def refuse_numbers(wish: Work) -> None:
    """Refuse numbers that its command does not take.

    Raises:
        PlanError: When there is one.
    """
    for what, value, (low, high) in (
        ("the person's height, in metres,", wish.stature_m, STATURE_M),
        ("the side of a square, in mm,", wish.square_mm, SQUARE_MM),
        ("the delay of camera 2, in seconds,", wish.offset_s, OFFSET_S),
    ):
        if value is not None and not low <= value <= high:
            raise PlanError(f"{what} must be from {low:g} to {high:g}, got {value:g}")


def _tracking(wish: Work, files: Sequence[Dropped], known: Known, name: str) -> Plan:
    folder = known.runs / CLIPS / name
    out = ("--out", str(known.runs))
    frames = max((file.frames for file in files), default=0)
    if wish.task == "single":
        video = folder / f"{name}{files[0].path.suffix.lower()}"
        arguments = ("single", str(video), *out)
        title = f"{name}: follow a person with one camera"
        return Plan(title, arguments, ((files[0].path, video),), name, frames=frames)
    placed, times_s = cameras_of(files, folder), times_of(files)
    if wish.calibration:
        placed += ((kept_calibration(known.runs, wish.calibration), folder / "calibration.json"),)
    more = [] if wish.offset_s is None else ["--offset", f"{wish.offset_s:g}"]
    more += ["--people", "all"] if wish.everyone else []
    more += ["--record"] if known.records else []
    title = f"{name}: follow a person with {len(files)} cameras"
    words = ("track", str(folder), *out, *SIZE, *more)
    return Plan(title, words, placed, name, frames=frames, times_s=times_s)


def _calibrating(wish: Work, files: Sequence[Dropped], runs: Path, name: str) -> Plan:
    made = kept_calibration(runs, name)
    folder = runs / CLIPS / name
    end = ("--out", str(made))
    report, times_s = made.with_suffix(".txt"), times_of(files)
    placed = cameras_of(files, folder)
    arguments: tuple[str, ...]
    if wish.task == "person":
        arguments = ("person", str(folder), "--stature", f"{wish.stature_m:g}")
        title = f"{name}: find the cameras by the person"
    elif wish.task == "board":
        side = () if wish.square_mm is None else ("--square", f"{wish.square_mm:g}")
        arguments = ("board", *(str(to) for _, to in placed), *side)
        title = f"{name}: find the cameras by the board"
    else:
        file = folder / files[0].path.name
        placed, arguments = ((files[0].path, file),), ("import", str(file))
        title = f"{name}: take over a calibration"
    return Plan(title, ("calibrate", *arguments, *end), placed, report=report, times_s=times_s)


def _marking(wish: Work, files: Sequence[Dropped], runs: Path, name: str) -> Plan:
    """Points are clicked on a page of their own; those of poles make a calibration."""
    folder, made = runs / CLIPS / name, kept_calibration(runs, name)
    points = kept_points(runs, name)
    page = ("--page", str(folder), "--port", str(free_port()))
    out = ("--out", str(made)) if wish.task == "poles" else ()
    arguments = ("calibrate", wish.task, str(points), *page, *out)
    return Plan(f"{name}: click the {wish.task}", arguments, cameras_of(files, folder), kind="page")


def cameras_of(files: Sequence[Dropped], folder: Path) -> tuple[tuple[Path, Path], ...]:
    """Where the videos of a clip come to lie: cam1.*, cam2.* and so on."""
    return tuple(
        (file.path, folder / f"cam{number}{file.path.suffix.lower()}")
        for number, file in enumerate(files, 1)
    )


def times_of(files: Sequence[Dropped]) -> tuple[tuple[float, ...], ...]:
    """When the frames of each video were taken, where all are of one recording; else ()."""
    one_clock = len({file.recording for file in files}) == 1
    return tuple(file.times_s for file in files) if one_clock and files[0].recording else ()


def kept_calibration(runs: Path, name: str) -> Path:
    """The file of a calibration of the list."""
    return runs / CALIBRATIONS / f"{name}.json"


def kept_points(runs: Path, name: str) -> Path:
    """The file of the points that were clicked for one."""
    return runs / CALIBRATIONS / f"{name}_points.toml"


def board_plan(runs: Path, paper: str) -> Plan:
    """The plan that writes the board to print."""
    arguments = ("calibrate", "board", "--print", str(runs / CALIBRATIONS / "board.pdf"))
    return Plan(f"the board to print, {paper.upper()}", (*arguments, "--paper", paper, "--force"))


def run_plan(wish: Open | Export | Report | Compare, runs: Path, port: int) -> Plan:
    """The plan for a run of the list.

    Args:
        wish: The user's choice.
        runs: The folder of the runs.
        port: A free port, for a page.
    """
    made = runs / wish.run
    folder, names = str(made), {str(to): file for to, file in OWN_NAMES.items()}
    if isinstance(wish, Export):
        arguments = ("export", folder, "--to", wish.to, "--force")
        return Plan(
            f"{wish.run}: write {wish.to.upper()}", arguments, makes=made / names.get(wish.to, "")
        )
    if isinstance(wish, Report):
        return Plan(f"{wish.run}: make a report", ("report", folder), makes=made / "report.html")
    if isinstance(wish, Compare):
        return Plan(
            f"{wish.run}: compare with {wish.other}",
            ("compare", folder, str(runs / wish.other)),
            makes=made / "compare.html",
        )
    page = ("--page",) if wish.page == "replay" else ()
    return Plan(
        f"{wish.run}: {wish.page}",
        (wish.page, folder, *page, "--port", str(port)),
        kind="page",
    )
