"""The live table: a line for each process of a run."""

from collections.abc import Mapping, Sequence
from typing import Final

from rich.table import Table

from common.messages import Pulse

COLUMNS: Final = (
    ("process", "left"),
    ("state", "left"),
    ("frames", "right"),
    ("fps", "right"),
    ("missed", "right"),
    ("dropped", "right"),
    ("p50 ms", "right"),
    ("p99 ms", "right"),
    ("MB", "right"),
)
COLOURS: Final = {"running": "green", "failed": "red", "ended": "dim", "ready": "cyan"}


def table_of(names: Sequence[str], pulses: Mapping[str, Pulse], title: str) -> Table:
    """How every process is doing; one that was not heard yet is starting.

    Latency is from a frame's capture to the end of the process's work on it. `missed` counts
    deadlines: work that ended more than a frame later.
    """
    table = Table(title=title, title_justify="left", expand=False)
    for column, side in COLUMNS:
        table.add_column(column, justify="left" if side == "left" else "right")
    for name in names:
        table.add_row(*_cells(name, pulses.get(name)))
    return table


def _cells(name: str, pulse: Pulse | None) -> list[str]:
    if pulse is None:
        return [name, "starting", *[""] * (len(COLUMNS) - 2)]
    colour = COLOURS.get(pulse.state, "white")
    return [
        name,
        f"[{colour}]{pulse.state}[/]",
        str(pulse.frames),
        f"{pulse.fps:.1f}",
        str(pulse.deadline_misses),
        str(pulse.dropped + pulse.late),
        f"{pulse.latency_p50_ms:.1f}",
        f"{pulse.latency_p99_ms:.1f}",
        f"{pulse.memory_mb:.0f}",
    ]
