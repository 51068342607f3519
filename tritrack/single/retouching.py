"""Retouching of a run: its video, its poses and its notes on a page, until Ctrl-C."""

import shlex
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from animator.retouching.fitting import FitError
from animator.take import Take, take_of
from common.bus.process import ProcessContext, process
from common.config.explained import explained
from common.config.part_settings import CameraSettings, SettingsError
from common.config.picture_size import size_within
from common.config.renamed_settings import settings_of
from common.config.settings import Settings
from common.notes.notes import Notes
from common.notes.notes_file import NotesError, load_notes, notes_path, save_notes
from common.npz_file import Facts
from common.rig.camera import PAPER_ROTATIONS, Camera, Matrix
from common.video.clip_facts import Clip
from common.video.clip_sources import ClipError, first_camera
from common.video.clips import open_clip
from common.video.decoding import Decoder
from runtime.store.other_run import run_told
from runtime.store.past_run import PastRun, open_run
from runtime.terminal import bar, say
from tritrack.single.ledger import facts_of, ledger
from tritrack.single.mask_file import is_mask_file
from tritrack.single.refitting import refit

if TYPE_CHECKING:
    from animator.retouching.retouch import RetouchPage

MOST_PICTURES: Final = 20_000
"""Largest number of pictures in memory, some 40 kB each."""
SHOWN: Final = (640, 480)
"""Largest size of a picture on the page, pixels."""
JPEG_QUALITY: Final = 88


class RetouchError(RuntimeError):
    """A run that cannot be retouched: the text names the cause and the cure."""


class Opened(NamedTuple):
    """A run to retouch, with its inputs."""

    run: PastRun
    settings: Settings
    """The run's own, with the video's present path."""
    clip: Clip
    """The run's video, as camera 1."""
    source: Path
    notes_path: Path


def retouch(
    folder: Path, video: Path | None, notes_file: Path | None, port: int, console: Console
) -> Facts:
    """Show a run on a page that edits the notes of its video, until Ctrl-C.

    Args:
        folder: The run's folder.
        video: Present path of the run's video; None: the one in its summary.
        notes_file: Replaces the notes beside the video.
        port: The page's port.
        console: Shows the page's address.

    Returns:
        The notes' file and the effort ledger at the end.

    Raises:
        PastRunError, RetouchError, ClipError, DecoderDied, NotesError, PageError: When an input is
            unusable.
    """
    make_page = _page_or_refuse()
    opened = _opened(folder, video, notes_file)
    run, clip, source, path = opened.run, opened.clip, opened.source, opened.notes_path
    notes = load_notes(path) if path.exists() else Notes(source.name)
    take = _take_of(run, clip)
    pictures = _pictures(clip, take, console)

    def picture_of(row: int) -> NDArray[np.uint8]:
        return _decoded(pictures[row])

    def keep(new: Notes) -> tuple[str, bool]:
        return _kept(path, page.take, new)

    with process("retouch", ProcessContext()) as stop:

        def fit(notes: Notes, report: Callable[[str], object]) -> Take:
            return _fitted(opened, notes, report, stop)

        page = make_page(take, clip.views[0].source_size, picture_of, notes, keep, fit, port)
        console.print(f"the page is at {page.address}; Ctrl-C ends it", highlight=False)
        try:
            stop.wait()
        finally:
            page.close()
    if page.notes != page.fitted:
        say(console, how_to_go_on(source, run))
    return {"notes": str(path), **facts_of(ledger(page.take, page.notes))}


def _page_or_refuse() -> type["RetouchPage"]:
    """The page's class, whose library is an extra."""
    try:
        from animator.retouching.retouch import RetouchPage
    except ModuleNotFoundError as error:
        raise RetouchError(
            f"there is no page without {error.name}: pip install 'tritrack[page]'"
        ) from error
    return RetouchPage


def _opened(folder: Path, video: Path | None, notes_file: Path | None) -> Opened:
    run = open_run(folder)
    settings = _settings_of(run, video)
    clip = _clip_of(run, settings)
    source = Path(str(clip.views[0].source))
    return Opened(run, settings, clip, source, notes_file or notes_path(source))


def _kept(path: Path, take: Take, notes: Notes) -> tuple[str, bool]:
    """Write notes; returns the page's message, and whether they were written."""
    try:
        save_notes(path, notes)
    except NotesError as error:
        return str(error), False
    count = ledger(take, notes).given.total
    return f"{count} input{'' if count == 1 else 's'}, kept in {path.name}", True


def _fitted(
    opened: Opened, notes: Notes, report: Callable[[str], object], stop: threading.Event
) -> Take:
    """The run fitted again with notes, in the page's form."""
    run = opened.run
    if not fitted_by_single(run):
        raise FitError(how_to_go_on(opened.source, run))
    refit(run.folder, opened.settings, notes, report, stop)
    return _take_of(open_run(run.folder), opened.clip)


def fitted_by_single(run: PastRun) -> bool:
    """Whether notes can be fitted into a run: `tritrack single` wrote it from a video."""
    told = run_told(run.folder)
    if told is None or told.command != "single":
        return False
    return not any(is_mask_file(Path(film)) for film in told.footage)


def how_to_go_on(video: Path, run: PastRun) -> str:
    """The cure for notes, which belong to one camera's picture."""
    command = f"tritrack single {shlex.quote(str(video))}"
    if np.any(np.count_nonzero(run.poses["seen"], axis=1) > 1):
        return f"the run has other cameras too, the notes are of camera 1: to fit that, {command}"
    return f"then fit the video again with these notes: {command}"


def _settings_of(run: PastRun, video: Path | None) -> Settings:
    """The run's own; its video at the present path."""
    try:
        settings = settings_of(run.summary.get("settings", {}))
    except (msgspec.ValidationError, SettingsError) as error:
        why = error if isinstance(error, SettingsError) else explained(error, Settings)
        raise RetouchError(f"{run.folder}/summary.json: {why}; track the clip again") from error
    if video is None:
        return settings
    name = first_camera(settings)
    before = settings.cameras.get(name, CameraSettings())
    camera = msgspec.structs.replace(before, source=str(video), device=-1)
    return msgspec.structs.replace(settings, clip="", cameras={name: camera})


def _clip_of(run: PastRun, settings: Settings) -> Clip:
    """The run's video, as camera 1."""
    try:
        clip = open_clip(settings, None, (1,))
    except ClipError as error:
        raise RetouchError(f"{error}; name the run's video with --video") from error
    if not isinstance(clip.views[0].source, str):
        raise RetouchError(f"{run.folder} is of a camera: name a video of it with --video")
    return clip


def _take_of(run: PastRun, clip: Clip) -> Take:
    """The run in the video's own pixels, as seen from camera 1."""
    view = clip.views[0]
    take = take_of(run.poses, view.source_size[0] / view.filed_size[0], _turn_of(run, clip))
    if not len(take.frame):
        raise RetouchError(f"{run.folder} has no frame: track the clip again")
    return take


def _turn_of(run: PastRun, clip: Clip) -> Matrix:
    """World to camera 1: the calibrated one, or the one that the run assumed, level before
    2026-11-26."""
    if clip.rig is not None:
        return clip.rig.cameras[0].R
    assumed = run.summary.get("camera")
    try:
        return msgspec.convert(assumed, Camera).R if assumed else PAPER_ROTATIONS[0]
    except msgspec.ValidationError as error:
        raise RetouchError(
            f"the summary of {run.folder} has no camera as it was written ({error}): "
            "track the clip again"
        ) from error


def _pictures(clip: Clip, take: Take, console: Console) -> Sequence[bytes]:
    """The picture of every row of the run as a JPEG; a missing one is replaced by the one
    before."""
    if len(take.frame) > MOST_PICTURES:
        raise RetouchError(
            f"{len(take.frame)} frames are too many for the page: track parts of the video, of at "
            f"most {MOST_PICTURES} frames each"
        )
    view = clip.views[0]
    size = size_within(view.source_size, SHOWN)
    wanted = {int(frame) for frame in take.frame}
    found: dict[int, bytes] = {}
    with Decoder() as decoder, bar(console) as progress:
        frames = decoder.frames(view.source, size)
        for decoded in progress.track(frames, total=view.frames or None, description="reading"):
            if decoded.index in wanted:
                found[decoded.index] = _jpeg(decoded.picture)
    blank = _jpeg(np.zeros((size[1], size[0], 3), np.uint8))
    kept: list[bytes] = []
    for frame in take.frame:
        kept.append(found.get(int(frame), kept[-1] if kept else blank))
    return kept


def _jpeg(picture: NDArray[np.uint8]) -> bytes:
    _, encoded = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return encoded.tobytes()


def _decoded(jpeg: bytes) -> NDArray[np.uint8]:
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR_RGB)
    return np.asarray(picture, np.uint8)
