"""Tracked frames at the models' rate: the paper's, whatever the cameras' (P1).

Models count frames: a squat from a camera of 60 frames a second would look like slow motion.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from recognizer.features import Rows

PERIOD_S: Final = 1 / 15
"""Time between frames of the models' training data."""
EARLY: Final = 0.4
"""Share of a period by which a frame may come early: camera clocks jitter."""
LONGEST: Final = 4
"""Largest number of model frames for one frame: no camera is slower, so frames are missing
beyond."""
BACK: Final = 1.5
"""Model frames until the next due one, beyond which time ran backwards: a clip began again."""


class State(NamedTuple):
    """When the next frame is due; None: at the first frame, whenever it comes."""

    due_s: float | None = None


def step(state: State, time_s: float) -> tuple[State, int]:
    """Number of model frames for a frame captured at a given time.

    A faster camera's frame gives none before one is due, a slower one's gives several; a camera of
    that rate gives one each.
    """
    due_s = time_s if state.due_s is None else state.due_s
    after = (time_s - due_s) / PERIOD_S
    if not -BACK <= after < LONGEST - EARLY:
        return State(time_s + PERIOD_S), 1
    due = max(0, math.floor(after + EARLY) + 1)
    return State(due_s + due * PERIOD_S), due


def counts(times_s: Sequence[float] | NDArray[np.float64]) -> NDArray[np.int64]:
    """Number of model frames for each captured frame, (n,)."""
    state, found = State(), []
    for time_s in times_s:
        state, due = step(state, float(time_s))
        found.append(due)
    return np.array(found, np.int64)


def at_model_rate(times_s: Sequence[float] | NDArray[np.float64], rows: Rows) -> Rows:
    """Rows at the models' rate: each repeated as `step` says.

    Args:
        times_s: (n,) capture times.
        rows: (n, 20), ROW_NAMES order.
    """
    return np.repeat(rows, counts(times_s), axis=0)
