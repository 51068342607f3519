"""Two to eight cameras recorded into one clip folder, each frame with the time it was taken."""

import shutil
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from itertools import combinations
from pathlib import Path
from typing import Final

from common.atomic_file import FileRefused
from common.npz_file import Facts
from common.video.camera_file import SPARE_BYTES, finish_times
from common.video.clip_sources import CLIP_CAMERAS, ClipError
from common.video.pictures import Source, is_recorded, named
from tritrack.recording_cameras.camera_take import CameraTake
from tritrack.recording_cameras.motion_delay import delay_s

MOST_S: Final = 1200.0
"""Longest recording, seconds: of larger pictures a file is full before."""
LOOK_S: Final = 0.1
READY_S: Final = 20.0
"""Seconds within which a camera gives its first picture, or it never will."""


def record_clip(
    sources: Sequence[Source],
    folder: Path,
    seconds: float,
    stop: threading.Event,
    tell: Callable[[str], object],
    force: bool = False,
    share: Callable[[float], object] = lambda _: None,
) -> Facts:
    """Record until the time is over, `stop` is set, a file or the disk is full, or a camera ends.

    Args:
        sources: Devices, or files that play as cameras, in the order of cam1, cam2 ...
        folder: The clip's; `meta.json` there gets each frame's time.
        seconds: At most MOST_S.
        stop: Set to end it.
        tell: Receives what happens.
        force: Whether a clip that is there may be replaced.
        share: Receives how much of the time is over, in [0, 1], ten times a second.

    Returns:
        `folder`, `seconds`, `why` it ended; by camera `frames`, `fps`, `dropped`, `fault`; and
        `later_s`, by how much each shows the same motion later than the first, null where unsure.

    Raises:
        ClipError: When there are not two to eight cameras, one is named twice or gives no picture,
            or it is stopped before.
        FileRefused: When a clip is there, or a camera plays a video of it.
        OSError: When the folder cannot be written.
    """
    old = _replaced(sources, folder, force)
    with ExitStack() as cameras:
        takes = []
        for name, source in zip(CLIP_CAMERAS, sources, strict=False):
            _refuse_stopped(stop)  # a camera that does not answer takes seconds
            takes.append(CameraTake(name, source, folder))
            cameras.callback(takes[-1].end)
        _wait_for(takes, stop)
        folder.mkdir(parents=True, exist_ok=True)
        for path in old:
            path.unlink()
        for take in takes:
            take.begin()
        tell(f"recording {len(takes)} cameras into {folder}, {seconds:.0f} s at most")
        began_s = time.monotonic()

        def tick() -> bool:
            done = (time.monotonic() - began_s) / min(seconds, MOST_S)
            share(min(1.0, done))
            return done >= 1.0

        why = _watched(takes, folder, tick, stop)
    return _finished(takes, folder, time.monotonic() - began_s, why)


def _replaced(sources: Sequence[Source], folder: Path, force: bool) -> list[Path]:
    """The files of the clip that is there and may be replaced.

    Raises:
        ClipError, FileRefused: As `record_clip`.
    """
    if not 2 <= len(sources) <= len(CLIP_CAMERAS):
        raise ClipError(f"{len(sources)} cameras: two to {len(CLIP_CAMERAS)} make a clip")
    for one, other in combinations(sources, 2):
        if one == other:
            raise ClipError(f"{named(one)} is named twice: name two cameras")
    old = [*folder.glob("cam[1-8].*"), *folder.glob("meta.json")] if folder.is_dir() else []
    if old and not force:
        raise FileRefused(f"{folder} holds a clip: name another --out, or say --force")
    for played in filter(is_recorded, sources):
        if Path(played).exists() and any(path.samefile(played) for path in old):
            raise FileRefused(f"{played} plays as a camera, and would be replaced: another --out")
    return old


def _refuse_stopped(stop: threading.Event) -> None:
    if stop.is_set():
        raise ClipError("stopped before a picture was recorded: nothing is written")


def _wait_for(takes: Sequence[CameraTake], stop: threading.Event) -> None:
    """Wait for the first picture of each.

    Raises:
        ClipError: When one gives none, or `stop` is set.
    """
    until_s = time.monotonic() + READY_S
    for take in takes:
        while not take.is_ready.wait(LOOK_S) and time.monotonic() < until_s:
            _refuse_stopped(stop)
        if not take.is_ready.is_set() or take.is_over:
            why = take.fault or f"no picture within {READY_S:.0f} s"
            raise ClipError(
                f"{named(take.source)} gives no picture: {why}; see that it is plugged in and that "
                "no other program holds it"
            )


def _watched(
    takes: Sequence[CameraTake], folder: Path, is_over: Callable[[], bool], stop: threading.Event
) -> str:
    """Why the recording ends, when it does; `is_over` says when by its time."""
    while True:
        if stop.wait(LOOK_S):
            return "asked to"
        if is_over():
            return "the time is over"
        if over := [take for take in takes if take.is_over]:
            return f"{over[0].name}: {over[0].fault or 'its file is full'}"
        if shutil.disk_usage(folder).free < SPARE_BYTES:
            return "the disk is full"


def _finished(takes: Sequence[CameraTake], folder: Path, lasted_s: float, why: str) -> Facts:
    """Write the times; the facts of the recording."""
    empty = [take for take in takes if len(take.times_s) < 2]
    if empty:
        raise ClipError(
            f"{named(empty[0].source)} gave {len(empty[0].times_s)} pictures: record longer"
        )
    finish_times(folder)
    later = {take.name: delay_s(takes[0].motion, take.motion) for take in takes[1:]}
    return {
        "folder": str(folder),
        "seconds": round(lasted_s, 3),
        "why": why,
        "cameras": {
            take.name: {
                "source": named(take.source),
                "frames": len(take.times_s),
                "fps": round(take.rate_hz, 3),
                "dropped": take.dropped,
                "fault": take.fault,
            }
            for take in takes
        },
        "later_s": {name: None if late is None else round(late, 3) for name, late in later.items()},
    }
