"""Performances found in a stream that nobody cuts: one event each, as soon as it is over."""

import math
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from recognizer.features import ROW_NAMES, TRAVEL_POSES, Bearings, Rows, bearings, with_pose
from recognizer.forward import forward
from recognizer.path_network import COUNT, LAST, ONSET, SCALE, PathNetwork, advance, emissions
from recognizer.postures import STATES, Array, DensityModel
from recognizer.spotting import MISSED_FRAMES

OVER_FRAMES: Final = 2
"""So long a performance must be over on the best path before it is an event."""
LEAST_FRAMES: Final = 10
"""A shorter motion is a twitch: the quickest squat takes 1.5 s."""
LEAST_STATES: Final = 3
"""Of the five states of a posture, so many must be met: a part of a posture is not the posture."""
MISFIT: Final = 42.0
"""Nats a frame by which a performance may fit worse than those learnt from: some one and a half an
entry, as people differ. A hand at the head fits a raised arm worse by 150 and more."""
RIVAL: Final = 9.0
"""Nats a frame by which a posture that holds may fit worse than one that does not."""
DRIFT, DRIFT_SHARE = 0.09, 0.3
"""By how much travel may differ from the posture's over a performance, leg lengths in five frames
times its weight, and as a share of it: people walk slower or faster. Steps back are no walk."""
AGAIN_FRAMES: Final = 9
"""The same posture within 0.6 s of where the last one ended is that performance going on: some
pause between two kicks. Whoever rests for longer performs again."""
SPEED_FRAMES: Final = 3
"""Limbs' speed is the change of their directions within so many frames."""
KEPT_FRAMES: Final = 150
"""Poses that a performance is judged by: its last ten seconds."""


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


@dataclass(frozen=True, eq=False)
class State:
    """The best paths through the network, and the last frames."""

    network: PathNetwork
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
    told: str = ""
    """Posture of the last event; "" where what was judged last was none."""
    missed: int = 0
    """How many frames without a pose came last."""


def init(model: DensityModel) -> State:
    """Nothing seen yet."""
    return _begun(PathNetwork(model))


def step(state: State, row: NDArray[np.float64] | None) -> tuple[State, Doing]:
    """Take one frame; a frame without a pose adds nothing, MISSED_FRAMES of them in a row end what
    was going on: who comes after them must be seen standing first.

    Args:
        row: (20,) ROW_NAMES order; None or NaN where there is no pose.

    Source: Lee & Kim 1999 for a network of gestures and one model of all else; Rabiner 1989,
    section III B, for its best path.
    """
    now = state.next_frame
    new = with_pose(state.rows[:0] if row is None else row[np.newaxis])
    state = replace(state, next_frame=now + 1, missed=0 if len(new) else state.missed + 1)
    if not len(new):
        if state.missed == MISSED_FRAMES:
            state = replace(_begun(state.network), next_frame=now + 1, missed=state.missed)
        return state, NOTHING
    state = _further(state, new, now)
    best, states = int(state.score.argmax()), len(state.score) - 2
    if best < states:
        name = state.network.model.names[best // STATES]
        return state, Doing(name, int(state.record[best, COUNT]), None)
    over = state.over[best]
    if over[ONSET] <= state.judged or now - over[LAST] < OVER_FRAMES:
        return state, NOTHING
    event = _event(state, over)
    again = event and event.name == state.told and event.first - state.judged <= AGAIN_FRAMES
    state = replace(state, judged=int(over[LAST]), told=event.name if event else "")
    return state, Doing("", 0, None if again else event)


def _begun(network: PathNetwork) -> State:
    """Nothing was seen by that network yet."""
    states = len(network.model.names) * STATES + 2
    score = np.full(states, -np.inf)
    score[-1] = 0.0
    record, over = np.zeros((states, LAST), np.int64), np.full((states, LAST + 1), -1)
    return State(network, score, record, over, np.empty((0, len(ROW_NAMES))))


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
    held = [_holds(state.network, p, shown, logs[:, p]) for p in range(len(model.names))]
    among = np.where(held, totals, -np.inf)
    posture = int(among.argmax())
    if among[posture] < totals.max() - RIVAL * len(rows):
        return None
    filler = (model.fit[posture] - MISFIT) * len(rows)
    shares = np.exp(SCALE * (np.append(among, filler) - among[posture]))
    posterior = float(shares[posture] / shares.sum())
    return Event(model.names[posture], first, last, posterior, int(over[COUNT]))


def _holds(network: PathNetwork, posture: int, shown: Bearings, logs: Array) -> bool:
    """Whether frames show the posture, and all of it.

    Args:
        network: Of all postures.
        posture: Its number.
        shown: (n, 27) the frames.
        logs: (n, s) their log densities in the posture's states.
    """
    model, state = network.model, logs.argmax(axis=1)
    meant = model.mean[posture, state, -3:].mean(axis=0)
    drift = np.linalg.norm(shown[:, -3:].mean(axis=0) - meant)
    return bool(
        len(shown) >= LEAST_FRAMES
        and len(np.unique(state)) >= LEAST_STATES
        and network.far[posture, state].any()
        and logs.max(axis=1).mean() >= model.fit[posture] - MISFIT
        and drift <= DRIFT + DRIFT_SHARE * np.linalg.norm(meant)
    )
