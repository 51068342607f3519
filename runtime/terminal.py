"""A command's display: one line per warning or error, and a progress bar."""

import json
import math
import os
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final, TypeVar

from rich.console import Console
from rich.progress import Progress, TaskID

Thing = TypeVar("Thing")
Tell = Callable[[float], object]
"""Receives the share of the work that is done, in [0, 1]."""
PROGRESS: Final = "TRITRACK_PROGRESS"
"""Environment variable; where it is "lines", progress is printed for the program that started the
command: a line `progress {"what": ..., "done": ..., "of": ...}` each time."""
LEAST_S: Final = 0.2
"""Least time between two such lines of one pass, seconds."""


def say(console: Console, text: str) -> None:
    """What was done."""
    _line(console, text, "")


def warn(console: Console, text: str) -> None:
    """A warning: an oddity that does not stop the work."""
    _line(console, f"warning: {text}", "yellow")


def complain(console: Console, text: str) -> None:
    """An error that stops it, and the cure."""
    _line(console, f"error: {text}", "red")


def counted(number: int, thing: str, things: str = "") -> str:
    """A number with its noun: 1 clip, 2 clips.

    Args:
        number: The number.
        thing: The noun in the singular.
        things: The plural; "": with an s.
    """
    return f"{number} {thing if number == 1 else things or f'{thing}s'}"


class ProgressLines(Progress):
    """Progress as lines, for another program."""

    def __init__(self, console: Console) -> None:
        """Nothing is drawn; the lines go to the console."""
        super().__init__(console=console, disable=True)
        self._said_s, self._pass = -LEAST_S, ""

    def update(self, task_id: TaskID, **changes: Any) -> None:
        """Note the change, and print it where the last line is old enough or the pass is new."""
        super().update(task_id, **changes)
        task, now_s = self._tasks[task_id], time.monotonic()
        if now_s - self._said_s >= LEAST_S or task.description != self._pass:
            self._said_s, self._pass = now_s, task.description
            said = {"what": task.description, "done": task.completed, "of": task.total}
            _line(self.console, f"progress {json.dumps(said)}", "")


def bar(console: Console) -> Progress:
    """Progress of long work; nothing is shown where the output is no terminal."""
    if os.environ.get(PROGRESS) == "lines":
        return ProgressLines(console)
    return Progress(console=console, transient=True, disable=not console.is_terminal)


def by_share(
    progress: Progress, things: Sequence[Thing], description: str
) -> Iterator[tuple[Thing, Tell]]:
    """Items one after the other, each with a function that receives its progress.

    One long video moves the bar with its frames, many short ones with each that is complete.
    """
    task = progress.add_task(description, total=len(things))
    for before, thing in enumerate(things):

        def tell(share: float, before: int = before) -> None:
            progress.update(task, completed=before + share)

        yield thing, tell
        progress.update(task, completed=before + 1)


def by_pass(
    progress: Progress, things: Sequence[Thing], passes: Sequence[str]
) -> Iterator[tuple[Thing, Callable[[str], Tell]]]:
    """Items one after the other, each processed in several passes.

    Each item comes with a function that begins a named pass and returns the function for its
    progress. A pass that is left out counts as done.
    """
    task = progress.add_task("", total=len(things) * len(passes))
    for before, thing in enumerate(things):

        def begun(name: str, before: int = before) -> Tell:
            done = before * len(passes) + passes.index(name)
            return lambda share: progress.update(task, completed=done + share, description=name)

        yield thing, begun
        progress.update(task, completed=(before + 1) * len(passes))


def json_text(value: Any) -> str:
    """Strict JSON: a number that is not finite becomes null."""
    return json.dumps(_finite(value), indent=1, allow_nan=False)


def _line(console: Console, text: str, style: str) -> None:
    """One line however long: a terminal wraps it itself, a file keeps it whole."""
    console.print(
        " ".join(text.split()), style=style, markup=False, highlight=False, soft_wrap=True
    )


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
