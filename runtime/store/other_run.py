"""Whether a run folder holds a run of another source, which must not be overwritten."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from common.npz_file import Facts
from runtime.store.runs import RunError

RUN_OF: Final = "run_of"
"""The summary's key for a run's command and source."""
OF_CAMERAS: Final = "processes"
"""A key that only a live run's summary has."""


class OtherRun(RunError):
    """A folder with a run of another source: the text names that and the cure."""


class RunOf(NamedTuple):
    """The source of a run: its command and inputs, not its settings, which may change."""

    command: str
    """`track`, `single`, `live` or `replay`."""
    footage: tuple[str, ...]
    """Its videos, or the replayed run, as absolute paths; cameras by number."""

    @property
    def facts(self) -> Facts:
        """In the summary's form."""
        return {RUN_OF: {"command": self.command, "footage": [*self.footage]}}

    @property
    def told(self) -> str:
        """In words."""
        films = ", ".join(self.footage)
        return f"tritrack {self.command}{f' of {films}' if films else ''}"


def run_of(command: str, sources: Sequence[str | int]) -> RunOf:
    """The source of a command's run over files, or cameras by number."""
    return RunOf(
        command, tuple(str(Path(one).resolve() if isinstance(one, str) else one) for one in sources)
    )


def refuse_other(folder: Path, now: RunOf) -> None:
    """Refuse to overwrite a run, unless it is of the same source.

    Runs of older versions, which do not record their source, may be overwritten.

    Raises:
        OtherRun: When it may not be overwritten.
    """
    other = other_than(folder, now)
    if other is not None:
        raise OtherRun(
            f"{folder} holds another run ({other.told}): "
            "choose another --out, or write over it with --force"
        )


def other_than(folder: Path, now: RunOf) -> RunOf | None:
    """The run in a folder, where it is known to be of another source."""
    before = run_told(folder)
    return None if before in (None, now, RunOf(now.command, ())) else before


def run_told(folder: Path) -> RunOf | None:
    """The source of the run in a folder; None where there is none, or none is recorded."""
    try:
        summary = json.loads((folder / "summary.json").read_text())
    except (OSError, ValueError):
        return None
    if not isinstance(summary, Mapping):
        return None
    told = summary.get(RUN_OF)
    if isinstance(told, Mapping) and isinstance(told.get("footage"), list):
        return RunOf(str(told.get("command")), tuple(map(str, told["footage"])))
    return RunOf("live", ()) if OF_CAMERAS in summary else None
