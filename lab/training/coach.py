"""Live teaching: instructions, a countdown, and the cutting of takes from the tracked motion."""

import math
from collections import deque
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.bus.messages import Body
from recognizer.features import Rows

MOVES_M: Final = 0.12
"""Displacement of a joint within LOOK_S from which on a person moves."""
LOOK_S: Final = 0.4
STANDS_S: Final = 0.5
"""Seconds without motion after which a person stands."""
HELD_S: Final = 2.0
"""Seconds of standing in another posture than before the take, after which the take is over."""
HOME_M: Final = 0.25
"""Largest distance of a joint, relative to the pelvis, from its place before the take, for the
same stance."""
LONGEST_S: Final = 12.0
"""Longest take, seconds, and longest wait for one to begin."""
SHORTEST_S: Final = 0.7

STAND: Final = "stand so that the cameras see all of you, arms hanging"
AGAIN_STILL: Final = "nothing moved: once more"
AGAIN_SHORT: Final = "that was too short: once more"
AGAIN_LOST: Final = "you were lost from sight: once more"


class Look(NamedTuple):
    """One body, reduced for teaching."""

    time_s: float
    row: Rows
    """(20,) the recogniser's input."""
    joints_m: NDArray[np.float64] | None
    """(15, 3); None where the body is not tracked."""


class State(NamedTuple):
    """The coach's state."""

    posture: str
    count_s: float
    """Length of the countdown before each take, seconds."""
    doing: str = "waiting"
    """waiting (for a person who stands), counting, ready or moving."""
    since_s: float = 0.0
    """Time when that phase began."""
    still_s: float | None = None
    """Time since when nothing moves; None during motion."""
    told: int = 0
    """The last number of the countdown."""
    seen: tuple[Look, ...] = ()
    """Observations since the take began, and within LOOK_S before."""


class Said(NamedTuple):
    """Output after a body."""

    word: str = ""
    """Text for the person; "" for nothing."""
    take: Rows | None = None
    """(n, 20) a performance from its first movement to the last."""


def look_at(body: Body, row: Rows, moving: tuple[str, ...]) -> Look:
    """A body in the coach's form; `moving` are the states in which it is tracked."""
    known = body.status in moving and bool(body.joints_m)
    return Look(body.captured_s, row, np.array(body.joints_m) if known else None)


def step(state: State, look: Look) -> tuple[State, Said]:
    """Process one body."""
    state = _with(state, look)
    if look.joints_m is None:
        return _lost(state, look)
    still_s = 0.0 if state.still_s is None else look.time_s - state.still_s
    stands = still_s >= STANDS_S
    if state.doing == "waiting":
        return _begin(state, look) if stands else (state, Said())
    if state.doing == "counting":
        return _count(state, look)
    if state.doing == "ready":
        return _await(state, look)
    return _end(state, look, still_s >= HELD_S or (stands and _is_home(state.seen[0], look)))


def _with(state: State, look: Look) -> State:
    """The state with the body, and the time since when nothing moves."""
    kept = deque((*state.seen, look))
    first_s = look.time_s - LOOK_S
    while state.doing != "moving" and kept[0].time_s < first_s:
        kept.popleft()
    recent = [one for one in kept if one.time_s >= first_s and one.joints_m is not None]
    places_m = [one.joints_m for one in recent if one.joints_m is not None]
    moves = len(places_m) < 2 or _extent_m(places_m) > MOVES_M
    since = recent[0].time_s if state.still_s is None and recent else state.still_s
    return state._replace(seen=tuple(kept), still_s=None if moves else since)


def _extent_m(joints_m: list[Vector]) -> float:
    return float(np.linalg.norm(np.array(joints_m) - joints_m[-1], axis=2).max())


def _is_home(before: Look, now: Look) -> bool:
    """Whether the stance is the one before the take: arms held up, or a deep squat, are the
    take's middle."""
    assert before.joints_m is not None
    assert now.joints_m is not None
    moved = (now.joints_m - now.joints_m[0]) - (before.joints_m - before.joints_m[0])
    return float(np.linalg.norm(moved, axis=1).max()) < HOME_M


def _to(state: State, doing: str, look: Look) -> State:
    return state._replace(doing=doing, since_s=look.time_s, told=0)


def _lost(state: State, look: Look) -> tuple[State, Said]:
    """A take in which the person is lost must be repeated; otherwise the coach waits."""
    word = AGAIN_LOST if state.doing in ("counting", "ready", "moving") else ""
    return _to(state, "waiting", look)._replace(still_s=None, seen=()), Said(word)


def _begin(state: State, look: Look) -> tuple[State, Said]:
    return _count(_to(state, "counting", look), look)


def _count(state: State, look: Look) -> tuple[State, Said]:
    """The countdown 3, 2, 1, now; a person who moves meanwhile either stands again by then, or
    begins early."""
    left = math.ceil(state.count_s - (look.time_s - state.since_s) - 1e-9)
    if left > 0:
        word = str(left) if left != state.told else ""
        return state._replace(told=left), Said(word)
    word = f"now: {state.posture}, once, then stand still"
    return _to(state, "ready", look), Said(word)


def _await(state: State, look: Look) -> tuple[State, Said]:
    if state.still_s is None:
        return _to(state, "moving", look), Said()
    if look.time_s - state.since_s > LONGEST_S:
        return _to(state, "waiting", look), Said(AGAIN_STILL)
    return state, Said()


def _end(state: State, look: Look, stands: bool) -> tuple[State, Said]:
    if not stands and look.time_s - state.since_s <= LONGEST_S:
        return state, Said()
    last_s = state.still_s if stands and state.still_s is not None else look.time_s
    rows = [one.row for one in state.seen if one.time_s <= last_s]
    after = _to(state, "waiting", look)._replace(seen=(look,))
    if last_s - state.since_s < SHORTEST_S:
        return after, Said(AGAIN_SHORT)
    return after, Said("thank you", np.array(rows))
