"""Whether a clip's views belong together, by their files and names: checked before a run."""

import filecmp
from itertools import combinations
from pathlib import Path
from typing import Final

from common.config.settings import Settings
from common.video.clip_sources import COMPANIONS, ClipError, Footage
from common.video.pictures import Source

ONE_ALONE: Final = (
    "to track by one camera alone add --views {seen}, or name its video in settings "
    "(camera_{seen}.source) instead of the clip"
)


def refuse_one_of_two(settings: Settings, named: list[Footage]) -> None:
    """See that a clip folder of which two views are asked has both.

    Args:
        settings: Of the run.
        named: What was found of the two views.

    Raises:
        ClipError: When the folder has a video of one camera alone; a file that may be the other
            is named.
    """
    if not settings.clip or len(named) != 1 or not isinstance(named[0].source, str):
        return
    seen, folder = named[0], Path(settings.clip)
    if seen.settings.source:
        return
    missing = 2 if seen.number == 1 else 1
    found = Path(str(seen.source))
    likely = _likely(folder, found, missing)
    cure = f"rename {likely} to cam{missing}{Path(likely).suffix}" if likely else "add it"
    raise ClipError(
        f"{folder} has {found.name} and no cam{missing}.*: {cure}; "
        + ONE_ALONE.format(seen=seen.number)
    )


def _likely(folder: Path, found: Path, missing: int) -> str:
    """The name of a file that may be the missing camera's video; "" where there is none."""
    names = [
        path.name
        for path in sorted(folder.iterdir())
        if path.is_file() and path != found and path.suffix.lower() not in COMPANIONS
    ]
    return next((name for name in names if str(missing) in Path(name).stem), "")


def refuse_same_source(named: list[Footage]) -> None:
    """See that two views are not of one video or camera: such a pair tells nothing of depth.

    Raises:
        ClipError: When they are.
    """
    for first, second in combinations(named, 2):
        if _is_same(first.source, second.source):
            what = "two videos" if isinstance(first.source, str) else "two cameras"
            raise ClipError(
                f"views {first.number} and {second.number} are the same: {first.source} and "
                f"{second.source}; name {what}, or add --views 1"
            )


def _is_same(first: Source, second: Source) -> bool:
    if isinstance(first, int) or isinstance(second, int):
        return first == second
    return filecmp.cmp(first, second, shallow=False)
