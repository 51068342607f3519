"""What is tracked, at the rate that the models know: the paper's, whatever the cameras' (P1).

Models count frames: a squat that a camera of 60 frames a second shows would be one in slow motion.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from recognizer.features import Rows

PERIOD_S: Final = 1 / 15
"""Of the frames that models learn from."""
EARLY: Final = 0.4
"""By so much of it a frame may come before it is due: clocks of cameras tremble."""
LONGEST: Final = 4
"""A frame stands for fewer of them: no camera is that slow, so frames are missing."""
BACK: Final = 1.5
"""A frame that is due in more of them than that was taken before the last one: a clip that began
again."""


class State(NamedTuple):
    """When the next frame is due; None: the first one is, whenever it comes."""

    due_s: float | None = None


def step(state: State, time_s: float) -> tuple[State, int]:
    """How many frames of the models' one that was taken then stands for.

    None of a faster camera's that comes before one is due, several of a slower one's; one of each
    of a camera of that rate.
    """
    due_s = time_s if state.due_s is None else state.due_s
    after = (time_s - due_s) / PERIOD_S
    if not -BACK <= after < LONGEST - EARLY:
        return State(time_s + PERIOD_S), 1
    due = max(0, math.floor(after + EARLY) + 1)
    return State(due_s + due * PERIOD_S), due


def counts(times_s: Sequence[float] | NDArray[np.float64]) -> NDArray[np.int64]:
    """How many of the models' frames each of those stands for that were taken then, (n,)."""
    state, found = State(), []
    for time_s in times_s:
        state, due = step(state, float(time_s))
        found.append(due)
    return np.array(found, np.int64)


def at_model_rate(times_s: Sequence[float] | NDArray[np.float64], rows: Rows) -> Rows:
    """Rows as the models count them: each so often as `step` says.

    Args:
        times_s: (n,) when the frames were taken.
        rows: (n, 20), ROW_NAMES order.
    """
    return np.repeat(rows, counts(times_s), axis=0)
