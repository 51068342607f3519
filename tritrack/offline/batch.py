"""Clip after clip tracked in lock-step, a run folder for each."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console

from common import config
from common.bus.messages import Body, Message, Report, ScaleSource, ViewerNumber
from common.config import Settings, SettingsError
from common.method import Mode
from common.video.clip_facts import Clip, both_cameras
from common.video.clip_sources import ClipError
from common.video.decoding import DecoderDied, Undecodable
from integrator.frame_numbers import frame_times
from tritrack.offline.lockstep import Decoders, Tracked, Watch, measured_before, track_clip
from tritrack.overrides import overridden
from tritrack.store.clip_paths import ClipsFailed, run_names, without_plain_files
from tritrack.store.recording import Head, recording_to, refuse_without_library
from tritrack.store.runs import believed, write_run
from tritrack.terminal import bar, by_share, complain, warn


def track_all(
    paths: Sequence[Path],
    out: Path,
    mode: Mode | None,
    views: tuple[ViewerNumber, ...],
    size: str | None,
    console: Console,
    *,
    trusted: bool = False,
    record: bool = False,
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
        trusted: A calibration is trusted even where it seems wrong.
        record: Keep what the viewers report, so that it can be replayed.

    Raises:
        ClipsFailed: When there is nothing to track, when two runs would have one folder, and at
            the end when any clip could not be used.
        RunError: When a run folder cannot be written.
    """
    runs = run_names(without_plain_files(paths, console))
    if record:
        refuse_without_library()
    done: dict[str, Any] = {}
    with Decoders() as decoders, bar(console) as progress:
        for (name, path), tell in by_share(progress, [*runs.items()], "tracking"):
            try:
                settings = overridden(config.load(path), mode, size)
                if trusted:
                    settings = msgspec.structs.replace(settings, trust_calibration=True)
                heard: list[Message] = []
                watch = _recorder(heard) if record else None
                tracked = track_clip(settings, decoders, views, watch=watch, tell=tell)
            except (SettingsError, ClipError, DecoderDied, Undecodable) as error:
                complain(console, str(error))
                continue
            for warning in tracked.facts["warnings"]:
                warn(console, f"{name}: {warning}")
            done[name] = {**tracked.facts, "clip": name, "believed": believed(tracked.bodies)}
            write_run(out / name, tracked.bodies, settings, done[name])
            if record:
                _write_recording(out / name, tracked, settings, heard, console)
    if len(done) < len(runs):
        raise ClipsFailed(f"{len(runs) - len(done)} of {len(runs)} clips could not be tracked")
    return {"clips": done}


def head_of(
    clip: Clip,
    settings: Settings,
    scale_source: ScaleSource | None = None,
    *,
    by_person: bool = False,
) -> Head:
    """What a recording of a clip begins with.

    Args:
        clip: With the rig that is known before the first frame.
        settings: Of the run.
        scale_source: Where that rig is from; None: it is calibrated, if there is one.
        by_person: The person tells the rig while the run goes on.
    """
    return Head(
        name=clip.name,
        settings=settings,
        period_s=clip.every / clip.views[0].fps,
        alone=len(clip.views) == 1,
        rig=both_cameras(clip),
        body=clip.body,
        times=frame_times(clip),
        scale_source=scale_source,
        by_person=by_person,
    )


def _recorder(heard: list[Message]) -> Watch:
    """Gathers what is said of every instant, in the order in which it is said."""

    def watch(_frames: object, reports: dict[int, Report], body: Body) -> None:
        heard.extend([*reports.values(), body])

    return watch


def _write_recording(
    folder: Path, tracked: Tracked, settings: Settings, heard: list[Message], console: Console
) -> None:
    clip = tracked.clip
    if not heard:
        warn(
            console,
            f"{clip.name}: nothing was recorded: one camera without a calibration is followed in "
            "passes over the whole film; follow it again instead",
        )
        return
    measured = msgspec.structs.replace(clip, body=measured_before(settings))
    with recording_to(folder, head_of(measured, settings, tracked.facts["scale_source"])) as keep:
        for message in heard:
            keep(message)
