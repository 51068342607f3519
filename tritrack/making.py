"""Made-up people as clips."""

from pathlib import Path
from typing import Literal

from rich.console import Console
from rich.progress import Progress

from common.config import SettingsError, size_of
from synth.motions import POSTURES
from synth.write import write_set


def make_clips(
    out: Path,
    motion: Literal["postures", "free"],
    performers: int,
    takes: int,
    seed: int,
    size: str,
    postures: tuple[str, ...],
    console: Console,
) -> list[Path]:
    """Write clips with truth, showing how far it is; returns their folders.

    Raises:
        SettingsError: When the size or a posture's name is none.
        SynthError: When a clip cannot be written.
    """
    unknown = [name for name in postures if name not in POSTURES]
    if unknown:
        raise SettingsError(f"unknown posture {unknown[0]!r}; known are {', '.join(POSTURES)}")
    try:
        width_height = size_of(size)
    except ValueError as error:
        raise SettingsError(str(error)) from error
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("rendering", total=None)
        return write_set(
            out,
            motion,
            performers,
            takes,
            seed,
            width_height,
            postures or POSTURES,
            lambda done, due: progress.update(task, completed=done, total=due),
        )
