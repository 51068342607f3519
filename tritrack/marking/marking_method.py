"""The marking page's interface to a calibration method."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import msgspec

from animator.marking.sheet import Number, Sheet, Solved


class MarkingMethod(NamedTuple):
    """The page's questions, and the evaluation of the answers."""

    name: str
    numbers: tuple[Number, ...]
    hints: dict[str, tuple[str, str]]
    """For each kind of mark what to click, in camera 1 and 2."""
    start: Sheet
    solve: Callable[[Sheet], Solved]
    text: Callable[[Sheet], str]
    """The typed command's file of points; CalibrationError where a number is missing."""
    write: Callable[[Sheet], None] | None
    """Writes the calibration; None: the method has none."""
    rows: Callable[[Sheet], Sequence[msgspec.Struct]]
    """The typed command's output, by camera."""


def toml_number(value: float) -> str:
    """A number that TOML reads back exactly."""
    return repr(float(value))


def toml_pixels(points: Sequence[tuple[float, float]]) -> str:
    """Points in TOML's form, without the outer brackets."""
    return ", ".join(f"[{toml_number(column)}, {toml_number(row)}]" for column, row in points)
