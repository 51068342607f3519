"""The files and cameras that a run's settings name, not opened yet."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from common.bus.messages import MOST_VIEWS, ViewerNumber
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.pictures import Source, is_recorded

COMPANIONS: Final = {".json", ".npz", ".txt", ".csv", ".toml", ".md", ".png", ".jpg", ".jpeg"}
"""Suffixes of files that may stand beside `cam1.*` and are no videos."""
CLIP_CAMERAS: Final = tuple(f"cam{n + 1}" for n in range(MOST_VIEWS))
"""Names of a clip folder's cameras, by their numbers."""
AVI_HEAD: Final = b"RIFF"
NOTHING: Final = "there is nothing to look at: set clip, or cameras.cam1 with source or device"
"""The message for settings without a clip or camera."""


class ClipError(ValueError):
    """An unusable clip: one line that names the file and the cure."""


class ViewSource(NamedTuple):
    """A view as the settings or the folder name it, not opened yet."""

    number: ViewerNumber
    source: Source
    settings: CameraSettings
    name: str
    """Name of the camera."""


def sources_of(settings: Settings) -> list[ViewSource]:
    """The cameras in the settings or their clip folder, by number.

    Raises:
        ClipError: When the clip folder does not exist, holds no video, two videos of one camera or
            too many cameras; when a camera has no video.
    """
    names = [*settings.cameras, *(name for name in CLIP_CAMERAS if name not in settings.cameras)]
    cameras = {name: settings.cameras.get(name, CameraSettings()) for name in names}
    sources = {name: _source_of(name, camera, settings.clip) for name, camera in cameras.items()}
    if settings.clip:
        _refuse_a_ninth(Path(settings.clip))
    named = {name: source for name, source in sources.items() if source is not None}
    if settings.clip and not named:
        raise ClipError(
            f"{settings.clip} has neither cam1.* nor cam2.*: name the videos so, or name them in "
            "the settings (cameras.cam1.source)"
        )
    numbers = numbers_of([*named])
    found = [ViewSource(numbers[name], named[name], cameras[name], name) for name in named]
    return sorted(found, key=lambda one: one.number)


def numbers_of(names: Sequence[str]) -> dict[str, ViewerNumber]:
    """Viewer numbers for cameras: cam1 to cam8 keep theirs, others get the lowest free ones.

    Raises:
        ClipError: When there are too many cameras.
    """
    if len(names) > MOST_VIEWS:
        raise ClipError(f"{len(names)} cameras ({', '.join(names)}): keep {MOST_VIEWS} at most")
    own = {name: n + 1 for n, name in enumerate(CLIP_CAMERAS) if name in names}
    free = (n + 1 for n, name in enumerate(CLIP_CAMERAS) if name not in own)
    return {name: own[name] if name in own else next(free) for name in names}


Offsets = Mapping[ViewerNumber, float]
"""The user's delays of cameras, by their numbers, seconds."""


def offsets_of(settings: Settings) -> Offsets:
    """The delays that the settings give: each camera's own, and `offset_s` that of camera 2."""
    numbers = numbers_of([*settings.cameras])
    own = {numbers[name]: camera.offset_s for name, camera in settings.cameras.items()}
    given = {number: late_s for number, late_s in own.items() if late_s is not None}
    return given if settings.offset_s is None else {2: settings.offset_s, **given}


def camera_words(settings: Settings) -> tuple[str, ...]:
    """What texts for the user call each camera, by its number: the settings' name, else "camera 1".

    A camera that is named by its number, as cam1, is called by it.
    """
    names = {number: name for name, number in numbers_of([*settings.cameras]).items()}
    own = ((n, names.get(n, at)) for n, at in enumerate(CLIP_CAMERAS, 1))
    return tuple(f"camera {n}" if name == f"cam{n}" else name for n, name in own)


def first_camera(settings: Settings) -> str:
    """Name of camera 1, which the settings need not mention."""
    numbers = numbers_of([*settings.cameras])
    return next((name for name, number in numbers.items() if number == 1), CLIP_CAMERAS[0])


def refuse_no_source(settings: Settings, path: Path) -> None:
    """Refuse settings without a clip or camera.

    Raises:
        ClipError: When they have none, or as `sources_of`.
    """
    if not sources_of(settings):
        raise ClipError(f"{path}: {NOTHING}")


def _source_of(name: str, camera: CameraSettings, clip: str) -> Source | None:
    """A camera's device or video, or the clip folder's video of its name."""
    if camera.device >= 0:
        return camera.device
    if camera.source:
        return camera.source
    if name not in CLIP_CAMERAS:
        raise ClipError(f"cameras.{name} has neither source nor device: set one of them")
    return _in_folder(Path(clip), name) if clip else None


def _in_folder(folder: Path, name: str) -> str | None:
    if folder.is_file():
        raise ClipError(f"{folder} is a file: name its folder, or set it as cameras.{name}.source")
    if not folder.is_dir():
        raise ClipError(f"there is no clip folder {folder}: check the path")
    videos = _videos(folder, name)
    if len(videos) > 1:
        raise ClipError(
            f"{folder} has {len(videos)} videos of {name} "
            f"({', '.join(path.name for path in videos)}): keep one, or set cameras.{name}.source"
        )
    return str(videos[0]) if videos else None


def _refuse_a_ninth(folder: Path) -> None:
    """The message for a camera whose video the settings would silently leave out."""
    for path in _videos(folder, f"cam{MOST_VIEWS + 1}"):
        raise ClipError(
            f"{folder} has {path.name}: a clip has {MOST_VIEWS} cameras at most, cam1.* to "
            f"cam{MOST_VIEWS}.*; remove it"
        )


def _videos(folder: Path, name: str) -> list[Path]:
    return [
        path
        for path in sorted(folder.glob(f"{name}.*"))
        if path.suffix.lower() not in COMPANIONS and path.is_file()
    ]


def companions_folder(settings: Settings, named: list[ViewSource]) -> Path:
    """The folder for files that belong to the videos."""
    if settings.clip:
        return Path(settings.clip)
    files = [Path(view.source) for view in named if is_recorded(view.source)]
    return files[0].parent if files else Path()


def refuse_unreadable(path: Path) -> None:
    """Refuse a file that does not exist, is empty, or cannot be read.

    Raises:
        ClipError: When it cannot be used.
    """
    if path.is_dir():
        raise ClipError(f"{path} is a folder: name a file in it")
    if not path.is_file():
        raise ClipError(f"there is no file {path}: check the path")
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except OSError as error:
        raise ClipError(
            f"cannot read {path}: {error.strerror}; see that you may read it (chmod u+r)"
        ) from error
    if empty:
        raise ClipError(f"{path} is empty: copy or record it again")


def refuse_a_lost_head(path: Path) -> None:
    """Refuse an AVI with a damaged header: OpenCV decodes it, but makes up rate and number of
    frames.

    Raises:
        ClipError: When it is one.
    """
    with path.open("rb") as file:
        if path.suffix.lower() == ".avi" and file.read(4) != AVI_HEAD:
            raise ClipError(f"{path} is no AVI from its first byte on: copy or record it again")
