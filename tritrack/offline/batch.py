"""Clip after clip tracked in lock-step, a run folder for each."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from common import config
from common.bus.messages import ViewerNumber
from common.config import SettingsError
from common.method import Mode
from common.video.clip_sources import ClipError
from common.video.decoding import DecoderDied, Undecodable
from tritrack.offline.lockstep import Decoders, track_clip
from tritrack.overrides import overridden
from tritrack.store.clip_paths import ClipsFailed, run_names, without_plain_files
from tritrack.store.runs import write_run
from tritrack.terminal import bar, by_share, complain, warn


def track_all(
    paths: Sequence[Path],
    out: Path,
    mode: Mode | None,
    views: tuple[ViewerNumber, ...],
    size: str | None,
    console: Console,
) -> dict[str, Any]:
    """Track clip after clip and write a run folder for each.

    A clip that cannot be used is said and left out; the others are tracked.

    Args:
        paths: Clip folders and settings files; other plain files are said and left out.
        out: Gets a folder for each, named after the clip or the settings file.
        mode: Instead of what the settings say; None leaves them.
        views: The cameras to use.
        size: As `mode`.
        console: For progress, warnings and errors.

    Raises:
        ClipsFailed: When there is nothing to track, when two runs would have one folder, and at
            the end when any clip could not be used.
        RunError: When a run folder cannot be written.
    """
    runs = run_names(without_plain_files(paths, console))
    done: dict[str, Any] = {}
    with Decoders() as decoders, bar(console) as progress:
        for (name, path), tell in by_share(progress, [*runs.items()], "tracking"):
            try:
                settings = overridden(config.load(path), mode, size)
                tracked = track_clip(settings, decoders, views, tell=tell)
            except (SettingsError, ClipError, DecoderDied, Undecodable) as error:
                complain(console, str(error))
                continue
            for warning in tracked.facts["warnings"]:
                warn(console, f"{name}: {warning}")
            done[name] = {**tracked.facts, "clip": name}
            write_run(out / name, tracked.bodies, settings, done[name])
    if len(done) < len(runs):
        raise ClipsFailed(f"{len(runs) - len(done)} of {len(runs)} clips could not be tracked")
    return {"clips": done}
