"""The clips that the start page recorded: their list, the times of their frames, their end."""

import shutil
import time
from pathlib import Path
from typing import Final

from animator.start.sections import Recordings, ShownRecording
from common.config.settings import Settings
from common.video.camera_file import finish_times, kept_times
from common.video.clip_sources import CLIP_CAMERAS, ClipError
from common.video.clips import meta_of
from runtime.terminal import counted

RECORDED: Final = ".recorded"
"""Folder of the recordings, hidden so that `runs/*/` matches runs alone."""
MOST_SHOWN: Final = 50


def recording_names(runs: Path) -> list[str]:
    """Names of the whole recordings, newest first: `meta.json` is written last."""
    found = [
        (-path.stat().st_mtime, path.parent.name)
        for path in (runs / RECORDED).glob("*/meta.json")
        if not path.parent.is_symlink()
    ]
    return [name for _, name in sorted(found)]


def finish_recording(clip: Path) -> None:
    """Make a recording of what one that was killed left, where two cameras of it left enough.

    Raises:
        OSError: When it cannot be written.
    """
    if not (clip / "meta.json").is_file() and len(kept_times(clip)) > 1:
        finish_times(clip)


def recorded_videos(runs: Path, name: str) -> list[Path]:
    """The videos of a recording by the cameras' numbers; none where there is no such recording."""
    if name not in recording_names(runs):
        return []
    folder = runs / RECORDED / name
    return [path for camera in CLIP_CAMERAS for path in sorted(folder.glob(f"{camera}.avi"))]


def recorded_times(video: Path) -> tuple[float, ...]:
    """When each frame of a video was taken, seconds on the clock of all that lie beside it, by the
    `meta.json` there; () where that does not say it."""
    try:
        return meta_of(Settings(clip=str(video.parent))).capture_s.get(video.stem, ())
    except ClipError:
        return ()


def shown_recordings(runs: Path) -> Recordings:
    """In the form for browsers."""
    return Recordings([_shown(runs, name) for name in recording_names(runs)[:MOST_SHOWN]])


def remove_recording(runs: Path, name: str) -> bool:
    """Delete a recording; False where there is none."""
    if name not in recording_names(runs):
        return False
    shutil.rmtree(runs / RECORDED / name, ignore_errors=True)
    return True


def _shown(runs: Path, name: str) -> ShownRecording:
    videos = recorded_videos(runs, name)
    times = [times_s for video in videos if (times_s := recorded_times(video))]
    lasts_s = max((times_s[-1] - times_s[0] for times_s in times), default=0.0)
    made_s = (runs / RECORDED / name / "meta.json").stat().st_mtime
    when = time.strftime("%Y-%m-%d %H:%M", time.localtime(made_s))
    return ShownRecording(name, when, f"{counted(len(videos), 'camera')}, {lasts_s:.1f} s")
