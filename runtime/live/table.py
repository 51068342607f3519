"""The live table: a line for each process of a run."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from common.bus.control_messages import Pulse
from common.bus.messages import Body, Posture

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
COLOURS: Final = {
    "running": "green",
    "ended": "dim",
    "ready": "cyan",
    "restarting": "yellow",
    "given up": "red",
}


def table_of(
    names: Sequence[str],
    pulses: Mapping[str, Pulse],
    title: str,
    cameras: Sequence[str] = (),
) -> Table:
    """The state of every process; one without a message yet is starting.

    A viewer is shown with what `cameras` calls its camera, by its number, where that is a name.

    Latency is from a frame's capture to the end of the process's work on it. `missed` counts
    deadlines: work that ended more than a frame later.
    """
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for column, side in COLUMNS:
        table.add_column(column, justify="left" if side == "left" else "right", no_wrap=True)
    for name in names:
        table.add_row(*_cells(_shown_name(name, cameras), pulses.get(name)))
    return table


def table_of_people(bodies: Sequence[Body], postures: Iterable[Posture]) -> Table:
    """Status and posture of each person of the newest instant, and advice to them by camera.

    Args:
        bodies: The newest, of one instant or more, oldest first; at least one.
        postures: The newest, oldest first.
    """
    now = {body.person: body for body in bodies if body.captured_s == bodies[-1].captured_s}
    judged = {posture.person: posture for posture in postures}
    table = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for column in ("person", "status", "posture", "advice"):
        table.add_column(column, no_wrap=column != "advice")
    for person, body in sorted(now.items()):
        posture = judged.get(person)
        doing = "" if posture is None else posture.doing.replace("_", " ")
        table.add_row(str(person), body.status, escape(doing), escape(_advice(body)))
    return table


def _advice(body: Body) -> str:
    """What a person can do, with the cameras for which they are asked to; one advice once."""
    cameras: dict[str, list[str]] = {}
    for camera, advice in enumerate(body.advice, 1):
        if advice:
            cameras.setdefault(advice, []).append(str(camera))
    return "; ".join(f"camera {' and '.join(own)}: {each}" for each, own in cameras.items())


def _shown_name(process: str, cameras: Sequence[str]) -> str:
    """The name of a process, and of its camera where that has one."""
    words = {f"viewer {n}": word for n, word in enumerate(cameras, 1) if word != f"camera {n}"}
    return f"{process} ({escape(words[process])})" if process in words else process


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


def table_of_rows(rows: Sequence[Mapping[str, object]]) -> Table:
    """A table with a line for each of several like items; its columns are their field names."""
    table = Table(box=SIMPLE_HEAD)
    for column in rows[0] if rows else ():
        table.add_column(column.replace("_", " "), justify="left" if column == "name" else "right")
    for row in rows:
        table.add_row(*(_shown(value) for value in row.values()))
    return table


def _shown(value: object) -> str:
    """A value to two decimals, never -0.00; several are joined."""
    if isinstance(value, list | tuple):
        return " ".join(_shown(each) for each in value)
    return f"{round(value, 2) + 0.0:.2f}" if isinstance(value, float) else str(value)
