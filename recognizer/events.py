"""Performances found in a continuous stream: one event each, as soon as it is over."""

import math
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from recognizer.features import ROW_NAMES, TRAVEL_POSES, Rows, bearings, with_pose
from recognizer.path_network import COUNT, LAST, ONSET, PathNetwork, advance, emissions
from recognizer.performance_judge import Event, event_of
from recognizer.postures import STATES, Array, DensityModel
from recognizer.spotting import MISSED_FRAMES

OVER_FRAMES: Final = 2
"""Frames for which a performance must have ended on the best path before it becomes an event."""
AGAIN_FRAMES: Final = 9
"""Frames after the end of a performance within which the same posture continues it, 0.6 s: some
people pause between two kicks. After a longer rest a new performance begins."""
SPEED_FRAMES: Final = 3
"""Frames over which the change of limbs' directions gives their speed."""
KEPT_FRAMES: Final = 150
"""Number of frames by which a performance is judged: its last ten seconds."""


class Doing(NamedTuple):
    """The posture in progress."""

    name: str
    """"" while the person stands or does something unknown."""
    times: int
    """Number of repetitions so far."""
    event: Event | None
    """A performance that has ended. One with the same start as the event before continues and
    replaces it."""


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
    """A person was seen standing: until then no posture begins."""
    judged: int = -1
    """Last frame of the last performance that was judged."""
    told: tuple[Event, ...] = ()
    """The parts of the last event, between which it paused; () where the last judged motion was
    none."""
    missed: int = 0
    """Number of frames without a pose since the last pose."""


def init(model: DensityModel) -> State:
    """The initial state."""
    return _begun(PathNetwork(model))


def step(state: State, row: NDArray[np.float64] | None) -> tuple[State, Doing]:
    """Process one frame. A frame without a pose adds nothing; MISSED_FRAMES of them in a row end
    the motion in progress, and the next person must be seen standing first.

    Args:
        row: (20,) ROW_NAMES order; None or NaN where there is no pose.

    Source: Lee & Kim 1999 for a network of gestures with one model for all else; Rabiner 1989,
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
        name, record = state.network.model.names[best // STATES], state.record[best]
        before = _parts_before(state.told, name, int(record[ONSET]))
        return state, Doing(name, _times(before) + int(record[COUNT]), None)
    over = state.over[best]
    if over[LAST] <= state.judged or now - over[LAST] < OVER_FRAMES:
        return state, NOTHING
    told, event = _judged(state, over)
    return replace(state, judged=int(over[LAST]), told=told), Doing("", 0, event)


def finish(state: State) -> Event | None:
    """The performance that the end of a stream cuts off, or that ended too shortly before to be
    reported."""
    best = int(state.score.argmax())
    under_way = best < len(state.score) - 2
    over = np.append(state.record[best], state.frames[-1]) if under_way else state.over[best]
    return _judged(state, over)[1] if over[LAST] > state.judged else None


def _judged(state: State, over: NDArray[np.int64]) -> tuple[tuple[Event, ...], Event | None]:
    """The parts of the last event now, and what is reported of it.

    The best path may have stayed in its posture through a pause after which another performance was
    judged: the earlier report is then a part of it.
    """
    told = state.told
    seen = [over[ONSET] <= frame <= over[LAST] for frame in state.frames]
    event = event_of(state.network, over, state.rows[seen])
    if event is None or (told and event.name != told[-1].name and event.first <= told[-1].last):
        return (told if over[ONSET] <= state.judged else ()), None
    before = _parts_before(told, event.name, event.first)
    if not before and _goes_on(told, event.name, event.first):
        event = event._replace(first=told[0].first)
    parts = (*before, event)
    sure = min(part.posterior for part in parts)
    return parts, event._replace(first=parts[0].first, times=_times(parts), posterior=sure)


def _parts_before(told: tuple[Event, ...], name: str, first: int) -> tuple[Event, ...]:
    """The earlier parts of the last event, if the one that begins now continues it."""
    return tuple(part for part in told if part.first < first and _goes_on(told, name, first))


def _goes_on(told: tuple[Event, ...], name: str, first: int) -> bool:
    """Whether the performance that begins now continues the last one, after a pause at most."""
    return bool(told) and told[-1].name == name and first - told[-1].last <= AGAIN_FRAMES


def _times(parts: tuple[Event, ...]) -> int:
    return sum(part.times for part in parts)


def _begun(network: PathNetwork) -> State:
    """The network's state before any frame."""
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
        state.score, state.record, state.over, emission, network.log_transition, network.side,
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
