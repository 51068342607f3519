"""Footage: the files and cameras that a run's settings name, not yet looked into."""

from pathlib import Path
from typing import Final, NamedTuple

from common.bus.messages import ViewerNumber
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.pictures import Source

COMPANIONS: Final = {".json", ".npz", ".txt", ".csv", ".toml", ".md", ".png", ".jpg", ".jpeg"}
"""Files that may stand beside `cam1.*` under the same name and are no video of it."""
NOTHING: Final = "there is nothing to look at: set clip, or camera_1 with source or device"
"""Said of settings that name no footage."""


class ClipError(ValueError):
    """A clip that cannot be used: one line that names the thing and the cure."""


class Footage(NamedTuple):
    """A view as the settings or the folder name it, not yet looked at."""

    number: ViewerNumber
    source: Source
    settings: CameraSettings


def footage_of(settings: Settings) -> list[Footage]:
    """One or two views, in their order.

    Raises:
        ClipError: When the clip folder is none, holds no video, or too many of one camera.
    """
    found = []
    own: dict[ViewerNumber, CameraSettings | None] = {1: settings.camera_1, 2: settings.camera_2}
    for number, given in own.items():
        camera = given or CameraSettings()
        source: Source | None = None
        if camera.device >= 0:
            source = camera.device
        elif camera.source:
            source = camera.source
        elif settings.clip:
            source = _in_folder(Path(settings.clip), number)
        if source is not None:
            found.append(Footage(number, source, camera))
    if settings.clip and not found:
        raise ClipError(
            f"{settings.clip} has neither cam1.* nor cam2.*: name the videos so, or name them in "
            "the settings (camera_1.source)"
        )
    return found


def refuse_no_footage(settings: Settings, path: Path) -> None:
    """See that the settings of a file name something to look at.

    Raises:
        ClipError: When they do not, or as `footage_of`.
    """
    if not footage_of(settings):
        raise ClipError(f"{path}: {NOTHING}")


def _in_folder(folder: Path, number: ViewerNumber) -> str | None:
    if folder.is_file():
        raise ClipError(f"{folder} is a file: name its folder, or set it as camera_{number}.source")
    if not folder.is_dir():
        raise ClipError(f"there is no clip folder {folder}: check the path")
    videos = [
        path
        for path in sorted(folder.glob(f"cam{number}.*"))
        if path.suffix.lower() not in COMPANIONS and path.is_file()
    ]
    if len(videos) > 1:
        raise ClipError(
            f"{folder} has {len(videos)} videos of camera {number} "
            f"({', '.join(path.name for path in videos)}): keep one, or set camera_{number}.source"
        )
    return str(videos[0]) if videos else None


def companions_folder(settings: Settings, named: list[Footage]) -> Path:
    """Where to look for what goes with the videos."""
    if settings.clip:
        return Path(settings.clip)
    files = [Path(view.source) for view in named if isinstance(view.source, str)]
    return files[0].parent if files else Path()
