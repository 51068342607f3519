"""What a person reads while a command works: one line a warning or an error, and a bar."""

import json
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import Progress

Thing = TypeVar("Thing")
Tell = Callable[[float], object]
"""Hears how much of some work is done, in [0, 1]."""


def say(console: Console, text: str) -> None:
    """What was done."""
    _line(console, text, "")


def warn(console: Console, text: str) -> None:
    """What is odd but does not stop the work."""
    _line(console, f"warning: {text}", "yellow")


def complain(console: Console, text: str) -> None:
    """What stops it, and the cure."""
    _line(console, f"error: {text}", "red")


def counted(number: int, thing: str, things: str = "") -> str:
    """How many of something: 1 clip, 2 clips.

    Args:
        number: How many.
        thing: One of them.
        things: Several; "": with an s.
    """
    return f"{number} {thing if number == 1 else things or f'{thing}s'}"


def bar(console: Console) -> Progress:
    """How far long work is; nothing where nobody looks on, as in a file."""
    return Progress(console=console, transient=True, disable=not console.is_terminal)


def by_share(
    progress: Progress, things: Sequence[Thing], description: str
) -> Iterator[tuple[Thing, Tell]]:
    """Things one after the other, each with a function that is told which share of it is done.

    One long video moves the bar with its frames, as many short ones do with each that is over.
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
    """Things one after the other, each gone through several times.

    With each comes a function that begins a pass, by its name, and gives another one that is told
    which share of it is done. A pass that is left out counts as done.
    """
    task = progress.add_task("", total=len(things) * len(passes))
    for before, thing in enumerate(things):

        def begun(name: str, before: int = before) -> Tell:
            done = before * len(passes) + passes.index(name)
            return lambda share: progress.update(task, completed=done + share, description=name)

        yield thing, begun
        progress.update(task, completed=(before + 1) * len(passes))


def json_text(value: Any) -> str:
    """Strict JSON: a number that is not finite, which JSON cannot say, becomes null."""
    return json.dumps(_finite(value), indent=1, allow_nan=False)


def _line(console: Console, text: str, style: str) -> None:
    """One line however long: a terminal wraps it by itself, a file keeps it whole."""
    console.print(
        " ".join(text.split()), style=style, markup=False, highlight=False, soft_wrap=True
    )


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
