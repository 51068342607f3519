"""Performances found in a stream that nobody cuts: one event each, as soon as it is over."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from recognizer.bearing import TRAVEL_POSES, Bearings, bearings
from recognizer.features import ROW_NAMES, Rows, with_pose
from recognizer.forward import forward
from recognizer.network import COUNT, LAST, ONSET, SCALE, advance, emissions
from recognizer.postures import STATES, Array, DensityModel

OVER_FRAMES: Final = 3
"""So long a performance must be over on the best path before it is an event."""
LEAST_FRAMES: Final = 10
"""A shorter motion is a twitch: the quickest squat takes 1.5 s."""
LEAST_STATES: Final = 3
"""Of the five states of a posture, so many must be met: a part of it is not the posture."""
MISFIT: Final = 42.0
"""Nats a frame by which a performance may fit worse than those learnt from: some one and a half an
entry, as people differ. A hand at the head fits a raised arm worse by 150 and more."""
RIVAL: Final = 9.0
"""Nats a frame by which a posture that holds may fit worse than one that does not."""
DRIFT: Final = 0.11
"""By how much travel may differ from the posture's over a performance, leg lengths in five frames
times its weight: a third of a slow walk. Steps back are no walk."""
SPEED_FRAMES: Final = 3
"""Limbs' speed is the change of their directions within so many frames."""
KEPT_FRAMES: Final = 150
"""Poses that a performance is judged by: its last ten seconds."""
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
    times: int
    """How often the posture's course was gone through: strides, kicks, circles."""


class Doing(NamedTuple):
    """What the body is doing now."""

    name: str
    """"" while standing or doing something unknown."""
    times: int
    event: Event | None
    """A performance that is over; told once."""


NOTHING: Final = Doing("", 0, None)


class Network:
    """What a model's network needs at every frame, computed once."""

    def __init__(self, model: DensityModel) -> None:
        """Of the postures in the order of the model."""
        self.model = model
        with np.errstate(divide="ignore"):
            self.log_transition = np.log(model.transition)

    @cached_property
    def turn(self) -> NDArray[np.int64]:
        """The two states of each posture that lie farthest apart, that nearer standing first."""
        return np.array([self._extremes(p) for p in range(len(self.model.names))])

    def _extremes(self, p: int) -> tuple[int, int]:
        mean = self.model.mean[p]
        share = np.linalg.matrix_power(self.model.transition[p], 1000)[0]
        apart = np.linalg.norm(mean[:, np.newaxis] - mean, axis=2)
        apart *= np.minimum.outer(share, share) > RARE
        one, other = (int(i) for i in np.unravel_index(apart.argmax(), apart.shape))
        away = np.linalg.norm(mean[[one, other]] - self.model.rest_mean, axis=1)
        return (one, other) if away[0] <= away[1] else (other, one)


@dataclass(frozen=True, eq=False)
class State:
    """The best paths through the network, and the last frames."""

    network: Network
    score: Array  # (p s + 2,)
    record: NDArray[np.int64]  # (p s + 2, LAST)
    over: NDArray[np.int64]  # (p s + 2, LAST + 1)
    rows: Rows  # the last frames with a pose
    frames: tuple[int, ...] = ()
    """Their numbers."""
    shown: tuple[Array, ...] = ()
    """Feature vectors of the last few."""
    next_frame: int = 0
    stood: bool = False
    """Somebody was seen standing: until then no posture begins."""
    judged: int = -1
    """Last frame of the last performance that was judged."""


def init(model: DensityModel) -> State:
    """Nothing seen yet."""
    states = len(model.names) * STATES + 2
    score = np.full(states, -np.inf)
    score[-1] = 0.0
    record, over = np.zeros((states, LAST), np.int64), np.full((states, LAST + 1), -1)
    return State(Network(model), score, record, over, np.empty((0, len(ROW_NAMES))))


def step(state: State, row: NDArray[np.float64] | None) -> tuple[State, Doing]:
    """Take one frame; a frame without a pose adds nothing.

    Args:
        row: (20,) ROW_NAMES order; None or NaN where there is no pose.

    Source: Lee & Kim 1999 for a network of gestures and one model of all else; Rabiner 1989,
    section III B, for its best path.
    """
    now = state.next_frame
    new = with_pose(state.rows[:0] if row is None else row[np.newaxis])
    state = replace(state, next_frame=now + 1)
    if not len(new):
        return state, NOTHING
    state = _further(state, new, now)
    best, states = int(state.score.argmax()), len(state.score) - 2
    if best < states:
        name = state.network.model.names[best // STATES]
        return state, Doing(name, int(state.record[best, COUNT]), None)
    over = state.over[best]
    if over[ONSET] <= state.judged or now - over[LAST] < OVER_FRAMES:
        return state, NOTHING
    return replace(state, judged=int(over[LAST])), Doing("", 0, _event(state, over))


def _further(state: State, new: Rows, now: int) -> State:
    network, model = state.network, state.network.model
    rows = np.concatenate([state.rows, new])[-KEPT_FRAMES:]
    seen = bearings(rows[-TRAVEL_POSES - 1 :])[-1]
    shown = (*state.shown, seen)[-SPEED_FRAMES - 1 :]
    speed = math.sqrt(np.square(seen - shown[0])[:-3].sum() + 4.0 * np.square(seen[-3:]).sum())
    emission = emissions(
        seen, speed, model.mean, model.variance, model.rest_mean, model.rest_variance
    )
    score, record, over = advance(
        state.score, state.record, state.over, emission, network.log_transition, network.turn,
        now, state.stood,
    )  # fmt: skip
    return replace(
        state,
        score=score,
        record=record,
        over=over,
        rows=rows,
        frames=(*state.frames, now)[-KEPT_FRAMES:],
        shown=shown,
        stood=state.stood or int(score.argmax()) == len(score) - 2,
    )


def _event(state: State, over: NDArray[np.int64]) -> Event | None:
    """The performance that is over, if it was one: the likeliest of the postures that it can be."""
    model, first, last = state.network.model, int(over[ONSET]), int(over[LAST])
    rows = state.rows[[first <= frame <= last for frame in state.frames]]
    shown, logs = bearings(rows), model.log_emission(rows)
    totals = forward(model.start, model.transition, logs)
    held = [_holds(model, p, shown, logs[:, p]) for p in range(len(model.names))]
    among = np.where(held, totals, -np.inf)
    posture = int(among.argmax())
    if among[posture] < totals.max() - RIVAL * len(rows):
        return None
    filler = (model.fit[posture] - MISFIT) * len(rows)
    shares = np.exp(SCALE * (np.append(among, filler) - among[posture]))
    posterior = float(shares[posture] / shares.sum())
    return Event(model.names[posture], first, last, posterior, int(over[COUNT]))


def _holds(model: DensityModel, posture: int, shown: Bearings, logs: Array) -> bool:
    """Whether frames show the posture, and all of it.

    Args:
        model: Of all postures.
        posture: Its number.
        shown: (n, 27) the frames.
        logs: (n, s) their log densities in the posture's states.
    """
    state = logs.argmax(axis=1)
    drift = (shown - model.mean[posture, state])[:, -3:].mean(axis=0)
    return bool(
        len(shown) >= LEAST_FRAMES
        and len(np.unique(state)) >= LEAST_STATES
        and logs.max(axis=1).mean() >= model.fit[posture] - MISFIT
        and np.linalg.norm(drift) <= DRIFT
    )
