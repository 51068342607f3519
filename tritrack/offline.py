"""The same steps as live, in one process and in lock-step: deterministic, as fast as it goes."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import msgspec
from rich.console import Console

from common import config
from common.body import Bdp
from common.camera import Rig
from common.clips import Clip, open_clip, shortfall
from common.config import Mode, Settings, SettingsError
from common.decoding import Decoder, DecoderDied, Undecodable
from common.footage import ClipError
from common.messages import Body, Guide, Report, ViewerNumber
from common.notes import Notes
from integrator import merge, noticing
from integrator.pairing import Pair
from tritrack.one_camera import extras_of, follow_clip
from tritrack.opening_clip import body_of
from tritrack.runs import write_run
from tritrack.terminal import bar, complain, warn
from viewer import track
from viewer.background import Background
from viewer.capture import Frame, recorded
from viewer.empty import empty_room


class ClipsFailed(RuntimeError):
    """Some clips could not be tracked; what was wrong with each was said before."""


class Tracked(NamedTuple):
    """What tracking a clip gave."""

    clip: Clip
    bodies: list[Body]
    facts: dict[str, Any]
    """For the summary: seconds of each stage, scale_source, warnings."""
    extras: Mapping[str, Any] = MappingProxyType({})
    """Arrays that one view alone adds to `poses.npz`."""


Watch = Callable[[dict[ViewerNumber, Frame], dict[int, Report], Body], object]
"""Looks at the frames of an instant, the reports on them and the body they gave."""


class Decoders:
    """One decoder a view, kept over many clips: a child's start costs more than a clip."""

    def __init__(self) -> None:
        """None started yet."""
        self._doors = ExitStack()
        self.of = {number: self._doors.enter_context(Decoder()) for number in (1, 2)}

    def __enter__(self) -> "Decoders":
        """Nothing to do before the first clip."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the children."""
        self._doors.close()


def track_clip(
    settings: Settings,
    decoders: Decoders,
    views: tuple[ViewerNumber, ...] = (1, 2),
    watch: Watch | None = None,
) -> Tracked:
    """Track one clip from its videos to its bodies; `watch` is shown every instant.

    Raises:
        ClipError: When the clip cannot be used.
        DecoderDied: When a video broke the decoder.
    """
    began = time.perf_counter()
    clip = open_clip(settings, decoders.of[1], views)
    if len(clip.views) == 1 and settings.mode != "paper":
        decoder = decoders.of[clip.views[0].number]
        followed = follow_clip(clip, settings, decoder, Notes())
        return Tracked(clip, followed.bodies, followed.facts, extras_of(followed.settled))
    if settings.mode == "thesis":
        raise ClipError(f"{clip.name}: the thesis's mode is for one camera: add --views 1")
    rig = both_cameras(clip)
    known = body_of(settings, lambda own: track_clip(own, decoders).bodies)
    viewers, odd_rooms = _viewers(clip, rig, settings, decoders)
    prepared = time.perf_counter()
    state = merge.init(rig, clip.every / clip.views[0].fps, settings, known)
    noticed = noticing.State()
    guide: Guide | None = None
    bodies: list[Body] = []
    spent = {"viewers": 0.0, "integrator": 0.0}
    for frames in _instants(clip, decoders):
        start = time.perf_counter()
        reports: dict[int, Report] = {}
        for number, frame in frames.items():
            viewers[number], reports[number] = track.step(viewers[number], frame, guide)
        middle = time.perf_counter()
        pair = Pair(reports.get(1), reports.get(2))
        state, body, guide = merge.step(state, pair)
        noticed = noticing.step(noticed, pair)
        bodies.append(body)
        if watch is not None:
            watch(frames, reports, body)
        spent["viewers"] += middle - start
        spent["integrator"] += time.perf_counter() - middle
    cut_off = [shortfall(view, decoders.of[view.number].came) for view in clip.views]
    noticed_odd = noticing.warnings(noticed, state)
    done = time.perf_counter()
    seconds = {"preparation": prepared - began, **spent, "all": done - began}
    facts = {
        "clip": clip.name,
        "performer": clip.meta.performer,
        "posture_meant": clip.meta.posture,
        **({"acts": msgspec.to_builtins(clip.meta.acts)} if clip.meta.acts else {}),
        "seconds": {name: round(value, 4) for name, value in seconds.items()},
        "frames_a_second": round(len(bodies) / (done - prepared), 1),
        "scale_source": state.scale_source,
        "warnings": [*clip.warnings, *odd_rooms, *filter(None, cut_off), *noticed_odd],
    }
    return Tracked(clip, bodies, facts)


def measured_before(settings: Settings) -> Bdp | None:
    """The person's body as the opening clip that the settings name tells it, if they name one.

    Raises:
        SettingsError, ClipError, DecoderDied: As `body_of` and `track_clip` do.
    """
    with Decoders() as decoders:
        return body_of(settings, lambda own: track_clip(own, decoders).bodies)


def overridden(settings: Settings, mode: Mode | None, size: str | None) -> Settings:
    """The settings with what a command line names instead; None leaves what they say.

    Raises:
        SettingsError: When the size is none.
    """
    try:
        return msgspec.structs.replace(
            settings, mode=mode or settings.mode, size=size or settings.size
        )
    except ValueError as error:
        raise SettingsError(str(error)) from error


def _viewers(
    clip: Clip, rig: Rig | None, settings: Settings, decoders: Decoders
) -> tuple[dict[ViewerNumber, track.State], list[str]]:
    """Viewers that know their rooms, and what is odd about these."""
    viewers: dict[ViewerNumber, track.State] = {}
    odd_rooms = []
    for view, (room, odd) in zip(clip.views, _rooms(clip, settings, decoders), strict=True):
        odd_rooms += [odd] if odd else []
        camera = None if rig is None else rig.cameras[view.number - 1]
        viewers[view.number] = track.init(view.number, room, camera, settings)
    return viewers, odd_rooms


def _rooms(clip: Clip, settings: Settings, decoders: Decoders) -> list[tuple[Background, str]]:
    """The empty room of every view, learnt side by side: mostly it is waiting for the decoders."""
    with ThreadPoolExecutor(len(clip.views)) as pool:
        return list(
            pool.map(
                lambda view: empty_room(view, settings.silhouette, decoders.of[view.number]),
                clip.views,
            )
        )


def both_cameras(clip: Clip) -> Rig | None:
    """The clip's rig with a camera for each viewer; a viewer that is not there gets the other's."""
    if clip.rig is None:
        return None
    own = {view.number: camera for view, camera in zip(clip.views, clip.rig.cameras, strict=True)}
    any_camera = clip.rig.cameras[0]
    cameras = (own.get(1, any_camera), own.get(2, any_camera))
    return msgspec.structs.replace(clip.rig, cameras=cameras)


def _instants(clip: Clip, decoders: Decoders) -> Iterator[dict[ViewerNumber, Frame]]:
    """The frames of all views, those of one instant together, in the order of time."""
    streams = {
        view.number: recorded(view, clip.every, decoders.of[view.number]) for view in clip.views
    }
    waiting = {number: next(stream, None) for number, stream in streams.items()}
    tolerance_s = 0.5 * clip.every / clip.views[0].fps
    while any(waiting.values()):
        first_s = min(frame.captured_s for frame in waiting.values() if frame is not None)
        now: dict[ViewerNumber, Frame] = {}
        for number, frame in waiting.items():
            if frame is not None and frame.captured_s - first_s <= tolerance_s:
                now[number] = frame
                waiting[number] = next(streams[number], None)
        yield now


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
        for name, path in progress.track(runs.items(), description="tracking"):
            try:
                settings = overridden(config.load(path), mode, size)
                tracked = track_clip(settings, decoders, views)
            except (SettingsError, ClipError, DecoderDied, Undecodable) as error:
                complain(console, str(error))
                continue
            for warning in tracked.facts["warnings"]:
                warn(console, warning)
            done[name] = {**tracked.facts, "clip": name}
            write_run(out / name, tracked.bodies, settings, done[name], tracked.extras)
    if len(done) < len(runs):
        raise ClipsFailed(f"{len(runs) - len(done)} of {len(runs)} clips could not be tracked")
    return {"clips": done}


def run_names(paths: Sequence[Path]) -> dict[str, Path]:
    """What to track, by the name of its run folder: the clip folder's, or the settings file's.

    Raises:
        ClipsFailed: When two would have one name.
    """
    runs: dict[str, Path] = {}
    for path in paths:
        name = path.stem if path.is_file() else path.resolve().name
        if name in runs:
            raise ClipsFailed(
                f"{runs[name]} and {path} would both be written to {name}: "
                "track one, then the other with another --out"
            )
        runs[name] = path
    return runs


def without_plain_files(paths: Sequence[Path], console: Console) -> list[Path]:
    """The paths without what a pattern like clips/* catches too, such as calibration.json.

    Raises:
        ClipsFailed: When nothing is left.
    """
    kept = []
    for path in paths:
        if path.is_file() and path.suffix != ".toml":
            warn(console, f"{path} is neither a clip folder nor a settings file: left out")
        else:
            kept.append(path)
    if not kept:
        raise ClipsFailed("no clip is left: name a folder with cam1.*, cam2.* or a settings file")
    return kept
