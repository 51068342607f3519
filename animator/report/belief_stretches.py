"""When a run's body was believed, and why not elsewhere: stretches of one state."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.npz_file import Arrays

CONFIDENT: Final = 0.5
"""Mean confidence of the joints below which a frame is half believed."""
WORDS: Final = {
    "empty": "no person in any view",
    "measuring": "believed, the body's lengths are being measured",
    "tracking": "believed",
    "doubted": "followed, but its joints are less than .5 confident in the mean",
    "predicted": "not believed: no view bears the pose out, it is carried on from before",
    "lost": "not believed: a person is seen, and no pose fits what the views show",
}
"""Each state, in words."""
SHORTEST_S: Final = 0.2
"""Shortest stretch in the list of doubts, seconds; the strip shows all."""


class Stretch(NamedTuple):
    """Rows of one state."""

    state: str
    first: int
    last: int
    from_s: float
    until_s: float
    left: float
    """Percent of the run before it."""
    wide: float
    """Percent of the run within it."""
    why: str


def states_of(poses: Arrays) -> NDArray[np.str_]:
    """The state of each row, (n,): its status, or doubted where the joints are hardly sure."""
    status = np.asarray(poses["status"])
    unsure = np.asarray(poses["confidence"]).mean(axis=1) < CONFIDENT
    return np.where((status == "tracking") & unsure, "doubted", status)


def stretches_of(poses: Arrays) -> list[Stretch]:
    """The run as stretches of one state each."""
    states, time_s = states_of(poses), np.asarray(poses["time_s"], float)
    if not len(states):
        return []
    step_s = float(np.median(np.diff(time_s))) if len(time_s) > 1 else 0.1
    ends_s = np.append(time_s[1:], time_s[-1] + step_s)
    whole_s = max(float(ends_s[-1] - time_s[0]), 1e-9)
    firsts = np.flatnonzero(np.append(True, states[1:] != states[:-1]))
    lasts = np.append(firsts[1:] - 1, len(states) - 1)
    return [
        Stretch(
            state := str(states[a]),
            int(a),
            int(b),
            float(time_s[a]),
            float(ends_s[b]),
            100.0 * float(time_s[a] - time_s[0]) / whole_s,
            100.0 * float(ends_s[b] - time_s[a]) / whole_s,
            f"{WORDS.get(state, state)}{_views(poses, int(a), int(b), state)}",
        )
        for a, b in zip(firsts, lasts, strict=True)
    ]


def _views(poses: Arrays, a: int, b: int, state: str) -> str:
    """Which cameras mostly did not show the person meanwhile."""
    if state in ("tracking", "measuring", "empty"):
        return ""
    seen = np.asarray(poses["seen"])[a : b + 1].mean(axis=0)
    used = np.any(poses["seen"], axis=0).tolist()
    names = [str(name) for name in poses["camera_names"]]
    blind = [name for name, share, on in zip(names, seen, used, strict=True) if on and share < 0.5]
    return f"; {' and '.join(blind)} did not show the person" if blind else ""


def doubts(stretches: Sequence[Stretch]) -> list[Stretch]:
    """The stretches that are not believed and last long enough to be listed."""
    fine = ("tracking", "measuring", "empty")
    return [
        one for one in stretches if one.state not in fine and one.until_s - one.from_s >= SHORTEST_S
    ]


def worst_rows(poses: Arrays, most: int, apart_s: float) -> list[int]:
    """The rows with a person that are worth the least, in the order of time.

    A row's worth is the mean confidence of its joints times the worst fit of any view that shows
    the person; without a pose it is 0.

    Args:
        poses: The run.
        most: At most so many.
        apart_s: Least time between two of them.
    """
    worth, time_s = _worth(poses), np.asarray(poses["time_s"], float)
    chosen: list[int] = []
    for row in np.argsort(worth, kind="stable").tolist():
        near = any(abs(time_s[row] - time_s[other]) < apart_s for other in chosen)
        if len(chosen) < most and np.isfinite(worth[row]) and not near:
            chosen.append(row)
    return sorted(chosen)


def _worth(poses: Arrays) -> Vector:
    seen, score = np.asarray(poses["seen"]), np.asarray(poses["score"], float)
    worst_fit = np.where(seen, score, np.inf).min(axis=1, initial=1.0)
    worth: Vector = np.asarray(poses["confidence"], float).mean(axis=1) * worst_fit
    posed = np.isfinite(poses["joints_m"]).all(axis=(1, 2))
    worth = np.where(posed, worth, 0.0)
    return np.where(np.asarray(poses["status"]) == "empty", np.nan, worth)
