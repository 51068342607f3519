"""Performances found in a stream that nobody cuts: one event each, as soon as it is over."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from recognizer.bearing import TRAVEL_POSES, bearings
from recognizer.features import ROW_NAMES, Rows, with_pose
from recognizer.network import (
    COUNT,
    DENSITY,
    FILLER,
    FRAMES,
    NUMBERS,
    ONSET,
    SCALE,
    TRAVEL,
    VISITED,
    advance,
    emissions,
)
from recognizer.postures import STATES, Array, DensityModel, scored

OVER_FRAMES: Final = 4
"""So long a performance must be over on the best path before it is an event."""
LEAST_FRAMES: Final = 10
"""A shorter motion is a twitch: the quickest squat takes 1.5 s."""
LEAST_STATES: Final = 4
"""Of the five states of a posture, so many must be met: a part of it is not the posture."""
MISFIT: Final = 30.0
"""By how much a performance may fit worse than those learnt from: about a nat an entry, as people
differ. A hand at the head fits a raised arm worse by 100 and more."""
DRIFT: Final = 0.15
"""By how much travel may differ from the posture's over a performance, leg lengths in five frames
times its weight: half of a slow walk. Steps back are no walk."""
SPEED_FRAMES: Final = 3
"""Limbs' speed is the change of their directions within so many frames."""
KEPT_FRAMES: Final = 150
"""Poses that the posterior of a performance is computed from: its last ten seconds."""
RARE: Final = 0.05
"""A state in which a posture is for a smaller share of its time marks no repetition."""


class Event(NamedTuple):
    """One performance."""

    name: str
    first: int
    last: int
    """First and last frame, counted in calls of `step`."""
    posterior: float
    """Of this posture among all and the filler, in [0, 1]."""
    count: int
    """How often the posture's course was gone through: steps with one leg, kicks, circles."""


class Doing(NamedTuple):
    """What the body is doing now."""

    name: str
    """"" while standing or doing something unknown."""
    count: int
    event: Event | None
    """A performance that is over; told once."""


class Network:
    """What a model's network needs at every frame, computed once."""

    def __init__(self, model: DensityModel) -> None:
        """Of the postures in the order of the model."""
        self.model = model
        self.log_transition = np.log(np.maximum(model.transition, 1e-300))
        self.travel = np.ascontiguousarray(model.mean[..., -3:]).reshape(-1, 3)

    @cached_property
    def turn(self) -> NDArray[np.int64]:
        """The two states of each posture that lie farthest apart, that nearer standing first."""
        return np.array([self._extremes(p) for p in range(len(self.model.names))])

    def _extremes(self, p: int) -> tuple[int, int]:
        mean = self.model.mean[p]
        share = np.linalg.matrix_power(self.model.transition[p], 1000)[0]
        apart = np.linalg.norm(mean[:, np.newaxis] - mean, axis=2)
        apart *= np.minimum.outer(share, share) > RARE
        one, other = np.unravel_index(int(apart.argmax()), apart.shape)
        away = np.linalg.norm(mean[[one, other]] - self.model.rest_mean, axis=1)
        return (int(one), int(other)) if away[0] <= away[1] else (int(other), int(one))


@dataclass(frozen=True, eq=False)
class State:
    """The best paths through the network, and the last frames."""

    network: Network
    score: Array  # (p s + 2,)
    record: Array  # (p s + 2, NUMBERS)
    ended: Array  # (p s + 2, NUMBERS + 2)
    rows: Rows  # the last frames with a pose
    frames: tuple[int, ...] = ()
    """Their numbers."""
    shown: tuple[Array, ...] = ()
    """Feature vectors of the last few."""
    next_frame: int = 0
    stood: bool = False
    told: int = -1
    """The last frame of the last event."""


def init(model: DensityModel) -> State:
    """Nothing seen yet."""
    states = len(model.names) * STATES + 2
    score = np.full(states, -np.inf)
    score[-1] = 0.0
    ended = np.full((states, NUMBERS + 2), -1.0)
    nothing = np.empty((0, len(ROW_NAMES)))
    return State(Network(model), score, np.zeros((states, NUMBERS)), ended, nothing)


def step(state: State, row: NDArray[np.float64] | None) -> tuple[State, Doing]:
    """Take one frame; a frame without a pose adds nothing.

    Args:
        row: (20,) ROW_NAMES order; None or NaN where there is no pose.

    Source: Lee & Kim 1999 for the network of gestures and one model of all else; Rabiner 1989,
    section III B, for its best path.
    """
    now = state.next_frame
    new = with_pose(state.rows[:0] if row is None else row[np.newaxis])
    if not len(new):
        return replace(state, next_frame=now + 1), Doing("", 0, None)
    state = _further(state, new, now)
    return _judged(state, now)


def _further(state: State, new: Rows, now: int) -> State:
    network, model = state.network, state.network.model
    rows = np.concatenate([state.rows, new])[-KEPT_FRAMES:]
    seen = bearings(rows[-TRAVEL_POSES - 1 :])[-1]
    shown = (*state.shown, seen)[-SPEED_FRAMES - 1 :]
    turned = float(np.square(seen[:-3] - shown[0][:-3]).sum())
    speed = math.sqrt(turned + 4.0 * float(np.square(seen[-3:]).sum()))
    emission, plain = emissions(
        seen, speed, model.mean, model.variance, model.rest_mean, model.rest_variance
    )
    score, record, ended = advance(
        state.score, state.record, state.ended, emission, plain, network.log_transition,
        seen[-3:] - network.travel, network.turn, now, state.stood,
    )  # fmt: skip
    return replace(
        state,
        score=score,
        record=record,
        ended=ended,
        rows=rows,
        frames=(*state.frames, now)[-KEPT_FRAMES:],
        shown=shown,
        next_frame=now + 1,
        stood=state.stood or int(score.argmax()) == len(score) - 2,
    )


def _judged(state: State, now: int) -> tuple[State, Doing]:
    """What the best path says of this frame, and of what is over."""
    best = int(state.score.argmax())
    names = state.network.model.names
    if best < len(names) * STATES:
        return state, Doing(names[best // STATES], int(state.record[best, COUNT]), None)
    last, posture = (int(value) for value in state.ended[best, NUMBERS:])
    record = state.ended[best]
    if posture < 0 or int(record[ONSET]) <= state.told or now - last < OVER_FRAMES:
        return state, Doing("", 0, None)
    event = _event(state, posture, record, last) if _holds(state, posture, record) else None
    return replace(state, told=last), Doing("", 0, event)


def _holds(state: State, posture: int, record: Array) -> bool:
    """Whether what is over was the posture, and all of it."""
    frames = record[FRAMES]
    drift = np.linalg.norm(record[TRAVEL : TRAVEL + 3]) / frames
    return bool(
        frames >= LEAST_FRAMES
        and int(record[VISITED]).bit_count() >= LEAST_STATES
        and record[DENSITY] / frames >= state.network.model.fit[posture] - MISFIT
        and drift <= DRIFT
    )


def _event(state: State, posture: int, record: Array, last: int) -> Event:
    model, first = state.network.model, int(record[ONSET])
    inside = [first <= frame <= last for frame in state.frames]
    rows = state.rows[np.array(inside)]
    scores = np.array([*scored(model, rows).values(), FILLER * len(rows)]) * SCALE
    shares = np.exp(scores - scores.max())
    posterior = float(shares[posture] / shares.sum())
    return Event(model.names[posture], first, last, posterior, int(record[COUNT]))
