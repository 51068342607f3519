"""Whose turn it is to be looked at, in each view, while a run of several people is late."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from integrator.people.known_life import NO_TRACK, Life

LATE: Final = 0.75
"""Time from capture to bodies, in frame periods, from which on people are looked at in turn: an
instant is missed at 1."""
LASTS_S: Final = 1.0
"""How long after the last late instant they are, seconds."""


class State(NamedTuple):
    """What one instant hands to the next."""

    left: int = 0
    """Number of instants for which people are looked at in turn, without another late one."""
    turn: int = 0


def step(
    state: State, late_s: float, period_s: float, lives: Sequence[Life]
) -> tuple[State, tuple[int | None, ...]]:
    """After an instant: for each view, the viewer's number of the person whose turn is next; empty
    where everyone is looked at.

    Views take turns apart: who is not looked at in one is in another.

    Args:
        state: After the instant before.
        late_s: From capture to the bodies.
        period_s: Between instants.
        lives: The people.
    """
    left = round(LASTS_S / period_s) if late_s > LATE * period_s else max(state.left - 1, 0)
    state = State(left, state.turn + 1)
    if not left or len(lives) < 2:
        return state, ()
    views = range(len(lives[0].tracks))
    return state, tuple(_due(view, state.turn, lives) for view in views)


def _due(view: int, turn: int, lives: Sequence[Life]) -> int | None:
    """None where that view shows one of them at most."""
    shown = [life.tracks[view] for life in lives if life.tracks[view] != NO_TRACK]
    return shown[(turn + view) % len(shown)] if len(shown) > 1 else None
