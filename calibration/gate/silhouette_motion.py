"""Whether the person moves, by each view's silhouettes in the last half second."""

from typing import Final, NamedTuple

import numpy as np

from common.bus.instant import Instant
from common.bus.messages import MOTION_S, View

MOVED: Final = 0.15
"""Share of the silhouette's pixels that changes from which on a person moves. In 95 % of the
half seconds of recorded motion it is 0.05 at least, in the median 0.34 (docs/measurements.md)."""


class Shown(NamedTuple):
    """One silhouette."""

    captured_s: float
    silhouette: bytes
    area_px: int


State = tuple[tuple[Shown, ...], ...]
"""The silhouettes of each view, oldest first: the last MOTION_S, and one older."""


def init(cameras: int) -> State:
    """The state of that many views before any silhouette."""
    return ((),) * cameras


def step(state: State, instant: Instant) -> State:
    """Process one instant; a view without a person shows no motion."""
    return tuple(_with(own, view) for own, view in zip(state, instant.views, strict=True))


def _with(own: tuple[Shown, ...], view: View | None) -> tuple[Shown, ...]:
    if view is None:
        return own
    if view.person is None:
        return ()
    own = (*own, Shown(view.captured_s, view.person.silhouette, view.person.area_px))
    old = [n for n, shown in enumerate(own) if view.captured_s - shown.captured_s >= MOTION_S]
    return own[old[-1] :] if old else own


def moves(state: State) -> tuple[bool, ...]:
    """Whether the person has moved in each view within MOTION_S; False where that is unknown."""
    return tuple(_moves(own) for own in state)


def _moves(own: tuple[Shown, ...]) -> bool:
    if not own or own[-1].captured_s - own[0].captured_s < MOTION_S:
        return False
    before, now = (np.frombuffer(each.silhouette, np.uint8) for each in (own[0], own[-1]))
    changed_px = int(np.unpackbits(before ^ now).sum()) if len(before) == len(now) else 0
    return changed_px > MOVED * own[-1].area_px
