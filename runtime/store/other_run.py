"""Whether a run folder holds a run of something else, which nobody means to write over."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from common.npz_file import Facts
from runtime.store.runs import RunError

RUN_OF: Final = "run_of"
"""What a summary calls the command and the footage of its run."""
OF_CAMERAS: Final = "processes"
"""What the summary of a live run alone tells."""


class OtherRun(RunError):
    """A folder that holds the run of something else: the text says of what, and the cure."""


class RunOf(NamedTuple):
    """Of what a run is: not how it was made, for the same is done again with other settings."""

    command: str
    """`track`, `single`, `live` or `replay`."""
    footage: tuple[str, ...]
    """Its films, or the run that is replayed, whole paths; cameras by their numbers."""

    @property
    def facts(self) -> Facts:
        """For its summary."""
        return {RUN_OF: {"command": self.command, "footage": [*self.footage]}}

    @property
    def told(self) -> str:
        """In words."""
        films = ", ".join(self.footage)
        return f"tritrack {self.command}{f' of {films}' if films else ''}"


def run_of(command: str, sources: Sequence[str | int]) -> RunOf:
    """The run of a command over files, or cameras by their numbers."""
    return RunOf(
        command, tuple(str(Path(one).resolve() if isinstance(one, str) else one) for one in sources)
    )


def refuse_other(folder: Path, now: RunOf) -> None:
    """See that a run which is there may be written over: nobody's, or one of the same.

    Runs that do not tell of what they are, of a version before this one, may.

    Raises:
        OtherRun: When it may not.
    """
    other = other_than(folder, now)
    if other is not None:
        raise OtherRun(
            f"{folder} holds another run ({other.told}): "
            "choose another --out, or write over it with --force"
        )


def other_than(folder: Path, now: RunOf) -> RunOf | None:
    """The run in a folder, where it is known to be of something else."""
    before = run_told(folder)
    return None if before in (None, now, RunOf(now.command, ())) else before


def run_told(folder: Path) -> RunOf | None:
    """Of what the run in a folder is; None where there is none, or it does not tell."""
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
