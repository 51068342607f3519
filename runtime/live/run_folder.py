"""The folder of a new live run: log, journal, pictures, and what an interrupted run left."""

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import msgspec

from calibration.paper.calibration import write_rig
from common.bus.messages import place_in_rig
from common.config.config_file import with_absolute_paths
from common.config.settings import Settings
from common.folder_owner import OWNER, other_owner, take
from common.npz_file import Facts
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError, fitted
from common.video.camera_file import SUFFIX, finish_times, kept_times, missing_of, rate_of
from common.video.clip_facts import Clip, whole_rig
from common.video.clip_sources import CLIP_CAMERAS
from common.video.pictures import is_recorded
from runtime.live.admission import LiveRefused
from runtime.live.page_desk import SAVED
from runtime.live.run_facts import facts_of_clip
from runtime.store.journal import Head as JournalHead
from runtime.store.journal import Journal, has_journal
from runtime.store.past_journal import LOG, put_aside
from runtime.store.recording import torn_recordings

PICTURES: Final = "pictures"
"""Name of the folder with what the cameras showed, a clip, where a run keeps that."""
KEPT: Final = ".kept-"
"""Prefix of the folder in which processes leave their state for a restart."""


@contextmanager
def owned(out: Path) -> Iterator[None]:
    """A run folder for this process alone: two runs would take each other's files for those of
    one that was cut short.

    Raises:
        LiveRefused: When another run writes into it, or it cannot be written.
    """
    file = out / f".{OWNER}"
    if (other := other_owner(file)) is not None:
        raise LiveRefused(
            f"another live run (process {other}) writes into {out}: end it, or name another --out"
        )
    try:
        out.mkdir(parents=True, exist_ok=True)
        take(file)
    except OSError as error:
        raise LiveRefused(f"cannot write {out}: {error.strerror}; name another --out") from error
    try:
        yield
    finally:
        file.unlink(missing_ok=True)


def new_log(out: Path) -> Path:
    """The log of this run alone: an earlier run's log is overwritten, unless that run was
    interrupted and will be moved aside.

    Raises:
        LiveRefused: When the folder cannot be written.
    """
    path = out / LOG
    try:
        out.mkdir(parents=True, exist_ok=True)
        path.open("a" if has_journal(out) else "w").close()
        for left in out.glob(f"{KEPT}*"):  # of an interrupted run
            shutil.rmtree(left, ignore_errors=True)
    except OSError as error:
        raise LiveRefused(f"cannot write {out}: {error.strerror}; name another --out") from error
    return path


def new_journal(out: Path, clip: Clip, settings: Settings, notes: list[str]) -> Journal:
    """A writer of bodies as they come; the journal of an interrupted run is moved aside.

    Args:
        out: The run's folder.
        clip: The run's clip.
        settings: The run's settings.
        notes: Receives a note about what was moved.

    Raises:
        LiveRefused: When it cannot be moved aside.
    """
    aside = out / SAVED / f"cut_short_{time.strftime('%Y%m%d_%H%M%S')}"
    try:
        if put_aside(out, aside):
            for torn in torn_recordings(out):
                torn.replace(aside / torn.name)
            notes.append(f"the run before this one was cut short: what it measured is in {aside}")
    except OSError as error:
        raise LiveRefused(
            f"{out} holds a run that was cut short, which cannot be put aside "
            f"({error.strerror}): name another --out"
        ) from error
    return Journal(
        out, JournalHead(settings=with_absolute_paths(settings), facts=facts_of_clip(clip))
    )


def refuse_kept_pictures(out: Path) -> None:
    """Refuse a run folder that holds pictures of another run: they would be lost.

    Raises:
        LiveRefused: When there are some.
    """
    if (out / PICTURES).exists():
        raise LiveRefused(
            f"{out / PICTURES} holds what cameras showed in another run: name another --out, or "
            "say --force"
        )


def new_pictures(out: Path, clip: Clip, wanted: bool) -> Path | None:
    """An empty folder for pictures, with the clip's calibration; None where none are wanted.

    Those of a run before are removed, unless this run plays them.

    Raises:
        LiveRefused: When it cannot be written, or this run plays what is in it.
    """
    folder = out / PICTURES
    played = (Path(view.source) for view in clip.views if is_recorded(view.source))
    if any(folder.resolve() in path.resolve().parents for path in played):
        raise LiveRefused(f"this run plays {folder}, which it would replace: name another --out")
    try:
        if folder.is_dir():
            shutil.rmtree(folder)
        if not wanted:
            return None
        folder.mkdir()
        rig = _recorded_rig(clip)
        if rig is not None:
            write_rig(folder / "calibration.json", rig)
    except (OSError, CalibrationError) as error:
        raise LiveRefused(f"cannot write {folder} ({error}): name another --out") from error
    return folder


def finish_pictures(folder: Path | None, notes: list[str]) -> Facts:
    """Make a clip of what viewers left in a folder: `meta.json` with the time of each picture.

    Args:
        folder: None: no picture was kept.
        notes: Receives what is missing, and what a viewer showed that was started again.

    Returns:
        For the summary: by file its frames, rate and number of missing ones.
    """
    if folder is None:
        return {}
    kept = kept_times(folder)
    if not kept:
        notes.append(f"no picture was kept in {folder}")
        return {}
    try:
        finish_times(folder)
    except OSError as error:
        notes.append(f"the times of the pictures in {folder} could not be written: {error}")
    for name, times_s in kept.items():
        camera, _, part = name.partition("_")
        if part:
            notes.append(
                f"the viewer of {camera} was started again: what it showed from then on is in "
                f"{folder / name}{SUFFIX}, its times in meta.json"
            )
        if missing := missing_of(times_s):
            notes.append(f"{missing} of {len(times_s) + missing} pictures of {name} are missing")
    return {
        "pictures": {
            name: {
                "frames": len(times_s),
                "fps": round(rate_of(times_s, 1.0), 3),
                "missing": missing_of(times_s),
            }
            for name, times_s in kept.items()
        }
    }


def _recorded_rig(clip: Clip) -> Rig | None:
    """The calibration of upright pictures, by the names of a clip folder's cameras; None without
    one, and where pictures differ in shape, which one calibration cannot say."""
    whole = whole_rig(clip)
    if whole is None:
        return None
    size, cameras = clip.views[0].size, []
    for view in clip.views:
        own = msgspec.structs.replace(whole, width=view.size[0], height=view.size[1])
        try:
            camera = fitted(own, size, view.name).cameras[place_in_rig(view.number)]
        except CalibrationError:
            return None
        cameras.append(msgspec.structs.replace(camera, name=CLIP_CAMERAS[view.number - 1]))
    width, height = size
    return msgspec.structs.replace(whole, width=width, height=height, cameras=tuple(cameras))
