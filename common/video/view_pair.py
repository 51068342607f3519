"""Whether a clip's cameras belong together, by their files and names: checked before a run."""

import filecmp
from collections.abc import Collection, Sequence
from itertools import combinations
from pathlib import Path
from typing import Final

from common.bus.messages import ViewerNumber
from common.config.settings import Settings
from common.video.clip_sources import COMPANIONS, ClipError, ViewSource
from common.video.pictures import Source, is_recorded

WITHOUT: Final = (
    "to track {without} add --views {views}, or name {videos} in settings (cameras.{name}.source) "
    "instead of the clip"
)


def refuse_missing(
    settings: Settings, found: Sequence[ViewSource], asked: Collection[ViewerNumber] | None
) -> None:
    """Refuse a clip without all the cameras asked for.

    Args:
        settings: The run's settings.
        found: The cameras in the settings and the clip.
        asked: The cameras to use; None: all. A clip has two at least, and only its last ones may be
            left out.

    Raises:
        ClipError: When one does not exist; the message names a file that may be its video.
    """
    there = [each.number for each in found]
    of_a_folder = any(_is_of_the_folder(each, settings) for each in found)
    all_of_it = range(1, max([2, *there]) + 1) if of_a_folder else there
    missing = [n for n in (all_of_it if asked is None else asked) if n not in there]
    if missing and settings.clip:
        raise ClipError(f"{settings.clip} {_without(settings, found, missing[0])}")
    if missing:
        names = ", ".join(f"{each.number} ({each.name})" for each in found)
        raise ClipError(f"there is no camera {missing[0]}: the settings name {names or 'none'}")


def _is_of_the_folder(one: ViewSource, settings: Settings) -> bool:
    return bool(settings.clip) and is_recorded(one.source) and not one.settings.source


def _without(settings: Settings, found: Sequence[ViewSource], missing: ViewerNumber) -> str:
    """What a folder lacks, and the cures."""
    videos = [Path(each.source).name for each in found if is_recorded(each.source)]
    likely = _likely(Path(settings.clip), videos, missing)
    cure = f"rename {likely} to cam{missing}{Path(likely).suffix}" if likely else "add it"
    without = WITHOUT.format(
        without="by one camera alone" if len(found) == 1 else "without it",
        views=",".join(str(each.number) for each in found),
        videos="its video" if len(found) == 1 else "the videos",
        name=found[0].name,
    )
    return f"has {', '.join(videos) or 'cameras'} and no cam{missing}.*: {cure}; {without}"


def _likely(folder: Path, found: Collection[str], missing: ViewerNumber) -> str:
    """Name of a file that may be the missing camera's video; "" where there is none."""
    names = [
        path.name
        for path in sorted(folder.iterdir())
        if path.is_file() and path.name not in found and path.suffix.lower() not in COMPANIONS
    ]
    return next((name for name in names if str(missing) in Path(name).stem), "")


def refuse_same_source(named: list[ViewSource]) -> None:
    """Refuse two views of one video or camera: such a pair contains no depth.

    Raises:
        ClipError: When two are the same.
    """
    for one, other in combinations(named, 2):
        if _is_same(one.source, other.source):
            what = "two videos" if is_recorded(one.source) else "two cameras"
            raise ClipError(
                f"views {one.number} and {other.number} are the same: {one.source} and "
                f"{other.source}; name {what}, or add --views 1"
            )


def _is_same(one: Source, other: Source) -> bool:
    if is_recorded(one) and is_recorded(other):
        return filecmp.cmp(one, other, shallow=False)
    return one == other
