"""The clips on a command line, and the run folder of each."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from common.video.clip_sources import COMPANIONS
from runtime.terminal import warn


class ClipsFailed(RuntimeError):
    """Some clips could not be tracked; each error was reported before."""


def run_names(paths: Sequence[Path]) -> dict[str, Path]:
    """Paths to track, by the name of the run folder: the clip folder's, or the settings file's.

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
    """The paths without other files that a pattern like clips/* matches, such as calibration.json.

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
        videos = [path for path in paths if path.suffix.lower() not in COMPANIONS]
        of_one = f"; of one video: tritrack single {videos[0]}" if videos else ""
        raise ClipsFailed(
            f"no clip is left: name a folder with cam1.*, cam2.* or a settings file{of_one}"
        )
    return kept
