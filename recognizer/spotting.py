"""Live recognition: the motion in progress, in a sliding window that is judged at every frame."""

from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from recognizer.features import FEATURE_NAMES, ROW_NAMES, Features, Rows, features, with_pose
from recognizer.postures import PostureModel, likeliest, scored

NAMED_FROM_FRAMES: Final = 15
"""Shortest motion, frames, a second: less fits too many postures."""

STILL_FRAMES: Final = 12
"""Frames of standstill that separate two motions: shorter ones occur within a motion, between
two kicks."""

STILL: Final = 0.15
"""Spread of feature vectors (root mean square distance from their mean) below which a body
stands still; 0.15 is one limb swaying by 9 degrees. With true angles it is 0.07 at most in T
poses and 0.19 at least in a second of any motion (two performers, docs/measurements.md)."""

MISSED_FRAMES: Final = 15
"""Frames in a row without a pose that end the motion in progress: the next pose begins a new
one."""


@dataclass(frozen=True, eq=False)
class State:
    """The last frames; the oldest first."""

    model: PostureModel | None
    """None: motions are followed, but not recognised."""
    window_frames: int
    rows: Rows  # (n, 20), n <= window_frames
    seen: Features  # (n, 16), of the same frames
    frames: tuple[int, ...] = ()
    """The numbers of the `step` calls, from 0, that had these poses."""
    next_frame: int = 0
    moving_frames: int = 0
    """Poses since the last standstill ended; 0 during one."""
    named: bool = False
    """The last judgement gave a name."""
    missed: int = 0
    """Number of frames without a pose since the last pose."""


class Judgement(NamedTuple):
    """Judgement of the window."""

    name: str
    """The likeliest posture; "" while there was too little motion, or only standing."""
    log_likelihoods: dict[str, float]
    """log P(window | model) of each posture; empty where there is no name."""
    first: int
    last: int
    """First and last frame of the window, as numbers of `step` calls; both are this call's where
    the window is empty."""


NOTHING: Final = Judgement("", {}, 0, 0)


def init(model: PostureModel | None, window_frames: int) -> State:
    """The initial state."""
    nothing = np.empty((0, len(ROW_NAMES)))
    return State(model, window_frames, rows=nothing, seen=np.empty((0, len(FEATURE_NAMES))))


def step(state: State, row: NDArray[np.float64] | None) -> tuple[State, Judgement]:
    """Process one frame and judge the window that ends with it.

    The models have no standing. So a standstill (the opening posture, say) has no name. A motion
    gets its name after a second, without the frames before the standstill. A motion that ends in
    standing keeps its name until only standing is in the window. A frame without a pose adds
    nothing.

    Args:
        row: (20,) ROW_NAMES order; None or NaN where there is no pose.
    """
    state = _cut(_remember(state, row))
    scores = _scores(state)
    name = likeliest(scores) if scores else ""
    now = state.next_frame - 1
    first, last = (state.frames[0], state.frames[-1]) if state.frames else (now, now)
    return replace(state, named=bool(scores)), Judgement(name, scores, first, last)


def motion_of(given: Rows, window_frames: int) -> Rows:
    """The rows by which a window at the end of a recording would be judged: the training input.

    Args:
        given: (n, 20), NaN in rows without a pose or from before the motion.
        window_frames: Length of the window.
    """
    state = init(None, window_frames)
    for row in given:
        state, _ = step(state, row)
    return given[list(state.frames)]


def _remember(state: State, row: NDArray[np.float64] | None) -> State:
    new = with_pose(state.rows[:0] if row is None else row[np.newaxis])
    now, keep = state.next_frame, state.window_frames
    if len(new):
        rows = np.concatenate([state.rows, new])[-keep:]
        seen = np.concatenate([state.seen, features(new)])[-keep:]
        moving = 0 if _stands(seen) else state.moving_frames + 1
        frames = (*state.frames, now)[-keep:]
        return replace(
            state,
            rows=rows,
            seen=seen,
            frames=frames,
            next_frame=now + 1,
            moving_frames=moving,
            missed=0,
        )
    missed = state.missed + 1
    if missed >= MISSED_FRAMES:
        state = init(state.model, keep)
    return replace(state, next_frame=now + 1, missed=missed)


def _cut(state: State) -> State:
    """The rows after the end of the last standstill, once there are enough of them."""
    if state.moving_frames < _needed(state):
        return state
    keep = state.moving_frames
    return replace(
        state, rows=state.rows[-keep:], seen=state.seen[-keep:], frames=state.frames[-keep:]
    )


def _scores(state: State) -> dict[str, float]:
    begun = state.named or state.moving_frames >= _needed(state)
    if (
        state.model is None
        or not begun
        or len(state.seen) < _needed(state)
        or _spread(state.seen) < STILL
    ):
        return {}
    return scored(state.model, state.rows)


def _needed(state: State) -> int:
    return min(NAMED_FROM_FRAMES, state.window_frames)


def _stands(seen: Features) -> bool:
    return len(seen) >= STILL_FRAMES and _spread(seen[-STILL_FRAMES:]) < STILL


def _spread(seen: Features) -> float:
    return float(np.sqrt(np.square(seen - seen.mean(axis=0)).sum(axis=1).mean()))
