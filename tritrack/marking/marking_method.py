"""A way to calibrate, as the marking page needs to know it."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import msgspec

from animator.marking.sheet import Number, Sheet, Solved


class MarkingMethod(NamedTuple):
    """What is asked for on the page, and what is made of it."""

    name: str
    numbers: tuple[Number, ...]
    hints: dict[str, tuple[str, str]]
    """Of each kind of mark what to click, in camera 1 and 2."""
    start: Sheet
    solve: Callable[[Sheet], Solved]
    text: Callable[[Sheet], str]
    """The file of points that the typed command reads; CalibrationError where a number lacks."""
    write: Callable[[Sheet], None] | None
    """Writes the calibration; None: the method has none."""
    rows: Callable[[Sheet], Sequence[msgspec.Struct]]
    """What the typed command prints, of each camera."""


def toml_number(value: float) -> str:
    """A number that TOML reads back as it is."""
    return repr(float(value))


def toml_pixels(points: Sequence[tuple[float, float]]) -> str:
    """Points as TOML writes them, without the outer brackets."""
    return ", ".join(f"[{toml_number(column)}, {toml_number(row)}]" for column, row in points)
