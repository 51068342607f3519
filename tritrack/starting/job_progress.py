"""What a command's lines say of its progress, and how long it will still take."""

import json
import re
from typing import Final, NamedTuple

PREFIX: Final = "progress "
ADDRESS: Final = re.compile(r"http://127\.0\.0\.1:\d+")
"""A page on this machine."""
BUS: Final = "the bus: "
"""What the line begins with that says where a live run is heard."""
MOST_LINES: Final = 60
"""Lines of a command that are kept, the newest."""
MOST_LETTERS: Final = 500
"""Of a kept line."""
SURE_SHARE: Final = 0.03
"""Share of the work from which on a remaining time is told."""
FAULTS: Final = ("error: ", "Usage: ")
"""What the line begins with that says why a command ended."""


class Progress(NamedTuple):
    """What a command has said so far."""

    lines: tuple[str, ...] = ()
    """The last lines other than progress."""
    what: str = ""
    """The present pass."""
    done: float = 0.0
    """Passes that are done, and the share of the present one."""
    passes: float = 1.0

    @property
    def share(self) -> float:
        """Done of all passes, in [0, 1]."""
        return min(1.0, max(0.0, self.done / self.passes))

    @property
    def address(self) -> str:
        """Of the command's own page; "" until it tells."""
        found = (ADDRESS.search(line) for line in self.lines)
        return next((one[0] for one in found if one), "")

    @property
    def bus(self) -> str:
        """Where programs hear a live run; "": there is none."""
        found = [line for line in self.lines if line.startswith(BUS)]
        return found[0].removeprefix(BUS) if found else ""

    @property
    def fault(self) -> str:
        """The line that says why the command ended; "" where there is none."""
        found = [line for line in self.lines if line.startswith(FAULTS)]
        return found[-1].removeprefix(FAULTS[0]) if found else ""


def step(state: Progress, line: str) -> Progress:
    """The progress after one more line."""
    text = line.rstrip()
    if not text.startswith(PREFIX):
        kept = (*state.lines, text[:MOST_LETTERS])[-MOST_LINES:]
        return state._replace(lines=kept) if text else state
    try:
        told = json.loads(text.removeprefix(PREFIX))
        what, done, passes = str(told["what"]), float(told["done"]), float(told["of"] or 1.0)
    except (ValueError, TypeError, KeyError):
        return state
    return state._replace(what=what, done=done, passes=max(1.0, passes))


def words(state: Progress, frames: int, seconds: float) -> str:
    """What it is doing, in words: the pass, its frames, the time that is left.

    Args:
        state: What it has said.
        frames: Of its video; 0: not known.
        seconds: Since it began.
    """
    if not state.what:
        return "starting"
    said = state.what
    if state.passes > 1:
        said += f" ({min(int(state.done) + 1, round(state.passes))} of {round(state.passes)})"
    if frames:
        within = 1.0 if state.done >= state.passes else state.done % 1.0
        said += f": {round(within * frames)} of {frames} frames"
    share = state.share
    if SURE_SHARE <= share < 1.0:
        said += f", about {duration(seconds * (1.0 - share) / share)} left"
    return said


def duration(seconds: float) -> str:
    """A duration, rounded as a guess is: 40 s, 3 min, 2 h."""
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    return f"{round(seconds / 60)} min" if seconds < 5400 else f"{round(seconds / 3600)} h"
