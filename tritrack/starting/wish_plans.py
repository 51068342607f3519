"""The plan that follows from a wish and from what is there now: files, runs, cameras."""

import time
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Final, NamedTuple

from animator.start.wishes import (
    Board,
    Compare,
    Demo,
    Export,
    Live,
    Open,
    Record,
    Report,
    Watched,
    Work,
)
from common.bus.messages import MOST_VIEWS
from common.video.pictures import Source
from runtime.live.free_ports import free_port
from runtime.store.run_exports import OWN_NAMES
from tritrack.machine_cameras.live_settings import live_settings
from tritrack.recording_cameras.recorded_clips import RECORDED
from tritrack.starting.calibration_list import calibration_names
from tritrack.starting.job_plan import (
    CALIBRATIONS,
    CLIPS,
    RECORDED_S,
    Dropped,
    Known,
    Plan,
    PlanError,
    board_plan,
    free_name,
    kept_calibration,
    planned,
    refuse_name,
    run_plan,
)
from tritrack.starting.run_list import run_folder
from tritrack.starting.start_files import SETTINGS
from tritrack.starting.tray import Facts, shown_tray
from tritrack.starting.uploads import Upload

Starting = Work | Board | Demo | Open | Export | Report | Compare | Live | Watched | Record
"""A wish that a command follows from."""


DEMO: Final = "demo"
"""Name of the demo's run."""
FEWEST: Final = 2
"""Cameras that make a clip."""


class There(NamedTuple):
    """What is there as a wish comes."""

    runs: Path
    files: Sequence[Upload]
    facts: Mapping[int, Facts]
    """Of the files, by their numbers."""
    sources: Mapping[str, Source]
    """Of the cameras, by their ids."""
    taken: frozenset[str]
    """Names of runs and recordings that jobs write."""
    board: tuple[Path, ...] = ()
    """Videos of the cameras before which the board was held."""

    @property
    def known(self) -> Known:
        """For the plans."""
        kept = calibration_names(self.runs)
        folders = [self.runs, self.runs / CLIPS]
        there = {path.name for folder in folders if folder.is_dir() for path in folder.iterdir()}
        names = frozenset(there | {*kept} | self.taken)
        return Known(self.runs, names, frozenset(kept), find_spec("mcap") is not None)


def plan_of(wish: Starting, there: There) -> Plan:
    """The plan that follows from a wish; the settings of a live run are written.

    Raises:
        PlanError: When what it names is not there, or is not for that.
        OSError: When the settings cannot be written.
    """
    if isinstance(wish, Work):
        return _plan_of_files(wish, there)
    if isinstance(wish, Live):
        return _plan_of_cameras(wish, there)
    if isinstance(wish, Record):
        return _plan_of_recording(wish, there)
    if isinstance(wish, Watched):
        if not there.board:
            raise PlanError("no board was shown yet: watch it, and hold it before the cameras")
        work = Work("board", f"board_{time.strftime('%Y-%m-%d_%H%M')}", square_mm=wish.square_mm)
        return planned(work, [Dropped(path) for path in there.board], there.known)
    if isinstance(wish, Board):
        (there.runs / CALIBRATIONS).mkdir(exist_ok=True)
        return board_plan(there.runs, wish.paper)
    if isinstance(wish, Demo):
        return demo_plan(there.runs)
    for name in [wish.run, wish.other] if isinstance(wish, Compare) else [wish.run]:
        if run_folder(there.runs, name) is None:
            raise PlanError(f"there is no run {name!r} any more")
    if isinstance(wish, Export) and wish.to not in OWN_NAMES:
        raise PlanError(f"there is no format {wish.to!r}: choose one of the list")
    return run_plan(wish, there.runs, free_port())


def refuse_cameras(cameras: Sequence[str], sources: Mapping[str, Source], least: int = 1) -> None:
    """Refuse a choice of cameras that cannot be.

    Args:
        cameras: Their ids.
        sources: Of those that are there.
        least: Fewest that must be chosen.

    Raises:
        PlanError: When there are too few, one twice, too many, or one that is not there.
    """
    if len(cameras) < least or len({*cameras}) < len(cameras):
        raise PlanError(f"choose {'two cameras' if least == FEWEST else 'one camera'} or more")
    if len(cameras) > MOST_VIEWS or not {*cameras} <= {*sources}:
        raise PlanError(f"{MOST_VIEWS} cameras at most, of those that are there: look again")


def _plan_of_files(wish: Work, there: There) -> Plan:
    if wish.task not in shown_tray(there.files, there.facts).tasks:
        raise PlanError("these files are not for that: drop one video, or two to eight")
    infos = {number: facts.info for number, facts in there.facts.items()}
    files = [
        Dropped(
            one.path,
            info.frames if (info := infos.get(one.number)) else 0,
            one.times_s,
            one.recording,
        )
        for one in there.files
    ]
    return planned(wish, files, there.known)


def _plan_of_recording(wish: Record, there: There) -> Plan:
    refuse_cameras(wish.cameras, there.sources, least=FEWEST)
    low, high = RECORDED_S
    if not low <= wish.seconds <= high:
        raise PlanError(f"a recording has from {low:g} to {high:g} seconds, got {wish.seconds:g}")
    refuse_name(wish.name)
    folder = there.runs / RECORDED
    taken = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    name = free_name(wish.name or time.strftime("clip_%Y-%m-%d_%H%M"), taken | there.taken)
    sources = [there.sources[each] for each in wish.cameras]
    return record_plan(sources, wish.seconds, folder / name)


def _plan_of_cameras(wish: Live, there: There) -> Plan:
    known, runs = there.known, there.runs
    refuse_cameras(wish.cameras, there.sources)
    if wish.calibration and wish.calibration not in known.calibrations:
        raise PlanError(f"there is no calibration {wish.calibration!r}: choose one of the list")
    name = free_name(time.strftime("live_%Y-%m-%d_%H%M"), known.names)
    rig = kept_calibration(runs, wish.calibration) if wish.calibration else None
    sources, port = [there.sources[each] for each in wish.cameras], free_port()
    file = runs / SETTINGS / f"{name}.toml"
    file.parent.mkdir(exist_ok=True)
    try:
        file.write_text(live_settings(sources, port, rig, wish.pictures), "utf-8")
    except UnicodeEncodeError as error:
        raise PlanError("a file's name is no Unicode, which settings must be: rename it") from error
    return live_plan(file, known, name, () if rig is None else (rig,))


def live_plan(settings: Path, known: Known, name: str, needs: tuple[Path, ...] = ()) -> Plan:
    """The plan of a live run by a settings file, and by what that names."""
    record = ("--record",) if known.records else ()
    arguments = ("live", str(settings), "--out", str(known.runs / name), *record)
    return Plan(f"{name}: live", arguments, run=name, kind="page", needs=needs)


def record_plan(sources: Sequence[Source], seconds: float, clip: Path) -> Plan:
    """The plan that records cameras into a clip's folder."""
    cameras = [word for source in sources for word in ("--camera", str(source))]
    arguments = ("record", "--out", str(clip), *cameras, "--seconds", f"{seconds:g}")
    title = f"{clip.name}: record {len(sources)} cameras"
    return Plan(title, arguments, records=clip)


def demo_plan(runs: Path) -> Plan:
    """The plan of the demo, whose page waits for its user."""
    arguments = ("demo", "--out", str(runs / DEMO))
    return Plan("a made-up person, live", arguments, run=DEMO, kind="page")
